"""The observatory's receiver: what happens to waveforms, and what a sconce's plate shows of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses have the shape of
stars' images (Moffat 1969), and first paths are told some way AHEAD of where, among places at which
a pulse on a plain ground is fitted by least squares, one stands out first (Stetson 1987).
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.observatory_hall import Exposure, Toll

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 46, 250
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
CORE, WINGS = 3.75, 7.0  # samples; power: pulses are 2.4 samples wide at half their height
AHEAD = 1.25  # samples before tops that first paths are told, as chips do
FINE, APERTURE = 8, 14  # places a sample; places on either side that are fitted
SOON = 14  # places: what stands out more so soon after is of the same pulse
STANDS, OF_TOP = 6.5, 0.13  # what counts: times what noise fits; of the highest
SINCE, EDGE = 80, 9  # samples before the highest in which tops are looked for; left out at ends
ALIKE: Floats = np.array([1.0, 0.32, -0.17, -0.2])  # noise beside itself, samples off [DW1000]
PLACES: Floats = np.arange(float(WIDE_SAMPLES))
TAPS = 10  # samples that what is between them is of


def moffat(off: Floats) -> Floats:
    """Return pulses of height 1 at samples off their tops (Moffat 1969)."""
    return np.asarray((1 + (off / CORE) ** 2) ** -WINGS)


def stars(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return moffat(PLACES - top[:, None])


def sky(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, WIDE_SAMPLES].

    White noise's spectrum, times the root of what ALIKE has for one, on a longer circle.
    """
    long = WIDE_SAMPLES + 6
    pitch = 2 * np.pi * np.fft.fftfreq(long)
    power = 1 + 2 * sum(ALIKE[k] * np.cos(k * pitch) for k in (1, 2, 3))
    white = rng.normal(size=(2, rows, long))
    tinted = np.fft.ifft(np.fft.fft(white[0] + 1j * white[1], axis=1) * np.sqrt(power), axis=1)
    return np.asarray(tinted[:, :WIDE_SAMPLES])


