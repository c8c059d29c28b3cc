"""The depot's radio as an instrument: waveforms, how a first path is found, and what is logged.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.depot_effects import Sheet

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 24, 200
METRES = 0.300272  # light travels in one sample
HALF_WIDTH = 2.7  # samples from the middle of a pulse to where it is over
STANDS_OUT, OF_LARGEST, ON_EDGE = 9.0, 0.07, 0.4
TOLD = 1.0 / 0.6551  # a component's standard deviation over that of sizes


def pulse_at(middle: Floats) -> Floats:
    """Return pulses [n, k] with these middles in samples [n]: the fourth power of a cosine."""
    gap = np.clip((np.arange(WIDE_SAMPLES) - middle[:, None]) / HALF_WIDTH, -1, 1)
    return np.asarray(np.cos(np.pi / 2 * gap) ** 4)


def delayed(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: whole ones moved, a rest interpolated."""
    whole = np.floor(samples).astype(int)
    rest = (samples - whole)[:, None]
    taps = (
        -rest * (rest - 1) * (rest - 2) / 6, (rest + 1) * (rest - 1) * (rest - 2) / 2,
        -(rest + 1) * rest * (rest - 2) / 2, (rest + 1) * rest * (rest - 1) / 6,
    )  # fmt: skip
    made = np.zeros_like(waves)
    for number, tap in enumerate(taps):
        at = np.arange(waves.shape[1]) - whole[:, None] - number + 1
        inside = (at >= 0) & (at < waves.shape[1])
        made += tap * inside * np.take_along_axis(waves, np.clip(at, 0, waves.shape[1] - 1), axis=1)
    return made


def first_edge(waves: Complexes, sigma: Floats, of_largest: float = OF_LARGEST) -> Floats:
    """Return where the first thing that stands out is at ON_EDGE of its height, in samples [n]."""
    size = np.abs(waves)
    most = size.max(axis=1)
    least = np.minimum(np.maximum(STANDS_OUT * sigma, of_largest * most), 0.98 * most)
    out = []
    for row, wanted in zip(size, least, strict=True):
        at = int(np.argmax(row > wanted))
        top = row[at : at + 3].max()
        while at > 0 and row[at] > ON_EDGE * top:
            at -= 1
        while at < len(row) - 2 and row[at + 1] < ON_EDGE * top:
            at += 1
        out.append(at + (ON_EDGE * top - row[at]) / max(row[at + 1] - row[at], 1e-9))
    return np.asarray(np.clip(out, 0, size.shape[1] - 1))


def energies(waves: Complexes, index: Floats) -> tuple[Floats, Floats]:
    """Return the energy of all samples, and of the three after the first path, both [n]."""
    at = np.floor(index).astype(int)[:, None] + np.arange(1, 4)
    near = np.take_along_axis(waves, np.minimum(at, waves.shape[1] - 1), axis=1)
    return (np.abs(waves) ** 2).sum(axis=1), (np.abs(near) ** 2).sum(axis=1)


