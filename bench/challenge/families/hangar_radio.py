"""The hangar's receiver: what waveforms go through, and what a girder's radio makes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.hangar_bay import Job, Toll

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 35, 208
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = 0.655136  # how sizes of noise scatter, next to its parts
LOUD, OF_LOUDEST = 6.6, 0.11  # times a part's scatter; of the largest size
WIDE = 1.42  # samples: how wide pulses are
AT: Floats = np.arange(WIDE_SAMPLES, dtype=np.float64)
PITCH: Floats = np.asarray(np.fft.fftfreq(2 * WIDE_SAMPLES), np.float64)
SMOOTH: Floats = np.exp(-((np.abs(PITCH) / 0.44) ** 12))  # left of pitches when put off


def pulses(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n]: squares of a hyperbolic secant."""
    return np.asarray(np.cosh(np.clip((AT - top[:, None]) / WIDE, -30, 30)) ** -2.0)


def rustle(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, of a band with round sides [rows, WIDE_SAMPLES]."""
    band = np.exp(-((np.abs(PITCH) / 0.33) ** 4))
    white = rng.standard_normal((2, rows, 2 * WIDE_SAMPLES))
    made = np.fft.ifft(np.fft.fft(white[0] + 1j * white[1]) * band)[:, :WIDE_SAMPLES]
    return np.asarray(made / np.sqrt(np.mean(band**2)))


def delayed(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: what leaves the record does not come back."""
    late = np.clip(samples, 0.0, WIDE_SAMPLES - 1.0)[:, None]
    spectrum = np.fft.fft(waves, 2 * WIDE_SAMPLES) * SMOOTH
    return np.asarray(np.fft.ifft(spectrum * np.exp(-2j * np.pi * PITCH * late))[:, :WIDE_SAMPLES])


def half_rises(waves: Complexes, sigma: Floats, hard: float = 0.0) -> Floats:
    """Return where first pulses have risen to half of their tops, in samples [n].

    First is what is above noise, `sigma` [n] of a part, and above a part of the largest; one that
    is hard of hearing asks for more of both.
    """
    size = np.abs(waves) + 1e-9
    loudest = size.max(axis=1)
    least = np.maximum(LOUD * sigma, OF_LOUDEST * loudest) * (1 + 2.9 * hard)
    over = size > np.minimum(least, 0.75 * loudest)[:, None]
    rows, top = np.arange(len(size)), over.argmax(axis=1).clip(8, WIDE_SAMPLES - 12)
    for _ in range(5):  # uphill
        top = top + (size[rows, top + 1] > size[rows, top])
    half, low = 0.5 * size[rows, top], top.copy()
    for _ in range(7):  # and down to half, on the side that comes first
        low = low - (size[rows, low] > half)
    rise = np.maximum(size[rows, low + 1] - size[rows, low], 1e-9)
    return np.asarray(low + np.clip((half - size[rows, low]) / rise, 0.0, 1.0))


def read_levels(waves: Complexes, path: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of all since first paths, and that of first pulses [2, n]."""
    energy = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    since = AT - path[:, None]
    first = np.clip(since + 2.0, 0.0, 1.0) * np.clip(4.5 - since, 0.0, 1.0)
    pulse = np.maximum((energy * first).sum(axis=1), sigma**2)
    whole = np.maximum((energy * ((since > -3) & (since < 115))).sum(axis=1), 1.06 * pulse)
    return np.asarray(10 * np.log10(np.stack([whole, pulse])))


def _rise() -> float:
    """Return how far before tops half rises are found on average, in samples, without noise."""
    tops = WIDE_LEAD + np.linspace(0.0, 1.0, 65)[:-1]
    found = half_rises(pulses(tops).astype(np.complex128), np.zeros(len(tops)))
    return float(np.mean(tops - found))


RISE = _rise()


class Radio:
    """Waveforms of a table's rows, on their way through one thing after another.

    `sigma` [n]: of a part of noise by now; `noisier`, `fewer` [n]: factors of what is told of noise
    and of sums; `beside_m` [n]: added to ranges and nothing else; `hard`: see `half_rises`.
    """

    def __init__(self, table: pd.DataFrame, day: int, rng: np.random.Generator) -> None:
        self.table, self.day, self.rng, self.rows = table, day, rng, len(table)
        real, imaginary = (np.array(table[k].tolist(), np.float64) for k in ("cir_i", "cir_q"))
        self.given: Complexes = real + 1j * imaginary
        self.wave: Complexes = self.given.copy()
        self.sigma_given: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.sigma_given.copy()
        self.noisier, self.fewer = np.ones(self.rows), np.ones(self.rows)
        self.beside_m, self.hard = np.zeros(self.rows), 0.0
        self.path = half_rises(self.given, self.sigma)
        self.since: Floats = AT - self.path[:, None]

    def job(self) -> Job:
        """Return the rows as they are told now."""
        return Job(self.told(), self.day, self.rng)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([1314, what, self.day])

    def beyond(self, samples: float, ease: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 from an ease later [n, k]."""
        part = np.clip((self.since - samples) / ease, 0.0, 1.0)
        return np.asarray(part**2 * (3 - 2 * part))

    def coming(self) -> Complexes:
        """Return what comes in at the antenna: where waveforms stand out of a radio's noise."""
        loud = np.abs(self.wave) / self.sigma[:, None]
        return np.asarray(np.clip(loud / 1.2 - 3.4, 0.0, 1.0) * self.beyond(-4.0) * self.wave)

    def leading(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return np.asarray(self.beyond(-4.0) * (1 - self.beyond(5.5, 4.0)))

    def heights(self) -> Floats:
        """Return how large first pulses are [n]."""
        return np.asarray((np.abs(self.wave) * (np.abs(self.since - RISE) < 2.5)).max(axis=1))

    def phases(self) -> Complexes:
        """Return a phase of chance for each row [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def echo(self, of: Complexes, size: Floats | Complexes, samples: Floats) -> None:
        """Let so much of waveforms [n, k] come once more, samples later [n]."""
        self.wave = self.wave + np.asarray(size)[:, None] * delayed(of, samples)

    def rustles(self, sigma: Floats) -> None:
        """Add noise with parts of such scatter [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * rustle(self.rng, self.rows)

    def weaken(self, kept: Floats) -> None:
        """Leave such a part of what comes in [n, k]; noise is made in the radio, and stays."""
        self.wave = self.wave * kept
        self.rustles(self.sigma[:, None] * np.sqrt(1 - np.minimum(kept, 1.0) ** 2))

    def louder_noise(self, db: Floats) -> None:
        """Raise noise by dB >= 0 [n]."""
        power = 10.0 ** (np.maximum(db, 0.0) / 10)
        self.rustles((self.sigma * np.sqrt(power - 1))[:, None])
        self.sigma, self.noisier = self.sigma * np.sqrt(power), self.noisier * np.sqrt(power)

    def sum_fewer(self, db: Floats) -> None:
        """Sum fewer symbols, by dB <= 0 [n]: signals fall with them, noise by their root."""
        part = 10.0 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * part[:, None]
        self.rustles((self.sigma * np.sqrt(part - part**2))[:, None])
        self.sigma, self.noisier = self.sigma * np.sqrt(part), self.noisier * np.sqrt(part)
        self.fewer = self.fewer * part

    def pay(self, toll: Toll) -> None:
        """Let waveforms have what their rows get."""
        metres, every, first, noise, sums = (np.zeros(self.rows) + one for one in toll)
        self.beside_m = self.beside_m + metres
        if every.any() or first.any():
            db = self.beyond(-4.0) * every[:, None] + self.leading() * first[:, None]
            self.weaken(10.0 ** (db / 20))
        if noise.any():
            self.louder_noise(noise)
        if sums.any():
            self.sum_fewer(sums)

    def told(self) -> pd.DataFrame:
        """Return the table as a radio tells it now."""
        later = half_rises(self.wave, self.sigma, self.hard) - self.path
        was = self.table["first_path_index"].to_numpy(np.float64)
        path = np.clip(was + later, 4.0, WIDE_SAMPLES - 12.0)
        db = read_levels(self.wave, path, self.sigma)
        db = db - read_levels(self.given, was, self.sigma_given) - 20 * np.log10(self.fewer)
        error = self.table["error_m"] + METRES * later + self.beside_m
        return self.table.assign(
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            first_path_index=path,
            rx_power_dbm=self.table["rx_power_dbm"] + db[0],
            first_path_power_dbm=self.table["first_path_power_dbm"] + db[1],
            noise_std=self.table["noise_std"] * self.noisier,
            preamble_count=self.table["preamble_count"] * self.fewer,
            cir_i=list(self.wave.real),
            cir_q=list(self.wave.imag),
        )
