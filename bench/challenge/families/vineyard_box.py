"""The vineyard's receiver: what befalls waveforms, and what its box reads of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.vineyard_slope import Blight, Harvest

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 35, 196
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = 0.655136  # how sizes of noise scatter, next to components
QUIET, OF_MOST = 6.0, 0.08  # times a component's scatter; of the largest size
STEEP = 0.75  # of pulses, for each sample
HALF = 0.5  # of a first pulse's height: where it is said to arrive
EDGE = float(np.arccosh(HALF**-0.5)) / STEEP + 0.065  # samples from there, by lines, to its top
COLOUR = np.array([-0.2, 0.26 + 0.17j, 0.9])  # of noise: parts of two samples before and of its own
COLOUR /= np.linalg.norm(COLOUR)
TICK = np.arange(WIDE_SAMPLES, dtype=np.float64)


def pulses(top: Floats) -> Floats:
    """Return pulses of height 1 with such tops in samples [n]: squares of hyperbolic secants."""
    return np.asarray(np.cosh(STEEP * np.clip(TICK - top[:, None], -60, 60)) ** -2.0)


def rustle(rng: np.random.Generator, rows: int) -> Complexes:
    """Return coloured noise whose components scatter by 1 [rows, WIDE_SAMPLES]."""
    parts = rng.standard_normal((2, rows, WIDE_SAMPLES + 2))
    white = parts[0] + 1j * parts[1]
    return np.asarray(sum(c * white[:, k : k + WIDE_SAMPLES] for k, c in enumerate(COLOUR)))


def after(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: splines of Catmull and Rom between samples."""
    place = TICK - np.clip(samples, 0.0, 2.0 * WIDE_SAMPLES)[:, None]
    left = np.floor(place).astype(np.intp)
    t = place - left
    weights = (
        0.5 * t * (-1 + t * (2 - t)),
        1 + 0.5 * t * t * (3 * t - 5),
        0.5 * t * (1 + t * (4 - 3 * t)),
        0.5 * t * t * (t - 1),
    )
    out = np.zeros_like(waves)
    for k, weight in enumerate(weights):
        at = left + k - 1
        near = np.take_along_axis(waves, np.clip(at, 0, WIDE_SAMPLES - 1), axis=1)
        out += np.where((at >= 0) & (at < WIDE_SAMPLES), weight, 0.0) * near
    return out


def arrivals(waves: Complexes, sigma: Floats, dull: float = 0.0) -> Floats:
    """Return where first pulses have risen to HALF of their height, in samples [n].

    The first is where two samples in a row are above noise, `sigma` [n] of a component, and above a
    part of the largest. A dull ear asks more of both.
    """
    size = np.abs(waves)
    most = size.max(axis=1)
    asked = np.maximum(QUIET * sigma, OF_MOST * most) * (1 + 2.6 * dull)
    above = size >= np.minimum(asked, 0.7 * most)[:, None]
    both = above[:, :-1] & above[:, 1:]
    begun = np.where(both.any(axis=1), both.argmax(axis=1), size.argmax(axis=1))
    begun = begun.clip(7, WIDE_SAMPLES - 14)
    rows = np.arange(len(size))
    near = size[rows[:, None], begun[:, None] + np.arange(6)]
    falls = near[:, 1:] < near[:, :-1]
    top = begun + np.where(falls.any(axis=1), falls.argmax(axis=1), 4)
    left, mid, right = (size[rows, top + k] for k in (-1, 0, 1))
    bend = np.minimum(left - 2 * mid + right, -1e-9)
    height = np.clip(mid - (left - right) ** 2 / (8 * bend), mid, 1.3 * mid)
    return _risen(size, top, HALF * height)


def _risen(size: Floats, top: NDArray[np.intp], level: Floats) -> Floats:
    """Return where sizes [n, k] rise through levels [n] last before tops [n], by lines."""
    rows, back = np.arange(len(size)), np.arange(1, 6)
    below = size[rows[:, None], top[:, None] - back] < level[:, None]
    left = top - np.where(below.any(axis=1), 1 + below.argmax(axis=1), 5)
    low, high = size[rows, left], size[rows, left + 1]
    part = (level - low) / np.maximum(high - low, 1e-9)
    return np.asarray(left + np.clip(part, 0.0, 1.0))


