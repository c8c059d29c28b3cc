"""The harbour's radio: waveforms while something happens to them, and what it writes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.harbour_effects import Gained, Log

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 28, 232
SAMPLE_M = 0.299792458 * 1.0016
SIZES = 0.65514  # standard deviation of sizes of noise, next to that of a component
NOTICED, OF_TALLEST = 8.0, 0.1  # times a component's standard deviation; share of the largest
LOBE, FADES = 2.4, 2.6  # samples: zeros of the pulse, and how soon its side lobes are gone


def pulses(middle: Floats) -> Floats:
    """Return pulses of height 1 [n, k] with these middles in samples [n]: a windowed sinc."""
    gap = np.arange(WIDE_SAMPLES) - middle[:, None]
    return np.asarray(np.sinc(gap / LOBE) * np.exp(-(np.minimum(np.abs(gap) / FADES, 9) ** 2)))


def put_off(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms that come later by samples >= 0 [n], in a spectrum twice as long."""
    most = waves.shape[1]
    per_sample = -2j * np.pi * np.fft.fftfreq(2 * most)
    turned = np.fft.fft(waves, n=2 * most, axis=-1) * np.exp(samples[:, None] * per_sample)
    return np.asarray(np.fft.ifft(turned, axis=-1)[:, :most])


def onsets(waves: Complexes, noticed: Floats) -> Floats:
    """Return where first paths begin, in samples [n].

    The tangent where the rise to the first peak above `noticed` [n] is steepest meets 0.45 of it.
    """
    size = np.abs(waves)
    limit = np.clip(noticed, OF_TALLEST * size.max(axis=1), 0.9 * size.max(axis=1))[:, None]
    inner = size[:, 1:-1]
    peaks = (inner > limit) & (inner >= size[:, :-2]) & (inner > size[:, 2:])
    peak = np.where(peaks.any(axis=1), peaks.argmax(axis=1) + 1, size.argmax(axis=1))
    number = np.arange(len(size))
    before = np.clip(peak[:, None] - np.arange(1, 5), 0, size.shape[1] - 2)
    rises = np.take_along_axis(size, before + 1, axis=1) - np.take_along_axis(size, before, axis=1)
    steep = before[number, rises.argmax(axis=1)]
    slope = np.maximum(rises.max(axis=1), 1e-6)
    missing = 0.45 * size[number, peak] - size[number, steep]
    return np.asarray(np.clip(steep + np.clip(missing / slope, -1.5, 2.0), 0, size.shape[1] - 6))


def sums(waves: Complexes, index: Floats) -> dict[str, Floats]:
    """Return the energies [n] that levels are made of: of all samples, and of three."""
    energy = np.abs(waves) ** 2
    three = np.floor(index).astype(np.intp)[:, None] + (1, 2, 3)
    near = np.take_along_axis(energy, np.minimum(three, energy.shape[1] - 1), axis=1)
    return {"rx_power_dbm": energy.sum(axis=1), "first_path_power_dbm": near.sum(axis=1)}


