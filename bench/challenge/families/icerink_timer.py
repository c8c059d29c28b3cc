"""The ice rink's receiver: what happens to waveforms, and what a mullion's timer tells of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses are Kaiser's bell
of Bessel's I0. What fits pulses is looked through for its first top that stands out; there one
pulse is fitted, height and place, by Gauss's and Newton's steps, and first paths are told AHEAD.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.icerink_rink import Marks, Period

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 44, 232
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
HALF, BETA = 4.2, 14.6  # samples from a pulse's top to either end; how steep its bell is
AHEAD = 1.2  # samples by which first paths are told ahead of tops, as chips tell them
ALIKE = (1.0, 0.32, -0.17, -0.2)  # noise beside itself, samples off [DW1000]
STANDS, OF_TOP = 6.5, 0.075  # bars: of noise's part, of the highest
DEAF, MOST = (3.6, 4.2), 0.92  # by which bars of deaf ones are higher; highest of bars
SOONEST, EDGE = 78, 8  # samples before the highest from which on tops count; none at ends
STEPS, REACH = 4, 1.3  # of a fit; samples that it may go
TAPS = 8  # by which parts of samples are made
PLACES: Floats = np.arange(float(WIDE_SAMPLES))


def shouts(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return _shout(PLACES - top[:, None])


def _shout(off: Floats) -> Floats:
    """Return a pulse's height so many samples off its top [...]."""
    left = np.sqrt((1 - (off / HALF) ** 2).clip(0.0))
    return np.asarray(np.where(np.abs(off) < HALF, (np.i0(BETA * left) - 1) / (np.i0(BETA) - 1), 0))


def _root() -> Floats:
    """Return a lower triangle that makes white noise beside itself as ALIKE says (Cholesky)."""
    apart = np.abs(np.subtract.outer(np.arange(WIDE_SAMPLES), np.arange(WIDE_SAMPLES)))
    alike = np.array([*ALIKE, 0.0])[np.minimum(apart, len(ALIKE))]
    return np.asarray(np.linalg.cholesky(alike), np.float64)


ROOT = _root()


