"""The chairlift's receiver: what ails waveforms, and what electronics at a mast read of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.chairlift_rope import Ill, Trip

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 34, 238
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = 0.655136  # how sizes of noise scatter, next to one of both components
CLEAR, OF_PEAK = 6.8, 0.09  # times a component's scatter; of the largest size
SPAN = 7.0  # samples of a pulse, from end to end
LOW, HIGH = 0.3, 0.7  # of a top: where an edge is met
PEAK = 2.53  # samples from where an edge would begin, by a line, to its top
LEAN = 0.45  # of noise: what stays of a sample in the next one
SAMPLES_AT: Floats = np.linspace(0.0, WIDE_SAMPLES - 1.0, WIDE_SAMPLES)


def bumps(peak: Floats) -> Floats:
    """Return pulses of height 1 with such peaks in samples [n]: cubes of a cosine."""
    off = np.clip((SAMPLES_AT - peak[:, None]) / SPAN, -0.5, 0.5)
    return np.asarray(np.cos(np.pi * off) ** 3)


def murmur(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose components scatter by 1, each sample leaning on the last [rows, k]."""
    fresh = rng.standard_normal((rows, WIDE_SAMPLES)) + 1j * rng.standard_normal(
        (rows, WIDE_SAMPLES)
    )
    fresh[:, 1:] *= np.sqrt(1 - LEAN**2)
    for at in range(1, WIDE_SAMPLES):
        fresh[:, at] += LEAN * np.exp(0.6j) * fresh[:, at - 1]
    return fresh


