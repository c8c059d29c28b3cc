"""The tunnel's receiver: waveforms on their way to it, and what it notes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.tunnel_effects import Ledger

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 30, 214
SAMPLE_M = 0.30027  # of light, in 1.0016 ns
SPREAD_OF_SIZE = 0.65514  # of noise whose components scatter by 1
STANDS_OUT, OF_HIGHEST = 7.0, 0.13  # scatters of a component; share of the highest
EARLIER = 1.25  # samples from the index to the first maximum
SYMBOL, ROLL_OFF = 1.95, 0.75  # of the raised cosine, the first in samples


def _raised_cosine(gap: Floats) -> Floats:
    """Return a raised cosine's impulse response at times in samples."""
    ratio = gap / SYMBOL
    below = 1 - np.square(2 * ROLL_OFF * ratio)
    below = np.where(np.abs(below) < 1e-9, 1e-9, below)
    return np.asarray(np.sinc(ratio) * np.cos(np.pi * ROLL_OFF * ratio) / below)


FINE = np.arange(-16, 16.001, 1 / 61)  # never where the response is 0/0
FINE_RESPONSE = _raised_cosine(FINE)


def responses(middle: Floats) -> Floats:
    """Return pulses of height 1 [n, k] around middles in samples [n]."""
    gap = np.arange(WIDE_SAMPLES) - middle[:, None]
    return np.asarray(np.interp(gap, FINE, FINE_RESPONSE, left=0.0, right=0.0))


