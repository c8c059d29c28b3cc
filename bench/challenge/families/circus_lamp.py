"""The circus' receiver: what happens to waveforms, and what a pole's lamp tells of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. Pulses are a window of
four cosines (Nuttall 1981); what comes is taken off pulse by pulse, the strongest first, as images
of stars are cleaned (Hoegbom 1974), and first paths are told AHEAD of the first pulse of these.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.circus_tent import Act, Trick

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 45, 252
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = float(np.sqrt(2 - np.pi / 2))  # how sizes of noise scatter, next to a part of it
NUTTALL: Floats = np.array([0.3635819, 0.4891775, 0.1365995, 0.0106411])
LOBE = 3.6  # samples from a pulse's top to either end
AHEAD = 1.2  # samples before tops that first paths are told, as chips do
FINE = 8  # places a sample
STANDS, OF_TOP = 6.5, 0.13  # what counts: times what noise leaves; of the highest
SOONEST, EDGE = 85, 10  # samples before the highest from which on pulses count; none at ends
OWN, SKIRT, OF_SKIRT = 20, 46, 0.28  # places that are a pulse's own; in which it hides less than
MOST = 40  # pulses that are taken off
ALIKE: Floats = np.array([1.0, 0.32, -0.17, -0.2])  # noise beside itself, samples off [DW1000]
PLACES: Floats = np.arange(float(WIDE_SAMPLES))
TAPS = 8  # samples on either side of which what is between them is made


def window(part: Floats) -> Floats:
    """Return a window of four cosines, 1 amid and 0 from -1 and 1 outward [...]."""
    turn = np.pi * part[..., None] * np.arange(4)
    return np.asarray(np.where(np.abs(part) < 1.0, np.cos(turn) @ NUTTALL, 0.0))


def flashes(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return window((PLACES - top[:, None]) / LOBE)


def applause(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as ALIKE says [rows, WIDE_SAMPLES].

    Each pitch of a ring of samples has its part of the power; what is kept leaves the ring open.
    """
    long = WIDE_SAMPLES + 12
    pitch = 2 * np.pi * np.arange(long)[:, None] / long * np.arange(4)
    power = np.cos(pitch) @ (ALIKE * np.array([1.0, 2.0, 2.0, 2.0]))
    parts = rng.normal(size=(rows, 2, long))
    ring = np.fft.fft((parts[:, 0] + 1j * parts[:, 1]) * np.sqrt(power), axis=1)
    return np.asarray(ring[:, :WIDE_SAMPLES] / np.sqrt(long))


