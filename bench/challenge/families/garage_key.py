"""The garage's receiver: what waveforms meet, and what a phone reads of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.garage_cars import Visit, Wrong

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 27, 172
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
OVER, OF_TOP = 6.6, 0.09  # times a component's scatter; of the largest size
NARROW = 1.02  # samples of a pulse
BACK, CONSTANT = 2, 0.62  # samples between what is compared, and the share that is taken
BEFORE, TOP = 1.9, 1.28  # samples: of crossings, taken off; from onsets to tops of clean pulses
AT = np.arange(float(WIDE_SAMPLES))
POINTS = np.arange(-2, 4)  # of a polynomial through six samples


def secants(top: Floats) -> Floats:
    """Return pulses of height 1 with such tops in samples [n, k]: hyperbolic secants."""
    return np.asarray(1 / np.cosh((AT - top[:, None]) / NARROW))


def simmer(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1, less of it at the band's ends [size, k]."""
    pitch = np.abs(np.fft.fftfreq(WIDE_SAMPLES))
    gain = np.sqrt(0.5 + 0.5 * np.cos(np.pi * np.clip((pitch - 0.22) / 0.28, 0, 1)))
    white = rng.normal(size=(size, WIDE_SAMPLES, 2)).view(np.complex128)[..., 0]
    made = np.fft.ifft(np.fft.fft(white, axis=1) * gain, axis=1)
    return np.asarray(made / np.sqrt(np.mean(gain**2)))


