"""The cathedral's receiver: what happens to waveforms, and what a boss's lectern reads of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses are skew, as
peaks of chromatograms (Fraser and Suzuki 1969). A bell smooths what comes; from its strongest one
goes back, over lulls, to the earliest that is over a bar: so many times what three
quarters of what came before were under (Rohling 1983), and a part of the strongest. Of the top
there chords are bisected, as of stars' curves of light (Pogson); first paths are told AHEAD of the
middles of these.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.cathedral_nave import Dues, Vigil

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 44, 220
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
WIDTH, SKEW = 2.35, 0.2  # samples between halves of a pulse; how much later it falls than rises
ALIKE = (1.0, 0.32, -0.17, -0.2)  # noise beside itself, samples off [DW1000]
STEPS, BELL, REACH = 4, 1.0, 4  # looks at each sample; of a bell to 1 / e, and to its end, samples
RANKED, HIGHEST = 3.8, 0.07  # bars: of what is so high by rank; of the strongest
WINDOW, RANK, GUARD = 27, 20, 4  # samples that are ranked; which one counts; left out after them
LULL = 45 * STEPS  # looks; going back ends where nothing was over a bar for longer
DEAF, MOST = (3.0, 5.5), 0.93  # by which bars of deaf ones are higher; highest of bars
CHORDS = (0.55, 0.68, 0.81)  # of tops
OPEN = 1.3  # of a lone pulse's chord, that one is no longer than
SIDES = 10 * STEPS  # looks at either end that are passed over
AHEAD_OF_MIDDLES = 1.45  # samples
PLACES: Floats = np.arange(float(WIDE_SAMPLES))


def _chime(off: Floats) -> Floats:
    """Return a pulse's height so many samples off its top [...]."""
    inside = (1 + 2 * SKEW * off / WIDTH).clip(1e-9)
    return np.asarray(np.exp(-np.log(2) * (np.log(inside) / SKEW) ** 2))


def chimes(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return _chime(PLACES - top[:, None])


def sough(rng: np.random.Generator, rows: int, samples: int = WIDE_SAMPLES) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, samples].

    Made on a circle that is longer, of even chances at its pitches (Davies and Harte 1987).
    """
    circle = samples + 20
    lags = np.zeros(circle)
    for k, alike in enumerate(ALIKE):
        lags[k] = lags[-k] = alike
    power = np.fft.fft(lags).real
    drawn = rng.standard_normal((2, rows, circle))
    spread = np.fft.ifft((drawn[0] + 1j * drawn[1]) * np.sqrt(power * circle), axis=1)
    return np.asarray(spread[:, :samples])


TAPS: Integers = np.arange(-9, 11)


def lingered(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by a sinc under a window of Kaiser's."""
    late = samples.clip(0.0, WIDE_SAMPLES + 30.0)
    whole = np.floor(late).astype(np.int64)
    off = TAPS - (late - whole)[:, None]
    by = np.sinc(off) * np.i0(7.0 * np.sqrt((1 - (off / 10.5) ** 2).clip(0.0))) / np.i0(7.0)
    width = waves.shape[1]
    wide = np.pad(waves, ((0, 0), (width + 60, 20)))
    made = np.zeros(waves.shape, np.complex128)
    row, at = np.arange(len(waves))[:, None], np.arange(width)
    for k, tap in enumerate(TAPS.tolist()):
        made += by[:, k, None] * wide[row, (at - whole[:, None] - tap + width + 60).clip(0)]
    return made


def _bank() -> Floats:
    """Return by what samples about are weighed at each look [2 REACH + 1, STEPS]."""
    off = np.arange(STEPS) / STEPS - np.arange(-REACH, REACH + 1)[:, None]
    bank = np.exp(-((off / BELL) ** 2))
    return np.asarray(bank / bank.sum(axis=0))


BANK = _bank()


def smoothed(waves: Complexes) -> Floats:
    """Return sizes once a bell has smoothed waveforms, STEPS to each sample [n, STEPS k]."""
    wide = np.pad(waves, ((0, 0), (REACH, REACH)))
    near = np.lib.stride_tricks.sliding_window_view(wide, 2 * REACH + 1, axis=1)
    return np.abs(near @ BANK).reshape(len(waves), -1)


def ranked_before(sizes: Floats) -> Floats:
    """Return what is so high by rank in a window before each look [n, STEPS k]."""
    whole = sizes[:, ::STEPS]
    wide = np.concatenate([whole[:, 1 : WINDOW + GUARD + 1][:, ::-1], whole], axis=1)
    near = np.lib.stride_tricks.sliding_window_view(wide, WINDOW, axis=1)
    ranked = np.partition(near[:, : whole.shape[1]], RANK, axis=2)[:, :, RANK]
    return np.repeat(ranked, STEPS, axis=1)


