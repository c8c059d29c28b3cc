"""The bakery's receiver: what becomes of waveforms, and what its tuner tells of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.bakery_house import Bake, Sheet

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 31, 208
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
TIMES, PART = 6.0, 0.11  # of a component's scatter; of the largest size
ROUND = 0.98  # samples in which a pulse falls to 1 / cosh(1)
AHEAD = 1.8  # samples by which first paths are told before their tops
KERNEL = 3  # lobes of a kernel between samples
TICK = np.arange(float(WIDE_SAMPLES))
FADES = 0.36 ** np.arange(9)  # of noise, sample by sample
FADES /= np.sqrt(np.sum(FADES**2))


def crests(top: Floats) -> Floats:
    """Return pulses of height 1 with such tops in samples [n, k]: one over a cosh."""
    return np.asarray(1 / np.cosh((TICK - top[:, None]) / ROUND))


def hum(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1 that forgets by a factor a sample, [size, k]."""
    long = WIDE_SAMPLES + len(FADES) - 1
    fresh = rng.normal(size=(size, long)) + 1j * rng.normal(size=(size, long))
    seen = np.lib.stride_tricks.sliding_window_view(fresh, len(FADES), axis=1)
    return np.asarray(seen @ FADES[::-1])


def put_off(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by Lanczos's kernel between samples."""
    late = np.minimum(np.maximum(samples, 0.0), 128.0)
    whole = np.ceil(late).astype(np.intp)
    room = np.zeros((len(waves), 132))
    roomy = np.concatenate([room, waves, room[:, :KERNEL]], axis=1)
    taps = np.arange(1 - KERNEL, KERNEL + 1)
    x = taps - (whole - late)[:, None]
    weight = np.sinc(x) * np.sinc(x / KERNEL) * (np.abs(x) < KERNEL)
    weight /= weight.sum(axis=1, keepdims=True)
    begin = (132 - whole)[:, None] + np.arange(WIDE_SAMPLES)
    out = np.zeros(waves.shape, np.complex128)
    for k, tap in enumerate(taps.tolist()):
        out += weight[:, k, None] * np.take_along_axis(roomy, begin + tap, axis=1)
    return out


def fronts(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return AHEAD of the first tops, in samples [n]: parabolas through logarithms of sizes.

    The first is the first above noise, `sigma` [n] of a component, and above a part of the
    largest. Deaf ones ask for more of both, and tell it later, most so where it is weak.
    """
    size = np.abs(waves) + 1e-9
    peak = np.max(size, axis=1)
    floor = (1 + 1.2 * deaf) * np.maximum(TIMES * sigma, PART * peak)
    heard = size >= np.minimum(floor, 0.72 * peak)[:, None]
    first = np.clip(heard.argmax(axis=1), 9, WIDE_SAMPLES - 14)
    top = first.copy()
    rows = np.arange(len(size))
    for _ in range(5):  # uphill
        top = np.where(size[rows, top + 1] > size[rows, top], top + 1, top)
    left, here, right = (np.log(size[rows, top + k]) for k in (-1, 0, 1))
    bend = np.minimum(left - 2 * here + right, -1e-6)
    aside = np.clip(0.5 * (left - right) / bend, -0.5, 0.5)
    weak = np.clip(8 * sigma / size[rows, top], 0, 1)
    return np.asarray(top + aside - AHEAD + 0.33 * min(deaf, 2.5) * (1 + 2 * weak))


def gauges(waves: Complexes, index: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of all that is heard, and that of first tops [2, n]."""
    energy = np.square(np.abs(waves)) - 2 * sigma[:, None] ** 2
    past = TICK - index[:, None]
    near = np.clip(1.5 - np.abs(past - AHEAD) / 2, 0, 1)
    first = np.maximum(np.einsum("ij,ij->i", energy, near), 0.85 * sigma**2)
    whole = np.where(past > -4.5, energy, 0.0).sum(axis=1)
    return np.asarray(10 * np.log10(np.stack([np.maximum(whole, 1.1 * first), first])))


class Tuned:
    """Waveforms of a table's rows, to which one thing after the other happens.

    `sigma` [n]: of a component of noise now; `hissing`, `counted` [n]: factors of what is told of
    noise and of symbols; `beside_m` [n]: metres that are in no waveform; `deaf`: of `fronts`.
    """

    def __init__(self, table: pd.DataFrame, night: int, rng: np.random.Generator) -> None:
        self.table, self.night, self.rng, self.rows = table, night, rng, len(table)
        self.was: Complexes = np.stack([*table["cir_i"]]) + 1j * np.stack([*table["cir_q"]])
        self.wave = self.was
        self.quiet = np.asarray(table["noise_std"], np.float64) / OF_NOISE
        self.sigma = self.quiet
        self.hissing, self.counted = np.ones(self.rows), np.ones(self.rows)
        self.beside_m, self.deaf = np.zeros(self.rows), 0.0
        self.front = fronts(self.was, self.sigma)
        self.past: Floats = TICK - self.front[:, None]

    def sheet(self) -> Sheet:
        """Return the rows as the tuner tells them now."""
        return Sheet(self.told(), self.night, self.rng)

    def constant(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([what, 924, self.night])

    def ramp(self, begin: float, end: float) -> Floats:
        """Return 0 until so many samples past fronts, 1 from so many on, smooth [n, k]."""
        x = np.clip((self.past - begin) / (end - begin), 0, 1)
        return np.asarray(x * x * (3 - 2 * x))

    def begun(self) -> Floats:
        """Return 0 until shortly before fronts, then 1 [n, k]."""
        return self.ramp(-4.5, -1.5)

    def first(self) -> Floats:
        """Return 1 while first pulses last, then 0 [n, k]."""
        return 1 - self.ramp(4.5, 9.0)

    def signal(self) -> Complexes:
        """Return waveforms from the front on, but not the tuner's own noise: it is in no room."""
        own = np.abs(self.wave) / self.sigma[:, None]
        return np.asarray(self.begun() * np.clip(own - 3.0, 0.0, 1.0) * self.wave)

    def crest(self) -> Floats:
        """Return the size of first pulses [n]."""
        inside = np.abs(self.past - AHEAD) < 2.5
        return np.asarray(np.where(inside, np.abs(self.wave), 0.0).max(axis=1))

    def spun(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(1j * np.pi * self.rng.uniform(-1, 1, self.rows)))

    def echo(self, share: Floats | Complexes, later: Floats, of: Complexes) -> None:
        """Hear such a share [n] of waveforms [n, k] so many samples later [n] as well."""
        self.wave = self.wave + np.asarray(share)[:, None] * put_off(of, later)

    def dither(self, sigma: Floats) -> None:
        """Add noise of such components [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * hum(self.rng, self.rows)

    def damp(self, left: Floats) -> None:
        """Leave a part of signals [n, k]; noise stays as it was."""
        self.wave = left * self.wave
        self.dither(np.sqrt(np.maximum(1 - left**2, 0.0)) * self.sigma[:, None])

    def noisier(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        by = 10 ** (0.05 * np.maximum(db, 0))
        self.dither((self.sigma * np.sqrt(by * by - 1))[:, None])
        self.sigma, self.hissing = by * self.sigma, by * self.hissing

    def sum_less(self, part: Floats) -> None:
        """Add up a part of the symbols [n]: noise falls by its root."""
        self.wave = part[:, None] * self.wave
        self.dither((self.sigma * np.sqrt(part * (1 - part)))[:, None])
        self.sigma, self.hissing = self.sigma * np.sqrt(part), self.hissing * np.sqrt(part)
        self.counted = self.counted * part

    def bake(self, bake: Bake) -> None:
        """Let happen to waveforms what becomes of their rows."""
        whole, front, hiss, count = (
            np.zeros(self.rows) + one for one in (bake.whole, bake.front, bake.hiss, bake.count)
        )
        self.beside_m = self.beside_m + bake.metres
        if whole.any() or front.any():
            db = whole[:, None] + front[:, None] * self.first()
            self.damp(10 ** (db * self.begun() / 20))
        if hiss.any():
            self.noisier(hiss)
        if count.any():
            self.sum_less(10 ** (np.minimum(count, 0) / 20))

    def told(self) -> pd.DataFrame:
        """Return the table as the tuner tells it now."""
        was = np.asarray(self.table["first_path_index"], np.float64)
        later = fronts(self.wave, self.sigma, self.deaf) - self.front
        index = np.clip(was + later, 5.0, WIDE_SAMPLES - 13.0)
        db = gauges(self.wave, index, self.sigma) - gauges(self.was, was, self.quiet)
        db = db - 20 * np.log10(self.counted)
        out = self.table.copy()
        out["first_path_index"] = index
        out["error_m"] += METRES * later + self.beside_m
        out["range_m"] = out["true_range_m"] + out["error_m"]
        out["rx_power_dbm"] += db[0]
        out["first_path_power_dbm"] += db[1]
        out["noise_std"] *= self.hissing
        out["preamble_count"] = out["preamble_count"] * self.counted
        out["cir_i"], out["cir_q"] = list(self.wave.real), list(self.wave.imag)
        return out
