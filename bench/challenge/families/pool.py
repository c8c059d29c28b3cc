"""Swimmers that turn lap after lap, ranged from beacons around the basin: ranges and levels.

numpy and pandas alone; what it can hide is in `pool_effects`, its waveforms in `pool_waves`.
The room is known. Antennas are low above water; exchanges are single-sided, mended by the carrier.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.pool_basin import (
    BASIN_M,
    BEACONS_M,
    COURSE,
    HALL_M,
    LANES_M,
    LAWS,
    SLABS,
    SWIMMERS,
    Change,
    Swims,
    in_the_lane,
)
from bench.challenge.families.pool_effects import EFFECTS

Floats = NDArray[np.float64]
HEATS, SWEEPS, SWEEP_S, SLOT_S = 13, 4, 1.35, 0.031
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = {
    "time-lag": "time_s",
    "exchange-motion": "reply_time_s",
    "antenna-delay": "time_s",
    "clock-offset": "reply_time_s",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "power-bias": "true_range_m",
    "path-loss": "true_range_m",
    "range-scale": "true_range_m",
    "level-control": "true_range_m",
    "cap-fills": "minutes_in_water",
    "splashing": "kicks_per_min",
    "wave-machine": "time_s",
    "pump-starts": "pump_rpm",
    "salted-water": "salt_g_per_l",
    "bathers-around": "bathers",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
IN_THE_LOG = ("feet-from-one-beacon", "laps-smoothed", "range-rounding")
SELDOM = 0.06


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the swimming hall's own."""
    rng = np.random.default_rng([731, seed])
    rows = among(heats(rng, drawn.rare), 0 if drawn.same_mix else -1)
    clean = _measured(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = among(heats(rng, drawn.rare), 0 if drawn.same_mix else 1)
        rows = rows.assign(link="model of " + rows["link"])
    models = [_measured(rows, rng, drawn.scatter) for _ in range(drawn.ratio)]
    return hidden_in(drawn, seed, clean, pd.concat(models, ignore_index=True))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return heats(np.random.default_rng([731, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts = _immersed(clean, drawn, [732, seed, 0])
    truth, _ = _immersed(simulated, drawn, [732, seed, 1])
    sides = (recorded, clean, simulated, truth)
    found, plain, model, true = (published(one, drawn.listed) for one in sides)
    return Tables(found, plain, model, true, shifts)


def published(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how swimmers swim, and what stands between unless listed."""
    hidden = [*COURSE, *([] if listed else ["obstacles"])]
    return table.drop(columns=[name for name in hidden if name in table])


def heats(
    rng: np.random.Generator, rare: str, sweeps: int = SWEEPS, count: int = HEATS
) -> pd.DataFrame:
    """Return what is known of the rows of an evening: heats, some of them of who waits."""
    waiting = rng.permutation(count) < (count - 2 if rare == "exchange-motion" else 3)
    starts = np.cumsum(rng.gamma(2.0, 640.0, count))
    parts = [_heat(rng, one, sweeps, starts[one], bool(waiting[one])) for one in range(count)]
    table = pd.concat(parts, ignore_index=True)
    size = len(table)
    table["reply_time_s"] = 0.006 + 0.085 * rng.beta(1.1, 3.0, size)
    table["pump_rpm"] = np.where(rng.random(size) < 0.5, 620.0, 1480.0) + rng.normal(0, 190, size)
    table["salt_g_per_l"] = rng.uniform(0.4, 9.0, size)
    table["bathers"] = rng.integers(1, 70, size).astype(np.float64)
    table["kicks_per_min"] = np.abs(rng.normal(0, 1, size)) * 45
    table["obstacles"] = _between(rng, table["link"], SELDOM if rare == "diffraction" else 0.15)
    return table


def among(rows: pd.DataFrame, side: int) -> pd.DataFrame:
    """Return all rows for 0, or mostly near links for -1, mostly far ones for 1."""
    if side == 0:
        return rows
    links = rows.groupby("link", sort=False)["true_range_m"].mean()
    place = links.rank(pct=True) if side > 0 else 1 - links.rank(pct=True)
    spread = np.mod(0.7548776662 * np.arange(1, len(links) + 1), 1)  # even, and not of chance
    taken = links.index[spread < 0.08 + 1.1 * place**1.6]
    return rows[rows["link"].isin(taken)].reset_index(drop=True)


def _heat(
    rng: np.random.Generator, number: int, sweeps: int, begin_s: float, waits: bool
) -> pd.DataFrame:
    """Return one heat: a swimmer is ranged from all beacons, sweep after sweep."""
    beacon = np.tile(rng.permutation(len(BEACONS_M)), sweeps)
    begun = np.repeat(np.arange(sweeps), len(BEACONS_M)) * SWEEP_S
    slot = np.tile(np.arange(len(BEACONS_M)), sweeps)
    when = np.asarray(begun + SLOT_S * slot, np.float64)
    swims = _stroke(rng, when, waits)
    here = np.empty((len(when), 3))
    here[:, 0] = in_the_lane(swims["along_m"] + swims["surge_m"] * np.sin(swims["surge_rad"]))
    here[:, 1], here[:, 2] = rng.choice(LANES_M), rng.uniform(0.16, 0.42)
    way = BEACONS_M[beacon] - here
    made: dict[str, Any] = {
        "link": [f"heat {number}, beacon {one}" for one in beacon],
        "tx": f"swimmer{rng.integers(SWIMMERS)}",
        "rx": [f"beacon{one}" for one in beacon],
        "environment": "evening" if begin_s > 7000 else "afternoon",
        "time_s": begin_s + when,
        "azimuth_deg": np.mod(np.degrees(np.arctan2(way[:, 1], way[:, 0])) - _ahead(swims), 360),
        "true_range_m": np.linalg.norm(way, axis=1),
        "temperature_c": 27.5 + rng.normal(0, 3.2) + rng.normal(0, 1.1, len(when)),
        "minutes_in_water": rng.exponential(11.0) + rng.uniform(0, 5, len(when)),
    }
    for place, axis in enumerate("xyz"):
        made[f"tx_{axis}_m"], made[f"rx_{axis}_m"] = here[:, place], BEACONS_M[beacon, place]
        made[f"room_{axis}_m"] = HALL_M[place]
    return pd.DataFrame(made | swims)


def _stroke(rng: np.random.Generator, when: Floats, waits: bool) -> dict[str, Floats]:
    """Return how one swims from some place on: a steady pace, and a surge with every stroke."""
    pace = 0.0 if waits else rng.uniform(0.7, 1.9)
    surge, rate = (0.0, 0.0) if waits else (rng.uniform(0.03, 0.12), rng.uniform(3.5, 6.5))
    start, phase = rng.uniform(0, 2 * BASIN_M[1]), rng.uniform(0, 2 * np.pi)
    ones = np.ones(len(when))
    values = (start + pace * when, pace * ones, surge * ones, rate * ones, phase + rate * when)
    return dict(zip(COURSE, values, strict=True))


def _ahead(swims: dict[str, Floats]) -> Floats:
    """Return where swimmers look, in degrees [n]: on one length one way, then back."""
    back = np.mod(swims["along_m"], 2 * BASIN_M[1]) > BASIN_M[1]
    return np.where(back, 180.0, 0.0)


def _between(rng: np.random.Generator, links: pd.Series, rail: float) -> pd.Series:
    """Return what stands in the straight path: a steel rail or plate, a screen, or nothing."""
    names = links.unique()
    kind = rng.choice(list(SLABS), len(names))
    chance = rng.random(len(names))
    stands = {
        name: ["metal"] if c < rail else [str(k)] if c < rail + 0.27 else []
        for name, k, c in zip(names, kind, chance, strict=True)
    }
    return links.map(stands)


def over_water(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm above water: low antennas lose more the farther they are [n]."""
    far, low = (rows[name].to_numpy(np.float64) for name in ("true_range_m", "tx_z_m"))
    return np.asarray(-57.0 - 20 * np.log10(far) - 0.06 * far / (0.2 + low))


def _measured(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the hall's own radio."""
    size, (which, links) = len(rows), pd.factorize(rows["link"])
    level = over_water(rows) + rng.uniform(-1.6, 1.6, len(links))[which]
    level = level - 0.8 * rng.weibull(1.4, size)  # heads under water for a moment
    error = 0.022 * scatter * rng.logistic(0, 0.5513, size)
    out = rows.assign(error_m=error, range_m=rows["true_range_m"] + error, rx_power_dbm=level)
    out["first_path_power_dbm"] = level - 0.9 - rng.gamma(2.0, 0.45, size)
    out["noise_std"] = 74.0 * np.exp(rng.normal(0, 0.03, size))
    return out.assign(preamble_count=np.rint(247 - rng.exponential(2.0, size)))


def _immersed(table: pd.DataFrame, drawn: Draw, seeds: list[int]) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    rng = np.random.default_rng(seeds)
    shifts = np.zeros((len(drawn.hidden), len(table)))
    for place in sorted(range(len(shifts)), key=lambda k: drawn.hidden[k] in IN_THE_LOG):
        swims = Swims(table, seeds[1], rng, seldom=bool(drawn.rare))
        change = EFFECTS[drawn.hidden[place]](swims, drawn.strength)
        shifts[place], table = change.metres, _with(table, change)
    return table, shifts


def _with(table: pd.DataFrame, change: Change) -> pd.DataFrame:
    """Return the table with a change of its rows."""
    edge = np.asarray(change.edge)
    error = table["error_m"] + change.metres
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + change.whole + 0.6 * edge,
        first_path_power_dbm=table["first_path_power_dbm"] + change.whole + edge,
        noise_std=table["noise_std"] * 10 ** (np.asarray(change.hiss) / 20),
        preamble_count=table["preamble_count"] * 10 ** (np.asarray(change.count) / 20),
    )
