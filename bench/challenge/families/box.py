"""Box-shaped rooms with channel impulse responses, by mirrored antennas and a noise-like tail.

numpy and pandas alone; pulse, detection, tail and every effect have other forms than in any
library: a raised-cosine pulse, a threshold on the steepest rise, reflections up to second order.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import product

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
SAMPLE_NS, SAMPLES, LEAD = 1.0016, 150, 12
LIGHT_M_PER_NS = 0.299792458
SCATTER_M, COUNTS, NOISE = 0.02, 9000.0, 45.0
LINKS, MOST_ROWS = 140, 3
KNOWN = (
    "noise-floor",
    "pulse-ringing",
    "specular-reflections",
    "diffuse-tail",
    "narrowband-interference",
    "path-loss",
    "antenna-delay",
    "power-bias",
    "material-delay",
)
OUTSIDE = ("leaking-mains", "late-echo-burst", "shifted-anchor", "dead-samples")


@dataclass
class World:
    """Rows under simulation: known columns, walls, and what the hidden effects ask for."""

    frame: pd.DataFrame
    walls: list[list[str]]
    rng: np.random.Generator
    hidden: dict[str, float] = field(default_factory=dict)

    def size(self, name: str) -> float:
        """Return the strength of a hidden effect, 0 where it is not hidden."""
        return self.hidden.get(name, 0.0)


def tables(drawn: Draw, rng: np.random.Generator) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the recorded and the simulated table of a case."""
    hidden = dict.fromkeys(drawn.hidden, drawn.strength)
    known, walls = _places(rng, (5.5, 4.2, 2.7) if drawn.same_mix else (4.0, 3.2, 2.7))
    recorded = _received(World(known, walls, rng, hidden))
    if not drawn.paired:
        known, walls = _places(rng, (5.5, 4.2, 2.7) if drawn.same_mix else (9.0, 6.0, 3.1))
        known = known.assign(link="sim " + known["link"])
    parts = [_received(World(known, walls, rng)) for _ in range(drawn.ratio)]
    simulated = pd.concat(parts, ignore_index=True)
    if not drawn.listed:
        recorded, simulated = (t.drop(columns="obstacles") for t in (recorded, simulated))
    return recorded, simulated


def _places(
    rng: np.random.Generator, size_m: tuple[float, float, float]
) -> tuple[pd.DataFrame, list[list[str]]]:
    """Return positions in a room, one to three rows a link, a screen in a fifth of the links."""
    again = rng.integers(1, MOST_ROWS + 1, LINKS)
    ends = rng.uniform(0.25, np.array(size_m) - 0.25, (2, LINKS, 3))
    frame = pd.DataFrame({"link": np.repeat([f"l{i}" for i in range(LINKS)], again)})
    for name, places in zip(("tx", "rx"), np.repeat(ends, again, axis=1), strict=True):
        for axis, column in zip("xyz", places.T, strict=True):
            frame[f"{name}_{axis}_m"] = column
    for axis, extent in zip("xyz", size_m, strict=True):
        frame[f"room_{axis}_m"] = extent
    gaps = np.repeat(ends[0] - ends[1], again, axis=0)
    frame["true_range_m"] = np.linalg.norm(gaps, axis=1)
    frame["tx"], frame["rx"] = "tag", np.repeat([f"a{i % 5}" for i in range(LINKS)], again)
    screens = [["plasterboard"] if rng.random() < 0.2 else [] for _ in range(LINKS)]
    return frame, [screens[i] for i in np.repeat(np.arange(LINKS), again)]


def _received(world: World) -> pd.DataFrame:
    """Return the table a receiver would write: samples, first path, levels, range."""
    frame, rng = world.frame, world.rng
    distance = frame["true_range_m"].to_numpy(np.float64)
    excess, gain = _paths(world)
    start = LEAD + rng.random(len(frame))  # where the straight line falls between samples
    signal = _sampled(excess + start[:, None], gain) + _tail(world, start, np.abs(gain[:, 0]))
    loudest = np.abs(signal).max(axis=1)
    signal *= (COUNTS / loudest)[:, None]
    noise_std = NOISE * (1 + 1.5 * world.size("noise-floor"))
    noise = rng.normal(0, noise_std, (2, *signal.shape))
    cir = np.abs(signal + noise[0] + 1j * noise[1] + _disturbance(world, signal.shape))
    first = _detected(cir, start)
    level = 20 * np.log10(loudest / 10) + 10 * np.log10(_energy(cir)) - 45
    early = 20 * np.log10(cir[np.arange(len(cir)), np.rint(start + 1).astype(int)] / COUNTS)
    range_m = distance + (first - start) * SAMPLE_NS * LIGHT_M_PER_NS
    range_m = range_m + rng.normal(0, SCATTER_M, len(cir)) + _shift(world, level)
    made = frame.assign(
        range_m=range_m, error_m=range_m - distance, obstacles=pd.Series(world.walls)
    )
    made = made.assign(rx_power_dbm=level, first_path_power_dbm=level + early - 3)
    made = made.assign(noise_std=_lead_noise(cir), preamble_count=1020.0)
    made["first_path_index"], made["sample_period_ns"] = first, SAMPLE_NS
    return made.assign(cir=list(cir.astype(np.float32)))


