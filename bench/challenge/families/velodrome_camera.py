"""The velodrome's receiver: what happens to waveforms, and what a post's camera tells of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses are fifth powers
of a parabola; first paths are told AHEAD of where, about the first top that stands out, phases of
what is seen through a slit turn evenly with pitch: by the group's delay.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.velodrome_track import Handicap, Race

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 46, 246
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
HALF = 3.35  # samples from a pulse's top to either end
AHEAD = 1.25  # samples before tops that first paths are told, as chips do
SLIT, PITCH, LOOKS = 3.5, 0.35, 9  # samples; radians a sample; how often the slit is moved
MOST = 1.4  # samples that a slit is moved off a top
STANDS, OF_TOP = 6.2, 0.14  # what counts: times what noise leaves; of the highest
SOONEST, EDGE = 84, 9  # samples before the highest from which on tops count; none at ends
EVEN: Floats = np.array([0.25, 0.5, 0.25])  # by which what is looked at is smoothed
ALIKE: Floats = np.array([1.0, 0.32, -0.17, -0.2])  # noise beside itself, samples off [DW1000]
PLACES: Floats = np.arange(float(WIDE_SAMPLES))


def bulges(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    part = (PLACES - top[:, None]) / HALF
    return np.asarray((1 - part**2).clip(0.0) ** 5)


def _root() -> Floats:
    """Return the even root of how noise is beside itself [WIDE_SAMPLES, WIDE_SAMPLES]."""
    off = np.abs(PLACES[:, None] - PLACES).astype(np.int64)
    beside = np.where(off < len(ALIKE), ALIKE[off.clip(max=len(ALIKE) - 1)], 0.0)
    sizes, ways = np.linalg.eigh(beside)
    return np.asarray((ways * np.sqrt(sizes.clip(0.0))) @ ways.T)


ROOT = _root()


def humming(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, WIDE_SAMPLES]."""
    real, imag = rng.normal(size=(2, rows, WIDE_SAMPLES))
    return np.asarray((real + 1j * imag) @ ROOT)


def _slopes(waves: Complexes) -> Complexes:
    """Return how fast waves change at samples, by differences of the eighth order [n, k]."""
    far = np.pad(waves, ((0, 0), (4, 4)))
    weights = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
    count = waves.shape[1]
    steps = (
        by * (far[:, 4 + k : 4 + k + count] - far[:, 4 - k : 4 - k + count])
        for k, by in enumerate(weights, 1)
    )
    return np.asarray(sum(steps))


