"""Hidden effects of the waveform: noise, echoes, losses and gains, put into complex samples.

Another simulator's samples are changed; what the chip reports follows from the changed samples:
the first path and with it the range are found again, and the powers move by what the samples say.
numpy and pandas only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Law

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
LINKS, ROWS = 90, 2
LEAD, SAMPLES = 5, 157  # of the impulse responses that are recorded
WIDE_LEAD, WIDE_SAMPLES = 24, 208  # of those that effects are put into
RAYLEIGH = 0.6551  # std of |n| over the std of its real part
SAMPLE_M = 0.3003  # one accumulator sample of 1.0016 ns
NTM = 12.5  # detection threshold in multiples of the noise std
WIDTH = 2.5  # samples, of the pulse at half its height


@dataclass
class Waves:
    """Samples of n rows: `cir` [n, K] complex counts, first path [n] samples, `floor` [n] counts^2.

    `floor` is the mean |noise|^2, `noise` the standard deviation of |noise| as reported; powers in
    dBm, temperature in degrees C, distance and range in metres, `symbols` accumulated.
    """

    cir: Complexes
    first: Floats
    noise: Floats
    rx_dbm: Floats
    first_dbm: Floats
    symbols: Floats
    range_m: Floats
    distance: Floats
    temperature: Floats
    floor: Floats
    mirrored_m: Floats

    @classmethod
    def of(cls, table: pd.DataFrame) -> Waves:
        """Return the waves of a table with `cir_i`, `cir_q` and columns of the exchange format."""
        names = (
            *("first_path_index", "noise_std", "rx_power_dbm", "first_path_power_dbm"),
            *("preamble_count", "range_m", "true_range_m", "temperature_c"),
        )
        columns = [table[name].to_numpy(np.float64).copy() for name in names]
        real, imaginary = (np.stack(list(table[name])) for name in ("cir_i", "cir_q"))
        columns.append(np.full(len(table), 2 * (columns[1].mean() / RAYLEIGH) ** 2))
        columns.append(_mirrored_m(table))
        return cls((real + 1j * imaginary).astype(np.complex128), *columns)

    def into(self, table: pd.DataFrame) -> pd.DataFrame:
        """Return the table with these waves in it."""
        return table.assign(
            cir_i=list(self.cir.real),
            cir_q=list(self.cir.imag),
            first_path_index=self.first,
            noise_std=self.noise,
            rx_power_dbm=self.rx_dbm,
            first_path_power_dbm=self.first_dbm,
            preamble_count=self.symbols,
            range_m=self.range_m,
            error_m=self.range_m - self.distance,
        )

    @property
    def delay(self) -> Floats:
        """Samples after the first path [n, K]."""
        return np.asarray(np.arange(self.cir.shape[1]) - self.first[:, None])

    @property
    def peak(self) -> Floats:
        """Largest magnitude [n]."""
        return np.asarray(np.abs(self.cir).max(axis=1))

    def noisy(self, power: Floats, rng: np.random.Generator) -> Complexes:
        """Return white noise [n, K] of mean |n|^2 = `power` [n]."""
        parts = rng.normal(size=(2, *self.cir.shape)) * np.sqrt(power / 2)[:, None]
        return np.asarray(parts[0] + 1j * parts[1])

    def attenuated(self, loss_db: Floats, rng: np.random.Generator) -> None:
        """Weaken the signal, not the noise, of every row by a loss [n] >= 0 in dB."""
        left = 10 ** (-loss_db / 20)
        fresh = self.noisy(self.floor * (1 - left**2), rng)
        self.cir = self.cir * left[:, None] + fresh

    def accumulated(self, share: Floats, rng: np.random.Generator) -> None:
        """Accumulate only a share [n] of the symbols: the noise falls as its root."""
        fresh = self.noisy(self.floor * (share - share**2), rng)
        self.cir = self.cir * share[:, None] + fresh
        self.floor, self.noise = self.floor * share, self.noise * np.sqrt(share)
        self.symbols = self.symbols * share

    def seen(self) -> tuple[Floats, Floats, Floats]:
        """Return what these samples say: first path [n] samples, energy and first power [n].

        Per symbol squared; the energy is that above the noise.
        """
        size = np.abs(self.cir)
        found = leading_edge(size, NTM * RAYLEIGH * np.sqrt(self.floor / 2))
        energy = (size**2).sum(axis=1)
        above = np.maximum(energy - size.shape[1] * self.floor, 0.05 * energy)
        near = np.floor(found).astype(int)[:, None] + np.arange(1, 4)
        early = (np.take_along_axis(size, near, axis=1) ** 2).sum(axis=1)
        return found, above / self.symbols**2, early / self.symbols**2


def _mirrored_m(table: pd.DataFrame) -> Floats:
    """Return how much longer the ways by four walls and the floor are, [5, n] in metres."""
    tx, rx, room = (
        table[[f"{name}_{axis}_m" for axis in "xyz"]].to_numpy(np.float64)
        for name in ("tx", "rx", "room")
    )
    ways = []
    for axis, far in ((0, False), (0, True), (1, False), (1, True), (2, False)):
        image = tx.copy()
        image[:, axis] = (2 * room[:, axis] if far else 0) - tx[:, axis]
        ways.append(np.linalg.norm(image - rx, axis=1) - np.linalg.norm(tx - rx, axis=1))
    return np.stack(ways)


def leading_edge(size: Floats, threshold: Floats) -> Floats:
    """Return where [n] the first edge above a threshold [n] crosses half its peak, in samples."""
    over = size > threshold[:, None]
    start = np.where(over.any(axis=1), over.argmax(axis=1), size.argmax(axis=1))
    out = np.empty(len(size))
    for row, begin in enumerate(start):
        top = begin
        while top < begin + 4 and size[row, top + 1] > size[row, top]:
            top += 1
        half, low = size[row, top] / 2, top
        while low > 0 and size[row, low] > half:
            low -= 1
        rise = max(size[row, low + 1] - size[row, low], 1e-9)
        out[row] = np.round(64 * (low + (half - size[row, low]) / rise)) / 64
    return out


Wave = Callable[[Waves, float, np.random.Generator], None]


def tail(waves: Waves, strength: float, rng: np.random.Generator) -> None:
    """Add a decaying random tail of diffuse paths whose start is `strength` of the peak."""
    decay = rng.uniform(12, 25)
    after = waves.delay - 1.2
    size = strength * waves.peak[:, None] * np.exp(-np.maximum(after, 0) / (2 * decay))
    paths = waves.noisy(np.ones(len(size)), rng) * size * (after > 0)
    pulse = np.exp(-4 * np.log(2) * (np.arange(-5, 6) / WIDTH) ** 2)
    pulse /= np.sqrt((pulse**2).sum())
    waves.cir = waves.cir + np.stack([np.convolve(row, pulse, "same") for row in paths])


def ringing(waves: Waves, strength: float, rng: np.random.Generator) -> None:
    """Repeat the pulse inside the antenna: `strength` of it, always the same delay later.

    The antenna is passive: what rings on is missing from the pulse.
    """
    late, turn = int(rng.integers(6, 11)), np.exp(1j * rng.uniform(0, 2 * np.pi))
    again = np.roll(waves.cir, late, axis=1)
    waves.cir = (waves.cir + strength * turn * again) / np.sqrt(1 + strength**2)


def interference(waves: Waves, strength: float, rng: np.random.Generator) -> None:
    """Add a narrowband emitter, `10 x strength` of the noise, with a slow beat over the window."""
    turns = rng.choice([-1, 1]) * rng.uniform(0.02, 0.2)  # per sample: 20 to 200 MHz off
    loud = 10 ** (rng.normal(0, 2, len(waves.cir)) / 20)
    size = 10 * strength * np.sqrt(waves.floor / 2) * loud
    when = np.arange(waves.cir.shape[1])
    beat = 1 + 0.2 * np.sin(when / 9.0 + rng.uniform(0, 6, (len(size), 1)))
    phase = 2 * np.pi * (turns * when + rng.uniform(size=(len(size), 1)))
    tone = size[:, None] * beat * np.exp(1j * phase)
    alone = waves.noisy(waves.floor, rng)
    waves.cir = waves.cir + tone
    waves.noise = waves.noise * np.abs(alone + tone).std(axis=1) / np.abs(alone).std(axis=1)
    waves.floor = waves.floor + size**2


def noise(waves: Waves, strength: float, rng: np.random.Generator) -> None:
    """Worsen the noise figure: the noise larger by `10 x strength` dB."""
    more = 10**strength
    waves.cir = waves.cir + waves.noisy(waves.floor * (more - 1), rng)
    waves.floor, waves.noise = waves.floor * more, waves.noise * np.sqrt(more)


def path_loss(waves: Waves, strength: float, rng: np.random.Generator) -> None:
    """Steepen the law of distance, with a step every few metres."""
    steps = np.floor(waves.distance / 6.0) * 0.5
    loss_db = strength * (40 * np.log10(waves.distance) + steps)
    waves.attenuated(np.maximum(loss_db, 0.0), rng)


def reflections(waves: Waves, strength: float, rng: np.random.Generator) -> None:
    """Add the echoes of the four walls and the floor, `2 x strength` of the straight path."""
    original = waves.cir.copy()
    for number, extra in enumerate(waves.mirrored_m):
        late = extra / SAMPLE_M
        size = (
            2 * strength * (0.8 if number < 4 else 0.5) * waves.distance / (waves.distance + extra)
        )
        turn = np.exp(2j * np.pi * rng.random(len(late)))
        waves.cir = waves.cir + (size * turn)[:, None] * _later(original, late)


def _later(cir: Complexes, late: Floats) -> Complexes:
    """Return samples [n, K] a number of samples [n] later, by linear interpolation."""
    whole, part = np.floor(late).astype(int), (late % 1)[:, None]
    grid = np.arange(cir.shape[1])[None] - whole[:, None]
    now, before = (
        np.where(at >= 0, np.take_along_axis(cir, np.maximum(at, 0), axis=1), 0)
        for at in (grid, grid - 1)
    )
    return np.asarray((1 - part) * now + part * before)


def fading(waves: Waves, strength: float, rng: np.random.Generator) -> None:
    """Let every row fade by itself: a Rice fade of the straight path with what runs beside it."""
    beside = rng.normal(size=(2, len(waves.cir))) * 2 * strength
    gain = np.abs(1 + beside[0] + 1j * beside[1])
    waves.attenuated(-20 * np.log10(np.clip(gain, 0.02, None) / gain.max()), rng)


def rounded(waves: Waves, strength: float, _rng: np.random.Generator) -> None:
    """Cut both parts of every sample to a grid of `600 x strength` counts."""
    grid = 600 * strength
    waves.cir = grid * (np.trunc(waves.cir.real / grid) + 1j * np.trunc(waves.cir.imag / grid))


def level_control(waves: Waves, strength: float, rng: np.random.Generator) -> None:
    """Hold the level: turn strong signals down and stop accumulating them early."""
    over = np.maximum(waves.rx_dbm + 90.0, 0) / 15.0
    waves.attenuated(12 * strength * over**1.4, rng)
    wanted = np.round(waves.symbols / (1 + 8 * strength * over**1.5))
    waves.accumulated(wanted / waves.symbols, rng)


def pre_echo(waves: Waves, strength: float, rng: np.random.Generator) -> None:
    """Outside the library: a filter that answers before it is asked, some samples early."""
    turn = np.exp(1j * rng.uniform(0, 2 * np.pi))
    waves.cir = waves.cir + 0.3 * strength * turn * np.roll(waves.cir, -3, axis=1)


def warm_gain(waves: Waves, strength: float, rng: np.random.Generator) -> None:
    """Outside the library: an amplifier that loses gain as it warms, from the coldest row on."""
    waves.attenuated(0.6 * strength * (waves.temperature - waves.temperature.min()), rng)


WAVES: dict[str, Wave] = {
    "diffuse-tail": tail,
    "pulse-ringing": ringing,
    "narrowband-interference": interference,
    "noise-floor": noise,
    "path-loss": path_loss,
    "level-control": level_control,
    "specular-reflections": reflections,
    "small-scale-fading": fading,
    "quantisation": rounded,
    "pre-echo": pre_echo,
    "warm-gain": warm_gain,
}
LAWS = {"pre-echo": Law(), "warm-gain": Law()}
"""What nobody's library has: no law of the range."""
CAUSES: dict[str, str] = {}
RARELY = ()
KNOWN = tuple(name for name in WAVES if name not in LAWS)
USUAL = 0.15  # a strength of 1 is this ratio


