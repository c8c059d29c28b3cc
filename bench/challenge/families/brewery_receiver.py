"""The brewery's receiver: what waveforms take up, and what is put down of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.brewery_cellar import Batch, Brew

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 30, 176
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
TIMES, SHARE = 6.2, 0.13  # a component's scatter; the largest size
BELL = 2.9  # samples from a pulse's top to where it ends
TICKS = np.arange(WIDE_SAMPLES) + 0.0


def bells(top: Floats) -> Floats:
    """Return pulses of height 1 with such tops in samples [n, k]: Hann's bell, and then nothing."""
    x = np.clip((TICKS[None, :] - top[:, None]) / BELL, -1, 1)
    return np.asarray(0.5 + 0.5 * np.cos(np.pi * x))


def rustle(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1, each a mean of two fresh ones, [size, k]."""
    fresh = rng.normal(size=(size, WIDE_SAMPLES + 1, 2))
    mixed = fresh[:, 1:] + 0.34 * fresh[:, :-1]
    return np.asarray((mixed[..., 0] + 1j * mixed[..., 1]) / np.hypot(1, 0.34))


def put_off(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by a windowed sinc, and nothing before them."""
    late = np.clip(samples, 0.0, 120.0)
    whole = np.rint(late).astype(np.intp)
    part = late - whole
    room = np.pad(waves, ((0, 0), (126, 6)))
    begin = 126 - whole[:, None] + np.arange(WIDE_SAMPLES)
    out = np.zeros_like(waves)
    for k in range(-5, 6):
        x = k - part
        weight = np.sinc(x) * np.cos(0.5 * np.pi * np.clip(x / 5.6, -1, 1)) ** 2
        out += weight[:, None] * np.take_along_axis(room, begin - k, axis=1)
    return out


def slopes(waves: Complexes, sigma: Floats, slow: float = 0.0) -> Floats:
    """Return where first pulses rise most steeply, by parabolas, in samples [n].

    About the first size over noise, `sigma` [n] of a component, and over a share of the largest.
    Slow ones ask for more of both, and go on toward the top that follows.
    """
    size = np.abs(waves)
    most = size.max(axis=1)
    bar = np.minimum((1 + slow) * np.maximum(TIMES * sigma, SHARE * most), 0.75 * most)
    over = np.clip((size >= bar[:, None]).argmax(axis=1), 9, WIDE_SAMPLES - 15)
    near = np.take_along_axis(size, over[:, None] + np.arange(-5, 8), axis=1)
    falls = (near[:, 5:-1] >= near[:, 6:]).argmax(axis=1) + 5  # the top that follows
    rise = near[:, 1:] - near[:, :-1]
    rise = np.where(np.arange(12) < falls[:, None], rise, -np.inf)
    at = np.clip(rise[:, 1:].argmax(axis=1) + 1, 1, 10)
    rows = np.arange(len(at))
    full = near[:, 1:] - near[:, :-1]
    low, mid, high = (full[rows, at + k] for k in (-1, 0, 1))
    part = np.clip(0.5 * (low - high) / np.minimum(low - 2 * mid + high, -1e-9), -0.8, 0.8)
    steepest = over - 5 + at + 0.5 + part
    return np.asarray(steepest + 0.4 * min(slow, 2.0) * np.maximum(over - 5 + falls - steepest, 0))


def budgets(waves: Complexes, index: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of all but noise, and that of four samples of first paths [2, n]."""
    power = np.square(np.abs(waves))
    noise = 2 * sigma**2
    since = TICKS[None, :] - index[:, None]
    weight = np.clip(2.6 - np.abs(since - 1.0), 0, 1)
    first = np.maximum((power * weight).sum(axis=1) - noise * weight.sum(axis=1), noise)
    after = since > -7
    whole = (power * after).sum(axis=1) - noise * after.sum(axis=1)
    return np.asarray(10 * np.log10(np.stack([np.maximum(whole, 1.1 * first), first])))


class Tap:
    """Waveforms of a table's rows, which take up one thing after the other.

    `sigma` [n]: of a component of noise now; `noise`, `symbols` [n]: factors of what is put down
    of them; `apart_m` [n]: metres that are not in waveforms; `slow`: of `slopes`.
    """

    def __init__(self, table: pd.DataFrame, vat: int, rng: np.random.Generator) -> None:
        self.table, self.vat, self.rng = table, vat, rng
        i, q = (np.vstack(table[name].to_list()).astype(float) for name in ("cir_i", "cir_q"))
        self.was: Complexes = i + 1j * q
        self.wave = self.was.copy()
        self.quiet = np.array(table["noise_std"], np.float64) / OF_NOISE
        self.sigma = self.quiet.copy()
        self.noise, self.symbols = np.ones(len(i)), np.ones(len(i))
        self.apart_m, self.slow = np.zeros(len(i)), 0.0
        self.rise = slopes(self.was, self.sigma)
        self.past: Floats = TICKS[None, :] - self.rise[:, None]

    def batch(self) -> Batch:
        """Return the rows as they would be put down now."""
        return Batch(self.put_down(), self.vat, self.rng)

    def recipe(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.vat, 875, what])

    def running(self) -> Floats:
        """Return 0 before first pulses, then 1 [n, k]: by a logistic curve, cut off."""
        return np.where(self.past < -6.5, 0.0, 1 / (1 + np.exp(-4.0 * (self.past + 4.0))))

    def early(self) -> Floats:
        """Return 1 as long as first pulses last, then 0 [n, k]: by a logistic curve."""
        return np.asarray(1 / (1 + np.exp(np.clip(1.6 * (self.past - 7.0), -40, 40))))

    def sound(self) -> Complexes:
        """Return what has come in since the first pulse: samples that stand out of the noise.

        Noise is the receiver's own: no tank returns it and no filter before it passes it.
        """
        power = np.square(np.abs(self.wave) / (3.6 * self.sigma[:, None]))
        return np.asarray(self.wave * self.running() * (1 - 1 / (1 + power**6)))

    def peak(self) -> Floats:
        """Return the size of first pulses [n]."""
        return np.asarray(np.where(np.abs(self.past - 1.5) < 3, np.abs(self.wave), 0).max(axis=1))

    def chance(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(1j * np.pi * self.rng.uniform(-1, 1, len(self.table))))

    def add(self, later: Floats, share: Floats | Complexes, of: Complexes) -> None:
        """Add so large a share [n] of waveforms [n, k], so many samples later [n]."""
        self.wave = self.wave + np.asarray(share)[:, None] * put_off(of, later)

    def leave(self, part: Floats) -> None:
        """Leave a part of signals [n, k], and noise as it was."""
        gone = np.sqrt(np.maximum(1 - part * part, 0.0)) * self.sigma[:, None]
        self.wave = self.wave * part + gone * rustle(self.rng, len(self.table))

    def roughen(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        by = np.exp(np.log(10) / 20 * np.maximum(db, 0.0))
        more = self.sigma * np.sqrt(by * by - 1)
        self.wave = self.wave + more[:, None] * rustle(self.rng, len(by))
        self.sigma, self.noise = self.sigma * by, self.noise * by

    def stop_early(self, part: Floats) -> None:
        """Add up a part of the symbols [n]: noise falls by its root."""
        back = self.sigma * np.sqrt(part * (1 - part))
        self.wave = self.wave * part[:, None] + back[:, None] * rustle(self.rng, len(part))
        self.sigma, self.noise = self.sigma * np.sqrt(part), self.noise * np.sqrt(part)
        self.symbols = self.symbols * part

    def take_up(self, brew: Brew) -> None:
        """Let waveforms have what is added to their rows."""
        none = np.zeros(len(self.table))
        self.apart_m = self.apart_m + brew.metres
        db = (none + brew.whole)[:, None] + (none + brew.edge)[:, None] * self.early()
        if db.any():
            self.leave(np.exp(np.log(10) / 20 * db * self.running()))
        if np.asarray(brew.hiss).any():
            self.roughen(none + brew.hiss)
        if np.asarray(brew.count).any():
            self.stop_early(np.exp(np.log(10) / 20 * np.minimum(none + brew.count, 0.0)))

    def put_down(self) -> pd.DataFrame:
        """Return the table as it is put down now."""
        out = self.table.copy()
        was = out["first_path_index"].to_numpy(np.float64)
        later = slopes(self.wave, self.sigma, self.slow) - self.rise
        index = np.clip(was + later, 6, WIDE_SAMPLES - 13)
        more = budgets(self.wave, index, self.sigma) - budgets(self.was, was, self.quiet)
        more -= 20 * np.log10(self.symbols)
        out["first_path_index"] = index
        out["error_m"] = out["error_m"] + METRES * later + self.apart_m
        out["range_m"] = out["true_range_m"] + out["error_m"]
        out["rx_power_dbm"] = out["rx_power_dbm"] + more[0]
        out["first_path_power_dbm"] = out["first_path_power_dbm"] + more[1]
        out["noise_std"] = out["noise_std"] * self.noise
        out["preamble_count"] = out["preamble_count"] * self.symbols
        out["cir_i"], out["cir_q"] = list(self.wave.real), list(self.wave.imag)
        return out
