"""Barrows in the cellar of a brewery, ranged from gantries over its tanks: ranges and levels.

numpy and pandas alone; what it can hide is in `brewery_effects`, its waveforms in
`brewery_waves`. No room is known, but the channel is. An errand has from one to nine rounds.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.brewery_cellar import (
    BARROWS,
    DAY_S,
    FILLED,
    GANTRIES_M,
    LAWS,
    LONG_M,
    PUSH,
    WIDE_M,
    Batch,
    Brew,
)
from bench.challenge.families.brewery_effects import EFFECTS
from bench.challenge.families.case import Draw, Tables

Floats = NDArray[np.float64]
ROUNDS = (1, 1, 2, 3, 4, 4, 5, 6, 7, 8, 8, 9, 9)  # of errands, in any order
ROUND_S, SLOT_S = 0.42, 0.031
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
    "foam-on-tags": "foam_mm",
    "glycol-pump-cycles": "time_s",
    "steam-let-in": "steam_bar",
    "malt-dust-settles": "malt_kg",
    "kegs-stacked": "kegs",
    "tank-fills": "tank_hl",
    "supply-starved": "supply_v",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
WRITTEN_LAST = ("median-of-last-three", "ells-from-one-gantry", "range-rounding")
SPARE = 0.055


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the brewery's own."""
    rng = np.random.default_rng([872, seed])
    rows = part_of(errands(rng, drawn.rare), 0 if drawn.same_mix else -1)
    clean = _polled(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = part_of(errands(rng, drawn.rare), 0 if drawn.same_mix else 1)
        rows["link"] = rows["link"].radd("rehearsed ")
    often = pd.concat([rows for _ in range(drawn.ratio)]).reset_index(drop=True)
    return hidden_in(drawn, seed, clean, _polled(often, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return errands(np.random.default_rng([872, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    found, metres = _brewed(clean, drawn, seed, np.random.default_rng([873, seed]))
    true, _ = _brewed(simulated, drawn, seed, np.random.default_rng([874, seed]))
    four = (found, clean, simulated, true)
    shown, plain, model, truth = (public(table, drawn.listed) for table in four)
    return Tables(shown, plain, model, truth, metres)


def public(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without how barrows are pushed, and what stands between unless listed."""
    secret = {*PUSH} if listed else {*PUSH, "obstacles"}
    return table.loc[:, [name not in secret for name in table.columns]].copy()


def errands(rng: np.random.Generator, rare: str, rounds: tuple[int, ...] = ROUNDS) -> pd.DataFrame:
    """Return what is known of the rows of a day: errands, in some of which a barrow stands."""
    order = rng.permutation(np.array(rounds))
    still = np.isin(np.arange(order.size), rng.choice(order.size, 4, replace=False))
    if rare == "exchange-motion":
        still = np.ones(order.size, bool)  # but for two short ones
        still[np.flatnonzero((order > 1) & (order < 5))[:2]] = False
    begin_s = np.sort(rng.uniform(0.0, DAY_S, order.size))
    made = [_errand(rng, k, order[k], begin_s[k], still[k]) for k in range(order.size)]
    return _gauges(pd.concat(made, ignore_index=True), rng, SPARE if rare == "diffraction" else 0.2)


def _gauges(table: pd.DataFrame, rng: np.random.Generator, steel: float) -> pd.DataFrame:
    """Return the table with what the brewery's gauges say at each row."""
    size = len(table)
    table["reply_time_s"] = 0.005 + 0.078 * rng.beta(0.9, 1.3, size)
    table["foam_mm"] = 45.0 * rng.beta(0.9, 2.0, size)
    table["steam_bar"] = rng.uniform(0.4, 4.2, size)
    table["malt_kg"] = rng.exponential(55.0, size)
    table["kegs"] = rng.geometric(0.07, size).astype(np.float64)
    table["tank_hl"] = 120.0 * rng.beta(0.9, 0.9, size)
    table["supply_v"] = rng.triangular(2.6, 6.0, 14.0, size)
    table["obstacles"] = _what_stands(rng, table["link"], steel)
    return table


def part_of(rows: pd.DataFrame, side: int) -> pd.DataFrame:
    """Return all rows for 0, or mostly those of near links for -1, of far ones for 1."""
    if not side:
        return rows.copy()
    rank = (side * rows.groupby("link")["true_range_m"].mean()).rank(pct=True)
    comb = np.mod(0.5698402910 * np.arange(1, len(rank) + 1), 1.0)  # even, and not of chance
    kept = rank.index[comb < np.maximum(1.25 * rank.to_numpy() ** 2.2, 0.04)]
    return rows[rows["link"].isin(kept)].reset_index(drop=True)


def _errand(
    rng: np.random.Generator, number: int, rounds: int, begin_s: float, still: bool
) -> pd.DataFrame:
    """Return one errand: round after round, all gantries poll the tag of a barrow."""
    every = len(GANTRIES_M)
    slot = np.arange(int(rounds) * every)
    gantry = slot % every
    since_s = ROUND_S * (slot // every) + SLOT_S * gantry
    table = _pushed(rng, since_s, still)
    way = GANTRIES_M[gantry] - table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy()
    for axis, name in enumerate("xyz"):
        table[f"rx_{name}_m"] = GANTRIES_M[gantry, axis]
    table["true_range_m"] = np.sqrt(np.square(way).sum(axis=1))
    bearing = np.arctan2(way[:, 0], way[:, 1]) + table["aisle_rad"].to_numpy()
    table["azimuth_deg"] = np.degrees(bearing) % 360
    table["link"] = [f"errand {number} below gantry {one}" for one in gantry]
    table["tx"] = f"barrow{rng.integers(BARROWS)}"
    table["rx"] = [f"gantry{one}" for one in gantry]
    table["environment"] = "cellar" if table["tx_y_m"].iloc[0] < 0.5 * LONG_M else "racking hall"
    table["time_s"] = begin_s + since_s
    table["temperature_c"] = rng.uniform(0.5, 36.0) + rng.normal(0, 0.9, slot.size)
    return table.assign(channel=9, prf_mhz=64.0)


def _pushed(rng: np.random.Generator, since_s: Floats, still: bool) -> pd.DataFrame:
    """Return how a barrow is pushed along an aisle, slower or faster, and where its tag is."""
    pace = 0.0 if still else rng.uniform(0.6, 1.7)
    gains = 0.0 if still else rng.uniform(-0.12, 0.16)
    aisle = 0.5 * np.pi * rng.integers(4) + rng.normal(0, 0.06)
    gone = pace * since_s + 0.5 * gains * since_s**2
    begin = rng.uniform([6.2, 6.2, 0.7], [WIDE_M - 6.2, LONG_M - 6.2, 1.5])
    return pd.DataFrame(
        {
            "aisle_rad": aisle + 0 * since_s,
            "pace_m_per_s": pace + gains * since_s,
            "gains_m_per_s2": gains + 0 * since_s,
            "tx_x_m": begin[0] + np.cos(aisle) * gone,
            "tx_y_m": begin[1] + np.sin(aisle) * gone,
            "tx_z_m": begin[2] + 0 * since_s,
        }
    )


def _what_stands(rng: np.random.Generator, links: pd.Series, steel: float) -> pd.Series:
    """Return what stands in straight paths: a tank of steel, something full, or nothing."""
    names = links.unique()
    tank = rng.random(names.size) < steel
    there = rng.random((names.size, len(FILLED))) < 0.16
    kinds = np.array([*FILLED])
    some = [["metal"] if one else kinds[row].tolist() for one, row in zip(tank, there, strict=True)]
    return links.map(dict(zip(names, some, strict=True)))


def over_tiles(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: nearly as in the open, more where aisles of steel lead [n]."""
    decades = np.log10(rows["true_range_m"].to_numpy(np.float64))
    along = (rows["tx_y_m"] - rows["rx_y_m"]).abs().to_numpy(np.float64) / LONG_M
    return np.asarray(-64.9 - 20.3 * decades + 1.8 * along)


def _polled(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the brewery's own radio."""
    size = len(rows)
    names, back = np.unique(rows["link"].to_numpy(str), return_inverse=True)
    level = over_tiles(rows) + rng.triangular(-2.6, 0, 2.6, names.size)[back]
    level += rng.normal(0, 0.35, size) + rng.uniform(-0.4, 0.4, size)
    error = 0.0155 * scatter * (rng.gamma(16.0, 0.25, size) - 4.0)
    out = rows.assign(error_m=error, range_m=rows["true_range_m"] + error, rx_power_dbm=level)
    out["first_path_power_dbm"] = level - 0.55 - 2.8 * rng.beta(1.3, 3.0, size)
    out["noise_std"] = 69.0 + rng.normal(0, 1.9, size)
    out["preamble_count"] = 249.0 - rng.binomial(12, 0.35, size)
    return out


def _brewed(
    table: pd.DataFrame, drawn: Draw, seed: int, rng: np.random.Generator
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    added: dict[str, Floats] = {}
    late = [name for name in WRITTEN_LAST if name in drawn.hidden]
    for name in [*(one for one in drawn.hidden if one not in late), *late]:
        brew = EFFECTS[name](Batch(table, seed, rng, drawn.rare != ""), drawn.strength)
        added[name] = brew.metres
        table = _poured(table, brew)
    metres = [added[name] for name in drawn.hidden]
    return table, np.array(metres, np.float64).reshape(len(metres), len(table))


def _poured(table: pd.DataFrame, brew: Brew) -> pd.DataFrame:
    """Return the table with what is added to its rows."""
    out = table.copy()
    out["error_m"] = out["error_m"] + brew.metres
    out["range_m"] = out["true_range_m"] + out["error_m"]
    out["rx_power_dbm"] = out["rx_power_dbm"] + brew.whole + 0.65 * np.asarray(brew.edge)
    out["first_path_power_dbm"] = out["first_path_power_dbm"] + brew.whole + brew.edge
    for name, db in (("noise_std", brew.hiss), ("preamble_count", brew.count)):
        out[name] = out[name] * np.exp(np.log(10) / 20 * np.asarray(db))
    return out