def first_tops(sizes: Floats, ranked: Floats, deaf: float) -> Integers:
    """Return the first top that one comes to who goes back from the strongest, in looks [n].

    Bars are higher if deaf, by DEAF.
    """
    looks = np.arange(sizes.shape[1])
    inner = (looks >= SIDES) & (looks < len(looks) - SIDES)
    most = np.where(inner, sizes, 0.0)
    strongest = most.argmax(axis=1)
    highest = most.max(axis=1)[:, None]
    bar = np.maximum(RANKED * ranked, HIGHEST * highest)
    bar = bar * (DEAF[0] + DEAF[1] * deaf if deaf > 0.0 else 1.0)
    over = inner & (sizes >= np.minimum(bar, MOST * highest))
    over[np.arange(len(sizes)), strongest] = True
    last = np.maximum.accumulate(np.where(over, looks, -10 * LULL), axis=1)
    alone = over[:, 1:] & (looks[1:] - last[:, :-1] > LULL)
    began = np.maximum.accumulate(np.where(alone, looks[1:], 0), axis=1)
    begin = began[np.arange(len(sizes)), strongest - 1][:, None]
    tops = (looks[1:-1] >= begin) & (sizes[:, 1:-1] >= sizes[:, :-2])
    tops &= (sizes[:, 1:-1] > sizes[:, 2:]) & over[:, 1:-1]
    return np.asarray(np.where(tops.any(axis=1), tops.argmax(axis=1) + 1, strongest), np.int64)


def _falls_to(near: Floats, level: float) -> Floats:
    """Return after how many looks heights [n, m] next to 1 first fall to a level; else the last."""
    below = near < level
    first = np.where(below.any(axis=1), below.argmax(axis=1), near.shape[1] - 1).clip(1)
    row = np.arange(len(near))
    high, low = near[row, first - 1], near[row, first]
    return np.asarray(first - 1 + ((high - level) / (high - low).clip(1e-9)).clip(0.0, 1.0))


def middles(sizes: Floats, top: Integers) -> Floats:
    """Return the mean of middles of CHORDS about tops, in samples [n]."""
    out, row = np.arange(5 * STEPS), np.arange(len(top))
    one, at, other = (sizes[row, top + k] for k in (-1, 0, 1))
    bend = (2 * at - one - other).clip(1e-12)
    high = at + (one - other) ** 2 / (8 * bend)
    rise, fall = (
        sizes[row[:, None], (top[:, None] + way * out).clip(0, sizes.shape[1] - 1)] / high[:, None]
        for way in (-1, 1)
    )
    found = np.zeros(len(top))
    for level, whole in zip(CHORDS, LONE, strict=True):
        left, right = _falls_to(rise, level), _falls_to(fall, level)
        found += np.minimum(right, OPEN * whole - left) - left
    return np.asarray((top + found / (2 * len(CHORDS))) / STEPS)


def _lone() -> tuple[Floats, float]:
    """Return how long a lone pulse's chords are, in looks, and samples of middles past its top."""
    fine = np.arange(-12.0, 12.0, 0.02)
    high = np.convolve(_chime(fine), np.exp(-((np.arange(-4.0, 4.02, 0.02) / BELL) ** 2)), "same")
    over = [fine[high > level * high.max()] for level in CHORDS]
    past = np.mean([0.5 * (one[0] + one[-1]) for one in over])
    return STEPS * np.array([one[-1] - one[0] for one in over]), float(past)


LONE, PAST = _lone()
AHEAD = AHEAD_OF_MIDDLES - PAST
"""Samples from first paths, as these are told, to tops."""


def readings(waves: Complexes, deaf: float = 0.0) -> Floats:
    """Return where first paths are told, in samples [n]; never sooner if deaf."""
    sizes = smoothed(waves)
    ranked = ranked_before(sizes)
    found = middles(sizes, first_tops(sizes, ranked, 0.0))
    if deaf > 0.0:
        found = np.maximum(found, middles(sizes, first_tops(sizes, ranked, deaf)))
    return np.asarray(found - AHEAD_OF_MIDDLES)


GATE, SLOPE, WITHIN = 1.9, 1.2, (-5.0, 94.0)  # samples: from tops; of a gate's ends; of all


def gates(at: Floats) -> Floats:
    """Return gates about tops of first pulses [n, k], whose ends are slopes."""
    return np.asarray(((GATE + SLOPE - np.abs(PLACES - at[:, None] - AHEAD)) / SLOPE).clip(0, 1))


