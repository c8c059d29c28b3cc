"""Skips, tubs, booms and lamps of a colliery, ranged from props in an underground hall.

numpy and pandas alone; what it can hide is in `colliery_effects`, waveforms in `colliery_waves`.
Hall, channel and line of sight are known. Props answer in slots by lot, some in every other round.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.colliery_effects import EFFECTS
from bench.challenge.families.colliery_faults import open_db
from bench.challenge.families.colliery_pit import COURSE, LAWS, PROPS, TAGS, Burden, Tally
from bench.challenge.families.colliery_shift import RARELY, worked

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Tally", "hidden_in", "known", "tables"]
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
    "noise-floor": "drill_bpm",
    "stone-dust-lies-on-props": "dust_g",
    "roof-drips-on-covers": "drip_ml",
    "conveyor-runs-close-by": "belt_gap_m",
    "covers-soak-since-they-were-hung": "hung_d",
    "chocks-stand-beside": "chocks",
    "belt-idlers-pass": "belt_m",
    "drives-cut-off-at-firedamp": "ch4_pct",
    "haze-that-draught-clears": "haze_pct",
    "drilling-shakes-booms": "drill_bpm",
}
LAST_OF_ALL = ("lachters-from-one-prop", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SYMBOLS, GRAIN = 1012, 2.55  # asked for; counts of noise for each root of one
PROP_DB: Floats = 1.1 * np.cos(2.1 * np.arange(PROPS) + 0.3)
TAG_DB: Floats = 1.0 * np.sin(1.9 * np.arange(len(TAGS)) + 2.0)
STRAIGHT = 0.6  # of all that comes is of first paths
MEASURED = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
            "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the colliery's own."""
    rng = np.random.default_rng([seed, 3401])
    shift = thinned(worked(rng, drawn.rare), drawn, near=True)
    clean = _ranged(shift, rng, drawn.scatter)
    other = shift if drawn.paired else next_shift(worked(rng, drawn.rare), drawn)
    again = pd.concat([other] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(again, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return worked(np.random.default_rng([seed, 3401]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    found, added_m = _burdened(clean, drawn, seed, 1)
    truth, _ = _burdened(simulated, drawn, seed, 2)
    four = [as_shown(one, drawn.listed) for one in (found, clean, simulated, truth)]
    return Tables(four[0], four[1], four[2], four[3], added_m)


def as_shown(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is shown: no courses, and obstacles only if they are listed."""
    kept = table.drop(columns=[*COURSE])
    return kept if listed else kept.drop(columns="obstacles")


def next_shift(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other winds, whose links are none of the recorded ones."""
    kept = thinned(rows, drawn, near=False)
    return kept.assign(link="next shift, " + kept["link"])


def thinned(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, mostly those of near links, or of far ones.

    Links stay the less likely the later they are by distance: multiples of one over the
    supergolden number tell which.
    """
    if drawn.same_mix:
        return rows
    far = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=near)
    order = np.arange(len(far))
    kept = far.index[np.mod(order / 1.465571232, 1.0) > 1.35 * order / len(far) - 0.3]
    return rows[rows["link"].isin(kept)].reset_index(drop=True)


def in_the_hall(tally: Tally) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links."""
    fades = tally.by_link(lambda n: tally.rng.triangular(-3.4, 0.6, 2.8, n))
    return open_db(tally.far) + PROP_DB[tally.prop] + TAG_DB[tally.tag] + fades


def counted(tally: Tally) -> tuple[Floats, Floats]:
    """Return how many symbols are counted, and what is told of noise in counts, [n] each."""
    missed = tally.rng.negative_binomial(2, 0.13, tally.rows).clip(max=110)
    symbols = np.asarray(SYMBOLS - missed, np.float64)
    loud = 0.03 * PROP_DB[tally.prop] + 0.03 * chances(tally.rng, tally.rows)
    return symbols, GRAIN * np.sqrt(symbols) * np.exp(loud)


def chances(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1: a bell that ends, as a power of a parabola has it [n]."""
    return np.asarray((2 * rng.beta(7.0, 7.0, rows) - 1) * np.sqrt(15.0))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the colliery's own ranges and levels.

    Errors are bells that end, wider where it is weak; links keep a little of their own.
    """
    tally = Tally(rows, 0, rng)
    level = in_the_hall(tally)
    wide = 0.0122 * np.sqrt(1 + 10 ** ((-95.0 - level) / 9))
    kept = tally.by_link(lambda n: 0.009 * (rng.random((3, n)).sum(axis=0) - 1.5))
    error = scatter * (wide * chances(rng, tally.rows) + kept)
    symbols, noise = counted(tally)
    every = level + 0.3 * chances(rng, tally.rows)
    first = level - 2.1 + 0.4 * chances(rng, tally.rows)
    made = (error, tally.far + error, every, first, noise, symbols)
    return rows.assign(**dict(zip(MEASURED, made, strict=True)))


def _burdened(
    table: pd.DataFrame, drawn: Draw, seed: int, side: int
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    added_m: dict[str, Floats] = {}
    for name in sorted(drawn.hidden, key=lambda one: (one in LAST_OF_ALL, one)):
        rng = np.random.default_rng([seed, 3402, side, *name.encode()])
        load = EFFECTS[name](Tally(table, seed, rng, bool(drawn.rare)), drawn.strength)
        added_m[name] = np.zeros(len(table)) + load.late_m
        table = _borne(table, load)
    made = np.zeros((len(drawn.hidden), len(table)))
    for row, name in enumerate(drawn.hidden):
        made[row] = added_m[name]
    return table, made


def _borne(table: pd.DataFrame, load: Burden) -> pd.DataFrame:
    """Return the table with what its rows bear.

    What is told of noise falls by the root of symbols that are not counted.
    """
    first, count_db = np.asarray(load.first_db), np.asarray(load.count_db)
    left_db = 10 * np.log10(1 - STRAIGHT + STRAIGHT * 10 ** (first / 10))
    error = table["error_m"] + load.late_m
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + load.all_db + left_db,
        first_path_power_dbm=table["first_path_power_dbm"] + load.all_db + first,
        noise_std=table["noise_std"] * 10 ** ((np.asarray(load.noise_db) + count_db / 2) / 20),
        preamble_count=table["preamble_count"] * 10 ** (count_db / 20),
    )