def scraping(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, WIDE_SAMPLES]."""
    parts = rng.standard_normal((2, rows, WIDE_SAMPLES)) @ ROOT.T
    return np.asarray(parts[0] + 1j * parts[1])


def _taps(part: Floats) -> Floats:
    """Return what of TAPS samples makes one that is late by a part [n, TAPS] (Lagrange)."""
    at = np.arange(TAPS) - TAPS // 2 + 1.0
    made = np.ones((len(part), TAPS))
    for k in range(TAPS):
        others = np.delete(at, k)
        made[:, k] = ((part[:, None] - others) / (at[k] - others)).prod(axis=1)
    return made


def skated_late(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: parts of samples by Lagrange's polynomials."""
    whole, part = np.divmod(samples.clip(0.0, WIDE_SAMPLES + 10.0), 1.0)
    before, taps = WIDE_SAMPLES + 20, _taps(part)
    wide = np.pad(waves, ((0, 0), (before, TAPS)))
    begin = (before - whole).astype(np.int64)[:, None] + np.arange(WIDE_SAMPLES)
    return np.asarray(sum(
        taps[:, [k]] * np.take_along_axis(wide, begin - (k - TAPS // 2 + 1), axis=1)
        for k in range(TAPS)
    ))  # fmt: skip


SHAPE: Floats = _shout(np.arange(-4.0, 5.0))
SHAPE_POWER = float((SHAPE**2).sum())


def fits(waves: Complexes) -> Complexes:
    """Return heights of pulses that fit waveforms best, at whole samples [n, k]."""
    made = np.zeros_like(waves)
    wide = np.pad(waves, ((0, 0), (4, 4)))
    for k, height in enumerate(SHAPE):
        made += height / SHAPE_POWER * wide[:, k : k + waves.shape[1]]
    return made


OF_NOISE = float(fits(scraping(np.random.default_rng(3604), 80))[:, 6:-6].real.std())
"""How parts of heights scatter that fit noise whose parts scatter by 1."""


def _first_top(sizes: Floats, sigma: Floats, deaf: float) -> Integers:
    """Return the first top that stands out [n] of what fits; its bar is higher if deaf, by DEAF."""
    count = sizes.shape[1]
    highest = sizes[:, EDGE : count - EDGE].argmax(axis=1)[:, None] + EDGE
    most = np.take_along_axis(sizes, highest, axis=1)
    bar = np.maximum(STANDS * OF_NOISE * sigma[:, None], OF_TOP * most)
    bar = np.minimum(bar * (DEAF[0] + DEAF[1] * deaf if deaf > 0.0 else 1.0), MOST * most)
    place = np.arange(count)
    there = (place >= np.maximum(highest - SOONEST, EDGE)) & (sizes >= bar)
    tops = np.zeros(sizes.shape, np.bool_)
    tops[:, 1:-1] = (sizes[:, 1:-1] >= sizes[:, :-2]) & (sizes[:, 1:-1] > sizes[:, 2:])
    return np.asarray((there & tops | (place == highest)).argmax(axis=1), np.int64)


SLOPE = 1e-3  # samples, of differences that slopes are of


def _near(waves: Complexes, at: Integers) -> Complexes:
    """Return samples from four before to four after places [n, 9]."""
    four = np.arange(-4, 5)
    return np.take_along_axis(waves, at[:, None] + four, axis=1)


def _fitted(waves: Complexes, top: Integers) -> Floats:
    """Return places of the pulses that fit waveforms best about tops, by least squares [n]."""
    at = top.clip(EDGE, waves.shape[1] - EDGE)
    own, off = _near(waves, at), np.zeros(len(at))
    for _ in range(STEPS):
        since = np.arange(-4.0, 5.0) - off[:, None]
        shape = _shout(since)
        slope = (_shout(since - SLOPE) - _shout(since + SLOPE)) / (2 * SLOPE)
        height = (own * shape).sum(axis=1) / (shape**2).sum(axis=1)
        left = (own - height[:, None] * shape) * height.conj()[:, None]
        pull = np.abs(height) ** 2 * (slope**2).sum(axis=1)
        off = (off + (left.real * slope).sum(axis=1) / np.maximum(pull, 1e-12)).clip(-REACH, REACH)
    return at + off


def first_paths(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return places AHEAD of first tops, in samples [n]; never sooner if deaf."""
    sizes = np.abs(fits(waves))
    at = _fitted(waves, _first_top(sizes, sigma, 0.0))
    if deaf > 0.0:
        at = np.maximum(at, _fitted(waves, _first_top(sizes, sigma, deaf)))
    return at - AHEAD


ALL, OWN = (-5.0, 96.0), 1.9  # samples after first paths of all energy; about tops, of the first


def _energies(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return energies of all and about first tops, less noise's [2, n]."""
    off = PLACES - at[:, None]
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    about = np.exp(-(((off - AHEAD) / OWN) ** 4))
    return np.stack([(power * ((off > ALL[0]) & (off < ALL[1]))).sum(axis=1),
                     (power * about).sum(axis=1)])  # fmt: skip


def _alone() -> Floats:
    """Return both energies of lone pulses of height 1 [2, 1]."""
    top = 100.0 + np.arange(16) / 16
    both = _energies(shouts(top).astype(np.complex128), top - AHEAD, np.zeros(16))
    return np.asarray(both.mean(axis=1)[:, None])


ALONE = _alone()


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    every, first = _energies(waves, at, sigma) / ALONE
    first = np.maximum(first, 0.4 * sigma**2)
    return np.asarray(10 * np.log10(np.stack([np.maximum(every, 1.02 * first), first])))


def heights(waves: Complexes, at: Floats) -> Floats:
    """Return how high first pulses are that fit at first paths [n]."""
    shape = shouts(at + AHEAD)
    return np.asarray(np.abs((waves * shape).sum(axis=1)) / (shape**2).sum(axis=1).clip(1e-9))


class Timer:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `noise_by`, `count_by` [n]: factors of what is told;
    `late_m` [n]: what ranges alone get; `deaf`: see `_first_top`.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        real, imag = (np.array(table[name].tolist(), np.float64) for name in ("cir_i", "cir_q"))
        self.plain: Complexes = real + 1j * imag
        self.wave: Complexes = self.plain
        self.calm: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma: Floats = self.calm
        self.noise_by, self.count_by = np.ones(self.rows), np.ones(self.rows)
        self.late_m: Floats = np.zeros(self.rows)
        self.deaf = 0.0
        self.at = first_paths(self.plain, self.calm)
        self.since: Floats = PLACES - self.at[:, None]

    def period(self) -> Period:
        """Return the rows as they are told by now."""
        return Period(self.told(), self.case, self.rng)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 3606, what])

    def after(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later, by a cosine [n, k]."""
        part = ((self.since - samples) / within).clip(0.0, 1.0)
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * part))

    def by_air(self) -> Complexes:
        """Return what came by air [n, k]: by Wiener's share, without what is no more than noise."""
        power = np.abs(self.wave) ** 2
        left = (power - 10.0 * self.sigma[:, None] ** 2) / np.maximum(power, 1e-9)
        return np.asarray(self.wave * self.after(-5.0) * left.clip(0.0))

    def straight(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.after(-5.0) * (1 - self.after(4.4, 3.0))

    def height(self) -> Floats:
        """Return how high first pulses are [n]."""
        return heights(self.wave, self.at)

    def phases(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def return_of(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come again, so many samples later [n]."""
        self.wave = self.wave + part[:, None] * skated_late(what, samples)

    def scrape(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * scraping(self.rng, self.rows)

    def weaken(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the timer's own noise stays."""
        by = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = by * self.wave
        self.scrape(self.sigma[:, None] * np.sqrt(1 - by**2))

    def drown(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (np.maximum(db, 0.0) / 20)
        self.scrape((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.noise_by = by * self.sigma, by * self.noise_by

    def count_fewer(self, db: Floats) -> None:
        """Add up fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        by = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = by[:, None] * self.wave
        self.scrape((self.sigma * np.sqrt(by - by**2))[:, None])
        self.sigma, self.noise_by = np.sqrt(by) * self.sigma, np.sqrt(by) * self.noise_by
        self.count_by = by * self.count_by

    def mark(self, marks: Marks) -> None:
        """Let waveforms get what rows do."""
        self.late_m = self.late_m + marks.late_m
        every, first, noise, count = (
            np.zeros(self.rows) + db
            for db in (marks.all_db, marks.first_db, marks.noise_db, marks.count_db)
        )
        if every.any() or first.any():
            self.weaken(self.after(-5.0) * every[:, None] + self.straight() * first[:, None])
        if noise.any():
            self.drown(noise)
        if count.any():
            self.count_fewer(count)

    def told(self) -> pd.DataFrame:
        """Return the table as the timer tells it by now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        moved = first_paths(self.wave, self.sigma, self.deaf) - self.at
        index = (was + moved).clip(6.0, WIDE_SAMPLES - 8.0)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * moved + self.late_m
        now, before = (levels_db(self.wave, index, self.sigma),
                       levels_db(self.plain, was, self.calm))  # fmt: skip
        every, first = now - before - 20 * np.log10(self.count_by)
        return self.table.assign(
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            first_path_index=index,
            rx_power_dbm=self.table["rx_power_dbm"] + every,
            first_path_power_dbm=self.table["first_path_power_dbm"] + first,
            noise_std=self.table["noise_std"] * self.noise_by,
            preamble_count=self.table["preamble_count"] * self.count_by,
            cir_i=list(self.wave.real),
            cir_q=list(self.wave.imag),
        )
