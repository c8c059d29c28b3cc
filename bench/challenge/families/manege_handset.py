"""The manege's receiver: what waveforms pass, and what the radio at a letter makes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.manege_hall import Lesson, Strain

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 34, 216
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = 0.655136  # how sizes of noise scatter, next to a part of it
STANDS_OUT, OF_LARGEST = 6.7, 0.1  # times a part's scatter; of the largest size
BEFORE_LARGEST = 60  # samples in which first pulses are looked for
HALF_WIDE = 3.43  # samples from a pulse's top to its ends
AR: tuple[float, float] = (0.417, -0.3035)
"""Of noise, by the two samples before: alike by .32, -.17 and -.17 after one, two and three."""
BURN_IN = 24  # samples of noise that are thrown away
PLACES: Floats = np.arange(WIDE_SAMPLES, dtype=np.float64)
FINE: Floats = np.arange(33) / 32  # between two samples


def pulses(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n]: fourth powers of a cosine's arch."""
    off = (PLACES - top[:, None]) / HALF_WIDE
    return np.asarray(np.cos(np.pi / 2 * np.clip(off, -1.0, 1.0)) ** 4)


def hiss(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1: an autoregression (AR) [rows, WIDE_SAMPLES]."""
    loose = rng.normal(size=(rows, WIDE_SAMPLES + BURN_IN, 2)) @ np.array([1.0, 1.0j])
    made = loose.copy()
    for at in range(2, made.shape[1]):
        made[:, at] += AR[0] * made[:, at - 1] + AR[1] * made[:, at - 2]
    first = AR[0] / (1 - AR[1])
    own = 1 - AR[0] * first - AR[1] * (AR[0] * first + AR[1])
    return np.asarray(made[:, BURN_IN:] * np.sqrt(own))


def put_off(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: whole ones, and a part by cubics (Lagrange)."""
    late = np.clip(samples, 0.0, WIDE_SAMPLES - 2.0)
    whole, part = np.divmod(late, 1.0)
    ahead = np.pad(waves, ((0, 0), (WIDE_SAMPLES, 2)))
    begin = (WIDE_SAMPLES + np.arange(WIDE_SAMPLES) - whole[:, None]).astype(np.int64)
    p = part[:, None]
    weights = {
        -1: -p * (1 - p) * (2 - p) / 6,
        0: (1 - p) * (1 + p) * (2 - p) / 2,
        1: p * (1 + p) * (2 - p) / 2,
        2: -p * (1 - p) * (1 + p) / 6,
    }
    taken = (w * np.take_along_axis(ahead, begin - k, axis=1) for k, w in weights.items())
    return np.asarray(sum(taken, np.zeros_like(waves)))


def first_tops(size: Floats, sigma: Floats, dull: float) -> Integers:
    """Return at which samples first pulses have their tops [n].

    First is, of some samples before the largest, what stands out of noise, `sigma` [n] of a part,
    and is above a part of the largest; what is dull asks for more of both.
    """
    rows, largest = np.arange(len(size)), size.argmax(axis=1)
    most = size[rows, largest]
    asked = np.maximum(STANDS_OUT * sigma, OF_LARGEST * most) * (1 + 3.6 * dull)
    over = size >= np.minimum(asked, 0.76 * most)[:, None]
    over &= largest[:, None] - BEFORE_LARGEST <= PLACES
    top = np.clip(over.argmax(axis=1), 10, WIDE_SAMPLES - 16)
    for _ in range(6):
        top = top + (size[rows, top + 1] > size[rows, top])
    return np.asarray(top, np.int64)


def edges(waves: Complexes, sigma: Floats, dull: float = 0.0) -> Floats:
    """Return where first pulses come up to half of their tops, in samples [n].

    Between samples by a cubic of sizes (Catmull and Rom 1974), to the nearest 1/32.
    """
    size = np.abs(waves) + 1e-9
    rows, top = np.arange(len(size)), first_tops(size, sigma, dull)
    left, mid, right = (size[rows, top + k] for k in (-1, 0, 1))
    bend = np.maximum(2 * mid - left - right, 1e-9)
    half = 0.5 * (mid + np.minimum((right - left) ** 2 / (8 * bend), 0.15 * mid))
    low = top.copy()
    for _ in range(7):
        low = np.where(size[rows, low] > half, low - 1, low)
    a, b, c, d = (size[rows, low + k][:, None] for k in (-1, 0, 1, 2))
    t = FINE[None]
    cubic = b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)))
    over = cubic >= half[:, None]
    first = np.where(over.any(axis=1), over.argmax(axis=1), len(FINE) - 1)
    before = np.maximum(first - 1, 0)
    near = np.stack([cubic[rows, before], cubic[rows, first]])
    part = np.clip((half - near[0]) / np.maximum(near[1] - near[0], 1e-9), 0.0, 1.0)
    return np.asarray(low + FINE[before] + part * (FINE[first] - FINE[before]))


