"""The distillery's receiver: what happens to waveforms, and what a spirit safe reads of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses are Jackson's
kernels (1912), never below nought, of a spectrum that is a spline. A safe draws samples out to
STEPS looks each without loss; its bar is so many times the noise of one of the calmest blocks
before, or a part of the strongest. From the sides it goes on to what is first over that, up to the
top there, and to where as much comes by a late gate as by an early one (as satellites' signals are
followed; Fine, Johnson 1965).
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.distillery_house import Duty, Run

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 48, 216
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
REACH = 3.75  # samples from a pulse's top until it is none
ALIKE = (1.0, 0.32, -0.17, -0.2)  # noise beside itself, samples off [DW1000]
STEPS = 4  # looks at each sample
BLOCKS, BLOCK, CALM = 4, 8, 1  # blocks of so many samples before; which in order of energy counts
OVER, PART = 4.7, 0.085  # bars: of noise there; of the strongest
DULL, MOST = (3.4, 6.6), 0.94  # by which bars of dull ones are higher; highest of bars
SIDES, UP = 9 * STEPS, 14  # looks at either end that are passed over; from a bar to a top
EARLY = 6  # looks that either gate lasts
NEAR = 5  # looks about tops within which gates are moved
AHEAD = 1.2
"""Samples from first paths, as these are told, to tops."""
PLACES: Floats = np.arange(float(WIDE_SAMPLES))


def _run_off(off: Floats) -> Floats:
    """Return a pulse's height so many samples off its top [...]."""
    return np.asarray(np.sinc(off / REACH) ** 4)


def drops(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return _run_off(PLACES - top[:, None])


def _sieve() -> Floats:
    """Return four taps by which even noise becomes ALIKE (Fejer 1916)."""
    both = np.array([*ALIKE[:0:-1], *ALIKE])
    roots = np.roots(both)
    taps = np.poly(roots[np.abs(roots) < 1]).real
    return np.asarray(taps / np.sqrt((taps**2).sum()))


SIEVE = _sieve()


def seething(rng: np.random.Generator, rows: int, samples: int = WIDE_SAMPLES) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, samples]."""
    even = rng.standard_normal((rows, samples + 3, 2)) @ np.array([1.0, 1.0j])
    return np.asarray(sum(tap * even[:, 3 - k : samples + 3 - k] for k, tap in enumerate(SIEVE)))


ROOM = 512  # samples of what turns, so that nothing comes round


def run_later(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: each pitch turned by as much."""
    late = samples.clip(0.0, WIDE_SAMPLES + 40.0)
    pitch = np.fft.fft(waves, ROOM, axis=1)
    pitch *= np.exp(-2j * np.pi * np.fft.fftfreq(ROOM) * late[:, None])
    made = np.fft.ifft(pitch, axis=1)[:, : waves.shape[1]]
    return np.asarray(np.where(np.arange(waves.shape[1]) < late[:, None] - 24, 0.0, made))


