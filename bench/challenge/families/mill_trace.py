"""Impulse responses of the mill's radio while something is done to them, and what it logs then.

numpy and pandas alone. All arrays are complex [n, WIDE_SAMPLES] in counts unless said otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.mill_effects import Change, Rows

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 30, 240
SAMPLE_M = 1.0016 * 0.299792458
PULSE = 0.85  # samples: |p(t)| = 1 / cosh(t / PULSE)
RAYLEIGH = 0.6551  # standard deviation of a size over that of a component
DETECT = 11.0  # times a component's standard deviation


def later(cir: Complexes, samples: Floats) -> Complexes:
    """Return waveforms that come later by samples [n], nothing wrapped around."""
    turns = np.fft.fftfreq(2 * cir.shape[1])
    spectrum = np.fft.fft(cir, 2 * cir.shape[1], axis=1)
    moved = np.fft.ifft(spectrum * np.exp(-2j * np.pi * np.outer(samples, turns)), axis=1)
    return np.asarray(moved[:, : cir.shape[1]])


def edges(cir: Complexes, floor: Floats) -> Floats:
    """Return where the first peak that stands out from floors [n] rises through half of it [n]."""
    size, rows = np.abs(cir), np.arange(len(cir))
    least = np.minimum(np.maximum(floor, 0.1 * size.max(axis=1)), 0.95 * size.max(axis=1))
    first = np.argmax(size > least[:, None], axis=1)
    place = np.arange(size.shape[1])
    falls = np.diff(size, axis=1, append=0.0) < 0
    top = np.argmax(falls & (place >= first[:, None]), axis=1)
    half = size[rows, top] / 2
    low = (size < half[:, None]) & (place < top[:, None])
    last = np.maximum(size.shape[1] - 1 - np.argmax(low[:, ::-1], axis=1), 0)
    last = np.where(low.any(axis=1), last, 0)
    after = np.minimum(last + 1, size.shape[1] - 1)
    rise = np.maximum(size[rows, after] - size[rows, last], 1e-9)
    return np.asarray(last + np.clip((half - size[rows, last]) / rise, 0, 1))


def three(cir: Complexes, index: Floats) -> Floats:
    """Return the energy of the three samples after a first path [n]."""
    at = np.clip(np.floor(index).astype(int)[:, None] + [1, 2, 3], 0, cir.shape[1] - 1)
    return np.asarray((np.abs(np.take_along_axis(cir, at, axis=1)) ** 2).sum(axis=1))


@dataclass
class Trace:
    """Waveforms of a table as they are changed: what the radio logs changes as they do.

    `late_m`, `symbols`, `hiss` and `told` [n]: metres that no waveform shows; factors of symbols
    accumulated, of noise in the samples, and of the noise that is logged. `deaf`: of the floor.
    """

    table: pd.DataFrame
    own: int
    rng: np.random.Generator
    cir: Complexes = field(init=False)
    deaf: float = 1.0

    def __post_init__(self) -> None:
        real, imaginary = (np.stack(list(self.table[name])) for name in ("cir_i", "cir_q"))
        self.before = np.asarray(real + 1j * imaginary, np.complex128)
        self.cir = self.before.copy()
        count = len(self.table)
        self.late_m, self.symbols = np.zeros(count), np.ones(count)
        self.hiss, self.told = np.ones(count), np.ones(count)
        self.sigma = self.table["noise_std"].to_numpy(np.float64) / RAYLEIGH
        self.was = edges(self.before, DETECT * self.sigma)

    def rows(self) -> Rows:
        """Return the rows as they would be logged now."""
        return Rows(self.logged(), self.own, self.rng)

    def edge(self) -> Floats:
        """Return where the radio sees the first path now, in samples [n]."""
        return edges(self.cir, DETECT * self.deaf * self.sigma * self.hiss)

    def since(self) -> Floats:
        """Return samples since the first path that was there at first [n, k]."""
        return np.asarray(np.arange(self.cir.shape[1]) - self.was[:, None], np.float64)

    def signal(self) -> Complexes:
        """Return what the antenna has: nothing before the first path, and no noise after it.

        Of that is what is too small; it counts the less the smaller it is.
        """
        noise = 3.7 * (self.sigma * self.hiss)[:, None]
        clear = 1 / (1 + (noise / np.maximum(np.abs(self.cir), 0.1 * noise)) ** 12)
        return np.asarray(self.cir * (self.since() > -7) * clear)

    def height(self) -> Floats:
        """Return the largest size within five samples of the first path [n]."""
        near = (self.since() > -1) & (self.since() < 5)
        return np.asarray((np.abs(self.cir) * near).max(axis=1))

    def noise(self, size: Floats) -> Complexes:
        """Return complex noise whose components have a standard deviation that fits [n, k]."""
        shape = self.cir.shape
        drawn = self.rng.normal(size=shape) + 1j * self.rng.normal(size=shape)
        return np.asarray(drawn * size)

    def times(self, factor: Floats) -> None:
        """Let signals be larger or smaller [n, k], in noise that stays as it is."""
        filled = np.sqrt(np.maximum(1 - factor**2, 0))
        self.cir = self.cir * factor + self.noise(filled * (self.sigma * self.hiss)[:, None])

    def noisier(self, factor: Floats) -> None:
        """Let samples have more noise, by factors of at least 1 [n]."""
        more = np.sqrt(np.maximum(factor**2 - 1, 0)) * self.sigma * self.hiss
        self.cir = self.cir + self.noise(more[:, None])
        self.hiss, self.told = self.hiss * factor, self.told * factor

    def fewer(self, share: Floats) -> None:
        """Let fewer symbols be accumulated: signals fall in proportion, noise as the root [n]."""
        more = np.sqrt(np.maximum(share - share**2, 0)) * self.sigma * self.hiss
        self.cir = self.cir * share[:, None] + self.noise(more[:, None])
        self.symbols = self.symbols * share
        self.hiss, self.told = self.hiss * np.sqrt(share), self.told * np.sqrt(share)

    def take(self, change: Change) -> None:
        """Let a change of rows happen to the waveforms."""
        one = np.ones(len(self.table))
        self.late_m = self.late_m + change.longer_m
        after = np.clip((self.since() + 7) / 2, 0, 1)
        early = 0.5 + 0.5 * np.cos(np.pi * np.clip((self.since() - 3) / 3, 0, 1))
        louder, straight = change.louder_db * one, change.straight_db * one
        if np.any(louder) or np.any(straight):
            self.times(10 ** ((louder[:, None] * after + straight[:, None] * after * early) / 20))
        self.noisier(change.noisier * one)
        self.fewer(change.symbols * one)

    def logged(self) -> pd.DataFrame:
        """Return the table as the radio logs it now."""
        now = self.edge()
        began = self.table["first_path_index"].to_numpy(np.float64)
        index = np.clip(began + (now - self.was), 1, self.cir.shape[1] - 5)
        error = self.table["error_m"] + self.late_m + (now - self.was) * SAMPLE_M
        per = 20 * np.log10(self.symbols)
        energies = [(np.abs(one) ** 2).sum(axis=1) for one in (self.before, self.cir)]
        firsts = [three(self.before, began), three(self.cir, index)]
        rise, first = (10 * np.log10(new / old) - per for old, new in (energies, firsts))
        return self.table.assign(
            error_m=error, range_m=self.table["true_range_m"] + error, first_path_index=index,
            rx_power_dbm=self.table["rx_power_dbm"] + rise,
            first_path_power_dbm=self.table["first_path_power_dbm"] + first,
            noise_std=self.table["noise_std"] * self.told,
            preamble_count=self.table["preamble_count"] * self.symbols,
            cir_i=list(self.cir.real), cir_q=list(self.cir.imag),
        )  # fmt: skip
