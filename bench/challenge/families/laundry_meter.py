"""The laundry's receiver: what happens to waveforms, and what a tag's meter makes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts. First paths are where
sizes rise most, once they are smoothed by a bell (Canny 1986), at the first such place that counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.laundry_plan import Change, Errand

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 42, 250
SAMPLE_NS = 1.0016
METRES = 0.299792458 * SAMPLE_NS  # a sample
OF_SIZES = 0.655136  # how sizes of noise scatter, next to a part of it (Rayleigh)
HALF_LONG = 3.25  # samples from a pulse's top to either end
FINE = 6  # places a sample in which rises are seen
BELL = 0.8  # samples: how wide sizes are smoothed
STANDS, OF_STEEPEST = 6.8, 0.13  # what rises count: times noise's scatter; of the steepest
BEFORE, EDGE = 90, 9  # samples before the steepest in which rises are looked for; left out at ends
NEXT_TO = (0.32, -0.17, -0.2)  # noise beside itself, one to three samples off [DW1000]
PLACES: Floats = np.arange(float(WIDE_SAMPLES))


def lobe(off: Floats) -> Floats:
    """Return pulses of height 1 at samples off their tops: fourth powers of a parabola."""
    return np.asarray((1 - (off / HALF_LONG) ** 2).clip(0.0) ** 4)


def lobes(top: Floats) -> Floats:
    """Return pulses of height 1 with tops at samples [n, WIDE_SAMPLES]."""
    return lobe(PLACES - top[:, None])


def sizzle(rng: np.random.Generator, rows: int) -> Complexes:
    """Return noise whose parts scatter by 1, beside itself as NEXT_TO says [rows, WIDE_SAMPLES]."""
    turn = 2 * np.pi * np.fft.fftfreq(WIDE_SAMPLES)
    power = 1 + 2 * sum(by * np.cos(k * turn) for k, by in enumerate(NEXT_TO, 1))
    white = rng.standard_normal((rows, WIDE_SAMPLES, 2)) @ np.array([1.0, 1.0j])
    return np.asarray(np.fft.ifft(np.sqrt(power) * np.fft.fft(white, axis=1), axis=1))


def belated(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n], between samples by Lagrange's polynomials."""
    late = samples.clip(0.0, WIDE_SAMPLES + 9.0)
    whole = np.floor(late).astype(np.int64)
    part = (late - whole)[:, None]
    knots = np.arange(-3, 5)
    padded = np.pad(waves, ((0, 0), (WIDE_SAMPLES + 16, 8)))
    begins = np.arange(WIDE_SAMPLES) + WIDE_SAMPLES + 16 - whole[:, None]
    out = np.zeros(waves.shape, np.complex128)
    for one in knots:
        others = knots[knots != one]
        by = np.prod((part - others) / (one - others), axis=1)[:, None]
        out += by * np.take_along_axis(padded, begins - one, axis=1)
    return out


def seen_finely(waves: Complexes) -> Floats:
    """Return sizes at FINE places a sample [n, FINE WIDE_SAMPLES]."""
    count, half = WIDE_SAMPLES, WIDE_SAMPLES // 2
    wide = np.zeros((len(waves), FINE * count), np.complex128)
    spectrum = np.fft.fft(waves, axis=1)
    wide[:, :half], wide[:, -half:] = spectrum[:, :half], spectrum[:, half:]
    return np.asarray(FINE * np.abs(np.fft.ifft(wide, axis=1)))


def steepness(size: Floats, step: float) -> Floats:
    """Return how sizes rise, smoothed by a bell [n, k]; places are `step` samples apart."""
    reach = int(4 * BELL / step)
    off = step * np.arange(-reach, reach + 1)
    taps = off * np.exp(-0.5 * (off / BELL) ** 2)
    taps /= (off * taps).sum()
    long = size.shape[1] + 2 * reach
    turned = np.fft.rfft(size, long, axis=1) * np.fft.rfft(taps[::-1], long)
    return np.asarray(np.fft.irfft(turned, long, axis=1)[:, reach : reach + size.shape[1]])


def crest(rise: Floats, place: Integers) -> Floats:
    """Return where parabolas through places and both beside these are highest, in places [n]."""
    rows = np.arange(len(rise))
    inner = place.clip(1, rise.shape[1] - 2)
    left, mid, right = (rise[rows, inner + k] for k in (-1, 0, 1))
    bend = np.minimum(left - 2 * mid + right, -1e-12)
    return np.asarray(inner + (0.5 * (left - right) / bend).clip(-1.0, 1.0))


def _noise_rises() -> float:
    """Return how steepness of noise scatters, next to a part of noise."""
    some = sizzle(np.random.default_rng(2304), 80)
    return float(steepness(seen_finely(some), 1 / FINE)[:, 60:-60].std())


OF_NOISE = _noise_rises()


def _first_rises(rise: Floats, sigma: Floats, deaf: float) -> Integers:
    """Return at which fine places first rises that count are steepest [n]; steepness [n, k].

    These stand out of noise, whose parts scatter by `sigma` [n], and are a part of the steepest.
    What is deaf asks for more of both.
    """
    place, edge = np.arange(rise.shape[1]), EDGE * FINE
    steepest = edge + rise[:, edge:-edge].argmax(axis=1)
    most = rise[np.arange(len(rise)), steepest]
    asked = np.maximum(STANDS * OF_NOISE * sigma, OF_STEEPEST * most) * (1 + 5.0 * deaf)
    counts = rise >= np.minimum(asked, 0.85 * most)[:, None]
    before, after = np.roll(rise, 1, axis=1), np.roll(rise, -1, axis=1)
    counts &= (rise > before) & (rise >= after)
    counts &= place >= np.maximum(steepest - BEFORE * FINE, edge)[:, None]
    return np.asarray(counts.argmax(axis=1), np.int64)


