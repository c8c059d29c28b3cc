"""The ferry's receiver: what comes over waveforms, and what its log has of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.ferry_deck import Lading, Swell

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 30, 232
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
CLEAR, SHARE = 6.5, 0.14  # times a component's scatter; of the largest size
SYMBOL = 2.6  # of a pulse with a raised cosine for its spectrum, in samples: as wide as it is
TIMES = np.arange(WIDE_SAMPLES, dtype=np.float64)
COLOUR = np.array([1.0, 0.24, -0.16])


def tones(middle: Floats) -> Floats:
    """Return pulses of height 1 with such middles in samples [n, k]: raised cosines' transforms."""
    x = 2 * (TIMES - middle[:, None]) / SYMBOL
    below = 1 - x**2
    near = np.abs(below) < 1e-6
    return np.asarray(np.where(near, 0.5, np.sinc(x) / np.where(near, 1.0, below)))


def static(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1, a little coloured, [size, k]."""
    white = rng.standard_normal((size, WIDE_SAMPLES + 2)) + 0j
    white += 1j * rng.standard_normal(white.shape)
    parts = [share * white[:, 2 - k : WIDE_SAMPLES + 2 - k] for k, share in enumerate(COLOUR)]
    return np.asarray(sum(parts) / np.sqrt(np.square(COLOUR).sum()))


def after_a_while(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]; nothing comes round from the end."""
    length = 3 * WIDE_SAMPLES // 2
    late = np.clip(samples, 0, WIDE_SAMPLES // 2 - 6)
    ramp = np.exp(-2j * np.pi * np.outer(late, np.fft.fftfreq(length)))
    return np.asarray(np.fft.ifft(np.fft.fft(waves, length) * ramp)[:, :WIDE_SAMPLES])


def tangents(waves: Complexes, sigma: Floats, lift: float = 0.0) -> Floats:
    """Return where tangents at the steepest ascents of first rises are zero, in samples [n].

    The first rise is by the first size that is clear of noise, `sigma` [n] of a component, and of
    a share of the largest. A `lift` asks for more of the largest, and times tangents higher up.
    """
    size, rows = np.abs(waves), np.arange(len(waves))
    largest = size.max(axis=1)
    limit = np.clip(CLEAR * sigma, (SHARE + 0.4 * lift) * largest, 0.8 * largest)
    first = np.clip((size >= limit[:, None]).argmax(axis=1), 5, WIDE_SAMPLES - 10)
    near = np.take_along_axis(size, first[:, None] + np.arange(-2, 4), axis=1)
    climbs = np.diff(near, axis=1)
    at = climbs.argmax(axis=1)
    slope = np.maximum(climbs[rows, at], 1e-9)
    middle, height = (near[rows, at] + near[rows, at + 1]) / 2, near.max(axis=1)
    return np.asarray(first - 2 + at + 0.5 + np.clip((lift * height - middle) / slope, -3, 3))


def powers_db(waves: Complexes, index: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy above noise of all samples, and of five at the first path [2, n]."""
    power = np.square(np.abs(waves))
    whole, noise = power.sum(axis=1), 2 * WIDE_SAMPLES * np.square(sigma)
    past = TIMES - np.floor(index)[:, None]
    first = (power * ((past >= 0) & (past < 5))).sum(axis=1)
    return np.asarray(10 * np.log10([np.maximum(whole - noise, 0.05 * whole), first]))


class Chain:
    """Waveforms of a table's rows along a receiver's chain.

    `sigma` [n]: of a component of noise now; `of_noise`, `of_count` [n]: factors of what is logged
    of noise and of symbols; `besides_m` [n]: metres that no waveform has; `lift`: of `tangents`.
    """

    def __init__(self, table: pd.DataFrame, sailing: int, rng: np.random.Generator) -> None:
        self.table, self.sailing, self.rng = table, sailing, rng
        real, imag = (np.vstack(list(table[name])) for name in ("cir_i", "cir_q"))
        self.given: Complexes = real.astype(np.float64) + 1j * imag.astype(np.float64)
        self.cir = self.given.copy()
        self.given_sigma = table["noise_std"].to_numpy(np.float64) / OF_NOISE
        self.sigma = self.given_sigma.copy()
        self.of_noise, self.of_count = np.ones((2, len(table)))
        self.besides_m = np.zeros(len(table))
        self.lift = 0.0
        self.start = tangents(self.given, self.sigma)
        self.past: Floats = TIMES - self.start[:, None]

    def lading(self) -> Lading:
        """Return the rows as they would be logged now."""
        return Lading(self.logged(), self.sailing, self.rng)

    def lasting(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([what, self.sailing, 774])

    def begun(self, over: float = 3.0) -> Floats:
        """Return 0 before first paths and 1 from there on [n, k], rising over some samples."""
        return np.asarray(np.clip((self.past + 1) / over + 1, 0, 1))

    def heard(self) -> Complexes:
        """Return what has come since first paths began, if noise is not as large as that.

        The set's noise is left out: it is made behind the aerial, where nothing rings or returns.
        """
        power = np.square(np.abs(self.cir) / self.sigma[:, None])
        return np.asarray(self.cir * self.begun() * np.clip((power - 10) / 6, 0, 1))

    def top(self) -> Floats:
        """Return the size of the first path [n]."""
        return np.asarray(np.abs(np.where(np.abs(self.past - 2) < 3, self.cir, 0)).max(axis=1))

    def phase(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(0, 2 * np.pi, len(self.table))))

    def weaken(self, left: Floats) -> None:
        """Leave a part of signals [n, k] and all of the noise."""
        lost = np.sqrt(np.maximum(1 - left * left, 0))
        self.cir = left * self.cir + lost * self.sigma[:, None] * static(self.rng, len(left))

    def noisier(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        by = 10 ** (db / 20)
        self.cir = self.cir + (self.sigma * np.sqrt(by**2 - 1))[:, None] * static(self.rng, len(db))
        self.sigma, self.of_noise = by * self.sigma, by * self.of_noise

    def shorter(self, part: Floats) -> None:
        """Add up a part of the symbols [n]: noise is left the root of it."""
        made = self.sigma * np.sqrt(part * (1 - part))
        self.cir = part[:, None] * self.cir + made[:, None] * static(self.rng, len(part))
        self.sigma, self.of_noise = self.sigma * part**0.5, self.of_noise * part**0.5
        self.of_count = self.of_count * part

    def overcome(self, swell: Swell) -> None:
        """Let what comes over rows come over their waveforms."""
        each = np.ones((len(self.table), 1))
        whole, edge, hiss, count = (
            np.asarray(one).reshape(-1, 1) * each
            for one in (swell.whole, swell.edge, swell.hiss, swell.count)
        )
        self.besides_m = self.besides_m + swell.metres
        if whole.any() or edge.any():
            fades = whole + edge * np.clip((11 - self.past) / 4, 0, 1)
            self.weaken(10 ** (self.begun() * fades / 20))
        if hiss.any():
            self.noisier(np.maximum(hiss[:, 0], 0))
        if count.any():
            self.shorter(10 ** (np.minimum(count[:, 0], 0) / 20))

    def logged(self) -> pd.DataFrame:
        """Return the table as it is logged now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        moved = tangents(self.cir, self.sigma, self.lift) - self.start
        index = np.clip(was + moved, 3, WIDE_SAMPLES - 9)
        rise = powers_db(self.cir, index, self.sigma) - 20 * np.log10(self.of_count)
        rise = rise - powers_db(self.given, was, self.given_sigma)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * moved + self.besides_m
        return self.table.assign(
            cir_i=list(self.cir.real),
            cir_q=list(self.cir.imag),
            first_path_index=index,
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + rise[0],
            first_path_power_dbm=self.table["first_path_power_dbm"] + rise[1],
            noise_std=self.table["noise_std"] * self.of_noise,
            preamble_count=self.table["preamble_count"] * self.of_count,
        )
