"""The pottery's receiver: what happens to waveforms, and what a purlin's cone tells of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses fall by a power
of how far off they are that is a little over a bell's. Noise is told by how samples differ that are
too far apart to be alike. First paths begin where what power has over DRIFT times the noise has
summed up to a bar (Page 1954); they are told AHEAD of the vertex of a parabola of logarithms of
the first top then, put right by where between samples that is. Levels of first paths are by sizes,
less noise's power, about tops.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.pottery_floor import Firing, Toll

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 44, 236
SAMPLE_NS = 0.9014
"""Of the pottery's own purlins; other tables say theirs."""
LIGHT_M_NS = 0.299792458
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
FALLS, STEEP = 1.56, 2.2  # samples to 1 / e; of pulses
ALIKE = (1.0, 0.32, -0.17, -0.2)  # noise beside itself, samples off [DW1000]
APART = 4  # samples by which noise is compared with itself
BEFORE = slice(4, 36)  # samples that noise is told by
DRIFT, BAR = 7.0, 8.0  # times the noise's power; sum of what is over that
OF_MOST = 0.075  # of the largest size, what counts as noise at least is over
COLD, COLDER, MOST = 0.46, 0.22, 0.9  # of the largest size, bars of cold cones; highest of all
SIDES = 7  # samples at either end that are passed over
PLACES: Floats = np.arange(float(WIDE_SAMPLES))
ORDER = 13  # samples that what comes between them is a polynomial of
WITHIN = (-5.0, 140.0)  # samples from first paths, of all that comes


def slumps(off: Floats) -> Floats:
    """Return how high pulses are so many samples off their tops [...]."""
    return np.asarray(np.exp(-(np.abs(off / FALLS) ** STEEP)))


def thuds(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return slumps(PLACES - np.asarray(top)[:, None])


@cache
def _beside(samples: int) -> Floats:
    """Return what even noise is mixed by to be beside itself as ALIKE says (Cholesky)."""
    off = np.abs(np.subtract.outer(np.arange(samples), np.arange(samples)))
    alike = np.append(ALIKE, 0.0)[off.clip(max=len(ALIKE))]
    return np.asarray(np.linalg.cholesky(alike))


def blunging(rng: np.random.Generator, rows: int, samples: int = WIDE_SAMPLES) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, samples]."""
    even = rng.standard_normal((2, rows, samples)) @ _beside(samples).T
    return np.asarray(even[0] + 1j * even[1])


def cast_later(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n], by Lagrange's polynomials of ORDER samples."""
    long, half = waves.shape[1], ORDER // 2
    late = np.clip(samples, 0.0, long + 2.0 * ORDER)
    whole = np.rint(late).astype(np.int64)
    part, taps = late - whole, np.arange(-half, half + 1)
    made = np.zeros(waves.shape, np.complex128)
    for tap in taps.tolist():
        others = taps[taps != tap]
        share = ((part[:, None] - others) / (tap - others)).prod(axis=1)
        begin = np.arange(long) - (whole + tap)[:, None]
        taken = np.take_along_axis(waves, begin.clip(0, long - 1), axis=1)
        made += share[:, None] * np.where((begin >= 0) & (begin < long), taken, 0.0)
    return made


def lull(waves: Complexes) -> Floats:
    """Return noise's mean power by how samples before differ that are APART (Neumann 1941) [n]."""
    before = waves[:, BEFORE]
    return np.asarray((np.abs(before[:, APART:] - before[:, :-APART]) ** 2).mean(axis=1) / 2 + 1e-9)