def exposed_later(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: between samples by Lagrange's polynomials."""
    late = samples.clip(0.0, float(WIDE_SAMPLES + TAPS))
    whole = np.floor(late).astype(np.int64)
    node = np.arange(TAPS) - (TAPS // 2 - 1)
    padded = np.pad(waves, ((0, 0), (TAPS // 2, TAPS // 2)))
    moved = np.zeros_like(waves)
    column, row = np.arange(WIDE_SAMPLES), np.arange(len(waves))[:, None]
    for one in node:
        rest = node[node != one]
        weight = np.prod((late - whole)[:, None] - rest, axis=1) / np.prod(one - rest)
        from_ = column - whole[:, None] - one + TAPS // 2
        there = (from_ >= 0) & (from_ < padded.shape[1])
        moved += weight[:, None] * np.where(
            there, padded[row, from_.clip(0, padded.shape[1] - 1)], 0
        )
    return moved


def _kernel() -> Floats:
    """Return by what places count in the height of a pulse on a plain ground about them."""
    shape = moffat(np.arange(-APERTURE, APERTURE + 1) / FINE)
    bare = shape - shape.mean()
    return np.asarray(bare / (bare**2).sum())


KERNEL = _kernel()


def heights(sizes: Floats) -> Floats:
    """Return how high pulses are that best fit sizes about each place [n, k], at FINE places."""
    count = sizes.shape[1] + 2 * APERTURE
    fitted = np.fft.irfft(
        np.fft.rfft(sizes, count, axis=1) * np.fft.rfft(KERNEL[::-1], count), count, axis=1
    )
    return np.asarray(fitted[:, APERTURE : APERTURE + sizes.shape[1]])


def finely(waves: Complexes) -> Floats:
    """Return sizes at FINE places a sample [n, FINE k], by spectra that go on with noughts."""
    count = waves.shape[1]
    half = count // 2
    spectrum = np.fft.fft(waves, axis=1)
    wide = np.zeros((len(waves), FINE * count), np.complex128)
    wide[:, :half], wide[:, half - count :] = spectrum[:, :half], spectrum[:, half:]
    return np.asarray(np.abs(np.fft.ifft(wide, axis=1)) * FINE)


def _of_noise() -> float:
    """Return how what is fitted to noise scatters whose parts scatter by 1."""
    return float(heights(finely(sky(np.random.default_rng(2704), 60))).std())


OF_NOISE = _of_noise()


def vertex(values: Floats, top: Integers) -> Floats:
    """Return where parabolas about tops [n] of values [n, k] are highest."""
    left, mid, right = (values[np.arange(len(values)), top + k] for k in (-1, 0, 1))
    bend = np.maximum(2 * mid - left - right, 1e-300)
    return np.asarray(top + ((right - left) / (2 * bend)).clip(-0.5, 0.5))


def outstanding(values: Floats) -> NDArray[np.bool_]:
    """Return where values [n, k] are tops, and nothing in the next SOON places is higher."""
    before, after = (np.roll(values, k, axis=1) for k in (1, -1))
    highest, reach = after, 1
    while reach < SOON:
        highest = np.maximum(highest, np.roll(highest, -min(reach, SOON - reach), axis=1))
        reach *= 2
    return np.asarray((values > before) & (values >= highest))


def _first_tops(values: Floats, sigma: Floats, deaf: float) -> Integers:
    """Return the first places of fits [n, k] that count [n]: out of noise, and of some height."""
    place, edge = np.arange(values.shape[1]), EDGE * FINE
    inner = np.where((place >= edge) & (place < len(place) - edge), values, 0.0)
    highest, most = inner.argmax(axis=1)[:, None], inner.max(axis=1)
    asked = (1 + 6.0 * deaf) * np.maximum(STANDS * OF_NOISE * sigma, OF_TOP * most)
    counts = outstanding(values) & (inner >= np.minimum(asked, 0.85 * most)[:, None])
    counts &= (place >= highest - SINCE * FINE) & (place <= highest)
    first = np.where(counts.any(axis=1), counts.argmax(axis=1), highest[:, 0])
    return np.asarray(first, np.int64)


def first_paths(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return places AHEAD of first tops, in samples [n]; never sooner if deaf."""
    values = heights(finely(waves))
    at = vertex(values, _first_tops(values, sigma, 0.0))
    if deaf > 0:
        at = np.maximum(at, vertex(values, _first_tops(values, sigma, deaf)))
    return at / FINE - AHEAD


ALL = (3.0, 108.0)  # samples before and after first paths of which all energy is
FIRST = 0.75  # samples that the bell is wide by which the energy of first paths is weighed


def _read(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return the energy of all and of the first path, less noise's [2, n]."""
    energy = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    off = PLACES - at[:, None]
    bell = np.exp(-0.5 * ((off - AHEAD) / FIRST) ** 2)
    inside = (off + ALL[0]).clip(0.0, 1.0) * (ALL[1] - off).clip(0.0, 1.0)
    first = (bell * energy).sum(axis=1) / bell.sum(axis=1)
    return np.stack([(inside * energy).sum(axis=1), first])


def _of_lone() -> Floats:
    """Return all energy, and that of the first path, of lone pulses of height 1 [2, 1]."""
    tops = 90 + np.arange(0.0, 1.0, 0.04)
    read = _read(stars(tops).astype(np.complex128), tops - AHEAD, np.zeros(len(tops)))
    return np.asarray(read.mean(axis=1, keepdims=True))


OF_LONE = _of_lone()


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    every, first = _read(waves, at, sigma) / OF_LONE
    first = first.clip(0.4 * sigma**2)
    return np.asarray(10 * np.log10([np.maximum(every, 1.02 * first), first]))


class Plate:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `told_noise`, `told_count` [n]: factors of what is told;
    `late_m` [n]: what ranges alone get; `deaf`: see `_first_tops`.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        self.blank: Complexes = np.array([*table["cir_i"]]) + 1j * np.array([*table["cir_q"]])
        self.wave: Complexes = self.blank
        self.quiet: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma: Floats = self.quiet
        self.told_noise, self.told_count = np.ones((2, self.rows))
        self.late_m: Floats = np.zeros(self.rows)
        self.deaf = 0.0
        self.at = first_paths(self.blank, self.quiet)
        self.since: Floats = PLACES - self.at[:, None]

    def shot(self) -> Exposure:
        """Return the rows as they are told by now."""
        return Exposure(self.shown(), self.case, self.rng)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 2705, what])

    def past(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later, by a sine [n, k]."""
        part = ((self.since - samples) / within).clip(0.0, 1.0)
        return np.asarray(np.sin(0.5 * np.pi * part) ** 2)

    def by_air(self) -> Complexes:
        """Return what came by air [n, k]: what is no larger than noise is left out, softly."""
        over = (np.abs(self.wave) / (4.2 * self.sigma[:, None])) ** 5
        return np.asarray(self.wave * self.past(-5.0) * over / (1 + over))

    def leading(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.past(-5.0) - self.past(4.4, 2.8)

    def peak(self) -> Floats:
        """Return how high first pulses are [n]."""
        near = np.where(np.abs(self.since - AHEAD) < 1.5, np.abs(self.wave), 0.0)
        return np.asarray(near.max(axis=1))

    def phases(self, *shape: int) -> Complexes:
        """Return phases by chance, [n] or [n, *shape]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random((self.rows, *shape))))

    def repeat(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come again, so many samples later [n]."""
        self.wave = self.wave + part[:, None] * exposed_later(what, samples)

    def fog(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * sky(self.rng, self.rows)

    def dim(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the plate's own noise stays."""
        left = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = left * self.wave
        self.fog(np.sqrt(1 - left**2) * self.sigma[:, None])

    def brighten_ground(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (np.maximum(db, 0.0) / 20)
        self.fog((np.sqrt(by**2 - 1) * self.sigma)[:, None])
        self.sigma, self.told_noise = by * self.sigma, by * self.told_noise

    def count_fewer(self, db: Floats) -> None:
        """Count fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        part = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = part[:, None] * self.wave
        self.fog((np.sqrt(part - part**2) * self.sigma)[:, None])
        root = np.sqrt(part)
        self.sigma, self.told_noise = root * self.sigma, root * self.told_noise
        self.told_count = part * self.told_count

    def bear(self, toll: Toll) -> None:
        """Let waveforms bear what rows do."""
        every, first, noise, count, late = (
            np.zeros(self.rows) + one
            for one in (toll.all_db, toll.first_db, toll.noise_db, toll.count_db, toll.late_m)
        )
        self.late_m = self.late_m + late
        if every.any() or first.any():
            self.dim(self.past(-5.0) * every[:, None] + self.leading() * first[:, None])
        if noise.any():
            self.brighten_ground(noise)
        if count.any():
            self.count_fewer(count)

    def shown(self) -> pd.DataFrame:
        """Return the table as the plate shows it by now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        later = first_paths(self.wave, self.sigma, self.deaf) - self.at
        now = np.clip(was + later, 6.0, WIDE_SAMPLES - 8.0)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * later + self.late_m
        more = levels_db(self.wave, now, self.sigma) - levels_db(self.blank, was, self.quiet)
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