def encored(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by sines over places, in a window of cosines."""
    late = samples.clip(0.0, WIDE_SAMPLES + 2.0 * TAPS)
    whole = np.floor(late).astype(np.int64)
    away = np.arange(1 - TAPS, TAPS + 1) - (late - whole)[:, None]
    by = np.sinc(away) * window(away / (TAPS + 1.0))
    ahead = WIDE_SAMPLES + 4 * TAPS
    padded = np.pad(waves, ((0, 0), (ahead, TAPS)))
    made = np.zeros(waves.shape, np.complex128)
    for k, tap in enumerate(by.T):
        begin = ahead - whole - (k + 1 - TAPS)
        seen = np.take_along_axis(padded, begin[:, None] + np.arange(WIDE_SAMPLES), axis=1)
        made += tap[:, None] * seen
    return made


def fitting(waves: Complexes) -> Complexes:
    """Return how high pulses would be at FINE places a sample [n, FINE WIDE_SAMPLES], each alone.

    Pitches above a half are noughts.
    """
    ring = np.minimum(PLACES, WIDE_SAMPLES - PLACES)
    pulse = window(ring / LOBE)
    found = np.fft.fft(waves, axis=1) * np.fft.fft(pulse).real / np.sum(pulse**2)
    halves = np.split(found, 2, axis=1)
    noughts = np.zeros((len(waves), (FINE - 1) * WIDE_SAMPLES), np.complex128)
    return np.asarray(FINE * np.fft.ifft(np.hstack([halves[0], noughts, halves[1]]), axis=1))


def _itself() -> Floats:
    """Return how a lone pulse fits others, at places off its top up to twice its lobe."""
    reach = int(2 * LOBE * FINE)
    own = fitting(flashes(np.array([100.0])).astype(np.complex128))[0].real
    return np.asarray(own[100 * FINE - reach : 100 * FINE + reach + 1])


ITSELF = _itself()
REACH = len(ITSELF) // 2
OF_NOISE = float(fitting(applause(np.random.default_rng(2904), 60)).real[:, 90:-90].std())
"""How parts of what fits noise scatter whose own parts scatter by 1."""


def crest(sizes: Floats, top: Integers) -> Floats:
    """Return where parabolas through sizes [n, k] at tops [n] and beside these are highest [n]."""
    row, inner = np.arange(len(sizes)), top.clip(1, sizes.shape[1] - 2)
    before, amid, after = (sizes[row, inner + k] ** 2 for k in (-1, 0, 1))
    bend = np.maximum(2 * amid - before - after, 1e-300)
    return np.asarray(inner + (0.5 * (after - before) / bend).clip(-0.5, 0.5))


def _take_off(left: Complexes, bar: Floats, top: Integers, live: NDArray[np.bool_]) -> None:
    """Take a pulse at tops [n] off live rows of what fits, and let it hide what is close to it."""
    off = np.arange(-REACH, REACH + 1)
    row = np.flatnonzero(live)
    at = top[row][:, None] + off
    there = (at >= 0) & (at < left.shape[1])
    at, row = at.clip(0, left.shape[1] - 1), row[:, None]
    high = left[row, top[row]]
    left[row, at] -= there * high * ITSELF
    skirt = np.where(np.abs(off) <= OWN, np.inf, np.where(np.abs(off) <= SKIRT, OF_SKIRT, 0.0))
    bar[row, at] = np.maximum(bar[row, at], np.abs(high) * skirt)


def _soonest(fits: Complexes, sigma: Floats, deaf: float) -> Floats:
    """Return the place of the first pulse that is taken off [n]; more is asked of it if deaf."""
    sizes, place = np.abs(fits), np.arange(fits.shape[1])
    inner = (place >= EDGE * FINE) & (place < len(place) - EDGE * FINE)
    highest = (sizes * inner).argmax(axis=1)
    most = np.take_along_axis(sizes, highest[:, None], axis=1)[:, 0]
    asked = np.maximum(STANDS * OF_NOISE * sigma, OF_TOP * most) * (1 + 6.0 * deaf)
    ahead = inner & (place <= highest[:, None]) & (place >= (highest - SOONEST * FINE)[:, None])
    bar = np.where(ahead, np.minimum(asked, 0.85 * most)[:, None], np.inf)
    left, first = fits.copy(), np.full(len(fits), np.inf)
    for _ in range(MOST):
        sizes = np.abs(left)
        over = np.where(sizes > bar, sizes, 0.0)
        top = over.argmax(axis=1)
        live = over.max(axis=1) > 0.0
        if not live.any():
            break
        first = np.where(live, np.minimum(first, crest(sizes, top)), first)
        _take_off(left, bar, top, live)
    return np.where(np.isfinite(first), first, crest(np.abs(fits), highest))


def first_paths(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return places AHEAD of first pulses, in samples [n]; never sooner if deaf."""
    fits = fitting(waves)
    at = _soonest(fits, sigma, 0.0)
    if deaf > 0.0:
        at = np.maximum(at, _soonest(fits, sigma, deaf))
    return at / FINE - AHEAD


ALL = (-5.0, 104.0)  # samples after first paths between which all energy is
FIRST = 1.7  # samples by which the first path's energy is weighed, as a bell


def _weighed(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return the energy of all and of the first path, less noise's [2, n]."""
    off = PLACES - at[:, None]
    energy = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    bell = np.exp(-0.5 * ((off - AHEAD) / (0.5 * FIRST)) ** 2)
    inside = (off > ALL[0]) & (off < ALL[1])
    return np.stack([np.sum(inside * energy, axis=1),
                     np.sum(bell * energy, axis=1) / bell.sum(axis=1)])  # fmt: skip


def _alone() -> Floats:
    """Return both energies of lone pulses of height 1 [2, 1]."""
    tops = 96.0 + np.arange(24) / 24
    both = _weighed(flashes(tops).astype(np.complex128), tops - AHEAD, np.zeros(24))
    return np.asarray(both.mean(axis=1, keepdims=True))


ALONE = _alone()


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> Floats:
    """Return all that comes and what comes first in dB of a lone pulse of height 1 [2, n]."""
    every, first = _weighed(waves, at, sigma) / ALONE
    first = np.maximum(first, 0.35 * sigma**2)
    return np.asarray(10 * np.log10(np.stack([np.maximum(every, 1.03 * first), first])))


class Lamp:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `told_noise`, `told_count` [n]: factors of what is told;
    `late_m` [n]: what ranges alone get; `deaf`: see `_soonest`.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.rows = table, case, rng, len(table)
        self.plain: Complexes = np.stack([*table["cir_i"]]) + 1j * np.stack([*table["cir_q"]])
        self.wave: Complexes = self.plain
        self.hush: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma: Floats = self.hush
        self.told_noise: Floats = np.ones(self.rows)
        self.told_count: Floats = np.ones(self.rows)
        self.late_m: Floats = np.zeros(self.rows)
        self.deaf = 0.0
        self.at = first_paths(self.plain, self.hush)
        self.since: Floats = PLACES - self.at[:, None]

    def act(self) -> Act:
        """Return the rows as they are told by now."""
        return Act(self.told(), self.case, self.rng)

    def fixed(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 2905, what])

    def past(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later, by a cosine [n, k]."""
        part = ((self.since - samples) / within).clip(0.0, 1.0)
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * part))

    def by_air(self) -> Complexes:
        """Return what came by air [n, k]: what is no larger than noise is left out, softly."""
        over = np.abs(self.wave) / (3.5 * self.sigma[:, None])
        return np.asarray(self.wave * self.past(-5.5) * over**4 / (1 + over**4))

    def first(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.past(-5.5) - self.past(4.2, 3.0)

    def height(self) -> Floats:
        """Return how high first pulses are [n]."""
        return np.asarray((np.abs(self.wave) * (np.abs(self.since - AHEAD) < 1.7)).max(axis=1))

    def any_phase(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def again(self, what: Complexes, part: Floats | Complexes, samples: Floats) -> None:
        """Let a part [n] of something [n, k] come again, so many samples later [n]."""
        self.wave = self.wave + part[:, None] * encored(what, samples)

    def add_noise(self, sigma: Floats) -> None:
        """Have more noise, whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * applause(self.rng, self.rows)

    def dim(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the lamp's own noise stays."""
        left = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * left
        self.add_noise(self.sigma[:, None] * np.sqrt(1 - left**2))

    def drown(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (np.maximum(db, 0.0) / 20)
        self.add_noise((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.told_noise = self.sigma * by, self.told_noise * by

    def miss(self, db: Floats) -> None:
        """Count fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        part = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * part[:, None]
        self.add_noise((self.sigma * np.sqrt(part - part**2))[:, None])
        self.sigma, self.told_noise = self.sigma * part**0.5, self.told_noise * part**0.5
        self.told_count = self.told_count * part

    def bear(self, trick: Trick) -> None:
        """Let waveforms bear what rows do."""
        told = (trick.late_m, trick.all_db, trick.first_db, trick.noise_db, trick.count_db)
        late, every, first, noise, count = np.stack(
            [np.zeros(self.rows) + np.asarray(one, np.float64) for one in told]
        )
        self.late_m = self.late_m + late
        if np.any(every) or np.any(first):
            self.dim(self.past(-5.5) * every[:, None] + self.first() * first[:, None])
        if np.any(noise):
            self.drown(noise)
        if np.any(count):
            self.miss(count)

    def told(self) -> pd.DataFrame:
        """Return the table as the lamp tells it by now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        moved = first_paths(self.wave, self.sigma, self.deaf) - self.at
        index = np.clip(was + moved, 6.0, WIDE_SAMPLES - 8.0)
        error = self.table["error_m"].to_numpy(np.float64) + METRES * moved + self.late_m
        levels = levels_db(self.wave, index, self.sigma) - levels_db(self.plain, was, self.hush)
        every, first = levels - 20 * np.log10(self.told_count)
        return self.table.assign(
            first_path_index=index,
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + every,
            first_path_power_dbm=self.table["first_path_power_dbm"] + first,
            noise_std=self.table["noise_std"] * self.told_noise,
            preamble_count=self.table["preamble_count"] * self.told_count,
            cir_i=[*self.wave.real],
            cir_q=[*self.wave.imag],
        )
