"""The lighthouse's receiver: what happens to waveforms, and what a cresset's lens tells of them.

numpy alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses are squares of hyperbolic
secants that rise sooner than they fall. Noise is told by the lower four fifths of the power before
(a trimmed mean). From the first two samples in a row over a bar it is followed up to a top; first
paths are told where the steps up to that are, in the mean by their squares, put right by where
between samples that is. Levels of first paths are by the power about their tops.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.lighthouse_station import Dues, Entries

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 50, 256
SAMPLE_NS = 0.8562
"""Of the lighthouse's own tags; other tables say theirs."""
LIGHT_M_NS = 0.299792458
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
WIDTH, SKEW = 1.58, 0.15  # samples; part by which pulses rise sooner and fall later
ALIKE = (1.0, 0.32, -0.17, -0.2)  # noise beside itself, samples off [DW1000]
BEFORE, LOWER = (3, 40), 0.8  # samples that noise is told by; the part of these
OVER, OF_MOST = 13.0, 0.065  # bars: of noise's power; of the largest size
DIM, MOST = (0.4, 0.26), 0.9  # of the largest size, bars of dim ones; highest of all
SIDES, STEPS = 7, 4  # samples at either end that are passed over; steps up to tops
PLACES: Floats = np.arange(float(WIDE_SAMPLES))
ABOUT = np.arange(-2, 3)  # samples about tops that first paths' levels are of
HEARD, STEEP = 0.44, 24  # turns a sample over which what comes later is lost; how soon
WITHIN = (-5.0, 150.0)  # samples from first paths, of all that comes


def shone(off: Floats) -> Floats:
    """Return how high pulses are so many samples off their tops [...]."""
    return np.asarray(1 / np.cosh(off / (WIDTH * (1 + SKEW * np.tanh(off / WIDTH)))) ** 2)


def gleams(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return shone((PLACES - top[:, None]).clip(-60.0, 60.0))


def _taps() -> Floats:
    """Return what even noise is summed by to be beside itself as ALIKE says [len(ALIKE)].

    Of all that would do the soonest, by the folded cepstrum (Kolmogorov 1941).
    """
    turns = 2 * np.pi * np.arange(1024) / 1024
    power = 1 + 2 * sum(one * np.cos(k * turns) for k, one in enumerate(ALIKE) if k)
    folded = np.fft.ifft(0.5 * np.log(np.asarray(power))).real
    folded[1:512] *= 2
    folded[513:] = 0.0
    return np.asarray(np.fft.ifft(np.exp(np.fft.fft(folded))).real[: len(ALIKE)])


TAPS = _taps()


def breaking(rng: np.random.Generator, rows: int, samples: int = WIDE_SAMPLES) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, samples]."""
    even = rng.standard_normal((rows, samples + len(TAPS) - 1, 2)) @ np.array([1.0, 1.0j])
    last = len(TAPS) - 1
    return np.asarray(sum(tap * even[:, last - k : last - k + samples]
                          for k, tap in enumerate(TAPS)))  # fmt: skip


def ebbed(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: whole ones are shifted, parts of one turned.

    What is over HEARD is lost, as by a filter of many stages (Butterworth 1930).
    """
    long = waves.shape[1]
    late = samples.clip(0.0, long + 1.0)
    whole = np.floor(late).astype(np.int64)
    pitch = np.fft.fftfreq(long + 32)
    kept = 1 / np.sqrt(1 + (pitch / HEARD) ** STEEP)
    turned = kept * np.exp(-2j * np.pi * (late - whole)[:, None] * pitch)
    parts = np.fft.ifft(turned * np.fft.fft(waves, long + 32, axis=1), axis=1)[:, :long]
    begin = np.arange(long) - whole[:, None]
    taken = np.take_along_axis(parts, begin.clip(0), axis=1)
    return np.asarray(np.where(begin >= 0, taken, 0.0))


def murmur(waves: Complexes) -> Floats:
    """Return noise's mean power by the mean of the lower ones of what comes before [n]."""
    power = np.sort(np.abs(waves[:, BEFORE[0] : BEFORE[1]]) ** 2, axis=1)
    lower = power[:, : round(LOWER * power.shape[1])].mean(axis=1)
    return np.asarray(lower / (1 + (1 - LOWER) * np.log(1 - LOWER) / LOWER) + 1e-12)


