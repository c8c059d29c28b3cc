"""A hall with anchors on its walls and tags put down at many places: ranges and levels, no CIR.

numpy and pandas alone. Every effect has another form than in any library: a logistic level bias,
Laplace jitter, walls of one thickness each, detours from a gamma law, a lobe instead of harmonics.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from zlib import crc32

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Law, Tables

Floats = NDArray[np.float64]
ANCHORS, PLACES, MOST_ROWS = 6, 24, 2
SCATTER_M = 0.025
LIGHT_M_PER_US = 299.792458
WALLS = {"concrete": 0.19, "brick": 0.12, "plasterboard": 0.015}  # m of delay per wall
CAUSES = {
    "antenna-delay": "time_s",
    "power-bias": "true_range_m",
    "clock-offset": "reply_time_s",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "path-loss": "true_range_m",
    "range-scale": "true_range_m",
    "step-in-time": "time_s",
    "periodic-in-time": "time_s",
}
RARELY = ("antenna-delay", "clock-offset", "temperature-drift", "material-delay", "blocked-path")
LAWS = {
    "swapped-tags": Law(("swap",), devices=("a0", "a1")),
    "shifted-anchor": Law(("position",), 0.51, "m", devices=("a2",)),
    "yards-in-one-anchor": Law(("unit",), 1 / 0.9144, "1", grows=False, devices=("a4",)),
    "step-in-time": Law(("step",), 0.12, "m"),
    "periodic-in-time": Law(("periodic",), 310.0, "s", grows=False),
    "worn-crystal": Law(("power", "parabola")),
    "path-switching": Law(),
}
"""What nobody's library has."""


@dataclass(frozen=True)
class World:
    """Rows with ranges and levels to change: `own` seeds what devices keep, `rng` the rest."""

    frame: pd.DataFrame
    own: int
    rng: np.random.Generator
    rare: str = ""

    def column(self, name: str) -> Floats:
        """Return a column as floats [n]."""
        return self.frame[name].to_numpy(np.float64)

    def per(self, name: str, spread: float, effect: str) -> Floats:
        """Return a value that every entry of a column keeps in all tables of a case [n]."""
        entries = self.frame[name].astype(str)
        drawn = {
            one: np.random.default_rng([self.own, crc32(f"{effect} {one}".encode())]).normal()
            for one in entries.unique()
        }
        if self.rare == effect:
            drawn = {one: 1.5 * (one == "tag3") for one in drawn}
        return spread * entries.map(drawn).to_numpy(np.float64)


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the hall's own."""
    rng = np.random.default_rng([seed, 1])
    places = _places(rng, "all" if drawn.same_mix else "near", drawn.rare)
    clean = _measured(places, rng, drawn.scatter)
    if not drawn.paired:
        places = _places(rng, "all" if drawn.same_mix else "far", drawn.rare)
        places = places.assign(link="sim " + places["link"])
    parts = [_measured(places, rng, drawn.scatter) for _ in range(drawn.ratio)]
    return hidden_in(drawn, seed, clean, pd.concat(parts, ignore_index=True))


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts = _insert(clean, drawn, seed, 2)
    made = Tables(recorded, clean, simulated, _insert(simulated, drawn, seed, 3)[0], shifts)
    return made if drawn.listed else _unlisted(made)


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _places(np.random.default_rng([seed, 1]), "all", drawn.rare)


def _unlisted(made: Tables) -> Tables:
    assert made.simulated is not None
    recorded, clean, simulated, truth = (
        one.drop(columns="obstacles")
        for one in (made.recorded, made.clean, made.simulated, made.truth)
    )
    return Tables(recorded, clean, simulated, truth, made.shifts_m)


def _places(rng: np.random.Generator, where: str, rare: str) -> pd.DataFrame:
    """Return what is known before anything is measured: positions, devices, times, walls."""
    angle = np.linspace(0, 2 * np.pi, ANCHORS, endpoint=False)
    anchors = np.stack([15 + 15 * np.cos(angle), 9 + 9 * np.sin(angle)], 1)
    spots = rng.uniform([1.0, 1.0], [29.0, 17.0], (PLACES, 2))
    tags = rng.integers(0, 4, PLACES)
    if rare in ("antenna-delay", "clock-offset"):
        tags = np.where(np.arange(PLACES) % 14 == 5, 3, tags % 3)
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
    return _settings(frame, rng, rare).drop(columns=["place", "anchor", "tag"])


