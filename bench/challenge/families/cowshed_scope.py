"""The cowshed's receiver: what befalls waveforms, and what its scope reads of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.cowshed_barn import Herd, Trouble

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 34, 194
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
SEEN, OF_LARGEST = 6.2, 0.13  # times a component's scatter; of the largest size
EARLY_PART = 0.2  # of a first pulse's energy, at which it is timed
WIDE = 2.85  # samples of a pulse
PLACE = np.arange(WIDE_SAMPLES, dtype=np.float64)
PHASES, TAPS = 64, np.arange(-5, 7)  # of the filters that delay


def bumps(top: Floats) -> Floats:
    """Return pulses of height 1 with such tops in samples [n, k]: Pearson's seventh kind."""
    return np.asarray((1 + np.square((PLACE - top[:, None]) / WIDE)) ** -4.0)


def murmur(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1 that two poles colour, [size, k]."""
    turn = np.exp(-2j * np.pi * np.fft.fftfreq(WIDE_SAMPLES))
    gain = 1 / np.abs(1 - 0.42 * turn + 0.27 * turn**2)
    white = rng.standard_normal((2, size, WIDE_SAMPLES))
    spectrum = np.fft.fft(white[0] + 1j * white[1], axis=1) * gain
    return np.asarray(np.fft.ifft(spectrum, axis=1) / np.sqrt(np.mean(gain**2)))


def _bank() -> Floats:
    """Return filters that delay by 0, 1 / PHASES, ... 1 samples [PHASES + 1, taps]."""
    x = TAPS - np.linspace(0, 1, PHASES + 1)[:, None]
    inside = np.sqrt(np.maximum(1 - np.square(x / 6.5), 0))
    bank = np.sinc(x) * np.i0(5.0 * inside) / np.i0(5.0)
    return np.asarray(bank / bank.sum(axis=1, keepdims=True))


BANK = _bank()


def behind(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by the nearest of a bank of filters."""
    steps = np.rint(np.clip(samples, 0, 120) * PHASES).astype(np.intp)
    whole, phase = np.divmod(steps, PHASES)
    room = np.pad(waves, ((0, 0), (130, 10)))
    out = np.zeros_like(waves)
    for number, tap in enumerate(TAPS.tolist()):
        source = 130 + np.arange(WIDE_SAMPLES) - (whole + tap)[:, None]
        out += BANK[phase, number][:, None] * np.take_along_axis(room, source, axis=1)
    return out


def onsets(waves: Complexes, sigma: Floats, dull: float = 0.0) -> Floats:
    """Return when a part of a first pulse's energy has come, in samples [n].

    First is what is above noise, `sigma` [n] of a component, and above a part of the largest. Dull
    ones ask for more of both, and wait for more of the energy.
    """
    size = np.abs(waves)
    largest = size.max(axis=1)
    level = (1 + 1.2 * dull) * np.maximum(SEEN * sigma, OF_LARGEST * largest)
    first = np.argmax(size >= np.minimum(level, 0.7 * largest)[:, None], axis=1)
    near = np.take_along_axis(size, _about(first, 0, 5), axis=1)
    falls = np.diff(near, axis=1) <= 0  # the top is the last before the first fall
    top = first + np.where(falls.any(axis=1), falls.argmax(axis=1), 4)
    power = np.take_along_axis(size, _about(top, -5, 8), axis=1) ** 2
    come = np.cumsum(np.maximum(power - 2 * sigma[:, None] ** 2, 0), axis=1)
    part = min(EARLY_PART + 0.13 * dull, 0.6) * come[:, -1]
    past = np.clip(np.argmax(come >= part[:, None], axis=1), 1, 7)[:, None]
    low, high = (np.take_along_axis(come, past - k, axis=1)[:, 0] for k in (1, 0))
    inside = np.clip((part - low) / np.maximum(high - low, 1e-9), 0, 1)
    return np.asarray(np.clip(top, 8, WIDE_SAMPLES - 13) - 6.0 + past[:, 0] + inside)


def _about(place: NDArray[np.intp], begin: int, many: int) -> NDArray[np.intp]:
    """Return numbers of so many samples from `begin` beside places [n, many], all in a record."""
    return np.clip(place, 8, WIDE_SAMPLES - 13)[:, None] + np.arange(begin, begin + many)


def readings(waves: Complexes, onset: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of all that has come, and that of first pulses [2, n]."""
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    past = PLACE - onset[:, None]
    first = np.sum(power * np.exp(-np.square((past - 0.7) / 1.9)), axis=1)
    first = np.maximum(first, 0.9 * sigma**2)
    whole = np.maximum(np.where(past > -5, power, 0).sum(axis=1), 1.1 * first)
    return np.asarray(10 * np.log10([whole, first]))


class Scope:
    """Waveforms of a table's rows, and what befalls them in turn.

    `sigma` [n]: of a component of noise now; `louder`, `fewer` [n]: factors of what is read of
    noise and of symbols; `unseen_m` [n]: metres that no waveform shows; `dull`: of `onsets`.
    """

    def __init__(self, table: pd.DataFrame, season: int, rng: np.random.Generator) -> None:
        self.table, self.season, self.rng = table, season, rng
        self.before: Complexes = np.stack(table["cir_i"].to_list()) + 1j * np.stack(
            table["cir_q"].to_list()
        )
        self.trace = self.before.copy()
        self.still: Floats = table["noise_std"].to_numpy(np.float64) / OF_NOISE
        self.sigma = self.still.copy()
        self.louder, self.fewer = np.ones((2, len(table)))
        self.unseen_m, self.dull = np.zeros(len(table)), 0.0
        self.onset = onsets(self.before, self.still)
        self.past: Floats = PLACE - self.onset[:, None]

    def herd(self) -> Herd:
        """Return the rows as they read now."""
        return Herd(self.read(), self.season, self.rng)

    def lasting(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([964, self.season, what])

    def after(self, samples: float, width: float = 3.0) -> Floats:
        """Return 0 until so many samples past onsets, then 1 [n, k]: by a cubic's odd powers."""
        x = np.clip((self.past - samples) / width, -0.5, 0.5)
        return np.asarray(0.5 + x * (1.5 - 2 * x * x))

    def on(self) -> Floats:
        """Return 0 until shortly before onsets, then 1 [n, k]."""
        return self.after(-3.2)

    def early(self) -> Floats:
        """Return 1 as long as first pulses last, then 0 [n, k]."""
        return 1 - self.after(7.0, 5.0)

    def coming(self) -> Complexes:
        """Return waveforms from the onset on, without samples that noise alone may have made."""
        times = np.abs(self.trace) / self.sigma[:, None]
        return np.asarray(self.trace * self.on() / (1 + np.exp(7 * (3.6 - times))))

    def height(self) -> Floats:
        """Return the size of first pulses [n]."""
        near = np.abs(self.past - 0.8) < 2.6
        return np.asarray(np.max(np.abs(self.trace) * near, axis=1))

    def turned(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(len(self.table))))

    def repeat(self, share: Floats | Complexes, samples: Floats, what: Complexes) -> None:
        """Add such a share [n] of waveforms [n, k], so many samples later [n]."""
        self.trace = self.trace + np.asarray(share)[:, None] * behind(what, samples)

    def mutter(self, sigma: Floats) -> None:
        """Add noise of such components [n, k] or [n, 1]."""
        self.trace = self.trace + sigma * murmur(self.rng, len(self.table))

    def hush(self, gain: Floats) -> None:
        """Leave such a part of signals [n, k]; noise stays as it was."""
        self.trace = self.trace * gain
        self.mutter(self.sigma[:, None] * np.sqrt(np.clip(1 - gain**2, 0, 1)))

    def noise_up(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        factor = 10 ** (np.maximum(db, 0) / 20)
        self.mutter((self.sigma * np.sqrt(factor**2 - 1))[:, None])
        self.sigma, self.louder = self.sigma * factor, self.louder * factor

    def shorten(self, part: Floats) -> None:
        """Add up a part of the symbols [n]: noise falls by its root."""
        self.trace = self.trace * part[:, None]
        self.mutter((self.sigma * np.sqrt(np.maximum(part * (1 - part), 0)))[:, None])
        self.sigma, self.louder = self.sigma * part**0.5, self.louder * part**0.5
        self.fewer = self.fewer * part

    def befall(self, trouble: Trouble) -> None:
        """Let happen to waveforms what befell their rows."""
        metres, whole, edge, noise, count = (
            np.broadcast_to(np.asarray(one, np.float64), self.sigma.shape) for one in trouble
        )
        self.unseen_m = self.unseen_m + metres
        if np.any(whole) or np.any(edge):
            db = whole[:, None] + edge[:, None] * self.early()
            self.hush(10 ** (db * self.on() / 20))
        if np.any(noise):
            self.noise_up(noise)
        if np.any(count):
            self.shorten(10 ** (np.minimum(count, 0) / 20))

    def read(self) -> pd.DataFrame:
        """Return the table as it reads now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        moved = onsets(self.trace, self.sigma, self.dull) - self.onset
        index = np.clip(was + moved, 5, WIDE_SAMPLES - 12)
        now = readings(self.trace, index, self.sigma) - 20 * np.log10(self.fewer)
        gained = now - readings(self.before, was, self.still)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * moved + self.unseen_m
        return self.table.assign(
            first_path_index=index,
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + gained[0],
            first_path_power_dbm=self.table["first_path_power_dbm"] + gained[1],
            noise_std=self.table["noise_std"] * self.louder,
            preamble_count=self.table["preamble_count"] * self.fewer,
            cir_i=list(self.trace.real),
            cir_q=list(self.trace.imag),
        )
