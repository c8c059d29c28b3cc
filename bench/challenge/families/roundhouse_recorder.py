"""The roundhouse's receiver: what waveforms pass, and what a recorder at a pier makes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. First paths are where
the rise to the first top is on average: each step up weighs by its square.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.roundhouse_stalls import Shunt, Toll

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 40, 232
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
CLEAR, OF_LARGEST = 6.8, 0.11  # times a part's scatter; of the largest size
LOOKED_BACK = 84  # samples before the largest in which first paths are looked for
HALF_WIDE = 3.3  # samples from a pulse's top to where it ends
TAKEN = 6  # samples before and after, of which what is between samples is made
ALIKE = (1.0, 0.32, -0.17, -0.2)  # noise after none, one, two and three samples [DW1000]
PLACES: Floats = np.arange(WIDE_SAMPLES, dtype=np.float64)


def window(off: Floats) -> Floats:
    """Return pulses of height 1 at samples off their tops: Blackman's window."""
    turn = np.pi * np.clip(off / HALF_WIDE, -1.0, 1.0)
    return np.asarray(0.42 + 0.5 * np.cos(turn) + 0.08 * np.cos(2 * turn))


def pulses(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return window(PLACES - top[:, None])


def _root() -> Floats:
    """Return what makes of loose numbers such as are alike by ALIKE [k, k] (Cholesky)."""
    apart = np.abs(PLACES[:, None] - PLACES).astype(int)
    return np.linalg.cholesky(np.append(ALIKE, 0.0)[apart.clip(max=len(ALIKE))])


ROOT: Floats = _root()


def crackle(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, alike from sample to sample [rows, WIDE_SAMPLES]."""
    loose = rng.normal(size=(2, rows, WIDE_SAMPLES)) @ ROOT.T
    return np.asarray(loose[0] + 1j * loose[1])


def held_back(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: between samples by a windowed sinc."""
    late = np.clip(samples, 0.0, WIDE_SAMPLES + 9.0)
    whole = np.ceil(late).astype(np.int64)
    early = (whole - late)[:, None]
    wide = np.pad(waves, ((0, 0), (WIDE_SAMPLES + 16, 2 * TAKEN)))
    first = WIDE_SAMPLES + 16 - whole[:, None] + np.arange(WIDE_SAMPLES)
    made = np.zeros_like(waves)
    for k in range(1 - TAKEN, TAKEN + 1):
        weight = np.sinc(k - early) * np.cos(0.5 * np.pi * (k - early) / TAKEN) ** 2
        made += weight * np.take_along_axis(wide, first + k, axis=1)
    return made


def first_tops(size: Floats, sigma: Floats, numb: float = 0.0) -> Integers:
    """Return at which samples first pulses have their tops [n].

    The first local top, not long before the largest size, that is clear of noise, `sigma` [n] of a
    part, and a part of the largest. What is numb asks for more of both.
    """
    most = size[:, 8:-8].max(axis=1, keepdims=True)
    largest = 8 + size[:, 8:-8].argmax(axis=1)[:, None]
    asked = np.maximum(CLEAR * sigma[:, None], OF_LARGEST * most) * (1 + 3.2 * numb)
    tops = np.zeros(size.shape, bool)
    tops[:, 8:-8] = (size[:, 8:-8] >= size[:, 7:-9]) & (size[:, 8:-8] > size[:, 9:-7])
    tops &= size >= np.minimum(asked, 0.78 * most)
    tops &= (largest - LOOKED_BACK <= PLACES) & (largest >= PLACES)
    return np.asarray(np.where(tops.any(axis=1), tops.argmax(axis=1), largest[:, 0]), np.int64)


def edges(waves: Complexes, sigma: Floats, numb: float = 0.0) -> Floats:
    """Return where first pulses rise, in samples [n]: the mean place of all steps up to a top.

    From where it began to rise without a fall between, but from no more than six samples before.
    What is numb takes no notice of the first steps of weak pulses.
    """
    size = np.abs(waves)
    top = first_tops(size, sigma, numb)
    back = top[:, None] - np.arange(6)
    rows = np.arange(len(size))[:, None]
    high, low = size[rows, back], size[rows, back - 1]
    rising = np.cumprod(high > low, axis=1)
    height = size[rows, top[:, None]]
    unseen = np.clip(2.5 * CLEAR * numb * sigma[:, None] - 0.1 * height, 0.0, 0.7 * height)
    weight = rising * (np.maximum(high, unseen) - np.maximum(low, unseen)) ** 2 + 1e-12
    return np.asarray((weight * (back - 0.5)).sum(axis=1) / weight.sum(axis=1))


def _energies(waves: Complexes, edge: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Return the energy of all from edges on, and of what comes next to them alone [n]."""
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    since = PLACES - edge[:, None]
    every = np.clip(since + 3.0, 0.0, 1.0) * np.clip(112.0 - since, 0.0, 1.0)
    first = np.clip(since + 1.5, 0.0, 1.0) * np.clip(4.5 - since, 0.0, 1.0)
    return (power * every).sum(axis=1), (power * first).sum(axis=1)


def _alone() -> tuple[float, float, float]:
    """Return, for lone pulses: from edges to tops in samples, energy of all and of what is next."""
    tops = WIDE_LEAD + np.arange(160) / 160
    waves, none = pulses(tops).astype(np.complex128), np.zeros(160)
    edge = edges(waves, none)
    whole, first = _energies(waves, edge, none)
    return float(np.mean(tops - edge)), float(whole.mean()), float(first.mean())


RISE, OF_ALL, OF_FIRST = _alone()


def decibels(waves: Complexes, edge: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Return, in dB of a lone pulse of height 1, all that comes and what first paths bring [n]."""
    whole, first = _energies(waves, edge, sigma)
    first = np.maximum(first / OF_FIRST, 0.7 * sigma**2)
    whole = np.maximum(whole / OF_ALL, 1.03 * first)
    return 10 * np.log10(whole), 10 * np.log10(first)


class Recorder:
    """Waveforms of a table's rows, and what becomes of them in one thing after another.

    `sigma` [n]: of a part of noise by now; `grown`, `summed` [n]: factors of what is told of noise
    and of counts; `besides_m` [n]: added to ranges alone; `numb`: see `first_tops`.
    """

    def __init__(self, table: pd.DataFrame, stable: int, rng: np.random.Generator) -> None:
        self.table, self.stable, self.rng, self.size = table, stable, rng, len(table)
        both = np.array([[*table["cir_i"]], [*table["cir_q"]]], np.float64)
        self.came_in: Complexes = both[0] + 1j * both[1]
        self.wave = self.came_in
        self.sigma_then: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.sigma_then
        self.grown, self.summed, self.besides_m = (np.full(self.size, k) for k in (1.0, 1.0, 0.0))
        self.numb = 0.0
        self.edge = edges(self.came_in, self.sigma_then)
        self.since: Floats = PLACES - self.edge[:, None]

    def rows(self) -> Shunt:
        """Return the rows as they are told now."""
        return Shunt(self.told(), self.stable, self.rng)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.stable, 1705, what])

    def begun(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past edges, 1 some later, without a kink [n, k]."""
        part = np.clip((self.since - samples) / within, 0.0, 1.0)
        return part**3 * (10 - 15 * part + 6 * part**2)

    def arriving(self) -> Complexes:
        """Return what comes by air [n, k], as far as it stands out of the recorder's own noise."""
        over = np.abs(self.wave) / self.sigma[:, None]
        return np.asarray(
            self.wave * self.begun(-5.0) / (1 + np.exp(np.clip(21 - 5 * over, -60, 60)))
        )

    def first(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.begun(-5.0) * (1 - self.begun(5.2, 2.5))

    def height(self) -> Floats:
        """Return how high first pulses are [n]."""
        near = np.where(np.abs(self.since - RISE) < 2.1, np.abs(self.wave), 0.0)
        return np.asarray(near.max(axis=1))

    def any_phase(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.size)))

    def again(self, what: Complexes, part: Floats | Complexes, samples: Floats | float) -> None:
        """Let a part [n] of something [n, k] come so many samples later [n]."""
        late = np.broadcast_to(samples, self.size)
        self.wave = self.wave + np.broadcast_to(part, self.size)[:, None] * held_back(what, late)

    def hear(self, sigma: Floats) -> None:
        """Add noise with parts of such a scatter, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * crackle(self.rng, self.size)

    def lose(self, db: Floats) -> None:
        """Let dB <= 0 or more be what becomes of that which comes [n, k]; noise stays as it was."""
        left = 10 ** (db / 20)
        self.wave = self.wave * left
        self.hear(self.sigma[:, None] * np.sqrt(np.clip(1 - left**2, 0.0, 1.0)))

    def louder(self, db: Floats) -> None:
        """Raise noise by dB >= 0 [n]."""
        times = 10 ** (np.maximum(db, 0.0) / 20)
        self.hear((self.sigma * np.sqrt(times**2 - 1))[:, None])
        self.sigma, self.grown = self.sigma * times, self.grown * times

    def sum_up_less(self, db: Floats) -> None:
        """Sum fewer symbols, by dB <= 0 [n]: signals fall with them, noise with their root."""
        left = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * left[:, None]
        self.hear((self.sigma * np.sqrt(left * (1 - left)))[:, None])
        self.sigma, self.grown = (one * np.sqrt(left) for one in (self.sigma, self.grown))
        self.summed = self.summed * left

    def pay(self, toll: Toll) -> None:
        """Let waveforms have what becomes of their rows."""
        whole, first, hiss, sums = (
            np.broadcast_to(db, self.size)
            for db in (toll.whole_db, toll.first_db, toll.hiss_db, toll.sums_db)
        )
        self.besides_m = self.besides_m + toll.metres
        if whole.any() or first.any():
            self.lose(self.begun(-5.0) * whole[:, None] + self.first() * first[:, None])
        if hiss.any():
            self.louder(hiss)
        if sums.any():
            self.sum_up_less(sums)

    def told(self) -> pd.DataFrame:
        """Return the table as the recorder tells it now."""
        moved = edges(self.wave, self.sigma, self.numb) - self.edge
        then = self.table["first_path_index"].to_numpy(np.float64)
        index = np.clip(then + moved, 6.0, WIDE_SAMPLES - 8.0)
        now_db = decibels(self.wave, index, self.sigma)
        then_db = decibels(self.came_in, then, self.sigma_then)
        error = self.table["error_m"] + METRES * moved + self.besides_m
        known = {
            name: self.table[name] + now - then - 20 * np.log10(self.summed)
            for name, now, then in zip(LEVELS, now_db, then_db, strict=True)
        }
        return self.table.assign(
            **known,
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            first_path_index=index,
            noise_std=self.table["noise_std"] * self.grown,
            preamble_count=self.table["preamble_count"] * self.summed,
            cir_i=[*self.wave.real],
            cir_q=[*self.wave.imag],
        )


LEVELS = ("rx_power_dbm", "first_path_power_dbm")
