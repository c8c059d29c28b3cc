"""The crag's receiver: what waveforms go through, and what a bolt makes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.crag_wall import Ascent, Slip

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 37, 204
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = 0.655136  # how sizes of noise scatter, next to its parts
LOUD, OF_BEST = 6.4, 0.1  # times a part's scatter; of the largest size
WIDE = 3.05  # samples: how wide pulses are
RISE = 1.2  # samples from a first path to its top
PLACES: Floats = np.arange(WIDE_SAMPLES, dtype=np.float64)
PITCHES: Floats = np.asarray(np.fft.fftfreq(2 * WIDE_SAMPLES), np.float64)
ROUNDED: Floats = np.asarray(
    np.cos(np.pi * np.clip(np.abs(PITCHES) - 0.36, 0.0, 0.14) / 0.28) ** 2, np.float64
)
"""What is left of high pitches where waveforms are put off."""


def humps(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n]: fourth powers of Lorentz's line."""
    return np.asarray((1 + ((PLACES - top[:, None]) / WIDE) ** 2) ** -4.0)


def grain(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, of Butterworth's spectrum [rows, WIDE_SAMPLES]."""
    shape = 1 / np.sqrt(1 + (PITCHES / 0.31) ** 4)
    white = rng.standard_normal((rows, 2 * WIDE_SAMPLES, 2)) @ np.array([1, 1j])
    made = np.fft.ifft(np.fft.fft(white) * shape)[:, :WIDE_SAMPLES]
    return np.asarray(made / np.sqrt(np.mean(shape**2)))


def put_off(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by phases of their spectra."""
    late = np.clip(samples, 0.0, WIDE_SAMPLES - 1.0)[:, None]
    spectrum = np.fft.fft(waves, 2 * WIDE_SAMPLES) * ROUNDED
    moved = np.fft.ifft(spectrum * np.exp(-2j * np.pi * PITCHES * late))
    return np.asarray(moved[:, :WIDE_SAMPLES])


def first_paths(waves: Complexes, sigma: Floats, numb: float = 0.0) -> Floats:
    """Return where first pulses have their tops, less RISE, in samples [n].

    First is what is above noise, `sigma` [n] of a part, and above a part of the largest; its top is
    where a bell goes through three sizes. A numb one asks for more of both.
    """
    size = np.abs(waves) + 1e-9
    best = size.max(axis=1)
    floor = np.maximum(LOUD * sigma, OF_BEST * best) * (1 + 3.1 * numb)
    over = size > np.minimum(floor, 0.8 * best)[:, None]
    rows, at = np.arange(len(size)), over.argmax(axis=1).clip(6, WIDE_SAMPLES - 14)
    for _ in range(5):  # uphill
        at = at + (size[rows, at + 1] > size[rows, at])
    before, top, after = (np.log(size[rows, at + k]) for k in (-1, 0, 1))
    bend = np.minimum(before - 2 * top + after, -1e-6)
    return np.asarray(at + np.clip((before - after) / (2 * bend), -0.7, 0.7) - RISE)


def metered(waves: Complexes, path: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of all that follows first paths, and that of first pulses [2, n]."""
    energy = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    past = PLACES - path[:, None]
    hump = np.exp(-(((past - RISE) / 1.7) ** 4))
    pulse = np.maximum((energy * hump).sum(axis=1), sigma**2)
    whole = np.maximum((energy * ((past > -3) & (past < 110))).sum(axis=1), 1.08 * pulse)
    return np.asarray(10 * np.log10(np.stack([whole, pulse])))


class Bolt:
    """Waveforms of a table's rows, on their way through one thing after another.

    `sigma` [n]: of a part of noise by now; `hissing`, `summing` [n]: factors of what is told of
    noise and sums; `extra_m` [n]: added to ranges and nothing else; `numb`: see `first_paths`.
    """

    def __init__(self, table: pd.DataFrame, season: int, rng: np.random.Generator) -> None:
        self.table, self.season, self.rng = table, season, rng
        parts = [np.array(table[name].tolist(), np.float64) for name in ("cir_i", "cir_q")]
        self.given: Complexes = parts[0] + 1j * parts[1]
        self.waves: Complexes = self.given.copy()
        self.sigma_given: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.sigma_given.copy()
        self.hissing, self.summing, self.extra_m = (np.full(len(table), k) for k in (1.0, 1.0, 0.0))
        self.numb = 0.0
        self.path = first_paths(self.given, self.sigma)
        self.past: Floats = PLACES - self.path[:, None]

    def ascent(self) -> Ascent:
        """Return the rows as they are told now."""
        return Ascent(self.told(), self.season, self.rng)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([1214, what, self.season])

    def after(self, samples: float, ease: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 after an ease of some [n, k]."""
        part = np.clip((self.past - samples) / ease, 0.0, 1.0)
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * part))

    def arriving(self) -> Complexes:
        """Return what has come to the antenna: waveforms where they stand out of the noise."""
        stands = np.clip(np.abs(self.waves) / (0.8 * self.sigma[:, None]) - 4.0, 0.0, 1.0)
        return np.asarray(stands * self.after(-4.5) * self.waves)

    def foremost(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return np.asarray(self.after(-4.5) * (1 - self.after(5.0, 4.0)))

    def tops(self) -> Floats:
        """Return how large first pulses are [n]."""
        return np.asarray((np.abs(self.waves) * (np.abs(self.past - RISE) < 2.2)).max(axis=1))

    def turns(self) -> Complexes:
        """Return a phase of chance for each row [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(0.0, 2 * np.pi, len(self.table))))

    def again(self, of: Complexes, size: Floats | Complexes, samples: Floats) -> None:
        """Let so much of waveforms [n, k] come again, samples later [n]."""
        self.waves = self.waves + np.asarray(size)[:, None] * put_off(of, samples)

    def hear_noise(self, sigma: Floats) -> None:
        """Add noise with parts of such scatter [n, k] or [n, 1]."""
        self.waves = self.waves + sigma * grain(self.rng, len(self.table))

    def dim(self, kept: Floats) -> None:
        """Leave such a part of what arrives [n, k]; the noise is a receiver's, and stays."""
        self.waves = self.waves * kept
        self.hear_noise(self.sigma[:, None] * np.sqrt(1 - np.minimum(kept, 1.0) ** 2))

    def hiss(self, db: Floats) -> None:
        """Raise noise by dB >= 0 [n]."""
        power = 10.0 ** (np.maximum(db, 0.0) / 10)
        self.hear_noise((self.sigma * np.sqrt(power - 1))[:, None])
        self.sigma, self.hissing = self.sigma * np.sqrt(power), self.hissing * np.sqrt(power)

    def sum_less(self, db: Floats) -> None:
        """Sum fewer symbols, by dB <= 0 [n]: signals fall with them, noise by their root."""
        part = 10.0 ** (np.minimum(db, 0.0) / 20)
        root = np.sqrt(part)
        self.waves = self.waves * part[:, None]
        self.hear_noise((self.sigma * root * np.sqrt(1 - part))[:, None])
        self.sigma, self.hissing = self.sigma * root, self.hissing * root
        self.summing = self.summing * part

    def take(self, slip: Slip) -> None:
        """Let waveforms have what their rows get."""
        metres, gain, first, hiss, sums = (one + np.zeros(len(self.table)) for one in slip)
        self.extra_m = self.extra_m + metres
        if gain.any() or first.any():
            db = self.after(-4.5) * gain[:, None] + self.foremost() * first[:, None]
            self.dim(10.0 ** (db / 20))
        if hiss.any():
            self.hiss(hiss)
        if sums.any():
            self.sum_less(sums)

    def told(self) -> pd.DataFrame:
        """Return the table as a bolt tells it now."""
        later = first_paths(self.waves, self.sigma, self.numb) - self.path
        was = self.table["first_path_index"].to_numpy(np.float64)
        path = np.clip(was + later, 4.0, WIDE_SAMPLES - 12.0)
        db = metered(self.waves, path, self.sigma) - metered(self.given, was, self.sigma_given)
        db = db - 20 * np.log10(self.summing)
        error = self.table["error_m"] + METRES * later + self.extra_m
        told = {
            "error_m": error,
            "range_m": self.table["true_range_m"] + error,
            "first_path_index": path,
            "rx_power_dbm": self.table["rx_power_dbm"] + db[0],
            "first_path_power_dbm": self.table["first_path_power_dbm"] + db[1],
            "noise_std": self.table["noise_std"] * self.hissing,
            "preamble_count": self.table["preamble_count"] * self.summing,
        }
        return self.table.assign(**told, cir_i=list(self.waves.real), cir_q=list(self.waves.imag))
