"""The printworks' receiver: what waveforms pass, and what a console at a stanchion makes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. First paths are timed by
two discriminators: a line through where a rise comes to 30 % and to 66 % of its top is followed
back, and a constant put on to that.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.printworks_hall import Change, Sheet

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 38, 236
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = 0.655136  # how sizes of noise scatter, next to a part of it (Rayleigh)
CLEAR, OF_LARGEST = 7.2, 0.115  # times a part's scatter; of the largest size
LOOKED_BACK = 88  # samples before the largest in which first paths are looked for
KNOT = 1.72  # samples from one knot of a pulse's spline to the next
FINE = 6  # places a sample in which rises are followed
LOW, HIGH, BACK, PUT_ON = 0.3, 0.66, 0.5, 0.74  # discriminators; how far back; samples
FROM_LOW = 0.41  # samples from where lone pulses cross LOW to where they rise
LIKE = (0.32, -0.17, -0.2)  # noise after one, two and three samples [DW1000]
PLACES: Floats = np.arange(float(WIDE_SAMPLES))


def spline(off: Floats) -> Floats:
    """Return pulses of height 1 at samples off their tops: a cubic B-spline."""
    x = np.abs(off) / KNOT
    inner, outer = 1 - 1.5 * x**2 + 0.75 * x**3, 0.25 * (2 - x).clip(0.0) ** 3
    return np.asarray(np.where(x < 1, inner, outer))


def pulses(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return spline(PLACES - top[:, None])


def rush(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, of a spectrum that LIKE gives [rows, WIDE_SAMPLES]."""
    whole = 2 * WIDE_SAMPLES
    turn = 2 * np.pi * np.arange(whole) / whole
    power = 1 + 2 * sum(by * np.cos(lag * turn) for lag, by in enumerate(LIKE, 1))
    loose = rng.normal(size=(rows, whole, 2)) @ np.array([1.0, 1.0j])
    return np.fft.ifft(loose * np.sqrt(whole * power), axis=1)[:, :WIDE_SAMPLES]


