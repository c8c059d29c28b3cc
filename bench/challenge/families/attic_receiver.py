"""The attic's receiver: what waveforms become while they are changed, and what is noted of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.attic_effects import Slate, Toll

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 26, 190
STEP_M = 0.30027217  # the way of light in a sample
RICE = 1.526390  # a component's standard deviation, for sizes that scatter by 1
NERVE, LEAST_SHARE, QUANTILE = 4.0, 0.008, 0.2  # deviations; of the largest energy; of a pulse's
BEFORE, BEHIND = 1.55, 2.05  # samples: widths of the pulse, which rises sooner than it falls


def pulse(middle: Floats) -> Floats:
    """Return pulses of height 1 around these middles in samples [n, k]: squared Lorentzians."""
    gap = np.arange(WIDE_SAMPLES) - middle[:, None]
    return np.asarray((1 + (gap / np.where(gap < 0, BEFORE, BEHIND)) ** 2) ** -2.0)


def shifted_by(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms delayed by samples >= 0 [n]; what leaves at the end is lost."""
    room = WIDE_SAMPLES + 130
    wave_number = np.fft.fftfreq(room) * 2 * np.pi
    phases = np.exp(-1j * wave_number * np.minimum(samples, 125.0)[:, None])
    whole = np.fft.ifft(np.fft.fft(waves, room, axis=1) * phases, axis=1)
    return np.asarray(whole[:, :WIDE_SAMPLES])


def found_at(waves: Complexes, sigma: Floats, nerve: float = NERVE) -> Floats:
    """Return where the first path is [n], in samples: a quantile of the energy that came first.

    It came where the energy of three samples in a row is above what noise of components `sigma`
    [n] makes, `nerve` deviations.
    """
    energy = waves.real**2 + waves.imag**2
    three = energy.copy()
    three[:, 1:] += energy[:, :-1]
    three[:, :-1] += energy[:, 1:]
    most = three.max(axis=1)
    limit = np.minimum(np.maximum(3 * (nerve * sigma) ** 2, LEAST_SHARE * most), 0.8 * most)
    first = np.clip((three > limit[:, None]).argmax(axis=1), 3, WIDE_SAMPLES - 12)
    window = first[:, None] + np.arange(-3, 6)
    above = np.maximum(np.take_along_axis(energy, window, axis=1) - 2 * sigma[:, None] ** 2, 0)
    share = np.cumsum(above, axis=1) / np.maximum(above.sum(axis=1), 1e-9)[:, None]
    place = np.maximum((share > QUANTILE).argmax(axis=1), 1)
    row = np.arange(len(share))
    low, high = share[row, place - 1], share[row, place]
    part = np.clip((QUANTILE - low) / np.maximum(high - low, 1e-9), 0, 1)
    return np.asarray(first - 3 + place - 0.5 + part)


def levels_of(waves: Complexes, index: Floats) -> Floats:
    """Return 10 log10 of the energy of all samples, and of three after the index [2, n]."""
    energy = waves.real**2 + waves.imag**2
    at = np.clip(np.floor(index).astype(int), 0, WIDE_SAMPLES - 4)
    three = sum(
        np.take_along_axis(energy, (at + after)[:, None], axis=1)[:, 0] for after in (1, 2, 3)
    )
    return np.asarray(10 * np.log10(np.array([energy.sum(axis=1), three])))


