"""The signal box's receiver: what changes in waveforms, and what its book has of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.signalbox_yard import Change, Train

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 34, 200
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
MULTIPLE, SHARE = 6.3, 0.125  # of a component's scatter; of the largest size
KNOT = 1.7  # samples between knots of the spline that a pulse is
LOW, HIGH = 0.3, 0.7  # parts of a top between which an edge is taken for straight
SAMPLE = np.arange(0.0, WIDE_SAMPLES, 1.0)


def splines(top: Floats) -> Floats:
    """Return pulses of height 1 with such tops in samples [n, k]: cubic basis splines."""
    x = np.abs(SAMPLE - top[:, None]) / KNOT
    outer = np.maximum(2 - x, 0.0) ** 3 / 4
    return np.asarray(outer - np.maximum(1 - x, 0.0) ** 3)


def static(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1 and a bell's spectrum, [size, k]."""
    fresh = rng.normal(size=(size, 2, WIDE_SAMPLES))
    bell = 0.25 + np.exp(-np.square(np.fft.fftfreq(WIDE_SAMPLES) / 0.36))
    bell /= np.sqrt(np.mean(bell**2))
    return np.asarray(np.fft.ifft(bell * np.fft.fft(fresh[:, 0] + 1j * fresh[:, 1])))


def deferred(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: turned in the spectrum, with room to run out."""
    room = 2 * WIDE_SAMPLES
    turns = np.fft.fftfreq(room) * np.clip(samples, 0.0, 130.0)[:, None]
    spectrum = np.fft.fft(waves, room, axis=1) * np.exp(-2j * np.pi * turns)
    return np.asarray(np.fft.ifft(spectrum, axis=1)[:, :WIDE_SAMPLES])


def onsets(waves: Complexes, sigma: Floats, numb: float = 0.0) -> Floats:
    """Return where the straight part of first edges comes from, in samples [n].

    The line through LOW and HIGH of the first top above noise, `sigma` [n] of a component, and
    above a share of the largest. Numb ones ask for more of both, and begin later on that line.
    """
    size = np.abs(waves)
    all_over = size.max(axis=1)
    least = (1 + 1.1 * numb) * np.maximum(MULTIPLE * sigma, SHARE * all_over)
    hit = np.argmax(size >= np.minimum(least, 0.72 * all_over)[:, None], axis=1)
    hit = np.minimum(np.maximum(hit, 11), WIDE_SAMPLES - 15)
    climb = np.take_along_axis(size, hit[:, None] + np.arange(7), axis=1)
    ended = np.diff(climb, axis=1) < 0
    top = hit + np.where(ended.any(axis=1), ended.argmax(axis=1), 6)
    edge = np.take_along_axis(size, top[:, None] - np.arange(9), axis=1)
    low, high = (top - _back(edge, part * edge[:, 0]) for part in (LOW, HIGH))
    slope = np.maximum(high - low, 0.2) / (HIGH - LOW)
    return np.asarray(low - (LOW - 0.32 * min(numb, 2.5)) * slope)


def _back(edge: Floats, level: Floats) -> Floats:
    """Return how many samples before tops sizes [n, 9], tops first, are at a level [n]."""
    k = np.maximum(np.argmax(edge < level[:, None], axis=1), 1)
    inner, outer = (np.take_along_axis(edge, k[:, None] - j, axis=1)[:, 0] for j in (1, 0))
    return np.asarray(k - np.clip((level - outer) / np.maximum(inner - outer, 1e-9), 0, 1))


def book(waves: Complexes, index: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of what is heard, and that of five samples of first paths [2, n]."""
    since = SAMPLE - index[:, None]
    clear = np.abs(waves) ** 2 - 2 * np.square(sigma[:, None])
    near = np.clip(3.0 - np.abs(since - 2.0), 0.0, 1.0)
    first = np.maximum(np.sum(clear * near, axis=1), 0.9 * sigma**2)
    whole = np.sum(clear * (since > -4), axis=1)
    return np.asarray(10 * np.log10(np.stack([np.maximum(whole, 1.12 * first), first])))


class Strip:
    """Waveforms of a table's rows, changed one time after the other.

    `sigma` [n]: of a component of noise now; `noisier`, `shorter` [n]: factors of what the book
    has of noise and of symbols; `off_m` [n]: metres beside waveforms; `numb`: of `onsets`.
    """

    def __init__(self, table: pd.DataFrame, day: int, rng: np.random.Generator) -> None:
        self.table, self.day, self.rng = table, day, rng
        parts = [np.stack(list(table[name])).astype(np.float64) for name in ("cir_i", "cir_q")]
        self.before: Complexes = np.asarray(parts[0] + 1j * parts[1])
        self.wave = self.before.copy()
        self.still = table["noise_std"].to_numpy(np.float64) / OF_NOISE
        self.sigma = self.still.copy()
        one = np.ones(len(table))
        self.noisier, self.shorter, self.off_m, self.numb = one, one, 0 * one, 0.0
        self.onset = onsets(self.before, self.sigma)
        self.past: Floats = SAMPLE - self.onset[:, None]

    def train(self) -> Train:
        """Return the rows as the book would have them now."""
        return Train(self.entered(), self.day, self.rng)

    def kept(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([904, what, self.day])

    def on(self) -> Floats:
        """Return 0 until first edges begin, then 1 [n, k]: by a bell's integral, cut off."""
        return np.where(self.past < -5, 0.0, 0.5 + 0.5 * np.tanh(1.5 * (self.past + 2.5)))

    def direct(self) -> Floats:
        """Return 1 while first pulses last, and 0 some samples after [n, k]."""
        return np.asarray(0.5 - 0.5 * np.tanh(0.8 * (self.past - 7.5)))

    def after(self, samples: float) -> Floats:
        """Return 0 until so many samples past onsets, then 1, within two samples [n, k]."""
        return np.asarray(np.clip((self.past - samples) / 2.0, 0, 1))

    def call(self) -> Complexes:
        """Return waveforms from the first edge on, those samples of them that tell from static.

        Static is of the frame: wagons and ballast cannot send it back.
        """
        tells = 0.5 + np.arctan(7 * (np.abs(self.wave) / self.sigma[:, None] - 3.7)) / 2.6
        return np.asarray(self.wave * self.on() * np.clip(tells, 0, 1))

    def height(self) -> Floats:
        """Return the size of first pulses [n]."""
        return np.asarray((np.abs(self.wave) * (np.abs(self.past - 2) < 3)).max(axis=1))

    def turned(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(0.0, 2 * np.pi, len(self.table))))

    def hear(self, share: Floats | Complexes, later: Floats, of: Complexes) -> None:
        """Hear such a share [n] of waveforms [n, k] once more, so many samples later [n]."""
        self.wave = self.wave + deferred(np.asarray(share)[:, None] * of, later)

    def fill(self, sigma: Floats) -> None:
        """Add noise of such components [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * static(self.rng, len(self.table))

    def scale(self, by: Floats | Complexes) -> None:
        """Scale signals by at most about 1 [n, k], and leave noise as it was."""
        self.wave = self.wave * by
        lost = np.maximum(1 - np.square(np.abs(by)), 0.0)
        self.fill(self.sigma[:, None] * np.sqrt(lost))

    def crackle(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        power = 10 ** (np.maximum(db, 0.0) / 10)
        self.fill((self.sigma * np.sqrt(power - 1))[:, None])
        self.sigma, self.noisier = self.sigma * np.sqrt(power), self.noisier * np.sqrt(power)

    def shorten(self, part: Floats) -> None:
        """Add up a part of the symbols [n]: noise falls by its root."""
        self.wave = self.wave * part[:, None]
        self.fill((self.sigma * np.sqrt(part * (1 - part)))[:, None])
        self.sigma, self.noisier = self.sigma * part**0.5, self.noisier * part**0.5
        self.shorter = self.shorter * part

    def change(self, change: Change) -> None:
        """Change waveforms as their rows change."""
        shape = self.off_m.shape
        self.off_m = self.off_m + change.metres
        whole, edge = (np.broadcast_to(np.asarray(x), shape) for x in (change.whole, change.edge))
        if (np.abs(whole) + np.abs(edge)).max() > 0:
            db = whole[:, None] + edge[:, None] * self.direct()
            self.scale(10 ** (0.05 * db * self.on()))
        if np.abs(change.hiss).max() > 0:
            self.crackle(np.broadcast_to(np.asarray(change.hiss), shape))
        if np.abs(change.count).max() > 0:
            fewer = np.minimum(np.broadcast_to(np.asarray(change.count), shape), 0.0)
            self.shorten(10 ** (0.05 * fewer))

    def entered(self) -> pd.DataFrame:
        """Return the table as the book has it now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        later = onsets(self.wave, self.sigma, self.numb) - self.onset
        index = np.clip(was + later, 5.5, WIDE_SAMPLES - 12.5)
        db = book(self.wave, index, self.sigma) - book(self.before, was, self.still)
        db -= 20 * np.log10(self.shorter)
        out = self.table.assign(first_path_index=index, cir_i=[*self.wave.real])
        out["cir_q"] = [*self.wave.imag]
        out["error_m"] += METRES * later + self.off_m
        out["range_m"] = out["true_range_m"] + out["error_m"]
        out["rx_power_dbm"] += db[0]
        out["first_path_power_dbm"] += db[1]
        out["noise_std"] *= self.noisier
        out["preamble_count"] = out["preamble_count"] * self.shorter
        return out
