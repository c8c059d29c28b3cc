"""The bowls green's receiver: what happens to waveforms, and what a knot's dial makes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. First paths are where
sizes, once a bell has smoothed them, bend down most, as blobs are found (Lindeberg 1998).
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.bowls_rinks import Change, End

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 40, 244
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = 0.655136  # how sizes of noise scatter, next to a part of it (Rayleigh)
HALF = 3.4  # samples from a pulse's top to either end
AHEAD = 1.2  # samples before tops that first paths are told, as chips do
FINE = 6  # places a sample in which bends are seen
BELL = 0.75  # samples: how wide sizes are smoothed
STANDS, OF_MOST = 6.6, 0.14  # what bends count: times noise's scatter; of the strongest
BEFORE, EDGE = 86, 9  # samples before the strongest in which bends are looked for; left out at ends
NEXT_TO = (0.32, -0.17, -0.2)  # noise beside itself, one to three samples off [DW1000]
PLACES: Floats = np.arange(float(WIDE_SAMPLES))


def humped(off: Floats) -> Floats:
    """Return pulses of height 1 at samples off their tops: fourth powers of a cosine."""
    return np.asarray(np.cos(0.5 * np.pi * (off / HALF).clip(-1.0, 1.0)) ** 4)


def pulses(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return humped(PLACES - top[:, None])


def rush(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as NEXT_TO says [rows, WIDE_SAMPLES]."""
    alike = np.zeros(WIDE_SAMPLES)
    alike[0] = 1.0
    for k, by in enumerate(NEXT_TO, 1):
        alike[k] = alike[-k] = by
    power = np.fft.fft(alike).real.clip(0.0)
    white = rng.standard_normal((rows, WIDE_SAMPLES, 2)).view(np.complex128)[..., 0]
    return np.asarray(np.fft.ifft(np.sqrt(power) * np.fft.fft(white, axis=1), axis=1))