def first_crest(waves: Complexes, dim: float) -> Integers:
    """Return the sample of the first top past a bar [n]; past a higher one if dim, by DIM."""
    size = np.abs(waves)
    size[:, :SIDES] = size[:, -SIDES:] = 0.0
    most = size.max(axis=1)
    bar = np.maximum(np.sqrt(OVER * murmur(waves)), OF_MOST * most)
    if dim > 0.0:
        bar = np.maximum(bar, (DIM[0] + DIM[1] * dim) * most)
    over = size >= np.minimum(bar, MOST * most)[:, None]
    over[:, :-1] &= over[:, 1:]
    begin = np.where(over.any(axis=1), over.argmax(axis=1), size.argmax(axis=1))
    tops = np.zeros(size.shape, np.bool_)
    tops[:, 1:-1] = (size[:, 1:-1] >= size[:, :-2]) & (size[:, 1:-1] > size[:, 2:])
    tops &= np.arange(size.shape[1]) >= begin[:, None]
    crest: Integers = np.where(tops.any(axis=1), tops.argmax(axis=1), begin).clip(SIDES)
    return crest


def _by_steps(waves: Complexes, crest: Integers) -> Floats:
    """Return where steps up to crests are, in the mean by their squares, in samples [n]."""
    at = crest[:, None] + np.arange(-STEPS, 1)
    up = np.diff(np.abs(np.take_along_axis(waves, at, axis=1)), axis=1).clip(0.0) ** 2
    where = at[:, 1:] - 0.5
    return np.asarray((up * where).sum(axis=1) / (up.sum(axis=1) + 1e-30))


def _of_lone() -> tuple[float, Floats, Floats]:
    """Return how far ahead of tops lone pulses are told, and what is put right by parts [k]."""
    top = 90.0 + np.arange(0.0, 1.0, 1 / 200)
    wave = gleams(top).astype(np.complex128)
    told = _by_steps(wave, np.abs(wave).argmax(axis=1))
    ahead = float((top - told).mean())
    order = np.argsort(told % 1.0)
    return ahead, (told % 1.0)[order], (top - ahead - told)[order]


AHEAD, PARTS, RIGHTED = _of_lone()
"""AHEAD: samples from first paths, as these are told, to tops."""


def focused(waves: Complexes, dim: float = 0.0) -> Floats:
    """Return where first paths are told, in samples [n]; never sooner if dim."""
    told = _by_steps(waves, first_crest(waves, 0.0))
    if dim > 0.0:
        told = np.maximum(told, _by_steps(waves, first_crest(waves, dim)))
    return np.asarray(told + np.interp(told % 1.0, PARTS, RIGHTED, period=1.0))


WHOLE = float((shone(np.arange(-30.0, 31.0)[:, None] - np.arange(0.0, 1.0, 0.05)) ** 2)
              .sum(axis=0).mean())  # fmt: skip


