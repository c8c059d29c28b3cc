"""The saw mill's receiver: what happens to waveforms, and what a brace's decoder makes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. First paths are where a
straight line is at LEVEL of a first pulse's height that is fitted to the middle of its rise.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.sawmill_yard import Change, Stint

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 40, 244
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = 0.655136  # how sizes of noise scatter, next to a part of it (Rayleigh)
HALF_LONG = 3.45  # samples from a pulse's top to either end
FINE = 6  # places a sample in which rises are seen
LOW, HIGH, LEVEL = 0.16, 0.84, 0.38  # parts of a top: what a line is fitted to, where it is read
RISES = 4 * FINE  # places before a top that a rise may last
STANDS, OF_TALLEST = 6.9, 0.11  # what first pulses are: times a part's scatter; of the tallest
BEFORE = 86  # samples before the tallest in which first pulses are looked for
NEXT_TO = (1.0, 0.32, -0.17, -0.2)  # noise beside itself after none to three samples [DW1000]
AT: Floats = np.arange(float(WIDE_SAMPLES))


def hump(off: Floats) -> Floats:
    """Return pulses of height 1 at samples off their tops: Bohman's window (1961)."""
    x = (np.abs(off) / HALF_LONG).clip(max=1.0)
    return np.asarray((1 - x) * np.cos(np.pi * x) + np.sin(np.pi * x) / np.pi)