def dropped_back(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by cubics through values and slopes (Hermite)."""
    late = samples.clip(0.0, WIDE_SAMPLES + 8.0)
    whole = np.ceil(late).astype(np.int64)
    part = (whole - late)[:, None]
    ahead = WIDE_SAMPLES + 12
    begin = ahead - whole[:, None] + np.arange(WIDE_SAMPLES)
    padded = np.pad(waves, ((0, 0), (ahead, 4)))
    slopes = np.pad(_slopes(waves), ((0, 0), (ahead, 4)))
    low, high = (np.take_along_axis(padded, begin + k, axis=1) for k in (0, 1))
    rise, fall = (np.take_along_axis(slopes, begin + k, axis=1) for k in (0, 1))
    turn = part**2 * (3 - 2 * part)
    made = (1 - turn) * low + turn * high
    return np.asarray(made + part * (1 - part) * ((1 - part) * rise - part * fall))


def _smooth(waves: Complexes) -> Complexes:
    padded = np.pad(waves, ((0, 0), (1, 1)))
    return np.asarray(sum(by * padded[:, k : k + waves.shape[1]] for k, by in enumerate(EVEN)))


OF_NOISE = float(_smooth(humming(np.random.default_rng(3304), 60)).real[:, 9:-9].std())
"""How parts of smoothed noise scatter whose own parts scatter by 1."""


def seen(waves: Complexes, at: Floats, pitch: float) -> Complexes:
    """Return what a slit at samples [n] lets through of a pitch, as seen from its middle [n]."""
    inner = np.rint(at).astype(np.int64).clip(5, waves.shape[1] - 6)[:, None] + np.arange(-4, 5)
    off = inner - at[:, None]
    slit = np.cos(0.5 * np.pi * (off / SLIT).clip(-1.0, 1.0)) ** 2
    through = np.take_along_axis(waves, inner, axis=1) * slit
    return np.asarray((through * np.exp(-1j * pitch * off)).sum(axis=1))


def _by_phases(waves: Complexes, top: Integers) -> Floats:
    """Return where phases turn evenly about tops [n]: slits are moved until they have it amid."""
    at = top.astype(np.float64)
    for _ in range(LOOKS):
        turn = np.angle(seen(waves, at, PITCH) * seen(waves, at, -PITCH).conj())
        at = top + (at - 0.5 * turn / PITCH - top).clip(-MOST, MOST)
    return np.asarray(at)


def _first_top(sizes: Floats, sigma: Floats, deaf: float) -> Integers:
    """Return the first top that stands out [n]; more is asked of it if deaf."""
    place = np.arange(sizes.shape[1])
    inner = (place >= EDGE) & (place < sizes.shape[1] - EDGE)
    highest = (sizes * inner).argmax(axis=1)
    most = np.take_along_axis(sizes, highest[:, None], axis=1)[:, 0]
    asked = np.maximum(STANDS * OF_NOISE * sigma, OF_TOP * most) * (1 + 5.5 * deaf)
    bar = np.minimum(asked, 0.88 * most)[:, None]
    soon = inner & (place <= highest[:, None]) & (place >= (highest - SOONEST)[:, None])
    tops = np.zeros(sizes.shape, np.bool_)
    tops[:, 1:-1] = (sizes[:, 1:-1] >= sizes[:, :-2]) & (sizes[:, 1:-1] > sizes[:, 2:])
    return np.asarray((tops & soon & (sizes > bar) | (place == highest[:, None])).argmax(axis=1))


def first_paths(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return places AHEAD of first pulses, in samples [n]; never sooner if deaf."""
    sizes = np.abs(_smooth(waves))
    at = _by_phases(waves, _first_top(sizes, sigma, 0.0))
    if deaf > 0.0:
        at = np.maximum(at, _by_phases(waves, _first_top(sizes, sigma, deaf)))
    return at - AHEAD


ALL = (-5.0, 100.0)  # samples after first paths between which all energy is


def _energies(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return the energy of all, less noise's, and that through a slit at first paths [2, n]."""
    off = PLACES - at[:, None]
    inside = (off > ALL[0]) & (off < ALL[1])
    every = np.sum(inside * (np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2), axis=1)
    return np.stack([every, np.abs(seen(waves, at + AHEAD, 0.0)) ** 2 - 6.7 * sigma**2])


def _lone() -> Floats:
    """Return both energies of lone pulses of height 1 [2, 1]."""
    tops = 90.0 + np.arange(20) / 20
    both = _energies(bulges(tops).astype(np.complex128), tops - AHEAD, np.zeros(20))
    return np.asarray(both.mean(axis=1, keepdims=True))


LONE = _lone()


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    every, first = _energies(waves, at, sigma) / LONE
    first = np.maximum(first, 0.4 * sigma**2)
    return np.asarray(10 * np.log10(np.stack([np.maximum(every, 1.02 * first), first])))


class Camera:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `told_noise`, `told_count` [n]: factors of what is told;
    `late_m` [n]: what ranges alone get; `deaf`: see `_first_top`.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        both = (np.stack([*table[name]]) for name in ("cir_i", "cir_q"))
        self.plain: Complexes = np.asarray(next(both) + 1j * next(both), np.complex128)
        self.wave: Complexes = self.plain
        self.still: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma: Floats = self.still
        self.told_noise: Floats = np.ones(self.rows)
        self.told_count: Floats = np.ones(self.rows)
        self.late_m: Floats = np.zeros(self.rows)
        self.deaf = 0.0
        self.at = first_paths(self.plain, self.still)
        self.since: Floats = PLACES - self.at[:, None]

    def race(self) -> Race:
        """Return the rows as they are told by now."""
        return Race(self.told(), self.case, self.rng)

    def same(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 3305, what])

    def after(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later, smoothly [n, k]."""
        part = ((self.since - samples) / within).clip(0.0, 1.0)
        return np.asarray(part**3 * (10 - 15 * part + 6 * part**2))

    def on_air(self) -> Complexes:
        """Return what came by air [n, k]: what is no larger than noise is left out, softly."""
        over = (np.abs(self.wave) / (3.4 * self.sigma[:, None])) ** 2
        return np.asarray(self.wave * self.after(-5.5) * -np.expm1(-(over**2)))

    def straight(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.after(-5.5) * (1 - self.after(4.3, 3.0))

    def height(self) -> Floats:
        """Return how high first pulses are [n]."""
        return np.asarray(np.abs(seen(self.wave, self.at + AHEAD, 0.0)) / np.sqrt(LONE[1, 0]))

    def turned(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def repeat(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come again, so many samples later [n]."""
        self.wave = self.wave + part[:, None] * dropped_back(what, samples)

    def add_noise(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * humming(self.rng, self.rows)

    def weaken(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the post's own noise stays."""
        left = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * left
        self.add_noise(self.sigma[:, None] * np.sqrt(1 - left**2))

    def drown(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (np.maximum(db, 0.0) / 20)
        self.add_noise((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.told_noise = self.sigma * by, self.told_noise * by

    def count_less(self, db: Floats) -> None:
        """Count fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        part = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * part[:, None]
        self.add_noise((self.sigma * np.sqrt(part - part**2))[:, None])
        self.sigma, self.told_noise = self.sigma * part**0.5, self.told_noise * part**0.5
        self.told_count = self.told_count * part

    def bear(self, load: Handicap) -> None:
        """Let waveforms bear what rows do."""
        told = (load.late_m, load.all_db, load.first_db, load.noise_db, load.count_db)
        late, every, first, noise, count = (
            np.zeros(self.rows) + np.asarray(one, np.float64) for one in told
        )
        self.late_m = self.late_m + late
        if every.any() or first.any():
            self.weaken(self.after(-5.5) * every[:, None] + self.straight() * first[:, None])
        if noise.any():
            self.drown(noise)
        if count.any():
            self.count_less(count)

    def told(self) -> pd.DataFrame:
        """Return the table as the camera tells it by now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        moved = first_paths(self.wave, self.sigma, self.deaf) - self.at
        index = (was + moved).clip(6.0, WIDE_SAMPLES - 8.0)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * moved + self.late_m
        levels = levels_db(self.wave, index, self.sigma) - levels_db(self.plain, was, self.still)
        every, first = levels - 20 * np.log10(self.told_count)
        return self.table.assign(
            first_path_index=index,
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + every,
            first_path_power_dbm=self.table["first_path_power_dbm"] + first,
            noise_std=self.table["noise_std"] * self.told_noise,
            preamble_count=self.table["preamble_count"] * self.told_count,
            cir_i=[*self.wave.real],
            cir_q=[*self.wave.imag],
        )
