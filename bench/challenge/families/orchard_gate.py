"""The orchard's receiver: what becomes of waveforms, and what is logged of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.orchard_plot import Plot, Yield

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 25, 198
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
SURE, SHARE = 6.5, 0.11  # times a component's scatter; of the largest size
HALF_WIDTH = 2.6  # samples, from the middle of a pulse to its end
RATIO = 0.517  # of a size and the next one, where the rise is at half


def bells(middle: Floats) -> Floats:
    """Return pulses of height 1 with such middles in samples [n, k]: squared cosines."""
    off = np.clip((np.arange(WIDE_SAMPLES) - middle[:, None]) / HALF_WIDTH, -1, 1)
    return np.asarray(np.square(np.cos(np.pi / 2 * off)))


def behindhand(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]; what is after the end is cut off."""
    length = 320
    angle = np.fft.fftfreq(length, 1 / (2 * np.pi))[None] * np.clip(samples, 0, 119)[:, None]
    later = np.fft.ifft(np.fft.fft(waves, length, axis=1) * np.exp(-1j * angle), axis=1)
    return np.asarray(later[:, :WIDE_SAMPLES])


def constant_fraction(waves: Complexes, least: Floats) -> Floats:
    """Return where the first rise is at a constant fraction of what follows, in samples [n].

    Near the first size above `least` [n], a size's ratio to the next one passes RATIO there;
    where none does, it is a sample before that size.
    """
    size = np.abs(waves)
    most = size.max(axis=1)
    limit = np.minimum(np.maximum(least, SHARE * most), 0.8 * most)
    found = np.clip((size >= limit[:, None]).argmax(axis=1), 3, WIDE_SAMPLES - 10)
    near = np.take_along_axis(size, found[:, None] + np.arange(-3, 5), axis=1)
    ratio = near[:, :-1] / np.maximum(near[:, 1:], 1e-9)
    passes = (ratio[:, 1:] >= RATIO) & (ratio[:, :-1] < RATIO) & (near[:, 2:] >= limit[:, None])
    place, rows = passes.argmax(axis=1), np.arange(len(near))
    low, high = ratio[rows, place], ratio[rows, place + 1]
    part = (RATIO - low) / np.where(np.abs(high - low) < 1e-9, 1e-9, high - low)
    return np.asarray(found + np.where(passes.any(axis=1), place - 3 + np.clip(part, 0, 1), -1.0))


def sums_of(waves: Complexes, index: Floats) -> Floats:
    """Return in dB the energy of all samples, and of three from the first path on [2, n]."""
    power = (waves * waves.conj()).real
    ahead = np.arange(WIDE_SAMPLES) - np.floor(index)[:, None]
    three = np.where((ahead > 0.5) & (ahead < 3.5), power, 0).sum(axis=1)
    return np.asarray(10 * np.log10(np.stack([power.sum(axis=1), three]) + 1e-9))


class Gate:
    """Waveforms of a table's rows between the antenna and the log.

    `scatter` [n]: of a component of noise now; `hiss`, `counted` [n]: factors of the logged noise
    and of the symbols; `besides_m` [n]: metres that the log has from elsewhere; `deaf`: factor of
    what a first path must have.
    """

    def __init__(self, table: pd.DataFrame, season: int, rng: np.random.Generator) -> None:
        self.table, self.season, self.rng = table, season, rng
        real, imaginary = (np.array([*table[name]], np.float64) for name in ("cir_i", "cir_q"))
        self.first: Complexes = np.asarray(real + 1j * imaginary)
        self.cir = self.first.copy()
        self.scatter = table["noise_std"].to_numpy(np.float64) / OF_NOISE
        self.hiss, self.counted = np.ones(len(table)), np.ones(len(table))
        self.besides_m, self.deaf = np.zeros(len(table)), 1.0
        self.edge = constant_fraction(self.first, SURE * self.scatter)
        self.ago: Floats = np.arange(WIDE_SAMPLES) - self.edge[:, None]

    def __len__(self) -> int:
        return len(self.table)

    def plot(self) -> Plot:
        """Return the rows as they would be logged now."""
        return Plot(self.logged(), self.season, self.rng)

    def lasting(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.season, what, 714])

    def signal(self) -> Complexes:
        """Return waveforms from shortly before the first path on, bare of the gate's own noise.

        It is added behind the antenna, and is not what soil and trees send back.
        """
        bare = 1 - np.exp(-((np.abs(self.cir) / (3.7 * self.scatter[:, None])) ** 14))
        return np.asarray(self.cir * (self.ago > -5.5) * bare)

    def crest(self) -> Floats:
        """Return the size of the first path [n]."""
        return np.asarray(np.where(np.abs(self.ago - 1.2) < 2.2, np.abs(self.cir), 0).max(axis=1))

    def turned(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(len(self))))

    def rushing(self) -> Complexes:
        """Return white noise with components of scatter 1 [n, k]."""
        return np.asarray(self.rng.normal(size=(len(self), WIDE_SAMPLES, 2)) @ [1, 1j])

    def weaken(self, left: Floats) -> None:
        """Leave a part of signals [n, k]; noise stays what it is."""
        fresh = self.scatter[:, None] * np.sqrt(np.maximum(1 - left * left, 0))
        self.cir = left * self.cir + fresh * self.rushing()

    def rush(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        more = 10 ** (db / 10)
        self.cir = self.cir + (self.scatter * np.sqrt(more - 1))[:, None] * self.rushing()
        self.scatter, self.hiss = self.scatter * np.sqrt(more), self.hiss * np.sqrt(more)

    def count_less(self, part: Floats) -> None:
        """Count a part of the symbols [n]: less noise, by its root."""
        self.cir = part[:, None] * self.cir
        self.cir = self.cir + (self.scatter * np.sqrt(part - part**2))[:, None] * self.rushing()
        self.scatter, self.hiss = self.scatter * part**0.5, self.hiss * part**0.5
        self.counted = self.counted * part

    def harvest(self, gives: Yield) -> None:
        """Let what effects give to rows or take from them befall waveforms."""
        ones = np.ones(len(self))
        self.besides_m = self.besides_m + gives.metres
        whole, edge = gives.whole * ones, gives.edge * ones
        if np.any(whole) or np.any(edge):
            there = np.clip(self.ago / 2 + 3, 0, 1)
            early = np.clip((8 - self.ago) / 3, 0, 1)
            self.weaken(10 ** (there * (whole[:, None] + early * edge[:, None]) / 20))
        if np.any(gives.hiss):
            self.rush(gives.hiss * ones)
        if np.any(gives.count):
            self.count_less(10 ** (np.minimum(gives.count, 0) * ones / 20))

    def logged(self) -> pd.DataFrame:
        """Return the table as it is logged now."""
        moved = constant_fraction(self.cir, SURE * self.deaf * self.scatter) - self.edge
        was = self.table["first_path_index"].to_numpy(np.float64)
        index = np.clip(was + moved, 1, WIDE_SAMPLES - 6)
        rises = sums_of(self.cir, index) - sums_of(self.first, was) - 20 * np.log10(self.counted)
        out = self.table.assign(first_path_index=index)
        out["error_m"] += METRES * moved + self.besides_m
        out["range_m"] = out["true_range_m"] + out["error_m"]
        out["rx_power_dbm"] += rises[0]
        out["first_path_power_dbm"] += rises[1]
        out["noise_std"] *= self.hiss
        out["preamble_count"] *= self.counted
        return out.assign(cir_i=list(self.cir.real), cir_q=list(self.cir.imag))
