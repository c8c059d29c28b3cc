"""The supermarket's receiver: what becomes of waveforms, and what comes onto the bill.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.market_plan import Bill, Goods

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 32, 206
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
LEAST, SHARE = 6.0, 0.1  # times a component's scatter; of the largest size
CLIMB = 0.8  # of a pulse: from its begin to half of its crest's place, in samples
QUOTA = 0.17  # of the energy of a first lobe, at which it is timed
PLACES = np.arange(WIDE_SAMPLES, dtype=np.float64)


def bumps(begin: Floats) -> Floats:
    """Return pulses of height 1 that begin at samples [n, k]: steep up, less so down."""
    since = np.maximum(PLACES - begin[:, None], 0) / CLIMB
    return np.asarray(np.square(since / 2) * np.exp(2 - since))


def grain(rng: np.random.Generator, size: int) -> Complexes:
    """Return white noise with components of scatter 1 [size, k]."""
    both = rng.standard_normal((size, WIDE_SAMPLES, 2))
    return np.asarray(both[..., 0] + 1j * both[..., 1])


def put_off(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]; zeros come in, what leaves is lost."""
    pad = 130
    late = np.clip(samples, 0, pad - 2)[:, None]
    wide = np.fft.fft(waves, WIDE_SAMPLES + pad, axis=1)
    wide = wide * np.exp(-2j * np.pi * late * np.fft.fftfreq(WIDE_SAMPLES + pad))
    return np.asarray(np.fft.ifft(wide, axis=1)[:, :WIDE_SAMPLES])


def begins(waves: Complexes, sigma: Floats, quota: float = QUOTA) -> Floats:
    """Return where waveforms begin, in samples [n]: by how energy changes, then by its sum.

    Up to the largest size, where three samples have most next to six before; there, where a quota
    of the energy of a lobe of seven samples has come. `sigma` [n]: of a component of noise.
    """
    size = np.abs(waves)
    power, top = np.square(size), size.max(axis=1)
    total = np.cumsum(np.pad(power, ((0, 0), (7, 3))), axis=1)
    ahead, behind = total[:, 9:-1] - total[:, 6:-4], total[:, 6:-4] - total[:, :-10]
    ratio = ahead / (behind + 6 * np.square(sigma)[:, None])
    least = np.minimum(np.maximum(LEAST * sigma, SHARE * top), 0.8 * top)
    fair = np.maximum(size, np.roll(size, -1, axis=1)) >= least[:, None]
    fair &= (size.argmax(axis=1)[:, None] >= PLACES) & (PLACES > 6)
    at = np.clip(np.where(fair, ratio, -1.0).argmax(axis=1), 6, WIDE_SAMPLES - 9)
    lobe = np.take_along_axis(power, at[:, None] + np.arange(-3, 5), axis=1)
    sums = np.cumsum(np.maximum(lobe - 2 * np.square(sigma)[:, None], 0), axis=1)
    sums = np.column_stack([np.zeros(len(at)), sums / np.maximum(sums[:, -1:], 1e-9)])
    passes, rows = np.maximum((sums >= quota).argmax(axis=1), 1), np.arange(len(at))
    low, high = sums[rows, passes - 1], sums[rows, passes]
    return np.asarray(at - 4.5 + passes + (quota - low) / np.maximum(high - low, 1e-9))


def totals(waves: Complexes, index: Floats) -> Floats:
    """Return in dB the energy of all samples, and of three around the first crest [2, n]."""
    power = np.square(np.abs(waves))
    off = PLACES - np.rint(index)[:, None]
    near = np.where((off > -0.5) & (off < 2.5), power, 0)
    return np.asarray(10 * np.log10(np.stack([power.sum(1), near.sum(1)]) + 1e-9))


