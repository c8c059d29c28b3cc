"""The tannery's receiver: what waveforms are dyed with, and what is read off them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.tannery_floor import Dye, Lot

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 28, 184
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
OVER, SHARE = 6.5, 0.14  # times a component's scatter; of the largest size
HALF_WIDTH, KAISER = 3.1, 5.5  # of a pulse, in samples, and how round it is
PLACES = np.arange(float(WIDE_SAMPLES))
MEMORY = np.array([1.0, 0.33, -0.12])  # of noise
MEMORY /= np.linalg.norm(MEMORY)


def windows(top: Floats) -> Floats:
    """Return pulses of height 1 with such tops in samples [n, k]: Kaiser's windows."""
    inside = 1 - np.square((PLACES - top[:, None]) / HALF_WIDTH)
    high = np.i0(KAISER * np.sqrt(np.maximum(inside, 0))) / np.i0(KAISER)
    return np.where(inside > 0, high, 0.0)


def murmur(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1, a sum of three fresh ones each, [size, k]."""
    fresh = rng.standard_normal((size, WIDE_SAMPLES + 2, 2)) @ np.array([1, 1j])
    return np.asarray(sum(m * fresh[:, 2 - k : 2 - k + WIDE_SAMPLES] for k, m in enumerate(MEMORY)))


def retarded(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by Keys's cubic (1981) between samples."""
    late = np.clip(samples, 0.0, 122.0)
    whole = np.floor(late).astype(np.intp)
    x = (late - whole)[:, None]
    roomy = np.pad(waves, ((0, 0), (124, 2)))
    begin = 124 - whole[:, None] + np.arange(WIDE_SAMPLES)
    weights = {
        1: 0.5 * (-(x**3) + 2 * x**2 - x),
        0: 0.5 * (3 * x**3 - 5 * x**2) + 1,
        -1: 0.5 * (-3 * x**3 + 4 * x**2 + x),
        -2: 0.5 * (x**3 - x**2),
    }
    parts = (w * np.take_along_axis(roomy, begin + k, axis=1) for k, w in weights.items())
    return np.asarray(sum(parts))


def rises(waves: Complexes, sigma: Floats, dull: float = 0.0) -> Floats:
    """Return where first pulses rise through a part of their own tops, in samples [n].

    The first is the first above noise, `sigma` [n] of a component, and above a share of the
    largest. Dull ones ask for more of both, and for a larger part, which comes later.
    """
    size = np.abs(waves)
    largest = size.max(axis=1)
    bar = (1 + 1.1 * dull) * np.maximum(OVER * sigma, SHARE * largest)
    over = (size >= np.minimum(bar, 0.7 * largest)[:, None]).argmax(axis=1)
    over = np.clip(over, 10, WIDE_SAMPLES - 16)
    rows = np.arange(len(size))
    near = size[rows[:, None], over[:, None] + np.arange(6)]
    falls = near[:, :-1] > near[:, 1:]
    step = np.where(falls.any(axis=1), falls.argmax(axis=1), 5)
    top = over + step
    level = min(0.5 + 0.22 * dull, 0.92) * size[rows, top]
    before = size[rows[:, None], top[:, None] - np.arange(8)]  # backward from the top
    back = np.maximum((before < level[:, None]).argmax(axis=1), 1)
    low, high = before[rows, back], before[rows, back - 1]
    part = np.clip((level - low) / np.maximum(high - low, 1e-9), 0.0, 1.0)
    return np.asarray(top - back + part)


def strengths(waves: Complexes, index: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of all that follows, and that about first tops [2, n]."""
    over = np.square(np.abs(waves)) - 2 * np.square(sigma)[:, None]
    since = PLACES - index[:, None]
    edge = (over * np.exp(-0.5 * np.square((since - 1.2) / 1.3))).sum(axis=1)
    edge = np.maximum(edge, 0.8 * np.square(sigma))
    whole = np.maximum(np.where(since > -5, over, 0.0).sum(axis=1), 1.15 * edge)
    return np.asarray(10 * np.log10([whole, edge]))


class Reading:
    """Waveforms of a table's rows, dyed with one thing after the other.

    `sigma` [n]: of a component of noise now; `rougher`, `thinner` [n]: factors of what is read of
    noise and of symbols; `aside_m` [n]: metres that no waveform shows; `dull`: of `rises`.
    """

    def __init__(self, table: pd.DataFrame, week: int, rng: np.random.Generator) -> None:
        self.table, self.week, self.rng = table, week, rng
        real, imaginary = (np.array(table[one].tolist(), np.float64) for one in ("cir_i", "cir_q"))
        self.raw: Complexes = np.asarray(real + 1j * imaginary)
        self.wave = self.raw
        self.calm = table["noise_std"].to_numpy(np.float64) / OF_NOISE
        self.sigma = self.calm
        self.rougher, self.thinner, self.aside_m = np.array([[1.0], [1.0], [0.0]]) + 0 * self.sigma
        self.dull = 0.0
        self.rise = rises(self.raw, self.sigma)
        self.since: Floats = PLACES - self.rise[:, None]

    def lot(self) -> Lot:
        """Return the rows as they would be read now."""
        return Lot(self.read(), self.week, self.rng)

    def lasting(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.week, what, 894])

    def begun(self) -> Floats:
        """Return 0 until shortly before first pulses, then 1 [n, k]: by a cosine."""
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.clip((self.since + 5.5) / 2.5, 0, 1)))

    def foremost(self) -> Floats:
        """Return 1 as long as first pulses last, then 0 [n, k]: by a cosine."""
        return np.asarray(0.5 + 0.5 * np.cos(np.pi * np.clip((self.since - 4.0) / 5.0, 0, 1)))

    def voice(self) -> Complexes:
        """Return waveforms from the first pulse on that rise above the reader's murmur."""
        rise = np.clip(np.abs(self.wave) / self.sigma[:, None] - 3.0, 0.0, 1.2) / 1.2
        return np.asarray(self.wave * self.begun() * rise**3 * (10 - 15 * rise + 6 * rise**2))

    def top(self) -> Floats:
        """Return the size of first pulses [n]."""
        return np.asarray(np.max(np.abs(self.wave), axis=1, where=np.abs(self.since - 1) < 3,
                                 initial=1e-9))  # fmt: skip

    def phases(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(len(self.table))))

    def add(self, share: Floats | Complexes, later: Floats, of: Complexes) -> None:
        """Add such a share [n] of waveforms [n, k], so many samples later [n]."""
        self.wave = self.wave + retarded(of, later) * np.asarray(share)[:, None]

    def rough(self, sigma: Floats) -> None:
        """Add noise of such components [n] or [n, k]."""
        self.wave = self.wave + sigma.reshape(len(self.table), -1) * murmur(self.rng, len(sigma))

    def weaken(self, left: Floats) -> None:
        """Leave a part of signals [n, k], and noise as it was."""
        self.wave = self.wave * left
        self.rough(self.sigma[:, None] * np.sqrt(np.clip(1 - left**2, 0, 1)))

    def louder(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        by = np.power(10.0, np.maximum(db, 0.0) / 20)
        self.rough(self.sigma * np.sqrt(by**2 - 1))
        self.sigma, self.rougher = self.sigma * by, self.rougher * by

    def fewer(self, part: Floats) -> None:
        """Add up a part of the symbols [n]: noise falls by its root."""
        self.wave = self.wave * part[:, None]
        self.rough(self.sigma * np.sqrt(part - part**2))
        root = np.sqrt(part)
        self.sigma, self.rougher = self.sigma * root, self.rougher * root
        self.thinner = self.thinner * part

    def dye(self, dye: Dye) -> None:
        """Dye waveforms as their rows are dyed."""
        whole, edge, hiss, count = (
            np.asarray(one) + np.zeros(len(self.table))
            for one in (dye.whole, dye.edge, dye.hiss, dye.count)
        )
        self.aside_m = self.aside_m + dye.metres
        db = whole[:, None] + edge[:, None] * self.foremost()
        if np.any(db):
            self.weaken(np.power(10.0, self.begun() * db / 20))
        if np.any(hiss):
            self.louder(hiss)
        if np.any(count):
            self.fewer(np.power(10.0, np.minimum(count, 0.0) / 20))

    def read(self) -> pd.DataFrame:
        """Return the table as it is read now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        later = rises(self.wave, self.sigma, self.dull) - self.rise
        index = np.clip(was + later, 6.0, WIDE_SAMPLES - 12.0)
        gain = strengths(self.wave, index, self.sigma) - strengths(self.raw, was, self.calm)
        gain = gain - 20 * np.log10(self.thinner)
        error = self.table["error_m"] + METRES * later + self.aside_m
        return self.table.assign(
            first_path_index=index,
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + gain[0],
            first_path_power_dbm=self.table["first_path_power_dbm"] + gain[1],
            noise_std=self.table["noise_std"] * self.rougher,
            preamble_count=self.table["preamble_count"] * self.thinner,
            cir_i=list(self.wave.real),
            cir_q=list(self.wave.imag),
        )