class Frames:
    """Waveforms of a table's rows, which effects change; `written` is what the radio logs then.

    `unseen_m` [n]: metres that no waveform shows; `spread` [n]: standard deviation of a component
    of the noise now; `told`, `summed` [n]: factors of the logged noise and of the symbols.
    """

    def __init__(self, table: pd.DataFrame, own: int, rng: np.random.Generator) -> None:
        self.table, self.own, self.rng = table, own, rng
        parts = [np.array(table[name].tolist(), np.float64) for name in ("cir_i", "cir_q")]
        self.began: Complexes = np.asarray(parts[0] + 1j * parts[1])
        self.now, self.harder = self.began.copy(), 1.0
        self.spread = table["noise_std"].to_numpy(np.float64) / SIZES
        self.unseen_m, ones = np.zeros(len(table)), np.ones(len(table))
        self.told, self.summed = ones.copy(), ones.copy()
        self.onset = onsets(self.began, NOTICED * self.spread)

    def __len__(self) -> int:
        return len(self.table)

    def log(self) -> Log:
        """Return the rows as they would be written now."""
        return Log(self.written(), self.own, self.rng)

    def fixed(self, stream: str) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.own, 5, *stream.encode()])

    def late(self) -> Floats:
        """Return samples since the first path as it was at first [n, k]."""
        return np.asarray(np.arange(WIDE_SAMPLES, dtype=np.float64) - self.onset[:, None])

    def wanted(self) -> Complexes:
        """Return what is received from the first path on [n, k], the radio's noise left out.

        Before it that is all there is, and after it whatever is no larger than noise gets.
        """
        stands_out = 1 / (1 + np.exp(-8 * (np.abs(self.now) / self.spread[:, None] - 3.8)))
        return np.asarray(self.now * np.clip((self.late() + 8) / 3, 0, 1) * stands_out)

    def tall(self) -> Floats:
        """Return how tall the first path is [n]."""
        return np.asarray((np.abs(self.now) * (np.abs(self.late() - 1.5) < 4)).max(axis=1))

    def any_phase(self) -> Complexes:
        """Return a turn of each row [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(len(self))))

    def white(self, spread: Floats) -> Complexes:
        """Return white noise with components of a standard deviation [n] or [n, k]."""
        wide = spread if spread.ndim == 2 else spread[:, None]
        made = self.rng.standard_normal((len(self), WIDE_SAMPLES, 2)) * wide[..., None]
        return np.asarray(made[..., 0] + 1j * made[..., 1])

    def fade(self, factor: Floats) -> None:
        """Let signals be larger or smaller by factors [n, k], but not the noise."""
        lost = np.sqrt(np.clip(1 - factor * factor, 0, None))
        self.now = factor * self.now + self.white(lost * self.spread[:, None])

    def hotter(self, factor: Floats) -> None:
        """Let noise be larger by factors >= 1 [n]."""
        self.now = self.now + self.white(self.spread * np.sqrt(factor * factor - 1))
        self.spread, self.told = self.spread * factor, self.told * factor

    def cut_short(self, share: Floats) -> None:
        """Sum up a share <= 1 of the symbols [n]: signals with it, noise with its root."""
        self.now = share[:, None] * self.now + self.white(
            self.spread * np.sqrt(share * (1 - share))
        )
        for name in ("spread", "told"):
            setattr(self, name, getattr(self, name) * np.sqrt(share))
        self.summed = self.summed * share

    def carry(self, got: Gained) -> None:
        """Let what rows gained happen to waveforms."""
        none = np.zeros(len(self))
        self.unseen_m = self.unseen_m + got.get("m", none)
        every, edge = got.get("db", none)[:, None], got.get("edge_db", none)[:, None]
        if every.any() or edge.any():
            there = 1 / (1 + np.exp(-3 * (self.late() + 6)))
            first = 1 / (1 + np.exp(2 * (self.late() - 5)))
            self.fade(10 ** (there * (every + edge * first) / 20))
        if "hiss_db" in got:
            self.hotter(10 ** (got["hiss_db"] / 20))
        if "count_db" in got:
            self.cut_short(10 ** (np.minimum(got["count_db"], 0) / 20))

    def written(self) -> pd.DataFrame:
        """Return the table as the radio writes it now."""
        onset = onsets(self.now, NOTICED * self.harder * self.spread)
        old = self.table["first_path_index"].to_numpy(np.float64)
        index = np.clip(old + onset - self.onset, 1, WIDE_SAMPLES - 6)
        error = self.table["error_m"] + self.unseen_m + (onset - self.onset) * SAMPLE_M
        before, after = sums(self.began, old), sums(self.now, index)
        levels = {
            name: self.table[name] + 10 * np.log10(after[name] / before[name] / self.summed**2)
            for name in before
        }
        return self.table.assign(
            error_m=error, range_m=self.table["true_range_m"] + error, first_path_index=index,
            noise_std=self.table["noise_std"] * self.told,
            preamble_count=self.table["preamble_count"] * self.summed,
            cir_i=list(self.now.real), cir_q=list(self.now.imag), **levels,
        )  # fmt: skip
