"""The baths' receiver: what happens to waveforms, and what a tag's probe tells of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses are cubes of a
sinc's main lobe; first paths are told some way AHEAD of the centre of what comes first of all that
a filter lets through that fits such pulses (Turin 1960).
"""

from __future__ import annotations

from math import comb

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.baths_hall import Heat, Splash

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 44, 248
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = 0.6551364  # how sizes of noise scatter, next to a part of it
LOBE = 3.3  # samples from a pulse's top to either end
AHEAD = 1.2  # samples before centres that first paths are told, as chips do
FINE, ABOUT = 8, 7  # places a sample; places on either side of a top that its centre is of
SOON = 13  # places: what is higher so soon after is of the same pulse
STANDS, OF_TOP = 6.5, 0.13  # what counts: times what noise lets through; of the highest
SINCE, EDGE = 85, 9  # samples before the highest in which tops are looked for; left out at ends
ALIKE: Floats = np.array([1.0, 0.32, -0.17, -0.2])  # noise beside itself, samples off [DW1000]
PLACES: Floats = np.arange(float(WIDE_SAMPLES))
NODES, DEGREE = 10, 7  # samples that what is between them is of; see `held_under`


def ripple(off: Floats) -> Floats:
    """Return pulses of height 1 at samples off their tops: cubes of a sinc's main lobe."""
    return np.asarray(np.where(np.abs(off) < LOBE, np.sinc(off / LOBE), 0.0) ** 3)