def fallen(waves: Complexes, cold: float) -> Integers:
    """Return the sample of the first top once the sum is over its bar [n]; of higher ones if cold.

    The sum begins anew whenever it would be less than nought.
    """
    size = np.abs(waves)
    size[:, :SIDES] = size[:, -SIDES:] = 0.0
    most = size.max(axis=1)
    part = OF_MOST if cold == 0.0 else min(COLD + COLDER * cold, MOST)
    least = np.maximum(np.sqrt(DRIFT * lull(waves)), part * most)
    least = np.minimum(least, MOST * most)[:, None]
    summed = np.cumsum(DRIFT * ((size / least) ** 2 - 1), axis=1)
    over = summed - np.minimum.accumulate(np.minimum(summed, 0.0), axis=1)
    bar = np.minimum(BAR, 0.98 * DRIFT * ((most[:, None] / least) ** 2 - 1))
    there = over >= bar
    hit = np.where(there.any(axis=1), there.argmax(axis=1), size.argmax(axis=1))
    still = (over <= 0.0) & (np.arange(size.shape[1]) <= hit[:, None])
    begun = size.shape[1] - still[:, ::-1].argmax(axis=1)
    tops = (
        (size[:, 1:-1] > size[:, :-2]) & (size[:, 1:-1] >= size[:, 2:]) & (size[:, 1:-1] >= least)
    )
    tops &= np.arange(1, size.shape[1] - 1) >= begun[:, None]
    first: Integers = np.where(tops.any(axis=1), tops.argmax(axis=1) + 1, size.argmax(axis=1))
    return first.clip(SIDES, size.shape[1] - SIDES - 1)


def _vertex(waves: Complexes, top: Integers) -> Floats:
    """Return where parabolas of logarithms of sizes about tops are highest, in samples [n]."""
    near = np.abs(np.take_along_axis(waves, top[:, None] + np.arange(-1, 2), axis=1))
    before, at, after = np.log(near + 1e-9).T
    bend = np.maximum(2 * at - before - after, 1e-6)
    return np.asarray(top + (0.5 * (after - before) / bend).clip(-0.75, 0.75))


def _of_lone() -> tuple[Floats, Floats]:
    """Return where between samples lone pulses are told, and what puts that right [k] each."""
    top = 100.0 + np.linspace(-0.499, 0.499, 301)
    told = _vertex(thuds(top).astype(np.complex128), np.full(len(top), 100))
    order = np.argsort(told % 1.0)
    return (told % 1.0)[order], (top - told)[order]


PARTS, RIGHTED = _of_lone()
AHEAD = 1.85
"""Samples from first paths, as these are told, to tops."""


def slumped(waves: Complexes, cold: float = 0.0) -> Floats:
    """Return where first paths are told, in samples [n]; never sooner if cold."""
    told = _vertex(waves, fallen(waves, 0.0))
    if cold > 0.0:
        told = np.maximum(told, _vertex(waves, fallen(waves, cold)))
    return np.asarray(told + np.interp(told % 1.0, PARTS, RIGHTED, period=1.0) - AHEAD)


WHOLE = float((slumps(np.arange(-30.0, 31.0)[:, None] - np.arange(0.0, 1.0, 0.04)) ** 2)
              .sum(axis=0).mean())  # fmt: skip


