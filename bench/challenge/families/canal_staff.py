"""The ship lock's receiver: what happens to waveforms, and what a davit's staff reads of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. First paths are where
half of the energy has come that comes until the first top, some way AHEAD of which they are told.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.canal_chamber import Passage, Toll

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 46, 236
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = 0.655136  # how sizes of noise scatter, next to a part of it (Rayleigh)
BOX = 1.74  # samples: how long each of four boxes is whose like makes a pulse
HALF_LONG = 2 * BOX
TOLD = 1.2  # samples before tops that first paths are told, as chips do
FINE = 8  # places a sample in which tops are seen
WITHIN = 3.0  # samples before a top of which half is sought
STANDS, OF_TOP = 5.8, 0.12  # what tops count: times noise's parts; of the highest
SINCE, EDGE = 88, 8  # samples before the highest in which tops are looked for; left out at ends
ALIKE = {1: 0.32, 2: -0.17, 3: -0.2}  # noise beside itself, so many samples off [DW1000]
TAPS, KAISER = 9, 8.0  # samples to either side that what comes between them is made of; its window
PLACES: Floats = np.arange(float(WIDE_SAMPLES))


def spline(off: Floats) -> Floats:
    """Return pulses of height 1 at samples off their tops: four boxes' cubic (Schoenberg 1946)."""
    out = np.abs(off) / BOX
    return np.asarray(0.25 * (2 - out).clip(0.0) ** 3 - (1 - out).clip(0.0) ** 3)