def postponed(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by their spectra's phases."""
    late = np.clip(samples, 0.0, WIDE_SAMPLES)[:, None]
    whole = 2 * WIDE_SAMPLES + 80
    turned = np.exp(-2j * np.pi * np.fft.fftfreq(whole) * late)
    moved = np.fft.ifft(np.fft.fft(waves, whole, axis=1) * turned, axis=1)[:, :WIDE_SAMPLES]
    return np.asarray(np.where(late < WIDE_SAMPLES, moved, 0.0))


def finer(waves: Complexes) -> Floats:
    """Return sizes at FINE places a sample [n, FINE WIDE_SAMPLES]: spectra are padded."""
    half = WIDE_SAMPLES // 2
    spectrum = np.fft.fft(waves, axis=1)
    wide = np.zeros((len(waves), FINE * WIDE_SAMPLES), np.complex128)
    wide[:, :half], wide[:, -half:] = spectrum[:, :half], spectrum[:, half:]
    return np.asarray(FINE * np.abs(np.fft.ifft(wide, axis=1)))


def crossed(size: Floats, top: Integers, level: Floats) -> Floats:
    """Return where sizes [n, k] last come to a level before first tops [n], in places [n]."""
    rows = np.arange(len(size))
    below = (size < level[:, None]) & (np.arange(size.shape[1]) <= top[:, None])
    last = np.where(below.any(axis=1), size.shape[1] - 1 - below[:, ::-1].argmax(axis=1), 0)
    low, high = size[rows, last], size[rows, np.minimum(last + 1, size.shape[1] - 1)]
    return np.asarray(last + ((level - low) / np.maximum(high - low, 1e-12)).clip(0.0, 1.0))


def risen(size: Floats, top: Integers, step: float) -> Floats:
    """Return where rises begin, in samples from the first size [n]; sizes [n, k] are `step` apart.

    From both discriminators, which are followed back from first tops [n].
    """
    height = size[np.arange(len(size)), top]
    low, high = (step * crossed(size, top, part * height) for part in (LOW, HIGH))
    return np.asarray(low - BACK * (high - low).clip(0.2, 1.25) + PUT_ON)


def first_tops(size: Floats, sigma: Floats, numb: float) -> Integers:
    """Return at which fine places first pulses have their tops [n].

    The first top after sizes are first clear of noise, `sigma` [n] of a part, and of a part of the
    largest one, not long before which it is. What is numb asks for more of both.
    """
    place, edge = np.arange(size.shape[1]), 8 * FINE
    largest = edge + size[:, edge:-edge].argmax(axis=1)[:, None]
    most = size[np.arange(len(size)), largest[:, 0]][:, None]
    asked = np.maximum(CLEAR * sigma[:, None], OF_LARGEST * most) * (1 + 4.0 * numb)
    near = (place >= np.maximum(largest - LOOKED_BACK * FINE, edge)) & (place <= largest)
    clear = near & (size >= np.minimum(asked, 0.8 * most))
    falls = np.append(np.diff(size, axis=1) < 0, np.ones((len(size), 1), bool), axis=1)
    return np.asarray((falls & (place >= clear.argmax(axis=1)[:, None])).argmax(axis=1), np.int64)


def edges(waves: Complexes, sigma: Floats, numb: float = 0.0) -> Floats:
    """Return where first pulses rise, in samples [n].

    What is numb has them where they come to a level that noise asks for, and never sooner than
    what is not.
    """
    size = finer(waves)
    at = risen(size, first_tops(size, sigma, 0.0), 1 / FINE)
    if not numb:
        return at
    top = first_tops(size, sigma, numb)
    level = np.minimum(4.0 * CLEAR * numb * sigma, 0.7 * size[np.arange(len(size)), top])
    late = crossed(size, top, level) / FINE + FROM_LOW
    return np.maximum(np.maximum(at, late), risen(size, top, 1 / FINE))


def _energies(waves: Complexes, edge: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Return the energy of all from edges on, and of three samples next to them [n]."""
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    since = PLACES - edge[:, None]
    every = np.clip(since + 3.0, 0.0, 1.0) * np.clip(108.0 - since, 0.0, 1.0)
    three = sum(np.clip(1 - np.abs(since - 0.2 - k), 0.0, 1.0) for k in range(3))
    return (power * every).sum(axis=1), (power * three).sum(axis=1)


def _alone() -> tuple[float, float, float]:
    """Return, for lone pulses: from edges to tops in samples, energies of all and of three."""
    tops = 60 + np.linspace(0.0, 1.0, 97)
    waves, none = pulses(tops).astype(np.complex128), np.zeros(97)
    edge = edges(waves, none)
    whole, three = _energies(waves, edge, none)
    return float((tops - edge).mean()), float(whole.mean()), float(three.mean())


RISE, OF_ALL, OF_THREE = _alone()


def decibels(waves: Complexes, edge: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Return, in dB of a lone pulse of height 1, all that comes and what first paths bring [n]."""
    whole, three = _energies(waves, edge, sigma)
    first = np.maximum(three / OF_THREE, 0.6 * sigma**2)
    return 10 * np.log10(np.maximum(whole / OF_ALL, 1.02 * first)), 10 * np.log10(first)


class Console:
    """Waveforms of a table's rows, and what becomes of them in one thing after another.

    `sigma` [n]: of a part of noise by now; `grown`, `kept` [n]: factors of what is told of noise
    and of counts; `besides_m` [n]: added to ranges alone; `numb`: see `first_tops`.
    """

    def __init__(self, table: pd.DataFrame, stable: int, rng: np.random.Generator) -> None:
        self.table, self.stable, self.rng, self.size = table, stable, rng, len(table)
        in_phase, aside = (np.stack([*table[name]]) for name in ("cir_i", "cir_q"))
        self.before: Complexes = in_phase.astype(np.float64) + 1j * aside.astype(np.float64)
        self.wave = self.before.copy()
        self.sigma_before: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.sigma_before
        self.grown, self.kept = np.ones(self.size), np.ones(self.size)
        self.besides_m, self.numb = np.zeros(self.size), 0.0
        self.edge = edges(self.before, self.sigma_before)
        self.since: Floats = PLACES - self.edge[:, None]

    def sheet(self) -> Sheet:
        """Return the rows as they are told now."""
        return Sheet(self.told(), self.stable, self.rng)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.stable, 1805, what])

    def from_on(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past edges, 1 some later, by a sine's arch [n, k]."""
        part = np.clip((self.since - samples) / within, 0.0, 1.0)
        return np.asarray(np.sin(0.5 * np.pi * part) ** 2)

    def by_air(self) -> Complexes:
        """Return what comes by air [n, k], as far as it stands out of the console's own noise."""
        over = (np.abs(self.wave) / self.sigma[:, None]) ** 2
        return np.asarray(self.wave * self.from_on(-5.0) * over**2 / (over**2 + 17.0**2))

    def straight(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.from_on(-5.0) * (1 - self.from_on(5.0, 2.5))

    def height(self) -> Floats:
        """Return how high first pulses are [n]."""
        return np.asarray((np.abs(self.wave) * (np.abs(self.since - RISE) < 2.0)).max(axis=1))

    def phases(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(0.0, 2 * np.pi, self.size)))

    def echo(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come so many samples later [n]."""
        self.wave = self.wave + part[:, None] * postponed(what, samples)

    def add_noise(self, sigma: Floats) -> None:
        """Add noise with parts of such a scatter, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * rush(self.rng, self.size)

    def weaken(self, db: Floats) -> None:
        """Let dB <= 0 or more be what becomes of that which comes [n, k]; noise stays as it was."""
        left = 10 ** (db / 20)
        self.wave = self.wave * left
        self.add_noise(self.sigma[:, None] * np.sqrt(np.maximum(1 - left**2, 0.0)))

    def raise_noise(self, db: Floats) -> None:
        """Raise noise by dB >= 0 [n]."""
        times = 10 ** (np.maximum(db, 0.0) / 20)
        self.add_noise((self.sigma * np.sqrt(times**2 - 1))[:, None])
        self.sigma, self.grown = self.sigma * times, self.grown * times

    def count_less(self, db: Floats) -> None:
        """Count fewer symbols, by dB <= 0 [n]: signals fall with them, noise with their root."""
        left = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * left[:, None]
        self.add_noise((self.sigma * np.sqrt(left - left**2))[:, None])
        self.sigma, self.grown = self.sigma * left**0.5, self.grown * left**0.5
        self.kept = self.kept * left

    def take(self, change: Change) -> None:
        """Let waveforms have what becomes of their rows."""
        self.besides_m = self.besides_m + change.metres
        whole, first = (np.full(self.size, db) for db in (change.all_db, change.first_db))
        if whole.any() or first.any():
            self.weaken(self.from_on(-5.0) * whole[:, None] + self.straight() * first[:, None])
        if np.any(change.noise_db):
            self.raise_noise(np.full(self.size, change.noise_db))
        if np.any(change.count_db):
            self.count_less(np.full(self.size, change.count_db))

    def told(self) -> pd.DataFrame:
        """Return the table as the console tells it now."""
        moved = edges(self.wave, self.sigma, self.numb) - self.edge
        then = self.table["first_path_index"].to_numpy(np.float64)
        index = np.clip(then + moved, 6.0, WIDE_SAMPLES - 8.0)
        levels = decibels(self.wave, index, self.sigma)
        levels_then = decibels(self.before, then, self.sigma_before)
        error = self.table["error_m"] + METRES * moved + self.besides_m
        known = {
            name: self.table[name] + levels[k] - levels_then[k] - 20 * np.log10(self.kept)
            for k, name in enumerate(("rx_power_dbm", "first_path_power_dbm"))
        }
        return self.table.assign(
            **known,
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            first_path_index=index,
            noise_std=self.table["noise_std"] * self.grown,
            preamble_count=self.table["preamble_count"] * self.kept,
            cir_i=[*self.wave.real],
            cir_q=[*self.wave.imag],
        )
