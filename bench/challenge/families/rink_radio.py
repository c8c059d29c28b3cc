"""The rink's receiver: what is cut into waveforms, and what is written down of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.rink_ice import Cut, Sheet

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 26, 190
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
STANDS_OUT, SHARE = 6.6, 0.12  # times a component's scatter; of the largest size
BACK, FRACTION = 2, 0.5  # samples by which a copy is late, and the part of a size it is compared to
WIDTH = 1.45  # of a pulse, in samples
INDEX = np.arange(WIDE_SAMPLES, dtype=np.float64)


def bursts(crest: Floats) -> Floats:
    """Return pulses of height 1 with such crests in samples [n, k]: squares of secants."""
    return np.asarray(np.cosh(np.clip((INDEX - crest[:, None]) / WIDTH, -40, 40)) ** -2.0)


def crackle(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1, neighbours alike by 0.3, [size, k]."""
    white = rng.standard_normal((size, WIDE_SAMPLES)) + 1j * rng.standard_normal(
        (size, WIDE_SAMPLES)
    )
    shape = np.sqrt(1 + 0.6 * np.cos(2 * np.pi * np.fft.fftfreq(WIDE_SAMPLES)))
    return np.asarray(np.fft.ifft(np.fft.fft(white) * shape))


def behindhand(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: whole ones, and Lagrange's cubic between."""
    late = np.clip(samples, 0.0, 125.0)
    whole = np.floor(late).astype(np.intp)
    d = (late - whole)[:, None]
    padded = np.pad(waves, ((0, 0), (128, 1)))
    start = 128 - whole[:, None] + np.arange(WIDE_SAMPLES)
    taps = (
        -d * (d - 1) * (d - 2) / 6,
        (d + 1) * (d - 1) * (d - 2) / 2,
        -(d + 1) * d * (d - 2) / 2,
        (d + 1) * d * (d - 1) / 6,
    )
    parts = (tap * np.take_along_axis(padded, start - k, 1) for k, tap in enumerate(taps, -1))
    return np.asarray(sum(parts))


def crests(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return where first pulses are: where a part of a size is that of two samples before [n].

    A constant fraction, of the first size over noise, `sigma` [n] of a component, and over a share
    of the largest. Deaf ones ask for more of both, and for a larger fraction, which comes later.
    """
    size = np.abs(waves)
    top = size.max(axis=1)
    bar = (1 + 1.2 * deaf) * np.maximum(STANDS_OUT * sigma, SHARE * top)
    first = (size >= np.minimum(bar, 0.72 * top)[:, None]).argmax(axis=1)
    first = np.clip(first, 8, WIDE_SAMPLES - 16)
    near = np.take_along_axis(size, first[:, None] + np.arange(-BACK, 11), axis=1)
    balance = min(FRACTION + 0.3 * deaf, 0.92) * near[:, BACK:] - near[:, :-BACK]
    crossed = (balance[:, :-1] > 0) & (balance[:, 1:] <= 0)
    at = crossed.argmax(axis=1)
    rows = np.arange(len(at))
    one, two = balance[rows, at], balance[rows, at + 1]
    part = np.where(crossed[rows, at], one / np.maximum(one - two, 1e-9), 1.0)
    return np.asarray(first + at + np.clip(part, 0, 1))


def levels(waves: Complexes, index: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy after first paths without noise's, and that of these [2, n]."""
    power = np.abs(waves) ** 2 - 2 * np.square(sigma)[:, None]
    since = INDEX - index[:, None]
    first = np.maximum((power * (np.abs(since) < 3)).sum(axis=1), np.square(sigma))
    whole = np.maximum((power * (since > -6)).sum(axis=1), 1.05 * first)
    return np.asarray(10 * np.log10(np.stack([whole, 0.9 * first])))


class Record:
    """Waveforms of a table's rows, cut after cut.

    `sigma` [n]: of a component of noise now; `louder`, `fewer` [n]: factors of what is written of
    noise and symbols; `beside_m` [n]: metres that waveforms do not have; `deaf`: of `crests`.
    """

    def __init__(self, table: pd.DataFrame, night: int, rng: np.random.Generator) -> None:
        self.table, self.night, self.rng = table, night, rng
        self.first: Complexes = np.stack(table["cir_i"].to_list()) + 1j * np.stack(
            table["cir_q"].to_list()
        )
        self.first = self.first.astype(np.complex128)
        self.cir = self.first.copy()
        self.before = table["noise_std"].to_numpy(np.float64) / OF_NOISE
        self.sigma = self.before.copy()
        size = len(table)
        self.louder, self.fewer, self.beside_m = np.ones(size), np.ones(size), np.zeros(size)
        self.deaf = 0.0
        self.crest = crests(self.first, self.sigma)
        self.since: Floats = INDEX - self.crest[:, None]

    def sheet(self) -> Sheet:
        """Return the rows as they would be written down now."""
        return Sheet(self.written(), self.night, self.rng)

    def frozen(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([854, self.night, what])

    def open(self) -> Floats:
        """Return 0 until shortly before first pulses, then 1 [n, k]: a smooth step."""
        x = np.clip((self.since + 6.0) / 2.0, 0, 1)
        return np.asarray(x * x * (3 - 2 * x))

    def direct(self) -> Floats:
        """Return 1 as long as first pulses last, then 0 [n, k]: a smooth step."""
        x = np.clip((9.0 - self.since) / 4.5, 0, 1)
        return np.asarray(x * x * (3 - 2 * x))

    def heard(self) -> Complexes:
        """Return waveforms from the first pulse on, where these are not the radio's own crackle."""
        above = np.clip((np.abs(self.cir) / self.sigma[:, None] - 3.0) / 1.1, 0, 1)
        return np.asarray(self.cir * self.open() * np.sin(0.5 * np.pi * above))

    def crest_size(self) -> Floats:
        """Return the size of first pulses [n]."""
        return np.asarray((np.abs(self.cir) * (np.abs(self.since) < 3)).max(axis=1))

    def turn(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(0, 2 * np.pi, len(self.table))))

    def more_noise(self, sigma: Floats) -> None:
        """Add noise of such components [n] or [n, k]."""
        wide = sigma if sigma.ndim == 2 else sigma[:, None]
        self.cir = self.cir + wide * crackle(self.rng, len(self.table))

    def dim(self, left: Floats) -> None:
        """Leave a part of signals [n, k], and noise as it was."""
        self.cir = self.cir * left
        self.more_noise(self.sigma[:, None] * np.sqrt(np.clip(1 - left**2, 0, None)))

    def hiss(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        by = 10 ** (np.maximum(db, 0.0) / 20)
        self.more_noise(self.sigma * np.sqrt(by**2 - 1))
        self.sigma, self.louder = self.sigma * by, self.louder * by

    def sum_fewer(self, part: Floats) -> None:
        """Add up a part of the symbols [n]: noise falls by its root."""
        self.cir = self.cir * part[:, None]
        self.more_noise(self.sigma * np.sqrt(part * (1 - part)))
        self.sigma, self.louder = self.sigma * part**0.5, self.louder * part**0.5
        self.fewer = self.fewer * part

    def take(self, cut: Cut) -> None:
        """Cut into waveforms what is cut into their rows."""
        shape = len(self.table)
        self.beside_m = self.beside_m + cut.metres
        whole, edge, hiss, count = (
            np.broadcast_to(np.asarray(one, np.float64), shape)
            for one in (cut.whole, cut.edge, cut.hiss, cut.count)
        )
        if whole.any() or edge.any():
            db = whole[:, None] + edge[:, None] * self.direct()
            self.dim(10 ** (db * self.open() / 20))
        if hiss.any():
            self.hiss(hiss)
        if count.any():
            self.sum_fewer(10 ** (np.minimum(count, 0) / 20))

    def written(self) -> pd.DataFrame:
        """Return the table as it is written down now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        later = crests(self.cir, self.sigma, self.deaf) - self.crest
        index = np.clip(was + later, 5, WIDE_SAMPLES - 14)
        gain = levels(self.cir, index, self.sigma) - levels(self.first, was, self.before)
        gain = gain - 20 * np.log10(self.fewer)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * later + self.beside_m
        return self.table.assign(
            first_path_index=index,
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + gain[0],
            first_path_power_dbm=self.table["first_path_power_dbm"] + gain[1],
            noise_std=self.table["noise_std"] * self.louder,
            preamble_count=self.table["preamble_count"] * self.fewer,
            cir_i=[*self.cir.real],
            cir_q=[*self.cir.imag],
        )
