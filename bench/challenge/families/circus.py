"""Fliers, spinners, cyclists and walkers of a circus, ranged from poles of its big top.

numpy and pandas alone; what it can hide is in `circus_effects`, waveforms in `circus_waves`. Tent,
channel and line of sight are known. Poles listen in slots that are powers of two (Welch, Costas).
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.circus_effects import EFFECTS
from bench.challenge.families.circus_faults import open_db
from bench.challenge.families.circus_show import RARELY, staged
from bench.challenge.families.circus_tent import COURSE, LAWS, POLES, TAGS, Act, Trick

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Act", "hidden_in", "known", "tables"]
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
    "noise-floor": "dim_pct",
    "chalk-dusts-the-poles": "chalk_mg",
    "rain-soaks-the-canvas": "rain_mm",
    "lions-cage-close-by": "cage_m",
    "rosin-on-tags": "rosin_g",
    "crowd-leans-in": "watchers",
    "fence-panels-pass": "fence_m",
    "sides-laced-up": "laced_pct",
    "smoke-under-lamps": "smoke_pct",
    "gusts-rack-their-poles": "gust_ms",
}
AFTER_ALL = ("arshins-from-one-pole", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SYMBOLS, GRAIN = 1013, 2.6  # asked for; counts of noise for each root of one
POLE_DB: Floats = 1.2 * np.cos(2.0 * np.arange(POLES) + 0.9)
TAG_DB: Floats = 1.3 * np.sin(2.0 * np.arange(len(TAGS)) + 0.2)
EARLY = 0.6  # of all that comes is of first paths
MEASURED = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
            "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the circus' own."""
    rng = np.random.default_rng([seed, 2902])
    day = thinned(staged(rng, drawn.rare), drawn, near=True)
    clean = _ranged(day, rng, drawn.scatter)
    other = day if drawn.paired else next_town(staged(rng, drawn.rare), drawn)
    again = pd.concat([other] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(again, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return staged(np.random.default_rng([seed, 2902]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    found, added_m = _performed(clean, drawn, seed, 1)
    truth, _ = _performed(simulated, drawn, seed, 2)
    four = (found, clean, simulated, truth)
    found, clean, simulated, truth = (as_handed_on(one, drawn.listed) for one in four)
    return Tables(found, clean, simulated, truth, added_m)


def as_handed_on(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is handed on: no courses, and obstacles only if they are listed."""
    secret = {*COURSE} if listed else {*COURSE, "obstacles"}
    return table[[name for name in table if name not in secret]]


def next_town(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other acts, whose links are none of the recorded ones."""
    kept = thinned(rows, drawn, near=False)
    return kept.assign(link="next town, " + kept["link"])


def thinned(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, mostly those of near links, or of far ones.

    Links are kept by distance, the fewer the later: those whose number by the golden ratio (Weyl)
    is above what is to be left out.
    """
    if drawn.same_mix:
        return rows
    far = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=near)
    order = np.arange(len(far))
    lot = order * (np.sqrt(5.0) - 1) / 2 % 1.0
    kept = far.index[lot > 1.25 * (order / len(far)) - 0.32]
    return rows[rows["link"].isin(kept)].reset_index(drop=True)


def in_the_tent(act: Act) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links."""
    fades = act.by_link(lambda n: act.rng.triangular(-3.0, 0.4, 2.6, n))
    return open_db(act.far) + POLE_DB[act.pole] + TAG_DB[act.tag] + fades


def counted(act: Act) -> tuple[Floats, Floats]:
    """Return how many symbols are counted, and what is told of noise in counts, [n] each."""
    missed = np.minimum(act.rng.geometric(0.07, act.rows), 80)
    symbols = np.asarray(SYMBOLS - missed, np.float64)
    loud = 0.026 * POLE_DB[act.pole] + 0.03 * chances(act.rng, act.rows)
    return symbols, GRAIN * np.sqrt(symbols) * np.exp(loud)


def chances(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1: sums of five even ones [rows]."""
    return np.asarray(rng.uniform(-1.0, 1.0, (5, rows)).sum(axis=0) / np.sqrt(5 / 3))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the circus' own ranges and levels.

    Errors are sums of even chances, and wider where it is weak; links keep a little of their own.
    """
    act = Act(rows, 0, rng)
    level = in_the_tent(act)
    wide = 0.0124 * np.sqrt(1 + 10 ** ((-96.0 - level) / 10))
    kept = act.by_link(lambda n: rng.triangular(-0.01, 0.0, 0.01, n))
    error = scatter * (wide * chances(rng, act.rows) + kept)
    symbols, noise = counted(act)
    every = level + 0.3 * chances(rng, act.rows)
    first = every - 0.25 - 3.1 * rng.beta(2.0, 3.6, act.rows)
    made = (error, act.far + error, every, first, noise, symbols)
    return rows.assign(**dict(zip(MEASURED, made, strict=True)))


def _performed(
    table: pd.DataFrame, drawn: Draw, seed: int, side: int
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    added_m: dict[str, Floats] = {}
    late = [name for name in AFTER_ALL if name in drawn.hidden]
    for name in [*sorted({*drawn.hidden} - {*late}), *late]:
        rng = np.random.default_rng([seed, 2906, side, *name.encode()])
        trick = EFFECTS[name](Act(table, seed, rng, bool(drawn.rare)), drawn.strength)
        added_m[name] = np.zeros(len(table)) + trick.late_m
        table = _borne(table, trick)
    rows = [added_m[name] for name in drawn.hidden]
    return table, np.array(rows).reshape(len(rows), len(table))


def _borne(table: pd.DataFrame, trick: Trick) -> pd.DataFrame:
    """Return the table with what its rows bear.

    What is told of noise falls by the root of symbols that are not counted.
    """
    first, count_db = np.asarray(trick.first_db), np.asarray(trick.count_db)
    left_db = 10 * np.log10(1 + EARLY * (10 ** (first / 10) - 1))
    error = table["error_m"] + trick.late_m
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + trick.all_db + left_db,
        first_path_power_dbm=table["first_path_power_dbm"] + trick.all_db + first,
        noise_std=table["noise_std"] * 10 ** ((np.asarray(trick.noise_db) + count_db / 2) / 20),
        preamble_count=table["preamble_count"] * 10 ** (count_db / 20),
    )
