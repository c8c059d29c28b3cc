"""The shipyard's receiver: what happens to waveforms, and what a derrick's lookout tells of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses are exponentials
of a cosh. What fits these is seen once it is over a bar of noise, of the highest, and of what came
just before (Finn and Johnson 1968); about the top that follows, a parabola is fitted to logarithms
of sizes, loud ones the more (Guo 2011), and first paths are told AHEAD of where it is highest.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.shipyard_slip import Berth, Toll

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 43, 226
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
STEEP, BROAD, ENDS = 2.0, 1.48, 5.2  # of pulses; samples of the cosh; from tops to where they end
AHEAD = 1.7  # samples by which first paths are told ahead of tops
ALIKE = (1.0, 0.32, -0.17, -0.2)  # noise beside itself, samples off [DW1000]
NOISE, HIGHEST, BEFORE = 6.3, 0.085, 2.4  # bars: of noise's part; of the highest; of what came
GUARD, LEADING = 5, 14  # samples: from what came before to what is seen; of what came before
DEAF, MOST = (3.0, 4.3), 0.93  # by which bars of deaf ones are higher; highest of bars
SIDES = 8  # samples at either end that are not looked at
TAPS: Integers = np.arange(-7, 9)  # of what fills in between samples
PLACES: Floats = np.arange(float(WIDE_SAMPLES))


def _comber(off: Floats) -> Floats:
    """Return a pulse's height so many samples off its top [...]."""
    high = np.exp(STEEP - STEEP * np.cosh(np.minimum(np.abs(off), ENDS) / BROAD))
    return np.asarray(np.where(np.abs(off) < ENDS, high, 0.0))