def _settings(frame: pd.DataFrame, rng: np.random.Generator, rare: str) -> pd.DataFrame:
    """Return the rows with times, temperatures, reply times, headings and walls."""
    time_s = frame["place"] * 40.0 + np.arange(len(frame)) * 0.1
    warm = 21 + 9 * np.sin(time_s / 700)
    if rare == "temperature-drift":
        warm = np.where(frame["place"] % 14 == 5, 45.0, 25.0)
    heading = rng.uniform(-180, 180, PLACES)[frame["place"]]
    bearing = np.degrees(
        np.arctan2(frame["rx_y_m"] - frame["tx_y_m"], frame["rx_x_m"] - frame["tx_x_m"])
    )
    frame = frame.assign(
        time_s=time_s,
        temperature_c=warm + 0.1 * rng.normal(size=len(frame)),
        reply_time_s=rng.choice([3e-4, 8e-4, 2e-3], len(frame)),
        azimuth_deg=(bearing - heading + 180) % 360 - 180,
    )
    share = 0.06 if rare == "material-delay" else 0.35
    drawn = {
        link: [str(rng.choice(list(WALLS)))] * int(rng.random() < share)
        for link in frame["link"].astype(str).unique()
    }
    walls = [drawn[link] for link in frame["link"].astype(str)]
    return frame.assign(obstacles=pd.Series(walls, dtype=object))


