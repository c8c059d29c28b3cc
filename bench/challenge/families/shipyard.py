"""Cradles, drums, haulers and punts of a shipyard by day, ranged from derricks about its dock.

numpy and pandas alone; what it can hide is in `shipyard_effects`, waveforms in `shipyard_waves`.
Dock, channel and line of sight are known. Derricks answer at marks of a ruler.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.shipyard_effects import EFFECTS
from bench.challenge.families.shipyard_faults import open_dbm
from bench.challenge.families.shipyard_slip import COURSE, DERRICKS, LAWS, TAGS, Berth, Toll
from bench.challenge.families.shipyard_tide import RARELY, manned

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Berth", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = dict.fromkeys(("power-bias", "path-loss", "level-control", "range-scale"), "true_range_m")
CAUSES |= dict.fromkeys(("time-lag", "antenna-delay"), "time_s")
CAUSES |= dict.fromkeys(("exchange-motion", "clock-offset"), "reply_time_s")
CAUSES |= {
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "noise-floor": "weld_a",
    "salt-crusts-on-covers": "salt_g",
    "weed-grows-on-fenders": "weed_cm",
    "anvil-dragged-close-by": "anvil_gap_m",
    "caulking-dries-since-wetted": "wetted_h",
    "shackles-heaped-beside": "shackles",
    "ribs-of-the-hull-pass": "keel_m",
    "caisson-floats-at-a-draught": "draught_m",
    "mist-lies-up-to-a-height": "fog_m",
    "pontoon-rides-the-tide": "tide_m",
    "hull-lists-with-its-ballast": "ballast_t",
}
LAST = ("spans-from-one-derrick", "medians-of-three-sent", "range-rounding")
"""What becomes of ranges after all else, in this order."""
ASKED, GRAIN = 2048, 2.2  # symbols; counts of noise for each root of one
DERRICK_DB: Floats = 1.0 * np.cos(2.2 * np.arange(DERRICKS) + 0.9)
TAG_DB: Floats = 0.75 * np.sin(1.7 * np.arange(len(TAGS)) + 2.5)
FADES_DB = (1.5, 3.1)  # of links: how they scatter, and no more than so much
STRAIGHT = 0.58  # of all that comes is of first paths
OWN_M = 0.0048  # by which links' own errors scatter
MEASURED = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
            "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the shipyard's own."""
    rng = np.random.default_rng([3901, seed])
    day = thinned(manned(rng, drawn.rare), drawn, near=True)
    clean = _ranged(day, rng, drawn.scatter)
    if not drawn.paired:
        day = next_tide(manned(rng, drawn.rare), drawn)
    simulated = _ranged(pd.concat(drawn.ratio * [day], ignore_index=True), rng, drawn.scatter)
    return hidden_in(drawn, seed, clean, simulated)


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return manned(np.random.default_rng([3901, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts_m = _charged(clean, drawn, seed, 1)
    truth, _ = _charged(simulated, drawn, seed, 2)
    shown = [posted(one, drawn.listed) for one in (recorded, clean, simulated, truth)]
    return Tables(shown[0], shown[1], shown[2], shown[3], shifts_m)


def posted(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is posted up: no courses, and obstacles only if they are listed."""
    secret = [*COURSE] if listed else [*COURSE, "obstacles"]
    return table.drop(columns=secret)


def next_tide(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other jobs, whose links are none of the recorded ones."""
    kept = thinned(rows, drawn, near=False)
    return kept.assign(link="next tide, " + kept["link"])


def dithered(odds: Floats) -> NDArray[np.bool_]:
    """Return which are taken of so many in a row, by odds whose rests are carried on [n]."""
    whole = np.floor(np.cumsum(odds) + 0.5)
    return np.diff(whole, prepend=0.0) > 0


def thinned(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, mostly those of near links, or of far ones.

    Of links in order of distance ever fewer are taken.
    """
    if drawn.same_mix:
        return rows
    means = rows.groupby("link")["true_range_m"].mean()
    order = means.index[np.argsort(means if near else -means)]
    odds = np.clip(1.15 - 1.25 * np.linspace(0.0, 1.0, len(order)), 0.0, 1.0)
    return rows[rows["link"].isin(order[dithered(odds)])].reset_index(drop=True)


def in_the_dock(berth: Berth) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links."""
    wide, most = FADES_DB
    fades = berth.each(lambda n: berth.rng.normal(0.0, wide, n).clip(-most, most))
    return open_dbm(berth.far) + DERRICK_DB[berth.derrick] + TAG_DB[berth.tag] + fades


def summed_up(berth: Berth) -> tuple[Floats, Floats]:
    """Return how many symbols are added up, and what is told of noise in counts, [n] each."""
    missed = berth.rng.negative_binomial(2.0, 0.035, berth.rows).clip(max=260)
    symbols = ASKED - missed.astype(np.float64)
    loud = np.exp(0.024 * DERRICK_DB[berth.derrick] + 0.032 * whims(berth.rng, berth.rows))
    return symbols, GRAIN * loud * np.sqrt(symbols)


def whims(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1: what the first of two bells is the more likely for [n].

    A logarithm of odds that are even (Verhulst).
    """
    return np.asarray(np.sqrt(3) / np.pi * rng.logistic(size=rows).clip(-9.0, 9.0))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the shipyard's own ranges and levels.

    Errors are wider where it is weak; links keep a little of their own.
    """
    berth = Berth(rows, 0, rng)
    level = in_the_dock(berth)
    error = wide_m(level) * whims(rng, berth.rows)
    error = scatter * (error + berth.each(lambda n: rng.normal(0.0, OWN_M, n)))
    symbols, noise = summed_up(berth)
    every = level + 0.29 * whims(rng, berth.rows)
    first = level + 10 * np.log10(STRAIGHT) + 0.35 * whims(rng, berth.rows)
    made = (error, berth.far + error, every, np.minimum(first, every), noise, symbols)
    return rows.assign(**dict(zip(MEASURED, made, strict=True)))


def wide_m(level: Floats) -> Floats:
    """Return how errors scatter by levels in dBm, in m [n]."""
    return np.hypot(0.0125, 0.0055 * np.minimum(10 ** ((-90.5 - level) / 20), 3.0))


def _charged(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    shifts_m = np.zeros((len(drawn.hidden), len(table)))
    order = sorted(
        drawn.hidden, key=lambda name: (LAST.index(name) + 1 if name in LAST else 0, name)
    )
    for name in order:
        rng = np.random.default_rng([3902, side, seed, *name.encode()])
        toll = EFFECTS[name](Berth(table, seed, rng, bool(drawn.rare)), drawn.strength)
        shifts_m[drawn.hidden.index(name)] = toll.late_m
        table = _paid(table, toll)
    return table, shifts_m


def _paid(table: pd.DataFrame, toll: Toll) -> pd.DataFrame:
    """Return the table once rows have paid; noise falls by the root of symbols that are less."""
    kept = 1 - STRAIGHT * (1 - 10 ** (np.asarray(toll.first_db) / 10))
    fewer = 10 ** (np.asarray(toll.tally_db) / 20)
    made = table.assign(error_m=table["error_m"] + toll.late_m)
    made["range_m"] = made["true_range_m"] + made["error_m"]
    made["rx_power_dbm"] += toll.dim_db + 10 * np.log10(kept)
    made["first_path_power_dbm"] += np.asarray(toll.dim_db) + toll.first_db
    made["noise_std"] *= 10 ** (np.asarray(toll.hiss_db) / 20) * np.sqrt(fewer)
    made["preamble_count"] *= fewer
    return made
