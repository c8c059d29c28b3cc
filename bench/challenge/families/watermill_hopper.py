"""The watermill's receiver: what happens to waveforms, and what a hopper tells of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses rise sooner than
they fall (a secant of two rates). Noise is told by the median of power before. Two samples in a
row over a bar begin a first path (two of two, as radars count hits); from there it is followed to
its top, and told where it first had a part of that height, on a straight line between logarithms
of sizes, put right by where between samples that is. Levels of first paths are of the three
samples after these, as a DW1000's are.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.watermill_race import Due, Grist

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 40, 202
SAMPLE_NS = 1.1268
"""Of the mill's own hatches; other tables say theirs."""
LIGHT_M_NS = 0.299792458
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
RISES, FALLS = 0.84, 1.05  # samples in which pulses rise and fall e-fold, far from their tops
BESIDE = (0.32, -0.17, -0.2)  # noise by that 1, 2 and 3 samples off [DW1000]
BEFORE = (3, 30)  # samples that noise is told by
OVER, OF_MOST = 12.0, 0.011  # bars of power: of noise's; of the most
BLUNT, HIGHEST = (0.12, 0.17), 0.8  # of the most, bars of blunt ones; highest of all
EDGES, CLIMBS = 6, 6  # samples at either end that are passed over; from a bar to a top
HALF, BACK = 0.5, 5  # of a top's height, where paths are told; samples that these are sought in
PLACES: Floats = np.arange(float(WIDE_SAMPLES))
OF_TOP = float(np.log(RISES / FALLS) / (1 / RISES + 1 / FALLS))  # where secants of two rates do top


def heaped(off: Floats) -> Floats:
    """Return how high pulses are so many samples off their tops [...]."""
    past = np.clip(off, -60.0, 60.0) - OF_TOP
    most = np.exp(OF_TOP / RISES) + np.exp(-OF_TOP / FALLS)
    return np.asarray(most / (np.exp(-past / RISES) + np.exp(past / FALLS)))