def _alone(gate: float, slope: float) -> float:
    """Return what energy of a lone pulse of height 1 comes by a gate."""
    off = np.arange(-9.0, 12.0, 0.01)
    return float(
        (_chime(off) ** 2 * ((gate + slope - np.abs(off)) / slope).clip(0, 1)).sum() * 0.01
    )


BY_GATE, WHOLE = _alone(GATE, SLOPE), _alone(99.0, 1.0)


def loudness(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return how high first pulses are by the energy that their gates let through [n]."""
    gate = gates(at)
    power = (gate * (np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2)).sum(axis=1)
    return np.asarray(np.sqrt(np.maximum(power, 0.4 * sigma**2) / BY_GATE))


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    first = loudness(waves, at, sigma) ** 2
    off = PLACES - at[:, None]
    there = (off > WITHIN[0]) & (off < WITHIN[1])
    power = ((np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2) * there).sum(axis=1)
    return np.asarray(10 * np.log10(np.stack([np.maximum(power / WHOLE, 1.01 * first), first])))


class Lectern:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `noise_by`, `count_by` [n]: factors of what is told;
    `late_m` [n]: what ranges alone get; `deaf`: see `first_tops`.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        self.plain: Complexes = np.stack([*table["cir_i"]]) + 1j * np.stack([*table["cir_q"]])
        self.wave = self.plain
        self.calm: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.calm.copy()
        self.noise_by, self.count_by = np.ones((2, self.rows))
        self.late_m, self.deaf = np.zeros(self.rows), 0.0
        self.at = readings(self.plain)
        self.off: Floats = PLACES - self.at[:, None]

    def vigil(self) -> Vigil:
        """Return the rows as they are told by now."""
        return Vigil(self.told(), self.case, self.rng)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([5405, self.case, what])

    def since(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later [n, k], by half a wave."""
        part = ((self.off - samples) / within).clip(0.0, 1.0)
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * part))

    def by_air(self) -> Complexes:
        """Return what came by air [n, k]: of what is next to noise, less (Wiener 1949)."""
        power = np.abs(self.wave) ** 2
        kept = power / (power + 12 * self.sigma[:, None] ** 2 + 1e-12)
        return np.asarray(self.since(-4.5) * kept**2 * self.wave)

    def direct(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.since(-4.5) * (1 - self.since(3.2, 2.6))

    def any_phases(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(-np.pi, np.pi, self.rows)))

    def echo(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come once more, so many samples later [n]."""
        heard = np.flatnonzero(np.abs(part) > 1e-9)
        if len(heard):
            more = part[heard, None] * lingered(what[heard], samples[heard])
            self.wave = self.wave.copy()
            self.wave[heard] += more

    def whisper(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * sough(self.rng, self.rows)

    def fade(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the lectern's own noise stays."""
        left = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * left
        self.whisper(self.sigma[:, None] * np.sqrt(1 - left**2))

    def louder(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (np.maximum(db, 0.0) / 20)
        self.whisper((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.noise_by = self.sigma * by, self.noise_by * by

    def sum_less(self, db: Floats) -> None:
        """Sum fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        by = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * by[:, None]
        self.whisper((self.sigma * np.sqrt(by * (1 - by)))[:, None])
        root = np.sqrt(by)
        self.sigma, self.noise_by = self.sigma * root, self.noise_by * root
        self.count_by = self.count_by * by

    def pay(self, dues: Dues) -> None:
        """Let waveforms pay what rows do."""
        level, first, noise, summed = (
            np.zeros(self.rows) + db
            for db in (dues.level_db, dues.first_db, dues.noise_db, dues.summed_db)
        )
        self.late_m = self.late_m + dues.late_m
        if level.any() or first.any():
            self.fade(self.since(-4.5) * level[:, None] + self.direct() * first[:, None])
        if noise.any():
            self.louder(noise)
        if summed.any():
            self.sum_less(summed)

    def told(self) -> pd.DataFrame:
        """Return the table as the lectern reads it by now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        moved = readings(self.wave, self.deaf) - self.at
        index = (was + moved).clip(4.0, WIDE_SAMPLES - 8.0)
        now, once = (
            levels_db(self.wave, index, self.sigma),
            levels_db(self.plain, was, self.calm),
        )
        level, first = now - once - 20 * np.log10(self.count_by)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * moved + self.late_m
        return self.table.assign(
            first_path_index=index,
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + level,
            first_path_power_dbm=self.table["first_path_power_dbm"] + first,
            preamble_count=self.table["preamble_count"] * self.count_by,
            noise_std=self.table["noise_std"] * self.noise_by,
            cir_i=[*self.wave.real],
            cir_q=[*self.wave.imag],
        )