def splines(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return spline(PLACES[None] - top[:, None])


def _coloured() -> Complexes:
    """Return by what spectra of white noise are to be multiplied [WIDE_SAMPLES]."""
    ring = np.zeros(WIDE_SAMPLES)
    ring[0] = 1.0
    for lag, by in ALIKE.items():
        ring[[lag, -lag]] = by
    return np.asarray(np.sqrt(np.fft.fft(ring).real.clip(0.0)), np.complex128)


COLOUR = _coloured()


def swash(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, WIDE_SAMPLES]."""
    white = rng.standard_normal((2, rows, WIDE_SAMPLES))
    return np.asarray(np.fft.ifft(COLOUR * np.fft.fft(white[0] + 1j * white[1], axis=-1), axis=-1))


def detained(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: in between by cardinal series, under a window."""
    whole, part = np.divmod(samples.clip(0.0, WIDE_SAMPLES + 2.0 * TAPS), 1.0)
    rows = np.arange(len(waves))[:, None]
    column = np.arange(WIDE_SAMPLES) - whole.astype(np.int64)[:, None]
    out = np.zeros(waves.shape, np.complex128)
    for tap in range(1 - TAPS, TAPS + 1):
        off = tap - part
        window = np.i0(KAISER * np.sqrt((1 - (off / (TAPS + 1)) ** 2).clip(0.0))) / np.i0(KAISER)
        at = column - tap
        there = (at >= 0) & (at < WIDE_SAMPLES)
        out += (np.sinc(off) * window)[:, None] * there * waves[rows, at.clip(0, WIDE_SAMPLES - 1)]
    return out


def finely(waves: Complexes) -> Floats:
    """Return energies at FINE places a sample [n, FINE WIDE_SAMPLES]."""
    half = WIDE_SAMPLES // 2
    spectrum = np.fft.fftshift(np.fft.fft(waves, axis=1), axes=1)
    more = ((0, 0), ((FINE - 1) * half, (FINE - 1) * half))
    wide = np.fft.ifft(np.fft.ifftshift(np.pad(spectrum, more), axes=1), axis=1)
    return np.asarray(FINE**2 * (wide.real**2 + wide.imag**2))


def _between(values: Floats, place: Floats) -> Floats:
    """Return values [n, k] at places between theirs [n, m], by lines."""
    low = np.floor(place).astype(np.int64).clip(0, values.shape[1] - 2)
    left, right = (np.take_along_axis(values, low + k, axis=1) for k in (0, 1))
    return np.asarray(left + (place - low) * (right - left))


def half_come(energy: Floats, top: Integers, within: int) -> Floats:
    """Return in front of which places half has come of what comes until tops [n]; energy [n, k].

    What has come until the end of a place is half a place past its middle.
    """
    come, beside = np.cumsum(energy, axis=1), top[:, None] + np.arange(-1, 2)
    near = np.take_along_axis(energy, beside.clip(0, energy.shape[1] - 1), axis=1)
    bend = np.minimum(near[:, 0] - 2 * near[:, 1] + near[:, 2], -1e-300)
    summit = top + (0.5 * (near[:, 0] - near[:, 2]) / bend).clip(-0.5, 0.5)
    half = _between(come, np.stack([summit - within, summit], axis=1) - 0.5).mean(axis=1)
    after = (come < half[:, None]).sum(axis=1)[:, None].clip(1, energy.shape[1] - 1)
    low, high = _between(come, after - 1.0)[:, 0], _between(come, after + 0.0)[:, 0]
    return np.asarray(after[:, 0] - 0.5 + (half - low) / (high - low).clip(1e-300))


def _first_tops(energy: Floats, sigma: Floats, deaf: float) -> Integers:
    """Return at which fine places the first tops are that count [n]; energy [n, k].

    These stand out of noise, whose parts scatter by `sigma` [n], and are a part of the highest.
    What is deaf asks for more of both.
    """
    place, edge = np.arange(energy.shape[1]), EDGE * FINE
    allowed = (place >= edge) & (place < energy.shape[1] - edge)
    highest = np.where(allowed, energy, -1.0).argmax(axis=1)[:, None]
    most = np.take_along_axis(energy, highest, axis=1)
    asked = np.maximum((STANDS * sigma[:, None]) ** 2, OF_TOP**2 * most) * (1 + 5.0 * deaf) ** 2
    top = np.diff(np.sign(np.diff(energy, axis=1, prepend=0.0)), axis=1, append=0.0) < 0
    counts = top & (energy >= np.minimum(asked, 0.7 * most))
    counts &= (place >= np.maximum(highest - SINCE * FINE, edge)) & (place <= highest)
    found = np.where(counts.any(axis=1), counts.argmax(axis=1), highest[:, 0])
    return np.asarray(found, np.int64)


def _halves(waves: Complexes, sigma: Floats, deaf: float) -> Floats:
    """Return where half of what comes until first tops has come, in samples [n].

    Never sooner if deaf.
    """
    energy, within = finely(waves), int(WITHIN * FINE)
    at = half_come(energy, _first_tops(energy, sigma, 0.0), within) / FINE
    if deaf > 0:
        at = np.maximum(at, half_come(energy, _first_tops(energy, sigma, deaf), within) / FINE)
    return np.asarray(at)


def _ahead() -> float:
    """Return how long before lone tops half has come, in samples."""
    tops = 80 + np.linspace(0.0, 1.0, 33)
    return float((tops - _halves(splines(tops).astype(np.complex128), np.zeros(33), 0.0)).mean())


HALF_AHEAD = _ahead()


def first_paths(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return TOLD samples ahead of where first tops would be, in samples [n]."""
    return np.asarray(_halves(waves, sigma, deaf) + HALF_AHEAD - TOLD)


def _summed(waves: Complexes, at: Floats, sigma: Floats, begin: float, end: float) -> Floats:
    """Return the energy from some samples after first paths until others, less noise's [n]."""
    since = PLACES - at[:, None]
    inside = (0.5 + np.minimum(since - begin, end - since)).clip(0.0, 1.0)
    return np.asarray(np.sum(inside * (np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2), axis=1))


ALL, FIRST = (-2.0, 101.0), (-0.4, 2.8)
"""From which sample after first paths until which all energy is summed, and that of the first."""


def _of_lone() -> tuple[float, float]:
    """Return all energy, and that of the first, of lone pulses of height 1."""
    tops = 80 + np.linspace(0.0, 1.0, 33)
    waves = splines(tops).astype(np.complex128)
    every, first = (_summed(waves, tops - TOLD, np.zeros(33), *part) for part in (ALL, FIRST))
    return float(every.mean()), float(first.mean())


OF_ALL, OF_FIRST = _of_lone()


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    first = np.maximum(_summed(waves, at, sigma, *FIRST) / OF_FIRST, 0.4 * sigma**2)
    every = np.maximum(_summed(waves, at, sigma, *ALL) / OF_ALL, 1.02 * first)
    return np.asarray(10 * np.log10(np.stack([every, first])))


class Staff:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `by_noise`, `by_count` [n]: factors of what is told of
    noise and counts; `more_m` [n]: what ranges alone get; `deaf`: see `_first_tops`.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        real, other = (np.array(table[part].tolist(), np.float64) for part in ("cir_i", "cir_q"))
        self.begun: Complexes = real + 1j * other
        self.wave: Complexes = self.begun
        self.sigma_begun: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma: Floats = self.sigma_begun
        self.by_noise, self.by_count, self.more_m = np.ones((3, self.rows)) * [[1.0], [1.0], [0.0]]
        self.deaf = 0.0
        self.at = first_paths(self.begun, self.sigma)
        self.since: Floats = PLACES - self.at[:, None]

    def passage(self) -> Passage:
        """Return the rows as they are told by now."""
        return Passage(self.told(), self.case, self.rng)

    def same(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 2505, what])

    def from_(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later, by a cosine [n, k]."""
        part = ((self.since - samples) / within).clip(0.0, 1.0)
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * part))

    def came(self) -> Complexes:
        """Return what came by air [n, k]: what is no larger than noise is left out, softly."""
        over = np.abs(self.wave) / (4.2 * self.sigma[:, None])
        return np.asarray(self.wave * self.from_(-5.0) / (1 + over.clip(1e-9) ** -6))

    def foremost(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.from_(-5.0) * (1 - self.from_(4.8, 2.4))

    def tall(self) -> Floats:
        """Return how high first pulses are [n]."""
        return np.asarray(np.where(np.abs(self.since - TOLD) < 1.7, np.abs(self.wave), 0).max(1))

    def spun(self, *shape: int) -> Complexes:
        """Return phases by chance, [n] or [n, *shape]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random((self.rows, *shape))))

    def return_(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come once more, so many samples later [n]."""
        self.wave = self.wave + detained(part[:, None] * what, samples)

    def hear(self, sigma: Floats) -> None:
        """Hear more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * swash(self.rng, self.rows)

    def weaken(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the staff's own noise stays."""
        left = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * left
        self.hear(self.sigma[:, None] * np.sqrt(1 - left**2))

    def roar(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (np.maximum(db, 0.0) / 20)
        self.hear(self.sigma[:, None] * np.sqrt(by**2 - 1)[:, None])
        self.sigma, self.by_noise = self.sigma * by, self.by_noise * by

    def count_less(self, db: Floats) -> None:
        """Count fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        part = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * part[:, None]
        self.hear(self.sigma[:, None] * np.sqrt(part - part**2)[:, None])
        self.by_count, root = self.by_count * part, np.sqrt(part)
        self.sigma, self.by_noise = self.sigma * root, self.by_noise * root

    def pay(self, toll: Toll) -> None:
        """Let waveforms bear what rows have to."""
        own = {name: np.zeros(self.rows) + toll[name] for name in toll}
        self.more_m = self.more_m + own.get("m", 0.0)
        if {"all", "first"} & {*own}:
            every, first = (np.atleast_1d(own.get(n, 0.0))[:, None] for n in ("all", "first"))
            self.weaken(self.from_(-5.0) * every + self.foremost() * first)
        if "noise" in own:
            self.roar(own["noise"])
        if "count" in own:
            self.count_less(own["count"])

    def told(self) -> pd.DataFrame:
        """Return the table as the staff tells it by now."""
        made, was = self.table.copy(), self.table["first_path_index"].to_numpy(np.float64)
        later = first_paths(self.wave, self.sigma, self.deaf) - self.at
        made["first_path_index"] = (was + later).clip(6.0, WIDE_SAMPLES - 8.0)
        made["error_m"] += METRES * later + self.more_m
        made["range_m"] = made["true_range_m"] + made["error_m"]
        now = levels_db(self.wave, made["first_path_index"].to_numpy(), self.sigma)
        louder = now - levels_db(self.begun, was, self.sigma_begun) - 20 * np.log10(self.by_count)
        made["rx_power_dbm"] += louder[0]
        made["first_path_power_dbm"] += louder[1]
        made["noise_std"] *= self.by_noise
        made["preamble_count"] *= self.by_count
        made["cir_i"], made["cir_q"] = list(self.wave.real), list(self.wave.imag)
        return made