def held_back(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by Lagrange's polynomials through six samples."""
    samples = np.clip(samples, 0.0, 200.0)
    whole = np.floor(samples).astype(np.int32)
    part = (samples - whole)[:, None]
    knots = (-2, -1, 0, 1, 2, 3)
    wide = np.pad(waves, ((0, 0), (206, 6)))
    start = 206 - whole[:, None] + np.arange(waves.shape[1])
    out = np.zeros_like(waves)
    for knot in knots:
        weight = np.ones_like(part)
        for other in (one for one in knots if one != knot):
            weight = weight * (part - other) / (knot - other)
        out += weight * np.take_along_axis(wide, start - knot, axis=1)
    return out


def edges(waves: Complexes, sigma: Floats, dense: float = 0.0) -> Floats:
    """Return where edges of first pulses would begin by a line, in samples [n].

    The first is what stays above noise, `sigma` [n] of a component, and above a part of the
    largest, for two samples. A dense receiver asks for more of both.
    """
    size = np.abs(waves)
    most = size.max(axis=1)
    least = np.maximum(CLEAR * sigma, OF_PEAK * most) * (1 + 3.6 * dense)
    loud = size >= np.minimum(least, 0.75 * most)[:, None]
    stays = loud[:, :-1] & loud[:, 1:]
    begin = np.where(stays.any(axis=1), stays.argmax(axis=1), size.argmax(axis=1))
    begin = np.clip(begin, 8, WIDE_SAMPLES - 16)
    return _edge(_doubled(size), 2 * begin) / 2


def _doubled(size: Floats) -> Floats:
    """Return sizes [n, k] with cubics' values amid every two of them, [n, 2 k]."""
    wide = np.pad(size, ((0, 0), (1, 2)), mode="edge")
    amid = (9 * (wide[:, 1:-2] + wide[:, 2:-1]) - wide[:, :-3] - wide[:, 3:]) / 16
    return np.stack([size, amid], axis=2).reshape(len(size), -1)


def _edge(size: Floats, begin: NDArray[np.intp]) -> Floats:
    """Return where lines through LOW and HIGH parts of tops after `begin` come from zero [n]."""
    rows = np.arange(len(size))
    top = begin.copy()
    for _ in range(8):
        top = np.where(size[rows, top + 1] > size[rows, top], top + 1, top)
    left, mid, right = size[rows, top - 1], size[rows, top], size[rows, top + 1]
    curve = np.minimum(left + right - 2 * mid, -1e-9)
    height = mid - np.clip((right - left) ** 2 / (8 * curve), -0.25 * mid, 0.0)
    low, high = (_met(size, top, part * height) for part in (LOW, HIGH))
    return np.asarray(low - LOW / (HIGH - LOW) * np.maximum(high - low, 0.4))


def _met(size: Floats, top: NDArray[np.intp], level: Floats) -> Floats:
    """Return where sizes [n, k], backward from tops, first fall below a level [n]."""
    rows, at = np.arange(len(size)), top.copy()
    for _ in range(12):
        at = np.where(size[rows, at] >= level, at - 1, at)
    low, high = size[rows, at], size[rows, at + 1]
    return np.asarray(at + np.clip((level - low) / np.maximum(high - low, 1e-9), 0.0, 1.0))


def powers(waves: Complexes, edge: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of all from edges on, and that of first pulses [2, n]."""
    net = np.abs(waves) ** 2 - 2 * np.square(sigma)[:, None]
    off = SAMPLES_AT - edge[:, None]
    weight = np.cos(np.pi * np.clip((off - PEAK) / 6.4, -0.5, 0.5)) ** 2
    one = np.maximum(np.sum(net * weight, axis=1), np.square(sigma))
    every = np.sum(np.where((off > -2.0) & (off < 120.0), net, 0.0), axis=1)
    return np.asarray(10 * np.log10([np.maximum(every, 1.12 * one), one]))


class Mast:
    """Waveforms of a table's rows, and one thing after the other that ails them.

    `sigma` [n]: of a component of noise at present; `times` [n]: of what is read of `noise` and of
    `sums`; `only_m` [n]: what ranges alone have; `dense`: of `edges`.
    """

    def __init__(self, table: pd.DataFrame, winter: int, rng: np.random.Generator) -> None:
        self.table, self.winter, self.rng, self.rows = table, winter, rng, len(table)
        self.first: Complexes = np.vstack([*table["cir_i"]]) + 1j * np.vstack([*table["cir_q"]])
        self.wave: Complexes = self.first + 0.0
        self.quiet: Floats = np.asarray(table["noise_std"], np.float64) / OF_SIZES
        self.sigma: Floats = self.quiet + 0.0
        self.times = {"noise": np.ones(self.rows), "sums": np.ones(self.rows)}
        self.only_m: Floats = np.zeros(self.rows)
        self.dense = 0.0
        self.edge = edges(self.first, self.quiet)
        self.off: Floats = SAMPLES_AT - self.edge[:, None]

    def trip(self) -> Trip:
        """Return the rows as they are read at present."""
        return Trip(self.reading(), self.winter, self.rng)

    def fixed(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([what, 1223, self.winter])

    def from_(self, samples: float, within: float = 2.5) -> Floats:
        """Return 0 until so many samples past edges, then 1, by a quintic within some [n, k]."""
        part = np.clip((self.off - samples) / within, 0.0, 1.0)
        return np.asarray(part**3 * (10 - 15 * part + 6 * part**2))

    def come(self) -> Complexes:
        """Return what has come by air [n, k]: what is clear of the noise, which is a mast's own."""
        clear = (np.abs(self.wave) - 3.0 * self.sigma[:, None]) / self.sigma[:, None]
        return np.asarray(self.wave * self.from_(-4.0) * np.clip(clear, 0.0, 1.0) ** 1.5)

    def leading(self) -> Floats:
        """Return 1 for first pulses, else 0 [n, k]."""
        return np.asarray(self.from_(-4.0) - self.from_(6.0, 4.0))

    def peaks(self) -> Floats:
        """Return how large first pulses are [n]."""
        return np.asarray(
            np.max(np.where(np.abs(self.off - PEAK) < 2, np.abs(self.wave), 0), axis=1)
        )

    def spins(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def repeat(self, what: Complexes, by: Floats | Complexes, samples: Floats) -> None:
        """Hear it again by some part [n], so many samples later [n]."""
        self.wave = self.wave + np.reshape(by, (self.rows, 1)) * held_back(what, samples)

    def mutter(self, sigma: Floats) -> None:
        """Let there be noise besides, with such components [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * murmur(self.rng, self.rows)

    def leave(self, part: Floats) -> None:
        """Leave a part of what comes [n, k], and all of the noise."""
        self.wave = self.wave * part
        self.mutter(np.sqrt(np.maximum(1.0 - part * part, 0.0)) * self.sigma[:, None])

    def louder_noise(self, db: Floats) -> None:
        """Let noise be more by dB >= 0 [n]."""
        times = np.power(10.0, np.maximum(db, 0.0) / 20)
        self.mutter((np.sqrt(times * times - 1) * self.sigma)[:, None])
        self.sigma = times * self.sigma
        self.times["noise"] = times * self.times["noise"]

    def fewer(self, db: Floats) -> None:
        """Take fewer symbols, by dB <= 0 [n]; noise, of which each has its own, falls by half."""
        part = np.power(10.0, np.minimum(db, 0.0) / 20)
        self.wave = part[:, None] * self.wave
        self.mutter((np.sqrt(part * (1 - part)) * self.sigma)[:, None])
        self.sigma = np.sqrt(part) * self.sigma
        self.times = {
            "noise": np.sqrt(part) * self.times["noise"],
            "sums": part * self.times["sums"],
        }

    def fall_ill(self, ill: Ill) -> None:
        """Let waveforms have what ails their rows."""
        whole = {name: np.broadcast_to(value, (self.rows,)) for name, value in ill.items()}
        self.only_m = self.only_m + whole.get("metres", 0.0)
        if "level" in whole or "first" in whole:
            none = np.zeros(self.rows)
            level, first = (whole.get(one, none)[:, None] for one in ("level", "first"))
            db = level * self.from_(-4.0) + first * self.leading()
            self.leave(np.power(10.0, db / 20))
        if "noise" in whole:
            self.louder_noise(whole["noise"])
        if "sums" in whole:
            self.fewer(whole["sums"])

    def reading(self) -> pd.DataFrame:
        """Return the table as it is read at present."""
        now = edges(self.wave, self.sigma, self.dense)
        at = np.asarray(self.table["first_path_index"], np.float64)
        index = (at + now - self.edge).clip(4.0, WIDE_SAMPLES - 9.0)
        grown = powers(self.wave, index - PEAK + 1.2, self.sigma)
        grown = grown - powers(self.first, at - PEAK + 1.2, self.quiet)
        grown = grown - 20 * np.log10(self.times["sums"])
        error = self.table["error_m"] + self.only_m + METRES * (now - self.edge)
        out = self.table.assign(error_m=error, range_m=self.table["true_range_m"] + error)
        return out.assign(
            noise_std=out["noise_std"] * self.times["noise"],
            preamble_count=out["preamble_count"] * self.times["sums"],
            rx_power_dbm=out["rx_power_dbm"] + grown[0],
            first_path_power_dbm=out["first_path_power_dbm"] + grown[1],
            first_path_index=index,
            **{"cir_i": [*self.wave.real], "cir_q": [*self.wave.imag]},
        )