class Reception:
    """What is received in a table's rows, and changed; `noted` returns what is logged of it.

    `sigma` [n] is a component's noise now, `logged` and `share` [n] factors of the logged noise and
    of the symbols, `apart_m` [n] metres that waveforms do not show, `nerve` of the detection.
    """

    def __init__(self, table: pd.DataFrame, case: int, seed: list[int]) -> None:
        self.table, self.case, self.rng = table, case, np.random.default_rng(seed)
        self.old = np.stack([*table["cir_i"]]) + 1j * np.stack([*table["cir_q"]])
        self.waves: Complexes = self.old.copy()
        self.sigma = RICE * table["noise_std"].to_numpy(np.float64)
        self.logged, self.share, self.apart_m = np.array([[1.0], [1.0], [0.0]]).repeat(
            len(table), axis=1
        )
        self.nerve, self.was = NERVE, found_at(self.old, self.sigma)
        self.behind: Floats = np.arange(WIDE_SAMPLES) - self.was[:, None]

    def slate(self) -> Slate:
        """Return the rows as noted now."""
        return Slate(self.noted(), self.case, self.rng)

    def always(self, stream: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([stream, 514, self.case])

    def signal(self) -> Complexes:
        """Return waveforms from a little before the first path on, where they leave the noise.

        What lies within it the receiver made itself: no rafter or board returns that.
        """
        size = np.abs(self.waves) / self.sigma[:, None]
        return np.where(self.behind > -6, self.waves * (1 - np.exp(-((size / 3.6) ** 12))), 0)

    def first_height(self) -> Floats:
        """Return the height of the first path [n]."""
        near = (self.behind > -2) & (self.behind < 5)
        return np.asarray(np.where(near, np.abs(self.waves), 0).max(axis=1))

    def turns(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(len(self.table))))

    def hiss(self) -> Complexes:
        """Return white noise of components of deviation 1 [n, k]."""
        pair = self.rng.normal(size=(2, *self.waves.shape))
        return np.asarray(pair[0] + 1j * pair[1])

    def add(self, more: Complexes) -> None:
        """Add waveforms [n, k]."""
        self.waves = self.waves + more

    def echo(self, late_m: Floats, size: Complexes | Floats, of: Complexes) -> None:
        """Add waveforms again, later by metres [n] and larger by factors [n]."""
        self.add(size[:, None] * shifted_by(of, late_m / STEP_M))

    def weigh(self, gain: Floats) -> None:
        """Multiply signals by gains [n, k]; noise is what it was."""
        rest = np.sqrt(np.maximum(1 - gain**2, 0)) * self.sigma[:, None]
        self.waves = gain * self.waves + rest * self.hiss()

    def hotter(self, factor: Floats) -> None:
        """Multiply noise by factors >= 1 [n]."""
        self.add((self.sigma * np.sqrt(np.maximum(factor**2 - 1, 0)))[:, None] * self.hiss())
        self.sigma, self.logged = self.sigma * factor, self.logged * factor

    def fewer(self, share: Floats) -> None:
        """Accumulate a share <= 1 of the symbols [n]."""
        missing = self.sigma * np.sqrt(share * (1 - share))
        self.waves = share[:, None] * self.waves + missing[:, None] * self.hiss()
        self.sigma, self.logged = self.sigma * np.sqrt(share), self.logged * np.sqrt(share)
        self.share = self.share * share

    def pay(self, toll: Toll) -> None:
        """Let a toll on rows happen to waveforms."""
        self.apart_m = self.apart_m + toll.m
        ones = np.ones((len(self.table), 1))
        whole, first = (np.reshape(part, (-1, 1)) * ones for part in (toll.all_db, toll.first_db))
        if np.any(whole) or np.any(first):
            begun = np.clip((self.behind + 6) / 2, 0, 1)
            early = np.clip((7 - self.behind) / 4, 0, 1)
            self.weigh(10 ** (begun * (whole + early * first) / 20))
        if np.any(np.asarray(toll.hiss) != 1):
            self.hotter(toll.hiss * ones[:, 0])
        if np.any(np.asarray(toll.symbols) != 1):
            self.fewer(toll.symbols * ones[:, 0])

    def noted(self) -> pd.DataFrame:
        """Return the table with what the receiver notes down now."""
        moved = found_at(self.waves, self.sigma, self.nerve) - self.was
        old_index = self.table["first_path_index"].to_numpy(np.float64)
        index = np.clip(old_index + moved, 0, WIDE_SAMPLES - 5)
        rises = levels_of(self.waves, index) - levels_of(self.old, old_index)
        rises = rises - 20 * np.log10(self.share)
        made: dict[str, Any] = {"error_m": self.table["error_m"] + self.apart_m + moved * STEP_M}
        made["range_m"] = self.table["true_range_m"] + made["error_m"]
        for name, rise in zip(("rx_power_dbm", "first_path_power_dbm"), rises, strict=True):
            made[name] = self.table[name] + rise
        for name, factor in (("noise_std", self.logged), ("preamble_count", self.share)):
            made[name] = self.table[name] * factor
        made |= {"cir_i": [*self.waves.real], "cir_q": [*self.waves.imag]}
        return self.table.assign(**made, first_path_index=index)
