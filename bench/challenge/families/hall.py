"""A hall with anchors on its walls and tags put down at many places: ranges and levels, no CIR.

numpy and pandas alone. Every effect has another form than in any library: a logistic level bias,
Laplace jitter, walls of one thickness each, detours from a gamma law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw

Floats = NDArray[np.float64]
SIZE_M = (30.0, 18.0)
ANCHORS, PLACES, MOST_ROWS = 8, 55, 3
SCATTER_M = 0.025
WALLS = {"concrete": 0.19, "brick": 0.12, "plasterboard": 0.015}  # m of delay per wall
KNOWN = (
    "antenna-delay",
    "power-bias",
    "clock-offset",
    "temperature-drift",
    "timestamp-jitter",
    "material-delay",
    "blocked-path",
    "path-loss",
    "range-scale",
)
OUTSIDE = ("swapped-tags", "shifted-anchor", "step-in-time", "periodic-in-time", "worn-crystal")


@dataclass(frozen=True)
class World:
    """One table in the making: what is known of the rows, and random numbers."""

    frame: pd.DataFrame
    walls: list[list[str]]
    rng: np.random.Generator
    level_dbm: Floats = field(default_factory=lambda: np.empty(0))

    def column(self, name: str) -> Floats:
        """Return a column as floats [n]."""
        return self.frame[name].to_numpy(np.float64)

    def per(self, name: str, spread: float) -> Floats:
        """Return a value for every distinct entry of a column, spread over the rows [n]."""
        codes, names = pd.factorize(self.frame[name])
        return np.asarray(self.rng.normal(0, spread, len(names))[codes])


def tables(drawn: Draw, rng: np.random.Generator) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the recorded and the simulated table of a case."""
    known, walls = _places(rng, "all" if drawn.same_mix else "near")
    recorded = _measured(World(known, walls, rng), drawn.hidden, drawn.strength)
    if not drawn.paired:
        known, walls = _places(rng, "all" if drawn.same_mix else "far")
        known = known.assign(link="sim " + known["link"])
    parts = [_measured(World(known, walls, rng), (), 1.0) for _ in range(drawn.ratio)]
    simulated = pd.concat(parts, ignore_index=True)
    if not drawn.listed:
        recorded, simulated = (t.drop(columns="obstacles") for t in (recorded, simulated))
    return recorded, simulated


def _places(rng: np.random.Generator, where: str) -> tuple[pd.DataFrame, list[list[str]]]:
    """Return what is known before anything is measured: positions, devices, times, walls."""
    angle = np.linspace(0, 2 * np.pi, ANCHORS, endpoint=False)
    anchors = np.stack([15 + 15 * np.cos(angle), 9 + 9 * np.sin(angle)], 1)
    spots = rng.uniform([1.0, 1.0], [29.0, 17.0], (PLACES, 2))
    tags = rng.integers(0, 4, PLACES)
    rows = []
    for place, (x, y) in enumerate(spots):
        for anchor, (ax, ay) in enumerate(anchors):
            flat = float(np.hypot(x - ax, y - ay))
            if (where == "near" and flat > 14) or (where == "far" and flat < 9):
                continue
            again = int(rng.integers(1, MOST_ROWS + 1))
            rows += [(place, anchor, x, y, ax, ay, tags[place])] * again
    columns = ["place", "anchor", "tx_x_m", "tx_y_m", "rx_x_m", "rx_y_m", "tag"]
    frame = pd.DataFrame(rows, columns=columns)
    frame["tx_z_m"], frame["rx_z_m"] = 1.1, 2.6
    gaps = [frame[f"tx_{a}_m"] - frame[f"rx_{a}_m"] for a in "xyz"]
    frame["true_range_m"] = np.sqrt(sum(gap**2 for gap in gaps))
    frame["tx"], frame["rx"] = "tag" + frame["tag"].astype(str), "a" + frame["anchor"].astype(str)
    frame["link"] = "p" + frame["place"].astype(str) + "-" + frame["rx"]
    frame["time_s"] = frame["place"] * 40.0 + np.arange(len(frame)) * 0.1
    frame["temperature_c"] = (
        21 + 9 * np.sin(frame["time_s"] / 700) + 0.1 * rng.normal(size=len(frame))
    )
    frame["reply_time_s"] = rng.choice([3e-4, 8e-4, 2e-3], len(frame))
    walls = _walls(frame, rng)
    return frame.drop(columns=["place", "anchor", "tag"]), walls


def _walls(frame: pd.DataFrame, rng: np.random.Generator) -> list[list[str]]:
    """Return the walls in the line of every row: the same for all rows of a link."""
    kinds = list(WALLS)
    drawn = {
        link: [str(rng.choice(kinds))] * int(rng.random() < 0.35) for link in frame["link"].unique()
    }
    return [drawn[link] for link in frame["link"]]


