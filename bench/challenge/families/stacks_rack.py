"""The archive's receiver: what becomes of waveforms, and what is put on record of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.stacks_plan import Entry, Files

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 26, 168
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
LOUDER, SHARE = 6.2, 0.12  # than a component's scatter; of the largest size
FRACTION, BEFORE = 0.5, 2  # of a size that the one so many samples before it is to have
STEEP, FLAT = 0.95, 1.45  # widths of a pulse before and after its middle, in samples
GRID = np.arange(WIDE_SAMPLES, dtype=np.float64)


def knocks(middle: Floats) -> Floats:
    """Return pulses of height 1 with such middles in samples [n, k]: bells that fall slower."""
    off = GRID - middle[:, None]
    return np.asarray(np.exp(-0.5 * np.square(off / np.where(off < 0, STEEP, FLAT))))


def rustle(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1, the less of it the faster it is, [size, k]."""
    white = rng.normal(size=(size, WIDE_SAMPLES)) + 1j * rng.normal(size=(size, WIDE_SAMPLES))
    shape = 1 + 0.45 * np.cos(2 * np.pi * np.fft.fftfreq(WIDE_SAMPLES))
    shaped = np.fft.ifft(np.fft.fft(white, axis=1) * shape / np.sqrt(np.square(shape).mean()))
    return np.asarray(shaped)


def shifted(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n], without what would come round."""
    much = np.clip(samples, 0, 110)[:, None]
    padded = np.pad(waves, ((0, 0), (0, 112)))
    turns = np.exp(-2j * np.pi * much * np.fft.fftfreq(padded.shape[1]))
    return np.asarray(np.fft.ifft(np.fft.fft(padded, axis=1) * turns, axis=1)[:, :WIDE_SAMPLES])


def first_knocks(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return where first paths are by a discriminator of a constant fraction, in samples [n].

    From the first size that is louder than noise, `sigma` [n] of a component, and than a share of
    the largest: where the size BEFORE is a FRACTION of it. Deafer ones want more of both.
    """
    size, rows = np.abs(waves), np.arange(len(waves))
    largest = size.max(axis=1)
    least = np.maximum(LOUDER * (1 + deaf) * sigma, SHARE * (1 + deaf) * largest)
    loud = size >= np.minimum(least, 0.75 * largest)[:, None]
    begin = np.clip(loud.argmax(axis=1), 5, WIDE_SAMPLES - 12)
    near = begin[:, None] + np.arange(0, 8)
    fraction = 1 - (1 - FRACTION) / (1 + 0.8 * deaf)
    over = np.take_along_axis(size, near - BEFORE, axis=1)
    over = over - fraction * np.take_along_axis(size, near, axis=1)
    at = np.maximum((over > 0).argmax(axis=1), 1)
    low, high = over[rows, at - 1], over[rows, at]
    part = np.clip(-low / np.maximum(high - low, 1e-9), -1, 1)
    return np.asarray(begin + at - 1 + part)


def loudness(waves: Complexes, index: Floats) -> Floats:
    """Return in dB the energy of all samples, and of a bell around the first path [2, n]."""
    power = waves.real**2 + waves.imag**2
    bell = np.exp(-np.square((GRID - index[:, None] + 0.4) / 2.2))
    return np.asarray(10 * np.log10(np.array([power.sum(axis=1), (bell * power).sum(axis=1)])))