def postponed(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]; what comes after the end is lost."""
    wide = WIDE_SAMPLES + 106
    turn = np.outer(np.minimum(samples, 104.0), np.fft.fftfreq(wide))
    spectrum = np.fft.fft(waves, wide, axis=1) * np.exp(-2j * np.pi * turn)
    return np.asarray(np.fft.ifft(spectrum, axis=1)[:, :WIDE_SAMPLES])


def first_maximum(waves: Complexes, limit: Floats) -> Floats:
    """Return where the index of first paths is, in samples [n].

    Before the first maximum above `limit` [n], found between samples by a parabola in dB.
    """
    size = np.abs(waves)
    highest = size.max(axis=1)
    over = size >= np.clip(limit, OF_HIGHEST * highest, 0.85 * highest)[:, None]
    over[:, :3], over[:, -8:] = False, False
    top = (size >= np.roll(size, 1, axis=1)) & (size > np.roll(size, -1, axis=1)) & over
    first = np.where(top.any(axis=1), top.argmax(axis=1), np.clip(size.argmax(axis=1), 3, None))
    rows = np.arange(len(size))
    at = [np.log(size[rows, np.minimum(first + k, WIDE_SAMPLES - 1)] + 1e-6) for k in (-1, 0, 1)]
    bent = np.minimum(at[0] - 2 * at[1] + at[2], -1e-6)
    return np.asarray(first + np.clip(0.5 * (at[0] - at[2]) / bent, -0.5, 0.5) - EARLIER)


def decibels(waves: Complexes, index: Floats) -> dict[str, Floats]:
    """Return the energy of whole waveforms and of three samples of the first path, in dB [n]."""
    energy = np.square(waves.real) + np.square(waves.imag)
    begin = np.clip(np.floor(index).astype(np.intp), 0, WIDE_SAMPLES - 4)
    rows = np.arange(len(energy))
    three = energy[rows, begin + 1] + energy[rows, begin + 2] + energy[rows, begin + 3]
    both = {"rx_power_dbm": energy.sum(axis=1), "first_path_power_dbm": three}
    return {name: 10 * np.log10(value + 1e-9) for name, value in both.items()}


class Probe:
    """Waveforms of rows, to be changed; `notes` says what is logged of them.

    `sigma` [n] is how much a component of noise scatters now; `noise_factor` and `share` [n] are
    factors of the logged noise and of the symbols; `unseen_m` [n] is not seen in waveforms;
    `alert` multiplies what the first path has to stand out by.
    """

    def __init__(self, table: pd.DataFrame, case: int, rng: np.random.Generator) -> None:
        self.table, self.case, self.rng, self.alert = table, case, rng, 1.0
        self.given: Complexes = np.vstack([*table["cir_i"]]) + 1j * np.vstack([*table["cir_q"]])
        self.waves, self.rows = self.given.copy(), len(table)
        self.sigma = table["noise_std"].to_numpy(np.float64) / SPREAD_OF_SIZE
        self.noise_factor, self.share = np.ones((2, self.rows))
        self.unseen_m = np.zeros(self.rows)
        self.arrival = first_maximum(self.given, STANDS_OUT * self.sigma)
        self.since: Floats = np.arange(WIDE_SAMPLES) - self.arrival[:, None]

    def ledger(self) -> Ledger:
        """Return a ledger of the rows as they would be noted now."""
        return Ledger(self.notes(), self.case, self.rng)

    def kept(self, purpose: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([614, self.case, purpose])

    def arriving(self) -> Complexes:
        """Return waveforms without noise: all before the first path, and what is small after it.

        The probe adds it to what has arrived already, feeder and all.
        """
        power = np.square(np.abs(self.waves) / self.sigma[:, None])
        kept = np.clip((power - 9.5) / (power + 1), 0, 0.5) / 0.5
        return np.where(self.since > -7, self.waves * kept, 0)

    def height(self) -> Floats:
        """Return how high the first path is [n]."""
        near = np.abs(self.since - EARLIER) < 2
        return np.asarray(np.max(np.abs(self.waves) * near, axis=1))

    def phases(self) -> Complexes:
        """Return one phase of each row [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(-np.pi, np.pi, self.rows)))

    def noise(self, scatter: Floats) -> Complexes:
        """Return white noise of components that scatter so much [n, 1] or [n, k]."""
        parts = self.rng.standard_normal((2, self.rows, WIDE_SAMPLES))
        return np.asarray(scatter * (parts[0] + 1j * parts[1]))

    def amplify(self, gain: Floats) -> None:
        """Multiply what arrives by gains [n, k], and keep the noise as it is."""
        missing = np.sqrt(np.clip(1 - np.square(gain), 0, 1))
        self.waves = self.waves * gain + self.noise(missing * self.sigma[:, None])

    def add_noise(self, db: Floats) -> None:
        """Let noise be stronger by dB >= 0 [n]."""
        factor = 10 ** (db / 20)
        self.waves = self.waves + self.noise((self.sigma * np.sqrt(factor**2 - 1))[:, None])
        self.sigma, self.noise_factor = self.sigma * factor, self.noise_factor * factor

    def stop_early(self, part: Floats) -> None:
        """Sum up a part <= 1 of the symbols [n], of which noise grows with the root."""
        lacking = self.sigma * np.sqrt(part - part**2)
        self.waves = self.waves * part[:, None] + self.noise(lacking[:, None])
        self.sigma, self.share = self.sigma * np.sqrt(part), self.share * part
        self.noise_factor = self.noise_factor * np.sqrt(part)

    def settle(self, ledger: Ledger) -> None:
        """Let what is booked on rows happen to their waveforms."""
        self.unseen_m = self.unseen_m + ledger.metres
        if ledger.db.any() or ledger.first_db.any():
            begun = np.clip((self.since + 7) / 3, 0, 1)
            early = 1 / (1 + np.exp(1.8 * (self.since - 6.2)))
            loss = ledger.db[:, None] + early * ledger.first_db[:, None]
            self.amplify(10 ** (begun * loss / 20))
        if ledger.noise_db.any():
            self.add_noise(ledger.noise_db)
        if (ledger.symbols < 1).any():
            self.stop_early(ledger.symbols)

    def notes(self) -> pd.DataFrame:
        """Return the table with what the receiver notes of the waveforms as they are."""
        late = first_maximum(self.waves, STANDS_OUT * self.alert * self.sigma) - self.arrival
        was = self.table["first_path_index"].to_numpy(np.float64)
        index = np.clip(was + late, 1.0, WIDE_SAMPLES - 7.0)
        error = self.table["error_m"] + self.unseen_m + SAMPLE_M * late
        old, new = decibels(self.given, was), decibels(self.waves, index)
        per_symbol = 20 * np.log10(self.share)
        levels = {name: self.table[name] + new[name] - old[name] - per_symbol for name in new}
        return self.table.assign(
            cir_i=list(self.waves.real), cir_q=list(self.waves.imag), first_path_index=index,
            range_m=self.table["true_range_m"] + error, error_m=error,
            noise_std=self.table["noise_std"] * self.noise_factor,
            preamble_count=self.table["preamble_count"] * self.share, **levels,
        )  # fmt: skip