def retarded(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by phases of what they are made of.

    Room for what leaves at the end is made, so that nothing comes back at the beginning.
    """
    long = 768  # past whatever comes, and soon transformed
    late = samples.clip(0.0, 2.0 * WIDE_SAMPLES)[:, None]
    spectrum = np.fft.fft(waves, long, axis=1) * np.exp(-2j * np.pi * np.fft.fftfreq(long) * late)
    return np.asarray(np.fft.ifft(spectrum, axis=1)[:, :WIDE_SAMPLES])


def sized_finely(waves: Complexes) -> Floats:
    """Return sizes at FINE places a sample [n, FINE WIDE_SAMPLES]."""
    count, half = WIDE_SAMPLES, WIDE_SAMPLES // 2
    spectrum = np.fft.fft(waves, axis=1)
    gap = np.zeros((len(waves), (FINE - 1) * count))
    wide = np.concatenate([spectrum[:, :half], gap, spectrum[:, half:]], axis=1)
    return np.asarray(np.abs(np.fft.ifft(FINE * wide, axis=1)))


def bending(size: Floats, step: float) -> Floats:
    """Return how sizes bend down, smoothed by a bell [n, k]; places are `step` samples apart."""
    reach = int(4.5 * BELL / step)
    off = step * np.arange(-reach, reach + 1)
    taps = (1 - (off / BELL) ** 2) * np.exp(-0.5 * (off / BELL) ** 2)
    taps = taps - taps.mean()
    taps /= -0.5 * (off**2 * taps).sum()
    long = size.shape[1] + 2 * reach
    bent = np.fft.irfft(np.fft.rfft(size, long, axis=1) * np.fft.rfft(taps, long), long, axis=1)
    return np.asarray(bent[:, reach : reach + size.shape[1]])


def summit(values: Floats, place: Integers) -> Floats:
    """Return where parabolas through places and both beside these are highest, in places [n]."""
    inner = place.clip(1, values.shape[1] - 2)
    near = np.take_along_axis(values, inner[:, None] + np.arange(-1, 2), axis=1)
    bend = np.minimum(near[:, 0] - 2 * near[:, 1] + near[:, 2], -1e-12)
    return np.asarray(inner + (0.5 * (near[:, 0] - near[:, 2]) / bend).clip(-1.0, 1.0))


def _noise_bends() -> float:
    """Return how bends of noise's sizes scatter, next to a part of noise."""
    some = sized_finely(rush(np.random.default_rng(2404), 80))
    return float(bending(some, 1 / FINE)[:, 60:-60].std())


OF_NOISE = _noise_bends()


def _first_bends(bend: Floats, sigma: Floats, deaf: float) -> Integers:
    """Return at which fine places first bends that count are strongest [n]; bends [n, k].

    These stand out of noise, whose parts scatter by `sigma` [n], and are a part of the strongest.
    What is deaf asks for more of both.
    """
    place, edge = np.arange(bend.shape[1]), EDGE * FINE
    strongest = edge + bend[:, edge:-edge].argmax(axis=1)
    most = np.take_along_axis(bend, strongest[:, None], axis=1)
    asked = np.maximum(STANDS * OF_NOISE * sigma[:, None], OF_MOST * most) * (1 + 5.0 * deaf)
    counts = bend >= np.minimum(asked, 0.85 * most)
    counts[:, 1:-1] &= (bend[:, 1:-1] > bend[:, :-2]) & (bend[:, 1:-1] >= bend[:, 2:])
    counts &= place >= np.maximum(strongest - BEFORE * FINE, edge)[:, None]
    return np.asarray(counts.argmax(axis=1), np.int64)


def first_paths(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return AHEAD of where first pulses bend most, in samples [n]; never sooner if deaf."""
    bend = bending(sized_finely(waves), 1 / FINE)
    at = summit(bend, _first_bends(bend, sigma, 0.0))
    if deaf:
        at = np.maximum(at, summit(bend, _first_bends(bend, sigma, deaf)))
    return np.asarray(at / FINE - AHEAD)


def _energies(waves: Complexes, at: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Return the energy of 108 samples about and after first paths, and of first pulses [n]."""
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    since = PLACES - at[:, None]

    def within(begin: float, end: float) -> Floats:
        inside = np.minimum(since - begin, end - since) + 0.5
        return np.asarray((inside.clip(0.0, 1.0) * power).sum(axis=1))

    return within(-2.5, 105.5), within(-0.6, 2.9)


def _of_one() -> tuple[float, float]:
    """Return the energies of all, and of the first pulse, of lone pulses of height 1."""
    tops, none = 70 + np.linspace(0.0, 1.0, 49), np.zeros(49)
    waves = pulses(tops).astype(np.complex128)
    whole, first = _energies(waves, first_paths(waves, none), none)
    return float(whole.mean()), float(first.mean())


OF_ALL, OF_FIRST = _of_one()


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Return, in dB of a lone pulse of height 1, all that comes and what comes first [n]."""
    whole, first = _energies(waves, at, sigma)
    early = np.maximum(first / OF_FIRST, 0.5 * sigma**2)
    every = np.maximum(whole / OF_ALL, 1.02 * early)
    return 10 * np.log10(every), 10 * np.log10(early)


class Dial:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `told_noise`, `told_count` [n]: factors of what is told
    of noise and counts; `aside_m` [n]: what ranges alone get; `deaf`: see `_first_bends`.
    """

    def __init__(self, table: pd.DataFrame, stable: int, rng: np.random.Generator) -> None:
        self.table, self.stable, self.rng, self.rows = table, stable, rng, len(table)
        real, imag = (np.stack([*table[part]]).astype(np.float64) for part in ("cir_i", "cir_q"))
        self.begun: Complexes = real + 1j * imag
        self.wave: Complexes = self.begun.copy()
        self.sigma_begun: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma: Floats = self.sigma_begun.copy()
        self.told_noise, self.told_count = np.ones(self.rows), np.ones(self.rows)
        self.aside_m, self.deaf = np.zeros(self.rows), 0.0
        self.at = first_paths(self.begun, self.sigma_begun)
        self.since: Floats = PLACES - self.at[:, None]

    def end(self) -> End:
        """Return the rows as they are told by now."""
        return End(self.told(), self.stable, self.rng)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.stable, 2405, what])

    def past(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 some later, by a sine [n, k]."""
        part = ((self.since - samples) / within).clip(0.0, 1.0)
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * part))

    def by_air(self) -> Complexes:
        """Return what comes by air [n, k]: what is no larger than noise is left out, softly."""
        over = (np.abs(self.wave) / (4.2 * self.sigma[:, None])) ** 6
        return np.asarray(self.wave * self.past(-5.0) * over / (1 + over))

    def straight(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.past(-5.0) * (1 - self.past(4.7, 2.4))

    def heights(self) -> Floats:
        """Return how high first pulses are [n]."""
        near = np.abs(self.since - AHEAD) < 1.8
        return np.asarray((np.abs(self.wave) * near).max(axis=1))

    def turns(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def echo(self, what: Complexes, share: Floats | Complexes, samples: Floats) -> None:
        """Let a share [n] of something [n, k] come again, so many samples later [n]."""
        self.wave = self.wave + share[:, None] * retarded(what, samples)

    def add_noise(self, sigma: Floats) -> None:
        """Add noise whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * rush(self.rng, self.rows)

    def lose(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the dial's own noise stays."""
        left = 10 ** (db.clip(max=0.0) / 20)
        self.wave = self.wave * left
        self.add_noise(self.sigma[:, None] * np.sqrt(1 - left**2))

    def be_noisy(self, db: Floats) -> None:
        """Have dB >= 0 more noise [n]."""
        by = 10 ** (db.clip(0.0) / 20)
        self.add_noise((self.sigma * np.sqrt(by**2 - 1))[:, None])
        self.sigma, self.told_noise = self.sigma * by, self.told_noise * by

    def count_fewer(self, db: Floats) -> None:
        """Count fewer symbols, by dB <= 0 [n]: signals lose as much, noise half of it."""
        part = 10 ** (db.clip(max=0.0) / 20)
        self.wave = self.wave * part[:, None]
        self.add_noise((self.sigma * np.sqrt(part * (1 - part)))[:, None])
        self.sigma, self.told_noise = self.sigma * part**0.5, self.told_noise * part**0.5
        self.told_count = self.told_count * part

    def take(self, change: Change) -> None:
        """Let waveforms take what becomes of rows."""
        none = np.zeros(self.rows)
        self.aside_m = self.aside_m + change.metres
        every, early = none + change.all_db, none + change.first_db
        if every.any() or early.any():
            self.lose(self.past(-5.0) * every[:, None] + self.straight() * early[:, None])
        if np.any(change.noise_db):
            self.be_noisy(none + change.noise_db)
        if np.any(change.count_db):
            self.count_fewer(none + change.count_db)

    def told(self) -> pd.DataFrame:
        """Return the table as the dial tells it by now."""
        later = first_paths(self.wave, self.sigma, self.deaf) - self.at
        first = self.table["first_path_index"].to_numpy(np.float64)
        index = (first + later).clip(6.0, WIDE_SAMPLES - 8.0)
        now = levels_db(self.wave, index, self.sigma)
        then = levels_db(self.begun, first, self.sigma_begun)
        counts_db = 20 * np.log10(self.told_count)
        error = self.table["error_m"] + METRES * later + self.aside_m
        return self.table.assign(
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + now[0] - then[0] - counts_db,
            first_path_power_dbm=self.table["first_path_power_dbm"] + now[1] - then[1] - counts_db,
            first_path_index=index,
            noise_std=self.table["noise_std"] * self.told_noise,
            preamble_count=self.table["preamble_count"] * self.told_count,
            cir_i=list(self.wave.real),
            cir_q=list(self.wave.imag),
        )