def combers(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return _comber(np.subtract.outer(-top, -PLACES))


def _spread_over() -> Floats:
    """Return by what chances are weighed of which noise is made that is beside itself as ALIKE.

    The last row of a long triangle whose square has ALIKE beside its middle (Bauer 1955).
    """
    apart = np.abs(np.subtract.outer(np.arange(96), np.arange(96)))
    beside = np.array([*ALIKE, 0.0])[apart.clip(max=len(ALIKE))]
    return np.asarray(np.linalg.cholesky(beside)[-1, -len(ALIKE) :])


WEIGHTS = _spread_over()


def surf(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, WIDE_SAMPLES]."""
    long = WIDE_SAMPLES + len(WEIGHTS) - 1
    real, imag = rng.standard_normal((2, rows, long))
    white = real + 1j * imag
    ways = (one * white[:, k : k + WIDE_SAMPLES] for k, one in enumerate(WEIGHTS.tolist()))
    return np.asarray(sum(ways), np.complex128)


def hove_to(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: between these, by Lanczos's windowed sincs."""
    late = samples.clip(0.0, WIDE_SAMPLES + 12.0)
    whole = np.floor(late).astype(np.int64)
    room = WIDE_SAMPLES + 30
    wide = np.pad(waves, ((0, 0), (room, 10)))
    made = np.zeros(waves.shape, np.complex128)
    for tap in TAPS.tolist():
        off = tap - (late - whole)
        weight = np.sinc(off) * np.sinc(off / 8.0)
        at = np.arange(WIDE_SAMPLES) + (room - whole - tap)[:, None]
        made += weight[:, None] * np.take_along_axis(wide, at, axis=1)
    return np.where(whole[:, None] - 9 <= PLACES, made, 0.0)


MODEL: Floats = _comber(np.arange(-5.0, 6.0))
MODEL_POWER = float(MODEL @ MODEL)


def met(waves: Complexes) -> Complexes:
    """Return heights of pulses that fit waveforms best, at whole samples [n, k]."""
    reach = len(MODEL) // 2
    wide = np.pad(waves, ((0, 0), (reach, reach)))
    long = waves.shape[1]
    parts = (one * wide[:, k : k + long] for k, one in enumerate((MODEL / MODEL_POWER).tolist()))
    return np.asarray(sum(parts), np.complex128)


OF_NOISE = float(met(surf(np.random.default_rng(3904), 90))[:, 7:-7].imag.std())
"""How parts of heights scatter that fit noise whose parts scatter by 1."""


def came_before(sizes: Floats) -> Floats:
    """Return means of LEADING sizes that end GUARD samples before each [n, k]; of what there is."""
    sums = np.pad(np.cumsum(sizes, axis=1), ((0, 0), (1, 0)))
    end = (np.arange(sizes.shape[1]) - GUARD + 1).clip(0)
    begin = (end - LEADING).clip(0)
    return np.asarray((sums[:, end] - sums[:, begin]) / np.maximum(end - begin, 1))


def _seen(sizes: Floats, sigma: Floats, deaf: float) -> Integers:
    """Return the first top that is over a bar [n], which is higher if deaf, by DEAF.

    Where nothing is over what came before, the highest is seen.
    """
    inner = np.zeros(sizes.shape[1], np.bool_)
    inner[SIDES:-SIDES] = True
    most = sizes[:, SIDES:-SIDES].max(axis=1, keepdims=True)
    bar = np.maximum(NOISE * OF_NOISE * sigma[:, None], HIGHEST * most)
    bar = np.minimum(bar * (DEAF[0] + DEAF[1] * deaf if deaf > 0.0 else 1.0), MOST * most)
    over = (sizes > bar) & (sizes > BEFORE * came_before(sizes)) & inner
    falls = np.diff(sizes, axis=1, append=0.0) <= 0.0
    at = np.where(over.any(axis=1), over.argmax(axis=1), np.where(inner, sizes, 0).argmax(axis=1))
    tops = falls & (np.arange(sizes.shape[1]) >= at[:, None])
    return np.asarray(tops.argmax(axis=1), np.int64)


ABOUT = np.arange(-2.0, 3.0)
POWERS: Floats = np.stack([ABOUT**0, ABOUT, ABOUT**2])


def _crests(sizes: Floats, at: Integers) -> Floats:
    """Return where parabolas through logarithms of sizes about places are highest [n]."""
    near = at.clip(SIDES - 2, sizes.shape[1] - SIDES + 1)
    beside = near[:, None] + ABOUT.astype(np.int64)
    high = np.take_along_axis(sizes, beside, axis=1).clip(1e-12)
    weighed = high**2 / (high**2).max(axis=1, keepdims=True)
    square = np.einsum("ik,nk,jk->nij", POWERS, weighed, POWERS) + 1e-9 * np.eye(3)
    side = np.einsum("ik,nk->ni", POWERS, weighed * np.log(high))
    _, tilt, bend = np.linalg.solve(square, side[:, :, None])[:, :, 0].T
    return np.asarray(near - (tilt / np.minimum(2 * bend, -0.02)).clip(-1.2, 1.2))


def first_paths(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return places AHEAD of the first crest, in samples [n]; never sooner if deaf."""
    sizes = np.abs(met(waves))
    first = _crests(sizes, _seen(sizes, sigma, 0.0))
    if deaf > 0.0:
        first = np.maximum(first, _crests(sizes, _seen(sizes, sigma, deaf)))
    return first - AHEAD


WHILE = (-6.5, 108.0)  # samples after first paths of all energy


def heights(waves: Complexes, at: Floats) -> Floats:
    """Return how high pulses are that fit at first paths [n]."""
    model = combers(at + AHEAD)
    both = np.einsum("nk,nk->n", waves, model), np.einsum("nk,nk->n", model, model)
    return np.asarray(np.abs(both[0]) / np.maximum(both[1], 1e-9))


LONE = float((combers(np.full(1, 100.4)) ** 2).sum())


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    off = np.subtract.outer(-at, -PLACES)
    there = (off > WHILE[0]) & (off < WHILE[1])
    power = waves.real**2 + waves.imag**2
    every = ((power - 2 * sigma[:, None] ** 2) * there).sum(axis=1) / LONE
    first = np.maximum(heights(waves, at) ** 2 - 2 * (OF_NOISE * sigma) ** 2, 0.3 * sigma**2)
    return np.asarray(10 * np.log10(np.stack([np.maximum(every, 1.02 * first), first])))


class Lookout:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `noise_by`, `count_by` [n]: factors of what is told;
    `late_m` [n]: what ranges alone get; `deaf`: see `_seen`.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        self.plain: Complexes = np.vstack([*table["cir_i"]]) + 1j * np.vstack([*table["cir_q"]])
        self.wave = self.plain
        self.calm: Floats = np.asarray(table["noise_std"], np.float64) / OF_SIZES
        self.sigma = self.calm
        self.noise_by, self.count_by, self.late_m = np.ones((3, self.rows)) * [[1.0], [1.0], [0.0]]
        self.deaf = 0.0
        self.at = first_paths(self.plain, self.calm)
        self.off: Floats = np.subtract.outer(-self.at, -PLACES)

    def berth(self) -> Berth:
        """Return the rows as they are told by now."""
        return Berth(self.told(), self.case, self.rng)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([3906, what, self.case])

    def since(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later, by a quintic [n, k]."""
        part = ((self.off - samples) / within).clip(0.0, 1.0)
        return part**3 * (10.0 - 15.0 * part + 6.0 * part**2)

    def by_air(self) -> Complexes:
        """Return what came by air [n, k]: what stands out of noise, of faint things ever less."""
        over = (np.abs(self.wave) / np.maximum(self.sigma[:, None], 1e-9) - 3.0) / 2.5
        return np.asarray(self.wave * self.since(-5.6) * over.clip(0.0, 1.0))

    def ahead(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.since(-5.6) * (1 - self.since(4.6, 3.0))

    def any_phase(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def echo(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come again, so many samples later [n]."""
        self.wave = self.wave + hove_to(part[:, None] * what, samples)

    def roar(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * surf(self.rng, self.rows)

    def dim(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the lookout's own noise stays."""
        left = np.minimum(10 ** (db / 20), 1.0)
        self.wave = left * self.wave
        self.roar(self.sigma[:, None] * np.sqrt(1 - left**2))

    def hiss(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = np.maximum(10 ** (db / 20), 1.0)
        self.roar((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.noise_by = by * self.sigma, by * self.noise_by

    def tally(self, db: Floats) -> None:
        """Add up fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        by = np.minimum(10 ** (db / 20), 1.0)
        self.wave = by[:, None] * self.wave
        self.roar((self.sigma * np.sqrt(by * (1 - by)))[:, None])
        self.sigma, self.noise_by = self.sigma * by**0.5, self.noise_by * by**0.5
        self.count_by = self.count_by * by

    def pay(self, toll: Toll) -> None:
        """Let waveforms pay what rows do."""
        self.late_m = self.late_m + toll.late_m
        if np.any(toll.dim_db) or np.any(toll.first_db):
            every, first = (np.broadcast_to(db, self.rows)[:, None]
                            for db in (toll.dim_db, toll.first_db))  # fmt: skip
            self.dim(self.since(-5.6) * every + self.ahead() * first)
        if np.any(toll.hiss_db):
            self.hiss(np.broadcast_to(toll.hiss_db, self.rows))
        if np.any(toll.tally_db):
            self.tally(np.broadcast_to(toll.tally_db, self.rows))

    def told(self) -> pd.DataFrame:
        """Return the table as the lookout tells it by now."""
        was = np.asarray(self.table["first_path_index"], np.float64)
        moved = first_paths(self.wave, self.sigma, self.deaf) - self.at
        index = (was + moved).clip(6.0, WIDE_SAMPLES - 8.0)
        more_db = levels_db(self.wave, index, self.sigma) - levels_db(self.plain, was, self.calm)
        every, first = more_db - 20 * np.log10(self.count_by)
        error = np.asarray(self.table["error_m"], np.float64) + METRES * moved + self.late_m
        made = self.table.assign(error_m=error, range_m=self.table["true_range_m"] + error)
        made["first_path_index"] = index
        made["rx_power_dbm"] += every
        made["first_path_power_dbm"] += first
        made["noise_std"] *= self.noise_by
        made["preamble_count"] *= self.count_by
        return made.assign(cir_i=[*self.wave.real], cir_q=[*self.wave.imag])
