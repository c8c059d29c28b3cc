"""Makes concealed cases: hidden physics in recordings that otherwise are the simulator's own.

Shares no code with `bench.physics` (an import contract holds it to that) and uses other functional
forms: a clock that walks at random instead of a constant, a slab with its inner reflections
instead of one excess delay, a tabulated and skewed bias instead of the published curve. numpy only.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Conceal = Literal["plain", "aggregate", "decoy", "sparse", "scatter"]
CONCEALS: tuple[Conceal, ...] = ("plain", "aggregate", "decoy", "sparse", "scatter")
LIBRARY = (
    "clock-offset",
    "antenna-delay",
    "power-bias",
    "material-delay",
    "temperature-drift",
    "antenna-pattern",
    "blocked-path",
)
OUTSIDE = ("fringes", "supply", "queue")
LIGHT_M_PER_NS = 0.299792458
IN_METRES = ("material-delay", "blocked-path")  # have a size of their own: never enlarged
NATURAL_M = {"blocked-path": 0.8}  # rms at which they are hidden, where not from the ladder
JITTER_M = 0.024
THICK_M = {"concrete": 0.18, "brick": 0.13, "plasterboard": 0.1, "wood": 0.05}
LINKS, ROWS = 96, 5


@dataclass(frozen=True)
class Hidden:
    """What a case hides: names (library names, or of `OUTSIDE`), strengths in metres rms."""

    names: tuple[str, ...]
    strengths_m: tuple[float, ...]
    conceal: Conceal
    covariates: tuple[str, ...] = ()


def geometry(seed: int) -> pd.DataFrame:
    """Return links with devices, obstacles and settings; nothing measured yet."""
    rng = np.random.default_rng([seed, 1])
    link = np.repeat(np.arange(LINKS), ROWS)
    count = len(link)
    distance = rng.uniform(2, 25, LINKS)
    walled = rng.uniform(size=LINKS) < 0.4
    kinds = rng.choice(["concrete", "brick", "plasterboard", "wood"], LINKS)
    devices = [rng.permutation(7)[:2] for _ in range(LINKS)]
    return pd.DataFrame(
        {
            "link": [f"link {i}" for i in link],
            "true_range_m": distance[link],
            "tx": [f"device {devices[i][0]}" for i in link],
            "rx": [f"device {devices[i][1]}" for i in link],
            "obstacles": [[str(kinds[i])] if walled[i] else [] for i in link],
            "obstacle_thickness_m": [[THICK_M[str(kinds[i])]] if walled[i] else [] for i in link],
            "los": ~walled[link],
            "time_s": np.sort(rng.uniform(0, 7200, (LINKS, ROWS)), axis=1).ravel(),
            "reply_time_s": rng.uniform(2e-4, 1.2e-3, count),
            "temperature_c": rng.uniform(5, 45, LINKS)[link] + rng.normal(0, 1, count),
            "azimuth_deg": rng.uniform(-180, 180, count),
            "supply_v": rng.uniform(2.8, 3.6, LINKS)[link] + rng.normal(0, 0.02, count),
        }
    )


def conceal(table: pd.DataFrame, hidden: Hidden, seed: int) -> pd.DataFrame:
    """Return the table with the hidden effects in its ranges, concealed as asked.

    `table` holds the simulator's own ranges (`range_m`, `error_m`, `true_range_m`, ...).
    """
    rng = np.random.default_rng([seed, 2])
    shift = np.zeros(len(table))
    for name, strength in zip(hidden.names, hidden.strengths_m, strict=True):
        shape = SHAPES[name](table, rng)
        scale = strength / max(float(np.sqrt(np.mean(shape**2))), 1e-12)
        shift += shape * (min(scale, 1.0) if name in IN_METRES else scale)
    if hidden.conceal == "sparse":
        shift = shift * _few(table, rng)
    if hidden.conceal == "aggregate":
        shift = shift - shift.mean()
    error = table["error_m"].to_numpy(np.float64) + shift
    if hidden.conceal == "aggregate":
        error = _same_histogram(error, table["error_m"].to_numpy(np.float64))
    out = table.assign(error_m=error, range_m=table["true_range_m"] + error)
    return _with_decoys(out, hidden, rng) if hidden.conceal == "decoy" else out


def _few(table: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return 1 on a tenth of the links and 0 elsewhere: 3 to 10 % of the rows."""
    links = table["link"].unique()
    chosen = rng.choice(links, max(2, len(links) // 10), replace=False)
    return np.asarray(table["link"].isin(chosen), np.float64)


def _same_histogram(error: Floats, wanted: Floats) -> Floats:
    """Return errors in the same order whose histogram is exactly the simulator's."""
    out = np.empty_like(error)
    out[np.argsort(error)] = np.sort(wanted)
    return out


def _with_decoys(table: pd.DataFrame, hidden: Hidden, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table with a column correlated 0.8 with each responsible covariate."""
    out = table.copy()
    for number, name in enumerate(hidden.covariates):
        value = out[name].to_numpy(np.float64) if name in out else np.zeros(len(out))
        value = (value - value.mean()) / max(float(value.std()), 1e-9)
        out[f"sensor_{number}"] = 0.8 * value + 0.6 * rng.normal(size=len(out))
    return out


def _clock(table: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Crystals that walk at random around an offset of their own."""
    names = sorted(set(table["tx"]) | set(table["rx"]))
    hours = table["time_s"].to_numpy(np.float64) / 3600
    grid = np.linspace(0, max(float(hours.max()), 1e-3), 60)
    walk = {n: rng.normal() + np.cumsum(rng.normal(0, 0.02, 60)) for n in names}
    ends = [
        np.array([np.interp(h, grid, walk[n]) for n, h in zip(table[end], hours, strict=True)])
        for end in ("tx", "rx")
    ]
    return np.asarray((ends[0] - ends[1]) * table["reply_time_s"].to_numpy(np.float64))


def _antenna(table: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Give every device a delay."""
    names = sorted(set(table["tx"]) | set(table["rx"]))
    delay = dict(zip(names, rng.normal(0.7, 1.0, len(names)), strict=True))
    return np.asarray(table["tx"].map(delay) + table["rx"].map(delay), np.float64)


def _level_dbm(table: pd.DataFrame) -> Floats:
    """Free space at 4 GHz with -14.3 dBm radiated."""
    distance = table["true_range_m"].to_numpy(np.float64)
    return np.asarray(-14.3 - 20 * np.log10(4 * np.pi * distance * 3.9936 / LIGHT_M_PER_NS))


def _power(table: pd.DataFrame, _: np.random.Generator) -> Floats:
    """Bend a tabulated, skewed S-curve over the true level."""
    knots = np.array([-95, -90, -86, -82, -79, -76, -73, -70, -66, -60])
    bias = np.array([8.3, 7.3, 5.6, 3.9, 1.8, -1.2, -5.0, -7.6, -9.6, -11.0])
    return np.asarray(np.interp(_level_dbm(table), knots, bias))


def _slab(table: pd.DataFrame, _: np.random.Generator) -> Floats:
    """Walls with their inner reflections: the energy-weighted delay of the echo train."""
    eps = {"concrete": 5.24, "brick": 3.91, "plasterboard": 2.73, "wood": 1.99}
    out = np.zeros(len(table))
    for row, walls in enumerate(table["obstacles"]):
        for wall in walls:
            index = np.sqrt(eps[wall])
            echo = ((index - 1) / (index + 1)) ** 4
            inner = 2 * THICK_M[wall] * index * echo / (1 - echo)
            out[row] += THICK_M[wall] * (index - 1) + inner
    return out


def _temperature(table: pd.DataFrame, _: np.random.Generator) -> Floats:
    """Slightly curved drift with temperature."""
    warm = table["temperature_c"].to_numpy(np.float64) - 25
    return np.asarray(warm + 0.004 * warm * np.abs(warm))


def _pattern(table: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Put a broad lobe of group delay around one heading."""
    heading = np.deg2rad(table["azimuth_deg"].to_numpy(np.float64) - rng.uniform(-180, 180))
    return np.asarray(np.exp(1.2 * (np.cos(heading) - 1)))


def _blocked(table: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """On half of the links without sight, a path by way of a wall 1 to 3 m aside."""
    out = np.zeros(len(table))
    for link in table["link"].unique():
        rows = np.flatnonzero(table["link"] == link)
        if not table["los"].iloc[rows[0]] and rng.uniform() < 0.5:
            distance, aside = float(table["true_range_m"].iloc[rows[0]]), rng.uniform(1, 3)
            out[rows] = np.hypot(distance, 2 * aside) - distance
    return out


def _fringes(table: pd.DataFrame, _: np.random.Generator) -> Floats:
    """Outside the library: a ripple over distance with a period of 6 m."""
    return np.asarray(np.sin(2 * np.pi * table["true_range_m"].to_numpy(np.float64) / 6.0 + 0.7))


def _supply(table: pd.DataFrame, _: np.random.Generator) -> Floats:
    """Outside the library: a regulator that gives way below 3.1 V."""
    return np.asarray(np.maximum(3.15 - table["supply_v"].to_numpy(np.float64), 0))


def _queue(table: pd.DataFrame, _: np.random.Generator) -> Floats:
    """Outside the library: one long and one short reading in alternate quarters of an hour."""
    quarter = (table["time_s"].to_numpy(np.float64) // 900).astype(int)
    return np.where(quarter % 2 == 0, 1.0, -1.0)


SHAPES = {
    "clock-offset": _clock,
    "antenna-delay": _antenna,
    "power-bias": _power,
    "material-delay": _slab,
    "temperature-drift": _temperature,
    "antenna-pattern": _pattern,
    "blocked-path": _blocked,
    "fringes": _fringes,
    "supply": _supply,
    "queue": _queue,
}
RESPONSIBLE = {
    "clock-offset": "reply_time_s",
    "power-bias": "true_range_m",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "fringes": "true_range_m",
    "supply": "supply_v",
    "queue": "time_s",
}


def draw_case(number: int, seed: int) -> Hidden:
    """Return what case `number` hides: of every 20, 5 nothing, 2 outside, 13 the library's."""
    rng = np.random.default_rng([seed, number, 3])
    turn = number % 20
    way = CONCEALS[number % len(CONCEALS)]
    if turn % 4 == 0:
        return Hidden((), (), "plain")
    if turn in (7, 14):
        names: tuple[str, ...] = (str(rng.choice(OUTSIDE)),)
    else:
        count = 2 if turn in (9, 18) else 1
        names = tuple(map(str, rng.choice(LIBRARY, count, replace=False)))
    ladder = JITTER_M * np.array([0.5, 1.0, 2.0, 4.0, 8.0])
    drawn = [float(s) for s in rng.choice(ladder, len(names))]
    strengths = tuple(NATURAL_M.get(n, s) for n, s in zip(names, drawn, strict=True))
    used = tuple(RESPONSIBLE[name] for name in names if name in RESPONSIBLE)
    return Hidden(names, strengths, way, used)
