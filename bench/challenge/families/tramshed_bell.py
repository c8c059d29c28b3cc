"""The tram shed's receiver: what happens to waveforms, and what a tag's bell tells of them.

numpy alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses are what a rectangle is once
a square of a secant has smoothed it. Noise is told by the mean of sizes before. A bell is struck
where sizes are over a high bar, and sounds since these were over a low one (Schmitt 1938); first
paths are told AHEAD of the circular mean of powers about the first top since then (Mardia 1972),
put right by where between samples that is. Levels of first paths are by power and pulse there.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.tramshed_depot import Fares, Fine

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 46, 268
SAMPLE_NS = 0.9377
"""Of the tram shed's own tags; other tables say theirs."""
LIGHT_M_NS = 0.299792458
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
FLAT, SMOOTH = 0.85, 1.18  # samples: half of the rectangle; of what smooths it
ALIKE = (1.0, 0.32, -0.17, -0.2)  # noise beside itself, samples off [DW1000]
BEFORE = slice(5, 38)  # samples that noise is told by
STRIKES, SOUNDS = (4.7, 0.085), (3.3, 0.05)  # bars: of noise's parts; of the largest size
DEAF, DEAFER, MOST = 0.39, 0.27, 0.9  # of the largest size, bars of deaf ones; highest of all
SIDES = 8  # samples at either end that are passed over
AROUND = np.arange(-3, 4)  # samples about tops that are weighed
TURN = 2 * np.pi / 9.0  # radians a sample of circular means
PLACES: Floats = np.arange(WIDE_SAMPLES, dtype=np.float64)
REACH, KEEN = 12, 7.0  # samples of what is shifted by parts of one; of Kaiser's window
WITHIN = (-6.0, 158.0)  # samples from first paths, of all that comes


def strokes(off: Floats) -> Floats:
    """Return how high pulses are so many samples off their tops [...]."""
    edge = np.cosh(2 * FLAT / SMOOTH)
    return np.asarray((1 + edge) / (np.cosh(2 * np.clip(off, -80.0, 80.0) / SMOOTH) + edge))


def peals(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return strokes(PLACES - np.asarray(top)[:, None])


def arcing(rng: np.random.Generator, rows: int, samples: int = WIDE_SAMPLES) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, samples].

    Cut from rings of even noise that are filtered by the root of its spectrum.
    """
    ring = samples + 16
    turns = 2 * np.pi * np.arange(ring) / ring
    power = 1 + 2 * (ALIKE[1] * np.cos(turns) + ALIKE[2] * np.cos(2 * turns)
                     + ALIKE[3] * np.cos(3 * turns))  # fmt: skip
    even = rng.standard_normal((rows, ring)) + 1j * rng.standard_normal((rows, ring))
    return np.asarray(np.fft.ifft(np.sqrt(power) * np.fft.fft(even, axis=1), axis=1)[:, :samples])


def tolled_later(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n], by a sinc in Kaiser's window."""
    long = waves.shape[1]
    late = np.clip(samples, 0.0, long + 2.0 * REACH)
    whole = np.floor(late).astype(np.int64)
    made = np.zeros(waves.shape, np.complex128)
    for tap in range(-REACH, REACH + 1):
        off = tap - (late - whole)
        inner = np.maximum(1 - (off / (REACH + 1)) ** 2, 0.0)
        share = np.sinc(off) * np.i0(KEEN * np.sqrt(inner)) / np.i0(KEEN)
        begin = np.arange(long) - (whole + tap)[:, None]
        taken = np.take_along_axis(waves, begin.clip(0, long - 1), axis=1)
        made += share[:, None] * np.where((begin >= 0) & (begin < long), taken, 0.0)
    return made


def hush(waves: Complexes) -> Floats:
    """Return how a part of noise scatters, by the mean of sizes before [n] (Rayleigh 1880)."""
    return np.asarray(np.abs(waves[:, BEFORE]).mean(axis=1) / np.sqrt(np.pi / 2) + 1e-9)


