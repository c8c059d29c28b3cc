"""The colliery's receiver: what happens to waveforms, and what a prop's geophone tells of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses are Kaiser's
windows; first paths are told PAST where a step that is as high as the first top that stands out
has as much below it as the rise to that top has, in phase with the top.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.colliery_pit import Burden, Tally

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 44, 228
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
HALF, BETA = 2.95, 8.0  # samples from a pulse's top to either end; how narrow it is (Kaiser 1980)
PAST = 0.25  # samples past steps that first paths are told, as far before tops as chips do
RISE = 5  # samples before a top that belong to its rise
STANDS, OF_TOP = 6.4, 0.145  # what counts: times what noise leaves; of the highest
SOONEST, EDGE = 80, 9  # samples before the highest from which on tops count; none at ends
BLURS: Floats = np.array([-0.07, 0.32, 0.5, 0.32, -0.07])  # by which what is looked at is smoothed
ALIKE = (1.0, 0.32, -0.17, -0.2)  # noise beside itself, samples off [DW1000]
PLACES: Floats = np.arange(float(WIDE_SAMPLES))
ROUND = 512  # samples of a circle of noise, of which records are a part


def booms(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    part = ((PLACES - top[:, None]) / HALF).clip(-1.0, 1.0)
    return np.asarray((np.i0(BETA * np.sqrt(1 - part**2)) - 1) / (np.i0(BETA) - 1))


def _sizes_of_pitches() -> Floats:
    """Return roots of how much noise has at pitches of a circle [ROUND]."""
    turn = 2 * np.pi * np.arange(ROUND) / ROUND
    power = 1 + 2 * sum(by * np.cos(k * turn) for k, by in enumerate(ALIKE[1:], 1))
    return np.asarray(np.sqrt(np.maximum(power, 0.0)), np.float64)


PITCHES = _sizes_of_pitches()


def trickling(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, WIDE_SAMPLES]."""
    real, imag = rng.normal(size=(2, rows, ROUND))
    whole = np.fft.ifft(np.fft.fft(real + 1j * imag, axis=1) * PITCHES, axis=1)
    return np.asarray(whole[:, :WIDE_SAMPLES])


def _weights(part: Floats) -> Floats:
    """Return weights of seven samples about places a part below samples [n, 7] (Lagrange)."""
    at = np.arange(-3.0, 4.0)
    made = np.ones((len(part), 7))
    for k, here in enumerate(at):
        for there in at[at != here]:
            made[:, k] *= (-part - there) / (here - there)
    return made