class Scope:
    """What the radio receives, while effects change it; `log` returns what it writes down.

    `sigma` is the noise of a component now, `told` and `count` [n] factors of the logged noise
    and symbols; `late_m` [n] is what no waveform shows; `share`: of the largest, to be found.
    """

    def __init__(self, table: pd.DataFrame, kept: int, seed: list[int]) -> None:
        self.table, self.kept = table, kept
        self.rng = np.random.default_rng(seed)
        real, imaginary = (np.array(table[f"cir_{part}"].tolist()) for part in "iq")
        self.first = np.asarray(real + 1j * imaginary, np.complex128)
        self.waves, self.share = self.first.copy(), OF_LARGEST
        self.sigma = table["noise_std"].to_numpy(np.float64) * TOLD
        self.told, self.count = np.ones(len(table)), np.ones(len(table))
        self.late_m = np.zeros(len(table))
        self.began = first_edge(self.first, self.sigma)

    @property
    def after(self) -> Floats:
        """Samples since the first path as it was [n, k]."""
        return np.asarray(np.arange(WIDE_SAMPLES) - self.began[:, None], np.float64)

    @property
    def heard(self) -> Complexes:
        """Waveforms from shortly before the first path on, as far as they came by the antenna.

        What is not three times as large as noise is taken for noise, which comes after it.
        """
        larger = np.clip(np.abs(self.waves) / self.sigma[:, None] - 3, 0, 1)
        return np.where(self.after > -6, self.waves * larger**2 * (3 - 2 * larger), 0)

    @property
    def tallest(self) -> Floats:
        """The largest size of the first path [n]."""
        return np.asarray(np.where(np.abs(self.after) < 4, np.abs(self.waves), 0).max(axis=1))

    def sheet(self) -> Sheet:
        """Return the rows as they are logged now, to be changed."""
        return Sheet(self.log(), self.kept, self.rng)

    def same(self, stream: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.kept, stream, 98])

    def add(self, other: Complexes | Floats) -> None:
        """Add waveforms."""
        self.waves = self.waves + other

    def add_noise(self, sigma: Floats) -> None:
        """Add white noise of these components [n] or [n, k], that nothing logs."""
        drawn = self.rng.normal(size=(2, *self.waves.shape))
        self.add((drawn[0] + 1j * drawn[1]) * (sigma if sigma.ndim == 2 else sigma[:, None]))

    def scale(self, factor: Floats) -> None:
        """Scale signals by factors [n, k] where noise stays what it is."""
        self.waves = self.waves * factor
        self.add_noise(self.sigma[:, None] * np.sqrt(np.clip(1 - factor**2, 0, None)))

    def hiss(self, factor: Floats) -> None:
        """Let noise be larger by factors >= 1 [n]."""
        self.add_noise(self.sigma * np.sqrt(factor**2 - 1))
        self.sigma, self.told = self.sigma * factor, self.told * factor

    def stop_early(self, share: Floats) -> None:
        """Accumulate shares of the symbols [n]: signals in proportion, noise as their root."""
        self.waves = self.waves * share[:, None]
        self.add_noise(self.sigma * np.sqrt(share - share**2))
        root = np.sqrt(share)
        self.sigma, self.told, self.count = self.sigma * root, self.told * root, self.count * share

    def apply(self, sheet: Sheet) -> None:
        """Let what rows gained happen to waveforms and ranges."""
        none = np.zeros(len(self.table))
        late, louder, straight, noise, fewer = (
            sheet.gained.get(name, none)
            for name in ("late_m", "all_db", "straight_db", "noise_db", "symbols_db")
        )
        self.late_m = self.late_m + late
        if louder.any() or straight.any():
            begun = np.clip((self.after + 6) / 2, 0, 1)
            fades = np.clip((6 - self.after) / 3, 0, 1)
            gain_db = louder[:, None] * begun + straight[:, None] * begun * fades
            self.scale(10 ** (gain_db / 20))
        if noise.any():
            self.hiss(10 ** (np.maximum(noise, 0) / 20))
        if fewer.any():
            self.stop_early(10 ** (fewer / 20))

    def log(self) -> pd.DataFrame:
        """Return the table with what the radio writes down now."""
        moved = first_edge(self.waves, self.sigma, self.share) - self.began
        old = self.table["first_path_index"].to_numpy(np.float64)
        index = np.clip(old + moved, 0, WIDE_SAMPLES - 6)
        out = self.table.copy()
        out["error_m"] += self.late_m + moved * METRES
        out["range_m"] = out["true_range_m"] + out["error_m"]
        out["first_path_index"] = index
        before, now = energies(self.first, old), energies(self.waves, index)
        for name, was, is_now in zip(("rx", "first_path"), before, now, strict=True):
            out[f"{name}_power_dbm"] += 10 * np.log10(is_now / was / self.count**2)
        out["noise_std"] *= self.told
        out["preamble_count"] *= self.count
        out["cir_i"], out["cir_q"] = list(self.waves.real), list(self.waves.imag)
        return out