def brightness(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return how high first pulses are, by the power about their tops, less noise's [n]."""
    top = at + AHEAD
    which = (np.rint(top).astype(np.int64)[:, None] + ABOUT).clip(0, waves.shape[1] - 1)
    full = (shone(which - top[:, None]) ** 2).sum(axis=1)
    noise = 2 * sigma**2 * len(ABOUT)
    power = (np.abs(np.take_along_axis(waves, which, axis=1)) ** 2).sum(axis=1) - noise
    return np.asarray(np.sqrt(np.maximum(power, 0.15 * noise + 1e-12) / full))


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    first = brightness(waves, at, sigma) ** 2
    off = PLACES - at[:, None]
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    every = np.where((off >= WITHIN[0]) & (off <= WITHIN[1]), power, 0.0).sum(axis=1) / WHOLE
    return np.asarray(10 * np.log10(np.stack([np.maximum(every, 1.03 * first), first])))


class Lens:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `noise_by`, `count_by` [n]: factors of what is told;
    `more_m` [n]: what ranges alone get; `dim`: see `first_crest`; `metres` [n]: of a sample.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        parts = [np.stack([*map(np.asarray, table[name])]) for name in ("cir_i", "cir_q")]
        self.begun: Complexes = np.asarray(parts[0] + 1j * parts[1], np.complex128)
        self.wave = self.begun.copy()
        self.quiet: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.quiet.copy()
        self.noise_by, self.count_by = np.ones(self.rows), np.ones(self.rows)
        self.more_m, self.dim = np.zeros(self.rows), 0.0
        self.metres: Floats = LIGHT_M_NS * table["sample_period_ns"].to_numpy(np.float64)
        self.at = focused(self.begun)

    def entries(self) -> Entries:
        """Return the rows as they are told by now."""
        return Entries(self.told(), self.case, self.rng)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([9305, what, self.case])

    def since(self, samples: float, over: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later [n, k]."""
        part = ((PLACES - self.at[:, None] - samples) / over).clip(0.0, 1.0)
        return np.asarray(part**2 * (3 - 2 * part))

    def straight(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.since(-5.0) - self.since(4.8)

    def arrived(self) -> Complexes:
        """Return what came by air [n, k]: what noise may be is left out, softly."""
        ratio = np.abs(self.wave) / (3.4 * self.sigma[:, None] + 1e-9)
        return np.asarray(self.since(-5.0) * -np.expm1(-(ratio**4)) * self.wave)

    def turned(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def once_more(self, of: Complexes, share: Floats | Complexes, samples: Floats) -> None:
        """Let a share [n] of something [n, k] come once more, so many samples later [n]."""
        some = np.flatnonzero(np.abs(share) > 1e-9)
        if some.size:
            self.wave[some] += share[some, None] * ebbed(of[some], samples[some])

    def murmurs(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * breaking(self.rng, self.rows)

    def darken(self, db: Floats) -> None:
        """Let what comes lose dB <= 0 [n, k]; the cresset's own noise stays."""
        kept = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = kept * self.wave
        self.murmurs(self.sigma[:, None] * np.sqrt(1 - kept**2))

    def glare(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (np.maximum(db, 0.0) / 20)
        self.murmurs((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.noise_by = self.sigma * by, self.noise_by * by

    def sum_fewer(self, db: Floats) -> None:
        """Sum fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        by = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = by[:, None] * self.wave
        self.murmurs((self.sigma * np.sqrt(by - by**2))[:, None])
        self.sigma, self.noise_by = self.sigma * np.sqrt(by), self.noise_by * np.sqrt(by)
        self.count_by = self.count_by * by

    def collect(self, dues: Dues) -> None:
        """Take of waveforms what rows owe."""
        level, first, noise, count, more = (
            np.zeros(self.rows) + one
            for one in (dues.level_db, dues.first_db, dues.noise_db, dues.count_db, dues.more_m)
        )
        self.more_m = self.more_m + more
        if level.any() or first.any():
            self.darken(level[:, None] * self.since(-5.0) + first[:, None] * self.straight())
        if noise.any():
            self.glare(noise)
        if count.any():
            self.sum_fewer(count)

    def told(self) -> pd.DataFrame:
        """Return the table as the lens tells it by now."""
        table = self.table
        index = table["first_path_index"].to_numpy(np.float64)
        later = focused(self.wave, self.dim) - self.at
        now = (index + later).clip(4.0, WIDE_SAMPLES - 8.0)
        change = levels_db(self.wave, now, self.sigma) - levels_db(self.begun, index, self.quiet)
        every, first = change - 20 * np.log10(self.count_by)
        error = table["error_m"].to_numpy(np.float64) + self.metres * later + self.more_m
        return table.assign(
            error_m=error, range_m=table["true_range_m"] + error, first_path_index=now,
            rx_power_dbm=table["rx_power_dbm"] + every,
            first_path_power_dbm=table["first_path_power_dbm"] + first,
            noise_std=table["noise_std"] * self.noise_by,
            preamble_count=table["preamble_count"] * self.count_by,
            cir_i=[*self.wave.real], cir_q=[*self.wave.imag],
        )  # fmt: skip