def ripples(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return ripple(PLACES - top[:, None])


def _taps() -> Floats:
    """Return what white noise is summed by to be ALIKE: its spectrum's causal root (Kolmogorov)."""
    count = 4096
    pitch = 2 * np.pi * np.arange(count) / count
    power = 1 + 2 * sum(by * np.cos(k * pitch) for k, by in enumerate(ALIKE[1:], 1))
    quefrency = np.fft.ifft(np.log(power)).real
    causal = np.zeros(count)
    causal[0], causal[1 : count // 2] = quefrency[0] / 2, quefrency[1 : count // 2]
    return np.asarray(np.fft.ifft(np.exp(np.fft.fft(causal))).real[:4])


TAPS = _taps()


def gurgle(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, WIDE_SAMPLES]."""
    white = rng.normal(size=(2, rows, WIDE_SAMPLES + 3))
    parts = sum(tap * white[:, :, 3 - k : WIDE_SAMPLES + 3 - k] for k, tap in enumerate(TAPS))
    return np.asarray(parts[0] + 1j * parts[1])


def _barycentric() -> Floats:
    """Return weights of rational functions without poles (Floater, Hormann 2007) [NODES]."""
    last = NODES - 1
    sums = [
        sum(comb(DEGREE, k - i) for i in range(max(0, k - DEGREE), min(k, last - DEGREE) + 1))
        for k in range(NODES)
    ]
    return np.asarray(np.array(sums, np.float64) * (-1.0) ** np.arange(NODES))


WEIGHTS = _barycentric()


def held_under(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n], by rational functions between samples."""
    late = samples.clip(0.0, WIDE_SAMPLES + float(NODES))
    whole = np.floor(late)
    at = NODES // 2 - (late - whole)  # of nodes from 0 on, where what is to be shown is
    off = at[:, None] - np.arange(NODES)
    by = WEIGHTS / np.where(np.abs(off) < 1e-9, 1e-9, off)
    by /= by.sum(axis=1, keepdims=True)
    padded = np.pad(waves, ((0, 0), (2 * NODES + WIDE_SAMPLES, NODES)))
    begin = 2 * NODES + WIDE_SAMPLES - NODES // 2 - whole.astype(np.int64)
    out = np.zeros(waves.shape, np.complex128)
    for node in range(NODES):
        from_ = begin[:, None] + node + np.arange(WIDE_SAMPLES)
        out += by[:, [node]] * np.take_along_axis(padded, from_, axis=1)
    return out


def let_through(waves: Complexes) -> Floats:
    """Return sizes of what fits pulses at FINE places a sample [n, FINE WIDE_SAMPLES].

    Their spectra are those of waveforms times a pulse's, and go on with noughts.
    """
    count, half = WIDE_SAMPLES, WIDE_SAMPLES // 2
    off = np.asarray(np.fft.fftfreq(count, 1 / count), np.float64)
    shape = np.fft.fft(ripple(off)).real / (ripple(off) ** 2).sum()
    spectrum = np.fft.fft(waves, axis=1) * shape
    wide = np.zeros((len(waves), FINE * count), np.complex128)
    wide[:, :half], wide[:, -half:] = spectrum[:, :half], spectrum[:, half:]
    return np.asarray(FINE * np.abs(np.fft.ifft(wide, axis=1)))


OF_NOISE = float(let_through(gurgle(np.random.default_rng(2804), 60))[:, 80:-80].std() / OF_SIZES)
"""How parts of what noise lets through scatter whose own parts scatter by 1."""


def centre(values: Floats, top: Integers) -> Floats:
    """Return centres of fourth powers of values [n, k] about tops [n], twice, in places [n]."""
    off = np.arange(-ABOUT, ABOUT + 1)
    inner = top.clip(ABOUT + 2, values.shape[1] - ABOUT - 3)
    near = np.take_along_axis(values, inner[:, None] + off, axis=1) ** 4
    edge = np.minimum(near[:, [0]], near[:, [-1]])  # else it leans to where what is next is high
    above = (near - edge).clip(0.0)
    return np.asarray(inner + (above @ off) / np.maximum(above.sum(axis=1), 1e-300))


def _never_higher_soon(values: Floats) -> NDArray[np.bool_]:
    """Return where nothing in the next SOON places is higher [n, k]."""
    padded = np.pad(values, ((0, 0), (0, SOON)))
    windows = np.lib.stride_tricks.sliding_window_view(padded, SOON + 1, axis=1)
    return np.asarray(values >= windows.max(axis=2))


def _first_tops(values: Floats, sigma: Floats, deaf: float) -> Integers:
    """Return the first places that count of what is let through [n, k]: out of noise, and high."""
    place, edge = np.arange(values.shape[1]), EDGE * FINE
    inner = np.where((place >= edge) & (place < len(place) - edge), values, 0.0)
    most, highest = inner.max(axis=1), inner.argmax(axis=1)
    asked = np.maximum(STANDS * OF_NOISE * sigma, OF_TOP * most) * (1 + 6.5 * deaf)
    tops = (inner > np.roll(inner, 1, axis=1)) & _never_higher_soon(inner)
    tops &= inner >= np.minimum(asked, 0.85 * most)[:, None]
    tops &= place >= (highest - SINCE * FINE)[:, None]
    tops[np.arange(len(tops)), highest] = True
    return np.asarray(tops.argmax(axis=1), np.int64)


def first_paths(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return places AHEAD of first centres, in samples [n]; never sooner if deaf."""
    values = let_through(waves)
    at = centre(values, _first_tops(values, sigma, 0.0))
    if deaf > 0:
        at = np.maximum(at, centre(values, _first_tops(values, sigma, deaf)))
    return at / FINE - AHEAD


ALL = (-4.0, 106.0)  # samples after first paths between which all energy is
FIRST = 1.9  # samples on either side of centres in which the first path's energy is weighed


def _read(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return the energy of all and of the first path, less noise's [2, n]."""
    energy = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    off = PLACES - at[:, None]
    inside = (off - ALL[0]).clip(0.0, 1.0) * (ALL[1] - off).clip(0.0, 1.0)
    arch = np.cos(0.5 * np.pi * ((off - AHEAD) / FIRST).clip(-1.0, 1.0)) ** 2
    return np.stack([(inside * energy).sum(axis=1),
                     (arch * energy).sum(axis=1) / arch.sum(axis=1)])  # fmt: skip


def _of_lone() -> Floats:
    """Return all energy, and that of the first path, of lone pulses of height 1 [2, 1]."""
    tops = 95.0 + np.arange(0.0, 1.0, 0.05)
    read = _read(ripples(tops).astype(np.complex128), tops - AHEAD, np.zeros(len(tops)))
    return np.asarray(read.mean(axis=1, keepdims=True))


OF_LONE = _of_lone()


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    every, first = _read(waves, at, sigma) / OF_LONE
    first = np.maximum(first, 0.4 * sigma**2)
    return np.asarray(10 * np.log10(np.stack([np.maximum(every, 1.02 * first), first])))


class Probe:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `told_noise`, `told_count` [n]: factors of what is told;
    `late_m` [n]: what ranges alone get; `deaf`: see `_first_tops`.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        self.dry: Complexes = np.stack([*table["cir_i"]]) + 1j * np.stack([*table["cir_q"]])
        self.wave: Complexes = self.dry
        self.calm: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma: Floats = self.calm
        self.told_noise, self.told_count = np.ones((2, self.rows))
        self.late_m: Floats = np.zeros(self.rows)
        self.deaf = 0.0
        self.at = first_paths(self.dry, self.calm)
        self.since: Floats = PLACES - self.at[:, None]

    def heat(self) -> Heat:
        """Return the rows as they are told by now."""
        return Heat(self.told(), self.case, self.rng)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 2805, what])

    def after(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later, by a quintic [n, k]."""
        part = ((self.since - samples) / within).clip(0.0, 1.0)
        return np.asarray(part**3 * (10 - 15 * part + 6 * part**2))

    def heard(self) -> Complexes:
        """Return what came by air [n, k]: what is no larger than noise is left out, softly."""
        over = (np.abs(self.wave) / (4.0 * self.sigma[:, None])) ** 2
        return np.asarray(self.wave * self.after(-5.0) * -np.expm1(-(over**2)))

    def front(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.after(-5.0) - self.after(4.4, 2.8)

    def crest(self) -> Floats:
        """Return how high first pulses are [n]."""
        near = np.abs(self.since - AHEAD) < 1.6
        return np.asarray((near * np.abs(self.wave)).max(axis=1))

    def turns(self, *shape: int) -> Complexes:
        """Return phases by chance, [n] or [n, *shape]."""
        return np.asarray(np.exp(1j * self.rng.uniform(-np.pi, np.pi, (self.rows, *shape))))

    def lap(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come again, so many samples later [n]."""
        self.wave = self.wave + part[:, None] * held_under(what, samples)

    def hiss(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * gurgle(self.rng, self.rows)

    def sink(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the probe's own noise stays."""
        left = 10 ** (db.clip(max=0.0) / 20)
        self.wave = left * self.wave
        self.hiss(np.sqrt(1 - left**2) * self.sigma[:, None])

    def churn(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (db.clip(0.0) / 20)
        self.hiss((np.sqrt(by**2 - 1) * self.sigma)[:, None])
        self.sigma, self.told_noise = by * self.sigma, by * self.told_noise

    def count_fewer(self, db: Floats) -> None:
        """Count fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        part = 10 ** (db.clip(max=0.0) / 20)
        self.wave = part[:, None] * self.wave
        self.hiss((np.sqrt(part * (1 - part)) * self.sigma)[:, None])
        self.sigma, self.told_noise = np.sqrt(part) * np.stack([self.sigma, self.told_noise])
        self.told_count = part * self.told_count

    def suffer(self, splash: Splash) -> None:
        """Let waveforms bear what rows do."""
        late, every, first, noise, count = (
            np.broadcast_to(np.asarray(one, np.float64), (self.rows,))
            for one in (splash.late_m, splash.all_db, splash.first_db, splash.noise_db,
                        splash.count_db)
        )  # fmt: skip
        self.late_m = self.late_m + late
        if every.any() or first.any():
            self.sink(self.after(-5.0) * every[:, None] + self.front() * first[:, None])
        if noise.any():
            self.churn(noise)
        if count.any():
            self.count_fewer(count)

    def told(self) -> pd.DataFrame:
        """Return the table as the probe tells it by now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        later = first_paths(self.wave, self.sigma, self.deaf) - self.at
        now = np.clip(was + later, 6.0, WIDE_SAMPLES - 8.0)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * later + self.late_m
        more = levels_db(self.wave, now, self.sigma) - levels_db(self.dry, was, self.calm)
        every, first = more - 20 * np.log10(self.told_count)
        return self.table.assign(
            first_path_index=now,
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + every,
            first_path_power_dbm=self.table["first_path_power_dbm"] + first,
            noise_std=self.table["noise_std"] * self.told_noise,
            preamble_count=self.table["preamble_count"] * self.told_count,
            cir_i=[*self.wave.real],
            cir_q=[*self.wave.imag],
        )
