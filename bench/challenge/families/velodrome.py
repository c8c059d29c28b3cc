"""Sprinters, dernies, slingers and holders of a velodrome, ranged from posts about its boards.

numpy and pandas alone; what it can hide is in `velodrome_effects`, waveforms in `velodrome_waves`.
Hall, channel and line of sight are known. Posts listen lap by lap, and drop out one by one.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.velodrome_effects import EFFECTS
from bench.challenge.families.velodrome_evening import RARELY, raced
from bench.challenge.families.velodrome_faults import open_db
from bench.challenge.families.velodrome_track import COURSE, LAWS, POSTS, TAGS, Handicap, Race

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Race", "hidden_in", "known", "tables"]
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
    "noise-floor": "derny_rpm",
    "wax-films-the-posts": "wax_um",
    "boards-swell-in-damp": "damp_pct",
    "lap-board-close-by": "board_m",
    "chain-oil-on-tags": "oil_ul",
    "flags-wave-in-stands": "flags",
    "joists-pass-below": "under_m",
    "tunnel-gate-stands-open": "gate_pct",
    "fog-that-fans-thin": "fog_pct",
    "ignition-pulls-dernies-tags": "derny_rpm",
}
AFTER_ALL = ("endazes-from-one-post", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SYMBOLS, GRAIN = 1009, 2.5  # asked for; counts of noise for each root of one
POST_DB: Floats = 1.0 * np.sin(2.4 * np.arange(POSTS) + 0.6)
TAG_DB: Floats = 1.1 * np.cos(1.7 * np.arange(len(TAGS)) + 1.1)
EARLY = 0.62  # of all that comes is of first paths
MEASURED = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
            "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the velodrome's own."""
    rng = np.random.default_rng([seed, 3301])
    evening = weeded(raced(rng, drawn.rare), drawn, near=True)
    clean = _ranged(evening, rng, drawn.scatter)
    other = evening if drawn.paired else next_meeting(raced(rng, drawn.rare), drawn)
    again = pd.concat([other] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(again, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return raced(np.random.default_rng([seed, 3301]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    found, added_m = _handicapped(clean, drawn, seed, 1)
    truth, _ = _handicapped(simulated, drawn, seed, 2)
    four = [as_published(one, drawn.listed) for one in (found, clean, simulated, truth)]
    return Tables(four[0], four[1], four[2], four[3], added_m)


def as_published(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is published: no courses, and obstacles only if they are listed."""
    kept = table.drop(columns=[*COURSE])
    return kept if listed else kept.drop(columns="obstacles")


def next_meeting(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other races, whose links are none of the recorded ones."""
    kept = weeded(rows, drawn, near=False)
    return kept.assign(link="next meeting, " + kept["link"])


def weeded(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, mostly those of near links, or of far ones.

    Links stay the less likely the later they are by distance: multiples of one over the plastic
    number (van der Laan) tell which.
    """
    if drawn.same_mix:
        return rows
    far = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=near)
    order = np.arange(len(far))
    kept = far.index[np.mod(order / 1.324717957, 1.0) > 1.3 * order / len(far) - 0.3]
    return rows[rows["link"].isin(kept)].reset_index(drop=True)


def in_the_hall(race: Race) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links."""
    fades = race.per_link(lambda n: 5.0 * race.rng.beta(2.6, 2.2, n) - 2.7)
    return open_db(race.far) + POST_DB[race.post] + TAG_DB[race.tag] + fades


def counted(race: Race) -> tuple[Floats, Floats]:
    """Return how many symbols are counted, and what is told of noise in counts, [n] each."""
    missed = race.rng.binomial(90, race.rng.beta(1.2, 6.0, race.rows))
    symbols = np.asarray(SYMBOLS - missed, np.float64)
    loud = 0.03 * POST_DB[race.post] + 0.03 * chances(race.rng, race.rows)
    return symbols, GRAIN * np.sqrt(symbols) * np.exp(loud)


def chances(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1: differences of two counts of forty coins, blurred [n]."""
    coins = np.subtract(*rng.binomial(40, 0.5, (2, rows)))
    return np.asarray((coins + rng.uniform(-0.5, 0.5, rows)) / np.sqrt(20 + 1 / 12))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the velodrome's own ranges and levels.

    Errors are like counts of coins, wider where it is weak; links keep a little of their own.
    """
    race = Race(rows, 0, rng)
    level = in_the_hall(race)
    wide = 0.0118 * (1 + 10 ** ((-97.0 - level) / 14))
    kept = race.per_link(lambda n: 0.02 * (rng.beta(3.0, 3.0, n) - 0.5))
    error = scatter * (wide * chances(rng, race.rows) + kept)
    symbols, noise = counted(race)
    every = level + 0.3 * chances(rng, race.rows)
    first = level - 1.9 + 0.4 * chances(rng, race.rows)
    made = (error, race.far + error, every, first, noise, symbols)
    return rows.assign(**dict(zip(MEASURED, made, strict=True)))


def _handicapped(
    table: pd.DataFrame, drawn: Draw, seed: int, side: int
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    added_m: dict[str, Floats] = {}
    for name in sorted(drawn.hidden, key=lambda one: (one in AFTER_ALL, one)):
        rng = np.random.default_rng([seed, 3302, side, *name.encode()])
        load = EFFECTS[name](Race(table, seed, rng, bool(drawn.rare)), drawn.strength)
        added_m[name] = np.zeros(len(table)) + load.late_m
        table = _borne(table, load)
    made = np.zeros((len(drawn.hidden), len(table)))
    for row, name in enumerate(drawn.hidden):
        made[row] = added_m[name]
    return table, made


def _borne(table: pd.DataFrame, load: Handicap) -> pd.DataFrame:
    """Return the table with what its rows bear.

    What is told of noise falls by the root of symbols that are not counted.
    """
    first, count_db = np.asarray(load.first_db), np.asarray(load.count_db)
    left_db = 10 * np.log10(1 - EARLY + EARLY * 10 ** (first / 10))
    error = table["error_m"] + load.late_m
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + load.all_db + left_db,
        first_path_power_dbm=table["first_path_power_dbm"] + load.all_db + first,
        noise_std=table["noise_std"] * 10 ** ((np.asarray(load.noise_db) + count_db / 2) / 20),
        preamble_count=table["preamble_count"] * 10 ** (count_db / 20),
    )
