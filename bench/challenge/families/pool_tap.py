"""The swimming hall's receiver: what becomes of waveforms, and what is written down of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.pool_basin import Change, Swims

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 28, 228
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
SURE, SHARE = 7.0, 0.13  # times a component's scatter; of the largest size
WIDTH = 0.95  # of a pulse, in samples
RISE = WIDTH * float(np.arccosh(2.0))  # from half of the height to the middle
PART = 0.5  # of the first crest, where its rise is timed
BOW = 0.083  # samples that straight lines between sizes are early, by trial


def pulses(middle: Floats) -> Floats:
    """Return pulses of height 1 with such middles in samples [n, k]: hyperbolic secants."""
    off = (np.arange(WIDE_SAMPLES) - middle[:, None]) / WIDTH
    return np.asarray(1 / np.cosh(np.clip(off, -40, 40)))


def hum(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1, neighbours alike, [size, k]."""
    white = rng.normal(size=(2, size, WIDE_SAMPLES + 1))
    mixed = (white[..., 1:] + 0.3 * white[..., :-1]) / np.sqrt(1.09)
    return np.asarray(mixed[0] + 1j * mixed[1])


def delayed(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]; what would be after the end is left out."""
    turns = np.fft.fftfreq(2 * WIDE_SAMPLES) * np.clip(samples, 0, WIDE_SAMPLES - 10)[:, None]
    spectra = np.fft.fft(waves, 2 * WIDE_SAMPLES, axis=1) * np.exp(-2j * np.pi * turns)
    return np.asarray(np.fft.ifft(spectra, axis=1)[:, :WIDE_SAMPLES])


def half_of_the_crest(waves: Complexes, least: Floats, stern: float = 1.0) -> Floats:
    """Return where the first crest's rise is at half of its height, in samples [n].

    The first crest is the largest of the five sizes from the first one above `least` [n] on. A
    sterner one times it higher up.
    """
    size, rows = np.abs(waves), np.arange(len(waves))
    most = size.max(axis=1)
    limit = np.minimum(np.maximum(least, min(SHARE * stern, 0.6) * most), 0.75 * most)
    first = np.clip((size > limit[:, None]).argmax(axis=1), 6, WIDE_SAMPLES - 12)
    near = np.take_along_axis(size, first[:, None] + np.arange(-5, 5), axis=1)
    rising = np.diff(near[:, 5:], axis=1) < 0
    top = np.where(rising.any(axis=1), rising.argmax(axis=1), 4) + 5
    aim = (1 - (1 - PART) / stern) * near[rows, top]
    below = (near < aim[:, None]) & (np.arange(10) < top[:, None])
    at = np.where(below.any(axis=1), 9 - below[:, ::-1].argmax(axis=1), 0)
    low, high = near[rows, at], near[rows, at + 1]
    part = np.clip((aim - low) / np.maximum(high - low, 1e-9), 0, 1)
    return np.asarray(first - 5 + at + part)


def energies(waves: Complexes, index: Floats) -> Floats:
    """Return in dB the energy of all samples, and of four from the first path on [2, n]."""
    power = np.square(np.abs(waves))
    ahead = np.arange(WIDE_SAMPLES) - np.ceil(index)[:, None]
    first = np.where((ahead >= 0) & (ahead < 4), power, 0).sum(axis=1)
    return np.asarray(10 * np.log10(np.stack([power.sum(axis=1), first]) + 1e-9))


class Tap:
    """Waveforms of a table's rows on their way from the antenna to the disk.

    `sigma` [n]: of a component of noise now; `noisier`, `fewer` [n]: factors of the noise written
    down and of the symbols; `extra_m` [n]: metres that come from elsewhere; `stern`: 1
    or more, where first paths are timed later.
    """

    def __init__(self, table: pd.DataFrame, meet: int, rng: np.random.Generator) -> None:
        self.table, self.meet, self.rng = table, meet, rng
        parts = [np.stack([*table[name]]).astype(np.float64) for name in ("cir_i", "cir_q")]
        self.before: Complexes = np.asarray(parts[0] + 1j * parts[1])
        self.waves = self.before.copy()
        self.sigma = table["noise_std"].to_numpy(np.float64) / OF_NOISE
        self.noisier, self.fewer, self.extra_m = np.ones((3, len(table)))
        self.extra_m = 0 * self.extra_m
        self.stern = 1.0
        self.edge = half_of_the_crest(self.before, SURE * self.sigma)
        self.since: Floats = np.arange(WIDE_SAMPLES) - self.edge[:, None]

    def swims(self) -> Swims:
        """Return the rows as they would be written down now."""
        return Swims(self.written(), self.meet, self.rng)

    def kept(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([734, what, self.meet])

    def there(self) -> Complexes:
        """Return waveforms without the noise before the first path, and without that after it.

        No water returns what the tap itself adds; that is whatever does not stand out.
        """
        out = np.clip(np.abs(self.waves) / (0.8 * self.sigma[:, None]) - 4, 0, 1)
        return np.asarray(self.waves * np.clip(self.since / 3 + 2.2, 0, 1) * out)

    def crest(self) -> Floats:
        """Return the size of the first path [n]."""
        near = (self.since > -1) & (self.since < 4)
        return np.asarray(np.where(near, np.abs(self.waves), 0).max(axis=1))

    def phases(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(-np.pi, np.pi, len(self.table))))

    def fade(self, left: Floats) -> None:
        """Leave a part of signals [n, k]; noise stays what it is."""
        fresh = np.sqrt(np.clip(1 - np.square(left), 0, None)) * self.sigma[:, None]
        self.waves = left * self.waves + fresh * hum(self.rng, len(left))

    def hiss(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        gain = 10 ** (np.maximum(db, 0) / 20)
        more = self.sigma * np.sqrt(np.square(gain) - 1)
        self.waves = self.waves + more[:, None] * hum(self.rng, len(db))
        self.sigma, self.noisier = self.sigma * gain, self.noisier * gain

    def stop_early(self, part: Floats) -> None:
        """Accumulate a part of the symbols [n]: noise falls by its root alone."""
        fresh = self.sigma * np.sqrt(part * (1 - part))
        self.waves = part[:, None] * self.waves + fresh[:, None] * hum(self.rng, len(part))
        self.sigma, self.noisier = self.sigma * np.sqrt(part), self.noisier * np.sqrt(part)
        self.fewer = self.fewer * part

    def befall(self, change: Change) -> None:
        """Let a change of rows befall waveforms."""
        ones = np.ones(len(self.table))
        whole, edge = (np.asarray(one * ones)[:, None] for one in (change.whole, change.edge))
        self.extra_m = self.extra_m + change.metres
        if np.any(whole) or np.any(edge):
            begun = np.clip(self.since / 3 + 2.2, 0, 1)
            self.fade(10 ** (begun * (whole + edge * np.clip(2.5 - self.since / 4, 0, 1)) / 20))
        if np.any(change.hiss):
            self.hiss(change.hiss * ones)
        if np.any(change.count):
            self.stop_early(10 ** (np.minimum(change.count * ones, 0) / 20))

    def written(self) -> pd.DataFrame:
        """Return the table as it is written down now."""
        found = half_of_the_crest(self.waves, SURE * self.sigma, self.stern)
        moved = found - self.edge
        was = self.table["first_path_index"].to_numpy(np.float64)
        index = np.clip(was + moved, 2, WIDE_SAMPLES - 8)
        gain = energies(self.waves, index) - energies(self.before, was) - 20 * np.log10(self.fewer)
        error = self.table["error_m"] + METRES * moved + self.extra_m
        return self.table.assign(
            first_path_index=index,
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + gain[0],
            first_path_power_dbm=self.table["first_path_power_dbm"] + gain[1],
            noise_std=self.table["noise_std"] * self.noisier,
            preamble_count=self.table["preamble_count"] * self.fewer,
            cir_i=[*self.waves.real],
            cir_q=[*self.waves.imag],
        )
