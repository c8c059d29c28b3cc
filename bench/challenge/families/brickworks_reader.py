"""The brickworks' receiver: what waveforms pass, and what a reader at a buckstay makes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. First paths are found by
a constant fraction, as in nuclear electronics (Gedcke and McDonald 1968): where what came two
samples ago is half of what comes now.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.brickworks_yard import Push, Upshot

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 38, 226
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = 0.655136  # how sizes of noise scatter, next to a part of it
CLEAR, OF_LARGEST = 6.4, 0.1  # times a part's scatter; of the largest size
LOOKED_BACK = 92  # samples before the largest in which first paths are looked for
KNOT = 1.72  # samples: a quarter of a pulse
DELAYED, FRACTION = 2, 0.5  # samples; of what comes now
TAPS = (0.89500033, 0.37376822, -0.09662165, -0.2234636)
"""Of noise, whose neighbours are alike by .32, -.17 and -.2 then [measured: DW1000]."""
PLACES: Floats = np.arange(WIDE_SAMPLES, dtype=np.float64)


def spline(off: Floats) -> Floats:
    """Return pulses of height 1 at samples off their tops: four boxes, one after another."""
    x = np.minimum(np.abs(off) / KNOT, 2.0)
    return np.asarray(np.where(x < 1, 1 - 1.5 * x**2 + 0.75 * x**3, 0.25 * (2 - x) ** 3))


def pulses(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return spline(PLACES - top[:, None])


def rustle(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, through a filter of four taps [rows, WIDE_SAMPLES]."""
    long = WIDE_SAMPLES + len(TAPS) - 1
    white = rng.standard_normal((rows, long, 2)).view(np.complex128)[:, :, 0]
    parts = (tap * white[:, k : k + WIDE_SAMPLES] for k, tap in enumerate(TAPS))
    return np.asarray(sum(parts), np.complex128)


def delayed(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n], by Lagrange's polynomials through six samples."""
    late = np.clip(samples, 0.0, WIDE_SAMPLES + 8.0)
    whole = np.floor(late).astype(np.int64)
    part, nodes = late - whole, np.arange(-2, 4)
    wide = np.pad(waves, ((0, 0), (0, 4)))  # what is asked for outside is nothing
    made = np.zeros_like(waves)
    for node in nodes:
        others = nodes[nodes != node]
        weight = np.prod((part[:, None] - others) / (node - others), axis=1)
        source = np.arange(WIDE_SAMPLES) - whole[:, None] - node
        source = np.where((source < 0) | (source >= WIDE_SAMPLES), WIDE_SAMPLES, source)
        made = made + weight[:, None] * np.take_along_axis(wide, source, axis=1)
    return made


def edges(waves: Complexes, sigma: Floats, dull: float = 0.0) -> Floats:
    """Return where first pulses begin, in samples [n]: at some fraction of their tops.

    `sigma` [n]: of a part of noise. Looked for from the first sample on, not long before the
    largest, that is clear of noise and a part of the largest; what came two samples ago has to be
    about as much, too. What is dull asks for more of both.
    """
    size = np.abs(waves)
    rows, largest = np.arange(len(size)), size[:, :-5].argmax(axis=1)
    most = size[rows, largest]
    asked = np.maximum(CLEAR * sigma, OF_LARGEST * most)
    loud = size >= np.minimum(asked * (1 + 5.5 * dull), 0.8 * most)[:, None]
    loud &= (largest[:, None] - LOOKED_BACK <= PLACES) & (PLACES >= DELAYED + 6)
    begun = np.where(loud.any(axis=1), loud.argmax(axis=1), largest)
    least = np.minimum(asked * (1 + 1.6 * dull), 0.8 * most)[:, None]
    over = np.full_like(size, -1.0)
    over[:, DELAYED:] = size[:, :-DELAYED] - np.maximum(FRACTION * size[:, DELAYED:], least)
    fits = (over >= 0) & (begun[:, None] <= PLACES)
    at = np.where(fits.any(axis=1), fits.argmax(axis=1), largest).clip(DELAYED + 6)
    here, before = over[rows, at], over[rows, at - 1]
    past = np.where(before < 0, here / np.maximum(here - before, 1e-9), 1.0).clip(0.0, 1.0)
    return np.asarray((at - past - DELAYED).clip(5.0, WIDE_SAMPLES - 8.0), np.float64)


def _energies(waves: Complexes, edge: Floats, sigma: Floats | float) -> tuple[Floats, Floats]:
    """Return the energy of all that comes from edges on, and of four samples there [n]."""
    power = np.abs(waves) ** 2 - 2 * np.square(np.zeros((len(waves), 1)) + np.c_[sigma])
    since = PLACES - np.floor(edge)[:, None]
    whole = np.where((since > -3) & (since < 108), power, 0.0).sum(axis=1)
    return whole, np.where((since >= 0) & (since < 4), power, 0.0).sum(axis=1)


def _alone() -> tuple[float, float, float]:
    """Return, for lone pulses: from edges to tops in samples, energy of all and of four."""
    tops = WIDE_LEAD + np.linspace(0.0, 1.0, 250, endpoint=False)
    waves = pulses(tops).astype(np.complex128)
    edge = edges(waves, np.full(250, 1e-6))
    whole, four = _energies(waves, edge, 0.0)
    return float((tops - edge).mean()), float(whole.mean()), float(four.mean())


RISE, OF_ALL, OF_FOUR = _alone()