def grains(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return heaped(PLACES - top[:, None])


def _filter() -> Floats:
    """Return weights whose noise is beside itself as BESIDE says (Fejer and Riesz, by roots)."""
    beside = np.array([*BESIDE[::-1], 1.0, *BESIDE])
    roots = np.roots(beside)
    weights = np.real(np.poly(roots[np.argsort(np.abs(roots))[:3]]))
    return np.asarray(weights / np.linalg.norm(weights))


WEIGHTS = _filter()


def trundling(rng: np.random.Generator, rows: int, samples: int = WIDE_SAMPLES) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as BESIDE says [rows, samples]."""
    white = rng.standard_normal((2, rows, samples + len(WEIGHTS) - 1))
    even = white[0] + 1j * white[1]
    made = sum(w * even[:, k : k + samples] for k, w in enumerate(WEIGHTS))
    return np.asarray(made, np.complex128)


TAPS: Floats = np.arange(-7.0, 9.0)


def ground_later(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: a sinc in Kaiser's window (1974), 16 wide."""
    late = samples.clip(0.0, waves.shape[1] + 20.0)
    whole = np.floor(late).astype(np.int64)
    part, made = late - whole, np.zeros(waves.shape, np.complex128)
    for tap in TAPS:
        off = tap - part
        share = np.sinc(off) * np.i0(5.0 * np.sqrt((1 - (off / 8.2) ** 2).clip(0.0))) / np.i0(5.0)
        from_ = np.arange(waves.shape[1]) - (whole + int(tap))[:, None]
        there = (from_ >= 0) & (from_ < waves.shape[1])
        taken = np.take_along_axis(waves, from_.clip(0, waves.shape[1] - 1), axis=1)
        made += share[:, None] * np.where(there, taken, 0.0)
    return made


def hush(waves: Complexes) -> Floats:
    """Return noise's mean power by the median of what comes before [n] (of an exponential)."""
    early = np.abs(waves[:, BEFORE[0] : BEFORE[1]]) ** 2
    return np.asarray(np.median(early, axis=1) / np.log(2.0) + 1e-12)


def begun(waves: Complexes, blunt: float) -> Integers:
    """Return the sample of the first top after two samples over a bar [n]; bars by BLUNT if so."""
    power = np.abs(waves) ** 2
    power[:, :EDGES] = power[:, -EDGES:] = 0.0
    most = power.max(axis=1)
    bar = np.maximum(OVER * hush(waves), OF_MOST * most)
    if blunt > 0.0:
        bar = np.maximum(bar, (BLUNT[0] + BLUNT[1] * blunt) * most)
    over = power >= np.minimum(bar, HIGHEST * most)[:, None]
    both = over[:, :-1] & over[:, 1:]
    first = np.where(both.any(axis=1), both.argmax(axis=1), power.argmax(axis=1))
    near = np.take_along_axis(power, (first[:, None] + np.arange(CLIMBS + 2)).clip(
        max=waves.shape[1] - 1), axis=1)  # fmt: skip
    falls = np.diff(near, axis=1) < 0
    return np.asarray(first + np.where(falls.any(axis=1), falls.argmax(axis=1), CLIMBS), np.int64)


def _at_part(waves: Complexes, top: Integers) -> Floats:
    """Return where sizes first have HALF of what they have at tops, by their logarithms [n]."""
    size = np.log(np.abs(waves) + 1e-12)
    near = np.take_along_axis(size, top[:, None] + np.arange(-1, 2), axis=1)
    bend = (near[:, 0] - 2 * near[:, 1] + near[:, 2]).clip(max=-1e-3)
    over = ((near[:, 2] - near[:, 0]) ** 2 / (-8 * bend)).clip(0.0, 0.4)
    goal = near[:, 1] + over + np.log(HALF)
    rise = np.take_along_axis(size, top[:, None] + np.arange(-BACK, 1), axis=1)
    under = rise[:, :-1] < goal[:, None]
    last = np.where(under.any(axis=1), BACK - 1 - under[:, ::-1].argmax(axis=1), 0)
    low, high = (np.take_along_axis(rise, last[:, None] + k, axis=1)[:, 0] for k in (0, 1))
    part = ((goal - low) / np.maximum(high - low, 1e-6)).clip(0.0, 1.0)
    return np.asarray(top - BACK + last + part)


def _of_lone() -> tuple[float, Floats, Floats]:
    """Return how far ahead of tops lone pulses are told, and what is put right by parts [k]."""
    top = 80.0 + np.arange(0.0, 1.0, 1 / 128)
    wave = grains(top).astype(np.complex128)
    told = _at_part(wave, np.abs(wave).argmax(axis=1))
    ahead = float((top - told).mean())
    order = np.argsort(told % 1.0)
    return ahead, (told % 1.0)[order], (top - ahead - told)[order]


AHEAD, PARTS, RIGHTED = _of_lone()
"""AHEAD: samples from first paths, as these are told, to tops."""


def weighed(waves: Complexes, blunt: float = 0.0) -> Floats:
    """Return where first paths are told, in samples [n]; never sooner if blunt."""
    found = _at_part(waves, begun(waves, 0.0))
    if blunt > 0.0:
        found = np.maximum(found, _at_part(waves, begun(waves, blunt)))
    return np.asarray(found + np.interp(found % 1.0, PARTS, RIGHTED, period=1.0))


THREE = np.arange(1, 4)  # samples after first paths that these' levels are of
WITHIN = (-4.0, 105.0)  # samples from first paths, of all that comes


def _energies() -> tuple[float, float]:
    """Return the energy of a lone pulse of height 1, and that of its three samples."""
    at = np.arange(0.0, 1.0, 1 / 64)[:, None]
    three = heaped(THREE - at - AHEAD)
    every = heaped(np.arange(-14.0, 18.0) - at - AHEAD)
    return float((every**2).sum(axis=1).mean()), float((three**2).sum(axis=1).mean())


WHOLE, OF_THREE = _energies()


def heights(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return how high first pulses are by three samples' power, less noise's [n]."""
    which = (np.floor(at).astype(np.int64)[:, None] + THREE).clip(0, waves.shape[1] - 1)
    noise = 2 * len(THREE) * sigma**2
    power = (np.abs(np.take_along_axis(waves, which, axis=1)) ** 2).sum(axis=1) - noise
    return np.asarray(np.sqrt(np.maximum(power, 0.12 * noise + 1e-12) / OF_THREE))


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    first = heights(waves, at, sigma) ** 2
    off = PLACES - at[:, None]
    kept = (off >= WITHIN[0]) & (off <= WITHIN[1])
    power = (kept * (np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2)).sum(axis=1) / WHOLE
    return np.asarray(10 * np.log10(np.stack([np.maximum(power, 1.03 * first), first])))


class Hopper:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `noise_by`, `count_by` [n]: factors of what is told;
    `late_m` [n]: what ranges alone get; `blunt`: see `begun`; `metres` [n]: of a sample.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        real, imag = (np.stack([*table[name]]).astype(np.float64) for name in ("cir_i", "cir_q"))
        self.plain: Complexes = real + 1j * imag
        self.wave = self.plain.copy()
        self.still: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.still.copy()
        self.noise_by, self.count_by = np.ones(self.rows), np.ones(self.rows)
        self.late_m, self.blunt = np.zeros(self.rows), 0.0
        self.metres: Floats = LIGHT_M_NS * table["sample_period_ns"].to_numpy(np.float64)
        self.at = weighed(self.plain)

    def grist(self) -> Grist:
        """Return the rows as they are told by now."""
        return Grist(self.told(), self.case, self.rng)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([8405, self.case, what])

    def after(self, samples: float, over: float = 1.8) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later, smoothly [n, k]."""
        part = ((PLACES - self.at[:, None] - samples) / over).clip(0.0, 1.0)
        return np.asarray(part**2 * (3 - 2 * part))

    def straight(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.after(-5.5) - self.after(4.0)

    def came(self) -> Complexes:
        """Return what came by air [n, k]: what noise may be is left out, softly."""
        power = np.abs(self.wave) ** 2
        sure = (1 - 9 * self.sigma[:, None] ** 2 / (power + 1e-12)).clip(0.0)
        return np.asarray(self.after(-5.5) * sure**0.7 * self.wave)

    def turns(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def repeat(self, of: Complexes, share: Floats | Complexes, samples: Floats) -> None:
        """Let a share [n] of something [n, k] come once more, so many samples later [n]."""
        there = np.flatnonzero(np.abs(share) > 1e-9)
        if len(there):
            late = ground_later(of[there], samples[there])
            self.wave[there] += np.asarray(share)[there, None] * late

    def hiss(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * trundling(self.rng, self.rows)

    def lose(self, db: Floats) -> None:
        """Let what comes lose dB <= 0 [n, k]; the hatch's own noise stays."""
        kept = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = kept * self.wave
        self.hiss(self.sigma[:, None] * np.sqrt(1 - kept**2))

    def louder(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (np.maximum(db, 0.0) / 20)
        self.hiss((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.noise_by = self.sigma * by, self.noise_by * by

    def sum_less(self, db: Floats) -> None:
        """Sum fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        by = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = by[:, None] * self.wave
        self.hiss((self.sigma * np.sqrt(by - by**2))[:, None])
        self.sigma, self.noise_by = self.sigma * np.sqrt(by), self.noise_by * np.sqrt(by)
        self.count_by = self.count_by * by

    def pay(self, due: Due) -> None:
        """Take of waveforms what rows owe."""
        none = np.zeros(self.rows)
        self.late_m = self.late_m + due.late_m
        level, first = none + due.level_db, none + due.first_db
        if level.any() or first.any():
            self.lose(level[:, None] * self.after(-5.5) + first[:, None] * self.straight())
        if np.any(due.noise_db):
            self.louder(none + due.noise_db)
        if np.any(due.count_db):
            self.sum_less(none + due.count_db)

    def told(self) -> pd.DataFrame:
        """Return the table as the hopper tells it by now."""
        table = self.table
        index = table["first_path_index"].to_numpy(np.float64)
        by = weighed(self.wave, self.blunt) - self.at
        now = (index + by).clip(4.0, WIDE_SAMPLES - 8.0)
        change = levels_db(self.wave, now, self.sigma) - levels_db(self.plain, index, self.still)
        change = change - 20 * np.log10(self.count_by)
        error = table["error_m"].to_numpy(np.float64) + self.metres * by + self.late_m
        return table.assign(
            error_m=error, range_m=table["true_range_m"] + error, first_path_index=now,
            rx_power_dbm=table["rx_power_dbm"] + change[0],
            first_path_power_dbm=table["first_path_power_dbm"] + change[1],
            noise_std=table["noise_std"] * self.noise_by,
            preamble_count=table["preamble_count"] * self.count_by,
            cir_i=[*self.wave.real], cir_q=[*self.wave.imag],
        )  # fmt: skip