def weight(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return how high first pulses are: sizes about tops, rid of noise's power, as pulses weigh."""
    top = np.asarray(at) + AHEAD
    which = np.floor(top).astype(np.int64)[:, None] + np.arange(-1, 3)
    pulse = slumps(which - top[:, None])
    noise = 2 * np.asarray(sigma)[:, None] ** 2
    power = np.abs(np.take_along_axis(waves, which.clip(0, waves.shape[1] - 1), axis=1)) ** 2
    size = np.sqrt(np.maximum(power - noise, 0.1 * noise + 1e-12))
    return np.asarray((size * pulse).sum(axis=1) / (pulse**2).sum(axis=1))


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    since = PLACES - np.asarray(at)[:, None]
    inside = (since >= WITHIN[0]) & (since <= WITHIN[1])
    power = ((np.abs(waves) ** 2 - 2 * np.asarray(sigma)[:, None] ** 2) * inside).sum(axis=1)
    first = weight(waves, at, sigma) ** 2
    return np.asarray(10 * np.log10(np.stack([np.maximum(power / WHOLE, 1.025 * first), first])))


class Cone:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `noise_by`, `count_by` [n]: factors of what is told;
    `more_m` [n]: what ranges alone get; `cold`: see `fallen`; `metres` [n]: of a sample.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        self.begun: Complexes = np.stack([*table["cir_i"]]).astype(np.complex128)
        self.begun += 1j * np.stack([*table["cir_q"]])
        self.wave = self.begun.copy()
        self.calm: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.calm.copy()
        self.noise_by, self.count_by = np.ones(self.rows), np.ones(self.rows)
        self.more_m, self.cold = np.zeros(self.rows), 0.0
        self.metres: Floats = LIGHT_M_NS * table["sample_period_ns"].to_numpy(np.float64)
        self.at = slumped(self.begun)

    def firing(self) -> Firing:
        """Return the rows as they are told by now."""
        return Firing(self.told(), self.case, self.rng)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([9605, what, self.case])

    def past(self, samples: float, over: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later [n, k]."""
        part = ((PLACES - self.at[:, None] - samples) / over).clip(0.0, 1.0)
        return np.asarray(np.sin(0.5 * np.pi * part) ** 2)

    def straight(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.past(-5.0) - self.past(4.8)

    def arrived(self) -> Complexes:
        """Return what came by air [n, k]: what noise may be is left out, softly."""
        over = np.abs(self.wave) / (self.sigma[:, None] + 1e-9)
        part = ((over - 2.5) / 2.2).clip(0.0, 1.0)
        return np.asarray(self.past(-5.0) * part**2 * (3 - 2 * part) * self.wave)

    def turns(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def repeat(self, of: Complexes, share: Floats | Complexes, samples: Floats) -> None:
        """Let a share [n] of something [n, k] come once more, so many samples later [n]."""
        some = np.flatnonzero(np.abs(share) > 1e-9)
        if some.size:
            self.wave[some] += share[some, None] * cast_later(of[some], samples[some])

    def hiss(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * blunging(self.rng, self.rows)

    def dull(self, db: Floats) -> None:
        """Let what comes lose dB <= 0 [n, k]; the purlin's own noise stays as large."""
        kept = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = kept * self.wave
        self.hiss(np.sqrt(1 - kept**2) * self.sigma[:, None])

    def rumble(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (np.maximum(db, 0.0) / 20)
        self.hiss((np.sqrt(by**2 - 1) * self.sigma)[:, None])
        self.sigma, self.noise_by = by * self.sigma, by * self.noise_by

    def sum_fewer(self, db: Floats) -> None:
        """Sum fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        by = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = by[:, None] * self.wave
        self.hiss((np.sqrt(by * (1 - by)) * self.sigma)[:, None])
        self.sigma, self.noise_by = np.sqrt(by) * self.sigma, np.sqrt(by) * self.noise_by
        self.count_by = by * self.count_by

    def pay(self, toll: Toll) -> None:
        """Take of waveforms what rows pay."""
        more, level, first, noise, count = (
            np.zeros(self.rows) + one
            for one in (toll.more_m, toll.level_db, toll.first_db, toll.noise_db, toll.count_db)
        )
        self.more_m = self.more_m + more
        if level.any() or first.any():
            self.dull(level[:, None] * self.past(-5.0) + first[:, None] * self.straight())
        if noise.any():
            self.rumble(noise)
        if count.any():
            self.sum_fewer(count)

    def told(self) -> pd.DataFrame:
        """Return the table as the cone tells it by now."""
        table = self.table
        index = table["first_path_index"].to_numpy(np.float64)
        later = slumped(self.wave, self.cold) - self.at
        now = (index + later).clip(4.0, WIDE_SAMPLES - 9.0)
        gains = levels_db(self.wave, now, self.sigma) - levels_db(self.begun, index, self.calm)
        every, first = gains - 20 * np.log10(self.count_by)
        error = table["error_m"].to_numpy(np.float64) + self.metres * later + self.more_m
        return table.assign(
            error_m=error, range_m=table["true_range_m"] + error, first_path_index=now,
            rx_power_dbm=table["rx_power_dbm"] + every,
            first_path_power_dbm=table["first_path_power_dbm"] + first,
            noise_std=table["noise_std"] * self.noise_by,
            preamble_count=table["preamble_count"] * self.count_by,
            cir_i=[*self.wave.real], cir_q=[*self.wave.imag],
        )  # fmt: skip