def drawn_out(waves: Complexes) -> Floats:
    """Return powers of waveforms at STEPS looks to each sample [n, STEPS k]."""
    count = waves.shape[1]
    pitch = np.fft.fft(waves, axis=1)
    middle = np.zeros((len(waves), (STEPS - 1) * count), np.complex128)
    full = np.concatenate([pitch[:, : count // 2], middle, pitch[:, count // 2 :]], axis=1)
    return np.asarray(np.abs(STEPS * np.fft.ifft(full, axis=1)) ** 2)


def calm(waves: Complexes) -> Floats:
    """Return how large noise is by one of the calmest blocks before, root mean square [n]."""
    before = np.abs(waves[:, 2 : 2 + BLOCKS * BLOCK]) ** 2
    power = before.reshape(len(waves), BLOCKS, BLOCK).mean(axis=2)
    return np.asarray(np.sqrt(np.sort(power, axis=1)[:, CALM]))


def first_tops(power: Floats, quiet: Floats, dull: float) -> Integers:
    """Return the first top after powers [n, looks] first are over a bar, in looks [n].

    `quiet` [n]: of `calm`. Bars are higher if dull, by DULL.
    """
    inner = power.copy()
    inner[:, :SIDES] = inner[:, -SIDES:] = 0.0
    most = np.sqrt(inner.max(axis=1))
    higher = DULL[0] + DULL[1] * dull if dull > 0.0 else 1.0
    bar = np.minimum(higher * np.maximum(OVER * quiet, PART * most), MOST * most)
    over = (inner >= bar[:, None] ** 2).argmax(axis=1)
    near = over[:, None] + np.arange(-1, UP)
    about = np.take_along_axis(inner, near.clip(0, power.shape[1] - 1), axis=1)
    is_top = (about[:, 1:-1] >= about[:, :-2]) & (about[:, 1:-1] > about[:, 2:])
    first = np.where(is_top.any(axis=1), is_top.argmax(axis=1), about.argmax(axis=1) - 1)
    return np.asarray(over + first, np.int64)


def balanced(power: Floats, top: Integers) -> Floats:
    """Return where gates about tops let as much through early as late, in samples [n]."""
    wide = np.pad(power, ((0, 0), (EARLY + NEAR + 1, EARLY + NEAR + 1)))
    filled = np.cumsum(wide, axis=1) - 0.5 * wide
    at = top[:, None] + EARLY + NEAR + 1 + np.arange(-NEAR, NEAR + 1)
    before, here, after = (np.take_along_axis(filled, at + by, axis=1) for by in (-EARLY, 0, EARLY))
    more_late = after + before - 2 * here
    crosses = (more_late[:, :-1] > 0) & (more_late[:, 1:] <= 0)
    begin = np.arange(-NEAR, NEAR)
    away = np.where(crosses, np.abs(begin + 0.5), 99.0)
    pick = away.argmin(axis=1)[:, None]
    left, right = (np.take_along_axis(more_late, pick + k, axis=1)[:, 0] for k in (0, 1))
    where = begin[pick[:, 0]] + left / (left - right + 1e-300)
    return np.asarray((top + np.where(crosses.any(axis=1), where, 0.0)) / STEPS)


def tellings(waves: Complexes, dull: float = 0.0) -> Floats:
    """Return where first paths are told, in samples [n]; never sooner if dull."""
    power, quiet = drawn_out(waves), calm(waves)
    found = balanced(power, first_tops(power, quiet, 0.0))
    if dull > 0.0:
        found = np.maximum(found, balanced(power, first_tops(power, quiet, dull)))
    return np.asarray(found - AHEAD)


def _of_one() -> tuple[float, float]:
    """Return a lone pulse's energy, and how much noise ALIKE comes through it next to that."""
    off = np.arange(-40.0, 41.0)
    every = [_run_off(off - part) for part in np.arange(0.0, 1.0, 0.125)]
    energy = np.mean([(one**2).sum() for one in every])
    through = np.mean([
        sum((1 + (lag > 0)) * alike * (one[lag:] * one[: len(one) - lag]).sum()
            for lag, alike in enumerate(ALIKE))
        for one in every
    ])  # fmt: skip
    return float(energy), float(through / energy)


ENERGY, BY_NOISE = _of_one()
WITHIN = (-5.0, 86.0)  # samples from tops, of all that comes


def matched(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return how high first pulses are by what comes through a pulse like them [n]."""
    like = drops(at + AHEAD)
    power = np.abs((like * waves).sum(axis=1)) ** 2 / ENERGY**2
    of_noise = 2 * sigma**2 * BY_NOISE / ENERGY
    return np.asarray(np.sqrt(np.maximum(power - of_noise, 0.2 * of_noise + 1e-12)))


def strengths_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    first = matched(waves, at, sigma) ** 2
    off = PLACES - at[:, None] - AHEAD
    there = (off >= WITHIN[0]) & (off <= WITHIN[1])
    power = np.where(there, np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2, 0.0).sum(axis=1)
    return np.asarray(10 * np.log10(np.stack([np.maximum(power / ENERGY, 1.01 * first), first])))


class Safe:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `noise_by`, `count_by` [n]: factors of what is told;
    `late_m` [n]: what ranges alone get; `dull`: see `first_tops`.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        parts = [np.stack(table[name].tolist()) for name in ("cir_i", "cir_q")]
        self.begun: Complexes = parts[0] + 1j * parts[1]
        self.wave = self.begun
        self.still: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.still.copy()
        self.noise_by, self.count_by = np.ones(self.rows), np.ones(self.rows)
        self.late_m, self.dull = np.zeros(self.rows), 0.0
        self.at = tellings(self.begun)
        self.off: Floats = PLACES - self.at[:, None]

    def run(self) -> Run:
        """Return the rows as they are told by now."""
        return Run(self.told(), self.case, self.rng)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([6205, what, self.case])

    def after(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later [n, k], smoothly."""
        part = np.clip((self.off - samples) / within, 0.0, 1.0)
        return np.asarray(part**2 * (3 - 2 * part))

    def heard(self) -> Complexes:
        """Return what came by air [n, k]: less noise's power, where there is more (Boll 1979)."""
        power = np.abs(self.wave) ** 2
        kept = np.sqrt((1 - 9 * self.sigma[:, None] ** 2 / (power + 1e-12)).clip(0.0))
        return np.asarray(self.after(-4.5) * kept * self.wave)

    def straight(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.after(-4.5) * (1 - self.after(3.1, 2.4))

    def turned(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def again(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come once more, so many samples later [n]."""
        own = np.flatnonzero(np.abs(part) > 1e-9)
        more = np.zeros(self.wave.shape, np.complex128)
        if own.size:
            more[own] = part[own, None] * run_later(what[own], samples[own])
        self.wave = self.wave + more

    def seethe(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * seething(self.rng, self.rows)

    def weaken(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the safe's own noise stays."""
        kept = np.minimum(10 ** (db / 20), 1.0)
        self.wave = kept * self.wave
        self.seethe(self.sigma[:, None] * np.sqrt(1 - kept**2))

    def roar(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = np.maximum(10 ** (db / 20), 1.0)
        self.seethe((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.noise_by = by * self.sigma, by * self.noise_by

    def stop_sooner(self, db: Floats) -> None:
        """Sum fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        by = np.minimum(10 ** (db / 20), 1.0)
        self.wave = by[:, None] * self.wave
        self.seethe((self.sigma * np.sqrt(by - by**2))[:, None])
        self.sigma, self.noise_by = np.sqrt(by) * self.sigma, np.sqrt(by) * self.noise_by
        self.count_by = by * self.count_by

    def levy(self, duty: Duty) -> None:
        """Let waveforms pay what rows do."""
        none = np.zeros(self.rows)
        self.late_m = self.late_m + duty.late_m
        level, first = none + duty.level_db, none + duty.first_db
        if np.any(level) or np.any(first):
            self.weaken(level[:, None] * self.after(-4.5) + first[:, None] * self.straight())
        if np.any(duty.noise_db):
            self.roar(none + duty.noise_db)
        if np.any(duty.summed_db):
            self.stop_sooner(none + duty.summed_db)

    def told(self) -> pd.DataFrame:
        """Return the table as the safe reads it by now."""
        table, begun = self.table, self.table["first_path_index"].to_numpy(np.float64)
        by = tellings(self.wave, self.dull) - self.at
        index = np.clip(begun + by, 4.0, WIDE_SAMPLES - 8.0)
        gained = strengths_db(self.wave, index, self.sigma)
        gained -= strengths_db(self.begun, begun, self.still) + 20 * np.log10(self.count_by)
        error = table["error_m"].to_numpy(np.float64) + METRES * by + self.late_m
        return table.assign(
            error_m=error, range_m=table["true_range_m"] + error, first_path_index=index,
            rx_power_dbm=table["rx_power_dbm"] + gained[0],
            first_path_power_dbm=table["first_path_power_dbm"] + gained[1],
            noise_std=table["noise_std"] * self.noise_by,
            preamble_count=table["preamble_count"] * self.count_by,
            cir_i=[*self.wave.real], cir_q=[*self.wave.imag],
        )  # fmt: skip
