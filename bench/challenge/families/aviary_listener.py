"""The aviary's receiver: what happens to waveforms, and what a nestbox's listener makes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. First paths are where
two gates are in balance, as radars track by a split gate (Skolnik 2001): what comes within a late
gate has just no longer BALANCE times the energy of what came within an early one.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.aviary_grounds import Change, Watch

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 36, 230
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = 0.655136  # how sizes of noise scatter, next to a part of it (Rayleigh)
HALF_LONG, SHAPE = 3.7, 11.6  # of pulses: samples to either end, and Kaiser's parameter
FINER = 8  # places a sample in which gates are moved
GATE, BALANCE = 2.0, 4.2  # samples that a gate is open; energies, late to early
LEANS_BACK = 4.0  # samples before a top in which gates are balanced
SURE, SHARE = 6.6, 0.105  # of first tops: times a part's scatter; of the largest size
NOT_SOONER = 84  # samples before the largest: nothing sooner is a first path
TAU = (1.0, 0.32, -0.17, -0.2)  # noise next to itself after none to three samples [DW1000]
TICKS: Floats = np.arange(float(WIDE_SAMPLES))


def bell(off: Floats) -> Floats:
    """Return pulses of height 1 at samples off their tops: Kaiser's window (1974)."""
    inside = np.sqrt((1 - (off / HALF_LONG) ** 2).clip(0.0))
    return np.asarray(np.i0(SHAPE * inside) / np.i0(SHAPE) * (np.abs(off) < HALF_LONG))