def humps(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return hump(AT - top[:, None])


def _root() -> Floats:
    """Return the root of how noise at samples goes together (Cholesky), [WIDE_SAMPLES] twice."""
    apart = np.abs(AT[:, None] - AT).astype(np.int64)
    alike = np.concatenate([NEXT_TO, np.zeros(WIDE_SAMPLES)])
    return np.asarray(np.linalg.cholesky(alike[apart]))


ROOT = _root()


def rasp(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as NEXT_TO says [rows, WIDE_SAMPLES]."""
    real, imaginary = rng.standard_normal((2, rows, WIDE_SAMPLES))
    return np.asarray((real @ ROOT.T) + 1j * (imaginary @ ROOT.T))


def held(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n], by a slope of their spectra's phases."""
    late = samples.clip(0.0, float(WIDE_SAMPLES))[:, None]
    whole = 2 * WIDE_SAMPLES + 24
    slope = np.exp(-2j * np.pi * late * np.fft.fftfreq(whole))
    moved = np.fft.ifft(np.fft.fft(waves, whole, axis=1) * slope, axis=1)[:, :WIDE_SAMPLES]
    return np.asarray(np.where((late < WIDE_SAMPLES) & (late - 24 <= AT), moved, 0.0))


def seen_finely(waves: Complexes) -> Floats:
    """Return sizes at FINE places a sample [n, FINE WIDE_SAMPLES]."""
    spectrum, half = np.fft.fft(waves, axis=1), WIDE_SAMPLES // 2
    empty = np.zeros((len(waves), (FINE - 1) * WIDE_SAMPLES), np.complex128)
    wide = np.concatenate([spectrum[:, :half], empty, spectrum[:, half:]], axis=1)
    return np.asarray(FINE * np.abs(np.fft.ifft(wide, axis=1)))


def inclined(size: Floats, top: Integers, step: float) -> Floats:
    """Return where lines through rises are at LEVEL, in samples [n]; sizes [n, k], `step` apart.

    Lines are fitted to places by sizes, from the last that is below LOW on, up to HIGH of tops;
    what is in the middle of both counts most.
    """
    rows = np.arange(len(size))[:, None]
    place = (top[:, None] + np.arange(-RISES, 1)).clip(0)
    part = size[rows, place] / size[rows, top[:, None]].clip(1e-12)
    below = part < LOW
    last = np.where(below.any(axis=1), RISES - below[:, ::-1].argmax(axis=1), -1)
    weight = ((part - LOW) * (HIGH - part)).clip(0.0) ** 2
    weight *= np.arange(RISES + 1) > last[:, None]
    weight += 1e-12
    weight /= weight.sum(axis=1, keepdims=True)
    means = [(weight * one).sum(axis=1)[:, None] for one in (part, place)]
    along, aside = part - means[0], place - means[1]
    slope = (weight * along * aside).sum(axis=1) / (weight * along**2).sum(axis=1).clip(1e-9)
    most = 12.0 / step  # a rise is no flatter
    return np.asarray(step * (means[1][:, 0] + slope.clip(0.0, most) * (LEVEL - means[0][:, 0])))


def _first_tops(size: Floats, sigma: Floats, dull: float) -> Integers:
    """Return at which fine places first pulses have their tops [n]; sizes [n, k].

    From where sizes first stand out of noise, `sigma` [n] of a part, and are a part of the tallest,
    on to where they first fall. What is dull asks for more of both.
    """
    place, edge = np.arange(size.shape[1]), 9 * FINE
    tallest = edge + size[:, edge:-edge].argmax(axis=1)
    most = size[np.arange(len(size)), tallest]
    asked = np.maximum(STANDS * sigma, OF_TALLEST * most) * (1 + 3.8 * dull)
    stands = size >= np.minimum(asked, 0.82 * most)[:, None]
    stands &= place >= np.maximum(tallest - BEFORE * FINE, edge)[:, None]
    begins = stands.argmax(axis=1)
    falls = np.concatenate([size[:, 1:] < size[:, :-1], np.ones((len(size), 1), bool)], axis=1)
    return np.asarray((falls & (place >= begins[:, None])).argmax(axis=1), np.int64)


def onsets(waves: Complexes, sigma: Floats, dull: float = 0.0) -> Floats:
    """Return where first pulses rise, in samples [n]; never sooner if dull."""
    size = seen_finely(waves)
    sharp = inclined(size, _first_tops(size, sigma, 0.0), 1 / FINE)
    if not dull:
        return sharp
    return np.maximum(sharp, inclined(size, _first_tops(size, sigma, dull), 1 / FINE))


def _energies(waves: Complexes, at: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Return the energy of 110 samples about and after onsets, and of first pulses alone [n]."""
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    since = AT - at[:, None]
    windows = [
        (since + 0.5 - begin).clip(0.0, 1.0) * (end + 0.5 - since).clip(0.0, 1.0)
        for begin, end in ((-3.0, 106.0), (-0.8, 2.9))
    ]
    return (power * windows[0]).sum(axis=1), (power * windows[1]).sum(axis=1)


def _of_one() -> tuple[float, float, float]:
    """Return, for lone pulses: samples from onsets to tops, energies of all and of the first."""
    tops = 64 + np.linspace(0.0, 1.0, 61)
    waves, none = humps(tops).astype(np.complex128), np.zeros(61)
    at = onsets(waves, none)
    whole, first = _energies(waves, at, none)
    return float((tops - at).mean()), float(whole.mean()), float(first.mean())


RISE, OF_ALL, OF_FIRST = _of_one()


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Return, in dB of a lone pulse of height 1, all that comes and what comes first [n]."""
    whole, first = _energies(waves, at, sigma)
    early = np.maximum(first / OF_FIRST, 0.55 * sigma**2)
    return 10 * np.log10(np.maximum(whole / OF_ALL, 1.015 * early)), 10 * np.log10(early)


class Decoder:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `noise_by`, `count_by` [n]: factors of what is told of
    noise and counts; `beside_m` [n]: what ranges alone get; `dull`: see `_first_tops`.
    """

    def __init__(self, table: pd.DataFrame, stable: int, rng: np.random.Generator) -> None:
        self.table, self.stable, self.rng, self.n = table, stable, rng, len(table)
        real, imaginary = (np.vstack(table[name].to_list()) for name in ("cir_i", "cir_q"))
        self.begun: Complexes = real.astype(np.float64) + 1j * imaginary.astype(np.float64)
        self.wave: Complexes = self.begun.copy()
        self.sigma_begun: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma: Floats = self.sigma_begun.copy()
        self.noise_by, self.count_by = np.ones(self.n), np.ones(self.n)
        self.beside_m, self.dull = np.zeros(self.n), 0.0
        self.at = onsets(self.begun, self.sigma_begun)
        self.since: Floats = AT - self.at[:, None]

    def stint(self) -> Stint:
        """Return the rows as they are told by now."""
        return Stint(self.told(), self.stable, self.rng)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.stable, 2205, what])

    def past(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples after onsets, 1 some later, by an arch [n, k]."""
        part = ((self.since - samples) / within).clip(0.0, 1.0)
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * part))

    def aloft(self) -> Complexes:
        """Return what comes by air [n, k]: what is no larger than noise is left out, softly."""
        over = np.abs(self.wave) / (4.1 * self.sigma[:, None])
        return np.asarray(self.wave * self.past(-5.0) * -np.expm1(-(over**4)))

    def straight(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.past(-5.0) * (1 - self.past(5.0, 2.5))

    def heights(self) -> Floats:
        """Return how high first pulses are [n]."""
        near = np.abs(self.since - RISE) < 1.8
        return np.asarray(np.where(near, np.abs(self.wave), 0.0).max(axis=1))

    def turns(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.n)))

    def again(self, what: Complexes, share: Floats | Complexes, samples: Floats) -> None:
        """Let a share [n] of something [n, k] come again, so many samples later [n]."""
        self.wave = self.wave + share[:, None] * held(what, samples)

    def add_noise(self, sigma: Floats) -> None:
        """Add noise whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * rasp(self.rng, self.n)

    def dim(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the decoder's own noise stays."""
        left = 10 ** (db.clip(max=0.0) / 20)
        self.wave = self.wave * left
        self.add_noise(self.sigma[:, None] * np.sqrt(1 - left**2))

    def rouse(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (db.clip(0.0) / 20)
        self.add_noise((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.noise_by = self.sigma * by, self.noise_by * by

    def count_less(self, db: Floats) -> None:
        """Count fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        part = 10 ** (db.clip(max=0.0) / 20)
        self.wave = self.wave * part[:, None]
        self.add_noise((self.sigma * np.sqrt(part * (1 - part)))[:, None])
        self.sigma, self.noise_by = self.sigma * part**0.5, self.noise_by * part**0.5
        self.count_by = self.count_by * part

    def take(self, change: Change) -> None:
        """Let waveforms take what becomes of rows."""
        full = np.ones(self.n)
        self.beside_m = self.beside_m + change.metres
        every, early = full * change.all_db, full * change.first_db
        if every.any() or early.any():
            self.dim(self.past(-5.0) * every[:, None] + self.straight() * early[:, None])
        if np.any(change.noise_db):
            self.rouse(full * change.noise_db)
        if np.any(change.count_db):
            self.count_less(full * change.count_db)

    def told(self) -> pd.DataFrame:
        """Return the table as the decoder tells it by now."""
        later = onsets(self.wave, self.sigma, self.dull) - self.at
        first = self.table["first_path_index"].to_numpy(np.float64)
        index = (first + later).clip(6.0, WIDE_SAMPLES - 8.0)
        now = levels_db(self.wave, index, self.sigma)
        then = levels_db(self.begun, first, self.sigma_begun)
        every, early = (
            a - b - 20 * np.log10(self.count_by) for a, b in zip(now, then, strict=True)
        )
        error = self.table["error_m"] + METRES * later + self.beside_m
        return self.table.assign(
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + every,
            first_path_power_dbm=self.table["first_path_power_dbm"] + early,
            first_path_index=index,
            noise_std=self.table["noise_std"] * self.noise_by,
            preamble_count=self.table["preamble_count"] * self.count_by,
            cir_i=list(self.wave.real),
            cir_q=list(self.wave.imag),
        )