def _measured(places: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of this hall's own radio."""
    distance = places["true_range_m"].to_numpy(np.float64)
    codes, links = pd.factorize(places["link"])
    shadow = rng.normal(0, 1.0, len(links))[codes]
    level = -62 - 20 * np.log10(distance) + shadow + rng.normal(0, 0.3, len(places))
    error = rng.normal(0, SCATTER_M * scatter, len(places))
    first = level - 1.5 + rng.normal(0, 0.4, len(places))
    made = places.assign(range_m=distance + error, error_m=error, rx_power_dbm=level)
    return made.assign(first_path_power_dbm=first)


def _insert(table: pd.DataFrame, drawn: Draw, seed: int, part: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    rng = np.random.default_rng([seed, part, 5])
    own = int(np.random.default_rng([seed, 7]).integers(2**31))
    shifts = np.zeros((len(drawn.hidden), len(table)))
    for place, name in enumerate(drawn.hidden):
        world = World(table, own, rng, drawn.rare)
        shifts[place], gain = EFFECTS[name](world, drawn.strength)
        levels = {
            n: table[n] + gain for n in ("rx_power_dbm", "first_path_power_dbm") if n in table
        }
        error = table["error_m"] + shifts[place]
        table = table.assign(error_m=error, range_m=table["true_range_m"] + error, **levels)
    return table, shifts


Effect = Callable[[World, float], tuple[Floats, Floats | float]]
"""(world, strength) -> shift of the range [n] in metres, gain [n] in dB."""


def _delay(world: World, strength: float) -> tuple[Floats, float]:
    size = 0.06 * strength
    ends = world.per("tx", size, "antenna-delay")
    if world.rare == "antenna-delay":
        return ends, 0.0
    return ends + world.per("rx", size, "antenna-delay") + 0.09 * strength, 0.0


def _level_bias(world: World, strength: float) -> tuple[Floats, float]:
    rising = 1 / (1 + np.exp((world.column("rx_power_dbm") + 79) / 3.5))
    return 0.16 * strength * (rising - 0.55), 0.0


def _crystals(world: World, strength: float) -> tuple[Floats, float]:
    size = 2.0 * strength
    ppm = world.per("tx", size, "clock-offset")
    if world.rare != "clock-offset":
        ppm = ppm - world.per("rx", size, "clock-offset")
    return 0.5 * LIGHT_M_PER_US * ppm * world.column("reply_time_s"), 0.0


def _warmth(world: World, strength: float) -> tuple[Floats, float]:
    return 0.006 * strength * (world.column("temperature_c") - 25), 0.0


def _lobe(world: World, strength: float) -> tuple[Floats, float]:
    centre = np.random.default_rng([world.own, 1]).uniform(-180, 180)
    turn = np.deg2rad(world.column("azimuth_deg") - centre)
    lobe = np.exp(1.2 * (np.cos(turn) - 1))
    return 0.15 * strength * (lobe - 0.42), 0.0  # calibration took the mean out


def _jitter(world: World, strength: float) -> tuple[Floats, float]:
    return world.rng.laplace(0, 0.035 * strength, len(world.frame)), 0.0


def _walled(world: World, strength: float) -> tuple[Floats, Floats]:
    delay = np.array([sum(WALLS[kind] for kind in row) for row in world.frame["obstacles"]])
    return delay * strength, np.where(delay > 0, -4.0, 0.0)


def _blocked(world: World, strength: float) -> tuple[Floats, Floats]:
    codes, links = pd.factorize(world.frame["link"])
    struck = world.rng.random(len(links)) < (0.05 if world.rare else 0.15)
    detour = world.rng.gamma(2.0, 0.6 * max(strength, 0.5), len(links)) * struck
    return detour[codes], np.where(struck[codes], -6.0, 0.0)


def _distance_loss(world: World, strength: float) -> tuple[Floats, Floats]:
    loss = 8 * strength * np.log10(world.column("true_range_m") / 8)
    return np.zeros(len(world.frame)), -loss


def _stretched(world: World, strength: float) -> tuple[Floats, float]:
    return 0.006 * strength * world.column("true_range_m"), 0.0


def _coarse(world: World, strength: float) -> tuple[Floats, float]:
    """Firmware that cuts ranges down to a grid of some centimetres."""
    grid = 0.2 * strength
    now = world.column("range_m")
    return grid * np.floor(now / grid) + grid / 2 - now, 0.0


def _two_rays(world: World, strength: float) -> tuple[Floats, Floats]:
    """Reflect off the floor inside the pulse: a phasor at 4 GHz, weaker where it is steep."""
    far = world.column("true_range_m")
    longer = np.sqrt(far**2 + 4 * world.column("tx_z_m") * world.column("rx_z_m")) - far
    size = min(0.35 * strength, 0.8) * far / (far + longer)
    ray = -size * np.exp(-2j * np.pi * longer / 0.0751)
    inside = np.exp(-((longer / 0.6) ** 2))
    return inside * longer * np.real(ray / (1 + ray)), 20 * np.log10(np.abs(1 + ray))


def _ends(world: World, end: str) -> Floats:
    return world.frame[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy(np.float64).copy()


def _swapped(world: World, _strength: float) -> tuple[Floats, float]:
    """Anchors a0 and a1 have each other's position in the truth."""
    real, names = _ends(world, "rx"), world.frame["rx"].to_numpy()
    place = {name: real[names == name][:1] for name in ("a0", "a1")}
    for name, other in (("a0", "a1"), ("a1", "a0")):
        if len(place[other]):
            real[names == name] = place[other]
    return _moved(world, real)


def _shifted(world: World, strength: float) -> tuple[Floats, float]:
    """Anchor a2 hangs elsewhere than the plan says."""
    real = _ends(world, "rx")
    real[(world.frame["rx"] == "a2").to_numpy()] += np.array([0.4, -0.3, 0.1]) * strength
    return _moved(world, real)


def _moved(world: World, real: Floats) -> tuple[Floats, float]:
    """Return what ranges gain where anchors really are at `real` [n, 3]."""
    far = np.linalg.norm(_ends(world, "tx") - real, axis=1)
    return np.asarray(far - world.column("true_range_m")), 0.0


def _yards(world: World, _strength: float) -> tuple[Floats, float]:
    """Anchor a4 writes yards where all others write metres."""
    mine = (world.frame["rx"] == "a4").to_numpy()
    return mine * (1 / 0.9144 - 1) * world.column("range_m"), 0.0


def _step(world: World, strength: float) -> tuple[Floats, float]:
    late = world.column("time_s") > 0.6 * 40.0 * PLACES
    return np.asarray(0.12 * strength * late), 0.0


def _periodic(world: World, strength: float) -> tuple[Floats, float]:
    return 0.08 * strength * np.sin(2 * np.pi * world.column("time_s") / 310), 0.0


def _worn(world: World, strength: float) -> tuple[Floats, float]:
    """One tag's error grows with the square of the distance: nothing physical."""
    mine = (world.frame["tx"] == "tag1").to_numpy()
    return 0.0008 * strength * mine * world.column("true_range_m") ** 2, 0.0


def _switching(world: World, strength: float) -> tuple[Floats, float]:
    """Lock a quarter of the rows, at random, on to a path that is always as much longer."""
    longer = world.rng.random(len(world.frame)) < 0.25
    return np.asarray(0.4 * strength * longer, np.float64), 0.0


EFFECTS: dict[str, Effect] = {
    "antenna-delay": _delay,
    "power-bias": _level_bias,
    "clock-offset": _crystals,
    "temperature-drift": _warmth,
    "antenna-pattern": _lobe,
    "timestamp-jitter": _jitter,
    "material-delay": _walled,
    "blocked-path": _blocked,
    "path-loss": _distance_loss,
    "range-scale": _stretched,
    "range-rounding": _coarse,
    "ground-bounce": _two_rays,
    "swapped-tags": _swapped,
    "shifted-anchor": _shifted,
    "yards-in-one-anchor": _yards,
    "step-in-time": _step,
    "periodic-in-time": _periodic,
    "worn-crystal": _worn,
    "path-switching": _switching,
}
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