def _measured(world: World, hidden: tuple[str, ...], strength: float) -> pd.DataFrame:
    """Return the table with ranges and levels; hidden effects in their usual size x strength."""
    frame, rng = world.frame, world.rng
    distance = world.column("true_range_m")
    level = -62 - 20 * np.log10(distance) + world.per("link", 1.0) + rng.normal(0, 0.3, len(frame))
    range_m = distance + rng.normal(0, SCATTER_M, len(frame))
    for name in hidden:
        shift, gain = EFFECTS[name](replace(world, level_dbm=level), strength)
        range_m, level = range_m + shift, level + gain
    made = frame.assign(range_m=range_m, error_m=range_m - distance, rx_power_dbm=level)
    made["first_path_power_dbm"] = level - 1.5 + rng.normal(0, 0.4, len(frame))
    return made.assign(obstacles=pd.Series(world.walls))


Effect = Callable[[World, float], tuple[Floats, Floats | float]]
"""(world, strength) -> shift of the range [n] in metres, gain [n] in dB."""


def _delay(world: World, strength: float) -> tuple[Floats, float]:
    ends = world.per("tx", 0.06 * strength) + world.per("rx", 0.06 * strength)
    return ends + 0.09 * strength, 0.0


def _level_bias(world: World, strength: float) -> tuple[Floats, float]:
    rising = 1 / (1 + np.exp((world.level_dbm + 79) / 3.5))
    return 0.16 * strength * (rising - 0.55), 0.0


def _crystals(world: World, strength: float) -> tuple[Floats, float]:
    ppm = world.per("tx", 2.0 * strength) - world.per("rx", 2.0 * strength)
    return 0.5 * 299.792458 * ppm * world.column("reply_time_s"), 0.0


def _warmth(world: World, strength: float) -> tuple[Floats, float]:
    return 0.006 * strength * (world.column("temperature_c") - 25), 0.0


def _jitter(world: World, strength: float) -> tuple[Floats, float]:
    return world.rng.laplace(0, 0.035 * strength, len(world.frame)), 0.0


def _walled(world: World, strength: float) -> tuple[Floats, Floats]:
    delay = np.array([sum(WALLS[kind] for kind in row) for row in world.walls])
    return delay * strength, np.where(delay > 0, -4.0, 0.0)


def _blocked(world: World, strength: float) -> tuple[Floats, Floats]:
    codes, links = pd.factorize(world.frame["link"])
    struck = world.rng.random(len(links)) < 0.15
    detour = world.rng.gamma(2.0, 0.35 * strength, len(links)) * struck
    return detour[codes], np.where(struck[codes], -6.0, 0.0)


def _distance_loss(world: World, strength: float) -> tuple[Floats, Floats]:
    loss = 8 * strength * np.log10(world.column("true_range_m") / 8)
    return np.zeros(len(world.frame)), -loss


def _stretched(world: World, strength: float) -> tuple[Floats, float]:
    return 0.006 * strength * world.column("true_range_m"), 0.0


def _swapped(world: World, _strength: float) -> tuple[Floats, float]:
    """Anchors a0 and a1 have each other's position in the truth."""
    place = {
        name: world.frame.loc[world.frame["rx"] == name, ["rx_x_m", "rx_y_m", "rx_z_m"]]
        for name in ("a0", "a1")
    }
    real = world.frame[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy(np.float64).copy()
    for name, other in (("a0", "a1"), ("a1", "a0")):
        if len(place[other]):
            real[(world.frame["rx"] == name).to_numpy()] = place[other].iloc[0].to_numpy()
    return _moved(world, real)


def _shifted(world: World, strength: float) -> tuple[Floats, float]:
    """Anchor a2 hangs elsewhere than the plan says."""
    real = world.frame[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy(np.float64).copy()
    real[(world.frame["rx"] == "a2").to_numpy()] += np.array([0.4, -0.3, 0.1]) * strength
    return _moved(world, real)


def _moved(world: World, real: Floats) -> tuple[Floats, float]:
    """Return what ranges gain where anchors really are at `real` [n, 3]."""
    tags = world.frame[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)
    return np.linalg.norm(tags - real, axis=1) - world.column("true_range_m"), 0.0


def _step(world: World, strength: float) -> tuple[Floats, float]:
    late = world.column("time_s") > 0.6 * world.column("time_s").max()
    return 0.12 * strength * late, 0.0


def _periodic(world: World, strength: float) -> tuple[Floats, float]:
    return 0.08 * strength * np.sin(2 * np.pi * world.column("time_s") / 310), 0.0


def _worn(world: World, strength: float) -> tuple[Floats, float]:
    """One tag's error grows with the square of the distance: nothing physical."""
    mine = (world.frame["tx"] == "tag1").to_numpy()
    return 0.0008 * strength * mine * world.column("true_range_m") ** 2, 0.0


EFFECTS: dict[str, Effect] = {
    "antenna-delay": _delay,
    "power-bias": _level_bias,
    "clock-offset": _crystals,
    "temperature-drift": _warmth,
    "timestamp-jitter": _jitter,
    "material-delay": _walled,
    "blocked-path": _blocked,
    "path-loss": _distance_loss,
    "range-scale": _stretched,
    "swapped-tags": _swapped,
    "shifted-anchor": _shifted,
    "step-in-time": _step,
    "periodic-in-time": _periodic,
    "worn-crystal": _worn,
}
