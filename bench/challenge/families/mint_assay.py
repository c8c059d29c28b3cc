"""The mint's receiver: what happens to waveforms, and what a tag's assay tells of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses are Wendland's
functions (1995), smooth, and none from where they end. Noise is told by the mean of logarithms of
what comes before. The first three samples whose energy is over a bar (Urkowitz 1967) are followed
up to their top; on the rise to that, a difference of what comes next to a sum of it tells how far
off the pulse is, as angles are by monopulse radars (Sherman 1984); first paths are told AHEAD.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.mint_court import Tally, Toll

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 52, 244
SAMPLE_NS = 0.9014
"""Of the mint's own tags; other tables say theirs."""
LIGHT_M_NS = 0.299792458
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
REACH, SLOPES = 4.5, 4.2  # samples from a pulse's top until it is none; of what slopes are told by
RISE = 0.9  # samples before tops about which slopes are told
ALIKE = (1.0, 0.32, -0.17, -0.2)  # noise beside itself, samples off [DW1000]
BEFORE = (2, 36)  # samples that noise is told by
OVER, PART = 8.5, 0.01  # bars of energy: of noise's; of the most
DULL, MOST = (12.0, 50.0), 0.85  # by which bars of dull ones are higher; highest of bars
A_LITTLE, EVENS = 0.2886, 1.1230  # of the median; by which logarithms' mean is lower then
SIDES, UP = 8, 5  # samples at either end that are passed over; from a bar to a top
OFTEN, AT_MOST = 4, 0.8  # steps towards a pulse's place, of so many samples
AHEAD = 1.3
"""Samples from first paths, as these are told, to tops."""
PLACES: Floats = np.arange(float(WIDE_SAMPLES))


def planed(off: Floats, reach: float = REACH) -> Floats:
    """Return how high pulses are so many samples off their tops [...]."""
    part = np.abs(off / reach).clip(max=1.0)
    return np.asarray((1 - part) ** 6 * (35 * part**2 + 18 * part + 3) / 3)


def sloped(off: Floats, reach: float = SLOPES) -> Floats:
    """Return how steeply pulses rise so many samples off their tops, each sample [...]."""
    part = np.abs(off / reach).clip(max=1.0)
    return np.asarray(-np.sign(off) * 56 / 3 / reach * part * (5 * part + 1) * (1 - part) ** 5)


def coins(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return planed(PLACES - top[:, None])


def jingling(rng: np.random.Generator, rows: int, samples: int = WIDE_SAMPLES) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, samples].

    Pitches of a ring are drawn, each as strong as noise has it (Dietrich and Newsam 1997).
    """
    ring = samples + 4
    beside = np.zeros(ring)
    beside[: len(ALIKE)] = ALIKE
    beside[-1 : -len(ALIKE) : -1] = ALIKE[1:]
    strong = np.fft.fft(beside).real.clip(0.0) * ring
    even = rng.standard_normal((rows, ring, 2)) @ np.array([1.0, 1.0j])
    return np.asarray(np.fft.ifft(np.sqrt(strong) * even, axis=1)[:, :samples])


KNOTS: Floats = np.arange(-4.0, 4.0)


def rolled_later(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: eight neighbours' polynomials (Waring 1779)."""
    late = samples.clip(0.0, waves.shape[1] + 16.0)
    whole = np.floor(late).astype(np.int64)
    at, made = -(late - whole), np.zeros(waves.shape, np.complex128)
    for knot in KNOTS:
        others = np.delete(KNOTS, int(knot) + 4)
        share = np.prod((at[:, None] - others) / (knot - others), axis=1)
        made += share[:, None] * _shoved(waves, whole - int(knot))
    return made


def _shoved(waves: Complexes, by: Integers) -> Complexes:
    """Return waveforms later by whole samples [n], with nothing where none was."""
    begin = np.arange(waves.shape[1]) - by[:, None]
    there = (begin >= 0) & (begin < waves.shape[1])
    taken = np.take_along_axis(waves, begin.clip(0, waves.shape[1] - 1), axis=1)
    return np.asarray(np.where(there, taken, 0.0))


def quiet(waves: Complexes) -> Floats:
    """Return noise's mean power by logarithms' mean over samples before [n].

    Before that all have a little of their median more, so that noughts do not count for all.
    """
    power = np.abs(waves[:, BEFORE[0] : BEFORE[1]]) ** 2
    power += A_LITTLE * np.median(power, axis=1)[:, None] + 1e-12
    return np.asarray(EVENS * np.exp(np.log(power).mean(axis=1)))


