"""Bags, shuttles, trolleys and folders of a laundry, ranged by its louvres: ranges and levels.

numpy and pandas alone; what it can hide is in `laundry_effects`, waveforms in `laundry_waves`. The
hall, the channel and line of sight are known. Louvres ask, tags answer and log what they hear.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.laundry_day import RARELY, worked
from bench.challenge.families.laundry_effects import EFFECTS
from bench.challenge.families.laundry_faults import open_db
from bench.challenge.families.laundry_plan import COURSE, LAWS, LOUVRES, TAGS, Change, Errand

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Change", "Errand", "hidden_in", "known", "tables"]
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
    "noise-floor": "time_s",
    "lint-on-grilles": "lint_g",
    "piles-tower-up": "pile_cm",
    "presses-close-by": "press_m",
    "softener-films-tags": "softener_ml",
    "ironers-steam": "steam_kgh",
    "drum-ribs-pass": "drum_m",
    "dock-doors-rolled-up": "door_pct",
    "springs-sink-laden": "linen_kg",
}
AT_LAST = ("aunes-from-one-louvre", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SYMBOLS, GRAIN = 1010.0, 2.85  # counted; counts of noise for each root of one
LOUVRE_DB: Floats = 1.5 * np.cos(2.4 * np.arange(LOUVRES))
TAG_DB: Floats = np.random.default_rng(2301).uniform(-0.8, 0.8, len(TAGS))
EARLY = 0.55  # of all that comes is of first paths
MEASURED = (
    "error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std", "preamble_count"
)  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the laundry's own."""
    rng = np.random.default_rng([seed, 2302])
    clean = _ranged(shortened(worked(rng, drawn.rare), drawn, True), rng, drawn.scatter)
    rows = clean.drop(columns=list(MEASURED))
    if not drawn.paired:
        rows = next_day(worked(rng, drawn.rare), drawn)
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(more, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return worked(np.random.default_rng([seed, 2302]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _undergone(clean, drawn, seed, 1)
    truth, _ = _undergone(simulated, drawn, seed, 2)
    every = (recorded, clean, simulated, truth)
    found, plain, other, true = (as_kept(one, drawn.listed) for one in every)
    return Tables(found, plain, other, true, metres)


def as_kept(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is kept: no courses, and obstacles only if they are listed."""
    untold = [*COURSE] if listed else [*COURSE, "obstacles"]
    return table.drop(columns=untold, errors="ignore")


def next_day(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other errands, whose links are none of the recorded ones."""
    return shortened(rows, drawn, False).assign(link=lambda one: "next day, " + one["link"])


def shortened(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of near links mostly, or of far ones.

    Of ten links in turn, from the nearest or from the farthest on, the more are left out the later.
    """
    if drawn.same_mix:
        return rows
    order = rows.groupby("link")["true_range_m"].mean().rank(method="first", ascending=near) - 1
    tenth = (10 * order / len(order)).astype(int)
    stays = (tenth < 4) | (order % (tenth + 1) == 0)
    return rows[rows["link"].map(stays).to_numpy(bool)].reset_index(drop=True)


def in_the_hall(rows: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links."""
    errand = Errand(rows, 0, rng)
    fades = errand.of_links(lambda n: 10 * np.log10(rng.gamma(6.0, 1 / 6, n).clip(0.3)))
    return open_db(errand.far) + LOUVRE_DB[errand.louvre] + TAG_DB[errand.tag] + fades


def counted(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return how many symbols are counted, and what is told of noise in counts, [n] each."""
    symbols = SYMBOLS - np.floor(rng.gamma(2.0, 4.0, len(rows)).clip(max=40.0))
    own = 1 + 0.03 * TAG_DB[Errand(rows, 0, rng).tag]
    scatter = rng.uniform(0.95, 1.05, len(rows))
    return symbols, np.asarray(GRAIN * np.sqrt(symbols) * own * scatter)


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the laundry's own ranges and levels.

    Errors are of a bell, wider on some links than on others, and wider where it is weak; links keep
    a little of their own.
    """
    level, size, errand = in_the_hall(rows, rng), len(rows), Errand(rows, 0, rng)
    wide = 0.016 * np.sqrt(1 + 10 ** ((-88.0 - level) / 10))
    wide = wide * errand.of_links(lambda n: rng.uniform(0.7, 1.3, n))
    kept = errand.of_links(lambda n: 0.015 * (rng.beta(2.0, 2.0, n) - 0.5))
    error = scatter * (wide * rng.normal(size=size) + kept)
    symbols, noise = counted(rows, rng)
    level = level + 0.24 * rng.normal(size=size)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.3 - rng.exponential(1.0, (2, size)).clip(max=4.0).sum(0),
        noise_std=noise,
        preamble_count=symbols,
    )


def _undergone(
    table: pd.DataFrame, drawn: Draw, seed: int, side: int
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    added = {name: np.zeros(len(table)) for name in drawn.hidden}
    first = sorted(name for name in drawn.hidden if name not in AT_LAST)
    for name in (*first, *(name for name in AT_LAST if name in drawn.hidden)):
        own = np.random.default_rng([seed, 2306, side, *name.encode()])
        change = EFFECTS[name](Errand(table, seed, own, bool(drawn.rare)), drawn.strength)
        added[name] += change.metres
        table = _changed(table, change)
    return table, np.array([added[name] for name in drawn.hidden]).reshape(-1, len(table))


def _changed(table: pd.DataFrame, change: Change) -> pd.DataFrame:
    """Return the table with what becomes of its rows.

    What is told of noise falls by the root of symbols that are not counted.
    """
    first, fewer = np.asarray(change.first_db), np.asarray(change.count_db)
    every = 10 * np.log10(1 - EARLY + EARLY * 10 ** (first / 10)) + change.all_db
    error = table["error_m"] + change.metres
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + every,
        first_path_power_dbm=table["first_path_power_dbm"] + first + change.all_db,
        noise_std=table["noise_std"] * 10 ** ((np.asarray(change.noise_db) + 0.5 * fewer) / 20),
        preamble_count=table["preamble_count"] * 10 ** (fewer / 20),
    )
