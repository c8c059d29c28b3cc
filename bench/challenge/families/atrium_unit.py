"""The atrium's receiver: what waveforms go through, and what a unit on a balcony makes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.atrium_well import Ride, Upset

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 36, 220
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = 0.655136  # how sizes of noise scatter, next to a part of it
ABOVE, OF_MOST = 6.6, 0.095  # times a part's scatter; of the largest size
BROAD = 1.42  # samples: how broad pulses are
RISE = BROAD * float(np.arccosh(np.sqrt(2.0)))  # samples from half of a top to the top
TAPS: Complexes = np.array([0.25, 0.9, 0.35 + 0.12j, -0.22, -0.12j])
"""What noise is filtered by."""
AT: Floats = np.arange(float(WIDE_SAMPLES))
REACH, BETA = 8, 6.0  # samples on either side that a moved one is made of; Kaiser's


def pulses(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n]: squares of a hyperbolic secant."""
    off = np.clip((AT - top[:, None]) / BROAD, -30.0, 30.0)
    return np.asarray(np.cosh(off) ** -2.0)


def rustle(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1: white, filtered by TAPS [rows, WIDE_SAMPLES]."""
    white = rng.normal(size=(2, rows, WIDE_SAMPLES + len(TAPS) - 1))
    both = white[0] + 1j * white[1]
    made = sum(tap * both[:, k : k + WIDE_SAMPLES] for k, tap in enumerate(TAPS))
    return np.asarray(made / np.sqrt((np.abs(TAPS) ** 2).sum()))


def moved(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by sincs in Kaiser's window."""
    samples = np.clip(samples, 0.0, WIDE_SAMPLES - 1.0)
    whole = samples.astype(np.int64)
    part = samples - whole
    wide = np.pad(waves, ((0, 0), (WIDE_SAMPLES + REACH, REACH)))
    rows = np.arange(len(waves))[:, None]
    begin = WIDE_SAMPLES + REACH + np.arange(WIDE_SAMPLES) - whole[:, None]
    out = np.zeros_like(waves)
    for tap in range(1 - REACH, REACH + 1):
        away = tap - part
        inner = np.sqrt(np.maximum(1 - (away / REACH) ** 2, 0.0))
        weight = np.sinc(away) * np.i0(BETA * inner) / np.i0(BETA)
        out += weight[:, None] * wide[rows, begin - tap]
    return out


def halves(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return where first pulses have half of their tops, on their way up, in samples [n].

    First is what is above noise, `sigma` [n] of a part, and above a part of the largest. A deaf one
    asks for more of both.
    """
    size = np.abs(waves) + 1e-9
    most = size.max(axis=1)
    asked = (1 + 4.4 * deaf) * np.maximum(ABOVE * sigma, OF_MOST * most)
    found = np.argmax(size >= np.minimum(asked, 0.78 * most)[:, None], axis=1)
    rows, top = np.arange(len(size)), np.clip(found, 9, WIDE_SAMPLES - 18)
    for _ in range(7):  # uphill
        top = np.where(size[rows, top + 1] > size[rows, top], top + 1, top)
    left, mid, right = (size[rows, top + k] for k in (-1, 0, 1))
    bend = np.minimum(left + right - 2 * mid, -1e-9)
    half = 0.5 * (mid - np.clip((right - left) ** 2 / (8 * bend), -0.2 * mid, 0.0))
    at = top.copy()
    for _ in range(8):  # downhill, backward
        at = np.where(size[rows, at] > half, at - 1, at)
    low, high = np.log(size[rows, at]), np.log(size[rows, at + 1])
    return np.asarray(at + np.clip((np.log(half) - low) / np.maximum(high - low, 1e-9), 0.0, 1.0))


def energies(waves: Complexes, half: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of all that follows first paths, and that of first pulses [2, n]."""
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    past = AT - half[:, None] - RISE
    first = np.maximum((power / (1 + (past / 1.9) ** 8)).sum(axis=1), sigma**2)
    every = (power / (1 + np.exp(np.clip(-4 * (past + 3.5), -50, 50)))) * (past < 115)
    return np.asarray(10 * np.log10([np.maximum(every.sum(axis=1), 1.1 * first), first]))


class Unit:
    """Waveforms of a table's rows, and what becomes of them.

    `sigma` [n]: of a part of noise now; `noisier`, `fewer` [n]: factors of what is told of noise
    and symbols; `metres` [n]: added to ranges alone; `deaf`: see `halves`.
    """

    def __init__(self, table: pd.DataFrame, house: int, rng: np.random.Generator) -> None:
        self.table, self.house, self.rng, self.size = table, house, rng, len(table)
        real, imaginary = (np.stack(list(table[name])) for name in ("cir_i", "cir_q"))
        self.before: Complexes = np.asarray(real + 1j * imaginary, np.complex128)
        self.wave = self.before.copy()
        self.calm: Floats = np.asarray(table["noise_std"], np.float64) / OF_SIZES
        self.sigma = self.calm.copy()
        self.noisier: Floats = np.ones(self.size)
        self.fewer: Floats = np.ones(self.size)
        self.metres: Floats = np.zeros(self.size)
        self.deaf = 0.0
        self.half = halves(self.before, self.calm)
        self.past: Floats = AT - self.half[:, None]

    def ride(self) -> Ride:
        """Return the rows as they are told now."""
        return Ride(self.told(), self.house, self.rng)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.house, what, 1305])

    def since(self, samples: float, soft: float = 0.7) -> Floats:
        """Return 0 before so many samples past first paths, 1 after them, softly [n, k]."""
        return np.asarray(0.5 + 0.5 * np.tanh((self.past - samples) / soft))

    def came(self) -> Complexes:
        """Return what came by air [n, k]: what is far above the noise, which is a unit's own."""
        over = (np.abs(self.wave) / self.sigma[:, None] / 3.6) ** 6
        return np.asarray(self.wave * self.since(-3.0) * over / (1 + over))

    def front(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return np.asarray(self.since(-3.0) * (1 - self.since(6.0, 1.5)))

    def height(self) -> Floats:
        """Return how high first pulses are [n]."""
        return np.asarray((np.abs(self.wave) * (np.abs(self.past - RISE) < 2)).max(axis=1))

    def any_phase(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(-np.pi, np.pi, self.size)))

    def echo(self, what: Complexes, by: Floats | Complexes, samples: Floats) -> None:
        """Add a part [n] of something [n, k], so many samples later [n]."""
        self.wave = self.wave + np.asarray(by)[:, None] * moved(what, samples)

    def add_noise(self, sigma: Floats) -> None:
        """Add noise with such parts, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * rustle(self.rng, self.size)

    def weaken(self, part: Floats) -> None:
        """Let a part of what comes be left [n, k], and noise as it was."""
        self.wave = self.wave * part
        self.add_noise(self.sigma[:, None] * np.sqrt(np.clip(1 - part**2, 0.0, 1.0)))

    def raise_noise(self, db: Floats) -> None:
        """Raise noise by dB >= 0 [n]."""
        by = np.exp(np.maximum(db, 0.0) * np.log(10) / 20)
        self.add_noise((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.noisier = self.sigma * by, self.noisier * by

    def add_up_less(self, db: Floats) -> None:
        """Add up fewer symbols, by dB <= 0 [n]; noise goes with their root."""
        part = np.exp(np.minimum(db, 0.0) * np.log(10) / 20)
        self.wave = self.wave * part[:, None]
        self.add_noise((self.sigma * np.sqrt(part - part**2))[:, None])
        self.sigma, self.noisier = self.sigma * part**0.5, self.noisier * part**0.5
        self.fewer = self.fewer * part

    def upset(self, by: Upset) -> None:
        """Let waveforms have what upsets their rows."""
        metres, whole, first, noise, symbols = (np.zeros(self.size) + one for one in by)
        self.metres = self.metres + metres
        if np.any(whole) or np.any(first):
            db = whole[:, None] * self.since(-3.0) + first[:, None] * self.front()
            self.weaken(np.exp(db * np.log(10) / 20))
        if np.any(noise):
            self.raise_noise(noise)
        if np.any(symbols):
            self.add_up_less(symbols)

    def told(self) -> pd.DataFrame:
        """Return the table as a unit tells it now."""
        later = halves(self.wave, self.sigma, self.deaf) - self.half
        index = self.table["first_path_index"].to_numpy(np.float64)
        path = np.clip(index + later, 5.0, WIDE_SAMPLES - 10.0)
        grown = energies(self.wave, path, self.sigma) - energies(self.before, index, self.calm)
        grown = grown - 20 * np.log10(self.fewer)
        error = self.table["error_m"] + METRES * later + self.metres
        return self.table.assign(
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            first_path_index=path,
            rx_power_dbm=self.table["rx_power_dbm"] + grown[0],
            first_path_power_dbm=self.table["first_path_power_dbm"] + grown[1],
            noise_std=self.table["noise_std"] * self.noisier,
            preamble_count=self.table["preamble_count"] * self.fewer,
            cir_i=list(self.wave.real),
            cir_q=list(self.wave.imag),
        )
