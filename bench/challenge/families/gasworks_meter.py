"""The gasworks' receiver: what happens to waveforms, and what a tag's meter tells of them.

numpy alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses have skirts (Moffat 1969).
Noise is told by what three quarters of the power before are under. The first top over a bar is
taken; ahead of it, first paths are where sizes are a part of what they are DELAY samples on, which
is so at one place however large they are (constant fraction, Gedcke and McDonald 1968), put right
by where between samples that is. Levels of first paths are by the pulse matched there.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.gasworks_yard import Bill, Charge

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 48, 272
SAMPLE_NS = 0.8013
"""Of the gasworks' own tags; other tables say theirs."""
LIGHT_M_NS = 0.299792458
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
SKIRT, POWER = 3.6, 5.0  # samples; of pulses
ALIKE: Floats = np.array([1.0, 0.32, -0.17, -0.2])  # noise beside itself [DW1000]
BEFORE = (4, 38)  # samples that noise is told by
OVER, OF_MOST = 15.0, 0.07  # bars: of noise's power; of the largest size
DEAF, MOST = (0.33, 0.22), 0.9  # of the largest size, bars of deaf ones; highest of all
SIDES, BACK = 7, 6  # samples at either end that are passed over; before tops
PART, DELAY = 0.55, 2  # of a size, that much later
PLACES: Floats = np.arange(float(WIDE_SAMPLES))
NEAR = np.arange(-3, 4)  # samples about tops that first paths' levels are of
HEARD = 0.4  # turns a sample, up to which all of what comes later is kept
WITHIN = (-5.0, 150.0)  # samples from first paths, of all that comes


def skirted(off: Floats) -> Floats:
    """Return how high pulses are so many samples off their tops [...]."""
    return np.asarray((1 + (off / SKIRT) ** 2) ** -POWER)


def puffs(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return skirted(PLACES - top[:, None])


@cache
def _triangle(samples: int) -> Floats:
    """Return what makes even noise beside itself as ALIKE says [samples, samples] (Cholesky)."""
    off = np.abs(np.subtract.outer(np.arange(samples), np.arange(samples)))
    made = np.where(off < len(ALIKE), ALIKE[off.clip(max=len(ALIKE) - 1)], 0.0)
    return np.asarray(np.linalg.cholesky(made).T)


def hissing(rng: np.random.Generator, rows: int, samples: int = WIDE_SAMPLES) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, samples]."""
    parts = rng.standard_normal((2, rows, samples)) @ _triangle(samples)
    return np.asarray(parts[0] + 1j * parts[1])


def piped_later(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: pitches turned by as much (Fourier).

    Those that pulses have nothing of are left out, softly (Tukey 1967), lest edges ripple.
    """
    long = 2 * waves.shape[1]
    late = samples.clip(0.0, float(waves.shape[1]))
    pitch = np.fft.fftfreq(long)
    kept = np.cos(0.5 * np.pi * ((np.abs(pitch) - HEARD) / (0.5 - HEARD)).clip(0.0)) ** 2
    turned = kept * np.exp(-2j * np.pi * late[:, None] * pitch)
    made = np.fft.ifft(turned * np.fft.fft(waves, long, axis=1), axis=1)[:, : waves.shape[1]]
    return np.asarray(np.where(samples[:, None] < waves.shape[1], made, 0.0))


def lull(waves: Complexes) -> Floats:
    """Return noise's mean power by the third quartile of what comes before [n]."""
    power = np.abs(waves[:, BEFORE[0] : BEFORE[1]]) ** 2
    return np.asarray(np.quantile(power, 0.75, axis=1) / np.log(4.0) + 1e-12)


def first_top(waves: Complexes, deaf: float) -> Integers:
    """Return the sample of the first top over a bar [n]; of a higher one if deaf, by DEAF."""
    size = np.abs(waves)
    size[:, :SIDES] = size[:, -SIDES:] = 0.0
    most = size.max(axis=1)
    bar = np.maximum(np.sqrt(OVER * lull(waves)), OF_MOST * most)
    if deaf > 0.0:
        bar = np.maximum(bar, (DEAF[0] + DEAF[1] * deaf) * most)
    tops = np.zeros(size.shape, np.bool_)
    tops[:, 1:-1] = (size[:, 1:-1] >= size[:, :-2]) & (size[:, 1:-1] > size[:, 2:])
    tops &= size >= np.minimum(bar, MOST * most)[:, None]
    first: Integers = np.where(tops.any(axis=1), tops.argmax(axis=1), size.argmax(axis=1))
    return first


def _at_fraction(waves: Complexes, top: Integers) -> Floats:
    """Return where, ahead of tops, sizes are PART of what they are DELAY samples on [n]."""
    near = np.abs(np.take_along_axis(waves, top[:, None] + np.arange(-BACK, DELAY + 1), axis=1))
    over = near[:, :-DELAY] - PART * near[:, DELAY:]
    under = over[:, :-1] < 0
    last = np.where(under.any(axis=1), BACK - 1 - under[:, ::-1].argmax(axis=1), 0)
    low, high = (np.take_along_axis(over, last[:, None] + k, axis=1)[:, 0] for k in (0, 1))
    part = (-low / np.maximum(high - low, 1e-9)).clip(0.0, 1.0)
    return np.asarray(top - BACK + last + part)


def _of_lone() -> tuple[float, Floats, Floats]:
    """Return how far ahead of tops lone pulses are told, and what is put right by parts [k]."""
    top = 90.0 + np.arange(0.0, 1.0, 1 / 160)
    wave = puffs(top).astype(np.complex128)
    told = _at_fraction(wave, np.abs(wave).argmax(axis=1))
    ahead = float((top - told).mean())
    order = np.argsort(told % 1.0)
    return ahead, (told % 1.0)[order], (top - ahead - told)[order]


