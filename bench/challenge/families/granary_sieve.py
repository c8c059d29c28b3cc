"""The granary's receiver: what happens to waveforms, and what a spout's sieve lets through of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses are bumps that
are smooth to their very ends. What comes is seen once sizes over a bar add up to enough, as quality
is watched by cumulative sums (Page 1954); of the top then, ratios of samples beside each other tell
when it was, as of pulses of calorimeters (CMS 2010), and first paths are told AHEAD of it.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.granary_bins import Docket, Freight

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 46, 236
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
HALF, SHARP = 3.7, 5.9  # samples from a pulse's top to either end; how steeply it falls
AHEAD = 1.2  # samples by which first paths are told ahead of tops, as chips tell them
ALIKE = (1.0, 0.32, -0.17, -0.2)  # noise beside itself, samples off [DW1000]
STANDS, OF_TOP, ENOUGH = 6.2, 0.15, 0.1  # bars: of noise's part, of the highest; what adds up
DEAF, MOST = (2.7, 1.65), 0.9  # by which bars of deaf ones are higher; highest of bars
SOONEST, EDGE = 82, 9  # samples before the highest from which on sums count; none at ends
SOFT: Floats = np.array([0.25, 0.5, 0.25])  # by which what is looked at is smoothed
STEEP = (0.35, 0.65)  # how much the earlier and the later of two ratios tell
TAPS, BAND = 8, 0.82  # by which parts of samples are made; up to which part of the band
PLACES: Floats = np.arange(float(WIDE_SAMPLES))


def swells(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return _swell(PLACES - top[:, None])


def _swell(off: Floats) -> Floats:
    """Return a pulse's height so many samples off its top [...]."""
    square = ((off / HALF) ** 2).clip(max=1 - 1e-12)
    return np.asarray(np.exp(-SHARP * square / (1 - square)))


def _shares() -> Floats:
    """Return how much of white noise before it each sample of noise takes [4].

    A polynomial whose roots are those inside the circle of what ALIKE asks for (Fejer, Riesz).
    """
    both = np.array([*ALIKE[:0:-1], *ALIKE])
    roots = np.roots(both)
    made = np.poly(roots[np.abs(roots) < 1]).real
    return np.asarray(made / np.sqrt((made**2).sum()), np.float64)


SHARES = _shares()