class Desk:
    """Waveforms of a table's rows, and what effects make of them one after another.

    `sigma` [n]: of a component of noise now; `noise_by`, `count_by` [n]: factors of the noise and
    of the symbols that are logged; `aside_m` [n]: metres from elsewhere; `quota`: of energy at
    which a first lobe is timed.
    """

    def __init__(self, table: pd.DataFrame, week: int, rng: np.random.Generator) -> None:
        self.table, self.week, self.rng = table, week, rng
        inphase, quadrature = (np.array([*table[name]]) for name in ("cir_i", "cir_q"))
        self.came: Complexes = np.asarray(inphase + 1j * quadrature, np.complex128)
        self.now = self.came.copy()
        self.sigma = np.asarray(table["noise_std"], np.float64) / OF_NOISE
        self.noise_by = np.ones(len(table))
        self.count_by = np.ones(len(table))
        self.aside_m = np.zeros(len(table))
        self.quota = QUOTA
        self.begun = begins(self.came, self.sigma)
        self.after: Floats = PLACES - self.begun[:, None]

    def goods(self) -> Goods:
        """Return the rows as they would be logged now."""
        return Goods(self.logged(), self.week, self.rng)

    def fixed(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng((self.week, 755, what))

    def heard(self) -> Complexes:
        """Return waveforms with nothing before the first path, nor what is as small as noise.

        Noise comes from the desk: shelves and cables have never heard it.
        """
        clear = np.clip(1.25 * np.abs(self.now) / self.sigma[:, None] - 4, 0, 1)
        return np.where(self.after > -4, clear * self.now, 0)

    def first(self) -> Floats:
        """Return the size of the first path [n]."""
        near = np.abs(self.after - 1) < 2.5
        return np.asarray((np.abs(self.now) * near).max(axis=1))

    def spun(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(len(self.table))))

    def lose(self, left: Floats) -> None:
        """Leave a part of signals [n, k], and noise as loud as it was."""
        more = self.sigma[:, None] * np.sqrt(np.maximum(1 - left**2, 0))
        self.now = left * self.now + more * grain(self.rng, len(left))

    def louder(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        power = np.power(10.0, db / 10)
        extra = self.sigma * np.sqrt(power - 1)
        self.now = self.now + extra[:, None] * grain(self.rng, len(db))
        self.sigma, self.noise_by = self.sigma * power**0.5, self.noise_by * power**0.5

    def fewer(self, part: Floats) -> None:
        """Add up a part of the symbols [n]; the root of it is left of noise."""
        extra = self.sigma * np.sqrt(part - np.square(part))
        self.now = part[:, None] * self.now + extra[:, None] * grain(self.rng, len(part))
        self.sigma, self.noise_by = self.sigma * part**0.5, self.noise_by * part**0.5
        self.count_by = self.count_by * part

    def charge(self, bill: Bill) -> None:
        """Let what rows are billed become of waveforms."""
        one = np.ones(len(self.table))
        self.aside_m = self.aside_m + bill.metres
        if np.any(bill.whole) or np.any(bill.edge):
            opened = np.clip((self.after + 5) / 2, 0, 1)
            early = np.clip((9 - self.after) / 3, 0, 1) * (bill.edge * one)[:, None]
            self.lose(np.power(10.0, opened * ((bill.whole * one)[:, None] + early) / 20))
        if np.any(bill.hiss):
            self.louder(bill.hiss * one)
        if np.any(bill.count):
            self.fewer(np.power(10.0, np.minimum(bill.count, 0) * one / 20))

    def logged(self) -> pd.DataFrame:
        """Return the table as it is logged now."""
        was = np.asarray(self.table["first_path_index"], np.float64)
        moved = begins(self.now, self.sigma, self.quota) - self.begun
        index = np.clip(was + moved, 4, WIDE_SAMPLES - 6)
        rises = totals(self.now, index) - totals(self.came, was) - 20 * np.log10(self.count_by)
        out = self.table.assign(first_path_index=index)
        out["error_m"] = out["error_m"] + METRES * moved + self.aside_m
        out["range_m"] = out["true_range_m"] + out["error_m"]
        for column, rise in zip(("rx_power_dbm", "first_path_power_dbm"), rises, strict=True):
            out[column] = out[column] + rise
        out["noise_std"] = out["noise_std"] * self.noise_by
        out["preamble_count"] = out["preamble_count"] * self.count_by
        return out.assign(cir_i=list(self.now.real), cir_q=list(self.now.imag))
