"""Rakers, tippers, harvesters and punts of a saltworks, ranged by vanes of wind pumps.

numpy and pandas alone; what it can hide is in `saltworks_effects`, waveforms in `saltworks_waves`.
The channel and line of sight are known; there is no room. Vanes ask when they like, ever later.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.saltworks_day import RARELY, worked
from bench.challenge.families.saltworks_effects import EFFECTS
from bench.challenge.families.saltworks_faults import open_db
from bench.challenge.families.saltworks_pans import COURSE, LAWS, TAGS, VANES, Haul, Levy

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Haul", "hidden_in", "known", "tables"]
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
    "noise-floor": "wind_ms",
    "sails-furled": "wind_ms",
    "spray-blown-across": "wind_ms",
    "brine-deepens": "brine_cm",
    "gypsum-crusts-on-lids": "crust_um",
    "iodine-stains-copper": "iodine_ug",
    "salt-heap-close-by": "heap_m",
    "gulls-sit-on-booms": "gulls",
    "rope-clamps-pass": "haul_m",
    "one-phase-sags-while-hauling": "haul_a",
}
LAST = ("ken-from-one-vane", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SYMBOLS, GRAIN = 1011, 2.6  # asked for; counts of noise for each root of one
VANE_DB: Floats = 1.2 * np.cos(2.4 * np.arange(VANES))
TAG_DB: Floats = np.random.default_rng(2601).uniform(-1.3, 1.3, len(TAGS))
EARLY = 0.56  # of all that comes is of first paths
LEVELS = ("rx_power_dbm", "first_path_power_dbm")
UNTOLD = ("error_m", "range_m", *LEVELS, "noise_std", "preamble_count")
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the saltworks' own."""
    rng = np.random.default_rng([seed, 2602])
    day = thinned(worked(rng, drawn.rare), drawn, 1.0)
    clean = _ranged(day, rng, drawn.scatter)
    other = day if drawn.paired else next_day(worked(rng, drawn.rare), drawn)
    often = pd.concat([other] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(often, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return worked(np.random.default_rng([seed, 2602]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, added_m = _levied(clean, drawn, seed, 1)
    true = _levied(simulated, drawn, seed, 2)[0]
    recorded, clean, simulated, true = (
        entered(one, drawn.listed) for one in (recorded, clean, simulated, true)
    )
    return Tables(recorded, clean, simulated, true, added_m)


def entered(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is entered: no courses, and obstacles only if they are listed."""
    away = [*COURSE] if listed else [*COURSE, "obstacles"]
    return table.drop(columns=away, errors="ignore")


def next_day(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other turns, whose links are none of the recorded ones."""
    kept = thinned(rows, drawn, -1.0)
    return kept.assign(link="next day, " + kept["link"])


def thinned(rows: pd.DataFrame, drawn: Draw, sign: float) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of near links mostly, or of far ones.

    Of each seven links by distance from the nearest on or, by the `sign`, from the farthest, fewer
    and fewer stay.
    """
    if drawn.same_mix:
        return rows
    order = rows.groupby("link")["true_range_m"].median().mul(sign).sort_values(kind="stable")
    seventh = 7 * np.arange(len(order)) // len(order)
    within = np.arange(len(order)) % 7
    stays = order.index[within < np.array([7, 7, 6, 4, 3, 1, 1])[seventh]]
    return rows[rows["link"].isin(stays)].reset_index(drop=True)


def at_the_works(haul: Haul) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links."""
    fades = haul.each(lambda n: 10 * np.log10(haul.rng.gamma(7.0, 1 / 7.0, n).clip(0.4, 2.2)))
    return open_db(haul.far) + VANE_DB[haul.vane] + TAG_DB[haul.tag] + fades


def counted(haul: Haul) -> tuple[Floats, Floats]:
    """Return how many symbols are counted, and what is told of noise in counts, [n] each."""
    missed = haul.rng.binomial(60, haul.rng.beta(1.5, 6.0, len(haul.far)))
    symbols = np.asarray(SYMBOLS - missed, np.float64)
    own = 1 + 0.03 * VANE_DB[haul.vane] + 0.028 * haul.rng.normal(size=len(symbols)).clip(-3, 3)
    return symbols, GRAIN * np.sqrt(symbols) * own


def logistic(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances of Verhulst's law that scatter by about 1, cut off at 4.2 [n]."""
    even = rng.uniform(0.0005, 0.9995, rows)
    return np.asarray(np.sqrt(3.0) / np.pi * np.log(even / (1 - even)))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the saltworks' own ranges and levels.

    Errors are of Verhulst's law, and wider where it is weak; links keep a little of their own.
    """
    haul, size = Haul(rows, 0, rng), len(rows)
    level = at_the_works(haul)
    wide = 0.0125 * np.sqrt(1 + 10 ** ((-90.0 - level) / 10))
    kept = haul.each(lambda n: rng.uniform(-0.008, 0.008, n))
    error = scatter * (wide * logistic(rng, size) + kept)
    symbols, noise = counted(haul)
    every = level + rng.uniform(-0.35, 0.35, size)
    first = every - 0.3 - 1.5 * rng.gamma(1.8, 0.5, size).clip(max=3.4)
    made = (error, haul.far + error, every, first, noise, symbols)
    return rows.assign(**dict(zip(UNTOLD, made, strict=True)))


def _turn(name: str) -> tuple[int, str]:
    return LAST.index(name) if name in LAST else -1, name


def _levied(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    added_m = np.zeros((len(drawn.hidden), len(table)))
    for name in sorted(drawn.hidden, key=_turn):
        own = np.random.default_rng([seed, 2606, side, *name.encode()])
        levy = EFFECTS[name](Haul(table, seed, own, bool(drawn.rare)), drawn.strength)
        added_m[drawn.hidden.index(name)] = levy.get("m", 0.0)
        table = _owing(table, levy)
    return table, added_m


def _owing(table: pd.DataFrame, levy: Levy) -> pd.DataFrame:
    """Return the table with what its rows owe.

    What is told of noise falls by the root of symbols that are not counted.
    """
    m, every, first, noise, count = (
        np.zeros(len(table)) + levy.get(name, 0.0)
        for name in ("m", "all", "first", "noise", "count")
    )
    error = table["error_m"] + m
    lost = 10 * np.log10(1 - EARLY + EARLY * 10 ** (first / 10))
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + every + lost,
        first_path_power_dbm=table["first_path_power_dbm"] + every + first,
        noise_std=table["noise_std"] * 10 ** ((noise + count / 2) / 20),
        preamble_count=table["preamble_count"] * 10 ** (count / 20),
    )