def _paths(world: World) -> tuple[Floats, Complexes]:
    """Return excess delay in samples and gain [n, paths]: the straight line, then mirrored ones."""
    frame, rng = world.frame, world.rng
    tx, rx, room = (
        frame[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy(np.float64)
        for end in ("tx", "rx", "room")
    )
    straight = frame["true_range_m"].to_numpy(np.float64)
    slower = np.array([0.05 * len(row) for row in world.walls]) * world.size("material-delay")
    screen = np.array([0.7 ** len(row) for row in world.walls])
    excess = [slower / (SAMPLE_NS * LIGHT_M_PER_NS)]
    exponent = 1 + 0.5 * world.size("path-loss")
    gain: list[NDArray[np.complex128]] = [(screen / straight**exponent).astype(complex)]
    mirror = 0.25 * (1 + world.size("specular-reflections"))
    for steps in product((-1, 0, 1), repeat=3):
        order = sum(map(abs, steps))
        if not 1 <= order <= 2:
            continue
        image = np.where(np.array(steps) > 0, 2 * room - tx, np.where(np.array(steps) < 0, -tx, tx))
        far = np.linalg.norm(image - rx, axis=1)
        phase = np.exp(2j * np.pi * rng.random(len(far)))
        excess.append((far - straight) / (SAMPLE_NS * LIGHT_M_PER_NS))
        gain.append(mirror**order / far * phase)
    if ringing := world.size("pulse-ringing"):
        excess.append(excess[0] + 6.3)
        gain.append(0.3 * ringing * gain[0] * np.exp(1j))
    return np.stack(excess, axis=1), np.stack(gain, axis=1)


def _sampled(at: Floats, gain: Complexes) -> Complexes:
    """Return the sum of raised-cosine pulses, 2.5 samples wide at half height, [n, SAMPLES]."""
    total = np.zeros((len(at), SAMPLES), complex)
    grid = np.arange(SAMPLES)
    for place, strength in zip(at.T, gain.T, strict=True):
        lag = (grid - place[:, None]) / 2.5
        total += strength[:, None] * np.where(np.abs(lag) < 1, 0.5 + 0.5 * np.cos(np.pi * lag), 0)
    return total


def _tail(world: World, start: Floats, direct: Floats) -> Complexes:
    """Return an exponential tail of random phase, 16 samples to 1/e; hidden: longer and louder."""
    more = world.size("diffuse-tail")
    lag = np.arange(SAMPLES) - start[:, None] - 2
    envelope = np.where(lag > 0, np.exp(-lag / (2 * 16 * (1 + more))), 0) * 0.15 * (1 + more)
    drawn = world.rng.normal(size=(2, *envelope.shape))
    return np.asarray(direct[:, None] * envelope * (drawn[0] + 1j * drawn[1]) / np.sqrt(2))


def _disturbance(world: World, shape: tuple[int, ...]) -> Complexes:
    """Return what comes on top of signal and noise, in counts."""
    rng, grid = world.rng, np.arange(shape[1])
    total = np.zeros(shape, complex)
    phase = 2 * np.pi * rng.random((shape[0], 1))
    total += 220 * world.size("narrowband-interference") * np.exp(1j * (0.9 * grid + phase))
    total += 400 * world.size("leaking-mains") * np.sin(2 * np.pi * grid / 75 + phase)
    burst = np.exp(-0.5 * ((grid - 95) / 4) ** 2) * rng.normal(size=shape)
    total += 2500 * world.size("late-echo-burst") * burst
    dead = (grid % 16 == 3) * min(1.0, world.size("dead-samples"))
    return np.asarray(total + 1500 * dead)


def _detected(cir: Floats, start: Floats) -> Floats:
    """Return the first path [n] in samples: half the height of the first peak, interpolated."""
    rows = np.arange(len(cir))
    peak = np.rint(start).astype(int)
    peak = np.where(cir[rows, peak + 1] > cir[rows, peak], peak + 1, peak)
    half = 0.5 * cir[rows, peak]
    grid = np.arange(cir.shape[1])
    below = (cir < half[:, None]) & (grid < peak[:, None])
    low = np.where(below, grid, 0).max(axis=1)
    rise = np.maximum(cir[rows, low + 1] - cir[rows, low], 1e-9)
    edge = low + np.clip((half - cir[rows, low]) / rise, 0, 1)
    return np.asarray(edge + 1.25)  # half height lies 1.25 samples before this pulse's centre


def _energy(cir: Floats) -> Floats:
    return np.asarray(np.maximum((cir**2).sum(axis=1) / COUNTS**2, 1e-6))


def _lead_noise(cir: Floats) -> Floats:
    """Return the scatter of the magnitudes before the first path, as a chip reports it."""
    return np.asarray(cir[:, : LEAD - 4].std(axis=1) + 1.0)


def _shift(world: World, level: Floats) -> Floats:
    """Return what hidden effects of the range alone add, in metres."""
    frame = world.frame
    total = np.full(len(frame), 0.12 * world.size("antenna-delay"))
    rising = 1 / (1 + np.exp((level - np.median(level)) / 2.5))
    total += 0.16 * world.size("power-bias") * (rising - 0.5)
    moved = (frame["rx"] == "a2").to_numpy() * world.size("shifted-anchor")
    return np.asarray(total + 0.35 * moved * np.sign(frame["tx_x_m"] - frame["rx_x_m"]))
