"""The planetarium's receiver: what happens to waveforms, and what a cove's almanac says of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses are fourth
powers of a cosine. Sizes are looked at between samples too, STEPS to each; of the first top that
is over a bar of noise and of the highest, it is told where it rises through half of itself.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.planetarium_dome import Fee, Seating

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 40, 210
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
HALF, POWER = 3.2, 4  # samples from a pulse's top to its ends; of the cosine
AHEAD = float(2 * HALF / np.pi * np.arccos(0.5 ** (1 / POWER)))
"""Samples from where a pulse is half as high to its top."""
ALIKE = (1.0, 0.32, -0.17, -0.2)  # noise beside itself, samples off [DW1000]
BURNS = 48  # samples of noise until none remembers how it began
NOISE, HIGHEST = 6.2, 0.1  # bars: of noise's part; of the highest
DEAF, MOST = (2.3, 4.4), 0.92  # by which bars of deaf ones are higher; highest of bars
STEPS, TAPS = 4, 7  # looks at each sample; samples to either side that these are made of
SIDES = 7 * STEPS  # looks at either end that are passed over
PLACES: Floats = np.arange(float(WIDE_SAMPLES))


def _glow(off: Floats) -> Floats:
    """Return a pulse's height so many samples off its top [...]."""
    return np.asarray(np.cos(0.5 * np.pi * (off / HALF).clip(-1.0, 1.0)) ** POWER)