def first_tops(waves: Complexes, dull: float) -> Integers:
    """Return the first top of threes' energy that is over a bar, in samples [n].

    Bars are higher if dull, by DULL.
    """
    power = np.abs(waves) ** 2
    threes = power.copy()
    threes[:, 1:-1] += power[:, :-2] + power[:, 2:]
    threes[:, :SIDES] = threes[:, -SIDES:] = 0.0
    most = threes.max(axis=1)
    higher = DULL[0] + DULL[1] * dull if dull > 0.0 else 1.0
    bar = np.minimum(higher * np.maximum(3 * OVER * quiet(waves), PART * most), MOST * most)
    over = (threes >= bar[:, None]).argmax(axis=1)
    about = np.take_along_axis(threes, over[:, None] + np.arange(UP + 1), axis=1)
    falls = np.diff(about, axis=1) <= 0
    return np.asarray(over + np.where(falls.any(axis=1), falls.argmax(axis=1), UP), np.int64)


def ratio(waves: Complexes, top: Floats) -> Floats:
    """Return what differs, next to the sum, on the rise to tops [n], each sample [n]."""
    off = PLACES - top[:, None] + RISE
    every = (planed(off, SLOPES) * waves).sum(axis=1)
    differs = -(sloped(off) * waves).sum(axis=1)
    return np.asarray((every.conj() * differs).real / (np.abs(every) ** 2 + 1e-9))


def _of_lone() -> tuple[Floats, Floats]:
    """Return ratios that rise, and how far lone pulses are past where they are sought [k] each."""
    past = np.linspace(-1.1, 1.1, 89)
    phases = np.arange(0.0, 1.0, 0.125)
    every = [ratio(coins(80 + part + past).astype(np.complex128), np.full(89, 80 + part))
             for part in phases]  # fmt: skip
    mean = np.mean(every, axis=0)
    order = np.argsort(mean)
    return np.asarray(mean[order]), np.asarray(past[order])


TABLE = _of_lone()


def assayed(waves: Complexes, dull: float = 0.0) -> Floats:
    """Return where first paths are told, in samples [n]; never sooner if dull."""
    found = _towards(waves, first_tops(waves, 0.0))
    if dull > 0.0:
        found = np.maximum(found, _towards(waves, first_tops(waves, dull)))
    return np.asarray(found - AHEAD)


def _towards(waves: Complexes, begin: Integers) -> Floats:
    """Return where pulses are, once ratios have led there from samples [n]; near these."""
    top = begin.astype(np.float64)
    for _ in range(OFTEN):
        step = np.interp(ratio(waves, top), *TABLE)
        top = (top + step.clip(-AT_MOST, AT_MOST)).clip(begin - 1.6, begin + 1.6)
    return np.asarray(top)


def _gate(off: Floats) -> Floats:
    """Return what share of power counts as the first pulse's, samples off its top [...]."""
    return planed(off + 0.4, 5.2)


def _energies() -> tuple[float, float]:
    """Return all energy of a lone pulse of height 1, and what its gate lets through."""
    off = np.arange(-9.0, 10.0) - np.arange(0.0, 1.0, 0.0625)[:, None]
    power = planed(off) ** 2
    return float(power.sum(axis=1).mean()), float((_gate(off) * power).sum(axis=1).mean())


WHOLE, GATED = _energies()
WITHIN = (-5.0, 120.0)  # samples from tops, of all that comes