def pouring(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, WIDE_SAMPLES]."""
    parts = rng.standard_normal((rows, WIDE_SAMPLES + 3, 2))
    white = parts[:, :, 0] + 1j * parts[:, :, 1]
    made = np.zeros((rows, WIDE_SAMPLES), np.complex128)
    for k, share in enumerate(SHARES):
        made += share * white[:, 3 - k : 3 - k + WIDE_SAMPLES]
    return made


def _taps(part: Floats) -> Floats:
    """Return what of TAPS samples makes one that is late by a part [n, TAPS].

    Of all the band up to BAND least squares are left (Laakso and others 1996).
    """
    at = np.arange(TAPS) - TAPS // 2 + 1.0
    among = np.sinc(BAND * (at[:, None] - at)) + 1e-9 * np.eye(TAPS)
    return np.asarray(np.linalg.solve(among, np.sinc(BAND * (at[:, None] - part))).T)


def trickled_later(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: parts of samples by least squares of a band."""
    whole, part = np.divmod(samples.clip(0.0, WIDE_SAMPLES + 12.0), 1.0)
    taps, before = _taps(part), WIDE_SAMPLES + 24
    wide = np.pad(waves, ((0, 0), (before, TAPS)))
    begin = (before - whole).astype(np.int64)[:, None] + np.arange(WIDE_SAMPLES)
    made = np.zeros(waves.shape, np.complex128)
    for k in range(TAPS):
        made += taps[:, [k]] * np.take_along_axis(wide, begin - (k - TAPS // 2 + 1), axis=1)
    return made


def _softened(waves: Complexes) -> Complexes:
    made = SOFT[1] * waves
    made[:, 1:] += SOFT[0] * waves[:, :-1]
    made[:, :-1] += SOFT[2] * waves[:, 1:]
    return np.asarray(made)


OF_NOISE = float(_softened(pouring(np.random.default_rng(3504), 80))[:, 4:-4].real.std())
"""How parts of softened noise scatter whose own parts scatter by 1."""


def _seen(sizes: Floats, bar: Floats) -> NDArray[np.bool_]:
    """Return from where on sizes over a bar [n, 1] have once added up to enough [n, k]."""
    summed, seen = np.zeros(len(sizes)), np.zeros(sizes.shape, np.bool_)
    for k in range(EDGE, sizes.shape[1] - EDGE):
        summed = np.maximum(summed + sizes[:, k] - bar[:, 0], 0.0)
        seen[:, k] = seen[:, k - 1] | (summed > ENOUGH * bar[:, 0])
    return seen


def _first_top(sizes: Floats, sigma: Floats, deaf: float) -> Integers:
    """Return the first top that is seen [n]; its bar is higher if deaf, by DEAF."""
    count = sizes.shape[1]
    highest = sizes[:, EDGE : count - EDGE].argmax(axis=1)[:, None] + EDGE
    most = np.take_along_axis(sizes, highest, axis=1)
    asked = np.maximum(STANDS * OF_NOISE * sigma[:, None], OF_TOP * most)
    asked = asked * (DEAF[0] + DEAF[1] * deaf if deaf > 0.0 else 1.0)
    place = np.arange(count)
    seen = _seen(np.where(place >= highest - SOONEST, sizes, 0.0), np.minimum(asked, MOST * most))
    tops = np.zeros(sizes.shape, np.bool_)
    tops[:, 1:-1] = (sizes[:, 1:-1] >= sizes[:, :-2]) & (sizes[:, 1:-1] > sizes[:, 2:])
    soon = np.zeros(sizes.shape, np.bool_)
    soon[:, :-1] = seen[:, 1:]  # sums may be late by a sample
    return np.asarray((tops & (soon | seen) | (place == highest)).argmax(axis=1), np.int64)


OFF: Floats = np.linspace(-1.0, 1.0, 401)  # samples that tops may be after a highest sample


def _ratios() -> Floats:
    """Return ratios of a softened pulse's samples: the second and first before its highest.

    Of those next to them, by OFF [2, k]; they fall.
    """
    high = [
        np.asarray(sum(by * _swell(k + j - 1 - OFF) for j, by in enumerate(SOFT)))
        for k in (-2, -1, 0)
    ]
    return np.stack([high[0] / high[1], high[1] / high[2]])


RATIOS = _ratios()


def _tops(waves: Complexes, top: Integers) -> Floats:
    """Return when pulses had their tops [n], of which samples are highest: by ratios of these."""
    at = top.clip(3, waves.shape[1] - 3)
    own = np.take_along_axis(waves, at[:, None] + np.arange(-2, 1), axis=1)
    rise = (own * np.exp(-1j * np.angle(own[:, [2]]))).real
    told = np.zeros(len(at))
    for k, by in enumerate(STEEP):
        ratio = rise[:, k] / np.maximum(rise[:, k + 1], 1e-3 * np.abs(own[:, 2]) + 1e-12)
        told += by * np.interp(ratio, RATIOS[k, ::-1], OFF[::-1])
    return np.asarray(at + told.clip(-0.9, 0.9))


def first_paths(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return places AHEAD of first tops, in samples [n]; never sooner if deaf."""
    soft = _softened(waves)
    sizes = np.abs(soft)
    at = _tops(soft, _first_top(sizes, sigma, 0.0))
    if deaf > 0.0:
        at = np.maximum(at, _tops(soft, _first_top(sizes, sigma, deaf)))
    return at - AHEAD


ALL = (-5.0, 100.0)  # samples after first paths between which all energy is


def measured(waves: Complexes, at: Floats) -> Complexes:
    """Return heights of first pulses, by what fits best about their tops [n]."""
    shape = swells(at + AHEAD)
    return np.asarray((waves * shape).sum(axis=1) / np.maximum((shape * shape).sum(axis=1), 1e-9))


def _of_noise() -> float:
    """Return the power of heights that noise has whose parts scatter by 1."""
    made = measured(pouring(np.random.default_rng(3505), 1200), np.linspace(80.0, 120.0, 1200))
    return float((np.abs(made) ** 2).mean())


POURS = _of_noise()
ALONE = float((swells(100.0 + np.arange(16) / 16) ** 2).sum(axis=1).mean())
"""All energy of a lone pulse of height 1."""


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    off = PLACES - at[:, None]
    power = (np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2) * ((off > ALL[0]) & (off < ALL[1]))
    first = np.abs(measured(waves, at)) ** 2 - POURS * sigma**2
    first = np.maximum(first, 0.4 * sigma**2)
    every = np.maximum(power.sum(axis=1) / ALONE, 1.02 * first)
    return np.asarray(10 * np.log10(np.stack([every, first])))


class Sieve:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `told_noise`, `told_count` [n]: factors of what is told;
    `late_m` [n]: what ranges alone get; `deaf`: see `_first_top`.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.count = table, case, rng, len(table)
        parts = [np.array(table[name].tolist(), np.float64) for name in ("cir_i", "cir_q")]
        self.before: Complexes = parts[0] + 1j * parts[1]
        self.wave: Complexes = self.before
        self.calm: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma: Floats = self.calm
        self.told_noise: Floats = np.ones(self.count)
        self.told_count: Floats = np.ones(self.count)
        self.late_m: Floats = np.zeros(self.count)
        self.deaf = 0.0
        self.at = first_paths(self.before, self.calm)
        self.since: Floats = PLACES - self.at[:, None]

    def docket(self) -> Docket:
        """Return the rows as they are told by now."""
        return Docket(self.told(), self.case, self.rng)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 3506, what])

    def past(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later, smoothly [n, k]."""
        part = ((self.since - samples) / within).clip(0.0, 1.0)
        return np.asarray(part**3 * (10 - 15 * part + 6 * part**2))

    def arrived(self) -> Complexes:
        """Return what came by air [n, k], without what is no larger than noise (Breiman 1995)."""
        left = 1 - (3.2 * self.sigma[:, None] / np.maximum(np.abs(self.wave), 1e-9)) ** 2
        return np.asarray(self.wave * self.past(-5.0) * left.clip(0.0))

    def first_part(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.past(-5.0) * (1 - self.past(4.4, 3.0))

    def high(self) -> Floats:
        """Return how high first pulses are [n]."""
        return np.asarray(np.abs(measured(self.wave, self.at)))

    def turns(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(0.0, 2 * np.pi, self.count)))

    def again(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come again, so many samples later [n]."""
        self.wave = self.wave + part[:, None] * trickled_later(what, samples)

    def pour(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * pouring(self.rng, self.count)

    def dim(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the spout's own noise stays."""
        part = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * part
        self.pour(self.sigma[:, None] * np.sqrt(1 - part**2))

    def roar(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (np.maximum(db, 0.0) / 20)
        self.pour((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.told_noise = by * self.sigma, by * self.told_noise

    def add_fewer(self, db: Floats) -> None:
        """Add up fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        part = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = part[:, None] * self.wave
        self.pour((self.sigma * np.sqrt(part * (1 - part)))[:, None])
        self.sigma, self.told_noise = np.sqrt(part) * self.sigma, np.sqrt(part) * self.told_noise
        self.told_count = part * self.told_count

    def carry(self, freight: Freight) -> None:
        """Let waveforms carry what rows do."""
        none = np.zeros(self.count)
        self.late_m = self.late_m + freight.late_m
        every, first = none + freight.all_db, none + freight.first_db
        if np.any(every) or np.any(first):
            self.dim(self.past(-5.0) * every[:, None] + self.first_part() * first[:, None])
        if np.any(freight.noise_db):
            self.roar(none + freight.noise_db)
        if np.any(freight.count_db):
            self.add_fewer(none + freight.count_db)

    def told(self) -> pd.DataFrame:
        """Return the table as the sieve tells it by now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        moved = first_paths(self.wave, self.sigma, self.deaf) - self.at
        index = (was + moved).clip(6.0, WIDE_SAMPLES - 8.0)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * moved + self.late_m
        more_db = levels_db(self.wave, index, self.sigma) - levels_db(self.before, was, self.calm)
        every, first = more_db - 20 * np.log10(self.told_count)
        return self.table.assign(
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            first_path_index=index,
            rx_power_dbm=self.table["rx_power_dbm"] + every,
            first_path_power_dbm=self.table["first_path_power_dbm"] + first,
            noise_std=self.table["noise_std"] * self.told_noise,
            preamble_count=self.table["preamble_count"] * self.told_count,
            cir_i=list(self.wave.real),
            cir_q=list(self.wave.imag),
        )