def glows(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return _glow(PLACES - top[:, None])


def _foretold() -> tuple[Floats, float]:
    """Return what is foretold of noise by the three before, and how what is new scatters.

    So that it is beside itself as ALIKE (Yule 1927, Walker 1931).
    """
    alike = np.array([[ALIKE[abs(i - j)] for i in range(3)] for j in range(3)])
    weights = np.linalg.solve(alike, np.array(ALIKE[1:]))
    return weights, float(np.sqrt(1 - weights @ np.array(ALIKE[1:])))


WEIGHTS, NEW = _foretold()


def starlight(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, WIDE_SAMPLES]."""
    made = NEW * (rng.standard_normal((rows, BURNS + WIDE_SAMPLES, 2)) @ np.array([1.0, 1.0j]))
    for k in range(3, made.shape[1]):
        made[:, k] += made[:, k - 3 : k] @ WEIGHTS[::-1]
    return np.asarray(made[:, BURNS:])


def set_later(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: phases of what these are made of turn."""
    late, room = samples.clip(0.0, WIDE_SAMPLES + 12.0), 4 * 128
    pitch = 2 * np.pi * np.fft.fftfreq(room)
    whole = np.fft.fft(waves, room, axis=1) * np.exp(-1j * pitch * late[:, None])
    made = np.fft.ifft(whole, axis=1)[:, :WIDE_SAMPLES]
    return (
        np.where(np.floor(late)[:, None] - 8 < PLACES, made, 0.0) * (late < WIDE_SAMPLES)[:, None]
    )


def _between() -> Floats:
    """Return by what samples about count in what is between these [2 TAPS + 1, STEPS]."""
    off = np.arange(STEPS) / STEPS - np.arange(-TAPS, TAPS + 1)[:, None]
    return np.asarray(np.sinc(off) * np.cos(0.5 * np.pi * off / (TAPS + 1)) ** 2)


BETWEEN = _between()


def looked_at(waves: Complexes) -> Floats:
    """Return sizes of waveforms, STEPS to each sample [n, STEPS k]."""
    wide = np.pad(waves, ((0, 0), (TAPS, TAPS)))
    made = np.lib.stride_tricks.sliding_window_view(wide, 2 * TAPS + 1, axis=1) @ BETWEEN
    return np.abs(made).reshape(len(waves), -1)


def _first_top(sizes: Floats, sigma: Floats, deaf: float) -> Integers:
    """Return the first top that is over a bar [n], which is higher if deaf, by DEAF."""
    inner = sizes[:, SIDES:-SIDES]
    most = inner.max(axis=1)
    bar = np.maximum(NOISE * sigma, HIGHEST * most)
    if deaf > 0.0:
        bar = bar * (DEAF[0] + DEAF[1] * deaf)
    top = inner >= np.minimum(bar, MOST * most)[:, None]
    top &= (inner >= sizes[:, SIDES - 1 : -SIDES - 1]) & (inner > sizes[:, SIDES + 1 : 1 - SIDES])
    found = np.where(top.any(axis=1), top.argmax(axis=1), inner.argmax(axis=1))
    return np.asarray(found + SIDES, np.int64)


def _risen(sizes: Floats, top: Integers) -> Floats:
    """Return where sizes rise through half of their top, in samples [n]."""
    back = np.arange(3 * STEPS + 1)
    near = np.take_along_axis(sizes, top[:, None] - back, axis=1) / sizes[np.arange(len(top)), top][
        :, None
    ].clip(1e-12)
    below = near < 0.5
    first = np.where(below.any(axis=1), below.argmax(axis=1), 1)
    low, high = (np.take_along_axis(near, one[:, None], axis=1)[:, 0] for one in (first, first - 1))
    part = ((0.5 - low) / np.maximum(high - low, 1e-9)).clip(0.0, 1.0)
    found = np.where(below.any(axis=1), top - first + part, top - AHEAD * STEPS)
    return np.asarray(found / STEPS)


def risings(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return where the first top rises, in samples [n]; never sooner if deaf."""
    sizes = looked_at(waves)
    found = [_risen(sizes, _first_top(sizes, sigma, one)) for one in {0.0, deaf}]
    return np.asarray(np.max(found, axis=0))


WITHIN = (-4.5, 98.0)  # samples from first paths of all energy


def brights(waves: Complexes, at: Floats) -> Floats:
    """Return how high pulses are that fit at first paths [n]."""
    model = glows(at + AHEAD)
    return np.asarray(np.abs((waves * model).sum(axis=1)) / (model**2).sum(axis=1).clip(1e-9))


LONE = float((_glow(np.arange(-8.0, 8.0, 0.01)) ** 2).sum() * 0.01)


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    off = PLACES - at[:, None]
    there = (off > WITHIN[0]) & (off < WITHIN[1])
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    every = np.where(there, power, 0.0).sum(axis=1) / LONE
    first = (brights(waves, at) ** 2 - sigma**2 / LONE).clip(0.3 * sigma**2)
    return np.asarray(10 * np.log10(np.stack([np.maximum(every, 1.02 * first), first])))


class Almanac:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `noise_by`, `count_by` [n]: factors of what is told;
    `late_m` [n]: what ranges alone get; `deaf`: see `_first_top`.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        parts = (np.stack([*table[f"cir_{part}"]]) for part in "iq")
        self.plain: Complexes = np.asarray(next(parts) + 1j * next(parts))
        self.wave = self.plain
        self.calm: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.calm
        self.noise_by, self.count_by = np.ones(self.rows), np.ones(self.rows)
        self.late_m, self.deaf = np.zeros(self.rows), 0.0
        self.at = risings(self.plain, self.calm)
        self.off: Floats = PLACES - self.at[:, None]

    def seating(self) -> Seating:
        """Return the rows as they are told by now."""
        return Seating(self.told(), self.case, self.rng)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([5206, what, self.case])

    def after(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later, by a cubic [n, k].

        Soft, so that nothing rings.
        """
        part = ((self.off - samples) / within).clip(0.0, 1.0)
        return np.asarray(part**2 * (3 - 2 * part))

    def by_air(self) -> Complexes:
        """Return what came by air [n, k]: what is over noise, the more of it the more it is."""
        noise = 3 * self.sigma[:, None] / np.abs(self.wave).clip(1e-9)
        return np.asarray(self.wave * self.after(-4.0) * (1 - noise**3).clip(0.0))

    def direct(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.after(-4.0) * (1 - self.after(3.4, 2.4))

    def phases(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def return_of(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come once more, so many samples later [n]."""
        self.wave = self.wave + part[:, None] * set_later(what, samples)

    def glimmer(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * starlight(self.rng, self.rows)

    def fade(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the almanac's own noise stays."""
        left = (10 ** (db / 20)).clip(max=1.0)
        self.wave = left * self.wave
        self.glimmer(self.sigma[:, None] * np.sqrt(1 - left**2))

    def louder(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = (10 ** (db / 20)).clip(1.0)
        self.glimmer((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.noise_by = by * self.sigma, by * self.noise_by

    def count_less(self, db: Floats) -> None:
        """Add up fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        by = (10 ** (db / 20)).clip(max=1.0)
        self.wave = by[:, None] * self.wave
        self.glimmer((self.sigma * np.sqrt(by - by**2))[:, None])
        self.sigma, self.noise_by = self.sigma * np.sqrt(by), self.noise_by * np.sqrt(by)
        self.count_by = self.count_by * by

    def pay(self, fee: Fee) -> None:
        """Let waveforms pay what rows do."""
        every, first, noise, count = (
            np.broadcast_to(db, self.rows)
            for db in (fee.all_db, fee.first_db, fee.noise_db, fee.count_db)
        )
        self.late_m = self.late_m + fee.late_m
        if every.any() or first.any():
            self.fade(self.after(-4.0) * every[:, None] + self.direct() * first[:, None])
        if noise.any():
            self.louder(noise)
        if count.any():
            self.count_less(count)

    def told(self) -> pd.DataFrame:
        """Return the table as the almanac says it by now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        moved = risings(self.wave, self.sigma, self.deaf) - self.at
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