def onsets(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return where first pulses rise most, in samples [n]; never sooner if deaf."""
    rise = steepness(seen_finely(waves), 1 / FINE)
    keen = crest(rise, _first_rises(rise, sigma, 0.0)) / FINE
    if not deaf:
        return np.asarray(keen)
    return np.asarray(np.maximum(keen, crest(rise, _first_rises(rise, sigma, deaf)) / FINE))


def _energies(waves: Complexes, at: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Return the energy of 114 samples about and after onsets, and of first pulses alone [n]."""
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    since = PLACES - at[:, None]

    def within(begin: float, end: float) -> Floats:
        inside = (since - begin + 0.5).clip(0.0, 1.0) * (end - since + 0.5).clip(0.0, 1.0)
        return np.asarray((inside * power).sum(axis=1))

    return within(-3.0, 111.0), within(-0.7, 2.8)


def _of_one() -> tuple[float, float, float]:
    """Return, for lone pulses: samples from onsets to tops, energies of all and of the first."""
    tops = 70 + np.linspace(0.0, 1.0, 49)
    waves, none = lobes(tops).astype(np.complex128), np.zeros(49)
    at = onsets(waves, none)
    whole, first = _energies(waves, at, none)
    return float((tops - at).mean()), float(whole.mean()), float(first.mean())


RISE, OF_ALL, OF_FIRST = _of_one()


def levels_db(waves: Complexes, at: Floats, sigma: Floats) -> tuple[Floats, Floats]:
    """Return, in dB of a lone pulse of height 1, all that comes and what comes first [n]."""
    whole, first = _energies(waves, at, sigma)
    early = np.maximum(first / OF_FIRST, 0.5 * sigma**2)
    every = np.maximum(whole / OF_ALL, 1.02 * early)
    return 10 * np.log10(every), 10 * np.log10(early)


class Meter:
    """Waveforms of rows, and what becomes of them, one thing after another.

    `sigma` [n]: of a part of noise by now; `told_noise`, `told_count` [n]: factors of what is told
    of noise and counts; `aside_m` [n]: what ranges alone get; `deaf`: see `_first_rises`.
    """

    def __init__(self, table: pd.DataFrame, stable: int, rng: np.random.Generator) -> None:
        self.table, self.stable, self.rng, self.rows = table, stable, rng, len(table)
        parts = [np.stack([*map(np.asarray, table[name])]) for name in ("cir_i", "cir_q")]
        self.begun: Complexes = parts[0].astype(np.float64) + 1j * parts[1].astype(np.float64)
        self.wave: Complexes = self.begun.copy()
        self.sigma_begun: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma: Floats = self.sigma_begun.copy()
        self.told_noise, self.told_count = np.ones(self.rows), np.ones(self.rows)
        self.aside_m, self.deaf = np.zeros(self.rows), 0.0
        self.at = onsets(self.begun, self.sigma_begun)
        self.since: Floats = PLACES - self.at[:, None]

    def errand(self) -> Errand:
        """Return the rows as they are told by now."""
        return Errand(self.told(), self.stable, self.rng)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.stable, 2305, what])

    def after(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past onsets, 1 some later, smoothly [n, k]."""
        part = ((self.since - samples) / within).clip(0.0, 1.0)
        return np.asarray(part**2 * (3 - 2 * part))

    def heard(self) -> Complexes:
        """Return what comes by air [n, k]: what is no larger than noise is left out, softly."""
        over = (np.abs(self.wave) / (4.3 * self.sigma[:, None])) ** 6
        return np.asarray(self.wave * self.after(-5.0) * over / (1 + over))

    def direct(self) -> Floats:
        """Return 1 while first pulses last, else 0 [n, k]."""
        return self.after(-5.0) * (1 - self.after(4.8, 2.5))

    def heights(self) -> Floats:
        """Return how high first pulses are [n]."""
        near = np.abs(self.since - RISE) < 1.8
        return np.asarray((np.abs(self.wave) * near).max(axis=1))

    def phases(self) -> Complexes:
        """Return phases by chance [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.rows)))

    def repeat(self, what: Complexes, share: Floats | Complexes, samples: Floats) -> None:
        """Let a share [n] of something [n, k] come again, so many samples later [n]."""
        self.wave = self.wave + share[:, None] * belated(what, samples)

    def add_noise(self, sigma: Floats) -> None:
        """Add noise whose parts scatter by so much, [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * sizzle(self.rng, self.rows)

    def lose(self, db: Floats) -> None:
        """Let what comes change by dB <= 0 [n, k]; the meter's own noise stays."""
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

    def suffer(self, change: Change) -> None:
        """Let waveforms take what becomes of rows."""
        every, early, noise, count = (
            np.zeros(self.rows) + one
            for one in (change.all_db, change.first_db, change.noise_db, change.count_db)
        )
        self.aside_m = self.aside_m + change.metres
        if every.any() or early.any():
            self.lose(self.after(-5.0) * every[:, None] + self.direct() * early[:, None])
        if noise.any():
            self.be_noisy(noise)
        if count.any():
            self.count_fewer(count)

    def told(self) -> pd.DataFrame:
        """Return the table as the meter tells it by now."""
        later = onsets(self.wave, self.sigma, self.deaf) - self.at
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