def hauled_back(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by sixth degrees through seven samples."""
    late = samples.clip(0.0, WIDE_SAMPLES + 8.0)
    whole = np.rint(late).astype(np.int64)
    weights = _weights(late - whole)
    ahead = WIDE_SAMPLES + 16
    padded = np.pad(waves, ((0, 0), (ahead, 4)))
    begin = ahead - whole[:, None] + np.arange(WIDE_SAMPLES)
    return np.asarray(
        sum(weights[:, [k]] * np.take_along_axis(padded, begin + k - 3, axis=1) for k in range(7))
    )


def _blurred(waves: Complexes) -> Complexes:
    padded = np.pad(waves, ((0, 0), (2, 2)))
    return np.asarray(sum(by * padded[:, k : k + waves.shape[1]] for k, by in enumerate(BLURS)))


OF_NOISE = float(_blurred(trickling(np.random.default_rng(3404), 60)).real[:, 9:-9].std())
"""How parts of blurred noise scatter whose own parts scatter by 1."""


def _first_top(sizes: Floats, sigma: Floats, deaf: float) -> Integers:
    """Return the first top that stands out [n]; more is asked of it if deaf."""
    place = np.arange(sizes.shape[1])
    inner = (place >= EDGE) & (place < sizes.shape[1] - EDGE)
    highest = (sizes * inner).argmax(axis=1)
    most = np.take_along_axis(sizes, highest[:, None], axis=1)[:, 0]
    asked = np.maximum(STANDS * OF_NOISE * sigma, OF_TOP * most) * (1 + 6.0 * deaf)
    bar = np.minimum(asked, 0.87 * most)[:, None]
    soon = inner & (place <= highest[:, None]) & (place >= (highest - SOONEST)[:, None])
    tops = np.zeros(sizes.shape, np.bool_)
    tops[:, 1:-1] = (sizes[:, 1:-1] >= sizes[:, :-2]) & (sizes[:, 1:-1] > sizes[:, 2:])
    return np.asarray((tops & soon & (sizes > bar) | (place == highest[:, None])).argmax(axis=1))


def _steps(waves: Complexes, top: Integers) -> Floats:
    """Return where steps are that are as high as tops, and have as much below them [n].

    Heights and places of tops are those of parabolas.
    """
    inner = top.clip(RISE + 1, waves.shape[1] - 3)[:, None] + np.arange(-RISE, 2)
    own = np.take_along_axis(waves, inner, axis=1)
    rise = (own * np.exp(-1j * np.angle(own[:, [RISE]]))).real
    before, amid, after = rise[:, RISE - 1], rise[:, RISE], rise[:, RISE + 1]
    bend = np.minimum(before - 2 * amid + after, -0.08 * np.abs(amid))
    off = (0.5 * (before - after) / bend).clip(-0.6, 0.6)
    high = np.maximum(amid - 0.25 * (before - after) * off, 0.2 * np.abs(amid) + 1e-12)
    slope = 0.5 * (after - before)
    # trapezia up to the sample at the top and what bends off these; a parabola on to the top itself
    below = rise[:, :RISE].sum(axis=1) + 0.5 * amid - slope / 12
    below = below + amid * off + slope * off**2 / 2 + bend * off**3 / 6
    place = top.clip(RISE + 1, waves.shape[1] - 3)
    return np.asarray(place + off - (below / high).clip(0.0, 3.2))


def first_paths(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return places PAST first steps, in samples [n]; never sooner if deaf."""
    smooth = _blurred(waves)
    sizes = np.abs(smooth)
    at = _steps(smooth, _first_top(sizes, sigma, 0.0))
    if deaf > 0.0:
        at = np.maximum(at, _steps(smooth, _first_top(sizes, sigma, deaf)))
    return at + PAST


def _to_top() -> float:
    """Return how many samples a lone pulse's top is after what is told of it."""
    tops = 90.0 + np.arange(40) / 40
    alone = first_paths(booms(tops).astype(np.complex128), np.full(40, 1e-9))
    return float((tops - alone).mean())


TO_TOP = _to_top()
ALL = (-4.5, 96.0)  # samples after first paths between which all energy is


def picked(waves: Complexes, top: Floats) -> Complexes:
    """Return heights of pulses with such tops that fit waveforms best [n]."""
    shape = booms(top)
    return np.asarray((waves * shape).sum(axis=1) / np.maximum((shape**2).sum(axis=1), 1e-9))


def _noise_picked() -> float:
    """Return the power of what is picked of noise whose parts scatter by 1."""
    noise = trickling(np.random.default_rng(3405), 900)
    return float(np.mean(np.abs(picked(noise, np.linspace(90.0, 110.0, 900))) ** 2))


LEFT = _noise_picked()
LONE = float(np.mean((booms(90.0 + np.arange(20) / 20) ** 2).sum(axis=1)))
"""All energy of a lone pulse of height 1."""


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    off = PLACES - at[:, None]
    inside = (off > ALL[0]) & (off < ALL[1])
    every = np.sum(inside * (np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2), axis=1) / LONE
    first = np.abs(picked(waves, at + TO_TOP)) ** 2 - LEFT * sigma**2
    first = np.maximum(first, 0.4 * sigma**2)
    return np.asarray(10 * np.log10(np.stack([np.maximum(every, 1.02 * first), first])))


class Geophone:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `told_noise`, `told_count` [n]: factors of what is told;
    `late_m` [n]: what ranges alone get; `deaf`: see `_first_top`.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        real, imag = (np.stack([*table[name]]) for name in ("cir_i", "cir_q"))
        self.plain: Complexes = np.asarray(real + 1j * imag, np.complex128)
        self.wave: Complexes = self.plain
        self.still: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma: Floats = self.still
        self.told_noise: Floats = np.ones(self.rows)
        self.told_count: Floats = np.ones(self.rows)
        self.late_m: Floats = np.zeros(self.rows)
        self.deaf = 0.0
        self.at = first_paths(self.plain, self.still)
        self.since: Floats = PLACES - self.at[:, None]

    def tally(self) -> Tally:
        """Return the rows as they are told by now."""
        return Tally(self.told(), self.case, self.rng)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 3406, what])

    def after(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later, smoothly [n, k]."""
        part = ((self.since - samples) / within).clip(0.0, 1.0)
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * part))

    def by_air(self) -> Complexes:
        """Return what came by air [n, k]: what is no larger than noise is left out, softly."""
        over = (np.abs(self.wave) / (3.6 * self.sigma[:, None])) ** 4
        return np.asarray(self.wave * self.after(-5.0) * over / (1 + over))

    def straight(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.after(-5.0) * (1 - self.after(4.2, 3.0))

    def height(self) -> Floats:
        """Return how high first pulses are [n]."""
        return np.asarray(np.abs(picked(self.wave, self.at + TO_TOP)))

    def phases(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def echo(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come again, so many samples later [n]."""
        self.wave = self.wave + part[:, None] * hauled_back(what, samples)

    def add_noise(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * trickling(self.rng, self.rows)

    def weaken(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the prop's own noise stays."""
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

    def bear(self, load: Burden) -> None:
        """Let waveforms bear what rows do."""
        told = (load.late_m, load.all_db, load.first_db, load.noise_db, load.count_db)
        late, every, first, noise, count = (
            np.zeros(self.rows) + np.asarray(one, np.float64) for one in told
        )
        self.late_m = self.late_m + late
        if every.any() or first.any():
            self.weaken(self.after(-5.0) * every[:, None] + self.straight() * first[:, None])
        if noise.any():
            self.drown(noise)
        if count.any():
            self.count_less(count)

    def told(self) -> pd.DataFrame:
        """Return the table as the geophone tells it by now."""
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
