"""The breadworks's receiver: what happens to waveforms, and what a corbel's balance tells of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses are a soliton's
square of a secant. From the highest of what fits such pulses one goes back to the earliest that is
over a bar, across lulls that are short; what is about there is weighed, and the pan shifted to the
mean of weights until it stays (Fukunaga and Hostetler 1975). First paths are told AHEAD of that.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.breadworks_hall import Bake, Does

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 46, 240
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
HALF, SECANT = 4.9, 1.32  # samples from a pulse's top to either end; how wide its secant is
AHEAD = 1.45  # samples by which first paths are told ahead of the pan
ALIKE = (1.0, 0.32, -0.17, -0.2)  # noise beside itself, samples off [DW1000]
STANDS, OF_TOP, LULL = 6.4, 0.08, 44  # bars: of noise's part, of the highest; samples of a lull
DEAF, MOST = (3.4, 4.0), 0.92  # by which bars of deaf ones are higher; highest of bars
ENDS = 9  # samples at either end that are not looked at
PAN, SHIFTS, REACH = 1.5, 14, 1.6  # samples: how wide the pan is; shifts; how far these may go
PLACES: Floats = np.arange(float(WIDE_SAMPLES))


def _swell(off: Floats) -> Floats:
    """Return a pulse's height so many samples off its top [...]."""
    end = np.cosh(HALF / SECANT) ** -2.0
    high = (np.cosh(off.clip(-HALF, HALF) / SECANT) ** -2.0 - end) / (1 - end)
    return np.asarray(high)