def heights(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return how high first pulses are by their power through a gate, less noise's [n]."""
    share = _gate(PLACES - at[:, None] - AHEAD)
    noise = 2 * sigma**2 * share.sum(axis=1)
    power = (share * np.abs(waves) ** 2).sum(axis=1) - noise
    return np.asarray(np.sqrt(np.maximum(power, 0.15 * noise + 1e-12) / GATED))


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    first = heights(waves, at, sigma) ** 2
    off = PLACES - at[:, None] - AHEAD
    kept = ((off >= WITHIN[0]) & (off <= WITHIN[1])).astype(np.float64)
    power = (kept * (np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2)).sum(axis=1) / WHOLE
    return np.asarray(10 * np.log10(np.stack([np.maximum(power, 1.02 * first), first])))


class Assay:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `noise_by`, `count_by` [n]: factors of what is told;
    `longer_m` [n]: what ranges alone get; `dull`: see `first_tops`; `metres` [n]: of a sample.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        cir = [np.array([*table[name]], np.float64) for name in ("cir_i", "cir_q")]
        self.first: Complexes = cir[0] + 1j * cir[1]
        self.wave = self.first.copy()
        self.plain: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.plain.copy()
        self.noise_by, self.count_by = np.ones((2, self.rows))
        self.longer_m, self.dull = np.zeros(self.rows), 0.0
        self.metres: Floats = LIGHT_M_NS * table["sample_period_ns"].to_numpy(np.float64)
        self.at = assayed(self.first)

    def tally(self) -> Tally:
        """Return the rows as they are told by now."""
        return Tally(self.told(), self.case, self.rng)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([7305, what, self.case])

    def past(self, samples: float, within: float = 2.2) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later [n, k]."""
        part = ((PLACES - self.at[:, None] - samples) / within).clip(0.0, 1.0)
        return np.asarray(np.sin(0.5 * np.pi * part) ** 2)

    def direct(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.past(-5.0) * (1 - self.past(3.6))

    def came(self) -> Complexes:
        """Return what came by air [n, k], by how sure it is that this is no noise (Wiener)."""
        power = np.abs(self.wave) ** 2
        sure = (power - 8 * self.sigma[:, None] ** 2).clip(0.0) / (power + 1e-12)
        return np.asarray(self.past(-5.0) * np.sqrt(sure) * self.wave)

    def by_chance(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(-np.pi, np.pi, self.rows)))

    def echo(self, of: Complexes, share: Floats | Complexes, samples: Floats) -> None:
        """Let a share [n] of something [n, k] come once more, so many samples later [n]."""
        rows = np.flatnonzero(np.abs(share) > 1e-9)
        if rows.size:
            self.wave[rows] += share[rows, None] * rolled_later(of[rows], samples[rows])

    def jingle(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * jingling(self.rng, self.rows)

    def dim(self, db: Floats) -> None:
        """Let what comes lose dB <= 0 [n, k]; the tag's own noise stays."""
        kept = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = kept * self.wave
        self.jingle(self.sigma[:, None] * np.sqrt(1 - kept**2))

    def roar(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (np.maximum(db, 0.0) / 20)
        self.jingle((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.noise_by = self.sigma * by, self.noise_by * by

    def count_less(self, db: Floats) -> None:
        """Sum fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        by = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = by[:, None] * self.wave
        self.jingle((self.sigma * np.sqrt(by * (1 - by)))[:, None])
        root = np.sqrt(by)
        self.sigma, self.noise_by = self.sigma * root, self.noise_by * root
        self.count_by = self.count_by * by

    def exact(self, toll: Toll) -> None:
        """Take of waveforms what is taken of rows."""
        none = np.zeros(self.rows)
        self.longer_m = self.longer_m + toll.longer_m
        level, first = none + toll.level_db, none + toll.first_db
        if level.any() or first.any():
            self.dim(level[:, None] * self.past(-5.0) + first[:, None] * self.direct())
        if np.any(toll.noise_db):
            self.roar(none + toll.noise_db)
        if np.any(toll.count_db):
            self.count_less(none + toll.count_db)

    def told(self) -> pd.DataFrame:
        """Return the table as the assay tells it by now."""
        table, begun = self.table, self.table["first_path_index"].to_numpy(np.float64)
        by = assayed(self.wave, self.dull) - self.at
        index = (begun + by).clip(4.0, WIDE_SAMPLES - 8.0)
        change = levels_db(self.wave, index, self.sigma) - 20 * np.log10(self.count_by)
        change = change - levels_db(self.first, begun, self.plain)
        error = table["error_m"].to_numpy(np.float64) + self.metres * by + self.longer_m
        return table.assign(
            error_m=error, range_m=table["true_range_m"] + error, first_path_index=index,
            rx_power_dbm=table["rx_power_dbm"] + change[0],
            first_path_power_dbm=table["first_path_power_dbm"] + change[1],
            noise_std=table["noise_std"] * self.noise_by,
            preamble_count=table["preamble_count"] * self.count_by,
            cir_i=[*self.wave.real], cir_q=[*self.wave.imag],
        )  # fmt: skip
