"""Augers, buckets, sacks and barrows of a granary, ranged from spouts about its bins.

numpy and pandas alone; what it can hide is in `granary_effects`, waveforms in `granary_waves`.
Hall, channel and line of sight are known. Spouts contend for slots, and wait longer if they clash.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.granary_bins import COURSE, LAWS, SPOUTS, TAGS, Docket, Freight
from bench.challenge.families.granary_effects import EFFECTS
from bench.challenge.families.granary_faults import open_dbm
from bench.challenge.families.granary_harvest import RARELY, harvested

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Docket", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = {
    "time-lag": "time_s",
    "antenna-delay": "time_s",
    "exchange-motion": "reply_time_s",
    "clock-offset": "reply_time_s",
    "range-scale": "true_range_m",
    "power-bias": "true_range_m",
    "path-loss": "true_range_m",
    "level-control": "true_range_m",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "noise-floor": "mill_kw",
    "chaff-clings-to-spouts": "chaff_g",
    "meal-cakes-on-covers": "caked_mm",
    "drier-stands-close-by": "drier_gap_m",
    "tallow-creeps-since-greased": "greased_h",
    "sacks-lean-on-posts": "sacks",
    "chain-pins-pass": "chain_m",
    "magnet-drum-holds-nails": "magnet_a",
    "damp-wheat-heats": "moist_pct",
    "walls-bulge-when-filled": "filled_pct",
}
AT_THE_VERY_END = ("famnar-from-one-spout", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SYMBOLS, GRAIN = 1018, 2.48  # asked for; counts of noise for each root of one
SPOUT_DB: Floats = 1.2 * np.sin(2.7 * np.arange(SPOUTS) + 1.1)
TAG_DB: Floats = 0.9 * np.cos(2.3 * np.arange(len(TAGS)) + 0.6)
STRAIGHT = 0.58  # of all that comes is of first paths
MEASURED = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
            "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the granary's own."""
    rng = np.random.default_rng([seed, 3501])
    day = thinned(harvested(rng, drawn.rare), drawn, near=True)
    clean = _ranged(day, rng, drawn.scatter)
    other = day if drawn.paired else another_day(harvested(rng, drawn.rare), drawn)
    again = pd.concat([other] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(again, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return harvested(np.random.default_rng([seed, 3501]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    found, added_m = _laden(clean, drawn, seed, 1)
    truth, _ = _laden(simulated, drawn, seed, 2)
    four = [as_shown(one, drawn.listed) for one in (found, clean, simulated, truth)]
    return Tables(four[0], four[1], four[2], four[3], added_m)


def as_shown(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is shown: no courses, and obstacles only if they are listed."""
    away = [*COURSE] if listed else [*COURSE, "obstacles"]
    return table.drop(columns=away)


def another_day(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other loads, whose links are none of the recorded ones."""
    kept = thinned(rows, drawn, near=False)
    return kept.assign(link="another day, " + kept["link"])


def thinned(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, mostly those of near links, or of far ones.

    Links stay the less likely the later they are by distance: multiples of one over the
    tribonacci number tell which.
    """
    if drawn.same_mix:
        return rows
    means = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=near)
    part = np.arange(len(means)) / len(means)
    lots = (np.arange(len(means)) / 1.8392867552) % 1.0
    kept = means.index[lots > 1.3 * part - 0.25]
    return rows[rows["link"].isin(kept)].reset_index(drop=True)


def in_the_granary(docket: Docket) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links."""
    fades = docket.per_link(lambda n: 4.2 * (docket.rng.beta(3.0, 2.2, n) - 3.0 / 5.2) * 2)
    return open_dbm(docket.far) + SPOUT_DB[docket.spout] + TAG_DB[docket.tag] + fades


def added_up(docket: Docket) -> tuple[Floats, Floats]:
    """Return how many symbols are added up, and what is told of noise in counts, [n] each."""
    missed = docket.rng.geometric(0.075, (2, docket.count)).sum(axis=0).clip(max=110)
    symbols = np.asarray(SYMBOLS - missed, np.float64)
    loud = 0.03 * SPOUT_DB[docket.spout] + 0.03 * chances(docket.rng, docket.count)
    return symbols, GRAIN * np.sqrt(symbols) * np.exp(loud)


def chances(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1: a bell, and beside it even chances [n]."""
    even = np.sqrt(3.0) * rng.uniform(-1.0, 1.0, rows)
    return np.asarray(0.8 * rng.normal(size=rows) + 0.6 * even)


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the granary's own ranges and levels.

    Errors are wider where it is weak; links keep a little of their own.
    """
    docket = Docket(rows, 0, rng)
    level = in_the_granary(docket)
    wide = 0.0115 + 0.009 * np.exp((-92.0 - level) / 6).clip(max=3.0)
    kept = docket.per_link(lambda n: rng.triangular(-0.012, 0.0, 0.012, n))
    error = scatter * (wide * chances(rng, docket.count) + kept)
    symbols, noise = added_up(docket)
    every = level + 0.28 * chances(rng, docket.count)
    first = level - 10 * np.log10(1 / STRAIGHT) + 0.4 * chances(rng, docket.count)
    made = (error, docket.far + error, every, np.minimum(first, every), noise, symbols)
    return rows.assign(**dict(zip(MEASURED, made, strict=True)))


def _laden(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    added_m = np.zeros((len(drawn.hidden), len(table)))
    for name in sorted(drawn.hidden, key=lambda one: (one in AT_THE_VERY_END, one)):
        rng = np.random.default_rng([seed, 3502, side, *name.encode()])
        freight = EFFECTS[name](Docket(table, seed, rng, bool(drawn.rare)), drawn.strength)
        added_m[drawn.hidden.index(name)] = freight.late_m
        table = _with(table, freight)
    return table, added_m


def _with(table: pd.DataFrame, freight: Freight) -> pd.DataFrame:
    """Return the table with what its rows carry.

    What is told of noise falls by the root of symbols that are not added up.
    """
    first, count_db = np.asarray(freight.first_db), np.asarray(freight.count_db)
    left_db = 10 * np.log10(1 - STRAIGHT * (1 - 10 ** (first / 10)))
    error = table["error_m"] + freight.late_m
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + freight.all_db + left_db,
        first_path_power_dbm=table["first_path_power_dbm"] + freight.all_db + first,
        noise_std=table["noise_std"] * 10 ** ((np.asarray(freight.noise_db) + count_db / 2) / 20),
        preamble_count=table["preamble_count"] * 10 ** (count_db / 20),
    )