def loaves(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return _swell(PLACES - top[:, None])


def _colour() -> Floats:
    """Return by how much parts of noise's spectrum are larger, so that it is as ALIKE says."""
    round_ = np.zeros(2 * WIDE_SAMPLES)
    round_[: len(ALIKE)] = ALIKE
    round_[1 - len(ALIKE) :] = ALIKE[:0:-1]
    return np.asarray(np.sqrt(np.fft.fft(round_).real.clip(0.0)))


COLOUR = _colour()


def kneading(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, WIDE_SAMPLES]."""
    parts = rng.standard_normal((2, rows, 2 * WIDE_SAMPLES))
    spectrum = COLOUR * np.fft.fft(parts[0] + 1j * parts[1], axis=1)
    return np.asarray(np.fft.ifft(spectrum, axis=1)[:, :WIDE_SAMPLES])


def proved_later(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n], by how phases of their spectrum turn."""
    long = 2 * WIDE_SAMPLES + 60
    late = np.minimum(samples.clip(0.0), WIDE_SAMPLES + 20.0)
    turn = np.exp(-2j * np.pi * np.fft.fftfreq(long) * late[:, None])
    made = np.fft.ifft(np.fft.fft(waves, long, axis=1) * turn, axis=1)[:, :WIDE_SAMPLES]
    return np.asarray(np.where(np.floor(late)[:, None] - 2.0 <= PLACES, made, 0.0))


SHAPE: Floats = _swell(np.arange(-4.0, 5.0))
SHAPE_POWER = float((SHAPE**2).sum())


def fitting(waves: Complexes) -> Complexes:
    """Return heights of pulses that fit waveforms best, at whole samples [n, k]."""
    wide = np.pad(waves, ((0, 0), (4, 4)))
    beside = np.lib.stride_tricks.sliding_window_view(wide, len(SHAPE), axis=1)
    return np.asarray(beside @ SHAPE / SHAPE_POWER)


OF_NOISE = float(fitting(kneading(np.random.default_rng(3704), 80))[:, 6:-6].real.std())
"""How parts of heights scatter that fit noise whose parts scatter by 1."""


def _gone_back(sizes: Floats, sigma: Floats, deaf: float) -> Integers:
    """Return the earliest that is over a bar, back from the highest across lulls [n].

    It is followed up to its top. The bar is higher if deaf, by DEAF.
    """
    inner = sizes[:, ENDS:-ENDS]
    highest = inner.argmax(axis=1) + ENDS
    most = inner.max(axis=1)
    bar = np.maximum(STANDS * OF_NOISE * sigma, OF_TOP * most)
    bar = np.minimum(bar * (DEAF[0] + DEAF[1] * deaf if deaf > 0.0 else 1.0), MOST * most)
    over = sizes >= bar[:, None]
    first = [_back(over[k], int(highest[k])) for k in range(len(sizes))]
    return np.array([_up(sizes[k], one, int(highest[k])) for k, one in enumerate(first)], np.int64)


def _back(over: NDArray[np.bool_], highest: int) -> int:
    """Return the first of those over a bar before a place of which none is a LULL off the next."""
    there = np.append(np.flatnonzero(over[ENDS:highest]) + ENDS, highest)
    lulls = np.flatnonzero(np.diff(there) > LULL)
    return int(there[lulls[-1] + 1] if len(lulls) else there[0])


def _up(sizes: Floats, place: int, highest: int) -> int:
    """Return where sizes no longer grow from a place on."""
    falls = np.flatnonzero(np.diff(sizes[place : highest + 1]) <= 0)
    return place + int(falls[0]) if len(falls) else highest


NEAR = np.arange(-6, 7)


def _weighed(heights_at: Complexes, at: Integers) -> Floats:
    """Return where the pan stays that is put down at places, in samples [n]."""
    near = at.clip(ENDS, heights_at.shape[1] - ENDS)
    weight = np.abs(np.take_along_axis(heights_at, near[:, None] + NEAR, axis=1)) ** 2
    off = np.zeros(len(at))
    for _ in range(SHIFTS):
        own = weight * np.exp(-0.5 * ((NEAR - off[:, None]) / PAN) ** 2)
        off = ((own * NEAR).sum(axis=1) / own.sum(axis=1).clip(1e-300)).clip(-REACH, REACH)
    return np.asarray(near + off)


def first_paths(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return places AHEAD of where the pan stays, in samples [n]; never sooner if deaf."""
    fit = fitting(waves)
    sizes = np.abs(fit)
    at = _weighed(fit, _gone_back(sizes, sigma, 0.0))
    if deaf > 0.0:
        at = np.maximum(at, _weighed(fit, _gone_back(sizes, sigma, deaf)))
    return at - AHEAD


ALL = (-6.0, 104.0)  # samples after first paths of all energy


def heights(waves: Complexes, at: Floats) -> Floats:
    """Return how high pulses are that fit at first paths [n]."""
    shape = loaves(at + AHEAD)
    return np.asarray(np.abs((waves * shape).sum(axis=1)) / (shape**2).sum(axis=1).clip(1e-9))


def _all_of(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return the energy of all that comes, less noise's [n]."""
    since = PLACES - at[:, None]
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    return np.asarray((power * ((since > ALL[0]) & (since < ALL[1]))).sum(axis=1))


ALONE = float((loaves(np.full(1, 100.3)) ** 2).sum())


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    first = np.maximum(heights(waves, at) ** 2 - 2 * (OF_NOISE * sigma) ** 2, 0.3 * sigma**2)
    every = np.maximum(_all_of(waves, at, sigma) / ALONE, 1.02 * first)
    return np.asarray(10 * np.log10(np.stack([every, first])))


class Balance:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `noise_by`, `count_by` [n]: factors of what is told;
    `late_m` [n]: what ranges alone get; `deaf`: see `_gone_back`.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        stacked = (np.stack([*table[name]]).astype(np.float64) for name in ("cir_i", "cir_q"))
        self.plain: Complexes = next(stacked) + 1j * next(stacked)
        self.wave: Complexes = self.plain
        self.calm: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma: Floats = self.calm
        self.noise_by, self.count_by = np.ones(self.rows), np.ones(self.rows)
        self.late_m: Floats = np.zeros(self.rows)
        self.deaf = 0.0
        self.at = first_paths(self.plain, self.calm)
        self.since: Floats = PLACES - self.at[:, None]

    def bake(self) -> Bake:
        """Return the rows as they are told by now."""
        return Bake(self.told(), self.case, self.rng)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.case, 3706, what])

    def from_on(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later, by a cubic [n, k]."""
        part = ((self.since - samples) / within).clip(0.0, 1.0)
        return np.asarray(part**2 * (3 - 2 * part))

    def came(self) -> Complexes:
        """Return what came by air [n, k]: all that is over some noise, less the more it is."""
        size = np.abs(self.wave)
        over = 1 - (3.2 * self.sigma[:, None] / np.maximum(size, 1e-9)) ** 3
        return np.asarray(self.wave * self.from_on(-5.5) * over.clip(0.0))

    def first(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.from_on(-5.5) * (1 - self.from_on(4.6, 3.0))

    def turned(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(0.0, 2 * np.pi, self.rows)))

    def again(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come again, so many samples later [n]."""
        self.wave = self.wave + part[:, None] * proved_later(what, samples)

    def knead(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * kneading(self.rng, self.rows)

    def fainter(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the balance's own noise stays."""
        by = 10 ** (db.clip(max=0.0) / 20)
        self.wave = by * self.wave
        self.knead(self.sigma[:, None] * np.sqrt(1 - by**2))

    def louder_noise(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (db.clip(0.0) / 20)
        self.knead((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.noise_by = by * self.sigma, by * self.noise_by

    def fewer(self, db: Floats) -> None:
        """Add up fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        by = 10 ** (db.clip(max=0.0) / 20)
        self.wave = by[:, None] * self.wave
        self.knead((self.sigma * np.sqrt(by - by**2))[:, None])
        self.sigma, self.noise_by = np.sqrt(by) * self.sigma, np.sqrt(by) * self.noise_by
        self.count_by = by * self.count_by

    def take(self, does: Does) -> None:
        """Let waveforms get what rows do."""
        self.late_m = self.late_m + does.late_m
        dbs = (does.all_db, does.first_db, does.noise_db, does.count_db)
        every, first, noise, count = (np.zeros(self.rows) + db for db in dbs)
        if every.any() or first.any():
            self.fainter(self.from_on(-5.5) * every[:, None] + self.first() * first[:, None])
        if noise.any():
            self.louder_noise(noise)
        if count.any():
            self.fewer(count)

    def told(self) -> pd.DataFrame:
        """Return the table as the balance tells it by now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        moved = first_paths(self.wave, self.sigma, self.deaf) - self.at
        index = (was + moved).clip(6.0, WIDE_SAMPLES - 8.0)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * moved + self.late_m
        levels = levels_db(self.wave, index, self.sigma) - levels_db(self.plain, was, self.calm)
        every, first = levels - 20 * np.log10(self.count_by)
        return self.table.assign(
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            first_path_index=index,
            rx_power_dbm=self.table["rx_power_dbm"] + every,
            first_path_power_dbm=self.table["first_path_power_dbm"] + first,
            noise_std=self.table["noise_std"] * self.noise_by,
            preamble_count=self.table["preamble_count"] * self.count_by,
            cir_i=[*self.wave.real],
            cir_q=[*self.wave.imag],
        )