AHEAD, PARTS, RIGHTED = _of_lone()
"""AHEAD: samples from first paths, as these are told, to tops."""


def metered(waves: Complexes, deaf: float = 0.0) -> Floats:
    """Return where first paths are told, in samples [n]; never sooner if deaf."""
    told = _at_fraction(waves, first_top(waves, 0.0))
    if deaf > 0.0:
        told = np.maximum(told, _at_fraction(waves, first_top(waves, deaf)))
    return np.asarray(told + np.interp(told % 1.0, PARTS, RIGHTED, period=1.0))


BESIDE: Floats = np.where(
    np.abs(np.subtract.outer(NEAR, NEAR)) < len(ALIKE),
    ALIKE[np.abs(np.subtract.outer(NEAR, NEAR)).clip(max=len(ALIKE) - 1)], 0.0,
)  # fmt: skip
WHOLE = float((skirted(np.arange(-30.0, 31.0)[:, None] - np.arange(0.0, 1.0, 0.05)) ** 2)
              .sum(axis=0).mean())  # fmt: skip


def heights(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return how high first pulses are, matched where they are told, less noise's [n]."""
    top = at + AHEAD
    which = (np.rint(top).astype(np.int64)[:, None] + NEAR).clip(0, waves.shape[1] - 1)
    share = skirted(which - top[:, None])
    share /= (share**2).sum(axis=1)[:, None]
    noise = 2 * sigma**2 * np.einsum("ni,ij,nj->n", share, BESIDE, share)
    power = np.abs((share * np.take_along_axis(waves, which, axis=1)).sum(axis=1)) ** 2 - noise
    return np.asarray(np.sqrt(np.maximum(power, 0.2 * noise + 1e-12)))


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    first = heights(waves, at, sigma) ** 2
    off = PLACES - at[:, None]
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    every = np.where((off >= WITHIN[0]) & (off <= WITHIN[1]), power, 0.0).sum(axis=1) / WHOLE
    return np.asarray(10 * np.log10(np.stack([np.maximum(every, 1.03 * first), first])))


class Meter:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `noise_by`, `count_by` [n]: factors of what is told;
    `more_m` [n]: what ranges alone get; `deaf`: see `first_top`; `metres` [n]: of a sample.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        self.begun: Complexes = np.array(
            [i + 1j * np.asarray(q) for i, q in zip(table["cir_i"], table["cir_q"], strict=True)],
            np.complex128,
        )
        self.wave = self.begun.copy()
        self.quiet: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.quiet.copy()
        self.noise_by, self.count_by = np.ones(self.rows), np.ones(self.rows)
        self.more_m, self.deaf = np.zeros(self.rows), 0.0
        self.metres: Floats = LIGHT_M_NS * table["sample_period_ns"].to_numpy(np.float64)
        self.at = metered(self.begun)

    def charge(self) -> Charge:
        """Return the rows as they are told by now."""
        return Charge(self.told(), self.case, self.rng)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([9205, what, self.case])

    def behind(self, samples: float, over: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later [n, k]."""
        part = ((PLACES - self.at[:, None] - samples) / over).clip(0.0, 1.0)
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * part))

    def straight(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.behind(-6.0) - self.behind(4.6)

    def came(self) -> Complexes:
        """Return what came by air [n, k]: what noise may be is left out, softly."""
        ratio = np.abs(self.wave) / (3.2 * self.sigma[:, None] + 1e-9)
        return np.asarray(self.behind(-6.0) * ratio**4 / (1 + ratio**4) * self.wave)

    def turned(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(0.0, 2 * np.pi, self.rows)))

    def again(self, of: Complexes, share: Floats | Complexes, samples: Floats) -> None:
        """Let a share [n] of something [n, k] come once more, so many samples later [n]."""
        some = np.flatnonzero(np.abs(share) > 1e-9)
        if some.size:
            self.wave[some] += share[some, None] * piped_later(of[some], samples[some])

    def hiss(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * hissing(self.rng, self.rows)

    def dull(self, db: Floats) -> None:
        """Let what comes lose dB <= 0 [n, k]; the tag's own noise stays."""
        kept = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = kept * self.wave
        self.hiss(self.sigma[:, None] * np.sqrt(1 - kept**2))

    def roar(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (np.maximum(db, 0.0) / 20)
        self.hiss((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.noise_by = self.sigma * by, self.noise_by * by

    def sum_fewer(self, db: Floats) -> None:
        """Sum fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        by = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = by[:, None] * self.wave
        self.hiss((self.sigma * np.sqrt(by - by**2))[:, None])
        for name in ("sigma", "noise_by"):
            setattr(self, name, getattr(self, name) * np.sqrt(by))
        self.count_by = self.count_by * by

    def settle(self, bill: Bill) -> None:
        """Take of waveforms what rows are charged."""
        level, first, noise, count, more = (
            np.zeros(self.rows) + one
            for one in (bill.level_db, bill.first_db, bill.noise_db, bill.count_db, bill.more_m)
        )
        self.more_m = self.more_m + more
        if level.any() or first.any():
            self.dull(level[:, None] * self.behind(-6.0) + first[:, None] * self.straight())
        if noise.any():
            self.roar(noise)
        if count.any():
            self.sum_fewer(count)

    def told(self) -> pd.DataFrame:
        """Return the table as the meter tells it by now."""
        table = self.table
        index = table["first_path_index"].to_numpy(np.float64)
        later = metered(self.wave, self.deaf) - self.at
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
