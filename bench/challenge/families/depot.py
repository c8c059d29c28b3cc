"""Fork-lift trucks in a depot with cold rooms, ranged from gates: ranges and levels, no CIR.

numpy and pandas alone; what it can hide is in `depot_effects`, its waveforms in `depot_waves`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.depot_effects import (
    EFFECTS,
    FORKS,
    GATES_M,
    GOODS,
    LAWS,
    SITE_M,
    UNSEEN,
    Sheet,
)

Floats = NDArray[np.float64]
DRIVES, POLLS, EVERY_S = 13, 3, 0.55
ZONES_C = {"freezer": -21.0, "chilled": 4.0, "dispatch": 17.0}
ALL_M, NEAR_M, FAR_M = (0.0, 99.0), (0.0, 36.0), (22.0, 99.0)  # distances of a mix
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
    "frosted-over": "since_defrost_h",
    "stacked-high": "stack_m",
    "fork-raised": "fork_height_m",
}
RARELY = ("time-lag", "blocked-path", "material-delay")


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the depot's own."""
    rng = np.random.default_rng([311, seed])
    rows = within(driven(rng, drawn.rare), ALL_M if drawn.same_mix else NEAR_M)
    clean = _polled(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = within(driven(rng, drawn.rare), ALL_M if drawn.same_mix else FAR_M)
        rows["link"] = "other " + rows["link"]
    many = [_polled(rows, rng, drawn.scatter) for _ in range(drawn.ratio)]
    return hidden_in(drawn, seed, clean, pd.concat(many, ignore_index=True))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return driven(np.random.default_rng([311, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts = _changed(clean, drawn, seed, 1)
    truth, _ = _changed(simulated, drawn, seed, 2)
    recorded, clean, simulated, truth = (
        logged(one, drawn.listed) for one in (recorded, clean, simulated, truth)
    )
    return Tables(recorded, clean, simulated, truth, shifts)


def logged(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is logged."""
    return table.drop(columns=list(UNSEEN) + ["obstacles"] * (not listed))


def driven(
    rng: np.random.Generator, rare: str, polls: int = POLLS, drives: int = DRIVES
) -> pd.DataFrame:
    """Return what is known of the rows: drives, every one past all gates."""
    stand = 0.86 if rare == "time-lag" else 0.2
    parts = [_drive(rng, number, polls, rng.random() < stand) for number in range(drives)]
    table = pd.concat(parts, ignore_index=True)
    table["reply_time_s"] = rng.choice([0.018, 0.05, 0.11], len(table), p=[0.4, 0.35, 0.25])
    table["fork_height_m"] = rng.uniform(0.1, 5.2, len(table))
    table["stack_m"] = rng.uniform(0.0, 8.0, len(table))
    share = 0.05 if rare == "material-delay" else 0.26
    table["obstacles"] = _stands_between(rng, table["link"], share)
    return table


def within(rows: pd.DataFrame, span_m: tuple[float, float]) -> pd.DataFrame:
    """Return the rows of links whose first distance is in a span."""
    first = rows.groupby("link")["true_range_m"].transform("first")
    return rows[first.between(*span_m)].reset_index(drop=True)


def _drive(rng: np.random.Generator, number: int, polls: int, stands: bool) -> pd.DataFrame:
    """Return one drive: steadily faster, slower or turning, or no drive at all."""
    gate, poll = np.divmod(np.arange(len(GATES_M) * polls), polls)
    when = poll * EVERY_S + 0.021 * gate
    heading, pace = rng.uniform(0, 2 * np.pi), 0.0 if stands else rng.uniform(0.8, 3.2)
    begin, more = np.array([np.cos(heading), np.sin(heading)]) * pace, rng.normal(0, 0.6, 2)
    more = more * (not stands)
    speed = begin + more * when[:, None]
    flat = rng.uniform([8, 6], [54, 30]) + begin * when[:, None] + more * when[:, None] ** 2 / 2
    here = np.column_stack([flat, np.full(len(when), rng.uniform(0.6, 1.4))])
    way = np.array(GATES_M, np.float64)[gate] - here
    ends = np.column_stack([here, here + way, np.tile(SITE_M, (len(way), 1))])
    names = [f"{end}_{axis}_m" for end in ("tx", "rx", "room") for axis in "xyz"]
    turned = np.degrees(np.arctan2(way[:, 1], way[:, 0]) - heading)
    shown = {
        "true_range_m": np.linalg.norm(way, axis=1),
        "link": [f"{number}.{one}" for one in gate],
        "tx": f"fork{rng.integers(FORKS)}",
        "rx": [f"gate{one}" for one in gate],
        "time_s": 1240.0 * number + when,
        "azimuth_deg": (turned + 180) % 360 - 180,
    }
    moves = np.column_stack([speed, np.broadcast_to(more, speed.shape)])
    table = dict(zip((*names, *UNSEEN), np.column_stack([ends, moves]).T, strict=True))
    return pd.DataFrame(table | shown | _conditions(when, rng))


def _conditions(when: Floats, rng: np.random.Generator) -> dict[str, Any]:
    """Return the zone of a drive, the truck's warmth, and when its antenna was defrosted."""
    zone = str(rng.choice(list(ZONES_C)))
    inside_min = rng.exponential(12.0) + when / 60
    fades = 0.7 * np.exp(-inside_min / 4) + 0.3 * np.exp(-inside_min / 25)
    warm = ZONES_C[zone] + rng.normal(0, 2.5) + rng.uniform(-14, 14) * fades
    since = rng.uniform(0, 24)
    return {"environment": zone, "temperature_c": warm, "since_defrost_h": since}


def _stands_between(rng: np.random.Generator, links: pd.Series, share: float) -> pd.Series:
    """Return what stands in the straight path of every link: goods, an iron rack, nothing."""
    listed: dict[str, list[str]] = {}
    for link in dict.fromkeys(links):
        goods = list(map(str, rng.choice(list(GOODS), rng.integers(1, 3))))
        listed[link] = goods if rng.random() < share else ["metal"] * (rng.random() < 0.22)
    return links.map(listed)


def _polled(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the depot's own radio."""
    far, size = rows["true_range_m"].to_numpy(np.float64), len(rows)
    number, links = pd.factorize(rows["link"])
    shade = rng.gumbel(0, 0.9, len(links))[number]
    level = -55.5 - 20.5 * np.log10(far) - shade + rng.triangular(-0.8, 0, 0.8, size)
    error = scatter * (0.02 * rng.normal(size=size) + 0.014 * rng.uniform(-1, 1, size))
    made = rows.assign(range_m=far + error, error_m=error, rx_power_dbm=level)
    made["first_path_power_dbm"] = level - 1.0 - rng.exponential(0.9, size)
    made["noise_std"] = 38.0 + rng.normal(0, 2.2, size)
    made["preamble_count"] = 256.0 - rng.binomial(9, 0.3, size)
    return made


def _changed(table: pd.DataFrame, drawn: Draw, seed: int, part: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    last = ("rewound-counter", "metres-as-yards", "range-rounding")
    order = sorted(drawn.hidden, key=lambda one: (one in last, one))
    rng, shifts = np.random.default_rng([312, seed, part]), {}
    for name in order:
        sheet = Sheet(table, seed, rng, bool(drawn.rare))
        EFFECTS[name](sheet, drawn.strength)
        shifts[name] = sheet.gained.get("late_m", np.zeros(len(table)))
        table = gained(table, sheet)
    listed = [shifts[name] for name in drawn.hidden]
    return table, np.array(listed).reshape(len(listed), len(table))


def gained(table: pd.DataFrame, sheet: Sheet) -> pd.DataFrame:
    """Return the table with what its rows gained."""
    late, louder, straight, hiss, fewer = (
        sheet.gained.get(name, np.zeros(len(table)))
        for name in ("late_m", "all_db", "straight_db", "noise_db", "symbols_db")
    )
    out = table.assign(error_m=table["error_m"] + late)
    out["range_m"] = out["true_range_m"] + out["error_m"]
    out["rx_power_dbm"] += louder + 0.75 * straight
    out["first_path_power_dbm"] += louder + straight
    out["noise_std"] *= 10 ** (hiss / 20)
    out["preamble_count"] *= 10 ** (fewer / 20)
    return out