def struck(waves: Complexes, deaf: float) -> Integers:
    """Return the sample of the first top since a bell sounds [n]; one that is higher if deaf."""
    size = np.abs(waves)
    size[:, :SIDES] = size[:, -SIDES:] = 0.0
    most, noise = size.max(axis=1), hush(waves)
    high = np.maximum(STRIKES[0] * noise, STRIKES[1] * most)
    low = np.maximum(SOUNDS[0] * noise, SOUNDS[1] * most)
    if deaf > 0.0:
        high = np.maximum(high, (DEAF + DEAFER * deaf) * most)
    hit = (size >= np.minimum(high, MOST * most)[:, None]).argmax(axis=1)
    under = (size < np.minimum(low, MOST * most)[:, None]) & (np.arange(size.shape[1])
                                                             <= hit[:, None])  # fmt: skip
    since = size.shape[1] - under[:, ::-1].argmax(axis=1)
    rises = size[:, 1:-1] > np.maximum(size[:, :-2], 0.0)
    falls = size[:, 1:-1] >= size[:, 2:]
    later = np.arange(1, size.shape[1] - 1) >= np.where(deaf > 0.0, hit, since)[:, None]
    top: Integers = (rises & falls & later).argmax(axis=1) + 1
    return top


def _swung(waves: Complexes, top: Integers) -> Floats:
    """Return the circular mean of powers about tops, in samples [n]."""
    at = (top[:, None] + AROUND).clip(0, waves.shape[1] - 1)
    power = np.abs(np.take_along_axis(waves, at, axis=1)) ** 2
    angle = np.angle(power @ np.exp(1j * TURN * AROUND) + 1e-30)
    return np.asarray(top + angle / TURN)


def _righting() -> tuple[Floats, Floats]:
    """Return where between samples lone pulses are told, and what puts that right [k] each."""
    top = 100.0 + np.linspace(-0.5, 0.5, 201)
    told = _swung(peals(top).astype(np.complex128), np.rint(top).astype(np.int64))
    order = np.argsort(told % 1.0)
    return (told % 1.0)[order], (top - told)[order]


PARTS, RIGHTED = _righting()
AHEAD = 1.7
"""Samples from first paths, as these are told, to tops."""


def rung(waves: Complexes, deaf: float = 0.0) -> Floats:
    """Return where first paths are told, in samples [n]; never sooner if deaf."""
    told = _swung(waves, struck(waves, 0.0))
    if deaf > 0.0:
        told = np.maximum(told, _swung(waves, struck(waves, deaf)))
    return np.asarray(told + np.interp(told % 1.0, PARTS, RIGHTED, period=1.0) - AHEAD)


LONE = float(np.mean([(strokes(np.arange(-40.0, 41.0) + part) ** 2).sum()
                      for part in np.linspace(0.0, 0.95, 20)]))  # fmt: skip


