"""The saltworks' receiver: what happens to waveforms, and what a vane's gauge reads of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. First paths are a little
ahead of the first top of Teager's energy (Kaiser 1990), a product less what is beside it.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.saltworks_pans import Haul, Levy

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 44, 242
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
REACH = 4.75  # samples from a pulse's top to its ends
TOLD = 1.3  # samples before tops that first paths are told, as chips do
FINE = 8  # places a sample in which tops are seen
NEAR = 6  # samples on either side that places between are of
BESIDE = 12  # places on either side that a product is of
SOON = 16  # places: what is higher so soon after a top is of the same pulse
STANDS, OF_TOP = 6.0, 0.12  # what tops count: times noise's parts; of the highest size
SINCE, EDGE = 84, 8  # samples before the highest in which tops are looked for; left out at ends
ALIKE: Floats = np.array([1.0, 0.32, -0.17, -0.2])  # noise beside itself, samples off [DW1000]
PLACES: Floats = np.arange(float(WIDE_SAMPLES))


def hump(off: Floats) -> Floats:
    """Return pulses of height 1 at samples off their tops (Wendland 1995), by sixth powers."""
    out = (np.abs(off) / REACH).clip(0.0, 1.0)
    return np.asarray((1 - out) ** 6 * (35 * out**2 + 18 * out + 3) / 3)


def humps(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return hump(PLACES[None] - top[:, None])


def _taps() -> Floats:
    """Return what white noise is to be summed with to be ALIKE: its zeros within the circle."""
    zeros = np.roots(np.concatenate([ALIKE[:0:-1], ALIKE]))
    taps = np.poly(zeros[np.abs(zeros) < 1.0]).real
    return np.asarray(taps / np.sqrt((taps**2).sum()))


TAPS = _taps()


def lapping(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, WIDE_SAMPLES]."""
    size = (rows, WIDE_SAMPLES + len(TAPS) - 1)
    white = rng.normal(size=size) + 1j * rng.normal(size=size)
    parts = [tap * white[:, k : k + WIDE_SAMPLES] for k, tap in enumerate(TAPS)]
    return np.asarray(np.sum(parts, axis=0))