class Rack:
    """Waveforms of a table's rows, as they are put through a rack of units one after another.

    `sigma` [n]: of a component of noise now; `noise_gain`, `symbol_gain` [n]: factors of what is
    put on record; `off_record_m` [n]: metres that waveforms do not show; `deaf`: of `first_knocks`.
    """

    def __init__(self, table: pd.DataFrame, volume: int, rng: np.random.Generator) -> None:
        self.table, self.volume, self.rng = table, volume, rng
        cirs = (np.array(table[name].tolist(), np.float64) for name in ("cir_i", "cir_q"))
        self.first: Complexes = np.asarray(next(cirs) + 1j * next(cirs))
        self.wave = self.first.copy()
        self.sigma = np.asarray(table["noise_std"], np.float64) / OF_NOISE
        self.noise_gain = np.ones(len(table))
        self.symbol_gain = np.ones(len(table))
        self.off_record_m = np.zeros(len(table))
        self.deaf = 0.0
        self.knock = first_knocks(self.first, self.sigma)
        self.delay: Floats = GRID - self.knock[:, None]

    def files(self) -> Files:
        """Return the rows as they would be on record now."""
        return Files(self.on_record(), self.volume, self.rng)

    def bound(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([794, self.volume, what])

    def begun(self) -> Floats:
        """Return 0 before first paths, and 1 from their rise on [n, k]."""
        return np.asarray(1 / (1 + np.exp(-2.5 * np.clip(self.delay + 4.5, -20, 20))))

    def early(self) -> Floats:
        """Return 1 until some samples after first paths, and 0 later [n, k]."""
        return np.asarray(1 / (1 + np.exp(np.clip(self.delay - 9.0, -30, 30))))

    def heard(self) -> Complexes:
        """Return waveforms with nothing before the first path, nor any rustle of the rack's own.

        Less than 3 of its scatters are nothing, more than 4.2 all there is.
        """
        sure = np.clip((np.abs(self.wave) - 3 * self.sigma[:, None]) / self.sigma[:, None], 0, 1.2)
        return np.asarray(self.begun() * (sure / 1.2) * self.wave)

    def size(self) -> Floats:
        """Return the size of the first path [n]."""
        return np.asarray(np.where(np.abs(self.delay) < 3, np.abs(self.wave), 0).max(axis=1))

    def turn(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(len(self.table))))

    def dim(self, left: Floats) -> None:
        """Leave a part of signals [n, k], in noise as it was."""
        fill = np.sqrt(np.clip(1 - left**2, 0, 1)) * self.sigma[:, None]
        self.wave = self.wave * left + fill * rustle(self.rng, len(left))

    def raise_noise(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        times = np.power(10, np.maximum(db, 0) / 20)
        fill = self.sigma * np.sqrt(times**2 - 1)
        self.wave = self.wave + fill[:, None] * rustle(self.rng, len(db))
        self.sigma, self.noise_gain = self.sigma * times, self.noise_gain * times

    def stop(self, part: Floats) -> None:
        """Add up a part of the symbols [n], and the root of it of noise."""
        fill, root = self.sigma * np.sqrt(part - part**2), np.sqrt(part)
        self.wave = self.wave * part[:, None] + fill[:, None] * rustle(self.rng, len(part))
        self.sigma, self.noise_gain = self.sigma * root, self.noise_gain * root
        self.symbol_gain = self.symbol_gain * part

    def enter(self, entry: Entry) -> None:
        """Let waveforms have what is entered for their rows."""
        parts = (entry.whole, entry.edge, entry.hiss, entry.count)
        whole, edge, hiss, count = (np.broadcast_to(one, len(self.table)) for one in parts)
        self.off_record_m = self.off_record_m + entry.metres
        if np.any(whole) or np.any(edge):
            db = whole[:, None] + self.early() * edge[:, None]
            self.dim(10 ** (self.begun() * db / 20))
        if np.any(hiss):
            self.raise_noise(hiss)
        if np.any(count):
            self.stop(10 ** (np.minimum(count, 0) / 20))

    def on_record(self) -> pd.DataFrame:
        """Return the table as it is put on record now."""
        was = np.asarray(self.table["first_path_index"], np.float64)
        moved = first_knocks(self.wave, self.sigma, self.deaf) - self.knock
        index = np.clip(was + moved, 4, WIDE_SAMPLES - 10)
        grew = loudness(self.wave, index) - loudness(self.first, was)
        grew = grew - 20 * np.log10(self.symbol_gain)
        out = self.table.assign(cir_i=[*self.wave.real], cir_q=[*self.wave.imag])
        out["first_path_index"] = index
        out["error_m"] = self.table["error_m"] + METRES * moved + self.off_record_m
        out["range_m"] = self.table["true_range_m"] + out["error_m"]
        out["rx_power_dbm"] = self.table["rx_power_dbm"] + grew[0]
        out["first_path_power_dbm"] = self.table["first_path_power_dbm"] + grew[1]
        out["noise_std"] = self.table["noise_std"] * self.noise_gain
        out["preamble_count"] = self.table["preamble_count"] * self.symbol_gain
        return out
