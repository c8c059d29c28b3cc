"""The quarry's receiver: what waveforms are loaded with, and what its log has of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.quarry_pit import Load, Spoil

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 32, 212
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
ABOVE, SHARE = 6.4, 0.15  # times a component's scatter; of the largest size
STAGES, SPAN = 3.0, 1.9  # of the filters that shape a pulse; samples from its begin to its top
PLACES = np.linspace(0, WIDE_SAMPLES - 1, WIDE_SAMPLES)


def blasts(top: Floats) -> Floats:
    """Return pulses with tops of height 1 at such places in samples [n, k]: of like stages."""
    since = np.maximum(1 + (PLACES - top[:, None]) / SPAN, 0)
    return np.asarray((since * np.exp(1 - since)) ** STAGES)


def hiss(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1, of which neighbours share some, [size, k]."""
    loose = rng.normal(size=(2, size, WIDE_SAMPLES + 2))
    near = loose[:, :, 1:-1] + 0.3 * (loose[:, :, 2:] + loose[:, :, :-2])
    return np.asarray((near[0] + 1j * near[1]) / np.sqrt(1 + 2 * 0.3**2))


def held_back(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n], as sines through them have it."""
    late = np.minimum(np.maximum(samples, 0), 130)
    room = WIDE_SAMPLES + 144
    shift = np.exp(np.outer(late, -2j * np.pi * np.fft.fftfreq(room)))
    return np.asarray(np.fft.ifft(np.fft.fft(waves, n=room) * shift)[:, :WIDE_SAMPLES])


def tops(waves: Complexes, sigma: Floats, numb: float = 0.0) -> Floats:
    """Return where first tops are, by parabolas through their logarithms, in samples [n].

    The first top is the first largest of three above noise, `sigma` [n] of a component, and above
    a share of all. Numb ones ask for more of both, and wait the longer the smaller a top is.
    """
    size = np.maximum(np.abs(waves), 1e-9)
    least = np.fmax(ABOVE * sigma, SHARE * size.max(axis=1))
    bar = (1 + numb) * least
    inner = size[:, 1:-1]
    peak = (inner >= size[:, :-2]) & (inner > size[:, 2:])
    peak &= inner >= np.minimum(bar, 0.8 * size.max(axis=1))[:, None]
    at = np.clip(1 + peak.argmax(axis=1), 5, WIDE_SAMPLES - 14)
    rows = np.arange(len(size))
    low, mid, high = (np.log(size[rows, at + k]) for k in (-1, 0, 1))
    bent = np.minimum(low - 2 * mid + high, -1e-9)
    part = np.clip(0.5 * (low - high) / bent, -0.75, 0.75)
    waits = np.minimum(0.8 * numb * least / size[rows, at], 1.5)
    return np.asarray(at + part + waits)


def energies(waves: Complexes, index: Floats) -> Floats:
    """Return in dB the energy of all samples, and that about the first top [2, n]."""
    power = np.abs(waves) ** 2
    about = np.clip(1.6 - np.abs(PLACES - index[:, None] - 0.3) / 2, 0, 1)
    return np.asarray(10 * np.log10([power.sum(axis=1), (about * power).sum(axis=1)]))


class Log:
    """Waveforms of a table's rows as they are logged, load after load.

    `sigma` [n]: of a component of noise now; `noise`, `symbols` [n]: factors of what is logged of
    them; `unseen_m` [n]: metres that no waveform has; `numb`: of `tops`.
    """

    def __init__(self, table: pd.DataFrame, stratum: int, rng: np.random.Generator) -> None:
        self.table, self.stratum, self.rng = table, stratum, rng
        i, q = (np.array([*table[name]], dtype=np.float64) for name in ("cir_i", "cir_q"))
        self.raw: Complexes = i + 1j * q
        self.cir = np.array(self.raw)
        self.sigma = np.array(table["noise_std"], np.float64) / OF_NOISE
        self.noise, self.symbols, self.unseen_m = np.ones(len(i)), np.ones(len(i)), np.zeros(len(i))
        self.numb = 0.0
        self.top = tops(self.raw, self.sigma)
        self.later: Floats = PLACES - self.top[:, None]

    def spoil(self) -> Spoil:
        """Return the rows as they would be logged now."""
        return Spoil(self.logged(), self.stratum, self.rng)

    def bedded(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.stratum, 834, what])

    def begun(self) -> Floats:
        """Return 0 before first pulses and 1 from their begin on [n, k], in two samples."""
        return np.asarray(np.clip((self.later + 5.5) / 2, 0, 1))

    def early(self) -> Floats:
        """Return 1 while first pulses last, and 0 some samples later [n, k]."""
        return np.asarray(np.clip((10 - self.later) / 5, 0, 1))

    def heard(self) -> Complexes:
        """Return waveforms from the begin of the first pulse on, but for hiss that the log adds."""
        louder = np.log(np.maximum(np.abs(self.cir) / self.sigma[:, None], 0.1) / 3.0) / np.log(1.4)
        return np.asarray(self.cir * self.begun() * np.clip(louder, 0, 1))

    def loud(self) -> Floats:
        """Return the size of the first top [n]."""
        return np.asarray(np.where(np.abs(self.later) <= 1.5, np.abs(self.cir), 0).max(axis=1))

    def spin(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(0, 2 * np.pi, len(self.top))))

    def leave(self, part: Floats) -> None:
        """Leave a part of signals [n, k]; noise is made good."""
        lost = np.sqrt(np.clip(1 - part * part, 0, 1)) * self.sigma[:, None]
        self.cir = part * self.cir + lost * hiss(self.rng, len(part))

    def drown(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        power = np.maximum(10 ** (db / 10), 1.0)
        more = self.sigma * np.sqrt(power - 1)
        self.cir = self.cir + more[:, None] * hiss(self.rng, len(db))
        self.sigma, self.noise = self.sigma * power**0.5, self.noise * power**0.5

    def cut_short(self, part: Floats) -> None:
        """Add up a part of the symbols [n], and its root of noise."""
        made = (self.sigma * np.sqrt(part - part * part))[:, None]
        self.cir = self.cir * part[:, None] + made * hiss(self.rng, len(part))
        for name in ("sigma", "noise"):
            setattr(self, name, getattr(self, name) * np.sqrt(part))
        self.symbols = self.symbols * part

    def load(self, load: Load) -> None:
        """Load waveforms with what is loaded on their rows."""
        size = self.top.shape
        self.unseen_m = self.unseen_m + np.broadcast_to(load.metres, size)
        db = np.broadcast_to(load.whole, size)[:, None]
        db = db + np.broadcast_to(load.edge, size)[:, None] * self.early()
        if db.any():
            self.leave(10 ** (db * self.begun() / 20))
        if np.asarray(load.hiss).any():
            self.drown(np.broadcast_to(load.hiss, size))
        if np.asarray(load.count).any():
            self.cut_short(10 ** (np.minimum(np.broadcast_to(load.count, size), 0) / 20))

    def logged(self) -> pd.DataFrame:
        """Return the table as it is logged now."""
        out = self.table.copy()
        was = out["first_path_index"].to_numpy(np.float64)
        moved = tops(self.cir, self.sigma, self.numb) - self.top
        index = np.clip(was + moved, 5, WIDE_SAMPLES - 14)
        more = energies(self.cir, index) - energies(self.raw, was) - 20 * np.log10(self.symbols)
        out["first_path_index"] = index
        out["error_m"] += METRES * moved + self.unseen_m
        out["range_m"] = out["true_range_m"] + out["error_m"]
        out["rx_power_dbm"] += more[0]
        out["first_path_power_dbm"] += more[1]
        out["noise_std"] *= self.noise
        out["preamble_count"] *= self.symbols
        return out.assign(cir_i=[*self.cir.real], cir_q=[*self.cir.imag])
