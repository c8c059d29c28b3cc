"""The foundry's receiver: what waveforms are put through, and what its gauge reads of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.foundry_bay import Flaw, Pour

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 38, 214
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
CLEAR, OF_MOST = 6.4, 0.085  # times a component's scatter; of the largest size
SPAN = 5.23  # samples from end to end of a pulse
EDGE = 1.3  # samples from where a first path is said to be to the top of its pulse
TICK = np.arange(WIDE_SAMPLES) * 1.0
ROOM = 1024  # samples in which waveforms are moved, so that none comes round


def raised(top: Floats) -> Floats:
    """Return pulses of height 1 with such tops in samples [n, k]: raised cosines."""
    part = np.clip((TICK - top[:, None]) / SPAN, -0.5, 0.5)
    return np.asarray(np.square(np.cos(np.pi * part)))


def grate(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1, of which each has some of two before [n, k]."""
    white = rng.standard_normal((size, WIDE_SAMPLES + 2, 2)) @ np.array([1.0, 1j])
    return np.asarray(0.916 * white[:, 2:] + 0.32 * white[:, 1:-1] - 0.24 * white[:, :-2])


def put_back(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by turning their spectra."""
    turn = np.fft.fftfreq(ROOM) * np.clip(samples, 0.0, 130.0)[:, None]
    moved = np.fft.ifft(np.fft.fft(waves, ROOM, axis=1) * np.exp(-2j * np.pi * turn), axis=1)
    return np.asarray(moved[:, :WIDE_SAMPLES])


def arrivals(waves: Complexes, sigma: Floats, blunt: float = 0.0) -> Floats:
    """Return where first pulses have their tops, less EDGE, in samples [n].

    First is what is above noise, `sigma` [n] of a component, and above a part of the largest; its
    top is a parabola's through logarithms of three samples. Blunt ones ask for more of both.
    """
    size = np.abs(waves)
    most = size.max(axis=1)
    asked = (1 + 4.0 * blunt) * np.maximum(CLEAR * sigma, OF_MOST * most)
    begun = np.argmax(size >= np.minimum(asked, 0.75 * most)[:, None], axis=1)
    begun = np.clip(begun, 6, WIDE_SAMPLES - 12)
    near = np.take_along_axis(size, begun[:, None] + np.arange(6), axis=1)
    falls = near[:, 1:] < near[:, :-1]
    top = begun + np.where(falls.any(axis=1), falls.argmax(axis=1), 5)
    left, mid, right = (
        np.log(np.take_along_axis(size, top[:, None] + k, axis=1)[:, 0] + 1e-9) for k in (-1, 0, 1)
    )
    aside = 0.5 * (left - right) / np.minimum(left - 2 * mid + right, -1e-6)
    return np.asarray(top + np.clip(aside, -0.5, 0.5) - EDGE)


def dials(waves: Complexes, arrival: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of all that comes, and of three samples of first pulses [2, n]."""
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    past = TICK - arrival[:, None]
    first = np.where(np.abs(past - EDGE) < 1.5, power, 0).sum(axis=1)
    first = np.maximum(first, 0.9 * sigma**2)
    every = np.maximum(np.where(past > -3, power, 0).sum(axis=1), 1.12 * first)
    return np.asarray(10 * np.log10(np.array([every, first])))


class Gauge:
    """Waveforms of a table's rows, and what happens to them one after the other.

    `sigma` [n]: of a component of noise now; `noisier`, `summed` [n]: factors of what is read of
    noise and of symbols; `outside_m` [n]: metres that leave waveforms alone; `blunt`: of
    `arrivals`.
    """

    def __init__(self, table: pd.DataFrame, shift: int, rng: np.random.Generator) -> None:
        self.table, self.shift, self.rng = table, shift, rng
        parts = [np.vstack(table[name].to_list()) for name in ("cir_i", "cir_q")]
        self.first_seen: Complexes = parts[0] + 1j * parts[1]
        self.seen = self.first_seen
        self.sigma_before: Floats = np.asarray(table["noise_std"], np.float64) / OF_NOISE
        self.sigma = self.sigma_before
        self.noisier, self.summed, self.outside_m = (np.full(len(table), x) for x in (1.0, 1.0, 0))
        self.blunt = 0.0
        self.arrival = arrivals(self.first_seen, self.sigma_before)
        self.past: Floats = TICK - self.arrival[:, None]

    def __len__(self) -> int:
        return len(self.table)

    def pour(self) -> Pour:
        """Return the rows as they read now."""
        return Pour(self.read(), self.shift, self.rng)

    def lasting(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.shift, 1023, what])

    def beyond(self, samples: float, within: float = 2.5) -> Floats:
        """Return 0 until so many samples past arrivals, then 1 [n, k]: by a line within some."""
        return np.asarray(np.clip((self.past - samples) / within, 0.0, 1.0))

    def come(self) -> Floats:
        """Return 0 until shortly before first pulses, then 1 [n, k]."""
        return self.beyond(-3.5)

    def lead(self) -> Floats:
        """Return 1 as long as first pulses last, then 0 [n, k]."""
        return 1 - self.beyond(6.0, 4.0)

    def signal(self) -> Complexes:
        """Return waveforms from the first pulse on, less the power that noise may have in them.

        The gauge makes it after all that rings or reflects.
        """
        noise = np.square(3.2 * self.sigma[:, None] / np.maximum(np.abs(self.seen), 1e-9))
        return np.asarray(self.come() * self.seen * np.sqrt(np.maximum(1 - noise, 0)))

    def tall(self) -> Floats:
        """Return the size of first pulses [n]."""
        near = np.abs(self.past - EDGE) < 2.2
        return np.asarray(np.where(near, np.abs(self.seen), 0.0).max(axis=1))

    def spun(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(len(self))))

    def join(self, share: Floats | Complexes, samples: Floats, what: Complexes) -> None:
        """Add such a share [n] of waveforms [n, k], so many samples later [n]."""
        self.seen = self.seen + np.asarray(share)[:, None] * put_back(what, samples)

    def stir(self, sigma: Floats) -> None:
        """Add noise of such components [n, k] or [n, 1]."""
        self.seen = self.seen + sigma * grate(self.rng, len(self))

    def dim(self, left: Floats) -> None:
        """Leave such a part of signals [n, k]; noise stays as it was."""
        gone = np.sqrt(np.clip(1 - np.minimum(left, 1.0) ** 2, 0, 1))
        self.seen = left * self.seen
        self.stir(self.sigma[:, None] * gone)

    def louder(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        times = 10 ** (np.clip(db, 0, None) / 20)
        self.stir((self.sigma * np.sqrt(times**2 - 1))[:, None])
        self.sigma, self.noisier = times * self.sigma, times * self.noisier

    def sum_fewer(self, db: Floats) -> None:
        """Sum up fewer symbols, by dB <= 0 [n]: noise falls by half as many."""
        part = 10 ** (np.clip(db, None, 0) / 20)
        self.seen = part[:, None] * self.seen
        self.stir((self.sigma * np.sqrt(part * (1 - part)))[:, None])
        root = np.sqrt(part)
        self.sigma, self.noisier = root * self.sigma, root * self.noisier
        self.summed = part * self.summed

    def take(self, flaw: Flaw) -> None:
        """Let be wrong with waveforms what is wrong with their rows."""
        metres, whole, edge, noise, count = (
            np.zeros(len(self)) + np.asarray(one, np.float64) for one in flaw
        )
        self.outside_m = self.outside_m + metres
        if whole.any() or edge.any():
            self.dim(10 ** (self.come() * (whole[:, None] + self.lead() * edge[:, None]) / 20))
        if noise.any():
            self.louder(noise)
        if count.any():
            self.sum_fewer(count)

    def read(self) -> pd.DataFrame:
        """Return the table as it reads now."""
        later = arrivals(self.seen, self.sigma, self.blunt) - self.arrival
        was = self.table["first_path_index"].to_numpy(np.float64)
        index = np.clip(was + later, 4.0, WIDE_SAMPLES - 11.0)
        db = dials(self.seen, index, self.sigma) - dials(self.first_seen, was, self.sigma_before)
        db = db - 20 * np.log10(self.summed)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * later + self.outside_m
        return self.table.assign(
            first_path_index=index,
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + db[0],
            first_path_power_dbm=self.table["first_path_power_dbm"] + db[1],
            noise_std=self.table["noise_std"] * self.noisier,
            preamble_count=self.table["preamble_count"] * self.summed,
            cir_i=list(self.seen.real),
            cir_q=list(self.seen.imag),
        )