def known(_: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure: links in rooms of several sizes."""
    rng = np.random.default_rng([seed, 1])
    rooms = rng.uniform([6, 4, 2.5], [16, 10, 4], (6, 3))
    link = np.repeat(np.arange(LINKS), ROWS)
    room = rooms[rng.integers(len(rooms), size=LINKS)]
    ends = rng.uniform(0.4, room - 0.4, (2, LINKS, 3))
    frame = pd.DataFrame({"link": [f"link {i}" for i in link]})
    for name, place in (("tx", ends[0]), ("rx", ends[1]), ("room", room)):
        for axis, column in zip("xyz", place.T, strict=True):
            frame[f"{name}_{axis}_m"] = column[link]
    frame["true_range_m"] = np.linalg.norm(ends[0] - ends[1], axis=1)[link]
    frame["tx"], frame["rx"] = [f"t{i % 3}" for i in link], [f"r{i % 4}" for i in link]
    frame["time_s"] = np.arange(len(frame)) * 2.0
    frame["temperature_c"] = rng.uniform(5, 45, LINKS)[link] + rng.normal(0, 0.3, len(frame))
    return frame


def conceal(table: pd.DataFrame, drawn: Draw, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its waveforms, ranges and powers.

    `table` has complex impulse responses of WIDE_SAMPLES; see `recorded` for what is shown.
    """
    for number, name in enumerate(drawn.hidden):
        waves = Waves.of(table)
        before = waves.seen()
        own = np.random.default_rng([seed, 6, number])
        WAVES[name](waves, USUAL * drawn.strength, own)
        after = waves.seen()
        later, louder, earlier = (b - a for a, b in zip(_in_db(before), _in_db(after), strict=True))
        waves.first, waves.range_m = waves.first + later, waves.range_m + SAMPLE_M * later
        waves.rx_dbm, waves.first_dbm = waves.rx_dbm + louder, waves.first_dbm + earlier
        table = waves.into(table)
    return table


def _in_db(seen: tuple[Floats, Floats, Floats]) -> tuple[Floats, Floats, Floats]:
    """Return what samples say with powers in dB."""
    return seen[0], 10 * np.log10(seen[1]), 10 * np.log10(seen[2])


def recorded(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table as a radio would log it: SAMPLES magnitudes from LEAD before the path."""
    start = np.floor(table["first_path_index"].to_numpy()).astype(int) - LEAD
    wide = [np.hypot(*np.stack(pair)) for pair in zip(table["cir_i"], table["cir_q"], strict=True)]
    start = np.clip(start, 0, WIDE_SAMPLES - SAMPLES)
    cut = [row[at : at + SAMPLES].astype(np.float32) for row, at in zip(wide, start, strict=True)]
    shown = table.drop(columns=["cir_i", "cir_q"])
    return shown.assign(cir=cut, first_path_index=table["first_path_index"] - start)
