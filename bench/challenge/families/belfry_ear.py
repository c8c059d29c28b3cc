"""The belfry's receiver: what is added to waveforms, and what its ear makes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.belfry_close import Toll, Watch

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 32, 180
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
LOUD, BESIDE = 6.4, 0.15  # times a component's scatter; beside the largest size
STAGES, STAGE = 6.0, 0.46  # of a chain of filters, and the time of each in samples
BAND = 0.41  # of noise, in periods a sample
BEAT = np.arange(0.0, WIDE_SAMPLES)


def strokes(top: Floats) -> Floats:
    """Return pulses of height 1 with such tops in samples [n, k]: what a chain of filters gives.

    t^n exp(-t), which rises faster than it falls.
    """
    t = np.maximum(1 + (BEAT - top[:, None]) / (STAGES * STAGE), 0.0)
    return np.asarray((t * np.exp(1 - t)) ** STAGES)


def rustle(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1 in a band with straight sides, [size, k]."""
    spectrum = rng.standard_normal((size, WIDE_SAMPLES, 2)).view(np.complex128)[..., 0]
    inside = np.abs(np.fft.fftfreq(WIDE_SAMPLES)) <= BAND
    return np.asarray(np.fft.ifft(spectrum * inside, axis=1, norm="ortho") / np.sqrt(inside.mean()))


