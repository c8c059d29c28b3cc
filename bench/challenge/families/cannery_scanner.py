"""The cannery's receiver: what waveforms meet, and what a scanner makes of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.cannery_hall import Harm, Lot

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 33, 186
METRES = 0.299792458 * 1.0016  # a sample
OF_SIZES = np.sqrt(2 - np.pi / 2)  # how sizes of noise scatter, next to its components
ABOVE, OF_LARGEST = 7.0, 0.11  # times a component's scatter; of the largest size
WIDTH = 7.0  # samples of a pulse, from nothing to nothing
RISE = 1.25  # samples from what is written as a first path to its middle
SAMPLE = np.arange(float(WIDE_SAMPLES))
TAPS = np.arange(-5, 6)  # of a delay between samples


def lobes(middle: Floats) -> Floats:
    """Return pulses of height 1 with such middles in samples [n, k]: Blackman's windows."""
    part = np.clip((SAMPLE - middle[:, None]) / WIDTH, -0.5, 0.5)
    return np.asarray(0.42 + 0.5 * np.cos(2 * np.pi * part) + 0.08 * np.cos(4 * np.pi * part))


def fizz(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1, whose spectrum is half an ellipse, [size, k]."""
    gain = np.sqrt(np.sqrt(1 - (np.fft.fftfreq(WIDE_SAMPLES) / 0.52) ** 2))
    parts = rng.standard_normal((2, size, WIDE_SAMPLES))
    made = np.fft.ifft(np.fft.fft(parts[0] + 1j * parts[1], axis=1) * gain, axis=1)
    return np.asarray(made / np.sqrt(np.mean(gain**2)))


def lagging(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: by sines over bells (Gaussian), 11 of them."""
    asked = np.clip(samples, 0.0, 110.0)
    whole = np.rint(asked).astype(np.intp)
    off = TAPS[:, None] - (asked - whole)
    weights = np.sinc(off) * np.exp(-((off / 3.2) ** 2))
    weights = weights / weights.sum(axis=0)
    room = 110 + len(TAPS)
    source = room + np.arange(waves.shape[1]) - whole[:, None]
    wide = np.pad(waves, ((0, 0), (room, room)))
    out = np.zeros_like(waves)
    for tap, weight in zip(TAPS.tolist(), weights, strict=True):
        out += weight[:, None] * np.take_along_axis(wide, source - tap, axis=1)
    return out


def found(waves: Complexes, sigma: Floats, deaf: float = 0.0) -> Floats:
    """Return where first pulses have their middles of weight, less RISE, in samples [n].

    First is what is above noise, `sigma` [n] of a component, and above a part of the largest;
    five sizes about its top weigh by their fourth powers. Deaf ones ask for more of both.
    """
    size = np.abs(waves)
    most = size.max(axis=1)
    asked = (1 + 3.7 * deaf) * np.maximum(ABOVE * sigma, OF_LARGEST * most)
    heard = np.argmax(size >= np.minimum(asked, 0.85 * most)[:, None], axis=1)
    heard = np.clip(heard, 4, WIDE_SAMPLES - 12)[:, None]
    top = heard + np.argmax(_taken(size, heard + np.arange(4)), axis=1)[:, None]
    about = top + np.arange(-2, 3)
    weight = _taken(size, about) ** 4
    return np.asarray(np.sum(weight * about, axis=1) / np.sum(weight, axis=1) - RISE)


def _taken(size: Floats, samples: NDArray[np.intp]) -> Floats:
    """Return the sizes at samples [n, any]."""
    return np.take_along_axis(size, samples, axis=1)


def gauged(waves: Complexes, index: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of all from first paths on, and that of first pulses [2, n]."""
    power = np.abs(waves) ** 2 - 2 * sigma[:, None] ** 2
    past = SAMPLE - index[:, None]
    tent = np.clip(1.6 - 0.5 * np.abs(past - RISE), 0.0, 1.0)
    first = np.maximum(np.sum(power * tent, axis=1), 1.2 * sigma**2)
    everything = np.sum(power * (past > -4.0), axis=1)
    return np.asarray(10 * np.log10([np.maximum(everything, 1.05 * first), first]))


class Scan:
    """Waveforms of a table's rows, which meet one thing after the other.

    `sigma` [n]: of a component of noise now; `noise_by`, `symbols_by` [n]: factors of what is
    written of noise and of symbols; `metres` [n]: added to ranges alone; `deaf`: see `found`.
    """

    def __init__(self, table: pd.DataFrame, shift: int, rng: np.random.Generator) -> None:
        self.table, self.shift, self.rng, self.size = table, shift, rng, len(table)
        self.before: Complexes = np.stack([*table["cir_i"]]) + 1j * np.stack([*table["cir_q"]])
        self.wave = self.before.copy()
        self.sigma_before: Floats = table["noise_std"].to_numpy(np.float64) / OF_SIZES
        self.sigma = self.sigma_before.copy()
        self.noise_by, self.symbols_by = np.ones(self.size), np.ones(self.size)
        self.metres, self.deaf = np.zeros(self.size), 0.0
        self.first = found(self.before, self.sigma_before)
        self.past: Floats = SAMPLE - self.first[:, None]

    def lot(self) -> Lot:
        """Return the rows as they are written now."""
        return Lot(self.written(), self.shift, self.rng)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([1064, self.shift, what])

    def since(self, samples: float, over: float = 1.0) -> Floats:
        """Return 0 until so many samples past first paths, 1 from `over` samples later [n, k]."""
        part = np.clip((self.past - samples) / over, 0.0, 1.0)
        return np.asarray(part * part * (3 - 2 * part))

    def signal(self) -> Complexes:
        """Return waveforms from shortly before first pulses on [n, k], if above the noise.

        That is the scanner's own: whatever stands in the hall has not heard it.
        """
        over = np.abs(self.wave) / self.sigma[:, None] - 3.6
        return np.asarray(self.wave * self.since(-4.2) * (0.5 + 0.5 * np.tanh(4 * over)))

    def first_pulse(self) -> Floats:
        """Return 1 as long as first pulses last, else 0 [n, k]."""
        return self.since(-4.2) - self.since(5.8, 2.4)

    def height(self) -> Floats:
        """Return the size of first pulses [n]."""
        near = np.abs(self.past - RISE) < 2.1
        return np.asarray(np.where(near, np.abs(self.wave), 0.0).max(axis=1))

    def phasors(self) -> Complexes:
        """Return a chance phase for each row [n]."""
        return np.asarray(np.exp(2j * np.pi * self.rng.random(self.size)))

    def add_copy(self, share: Floats | Complexes, samples: Floats, of: Complexes) -> None:
        """Add such a share [n] of waveforms [n, k], so many samples later [n]."""
        self.wave = self.wave + np.asarray(share)[:, None] * lagging(of, samples)

    def add_noise(self, sigma: Floats) -> None:
        """Add noise of such components [n, k] or [n, 1]."""
        self.wave = self.wave + sigma * fizz(self.rng, self.size)

    def scale(self, to: Floats) -> None:
        """Leave such a part of signals [n, k]; noise stays what it was."""
        self.wave = self.wave * to
        self.add_noise(self.sigma[:, None] * np.sqrt(np.clip(1 - to**2, 0.0, None)))

    def noisier(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        factor = 10 ** (np.maximum(db, 0.0) / 20)
        self.add_noise((self.sigma * np.sqrt(factor**2 - 1))[:, None])
        self.sigma = self.sigma * factor
        self.noise_by = self.noise_by * factor

    def stop_early(self, db: Floats) -> None:
        """Add up fewer symbols, by dB <= 0 [n]: noise grows with the root of their number."""
        kept = 10 ** (np.minimum(db, 0.0) / 20)
        self.wave = self.wave * kept[:, None]
        self.add_noise((self.sigma * np.sqrt(kept - kept**2))[:, None])
        self.sigma, self.noise_by = self.sigma * np.sqrt(kept), self.noise_by * np.sqrt(kept)
        self.symbols_by = self.symbols_by * kept

    def suffer(self, harm: Harm) -> None:
        """Let waveforms meet what goes wrong at their rows."""
        all_db, first_db, noise_db, symbols_db = (
            np.zeros(self.size) + one
            for one in (harm.all_db, harm.first_db, harm.noise_db, harm.symbols_db)
        )
        self.metres = self.metres + harm.metres
        if all_db.any() or first_db.any():
            down = self.since(-4.2) * all_db[:, None] + self.first_pulse() * first_db[:, None]
            self.scale(10 ** (down / 20))
        if noise_db.any():
            self.noisier(noise_db)
        if symbols_db.any():
            self.stop_early(symbols_db)

    def written(self) -> pd.DataFrame:
        """Return the table as it is written now."""
        was = self.table["first_path_index"].to_numpy(np.float64)
        moved = found(self.wave, self.sigma, self.deaf) - self.first
        index = np.clip(was + moved, 5.0, WIDE_SAMPLES - 11.0)
        louder = gauged(self.wave, index, self.sigma) - gauged(self.before, was, self.sigma_before)
        louder -= 20 * np.log10(self.symbols_by)
        error = self.table["error_m"] + METRES * moved + self.metres
        return self.table.assign(
            error_m=error,
            range_m=self.table["true_range_m"] + error,
            rx_power_dbm=self.table["rx_power_dbm"] + louder[0],
            first_path_power_dbm=self.table["first_path_power_dbm"] + louder[1],
            first_path_index=index,
            noise_std=self.table["noise_std"] * self.noise_by,
            preamble_count=self.table["preamble_count"] * self.symbols_by,
            cir_i=[*self.wave.real],
            cir_q=[*self.wave.imag],
        )