def lagged(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n], by turning phases of twice as long a spectrum."""
    late = samples.clip(0.0, float(WIDE_SAMPLES))
    pitch = np.fft.fftfreq(2 * WIDE_SAMPLES)
    turns = np.exp(-2j * np.pi * pitch * late[:, None])
    made = np.fft.ifft(np.fft.fft(waves, 2 * WIDE_SAMPLES, axis=1) * turns, axis=1)
    return np.asarray(made[:, :WIDE_SAMPLES] * (late[:, None] - REACH < PLACES))


def _between() -> Floats:
    """Return what samples about a place count in what is between them [2 NEAR, FINE]."""
    off = np.arange(FINE) / FINE - np.arange(1 - NEAR, NEAR + 1)[:, None]
    return np.asarray(np.sinc(off) * np.cos(0.5 * np.pi * off / NEAR) ** 2)


BETWEEN = _between()


def finely(waves: Complexes) -> Complexes:
    """Return waveforms at FINE places a sample [n, FINE WIDE_SAMPLES], of what is NEAR alone."""
    wide = np.pad(waves, ((0, 0), (NEAR - 1, NEAR)))
    views = np.lib.stride_tricks.sliding_window_view(wide, 2 * NEAR, axis=1)
    return np.asarray((views @ BETWEEN).reshape(len(waves), FINE * WIDE_SAMPLES))


def teager(fine: Complexes) -> Floats:
    """Return squares of what is there, less the product of what is BESIDE it [n, k]."""
    before, after = np.roll(fine, BESIDE, axis=1), np.roll(fine, -BESIDE, axis=1)
    return np.asarray(np.abs(fine) ** 2 - (before * after.conj()).real)


def summit(values: Floats, top: Integers) -> Floats:
    """Return where parabolas through tops [n] and what is next to them [n, k] are highest."""
    near = np.take_along_axis(values, top[:, None] + np.arange(-1, 2), axis=1)
    bend = np.minimum(near[:, 0] - 2 * near[:, 1] + near[:, 2], -1e-300)
    return np.asarray(top + (0.5 * (near[:, 0] - near[:, 2]) / bend).clip(-0.5, 0.5))


def unsurpassed(values: Floats) -> NDArray[np.bool_]:
    """Return where nothing is higher in the next SOON places [n, k]."""
    highest, reach = values, 1
    while reach < SOON:
        highest = np.maximum(highest, np.roll(highest, -reach, axis=1))
        reach *= 2
    return np.asarray(values >= highest)


def _first_tops(values: Floats, sigma: Floats, deaf: float) -> Integers:
    """Return at which fine places the first tops are that count [n]; values [n, k].

    These stand out of noise, whose parts scatter by `sigma` [n], and are a part of the highest.
    What is deaf asks for more of both.
    """
    place = np.arange(values.shape[1])
    edge = EDGE * FINE
    allowed = (place >= edge) & (place < values.shape[1] - edge)
    highest = np.where(allowed, values, -1.0).argmax(axis=1)
    most = values[np.arange(len(values)), highest]
    asked = np.maximum((STANDS * sigma) ** 2, OF_TOP**2 * most) * (1 + 6.0 * deaf) ** 2
    tops = np.zeros(values.shape, bool)
    tops[:, 1:-1] = (values[:, 1:-1] > values[:, :-2]) & (values[:, 1:-1] >= values[:, 2:])
    tops &= unsurpassed(values) & (values >= np.minimum(asked, 0.85 * most)[:, None])
    begin = np.maximum(highest - SINCE * FINE, edge)
    tops &= (place >= begin[:, None]) & (place <= highest[:, None])
    return np.asarray(np.where(tops.any(axis=1), tops.argmax(axis=1), highest), np.int64)


def first_paths(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return TOLD samples ahead of first tops, in samples [n]; never sooner if deaf."""
    values = teager(finely(waves))
    at = summit(values, _first_tops(values, sigma, 0.0))
    if deaf > 0:
        at = np.maximum(at, summit(values, _first_tops(values, sigma, deaf)))
    return np.asarray(at / FINE - TOLD)


def _at(energy: Floats, place: Floats) -> Floats:
    """Return energies [n, k] at samples [n, m], by lines between them."""
    low = np.floor(place).astype(np.int64).clip(0, energy.shape[1] - 2)
    left, right = (np.take_along_axis(energy, low + k, axis=1) for k in (0, 1))
    return np.asarray(left + (place - low) * (right - left))


THREE: Floats = np.array([0.5, 1.3, 2.1])
"""Samples after first paths in which what comes first is read, as chips do in three."""
ALL = (-2.5, 104.0)  # samples after first paths from which until which all energy is


