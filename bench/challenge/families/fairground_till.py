"""The fairground's receiver: what waveforms go through, and what its till prints of them.

numpy and pandas alone. Waveforms are complex [n, WIDE_SAMPLES], in counts.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.fairground_rides import Stall, Ticket

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
WIDE_LEAD, WIDE_SAMPLES = 30, 216
METRES = 0.2997925 * 1.0016  # a sample
OF_NOISE = 0.655136  # how sizes scatter, next to components
ABOVE, SHARE = 6.3, 0.14  # times a component's scatter; of the largest size
RISES, FALLS = 0.98, 1.3  # scatters of the bell's two halves in samples
FINER = 6  # times more samples between which copies are taken
STEP = np.arange(float(WIDE_SAMPLES))


def peals(top: Floats) -> Floats:
    """Return pulses of height 1 with such tops in samples [n, k]: half bells of two widths."""
    past = STEP - top[:, None]
    return np.asarray(np.exp(-0.5 * np.square(past / np.where(past < 0, RISES, FALLS))))


def chatter(rng: np.random.Generator, size: int) -> Complexes:
    """Return noise with components of scatter 1 whose spectrum is a parabola, [size, k]."""
    pitch = np.fft.fftfreq(WIDE_SAMPLES)
    gain = np.sqrt(1 - np.square(pitch / 0.51))
    parts = rng.normal(size=(size, WIDE_SAMPLES)), rng.normal(size=(size, WIDE_SAMPLES))
    made = np.fft.ifft(gain * (parts[0] + 1j * parts[1]), axis=1) * np.sqrt(WIDE_SAMPLES)
    return np.asarray(made / np.sqrt(np.mean(gain**2)))


def afterwards(waves: Complexes, samples: Floats) -> Complexes:
    """Return waveforms later by samples >= 0 [n]: straight between those that are finer."""
    long = 2 * WIDE_SAMPLES
    spectrum = np.fft.fft(waves, long, axis=1)
    wide = np.zeros((len(waves), FINER * long), np.complex128)
    wide[:, : long // 2], wide[:, -long // 2 :] = np.split(spectrum, 2, axis=1)
    fine = FINER * np.fft.ifft(wide, axis=1)
    place = FINER * (STEP - np.clip(samples, 0.0, 110.0)[:, None])
    left = np.floor(place).astype(np.intp)
    one, other = (np.take_along_axis(fine, (left + k) % fine.shape[1], axis=1) for k in (0, 1))
    return np.asarray(np.where(place > -FINER * 6, one + (place - left) * (other - one), 0))


def strikes(waves: Complexes, sigma: Floats, numb: float = 0.0) -> Floats:
    """Return where tangents to first edges meet zero, in samples [n].

    First is what is above noise, `sigma` [n] of a component, and above a share of the largest. Numb
    ones ask for more of both, and take a place higher up the tangent.
    """
    size = np.abs(waves)
    rows, most = np.arange(len(size)), np.max(size, axis=1)
    asked = np.maximum(ABOVE * sigma, SHARE * most) * (1 + 1.15 * numb)
    heard = np.argmax(size >= np.minimum(asked, 0.72 * most)[:, None], axis=1)
    heard = np.clip(heard, 8, WIDE_SAMPLES - 14)
    steps = np.stack([size[rows, heard + k + 1] - size[rows, heard + k] for k in range(-3, 3)])
    steep = np.clip(np.argmax(steps, axis=0), 1, 4)
    before, here, after = (steps[steep + k, rows] for k in (-1, 0, 1))
    bend = np.minimum(before - 2 * here + after, -1e-9)
    aside = np.clip(0.5 * (before - after) / bend, -0.5, 0.5)
    slope = np.maximum(here - 0.25 * (before - after) * aside, 1e-9)
    at = heard - 2.5 + steep  # the middle of the steepest step
    height = 0.5 * (size[rows, heard - 3 + steep] + size[rows, heard - 2 + steep])
    height = height + aside * here
    top = np.max(np.stack([size[rows, heard + k] for k in range(5)]), axis=0)
    up = min(0.3 * numb, 0.8) * top / slope
    return np.asarray(at + aside - np.clip(height / slope - up, -4.0, 4.0))


def prints(waves: Complexes, strike: Floats, sigma: Floats) -> Floats:
    """Return in dB the energy of all there is, and that of four samples about first tops [2, n]."""
    power = np.square(waves.real) + np.square(waves.imag) - 2 * np.square(sigma)[:, None]
    past = STEP - strike[:, None]
    near = np.clip(2.6 - np.abs(past - 1.7), 0.0, 1.0)
    first = np.maximum((power * near).sum(axis=1), 0.9 * sigma**2)
    every = np.maximum((power * (past > -4)).sum(axis=1), 1.1 * first)
    return np.asarray(10 * np.log10(np.vstack([every, first])))


class Till:
    """Waveforms of a table's rows, which go through one thing after the other.

    `sigma` [n]: of a component of noise now; `hisses`, `adds` [n]: factors of what is printed of
    noise and of symbols; `on_top_m` [n]: metres that are in no waveform; `numb`: of `strikes`.
    """

    def __init__(self, table: pd.DataFrame, evening: int, rng: np.random.Generator) -> None:
        self.table, self.evening, self.rng = table, evening, rng
        self.rows = len(table)
        self.given: Complexes = np.array(table["cir_i"].tolist()) + 1j * np.array(
            table["cir_q"].tolist()
        )
        self.now = self.given
        self.at_first: Floats = np.array(table["noise_std"], np.float64) / OF_NOISE
        self.sigma, self.hisses, self.adds = self.at_first, np.ones(self.rows), np.ones(self.rows)
        self.on_top_m, self.numb = np.zeros(self.rows), 0.0
        self.strike = strikes(self.given, self.at_first)
        self.past: Floats = STEP - self.strike[:, None]

    def ticket(self) -> Ticket:
        """Return the rows as they are printed now."""
        return Ticket(self.printed(), self.evening, self.rng)

    def fixed(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case share."""
        return np.random.default_rng([self.evening, what, 984])

    def since(self, samples: float, within: float = 2.0) -> Floats:
        """Return 0 until so many samples past strikes, then 1 [n, k]: by a cosine within some."""
        part = np.clip((self.past - samples) / within, 0, 1)
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * part))

    def sounds(self) -> Floats:
        """Return 0 until shortly before first pulses, then 1 [n, k]."""
        return self.since(-3.0)

    def first(self) -> Floats:
        """Return 1 as long as first pulses last, then 0 [n, k]."""
        return 1 - self.since(5.5, 5.0)

    def heard(self) -> Complexes:
        """Return waveforms from the first pulse on, and of these what is not the till's noise.

        Nothing outside returns that, so whatever is not well above it is left out.
        """
        part = np.clip(np.abs(self.now) / (1.2 * self.sigma[:, None]) - 2.5, 0, 1)
        return np.asarray(self.sounds() * (0.5 - 0.5 * np.cos(np.pi * part)) * self.now)

    def top(self) -> Floats:
        """Return the size of first pulses [n]."""
        inside = (self.past > -1) & (self.past < 4.5)
        return np.asarray(np.max(np.abs(self.now) * inside, axis=1))

    def phase(self) -> Complexes:
        """Return a phase for each row [n]."""
        return np.asarray(np.exp(1j * self.rng.uniform(0.0, 2 * np.pi, self.rows)))

    def copy(self, share: Floats | Complexes, samples: Floats, of: Complexes) -> None:
        """Let such a share [n] of waveforms [n, k] be heard so many samples later too [n]."""
        self.now = self.now + np.reshape(share, (-1, 1)) * afterwards(of, samples)

    def chatters(self, sigma: Floats) -> None:
        """Add noise of such components [n, k] or [n, 1]."""
        self.now = self.now + sigma * chatter(self.rng, self.rows)

    def muffle(self, left: Floats) -> None:
        """Leave such a part of signals [n, k]; noise stays as it was."""
        self.now = left * self.now
        self.chatters(self.sigma[:, None] * np.sqrt(np.maximum(1 - np.square(left), 0.0)))

    def hiss(self, db: Floats) -> None:
        """Let noise rise by dB >= 0 [n]."""
        by = np.power(10.0, db.clip(0.0) / 20)
        self.chatters(np.reshape(self.sigma * np.sqrt(by**2 - 1), (-1, 1)))
        self.sigma, self.hisses = by * self.sigma, by * self.hisses

    def count_less(self, db: Floats) -> None:
        """Add up fewer symbols, by dB <= 0 [n]: noise falls by half as many."""
        part = np.power(10.0, db.clip(max=0.0) / 20)
        self.now = part[:, None] * self.now
        self.chatters(np.reshape(self.sigma * np.sqrt(part - part**2), (-1, 1)))
        self.sigma, self.hisses = np.sqrt(part) * self.sigma, np.sqrt(part) * self.hisses
        self.adds = part * self.adds

    def deal(self, stall: Stall) -> None:
        """Let waveforms have what is dealt out to their rows."""
        self.on_top_m = self.on_top_m + stall.metres
        signal, first = (stall.db(what)[:, None] for what in ("signal", "first"))
        if signal.any() or first.any():
            self.muffle(10 ** (self.sounds() * (signal + first * self.first()) / 20))
        if stall.db("hiss").any():
            self.hiss(stall.db("hiss"))
        if stall.db("count").any():
            self.count_less(stall.db("count"))

    def printed(self) -> pd.DataFrame:
        """Return the table as it is printed now."""
        moved = strikes(self.now, self.sigma, self.numb) - self.strike
        was = np.array(self.table["first_path_index"], np.float64)
        index = np.clip(was + moved, 5.0, WIDE_SAMPLES - 13.0)
        change = prints(self.now, index, self.sigma) - prints(self.given, was, self.at_first)
        whole, first = change - 20 * np.log10(self.adds)
        out = self.table.assign(first_path_index=index)
        out["error_m"] = out["error_m"] + METRES * moved + self.on_top_m
        out["range_m"] = out["true_range_m"] + out["error_m"]
        out["rx_power_dbm"] = out["rx_power_dbm"] + whole
        out["first_path_power_dbm"] = out["first_path_power_dbm"] + first
        out["noise_std"] = out["noise_std"] * self.hisses
        out["preamble_count"] = out["preamble_count"] * self.adds
        return out.assign(cir_i=[*self.now.real], cir_q=[*self.now.imag])