def later(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by Lagrange's polynomials through six."""
    late = np.clip(samples, 0.0, 118.0)
    whole = np.floor(late)
    nodes = np.arange(-2.0, 4.0)  # samples later than the whole part
    x = (late - whole)[:, None]
    padded = np.pad(waves, ((0, 0), (122, 3)))
    start = (122 - whole).astype(np.intp)[:, None] + np.arange(WIDE_SAMPLES)
    out = np.zeros_like(waves)
    for node in nodes.tolist():
        others = nodes[nodes != node]
        weight = np.prod((x - others) / (node - others), axis=1)[:, None]
        out = out + weight * np.take_along_axis(padded, start - int(node), axis=1)
    return out


def attacks(waves: Complexes, sigma: Floats, dulled: float = 0.0) -> Floats:
    """Return where first pulses rise fastest, in samples [n]: parabolas through differences.

    The first is the first above noise, `sigma` [n] of a component, and beside the largest. Dulled
    ones ask for more of both, and take it later.
    """
    size = np.abs(waves)
    largest = size.max(axis=1)
    asked = (1 + 1.15 * dulled) * np.maximum(LOUD * sigma, BESIDE * largest)
    heard = (size >= np.minimum(asked, 0.71 * largest)[:, None]).argmax(axis=1)
    heard = np.clip(heard, 9, WIDE_SAMPLES - 13)[:, None]
    rise = np.take_along_axis(size, heard + np.arange(-3, 4), axis=1)
    rise = np.diff(rise, axis=1)  # six of them, the first two samples and a half before
    best = np.clip(rise[:, :5].argmax(axis=1), 1, 4)[:, None]
    left, mid, right = (np.take_along_axis(rise, best + k, axis=1)[:, 0] for k in (-1, 0, 1))
    curve = np.minimum(left + right - 2 * mid, -1e-9)
    aside = np.clip(0.5 * (left - right) / curve, -0.6, 0.6)
    return np.asarray(heard[:, 0] - 2.5 + best[:, 0] + aside + 0.38 * min(dulled, 2.5))


def loudness(waves: Complexes, index: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of all, and that of three samples about first tops [2, n]."""
    power = np.abs(waves) ** 2 - 2 * (sigma**2)[:, None]
    past = BEAT - index[:, None] - 1.2
    first = np.sum(power * np.maximum(1 - (past / 2.6) ** 2, 0.0), axis=1)
    first = np.maximum(first, 0.9 * sigma**2)
    whole = np.maximum(np.sum(power * (past > -5), axis=1), 1.12 * first)
    return np.asarray(10 * np.log10(np.array([whole, first])))


class Heard:
    """Waveforms of a table's rows, to which one thing after the other is added.

    `sigma` [n]: of a component of noise now; `rustling`, `summed` [n]: factors of what is said of
    noise and of symbols; `apart_m` [n]: metres that waveforms do not show; `dulled`: of `attacks`.
    """

    def __init__(self, table: pd.DataFrame, day: int, rng: np.random.Generator) -> None:
        self.table, self.day, self.rng = table, day, rng
        parts = (np.array(table[name].to_list()) for name in ("cir_i", "cir_q"))
        self.first_heard: Complexes = np.asarray(next(parts) + 1j * next(parts))
        self.wave = self.first_heard.copy()
        self.calm = table["noise_std"].to_numpy(np.float64) / OF_NOISE
        self.sigma = self.calm.copy()
        self.rustling, self.summed = np.ones_like(self.sigma), np.ones_like(self.sigma)
        self.apart_m, self.dulled = np.zeros_like(self.sigma), 0.0
        self.attack = attacks(self.first_heard, self.sigma)
        self.past: Floats = BEAT - self.attack[:, None]

    def __len__(self) -> int:
        """Return how many rows there are."""
        return len(self.table)

    def watch(self) -> Watch:
        """Return the rows as they are said to be now."""
        return Watch(self.said(), self.day, self.rng)

    def stays(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([what, self.day, 944])

    def from_(self, samples: float, width: float = 2.5) -> Floats:
        """Return 0 until so many samples past attacks, then 1 [n, k]: by a sine's quarter."""
        x = np.clip((self.past - samples) / width + 0.5, 0.0, 1.0)
        return np.asarray(np.sin(0.5 * np.pi * x) ** 2)

    def sounding(self) -> Floats:
        """Return 0 until shortly before first pulses, then 1 [n, k]."""
        return self.from_(-3.6)

    def striking(self) -> Floats:
        """Return 1 as long as first pulses last, then 0 [n, k]."""
        return 1 - self.from_(7.0, 5.0)

    def sound(self) -> Complexes:
        """Return waveforms from the first pulse on: what is loud enough not to be the ear's own."""
        x = np.clip(np.abs(self.wave) / self.sigma[:, None] - 3.0, 0.0, 1.0)
        return np.asarray(self.sounding() * np.sin(0.5 * np.pi * x) ** 2 * self.wave)

    def stroke(self) -> Floats:
        """Return the size of first pulses [n]."""
        near = np.where(np.abs(self.past - 1.2) < 2.6, np.abs(self.wave), 0)
        return np.asarray(np.maximum(near.max(axis=1), 1e-9))

    def any_phase(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(0, 2 * np.pi, len(self))))

    def again(self, share: Floats | Complexes, samples: Floats, of: Complexes) -> None:
        """Hear such a share [n] of waveforms [n, k] again, so many samples later [n]."""
        self.wave = self.wave + (np.asarray(share) * np.ones(len(self)))[:, None] * later(
            of, samples
        )

    def rustles(self, sigma: Floats) -> None:
        """Add noise of such components [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * rustle(self.rng, len(self))

    def soften(self, to: Floats) -> None:
        """Leave such a part of signals [n, k]; noise stays as it was."""
        self.wave = self.wave * to
        self.rustles(self.sigma[:, None] * np.sqrt(np.clip(1 - to * to, 0, 1)))

    def hiss(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        factor = np.power(10.0, np.clip(db, 0.0, None) / 20)
        self.rustles((self.sigma * np.sqrt(np.square(factor) - 1))[:, None])
        self.sigma, self.rustling = self.sigma * factor, self.rustling * factor

    def stop_early(self, part: Floats) -> None:
        """Add up a part of the symbols [n]: noise falls by its root."""
        self.wave = self.wave * part[:, None]
        self.rustles((self.sigma * np.sqrt(np.maximum(part - part**2, 0)))[:, None])
        self.sigma, self.rustling = self.sigma * part**0.5, self.rustling * part**0.5
        self.summed = self.summed * part

    def toll(self, toll: Toll) -> None:
        """Add to waveforms what is added to their rows."""
        same = np.ones(len(self))
        self.apart_m = self.apart_m + toll.metres
        db = (toll.all * same)[:, None] + (toll.first * same)[:, None] * self.striking()
        if np.abs(db).max() > 0:
            self.soften(np.power(10.0, db * self.sounding() / 20))
        if np.max(toll.hiss) > 0:
            self.hiss(toll.hiss * same)
        if np.min(toll.count) < 0:
            self.stop_early(np.power(10.0, np.minimum(toll.count, 0.0) * same / 20))

    def said(self) -> pd.DataFrame:
        """Return the table as it is said to be now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        moved = attacks(self.wave, self.sigma, self.dulled) - self.attack
        index = np.clip(was + moved, 5.0, WIDE_SAMPLES - 12.0)
        now, then = (
            loudness(self.wave, index, self.sigma),
            loudness(self.first_heard, was, self.calm),
        )
        whole, first = now - then - 20 * np.log10(self.summed)
        error = self.table["error_m"] + METRES * moved + self.apart_m
        return self.table.assign(
            first_path_index=index,
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + whole,
            first_path_power_dbm=self.table["first_path_power_dbm"] + first,
            noise_std=self.table["noise_std"] * self.rustling,
            preamble_count=self.table["preamble_count"] * self.summed,
            cir_i=[*self.wave.real],
            cir_q=[*self.wave.imag],
        )
