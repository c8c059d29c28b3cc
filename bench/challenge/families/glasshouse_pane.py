"""The glasshouse's receiver: what grows on waveforms, and what is written down of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.glasshouse_house import Crop, Growth

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 28, 184
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
OVER, SHARE = 6.8, 0.1  # times a component's scatter; of the largest size
HEIGHTS = (0.25, 0.5, 0.75)  # of a first summit, at which its rise is timed
WIDE = 1.4  # of a pulse, in samples
RUN_IN = 24  # samples that noise needs to be as coloured as it is
AXIS = np.arange(WIDE_SAMPLES).astype(np.float64)


def strikes(middle: Floats) -> Floats:
    """Return pulses of height 1 with such middles in samples [n, k]: of Butterworth's form."""
    return np.asarray(1 / (1 + ((AXIS[None, :] - middle[:, None]) / WIDE) ** 4))


def murmur(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1 that remembers 0.3 of itself, [size, k]."""
    fresh = rng.standard_normal((RUN_IN + WIDE_SAMPLES, size, 2)) @ np.array([1, 1j])
    fresh[1:] *= np.sqrt(1 - 0.3**2)
    for k in range(1, len(fresh)):
        fresh[k] += 0.3 * fresh[k - 1]
    return np.asarray(fresh[RUN_IN:].T)


def delayed(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]; what leaves at the end is gone."""
    late = np.clip(samples, 0.0, 120.0)
    spectrum = np.fft.fft(waves, 2 * WIDE_SAMPLES, axis=1)
    pitch = np.fft.fftfreq(2 * WIDE_SAMPLES)
    spectrum = spectrum * np.exp(-2j * np.pi * late[:, None] * pitch[None, :])
    return np.asarray(np.fft.ifft(spectrum, axis=1)[:, :WIDE_SAMPLES])


def rises(waves: Complexes, sigma: Floats, dull: float = 0.0) -> Floats:
    """Return the mean of where first summits' rises cross three of their heights, samples [n].

    The first summit is that after the first size over noise, `sigma` [n] of a component, and over
    a share of the largest. Dull ones ask for more of both, and time the upper part of a rise.
    """
    size = np.abs(waves)
    top = size.max(axis=1)
    bar = np.maximum(OVER * sigma, SHARE * top) * (1 + 1.1 * dull)
    first = (size >= np.minimum(bar, 0.7 * top)[:, None]).argmax(axis=1).clip(7, WIDE_SAMPLES - 12)
    near = np.take_along_axis(size, first[:, None] + np.arange(-6, 8), axis=1)
    falls = near[:, 6:-1] >= near[:, 7:]
    summit = 6 + falls.argmax(axis=1)
    height = near[np.arange(len(near)), summit]
    lift = 0.3 * min(dull, 2.0)
    times = [_crossing(near, summit, (one + (0.9 - one) * lift) * height) for one in HEIGHTS]
    return np.asarray(first - 6 + np.mean(times, axis=0))


def _crossing(near: Floats, summit: NDArray[np.intp], level: Floats) -> Floats:
    """Return where rises to summits last cross levels upward [n]."""
    place, rows = np.arange(near.shape[1]), np.arange(len(near))
    under = (near < level[:, None]) & (place < summit[:, None])
    low = np.where(under, place, 0).max(axis=1)
    below, above = near[rows, low], near[rows, low + 1]
    return np.asarray(low + np.clip((level - below) / np.maximum(above - below, 1e-9), 0, 1))


def strengths(waves: Complexes, index: Floats) -> Floats:
    """Return in dB the energy from the first path on, and that of its own few samples [2, n]."""
    power = np.square(waves.real) + np.square(waves.imag)
    since = AXIS[None, :] - index[:, None]
    whole = (power * (since > -6)).sum(axis=1)
    first = (power * np.clip(3 - np.abs(since - 1.2), 0, 1)).sum(axis=1)
    return np.asarray(10 * np.log10(np.stack([whole, first])))


class Pane:
    """Waveforms of a table's rows, on which things grow.

    `sigma` [n]: of a component of noise now; `noise_by`, `symbols_by` [n]: factors of what is
    written of them; `aside_m` [n]: metres that are not in waveforms; `dull`: of `rises`.
    """

    def __init__(self, table: pd.DataFrame, season: int, rng: np.random.Generator) -> None:
        self.table, self.season, self.rng = table, season, rng
        both = [np.stack(table[name].to_list()).astype(np.float64) for name in ("cir_i", "cir_q")]
        self.before: Complexes = both[0] + 1j * both[1]
        self.now = self.before.copy()
        self.sigma = table["noise_std"].to_numpy(np.float64) / OF_NOISE
        self.noise_by, self.symbols_by = np.ones(len(table)), np.ones(len(table))
        self.aside_m, self.dull = np.zeros(len(table)), 0.0
        self.rise = rises(self.before, self.sigma)
        self.since: Floats = AXIS[None, :] - self.rise[:, None]

    def crop(self) -> Crop:
        """Return the rows as they would be written down now."""
        return Crop(self.written(), self.season, self.rng)

    def sown(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([814, what, self.season])

    def on(self) -> Floats:
        """Return 0 until shortly before first paths, then 1 [n, k]; by half a cosine."""
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.clip((self.since + 5.5) / 2.5, 0, 1)))

    def front(self) -> Floats:
        """Return 1 as far as the first path goes, then 0 [n, k]."""
        return np.asarray(0.5 + 0.5 * np.cos(np.pi * np.clip((self.since - 7) / 4, 0, 1)))

    def signal(self) -> Complexes:
        """Return waveforms from the first path on, with what is lost in noise left out.

        Noise comes in behind the cable, so neither panes nor a stub return it.
        """
        rise = np.clip(np.abs(self.now) / self.sigma[:, None] - 3.1, 0, 1)
        return np.asarray(self.now * self.on() * rise * (2 - rise))

    def summit(self) -> Floats:
        """Return the size of the first path [n]."""
        return np.asarray(np.max(np.abs(self.now) * (np.abs(self.since - 1) < 3), axis=1))

    def phase(self) -> Complexes:
        """Return a phase for each row [n]."""
        turn = self.rng.normal(size=(len(self.table), 2)) @ np.array([1, 1j])
        return np.asarray(turn / np.abs(turn))

    def fill(self, sigma: Floats) -> Complexes:
        """Return noise of such components [n] or [n, k]."""
        wide = sigma if sigma.ndim == 2 else sigma[:, None]
        return np.asarray(wide * murmur(self.rng, len(self.table)))

    def shade(self, left: Floats) -> None:
        """Leave a part of signals [n, k], and noise as it was."""
        gone = np.sqrt(np.maximum(1 - np.square(left), 0))
        self.now = self.now * left + self.fill(gone * self.sigma[:, None])

    def louder_noise(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        by = np.exp(np.log(10) / 20 * np.maximum(db, 0))
        self.now = self.now + self.fill(self.sigma * np.sqrt(by * by - 1))
        self.sigma, self.noise_by = self.sigma * by, self.noise_by * by

    def fewer_symbols(self, part: Floats) -> None:
        """Add up a part of the symbols [n]: noise falls by its root."""
        self.now = part[:, None] * self.now + self.fill(self.sigma * np.sqrt(part * (1 - part)))
        self.sigma, self.noise_by = self.sigma * np.sqrt(part), self.noise_by * np.sqrt(part)
        self.symbols_by = self.symbols_by * part

    def take(self, growth: Growth) -> None:
        """Let waveforms have what grows on their rows."""
        none = np.zeros(len(self.table))
        whole, edge = none + growth.whole, none + growth.edge
        self.aside_m = self.aside_m + growth.metres
        if whole.any() or edge.any():
            fades = whole[:, None] + edge[:, None] * self.front()
            self.shade(10 ** (fades * self.on() / 20))
        if np.any(np.asarray(growth.hiss)):
            self.louder_noise(none + growth.hiss)
        if np.any(np.asarray(growth.count)):
            self.fewer_symbols(10 ** (np.minimum(none + growth.count, 0) / 20))

    def written(self) -> pd.DataFrame:
        """Return the table as it is written down now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        later = rises(self.now, self.sigma, self.dull) - self.rise
        index = np.clip(was + later, 4, WIDE_SAMPLES - 12)
        gain = strengths(self.now, index) - strengths(self.before, was)
        gain = gain - 20 * np.log10(self.symbols_by)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * later + self.aside_m
        factors = {"noise_std": self.noise_by, "preamble_count": self.symbols_by}
        return self.table.assign(
            first_path_index=index,
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + gain[0],
            first_path_power_dbm=self.table["first_path_power_dbm"] + gain[1],
            **{name: self.table[name] * by for name, by in factors.items()},
            cir_i=list(self.now.real),
            cir_q=list(self.now.imag),
        )