def loudness(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return how high first pulses are, by powers about tops as pulses weigh them [n]."""
    top = np.asarray(at) + AHEAD
    which = np.floor(top).astype(np.int64)[:, None] + np.arange(-1, 3)
    pulse = strokes(which - top[:, None]) ** 2
    power = np.abs(np.take_along_axis(waves, which.clip(0, waves.shape[1] - 1), axis=1)) ** 2
    noise = 2 * np.asarray(sigma) ** 2
    fitted = ((power - noise[:, None]) * pulse).sum(axis=1) / (pulse**2).sum(axis=1)
    return np.asarray(np.sqrt(np.maximum(fitted, 0.2 * noise + 1e-12)))


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    since = PLACES - np.asarray(at)[:, None]
    some = (since > WITHIN[0]) & (since < WITHIN[1])
    power = (np.abs(waves) ** 2 * some).sum(axis=1) - 2 * sigma**2 * some.sum(axis=1)
    first = 20 * np.log10(loudness(waves, at, sigma))
    every = 10 * np.log10(np.maximum(power / LONE, 1e-12))
    return np.stack([np.maximum(every, first + 0.12), first])


def ramp(part: Floats) -> Floats:
    """Return 0 under 0, 1 over 1, and half a wave of a cosine between [...]."""
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.clip(part, 0.0, 1.0)))


class Bell:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `noise_by`, `count_by` [n]: factors of what is told;
    `late_m` [n]: what ranges alone get; `deaf`: see `struck`; `metres` [n]: of a sample.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        inphase, other = (np.vstack(table[part].tolist()) for part in ("cir_i", "cir_q"))
        self.begun: Complexes = inphase.astype(np.complex128) + 1j * other
        self.wave = self.begun.copy()
        self.calm = np.asarray(table["noise_std"], np.float64) / OF_SIZES
        self.sigma = self.calm.copy()
        self.noise_by, self.count_by, self.late_m = np.ones((3, self.rows)) * [[1.0], [1.0], [0.0]]
        self.metres = LIGHT_M_NS * np.asarray(table["sample_period_ns"], np.float64)
        self.deaf = 0.0
        self.at = rung(self.begun)

    def fares(self) -> Fares:
        """Return the rows as they are told by now."""
        return Fares(self.told(), self.case, self.rng)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([9505, what, self.case])

    def from_on(self, samples: float, over: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later [n, k]."""
        return ramp((PLACES - self.at[:, None] - samples) / over)

    def direct(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.from_on(-5.0) * (1 - self.from_on(5.0))

    def came(self) -> Complexes:
        """Return what came by air [n, k]: what noise may be is left out, softly."""
        over = np.abs(self.wave) / (self.sigma[:, None] + 1e-9)
        return np.asarray(self.from_on(-5.0) * ramp((over - 2.3) / 2.4) * self.wave)

    def phases(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(-np.pi, np.pi, self.rows)))

    def again(self, of: Complexes, share: Floats | Complexes, samples: Floats) -> None:
        """Let a share [n] of something [n, k] come again, so many samples later [n]."""
        some = np.abs(share) > 1e-9
        if some.any():
            self.wave[some] += share[some, None] * tolled_later(of[some], samples[some])

    def hiss(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * arcing(self.rng, self.rows)

    def muffle(self, db: Floats) -> None:
        """Let what comes lose dB <= 0 [n, k]; the tag's own noise stays as large."""
        kept = np.power(10.0, np.minimum(db, 0.0) / 20)
        self.wave = self.wave * kept
        self.hiss(np.sqrt(1 - kept**2) * self.sigma[:, None])

    def crackle(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        power = np.power(10.0, np.maximum(db, 0.0) / 10)
        self.hiss((self.sigma * np.sqrt(power - 1))[:, None])
        self.sigma, self.noise_by = self.sigma * np.sqrt(power), self.noise_by * np.sqrt(power)

    def count_fewer(self, db: Floats) -> None:
        """Sum fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        part = np.power(10.0, np.minimum(db, 0.0) / 20)
        self.wave = self.wave * part[:, None]
        self.hiss((self.sigma * np.sqrt(part * (1 - part)))[:, None])
        self.sigma, self.noise_by = self.sigma * np.sqrt(part), self.noise_by * np.sqrt(part)
        self.count_by = self.count_by * part

    def levy(self, fine: Fine) -> None:
        """Take of waveforms what rows are fined."""
        none = np.zeros(self.rows)
        self.late_m = self.late_m + fine.late_m
        level, first = none + fine.level_db, none + fine.first_db
        if np.any(level) or np.any(first):
            self.muffle(level[:, None] * self.from_on(-5.0) + first[:, None] * self.direct())
        if np.any(fine.noise_db):
            self.crackle(none + fine.noise_db)
        if np.any(fine.count_db):
            self.count_fewer(none + fine.count_db)

    def told(self) -> pd.DataFrame:
        """Return the table as the bell tells it by now."""
        table = self.table
        index = np.asarray(table["first_path_index"], np.float64)
        later = rung(self.wave, self.deaf) - self.at
        now = np.clip(index + later, 5.0, WIDE_SAMPLES - 9.0)
        every, first = (levels_db(self.wave, now, self.sigma)
                        - levels_db(self.begun, index, self.calm)
                        - 20 * np.log10(self.count_by))  # fmt: skip
        error = np.asarray(table["error_m"], np.float64) + self.metres * later + self.late_m
        return table.assign(
            error_m=error, range_m=table["true_range_m"] + error, first_path_index=now,
            rx_power_dbm=table["rx_power_dbm"] + every,
            first_path_power_dbm=table["first_path_power_dbm"] + first,
            noise_std=table["noise_std"] * self.noise_by,
            preamble_count=table["preamble_count"] * self.count_by,
            cir_i=[*self.wave.real], cir_q=[*self.wave.imag],
        )  # fmt: skip
