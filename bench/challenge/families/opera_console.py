"""The opera's receiver: what waveforms pass, and what the console of a cleat makes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.opera_stage import Change, Cue

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 36, 220
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = 0.655136  # how sizes of noise scatter, next to a part of it
CLEAR, OF_MOST = 7.1, 0.12  # times a part's scatter; of the largest size
LOOKED_BACK = 58  # samples before the largest in which first paths are looked for
HALF_WIDE = 3.1  # samples from a pulse's top to its ends
ALIKE = (0.32, -0.17, -0.2)  # noise, from one sample to the next three [measured: DW1000]
FLANK = 7  # samples before a top in which a pulse's half is
PLACES: Floats = np.arange(WIDE_SAMPLES, dtype=np.float64)


def blackman(off: Floats) -> Floats:
    """Return pulses of height 1 at samples off their tops: Blackman's window."""
    turn = np.pi * np.clip(off / HALF_WIDE, -1.0, 1.0)
    return np.asarray(0.42 + 0.5 * np.cos(turn) + 0.08 * np.cos(2 * turn))


def struck(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return blackman(PLACES - top[:, None])


def hiss(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, coloured by its spectrum [rows, WIDE_SAMPLES]."""
    long = WIDE_SAMPLES + 36
    turn = 2 * np.pi * np.arange(long) / long
    power = 1 + 2 * sum(one * np.cos((k + 1) * turn) for k, one in enumerate(ALIKE))
    loose = rng.normal(size=(rows, long)) + 1j * rng.normal(size=(rows, long))
    coloured = np.fft.ifft(np.fft.fft(loose, axis=1) * np.sqrt(power), axis=1)
    return np.asarray(coloured[:, :WIDE_SAMPLES])


def later(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: a turn of their spectra; ends fall off."""
    late = np.clip(samples, 0.0, WIDE_SAMPLES)[:, None]
    turn = np.exp(-2j * np.pi * np.fft.fftfreq(2 * WIDE_SAMPLES) * late)
    moved = np.fft.ifft(np.fft.fft(waves, 2 * WIDE_SAMPLES, axis=1) * turn, axis=1)
    return np.asarray(moved[:, :WIDE_SAMPLES] * (late < WIDE_SAMPLES))


def first_tops(size: Floats, sigma: Floats, deaf: float) -> Integers:
    """Return at which samples first pulses have their tops [n].

    The first summit, not long before the largest, that is clear of noise, `sigma` [n] of a part,
    and above a part of the largest. What is deaf asks for more of both.
    """
    rows, largest = np.arange(len(size)), size[:, :-4].argmax(axis=1)
    most = size[rows, largest]
    asked = np.maximum(CLEAR * sigma, OF_MOST * most) * (1 + 4.2 * deaf)
    seen = size >= np.minimum(asked, 0.8 * most)[:, None]
    summit = np.ones_like(seen)
    summit[:, 1:] &= size[:, 1:] >= size[:, :-1]
    summit[:, :-1] &= size[:, :-1] > size[:, 1:]
    seen &= summit & (largest[:, None] - LOOKED_BACK <= PLACES)
    found = np.where(seen.any(axis=1), seen.argmax(axis=1), largest)
    return np.asarray(found.clip(FLANK + 2, WIDE_SAMPLES - 6), np.int64)


def edges(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return where first pulses come up to half of their tops, in samples [n].

    Tops are those of parabolas; between two samples sizes are taken to grow exponentially.
    """
    size = np.abs(waves) + 1e-9
    rows, top = np.arange(len(size)), first_tops(size, sigma, deaf)
    before, at, after = (size[rows, top + k] for k in (-1, 0, 1))
    bend = np.maximum(2 * at - before - after, 1e-9)
    half = 0.5 * (at + np.minimum((after - before) ** 2 / (8 * bend), 0.12 * at))
    flank = size[rows[:, None], top[:, None] - np.arange(FLANK + 1)]
    below = flank < half[:, None]
    back = np.where(below.any(axis=1), below.argmax(axis=1), FLANK).clip(min=1)
    low, high = flank[rows, back], flank[rows, back - 1]
    part = np.log(half / low) / np.maximum(np.log(high / low), 1e-9)
    return np.asarray(top - back + part.clip(0.0, 1.0))


def _lone() -> tuple[float, float, float]:
    """Return, for lone pulses: from edges to tops in samples, energy of all and of three."""
    tops = WIDE_LEAD + np.arange(200) / 200
    waves = struck(tops).astype(np.complex128)
    edge = edges(waves, np.full(200, 1e-6))
    whole, three = _energies(waves, edge, 0.0)
    return float(np.mean(tops - edge)), float(whole.mean()), float(three.mean())


def _energies(waves: Complexes, edge: Floats, sigma: Floats | float) -> tuple[Floats, Floats]:
    """Return the energy of all that comes from edges on, and of the three samples there [n]."""
    power = np.abs(waves) ** 2 - 2 * (np.zeros(len(waves)) + sigma)[:, None] ** 2
    since = PLACES - np.floor(edge)[:, None]
    whole = (power * ((since >= -2) & (since < 112))).sum(axis=1)
    return whole, (power * ((since >= 1) & (since <= 3))).sum(axis=1)


RISE, OF_WHOLE, OF_THREE = _lone()


def in_db(waves: Complexes, edge: Floats, sigma: Floats) -> Floats:
    """Return, in dB of a lone pulse of height 1, all that comes and what first paths bring [2, n].

    As chips have it (DW1000 User Manual, 4.7): a sum over all, and over three samples.
    """
    whole, three = _energies(waves, edge, sigma)
    three = np.maximum(three / OF_THREE, 0.5 * sigma**2)
    return np.asarray(10 * np.log10(np.stack([np.maximum(whole / OF_WHOLE, 1.04 * three), three])))


class Console:
    """Waveforms of a table's rows, and what becomes of them in one thing after another.

    `sigma` [n]: of a part of noise by now; `told_noise`, `told_sums` [n]: factors of what is told;
    `aside_m` [n]: added to ranges alone; `deaf`: see `first_tops`.
    """

    def __init__(self, table: pd.DataFrame, stable: int, rng: np.random.Generator) -> None:
        self.table, self.stable, self.rng, self.count = table, stable, rng, len(table)
        real, imaginary = (np.array([*table[name]], np.float64) for name in ("cir_i", "cir_q"))
        self.before: Complexes = real + 1j * imaginary
        self.wave = self.before.copy()
        self.sigma_before: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.sigma_before.copy()
        self.told_noise, self.told_sums = np.ones(self.count), np.ones(self.count)
        self.aside_m: Floats = np.zeros(self.count)
        self.deaf = 0.0
        self.edge = edges(self.before, self.sigma_before)
        self.since: Floats = PLACES - self.edge[:, None]

    def cue(self) -> Cue:
        """Return the rows as they are told now."""
        return Cue(self.told(), self.stable, self.rng)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.stable, 1505, what])

    def after(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past edges, 1 some later: a smooth step [n, k]."""
        part = np.clip((self.since - samples) / within, 0.0, 1.0)
        return np.asarray(part**2 * (3 - 2 * part))

    def arrived(self) -> Complexes:
        """Return what came by air [n, k]: what is clear of noise, which is the console's own."""
        loud = np.clip(np.abs(self.wave) / self.sigma[:, None] - 3.9, 0.0, 1.0)
        return np.asarray(self.wave * self.after(-4.5) * loud)

    def beginning(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return np.asarray(self.after(-4.5) * (1 - self.after(5.0, 3.0)))

    def heights(self) -> Floats:
        """Return how high first pulses are [n]."""
        near = np.abs(self.since - RISE) <= 2.0
        return np.asarray((np.abs(self.wave) * near).max(axis=1))

    def phases(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(-np.pi, np.pi, self.count)))

    def echo(self, what: Complexes, size: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come so many samples later [n]."""
        self.wave = self.wave + (np.zeros(self.count) + size)[:, None] * later(what, samples)

    def add_noise(self, sigma: Floats) -> None:
        """Add noise with parts of such a scatter, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * hiss(self.rng, self.count)

    def weaken(self, left: Floats) -> None:
        """Leave a part of what comes by air [n, k]; noise stays as large as it was."""
        self.wave = self.wave * left
        self.add_noise(self.sigma[:, None] * np.sqrt(np.clip(1 - left**2, 0.0, None)))

    def louder_noise(self, db: Floats) -> None:
        """Raise noise by dB >= 0 [n]."""
        times = 10 ** (np.clip(db, 0.0, None) / 20)
        self.add_noise((self.sigma * np.sqrt(times**2 - 1))[:, None])
        self.sigma, self.told_noise = self.sigma * times, self.told_noise * times

    def sum_fewer(self, db: Floats) -> None:
        """Sum fewer symbols, by dB <= 0 [n]: signals fall with them, noise with their root."""
        left = 10 ** (np.clip(db, None, 0.0) / 20)
        self.wave = self.wave * left[:, None]
        self.add_noise((self.sigma * np.sqrt(left - left**2))[:, None])
        root = np.sqrt(left)
        self.sigma, self.told_noise = self.sigma * root, self.told_noise * root
        self.told_sums = self.told_sums * left

    def bear(self, change: Change) -> None:
        """Let waveforms have what becomes of their rows."""
        metres, everything, first, noise, sums = (one + np.zeros(self.count) for one in change)
        self.aside_m = self.aside_m + metres
        if np.any(everything) or np.any(first):
            db = self.after(-4.5) * everything[:, None] + self.beginning() * first[:, None]
            self.weaken(10 ** (db / 20))
        if np.any(noise):
            self.louder_noise(noise)
        if np.any(sums):
            self.sum_fewer(sums)

    def told(self) -> pd.DataFrame:
        """Return the table as the console tells it now."""
        moved = edges(self.wave, self.sigma, self.deaf) - self.edge
        was = self.table["first_path_index"].to_numpy(np.float64)
        index = np.clip(was + moved, 6.0, WIDE_SAMPLES - 8.0)
        db = in_db(self.wave, index, self.sigma) - in_db(self.before, was, self.sigma_before)
        db = db - 20 * np.log10(self.told_sums)
        error = self.table["error_m"] + METRES * moved + self.aside_m
        return self.table.assign(
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            first_path_index=index,
            rx_power_dbm=self.table["rx_power_dbm"] + db[0],
            first_path_power_dbm=self.table["first_path_power_dbm"] + db[1],
            noise_std=self.table["noise_std"] * self.told_noise,
            preamble_count=self.table["preamble_count"] * self.told_sums,
            cir_i=[*self.wave.real],
            cir_q=[*self.wave.imag],
        )