def in_db(waves: Complexes, edge: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of all from first pulses on, and that of these [2, n]."""
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    since = PLACES - edge[:, None]
    arch = np.cos(np.pi / 2 * np.clip((since - RISE) / 4.2, -1.0, 1.0)) ** 2
    first = np.maximum((power * arch).sum(axis=1) * 1.3, sigma**2)
    ramp = np.clip((since + 3.5) / 1.5, 0.0, 1.0) * np.clip((118.0 - since) / 8.0, 0.0, 1.0)
    every = np.maximum((power * ramp).sum(axis=1), 1.07 * first)
    return np.asarray(10 * np.log10(np.stack([every, first])))


def _rise() -> float:
    """Return how far tops are behind edges on average, in samples, without noise."""
    tops = WIDE_LEAD + np.arange(128) / 128
    return float(np.mean(tops - edges(pulses(tops).astype(np.complex128), np.zeros(128))))


RISE = _rise()


class Handset:
    """Waveforms of a table's rows, and what becomes of them in one thing after another.

    `sigma` [n]: of a part of noise by now; `told_noise`, `told_count` [n]: factors of what is
    told; `aside_m` [n]: added to ranges alone; `dull`: see `first_tops`.
    """

    def __init__(self, table: pd.DataFrame, stable: int, rng: np.random.Generator) -> None:
        self.table, self.stable, self.rng, self.count = table, stable, rng, len(table)
        parts = [np.stack(table[name].to_list()).astype(np.float64) for name in ("cir_i", "cir_q")]
        self.first_wave: Complexes = parts[0] + 1j * parts[1]
        self.wave = self.first_wave.copy()
        self.first_sigma: Floats = np.asarray(table["noise_std"], np.float64) / OF_SIZES
        self.sigma = self.first_sigma.copy()
        self.told_noise: Floats = np.ones(self.count)
        self.told_count: Floats = np.ones(self.count)
        self.aside_m: Floats = np.zeros(self.count)
        self.dull = 0.0
        self.edge = edges(self.first_wave, self.first_sigma)
        self.since: Floats = PLACES - self.edge[:, None]

    def lesson(self) -> Lesson:
        """Return the rows as they are told now."""
        return Lesson(self.told(), self.stable, self.rng)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([what, self.stable, 1405])

    def past(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past edges, 1 some samples later: by a cosine [n, k]."""
        part = np.clip((self.since - samples) / within, 0.0, 1.0)
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * part))

    def by_air(self) -> Complexes:
        """Return what came by air [n, k]: what stands out of noise, which is the radio's own."""
        loud = np.abs(self.wave) / self.sigma[:, None] - 3.8
        return np.asarray(self.wave * self.past(-4.5) * np.sin(np.pi / 2 * np.clip(loud, 0, 1)))

    def opening(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return np.asarray(self.past(-4.5) * (1 - self.past(5.4, 3.2)))

    def tops(self) -> Floats:
        """Return how high first pulses are [n]."""
        return np.asarray((np.abs(self.wave) * (np.abs(self.since - RISE) <= 2.2)).max(axis=1))

    def turns(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.count)))

    def repeat(self, what: Complexes, by: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come so many samples later [n]."""
        self.wave = self.wave + np.asarray(by)[:, None] * put_off(what, samples)

    def hisses(self, sigma: Floats) -> None:
        """Add noise with parts of such a scatter, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * hiss(self.rng, self.count)

    def fade(self, left: Floats) -> None:
        """Leave a part of what comes by air [n, k]; noise stays as large as it was."""
        self.wave = self.wave * left
        self.hisses(self.sigma[:, None] * np.sqrt(np.maximum(1 - left**2, 0.0)))

    def hiss_more(self, db: Floats) -> None:
        """Raise noise by dB >= 0 [n]."""
        factor = 10 ** (np.maximum(db, 0.0) / 20)
        self.hisses((self.sigma * np.sqrt(factor**2 - 1))[:, None])
        self.sigma, self.told_noise = self.sigma * factor, self.told_noise * factor

    def count_fewer(self, db: Floats) -> None:
        """Count fewer symbols, by dB <= 0 [n]: signals fall with them, noise with their root."""
        left = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * left[:, None]
        self.hisses((self.sigma * np.sqrt(left * (1 - left)))[:, None])
        self.sigma, self.told_noise = self.sigma * np.sqrt(left), self.told_noise * np.sqrt(left)
        self.told_count = self.told_count * left

    def strain(self, by: Strain) -> None:
        """Let waveforms have what strains their rows."""
        metres, whole, first, noise, count = (one + np.zeros(self.count) for one in by)
        self.aside_m = self.aside_m + metres
        if whole.any() or first.any():
            db = self.past(-4.5) * whole[:, None] + self.opening() * first[:, None]
            self.fade(10 ** (db / 20))
        if noise.any():
            self.hiss_more(noise)
        if count.any():
            self.count_fewer(count)

    def told(self) -> pd.DataFrame:
        """Return the table as the radio tells it now."""
        later = edges(self.wave, self.sigma, self.dull) - self.edge
        was = self.table["first_path_index"].to_numpy(np.float64)
        index = np.clip(was + later, 5.0, WIDE_SAMPLES - 10.0)
        db = in_db(self.wave, index, self.sigma)
        db = db - in_db(self.first_wave, was, self.first_sigma) - 20 * np.log10(self.told_count)
        error = self.table["error_m"] + METRES * later + self.aside_m
        return self.table.assign(
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            first_path_index=index,
            rx_power_dbm=self.table["rx_power_dbm"] + db[0],
            first_path_power_dbm=self.table["first_path_power_dbm"] + db[1],
            noise_std=self.table["noise_std"] * self.told_noise,
            preamble_count=self.table["preamble_count"] * self.told_count,
            cir_i=list(self.wave.real),
            cir_q=list(self.wave.imag),
        )
