"""Box-shaped rooms with channel impulse responses, by mirrored antennas and a noise-like tail.

numpy and pandas alone; pulse, detection, tail and every effect have other forms than in any
library: a raised-cosine pulse, a first sample over a threshold, reflections up to second order.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import product

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Law, Tables

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
SAMPLE_NS, SAMPLES, LEAD = 1.0016, 150, 12
LIGHT_M_PER_NS = 0.299792458
SCATTER_M, COUNTS, NOISE = 0.02, 9000.0, 45.0
ROOMS_M = ((4.4, 3.4, 2.7), (7.0, 5.0, 2.7))
THRESHOLD = 9.0  # times the noise's usual standard deviation
LINKS, MOST_ROWS = 110, 2
CAUSES = {"antenna-delay": "time_s", "power-bias": "true_range_m", "path-loss": "true_range_m"}
RARELY = ()
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
    "obstructed-path",
    "level-control",
    "quantisation",
)
LAWS = {
    "leaking-mains": Law(),
    "late-echo-burst": Law(),
    "shifted-anchor": Law(("position",), 0.472, "m", devices=("a2",)),
    "dead-samples": Law(),
}
"""What nobody's library has."""


@dataclass
class World:
    """Rows under simulation: known columns, random numbers, what the hidden effects ask for."""

    frame: pd.DataFrame
    rng: np.random.Generator
    more: np.random.Generator  # for hidden effects alone, so that all else is drawn alike
    hidden: dict[str, float] = field(default_factory=dict)

    @property
    def walls(self) -> list[list[str]]:
        """What stands in the straight line of each row."""
        return list(self.frame["obstacles"])

    def size(self, name: str) -> float:
        """Return the strength of a hidden effect, 0 where it is not hidden."""
        return self.hidden.get(name, 0.0)


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case."""
    hidden = dict.fromkeys(drawn.hidden, drawn.strength)
    rng = np.random.default_rng([seed, 1])
    places = _places(rng, 0.5 if drawn.same_mix else 0.8)
    recorded, clean = (_received(_world(places, seed, 2, what)) for what in (hidden, {}))
    if not drawn.paired:
        places = _places(rng, 0.5 if drawn.same_mix else 0.2)
        places = places.assign(link="sim " + places["link"])
    simulated, truth = (
        _repeated(places, seed, first, drawn.ratio, what)
        for first, what in ((100, {}), (200, hidden))
    )
    four = recorded, clean, simulated, truth
    if not drawn.listed:
        four = tuple(one.drop(columns="obstacles") for one in four)  # type: ignore[assignment]
    return Tables(*four)


def _world(places: pd.DataFrame, seed: int, part: int, hidden: dict[str, float]) -> World:
    """Return rows to receive: the same part, the same random numbers."""
    draws = [np.random.default_rng([seed, part, stream]) for stream in (0, 1)]
    return World(places, draws[0], draws[1], hidden)


def _repeated(
    places: pd.DataFrame, seed: int, first: int, times: int, hidden: dict[str, float]
) -> pd.DataFrame:
    """Return the rows received several times over."""
    worlds = [_world(places, seed, first + number, hidden) for number in range(times)]
    return pd.concat([_received(world) for world in worlds], ignore_index=True)


def _places(rng: np.random.Generator, share: float) -> pd.DataFrame:
    """Return positions in two rooms, one to three rows a link, a screen in a fifth of the links.

    `share` of the links are in the smaller room.
    """
    again = rng.integers(1, MOST_ROWS + 1, LINKS)
    size_m = np.array(ROOMS_M)[(rng.random(LINKS) >= share).astype(int)]
    ends = rng.uniform(0.25, size_m - 0.25, (2, LINKS, 3))
    frame = pd.DataFrame({"link": np.repeat([f"l{i}" for i in range(LINKS)], again)})
    for name, places in zip(("tx", "rx"), np.repeat(ends, again, axis=1), strict=True):
        for axis, column in zip("xyz", places.T, strict=True):
            frame[f"{name}_{axis}_m"] = column
    for axis, extent in zip("xyz", np.repeat(size_m, again, axis=0).T, strict=True):
        frame[f"room_{axis}_m"] = extent
    gaps = np.repeat(ends[0] - ends[1], again, axis=0)
    frame["true_range_m"] = np.linalg.norm(gaps, axis=1)
    frame["tx"], frame["rx"] = "tag", np.repeat([f"a{i % 5}" for i in range(LINKS)], again)
    screens = [["plasterboard"] if rng.random() < 0.2 else [] for _ in range(LINKS)]
    listed = [screens[i] for i in np.repeat(np.arange(LINKS), again)]
    return frame.assign(obstacles=pd.Series(listed, dtype=object))


def _received(world: World) -> pd.DataFrame:
    """Return the table a receiver would write: samples, first path, levels, range."""
    frame, rng = world.frame, world.rng
    distance = frame["true_range_m"].to_numpy(np.float64)
    excess, gain = _paths(world)
    start = LEAD + rng.random(len(frame))  # where the straight line falls between samples
    straight = np.abs(gain[:, 0])
    _obstruct(world, excess, gain)
    signal = _sampled(excess + start[:, None], gain) + _tail(world, start, straight)
    loudest = np.abs(signal).max(axis=1)
    signal *= (COUNTS / loudest)[:, None]
    noise_std = NOISE * (1 + 1.5 * world.size("noise-floor"))
    noise = rng.normal(0, noise_std, (2, *signal.shape))
    cir = np.abs(signal + noise[0] + 1j * noise[1] + _disturbance(world, signal.shape))
    if step := 60 * world.size("quantisation"):
        cir = step * np.floor(cir / step)
    first, at = _detected(cir)
    level = 20 * np.log10(loudest / 10) + 10 * np.log10(_energy(cir)) - 45
    early = 20 * np.log10(cir[np.arange(len(cir)), at] / COUNTS)
    level, symbols = _controlled(world, level)
    range_m = distance + (first - start) * SAMPLE_NS * LIGHT_M_PER_NS
    range_m = range_m + rng.normal(0, SCATTER_M, len(cir)) + _shift(world, level)
    made = frame.assign(range_m=range_m, error_m=range_m - distance, rx_power_dbm=level)
    made = made.assign(first_path_power_dbm=level + early - 3, noise_std=_lead_noise(cir))
    made["preamble_count"], made["sample_period_ns"] = symbols, SAMPLE_NS
    return made.assign(first_path_index=first, cir=list(cir.astype(np.float32)))


def _obstruct(world: World, excess: Floats, gain: Complexes) -> None:
    """Weaken and delay the straight path of some links: something nobody listed stands there."""
    strength = world.size("obstructed-path")
    if not strength:
        return
    codes, links = pd.factorize(world.frame["link"])
    struck = (world.more.random(len(links)) < 0.3)[codes]
    loss_db = world.more.uniform(8, 12 + 8 * strength, len(links))[codes]
    gain[:, 0] *= np.where(struck, 10 ** (-loss_db / 20), 1)
    excess[:, 0] += np.where(struck, 0.25 * strength, 0)


def _controlled(world: World, level: Floats) -> tuple[Floats, Floats]:
    """Return level and symbols accumulated where strong signals are turned down."""
    strength = min(world.size("level-control"), 1.5)
    over = np.maximum(level - np.percentile(level, 30), 0)
    symbols = np.round(1020 / (1 + 0.08 * strength * over**1.3))
    return level - 0.3 * strength * over, symbols


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
        gain.append(mirror**order / far**exponent * phase)
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


def _detected(cir: Floats) -> tuple[Floats, NDArray[np.intp]]:
    """Return the first path [n] in samples, and the sample of its peak.

    Half the height of the first peak over a threshold, interpolated.
    """
    rows, grid = np.arange(len(cir)), np.arange(cir.shape[1])
    over = (cir > THRESHOLD * NOISE) & (grid >= 3)
    peak = np.where(over.any(axis=1), over.argmax(axis=1), cir.argmax(axis=1))
    for _ in range(4):
        later = np.minimum(peak + 1, cir.shape[1] - 1)
        peak = np.where(cir[rows, later] > cir[rows, peak], later, peak)
    half = 0.5 * cir[rows, peak]
    below = (cir < half[:, None]) & (grid < peak[:, None])
    low = np.where(below, grid, 0).max(axis=1)
    rise = np.maximum(cir[rows, low + 1] - cir[rows, low], 1e-9)
    edge = low + np.clip((half - cir[rows, low]) / rise, 0, 1)
    return np.asarray(edge + 1.25), peak  # half height: 1.25 samples before this pulse's centre


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
    return np.asarray(total + _elsewhere(frame, world.size("shifted-anchor")))


def _elsewhere(frame: pd.DataFrame, strength: float) -> Floats:
    """Return what ranges gain where anchor a2 hangs elsewhere than the plan says."""
    tag, anchor = (
        frame[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy(np.float64) for end in ("tx", "rx")
    )
    mine = (frame["rx"] == "a2").to_numpy()[:, None]
    real = anchor + mine * np.array([0.3, -0.35, 0.1]) * strength
    far, planned = (np.linalg.norm(tag - end, axis=1) for end in (real, anchor))
    return np.asarray(far - planned)
