"""The ropewalk's receiver: what happens to waveforms, and what a strut's telltale says of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses are fourth
powers of a parabola. Of what fits these at whole samples, the first top counts that is over a bar
of noise and of the highest; where between samples it is, is read off a table of what three
neighbours of a lone pulse make. First paths are told AHEAD of tops.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.ropewalk_walk import Due, Hank

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 41, 212
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
HALF, POWER = 3.05, 4  # samples from a pulse's top to its ends; of the parabola
AHEAD = 1.5  # samples by which first paths are told ahead of tops
ALIKE = (1.0, 0.32, -0.17, -0.2)  # noise beside itself, samples off [DW1000]
NOISE, HIGHEST = 6.6, 0.1  # bars: of noise's part; of the highest
DEAF, MOST = (2.4, 4.6), 0.92  # by which bars of deaf ones are higher; highest of bars
SIDES = 7  # samples at either end that are not looked at
BESIDE: Integers = np.arange(-8, 9)  # of what fills in between samples
PLACES: Floats = np.arange(float(WIDE_SAMPLES))


def _tuft(off: Floats) -> Floats:
    """Return a pulse's height so many samples off its top [...]."""
    return np.asarray((1 - (off / HALF) ** 2).clip(0.0) ** POWER)


def tufts(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return _tuft(PLACES - top[:, None])


def _weights() -> Floats:
    """Return by what white noise is weighed, so that it is beside itself as ALIKE.

    Their spectrum has no phase: a root of that of ALIKE (which is nowhere less than nothing).
    """
    turn = 2 * np.pi * np.arange(64) / 64
    apart = np.arange(1, len(ALIKE))
    power = 1 + 2 * np.cos(np.outer(turn, apart)) @ np.array(ALIKE[1:])
    return np.asarray(np.roll(np.fft.ifft(np.sqrt(power.clip(0.0))).real, 32))


WEIGHTS = _weights()


def creaking(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, WIDE_SAMPLES]."""
    room = 1 << (WIDE_SAMPLES + len(WEIGHTS)).bit_length()
    white = rng.standard_normal((rows, room, 2)) @ np.array([1.0, 1.0j])
    made = np.fft.ifft(np.fft.fft(white, axis=1) * np.fft.fft(WEIGHTS, room), axis=1)
    return np.asarray(made[:, len(WEIGHTS) : len(WEIGHTS) + WIDE_SAMPLES])


def strung_out(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: between these, by sincs under a cosine's hood."""
    late = samples.clip(0.0, WIDE_SAMPLES + 20.0)
    whole = np.rint(late).astype(np.int64)
    room = WIDE_SAMPLES + 30
    wide = np.pad(waves, ((0, 0), (room, 9)))
    columns = np.arange(WIDE_SAMPLES) + room - whole[:, None]
    made = np.zeros(waves.shape, np.complex128)
    for beside in BESIDE.tolist():
        off = beside + whole - late
        hood = np.cos(0.5 * np.pi * (off / 9.0).clip(-1.0, 1.0)) ** 2
        there = np.take_along_axis(wide, columns - beside, axis=1)
        made += (np.sinc(off) * hood)[:, None] * there
    return np.where(whole[:, None] - 9 < PLACES, made, 0.0)


MODEL: Floats = _tuft(np.arange(-3.0, 4.0))
MODEL_POWER = float((MODEL**2).sum())


def fitted(waves: Complexes) -> Complexes:
    """Return heights of pulses that fit waveforms best, at whole samples [n, k]."""
    reach = len(MODEL) // 2
    wide = np.pad(waves, ((0, 0), (reach, reach)))
    windows = np.lib.stride_tricks.sliding_window_view(wide, len(MODEL), axis=1)
    return np.asarray(windows @ (MODEL / MODEL_POWER))


OF_NOISE = float(fitted(creaking(np.random.default_rng(4104), 90))[:, 9:-9].real.std())
"""How parts of heights scatter that fit noise whose parts scatter by 1."""


def _first_top(sizes: Floats, sigma: Floats, deaf: float) -> Integers:
    """Return the first top that is over a bar [n], which is higher if deaf, by DEAF."""
    inner = sizes[:, SIDES:-SIDES]
    most = inner.max(axis=1, keepdims=True)
    bar = np.maximum(NOISE * OF_NOISE * sigma[:, None], HIGHEST * most)
    bar = np.minimum(bar * (DEAF[0] + DEAF[1] * deaf if deaf > 0.0 else 1.0), MOST * most)
    rises = inner >= sizes[:, SIDES - 1 : -SIDES - 1]
    falls = inner > sizes[:, SIDES + 1 : 1 - SIDES]
    top = rises & falls & (inner >= bar)
    found = np.where(top.any(axis=1), top.argmax(axis=1), inner.argmax(axis=1))
    return np.asarray(found + SIDES, np.int64)


def _leaning(three: Floats) -> Floats:
    """Return how three sizes lean [n], as a parabola's top through these would [n, 3]."""
    bend = three[:, 0] - 2 * three[:, 1] + three[:, 2]
    return np.asarray(0.5 * (three[:, 0] - three[:, 2]) / np.minimum(bend, -1e-12))


OFF: Floats = np.linspace(-0.8, 0.8, 321)
LEANS = _leaning(np.abs(fitted(tufts(100.0 + OFF).astype(np.complex128)))[:, 99:102])
"""How a lone pulse leans whose top is OFF a sample."""


def _tops(sizes: Floats, at: Integers) -> Floats:
    """Return where tops are between samples, near those that are given [n]."""
    near = at.clip(1, sizes.shape[1] - 2)
    three = np.take_along_axis(sizes, near[:, None] + np.arange(-1, 2), axis=1)
    return np.asarray(near + np.interp(_leaning(three), LEANS, OFF))


def first_paths(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return places AHEAD of the first top, in samples [n]; never sooner if deaf."""
    sizes = np.abs(fitted(waves))
    found = [_tops(sizes, _first_top(sizes, sigma, one)) for one in {0.0, deaf}]
    return np.asarray(np.max(found, axis=0) - AHEAD)


WITHIN = (-5.0, 96.0)  # samples from first paths of all energy


def highs(waves: Complexes, at: Floats) -> Floats:
    """Return how high pulses are that fit at first paths [n]."""
    model = tufts(at + AHEAD)
    return np.asarray(np.abs((waves * model).sum(axis=1)) / (model**2).sum(axis=1).clip(1e-9))


LONE = float((_tuft(np.arange(-8.0, 9.0, 0.01)) ** 2).sum() * 0.01)


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    off = PLACES - at[:, None]
    there = (off > WITHIN[0]) & (off < WITHIN[1])
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    every = np.where(there, power, 0.0).sum(axis=1) / LONE
    first = (highs(waves, at) ** 2 - 2 * (OF_NOISE * sigma) ** 2).clip(0.3 * sigma**2)
    return np.asarray(10 * np.log10(np.stack([np.maximum(every, 1.02 * first), first])))


class Telltale:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `noise_by`, `count_by` [n]: factors of what is told;
    `late_m` [n]: what ranges alone get; `deaf`: see `_first_top`.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        self.plain: Complexes = np.array([*table["cir_i"]]) + 1j * np.array([*table["cir_q"]])
        self.wave = self.plain
        self.calm: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.calm
        self.noise_by, self.count_by = np.ones(self.rows), np.ones(self.rows)
        self.late_m, self.deaf = np.zeros(self.rows), 0.0
        self.at = first_paths(self.plain, self.calm)
        self.off: Floats = PLACES - self.at[:, None]

    def hank(self) -> Hank:
        """Return the rows as they are told by now."""
        return Hank(self.told(), self.case, self.rng)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([4106, what, self.case])

    def from_on(self, samples: float, within: float = 2.2) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later, by half a cosine [n, k].

        Soft, so that nothing rings.
        """
        part = ((self.off - samples) / within).clip(0.0, 1.0)
        return 0.5 - 0.5 * np.cos(np.pi * part)

    def by_air(self) -> Complexes:
        """Return what came by air [n, k]: what stands out of noise, by Wiener's share of it."""
        power = np.abs(self.wave) ** 2
        share = (1 - 9 * self.sigma[:, None] ** 2 / np.maximum(power, 1e-12)).clip(0.0)
        return np.asarray(self.wave * self.from_on(-4.6) * share)

    def straight(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.from_on(-4.6) * (1 - self.from_on(3.8, 2.6))

    def turned(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(-np.pi, np.pi, self.rows)))

    def again(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come once more, so many samples later [n]."""
        self.wave = self.wave + part[:, None] * strung_out(what, samples)

    def creak(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * creaking(self.rng, self.rows)

    def dim(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the telltale's own noise stays."""
        left = (10 ** (db / 20)).clip(max=1.0)
        self.wave = left * self.wave
        self.creak(self.sigma[:, None] * np.sqrt(1 - left**2))

    def hiss(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = (10 ** (db / 20)).clip(1.0)
        self.creak((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.noise_by = by * self.sigma, by * self.noise_by

    def tally(self, db: Floats) -> None:
        """Add up fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        by = (10 ** (db / 20)).clip(max=1.0)
        self.wave = by[:, None] * self.wave
        self.creak((self.sigma * np.sqrt(by - by**2))[:, None])
        self.sigma, self.noise_by = self.sigma * np.sqrt(by), self.noise_by * np.sqrt(by)
        self.count_by = self.count_by * by

    def owe(self, due: Due) -> None:
        """Let waveforms owe what rows do."""
        dim, first, hiss, tally = (
            np.broadcast_to(db, self.rows)
            for db in (due.dim_db, due.first_db, due.hiss_db, due.tally_db)
        )
        self.late_m = self.late_m + due.late_m
        if dim.any() or first.any():
            self.dim(self.from_on(-4.6) * dim[:, None] + self.straight() * first[:, None])
        if hiss.any():
            self.hiss(hiss)
        if tally.any():
            self.tally(tally)

    def told(self) -> pd.DataFrame:
        """Return the table as the telltale says it by now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        moved = first_paths(self.wave, self.sigma, self.deaf) - self.at
        index = (was + moved).clip(5.0, WIDE_SAMPLES - 9.0)
        more_db = levels_db(self.wave, index, self.sigma) - levels_db(self.plain, was, self.calm)
        every, first = more_db - 20 * np.log10(self.count_by)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * moved + self.late_m
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