def decibels(waves: Complexes, edge: Floats, sigma: Floats) -> Floats:
    """Return, in dB of a lone pulse of height 1, all that comes and what first paths bring [2, n].

    As chips have it (DW1000 User Manual, 4.7), but of four samples in place of three.
    """
    whole, four = _energies(waves, edge, sigma)
    first = np.maximum(four / OF_FOUR, 0.6 * sigma**2)
    return np.asarray(10 * np.log10([np.maximum(whole / OF_ALL, 1.05 * first), first]))


class Reader:
    """Waveforms of a table's rows, and what becomes of them in one thing after another.

    `sigma` [n]: of a part of noise by now; `noisier`, `summed` [n]: factors of what is told;
    `beside_m` [n]: added to ranges alone; `dull`: see `edges`.
    """

    def __init__(self, table: pd.DataFrame, stable: int, rng: np.random.Generator) -> None:
        self.table, self.stable, self.rng, self.rows = table, stable, rng, len(table)
        parts = [np.stack([np.asarray(one, np.float64) for one in table[n]]) for n in _PARTS]
        self.was: Complexes = parts[0] + 1j * parts[1]
        self.wave = self.was.copy()
        self.sigma_was = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.sigma_was.copy()
        self.noisier, self.summed = np.ones(self.rows), np.ones(self.rows)
        self.beside_m: Floats = np.zeros(self.rows)
        self.dull = 0.0
        self.edge = edges(self.was, self.sigma_was)
        self.since: Floats = PLACES - self.edge[:, None]

    def push(self) -> Push:
        """Return the rows as they are told now."""
        return Push(self.told(), self.stable, self.rng)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.stable, 1605, what])

    def from_on(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past edges, 1 some later, half a sine between [n, k]."""
        part = np.clip((self.since - samples) / within, 0.0, 1.0)
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * part))

    def came(self) -> Complexes:
        """Return what came by air [n, k]: as much of it as is above noise, the reader's own."""
        ratio = 3.6 * self.sigma[:, None] / np.maximum(np.abs(self.wave), 1e-9)
        return np.asarray(self.wave * self.from_on(-4.0) * np.clip(1 - ratio**2, 0.0, 1.0))

    def leading(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return np.asarray(self.from_on(-4.0) * (1 - self.from_on(4.8, 2.5)))

    def tops(self) -> Floats:
        """Return how high first pulses are [n]."""
        near = np.where(np.abs(self.since - RISE) < 2.2, np.abs(self.wave), 0.0)
        return np.asarray(near.max(axis=1))

    def turned(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def repeat(self, what: Complexes, size: Floats | Complexes, samples: Floats | float) -> None:
        """Let a part [n] of something [n, k] come so many samples later [n]."""
        late = np.zeros(self.rows) + samples
        self.wave = self.wave + (np.zeros(self.rows) + size)[:, None] * delayed(what, late)

    def hisses(self, sigma: Floats) -> None:
        """Add noise with parts of such a scatter, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * rustle(self.rng, self.rows)

    def fade(self, left: Floats) -> None:
        """Leave a part of what comes by air [n, k]; noise stays as large as it was."""
        self.wave = self.wave * left
        self.hisses(self.sigma[:, None] * np.sqrt(np.maximum(1 - left**2, 0.0)))

    def hiss_more(self, db: Floats) -> None:
        """Raise noise by dB >= 0 [n]."""
        power = 10 ** (np.maximum(db, 0.0) / 10)
        self.hisses((self.sigma * np.sqrt(power - 1))[:, None])
        self.sigma, self.noisier = self.sigma * np.sqrt(power), self.noisier * np.sqrt(power)

    def sum_less(self, db: Floats) -> None:
        """Sum fewer symbols, by dB <= 0 [n]: signals fall with them, noise with their root."""
        kept = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * kept[:, None]
        self.hisses((self.sigma * np.sqrt(kept * (1 - kept)))[:, None])
        self.sigma, self.noisier = self.sigma * np.sqrt(kept), self.noisier * np.sqrt(kept)
        self.summed = self.summed * kept

    def take(self, upshot: Upshot) -> None:
        """Let waveforms have what becomes of their rows."""
        none = np.zeros(self.rows)
        self.beside_m = self.beside_m + upshot.metres
        whole, first = none + upshot.whole_db, none + upshot.first_db
        if whole.any() or first.any():
            db = self.from_on(-4.0) * whole[:, None] + self.leading() * first[:, None]
            self.fade(10 ** (db / 20))
        if upshot.hiss_db.any():
            self.hiss_more(none + upshot.hiss_db)
        if upshot.sums_db.any():
            self.sum_less(none + upshot.sums_db)

    def told(self) -> pd.DataFrame:
        """Return the table as the reader tells it now."""
        moved = edges(self.wave, self.sigma, self.dull) - self.edge
        was = self.table["first_path_index"].to_numpy(np.float64)
        index = np.clip(was + moved, 6.0, WIDE_SAMPLES - 8.0)
        after, before = (
            decibels(*one)
            for one in ((self.wave, index, self.sigma), (self.was, was, self.sigma_was))
        )
        whole_db, first_db = after - before - 20 * np.log10(self.summed)
        error = self.table["error_m"] + METRES * moved + self.beside_m
        return self.table.assign(
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            first_path_index=index,
            rx_power_dbm=self.table["rx_power_dbm"] + whole_db,
            first_path_power_dbm=self.table["first_path_power_dbm"] + first_db,
            noise_std=self.table["noise_std"] * self.noisier,
            preamble_count=self.table["preamble_count"] * self.summed,
            cir_i=[*self.wave.real],
            cir_q=[*self.wave.imag],
        )


_PARTS = ("cir_i", "cir_q")