def delayed(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by Lagrange's polynomial through six of them."""
    whole = np.floor(np.clip(samples, 0.0, 100.0)).astype(np.intp)
    part = np.clip(samples, 0.0, 100.0) - whole
    weights = np.ones((len(POINTS), len(part)))
    for k, one in enumerate(POINTS):
        for other in POINTS[one != POINTS]:
            weights[k] *= (part - other) / (one - other)
    wide = np.pad(waves, ((0, 0), (104, 4)))
    source = 104 + np.arange(waves.shape[1]) - whole[:, None]
    parts = [np.take_along_axis(wide, source - k, axis=1) for k in POINTS.tolist()]
    return np.asarray(sum(w[:, None] * p for w, p in zip(weights, parts, strict=True)))


def onsets(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return where first pulses fall below what they were before, less BEFORE, in samples [n].

    A discriminator of constant share: what came two samples before outgrows a share of what comes.
    It is asked about what is above noise, `sigma` [n] of a component, and above a share of the
    largest; deaf ones ask for more of both.
    """
    size = np.abs(waves)
    largest = size.max(axis=1)
    gate = (1.0 + 3.4 * deaf) * np.maximum(OVER * sigma, OF_TOP * largest)
    heard = np.argmax(size >= np.minimum(gate, 0.8 * largest)[:, None], axis=1)
    heard = np.clip(heard, 7, WIDE_SAMPLES - 13)
    near = heard[:, None] + np.arange(-1, 8)
    over = np.take_along_axis(size, near - BACK, axis=1) - CONSTANT * np.take_along_axis(
        size, near, axis=1
    )
    turned = (over[:, 1:] >= 0) & (over[:, :-1] < 0)
    first = np.where(turned.any(axis=1), turned.argmax(axis=1), 3)
    rows = np.arange(len(over))
    below, above = over[rows, first], over[rows, first + 1]
    part = np.clip(-below / np.maximum(above - below, 1e-9), 0.0, 1.0)
    return np.asarray(near[rows, first] + part - BEFORE)


def meters(waves: Complexes, onset: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of all since onsets, and that of samples beside first tops [2, n]."""
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    past = AT - onset[:, None]
    first = np.sum(power / (1 + ((past - TOP) / 1.3) ** 4), axis=1)
    first = np.maximum(first, sigma**2)
    all_of_it = np.maximum(np.sum(power * (past > -4.5), axis=1), 1.1 * first)
    return np.asarray(10 * np.log10(np.stack([all_of_it, first])))


class Key:
    """Waveforms of a table's rows, which meet one thing after the other.

    `sigma` [n]: of a component of noise now; `by_noise`, `by_count` [n]: factors of what is read of
    noise and of symbols; `aside_m` [n]: metres that no waveform has; `deaf`: of `onsets`.
    """

    def __init__(self, table: pd.DataFrame, afternoon: int, rng: np.random.Generator) -> None:
        self.table, self.afternoon, self.rng = table, afternoon, rng
        self.rows = table.shape[0]
        real, imaginary = (np.stack(table[part].tolist()) for part in ("cir_i", "cir_q"))
        self.had: Complexes = real + 1j * imaginary
        self.has = self.had
        self.noise_had: Floats = table["noise_std"].to_numpy(np.float64) / OF_NOISE
        self.sigma = self.noise_had
        self.by_noise, self.by_count = np.ones(self.rows), np.ones(self.rows)
        self.aside_m, self.deaf = np.zeros(self.rows), 0.0
        self.onset = onsets(self.had, self.noise_had)
        self.past: Floats = AT - self.onset[:, None]

    def visit(self) -> Visit:
        """Return the rows as they read now."""
        return Visit(self.read(), self.afternoon, self.rng)

    def always(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([1044, what, self.afternoon])

    def later_than(self, samples: float, soft: float = 1.0) -> Floats:
        """Return 0 until some samples before so many past onsets, then soon 1 [n, k]."""
        return np.asarray(0.5 + 0.5 * np.tanh((self.past - samples) / soft))

    def begun(self) -> Floats:
        """Return 0 until shortly before first pulses, then 1 [n, k]."""
        return self.later_than(-3.2, 0.5)

    def opening(self) -> Floats:
        """Return 1 as long as first pulses last, then 0 [n, k]."""
        return 1 - self.later_than(7.5, 1.2)

    def sound(self) -> Complexes:
        """Return waveforms from first pulses on; what a key's noise could be does not count."""
        apart = np.minimum(9 * (np.abs(self.has) / self.sigma[:, None] - 3.5), 50.0)
        return np.asarray(self.has * self.begun() * np.exp(-np.exp(-apart)))

    def crest(self) -> Floats:
        """Return the size of first pulses [n]."""
        return np.asarray(np.max(np.abs(self.has) * (np.abs(self.past - TOP) < 2.4), axis=1))

    def phases(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(-np.pi, np.pi, self.rows)))

    def echo(self, share: Floats | Complexes, samples: Floats, of: Complexes) -> None:
        """Add such a share [n] of waveforms [n, k], so many samples later [n]."""
        self.has = self.has + np.asarray(share)[:, None] * delayed(of, samples)

    def seethe(self, sigma: Floats) -> None:
        """Add noise of such components [n, k] or [n, 1]."""
        self.has = self.has + sigma * simmer(self.rng, self.rows)

    def weaken(self, to: Floats) -> None:
        """Leave such a part of signals [n, k]; noise stays as it was."""
        self.has = self.has * to
        self.seethe(self.sigma[:, None] * np.sqrt(np.maximum(0.0, 1 - to * to)))

    def raise_noise(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        factor = np.exp(np.maximum(db, 0.0) * np.log(10) / 20)
        self.seethe(self.sigma[:, None] * np.sqrt(factor**2 - 1)[:, None])
        self.sigma, self.by_noise = self.sigma * factor, self.by_noise * factor

    def count_fewer(self, db: Floats) -> None:
        """Add up fewer symbols, by dB <= 0 [n]: noise falls by half as many."""
        part = np.exp(np.minimum(db, 0.0) * np.log(10) / 20)
        self.has = self.has * part[:, None]
        self.seethe(self.sigma[:, None] * np.sqrt(part - part * part)[:, None])
        self.sigma, self.by_noise = self.sigma * part**0.5, self.by_noise * part**0.5
        self.by_count = self.by_count * part

    def meet(self, wrong: Wrong) -> None:
        """Let waveforms meet what goes wrong at their rows."""
        none = np.zeros(self.rows)
        self.aside_m = self.aside_m + wrong.get("metres", none)
        whole, edge = wrong.get("whole", none)[:, None], wrong.get("edge", none)[:, None]
        if whole.any() or edge.any():
            self.weaken(10 ** (self.begun() * (whole + edge * self.opening()) / 20))
        if "hiss" in wrong:
            self.raise_noise(wrong["hiss"])
        if "count" in wrong:
            self.count_fewer(wrong["count"])

    def read(self) -> pd.DataFrame:
        """Return the table as it reads now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        moved = onsets(self.has, self.sigma, self.deaf) - self.onset
        index = np.clip(was + moved, 6.0, WIDE_SAMPLES - 12.0)
        changed = meters(self.has, index, self.sigma) - meters(self.had, was, self.noise_had)
        changed -= 20 * np.log10(self.by_count)
        out = self.table.copy()
        out["first_path_index"] = index
        out["error_m"] += METRES * moved + self.aside_m
        out["range_m"] = out["true_range_m"] + out["error_m"]
        out["rx_power_dbm"] += changed[0]
        out["first_path_power_dbm"] += changed[1]
        out["noise_std"] *= self.by_noise
        out["preamble_count"] *= self.by_count
        out["cir_i"], out["cir_q"] = [*self.has.real], [*self.has.imag]
        return out