def calls(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return bell(TICKS - top[:, None])


def _regression() -> tuple[Floats, float]:
    """Return by how much noise follows its last three samples, and what is new (Yule, Walker)."""
    alike = np.array([[TAU[abs(i - j)] for j in range(3)] for i in range(3)])
    follows = np.linalg.solve(alike, np.array(TAU[1:]))
    return follows, float(np.sqrt(1 - follows @ np.array(TAU[1:])))


def murmur(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, alike as TAU says [rows, WIDE_SAMPLES]."""
    follows, new = _regression()
    settles = 48
    made = new * (rng.normal(size=(WIDE_SAMPLES + settles, rows, 2)) @ np.array([1.0, 1.0j]))
    for k in range(3, len(made)):
        made[k] += follows[0] * made[k - 1] + follows[1] * made[k - 2] + follows[2] * made[k - 3]
    return np.asarray(made[settles:].T)


def deferred(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: whole ones by their places, parts by phases."""
    whole = np.floor(np.clip(samples, 0.0, WIDE_SAMPLES)).astype(np.int64)
    part = np.clip(samples, 0.0, WIDE_SAMPLES) - whole
    padded = np.pad(waves, ((0, 0), (0, 64)))
    turn = np.exp(-2j * np.pi * np.fft.fftfreq(padded.shape[1]) * part[:, None])
    moved = np.fft.ifft(np.fft.fft(padded, axis=1) * turn, axis=1)[:, :WIDE_SAMPLES]
    place = np.arange(WIDE_SAMPLES) - whole[:, None]
    return np.asarray(np.where(place < 0, 0.0, np.take_along_axis(moved, place.clip(0), axis=1)))


def dense(waves: Complexes) -> Floats:
    """Return sizes at FINER places a sample [n, FINER WIDE_SAMPLES]."""
    spectrum = np.fft.fftshift(np.fft.fft(waves, axis=1), axes=1)
    more = (FINER - 1) * WIDE_SAMPLES // 2
    wide = np.fft.ifftshift(np.pad(spectrum, ((0, 0), (more, more))), axes=1)
    return np.asarray(FINER * np.abs(np.fft.ifft(wide, axis=1)))


def _tops(size: Floats, sigma: Floats, drowsy: float) -> Integers:
    """Return at which fine places first pulses have their tops [n]; sizes [n, k].

    Of all tops next before the largest size, or at it, the first that stands out: of noise,
    `sigma` [n] of a part, and as a share of the largest. What is drowsy asks for more of both.
    """
    edge = 10 * FINER
    largest = edge + size[:, edge:-edge].argmax(axis=1)
    most = size[np.arange(len(size)), largest]
    asks = np.maximum(SURE * sigma, SHARE * most) * (1 + 3.6 * drowsy)
    place = np.arange(1, size.shape[1] - 1)
    stands = size[:, 1:-1] >= np.minimum(asks, 0.85 * most)[:, None]
    stands &= (size[:, 1:-1] >= size[:, :-2]) & (size[:, 1:-1] > size[:, 2:])
    stands &= (place <= largest[:, None]) & (place >= largest[:, None] - NOT_SOONER * FINER)
    stands &= place >= edge
    return np.asarray(np.where(stands.any(axis=1), 1 + stands.argmax(axis=1), largest), np.int64)


def balanced(size: Floats, top: Integers, finer: int = FINER) -> Floats:
    """Return, in samples [n], where gates are in balance last before tops [n]; sizes [n, k].

    A second pulse within the late gate holds the balance up, at most to shortly before the top.
    """
    gate, back = round(GATE * finer), round(LEANS_BACK * finer)
    place = top[:, None] + np.arange(-back, 1)
    sums = np.cumsum(np.pad(size**2, ((0, 0), (1, 0))), axis=1)
    now, then, soon = (
        np.take_along_axis(sums, (place + by).clip(0, size.shape[1]), axis=1)
        for by in (0, -gate, gate)
    )
    over = np.log((soon - now).clip(1e-30) / (BALANCE * (now - then)).clip(1e-30))
    last = back - (over[:, ::-1] >= 0).argmax(axis=1)
    last = np.where((over >= 0).any(axis=1), last, 0).clip(0, back - 1)
    rows = np.arange(len(size))
    high, low = over[rows, last], over[rows, last + 1]
    part = (high / np.maximum(high - low, 1e-12)).clip(0.0, 1.0)
    return np.asarray(np.minimum(place[rows, last] + part, top - 0.3 * finer) / finer)


def arrivals(waves: Complexes, sigma: Floats, drowsy: float = 0.0) -> Floats:
    """Return where first pulses are on their way up, in samples [n]; never sooner if drowsy."""
    size = dense(waves)
    keen = balanced(size, _tops(size, sigma, 0.0))
    return np.maximum(keen, balanced(size, _tops(size, sigma, drowsy))) if drowsy else keen


def _energies(waves: Complexes, at: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Return the energy of 104 samples from arrivals on, and of the first pulse alone [n]."""
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    since = TICKS - at[:, None]
    whole = (since + 3.5).clip(0.0, 1.0) * (100.5 - since).clip(0.0, 1.0)
    first = (since + 1.5).clip(0.0, 1.0) * (3.5 - since).clip(0.0, 1.0)
    return (power * whole).sum(axis=1), (power * first).sum(axis=1)


def _lone() -> tuple[float, float, float]:
    """Return, for lone pulses: samples from arrivals to tops, energies of all and of the first."""
    tops = 70 + np.linspace(0.0, 1.0, 81)
    waves, quiet = calls(tops).astype(np.complex128), np.zeros(81)
    at = arrivals(waves, quiet)
    whole, first = _energies(waves, at, quiet)
    return float((tops - at).mean()), float(whole.mean()), float(first.mean())


UP, OF_ALL, OF_FIRST = _lone()


def loudness_db(waves: Complexes, at: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Return, in dB of a lone pulse of height 1, all that comes and what comes first [n]."""
    whole, first = _energies(waves, at, sigma)
    early = np.maximum(first / OF_FIRST, 0.5 * sigma**2)
    return 10 * np.log10(np.maximum(whole / OF_ALL, 1.01 * early)), 10 * np.log10(early)


class Listener:
    """Waveforms of rows, and what becomes of them step by step.

    `sigma` [n]: of a part of noise by now; `noise_by`, `count_by` [n]: factors of what is told of
    noise and counts; `ranges_m` [n]: what ranges alone get; `drowsy`: see `_tops`.
    """

    def __init__(self, table: pd.DataFrame, stable: int, rng: np.random.Generator) -> None:
        self.table, self.stable, self.rng, self.rows = table, stable, rng, len(table)
        parts = [np.stack(list(table[name])).astype(np.float64) for name in ("cir_i", "cir_q")]
        self.begun: Complexes = parts[0] + 1j * parts[1]
        self.wave: Complexes = self.begun.copy()
        self.sigma_begun: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.sigma_begun.copy()
        self.noise_by, self.count_by = np.ones(self.rows), np.ones(self.rows)
        self.ranges_m, self.drowsy = np.zeros(self.rows), 0.0
        self.at = arrivals(self.begun, self.sigma_begun)
        self.since: Floats = TICKS - self.at[:, None]

    def watch(self) -> Watch:
        """Return the rows as they are told by now."""
        return Watch(self.told(), self.stable, self.rng)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.stable, 2106, what])

    def after(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples after arrivals, 1 a little later [n, k]: a cubic."""
        part = ((self.since - samples) / within).clip(0.0, 1.0)
        return np.asarray(part**2 * (3 - 2 * part))

    def heard(self) -> Complexes:
        """Return what comes by air [n, k]: noise is shrunk away (James and Stein 1961)."""
        quiet = 9.0 * self.sigma[:, None] ** 2
        kept = (1 - quiet / (np.abs(self.wave) ** 2).clip(1e-12)).clip(0.0)
        return np.asarray(self.wave * kept * self.after(-5.0))

    def first(self) -> Floats:
        """Return 1 as long as first pulses last, else 0 [n, k]."""
        return self.after(-5.0) * (1 - self.after(5.0, 2.5))

    def tall(self) -> Floats:
        """Return how high first pulses are [n]."""
        near = np.abs(self.since - UP) < 1.6
        return np.asarray(np.where(near, np.abs(self.wave), 0.0).max(axis=1))

    def whirled(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def repeat(self, what: Complexes, share: Floats | Complexes, samples: Floats) -> None:
        """Let a share [n] of something [n, k] come once more, so many samples later [n]."""
        self.wave = self.wave + share[:, None] * deferred(what, samples)

    def hiss(self, sigma: Floats) -> None:
        """Add noise whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * murmur(self.rng, self.rows)

    def fade(self, db: Floats) -> None:
        """Let what comes fade by dB <= 0 [n, k]; the listener's own noise does not."""
        left = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * left
        self.hiss(self.sigma[:, None] * np.sqrt(1 - left**2))

    def louder_noise(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (db.clip(0.0) / 20)
        self.hiss((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.noise_by = self.sigma * by, self.noise_by * by

    def fewer(self, db: Floats) -> None:
        """Add up fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        part = 10 ** (db.clip(max=0.0) / 20)
        self.wave = self.wave * part[:, None]
        self.hiss((self.sigma * np.sqrt(part * (1 - part)))[:, None])
        root = np.sqrt(part)
        self.sigma, self.noise_by = self.sigma * root, self.noise_by * root
        self.count_by = self.count_by * part

    def undergo(self, change: Change) -> None:
        """Let waveforms undergo what becomes of rows."""
        self.ranges_m = self.ranges_m + change.metres
        every, early = (np.zeros(self.rows) + db for db in (change.all_db, change.first_db))
        if every.any() or early.any():
            self.fade(self.after(-5.0) * every[:, None] + self.first() * early[:, None])
        if np.any(change.noise_db):
            self.louder_noise(np.zeros(self.rows) + change.noise_db)
        if np.any(change.count_db):
            self.fewer(np.zeros(self.rows) + change.count_db)

    def told(self) -> pd.DataFrame:
        """Return the table as the listener tells it by now."""
        later = arrivals(self.wave, self.sigma, self.drowsy) - self.at
        first = self.table["first_path_index"].to_numpy(np.float64)
        index = (first + later).clip(6.0, WIDE_SAMPLES - 8.0)
        now = loudness_db(self.wave, index, self.sigma)
        begun = loudness_db(self.begun, first, self.sigma_begun)
        less_db = 20 * np.log10(self.count_by)
        error = self.table["error_m"] + METRES * later + self.ranges_m
        return self.table.assign(
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + now[0] - begun[0] - less_db,
            first_path_power_dbm=self.table["first_path_power_dbm"] + now[1] - begun[1] - less_db,
            first_path_index=index,
            noise_std=self.table["noise_std"] * self.noise_by,
            preamble_count=self.table["preamble_count"] * self.count_by,
            cir_i=list(self.wave.real),
            cir_q=list(self.wave.imag),
        )