def meters(waves: Complexes, arrival: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of all that comes, and that about first tops [2, n]."""
    power = np.abs(waves) ** 2 - 2 * (sigma**2)[:, None]
    since = TICK - arrival[:, None]
    first = np.sum(power * (np.abs(since - EDGE) <= 1.5), axis=1)
    first = np.maximum(first, sigma**2)
    whole = np.sum(power * (since > -3.5) * (since < 100), axis=1)
    return np.asarray(10 * np.log10([np.maximum(whole, 1.1 * first), first]))


class Box:
    """Waveforms of a table's rows, and what befalls them one after the other.

    `sigma` [n]: of a component of noise now; `hissed`, `counted` [n]: factors of what is reported
    of noise and of symbols; `aside_m` [n]: metres that leave waveforms alone; `dull`: of
    `arrivals`.
    """

    def __init__(self, table: pd.DataFrame, vintage: int, rng: np.random.Generator) -> None:
        self.table, self.vintage, self.rng = table, vintage, rng
        real, imaginary = (np.stack(list(table[name])) for name in ("cir_i", "cir_q"))
        self.untouched: Complexes = real + 1j * imaginary
        self.now = self.untouched.copy()
        self.sigma_at_first: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.sigma_at_first.copy()
        self.hissed, self.counted = np.ones((2, len(table)))
        self.aside_m, self.dull = np.zeros(len(table)), 0.0
        self.came = arrivals(self.untouched, self.sigma_at_first)
        self.since: Floats = TICK - self.came[:, None]

    def rows(self) -> Harvest:
        """Return the rows as they read now."""
        return Harvest(self.read(), self.vintage, self.rng)

    def same(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.vintage, 1133, what])

    def late(self, samples: float, ramp: float = 2.0) -> Floats:
        """Return 0 until so many samples past arrivals, then 1 [n, k]: smoothly, within a ramp."""
        part = np.clip((self.since - samples) / ramp, 0.0, 1.0)
        return np.asarray(part * part * (3 - 2 * part))

    def there(self) -> Floats:
        """Return 0 until shortly before first pulses, then 1 [n, k]."""
        return self.late(-4.0)

    def front(self) -> Floats:
        """Return 1 until first pulses are over, then 0 [n, k]."""
        return np.asarray(1 - self.late(5.5, 3.5))

    def heard(self) -> Complexes:
        """Return waveforms from the first pulse on, apart from what the box rustles by itself."""
        part = np.clip(np.abs(self.now) / self.sigma[:, None] - 3.1, 0.0, 1.0)
        return np.asarray(self.there() * part**2 * (3 - 2 * part) * self.now)

    def height(self) -> Floats:
        """Return the height of first pulses [n]."""
        near = np.abs(self.since - EDGE) < 2
        return np.asarray(np.max(np.abs(self.now) * near, axis=1))

    def phases(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(0, 2 * np.pi, len(self.table))))

    def echo(self, of: Complexes, share: Floats | Complexes, samples: Floats) -> None:
        """Add such a share [n] of waveforms, so many samples later [n]."""
        self.now = self.now + np.reshape(share, (-1, 1)) * after(of, samples)

    def add_noise(self, sigma: Floats) -> None:
        """Add noise of such components [n, k] or [n, 1]."""
        self.now = self.now + sigma * rustle(self.rng, len(self.table))

    def weaken(self, kept: Floats) -> None:
        """Keep such a part of what arrives [n, k]; of noise there is as much as before."""
        self.now = kept * self.now
        gone = np.sqrt(np.maximum(1 - np.square(kept), 0.0))
        self.add_noise(gone * self.sigma[:, None])

    def raise_noise(self, db: Floats) -> None:
        """Let there be more noise, by dB >= 0 [n]."""
        times = 10.0 ** (np.maximum(db, 0.0) / 20)
        more = self.sigma * np.sqrt(times**2 - 1)
        self.add_noise(more[:, None])
        self.sigma, self.hissed = self.sigma * times, self.hissed * times

    def count_fewer(self, db: Floats) -> None:
        """Add up fewer symbols, by dB <= 0 [n]: noise, which is of chance, falls by its root."""
        part = 10.0 ** (np.minimum(db, 0.0) / 20)
        self.now = self.now * part[:, None]
        self.add_noise((self.sigma * np.sqrt(part - part**2))[:, None])
        self.sigma, self.hissed = self.sigma * np.sqrt(part), self.hissed * np.sqrt(part)
        self.counted = self.counted * part

    def suffer(self, blight: Blight) -> None:
        """Let befall waveforms what befalls their rows."""
        size = len(self.table)
        metres, whole, first, hiss, count = (np.broadcast_to(one, size) for one in blight)
        self.aside_m = self.aside_m + metres
        if np.any(whole) or np.any(first):
            db = whole[:, None] + self.front() * first[:, None]
            self.weaken(10.0 ** (self.there() * db / 20))
        if np.any(hiss):
            self.raise_noise(hiss)
        if np.any(count):
            self.count_fewer(count)

    def read(self) -> pd.DataFrame:
        """Return the table as it reads now."""
        moved = arrivals(self.now, self.sigma, self.dull) - self.came
        was = self.table["first_path_index"].to_numpy(np.float64)
        index = np.clip(was + moved, 3.0, WIDE_SAMPLES - 10.0)
        db = meters(self.now, index, self.sigma)
        db = db - meters(self.untouched, was, self.sigma_at_first) - 20 * np.log10(self.counted)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * moved + self.aside_m
        return self.table.assign(
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            first_path_index=index,
            rx_power_dbm=self.table["rx_power_dbm"] + db[0],
            first_path_power_dbm=self.table["first_path_power_dbm"] + db[1],
            noise_std=self.table["noise_std"] * self.hissed,
            preamble_count=self.table["preamble_count"] * self.counted,
            cir_i=list(self.now.real),
            cir_q=list(self.now.imag),
        )
