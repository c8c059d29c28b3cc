"""Trolleys in a road tunnel, two tags on each, ranged from niches: ranges and levels, no CIR.

numpy and pandas alone; what it can hide is in `tunnel_effects`, its waveforms in `tunnel_waves`.
The bore guides waves: levels fall as in the open up to a break, and slowly beyond it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.tunnel_effects import (
    BORE_M,
    DRIVING,
    EFFECTS,
    FILLINGS,
    LAWS,
    NICHES_M,
    TAGS,
    Ledger,
)

Floats = NDArray[np.float64]
DRIVES, LAPS, LAP_S, SLOT_S = 8, 4, 0.55, 0.031
TAGS_APART_M = 2.6
BREAK_M, BEYOND_DB_M = 19.0, 0.13  # where the bore begins to guide, and what it costs then
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
    "soot-on-radomes": "soot_g_m2",
    "traction-current": "rail_current_a",
    "jet-fan-two": "fan_hz",
    "lining-sweats": "humidity_pct",
    "curve-forgotten": "true_range_m",
}
RARELY = ("blocked-path", "material-delay", "time-lag")
AT_THE_END = ("fore-for-aft", "range-rounding", "half-millimetre-word", "feet-from-one-niche")
PRIVATE = (*DRIVING, "apart_m")


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the tunnel's own."""
    rng = np.random.default_rng([611, seed])
    rows = one_mix(driven(rng, drawn.rare), drawn.same_mix, short=True)
    clean = _ranged(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = one_mix(driven(rng, drawn.rare), drawn.same_mix, short=False)
        rows["link"] = rows["link"] + " as planned"
    made = [_ranged(rows, rng, drawn.scatter) for _ in range(drawn.ratio)]
    return hidden_in(drawn, seed, clean, pd.concat(made, ignore_index=True))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return driven(np.random.default_rng([611, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts = _booked(clean, drawn, seed, 0)
    truth, _ = _booked(simulated, drawn, seed, 1)
    recorded, clean, simulated, truth = (
        shown(table, drawn.listed) for table in (recorded, clean, simulated, truth)
    )
    return Tables(recorded, clean, simulated, truth, shifts)


def shown(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is handed over: how trolleys are driven is not in it."""
    gone = {*PRIVATE} | (set() if listed else {"obstacles"})
    return table[[name for name in table if name not in gone]]


def driven(
    rng: np.random.Generator, rare: str, laps: int = LAPS, drives: int = DRIVES
) -> pd.DataFrame:
    """Return what is known of the rows of a night: drives, and trolleys that stand on some."""
    stands = set(rng.permutation(drives)[: drives // 4].tolist())
    if rare == "time-lag":
        stands = {*range(drives)} - {int(rng.integers(drives))}
    begins = np.cumsum(rng.uniform(300, 1500, drives))
    parts = [_drive(rng, one, laps, float(begins[one]), one in stands) for one in range(drives)]
    table = pd.concat(parts, ignore_index=True)
    size = len(table)
    return table.assign(
        reply_time_s=0.003 + 0.09 * rng.beta(1.1, 2.6, size),
        rail_current_a=rng.uniform(0, 620, size) * rng.choice([0.15, 1.0], size, p=[0.2, 0.8]),
        odometer_m=rng.uniform(0, 48, size),
        fan_hz=rng.triangular(5, 30, 50, size),
        obstacles=_across(rng, table["link"], 0.06 if rare == "material-delay" else 0.25),
    )


def one_mix(rows: pd.DataFrame, same: bool, short: bool) -> pd.DataFrame:
    """Return all rows, or those of the shorter or of the longer three fifths of links."""
    if same:
        return rows
    median = rows.groupby("link")["true_range_m"].median()
    ranked = median.sort_values().index
    most = round(0.6 * len(ranked))
    chosen = ranked[:most] if short else ranked[-most:]
    return rows[rows["link"].isin(chosen)].reset_index(drop=True)


def _drive(
    rng: np.random.Generator, number: int, laps: int, begin_s: float, stands: bool
) -> pd.DataFrame:
    """Return one drive: the niches range both tags of a trolley in turn, some laps."""
    lap, niche, aft = (one.ravel() for one in np.mgrid[:laps, : len(NICHES_M), :2])
    when = LAP_S * lap + SLOT_S * niche + SLOT_S / 2 * aft
    forth = rng.choice([-1.0, 1.0])
    speed = 0.0 if stands else forth * rng.uniform(1.3, 6.0)
    gathers = 0.0 if stands else rng.uniform(-0.5, 0.5)
    middle = rng.uniform(15, BORE_M[0] - 15) + speed * when + gathers * when**2 / 2
    tag = np.empty((len(when), 3))
    tag[:, 0] = middle + forth * TAGS_APART_M / 2 * np.where(aft, -1, 1)
    tag[:, 1:] = rng.uniform(2.4, 6.0), rng.uniform(1.1, 1.9)
    gap = NICHES_M[niche] - tag
    bearing = np.degrees(np.arctan2(forth * gap[:, 1], forth * gap[:, 0]))
    trolley = int(rng.integers(TAGS // 2))
    made: dict[str, Any] = {
        "link": [f"drive {number} {'fa'[a]}{n}" for n, a in zip(niche, aft, strict=True)],
        "tx": [f"tag{2 * trolley + a}" for a in aft],
        "rx": [f"niche{n}" for n in niche],
        "time_s": begin_s + when,
        "azimuth_deg": bearing,
        "true_range_m": np.sqrt(np.square(gap).sum(axis=1)),
    }
    for place, axis in enumerate("xyz"):
        made[f"tx_{axis}_m"], made[f"rx_{axis}_m"] = tag[:, place], NICHES_M[niche, place]
        made[f"room_{axis}_m"] = BORE_M[place]
    motion = (speed + gathers * when, gathers, forth * TAGS_APART_M)
    return pd.DataFrame(made | dict(zip(PRIVATE, motion, strict=True)) | _air(rng, len(when)))


def _air(rng: np.random.Generator, size: int) -> dict[str, Floats]:
    """Return how warm, damp and sooty it is on a drive."""
    warm = rng.uniform(-3, 30) + rng.normal(0, 2.5, size)  # draughty at some niches
    damp = 100 * rng.beta(4, 2) - rng.uniform(0, 6, size)
    soot = rng.gamma(1.2, 2.2) * rng.uniform(0.5, 1.5, size)  # of each niche's radome
    return {"temperature_c": warm, "humidity_pct": np.maximum(damp, 5), "soot_g_m2": soot}


def _across(rng: np.random.Generator, links: pd.Series, part: float) -> pd.Series:
    """Return what stands in the straight path of links: walls on a part, wagons, or nothing."""
    names, found = list(FILLINGS), {}
    for link in dict.fromkeys(links):
        chance = rng.random()
        if chance < part:
            count = 2 if rng.random() < 0.25 else 1
            found[link] = [str(one) for one in rng.choice(names, count, replace=False)]
        else:
            found[link] = ["metal"] if chance > 0.84 else []
    return links.map(found)


def guided(away: Floats) -> Floats:
    """Return the level in dBm at distances in m: as in the open up to a break, guided beyond."""
    open_air = 20 * np.log10(away * BREAK_M / np.hypot(away, BREAK_M))
    return np.asarray(-60.5 - open_air - BEYOND_DB_M * np.maximum(away - BREAK_M, 0))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the tunnel's own radio."""
    away, size = rows["true_range_m"].to_numpy(np.float64), len(rows)
    code, links = pd.factorize(rows["link"])
    level = guided(away) + rng.uniform(-2.2, 2.2, len(links))[code] + rng.normal(0, 0.45, size)
    error = 0.017 * scatter * np.clip(rng.logistic(0, 0.55, size), -6, 6)
    symbols = 512.0 - rng.integers(0, 9, size)
    return rows.assign(
        range_m=away + error, error_m=error, rx_power_dbm=level,
        first_path_power_dbm=level - 0.6 - 2.2 * rng.beta(2, 2, size),
        noise_std=44.0 + 3.1 * rng.logistic(0, 0.6, size), preamble_count=symbols,
        channel=3, prf_mhz=16.0,
    )  # fmt: skip


def _booked(table: pd.DataFrame, drawn: Draw, seed: int, part: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    rng, added = np.random.default_rng([612, part, seed]), {}
    last = {name: place for place, name in enumerate(AT_THE_END, 1)}
    for name in sorted(drawn.hidden, key=lambda one: (last.get(one, 0), one)):
        ledger = Ledger(table, seed, rng, bool(drawn.rare))
        EFFECTS[name](ledger, drawn.strength)
        table, added[name] = with_bookings(table, ledger), ledger.metres
    shifts = [added[name] for name in drawn.hidden]
    return table, np.reshape(shifts, (len(shifts), len(table)))


def with_bookings(table: pd.DataFrame, ledger: Ledger) -> pd.DataFrame:
    """Return the table with what a ledger has on its rows."""
    error = table["error_m"] + ledger.metres
    whole = ledger.db + 0.6 * ledger.first_db
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + whole,
        first_path_power_dbm=table["first_path_power_dbm"] + ledger.db + ledger.first_db,
        noise_std=table["noise_std"] * 10 ** (ledger.noise_db / 20),
        preamble_count=table["preamble_count"] * ledger.symbols,
    )
