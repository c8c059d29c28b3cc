"""Hidden effects of the waveform: they change impulse responses and powers, not the range.

The recorded tables hold magnitudes, so what is added meets the old samples at random phases
(or, at a fixed delay after the pulse, where it does not overlap). numpy only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass
class Waves:
    """Impulse responses of n rows: `cir` [n, K] counts, first path [n] samples, noise [n] counts.

    `noise` is the standard deviation of the real (or imaginary) part; powers in dBm, temperature
    in degrees C, distance in metres, `symbols` accumulated.
    """

    cir: Floats
    first: Floats
    noise: Floats
    rx_dbm: Floats
    first_dbm: Floats
    symbols: Floats
    distance: Floats
    temperature: Floats

    @classmethod
    def of(cls, table: pd.DataFrame) -> Waves:
        """Return the waves of a table with columns as in the exchange format."""
        names = (
            *("first_path_index", "noise_std", "rx_power_dbm", "first_path_power_dbm"),
            *("preamble_count", "true_range_m", "temperature_c"),
        )
        columns = [table[name].to_numpy(np.float64).copy() for name in names]
        return cls(np.stack(list(table["cir"])).astype(np.float64), *columns)

    def into(self, table: pd.DataFrame) -> pd.DataFrame:
        """Return the table with these waves in it."""
        return table.assign(
            cir=list(self.cir.astype(np.float32)),
            noise_std=self.noise,
            rx_power_dbm=self.rx_dbm,
            first_path_power_dbm=self.first_dbm,
            preamble_count=self.symbols,
        )

    @property
    def delay(self) -> Floats:
        """Samples after the first path [n, K]."""
        return np.asarray(np.arange(self.cir.shape[1]) - self.first[:, None])

    @property
    def peak(self) -> Floats:
        """Largest magnitude [n]."""
        return np.asarray(self.cir.max(axis=1))

    def met(self, more: Floats, rng: np.random.Generator) -> None:
        """Add magnitudes [n, K] at random phases; the receive level rises with the energy."""
        before = (self.cir**2).sum(axis=1)
        turn = np.cos(rng.uniform(0, 2 * np.pi, self.cir.shape))
        power = self.cir**2 + more**2 + 2 * self.cir * more * turn
        self.cir = np.sqrt(np.maximum(power, 0))
        self.rx_dbm = self.rx_dbm + 10 * np.log10((self.cir**2).sum(axis=1) / before)

    def amplified(self, gain_db: Floats) -> None:
        """Scale the signal, not the noise, of every row by a gain [n] in dB."""
        signal = np.maximum(self.cir**2 - 2 * self.noise[:, None] ** 2, 0)
        more = 10 ** (gain_db / 10)[:, None]
        self.cir = np.sqrt(self.cir**2 + (more - 1) * signal)
        self.rx_dbm, self.first_dbm = self.rx_dbm + gain_db, self.first_dbm + gain_db


Wave = Callable[[Waves, float, np.random.Generator], None]


def tail(waves: Waves, strength: float, rng: np.random.Generator) -> None:
    """Add a decaying random tail of diffuse paths whose start is `strength` of the peak."""
    decay = rng.uniform(12, 25)
    after = np.maximum(waves.delay - 2, 0)
    size = strength * waves.peak[:, None] * np.exp(-after / (2 * decay)) * (waves.delay > 2)
    random = rng.normal(size=(2, *size.shape))
    waves.met(size * np.hypot(random[0], random[1]) / np.sqrt(2), rng)


def ringing(waves: Waves, strength: float, rng: np.random.Generator) -> None:
    """Repeat the pulse inside the antenna: `strength` of it, always the same delay later."""
    late = int(rng.integers(6, 11))
    again = np.zeros_like(waves.cir)
    again[:, late:] = waves.cir[:, :-late]
    waves.met(strength * again * (waves.delay > late - 2), rng)


def interference(waves: Waves, strength: float, rng: np.random.Generator) -> None:
    """Add a narrowband emitter, `10 x strength` of the noise, with a slow beat over the window."""
    size = 10 * strength * waves.noise
    beat = 1 + 0.2 * np.sin(np.arange(waves.cir.shape[1]) / 9.0 + rng.uniform(0, 6))
    waves.met(size[:, None] * beat, rng)
    waves.noise = np.hypot(waves.noise, size / np.sqrt(2))


def noise(waves: Waves, strength: float, rng: np.random.Generator) -> None:
    """Worsen the noise figure: the noise larger by `10 x strength` dB."""
    more = waves.noise * np.sqrt(10**strength - 1)
    random = rng.normal(size=(2, *waves.cir.shape))
    waves.met(more[:, None] * np.hypot(random[0], random[1]), rng)
    waves.noise = np.hypot(waves.noise, more)


def path_loss(waves: Waves, strength: float, _: np.random.Generator) -> None:
    """Steepen the law of distance, with a step every few metres."""
    steps = np.floor(waves.distance / 6.0) * 0.5
    waves.amplified(-strength * (40 * np.log10(waves.distance) + steps))


def level_control(waves: Waves, strength: float, _: np.random.Generator) -> None:
    """Stop accumulating early when the signal is strong."""
    over = np.maximum(waves.rx_dbm + 90.0, 0) / 15.0
    share = 1 / (1 + 8 * strength * over**1.5)
    waves.symbols = np.round(waves.symbols * share)
    signal = np.maximum(waves.cir**2 - 2 * waves.noise[:, None] ** 2, 0)
    rest = waves.cir**2 - signal
    waves.cir = np.sqrt(signal * share[:, None] ** 2 + rest * share[:, None])
    waves.noise = waves.noise * np.sqrt(share)


def pre_echo(waves: Waves, strength: float, rng: np.random.Generator) -> None:
    """Outside the library: a filter that answers before it is asked, some samples early."""
    early = 3
    again = np.zeros_like(waves.cir)
    again[:, :-early] = waves.cir[:, early:]
    waves.met(0.3 * strength * again * (waves.delay < -1), rng)


def warm_gain(waves: Waves, strength: float, _: np.random.Generator) -> None:
    """Outside the library: an amplifier that loses gain when warm."""
    waves.amplified(-0.6 * strength * (waves.temperature - 25))


WAVES: dict[str, Wave] = {
    "diffuse-tail": tail,
    "pulse-ringing": ringing,
    "narrowband-interference": interference,
    "noise-floor": noise,
    "path-loss": path_loss,
    "level-control": level_control,
    "pre-echo": pre_echo,
    "warm-gain": warm_gain,
}
WAVES_OUTSIDE = ("pre-echo", "warm-gain")
STRENGTHS = (0.03, 0.1, 0.3)


@dataclass(frozen=True)
class HiddenWave:
    """What a waveform case hides: one name or none, and its strength (a ratio)."""

    name: str | None
    strength: float


def draw_wave(number: int, seed: int) -> HiddenWave:
    """Return what waveform case `number` hides: of every 20, 5 nothing, 3 outside the library."""
    rng = np.random.default_rng([seed, number, 4])
    turn = number % 20
    if turn % 4 == 0:
        return HiddenWave(None, 0.0)
    outside = turn in (7, 14, 18)
    names = [n for n in WAVES if (n in WAVES_OUTSIDE) == outside]
    return HiddenWave(str(rng.choice(names)), float(rng.choice(STRENGTHS)))


def conceal_wave(table: pd.DataFrame, hidden: HiddenWave, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effect in its waveforms and powers."""
    if hidden.name is None:
        return table
    waves = Waves.of(table)
    WAVES[hidden.name](waves, hidden.strength, np.random.default_rng([seed, 6]))
    return waves.into(table)