def _read(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return the energy of all and of the first path, less noise's [2, n]."""
    energy = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    off = PLACES - at[:, None]
    inside = np.minimum(off - ALL[0], ALL[1] - off).clip(0.0, 1.0)
    return np.stack([(inside * energy).sum(axis=1), _at(energy, at[:, None] + THREE).mean(axis=1)])


def _of_lone() -> Floats:
    """Return all energy, and that of the first path, of lone pulses of height 1 [2, 1]."""
    tops = 80 + np.linspace(0.0, 1.0, 40, endpoint=False)
    both = _read(humps(tops).astype(np.complex128), tops - TOLD, np.zeros(40))
    return np.asarray(both.mean(axis=1)[:, None])


OF_LONE = _of_lone()


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    every, first = _read(waves, at, sigma) / OF_LONE
    first = np.maximum(first, 0.4 * sigma**2)
    return np.asarray(10 * np.log10(np.stack([np.maximum(every, 1.01 * first), first])))


class Gauge:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `by_noise`, `by_count` [n]: factors of what is told of
    noise and counts; `more_m` [n]: what ranges alone get; `deaf`: see `_first_tops`.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        real, other = (np.stack([*table[name]]).astype(np.float64) for name in ("cir_i", "cir_q"))
        self.begun: Complexes = real + 1j * other
        self.wave: Complexes = self.begun
        self.sigma_begun: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma: Floats = self.sigma_begun
        self.by_noise: Floats = np.ones(self.rows)
        self.by_count: Floats = np.ones(self.rows)
        self.more_m: Floats = np.zeros(self.rows)
        self.deaf = 0.0
        self.at = first_paths(self.begun, self.sigma)
        self.off: Floats = PLACES - self.at[:, None]

    def haul(self) -> Haul:
        """Return the rows as they are told by now."""
        return Haul(self.told(), self.case, self.rng)

    def same(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 2605, what])

    def from_(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later, by a cubic [n, k]."""
        part = ((self.off - samples) / within).clip(0.0, 1.0)
        return np.asarray(part**2 * (3 - 2 * part))

    def came(self) -> Complexes:
        """Return what came by air [n, k]: what is no larger than noise is left out, softly."""
        over = np.abs(self.wave) / (4.0 * self.sigma[:, None])
        return np.asarray(self.wave * self.from_(-5.5) * over**6 / (1 + over**6))

    def foremost(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.from_(-5.5) * (1 - self.from_(4.6, 2.6))

    def tall(self) -> Floats:
        """Return how high first pulses are [n]."""
        near = np.abs(self.off - TOLD) < 1.6
        return np.asarray(np.max(np.abs(self.wave) * near, axis=1))

    def spun(self, *shape: int) -> Complexes:
        """Return phases by chance, [n] or [n, *shape]."""
        return np.asarray(np.exp(1j * self.rng.uniform(-np.pi, np.pi, (self.rows, *shape))))

    def once_more(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come again, so many samples later [n]."""
        self.wave = self.wave + lagged(part[:, None] * what, samples)

    def hear(self, sigma: Floats) -> None:
        """Hear more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * lapping(self.rng, self.rows)

    def weaken(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the gauge's own noise stays."""
        left = 10 ** (db.clip(max=0.0) / 20)
        self.wave = self.wave * left
        self.hear(self.sigma[:, None] * np.sqrt(1 - left**2))

    def roar(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (db.clip(0.0) / 20)
        self.hear((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.by_noise = self.sigma * by, self.by_noise * by

    def count_less(self, db: Floats) -> None:
        """Count fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        part = 10 ** (db.clip(max=0.0) / 20)
        self.wave = self.wave * part[:, None]
        self.hear((self.sigma * np.sqrt(part * (1 - part)))[:, None])
        self.sigma = self.sigma * np.sqrt(part)
        self.by_noise, self.by_count = self.by_noise * np.sqrt(part), self.by_count * part

    def owe(self, levy: Levy) -> None:
        """Let waveforms bear what rows owe."""
        own = {name: np.zeros(self.rows) + value for name, value in levy.items()}
        self.more_m = self.more_m + own.get("m", 0.0)
        none = np.zeros(self.rows)
        every, first = (own.get(name, none)[:, None] for name in ("all", "first"))
        if every.any() or first.any():
            self.weaken(self.from_(-5.5) * every + self.foremost() * first)
        if "noise" in own:
            self.roar(own["noise"])
        if "count" in own:
            self.count_less(own["count"])

    def told(self) -> pd.DataFrame:
        """Return the table as the gauge tells it by now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        later = first_paths(self.wave, self.sigma, self.deaf) - self.at
        now = (was + later).clip(6.0, WIDE_SAMPLES - 8.0)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * later + self.more_m
        louder = levels_db(self.wave, now, self.sigma) - 20 * np.log10(self.by_count)
        louder = louder - levels_db(self.begun, was, self.sigma_begun)
        return self.table.assign(
            first_path_index=now,
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + louder[0],
            first_path_power_dbm=self.table["first_path_power_dbm"] + louder[1],
            noise_std=self.table["noise_std"] * self.by_noise,
            preamble_count=self.table["preamble_count"] * self.by_count,
            cir_i=[*self.wave.real],
            cir_q=[*self.wave.imag],
        )
