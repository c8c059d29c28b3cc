"""Grapples, carriages, forklifts and sawyers of a saw mill, ranged from its braces.

numpy and pandas alone; what it can hide is in `sawmill_effects`, waveforms in `sawmill_waves`. The
channel and line of sight are known, a room is not. At each stint a tag asks from three to six
braces, one after the other, round after round; each brace hears it in some rounds in a row.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.sawmill_effects import EFFECTS
from bench.challenge.families.sawmill_faults import open_db
from bench.challenge.families.sawmill_shift import RARELY, shift
from bench.challenge.families.sawmill_yard import (
    BRACES,
    COURSE,
    LAWS,
    Change,
    Stint,
)

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Change", "Stint", "hidden_in", "known", "tables"]
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
    "resin-on-lids": "resin_g",
    "sawdust-drifts": "dust_cm",
    "blades-lose-strain": "strain_kn",
    "vents-steam": "vent_kgs",
    "chain-lugs-pass": "chain_m",
    "fine-gain-cycles": "rx_power_dbm",
    "firmware-changed-at-noon": "time_s",
    "kiln-braces-swell": "humidity_pct",
    "masts-tilt-laden": "load_t",
}
LAST = ("yards-from-one-brace", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SYMBOLS, GRAIN = 612.0, 3.62  # counted; counts of noise for each root of one
OWN_DB: Floats = np.random.default_rng(2201).triangular(-1.9, 0.2, 1.7, BRACES)
MEASURED = (
    "error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std", "preamble_count"
)  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the saw mill's own."""
    rng = np.random.default_rng([seed, 2202])
    clean = _ranged(mixed(shift(rng, drawn.rare), drawn, True), rng, drawn.scatter)
    rows = clean.drop(columns=list(MEASURED))
    if not drawn.paired:
        rows = next_shift(shift(rng, drawn.rare), drawn)
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(more, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return shift(np.random.default_rng([seed, 2202]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _undergone(clean, drawn, seed, 1)
    truth, _ = _undergone(simulated, drawn, seed, 2)
    found, plain, other, true = (
        as_logged(one, drawn.listed) for one in (recorded, clean, simulated, truth)
    )
    return Tables(found, plain, other, true, metres)


def as_logged(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is logged: no courses, and obstacles only if they are listed."""
    untold = [*COURSE] if listed else [*COURSE, "obstacles"]
    return table.drop(columns=untold, errors="ignore")


def next_shift(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other stints, whose links are none of the recorded ones."""
    return mixed(rows, drawn, False).assign(link=lambda one: "next shift, " + one["link"])


def mixed(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of 45 % of links, the nearest or farthest.

    And of every sixth link of the rest.
    """
    if drawn.same_mix:
        return rows
    means = rows.groupby("link")["true_range_m"].mean()
    order = means.rank(method="first", ascending=near)
    stays = (order <= 0.45 * len(means)) | (order % 6 == 0)
    return rows[rows["link"].map(stays).to_numpy(bool)].reset_index(drop=True)


def in_the_mill(rows: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return levels in dBm [n]: by distances, by braces that differ, with fades of links."""
    stint = Stint(rows, 0, rng)
    fades = stint.by_link(lambda n: 0.9 - 1.25 * np.abs(rng.normal(size=n)).clip(max=2.9))
    return open_db(stint.far) + OWN_DB[stint.brace] + fades


def counted(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return how many symbols are counted, and what is told of noise in counts, [n] each."""
    symbols = SYMBOLS - rng.binomial(40, 0.17, len(rows)).astype(np.float64)
    own = 1 + 0.018 * OWN_DB[Stint(rows, 0, rng).brace]
    told = GRAIN * np.sqrt(symbols) * own * (1 + 0.03 * rng.standard_normal(len(rows)))
    return symbols, np.asarray(told)


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the mill's own ranges and levels.

    Errors are of a bell that is now and then wider (Tukey 1960), and wider where it is weak; links
    keep a little of their own.
    """
    level, size = in_the_mill(rows, rng), len(rows)
    wide = 0.0155 * np.sqrt(1 + 10 ** ((-87.5 - level) / 10))
    wide = wide * np.where(rng.random(size) < 0.12, 2.1, 0.9)
    kept = Stint(rows, 0, rng).by_link(lambda n: rng.uniform(-0.0075, 0.0075, n))
    error = scatter * (wide * rng.standard_normal(size) + kept)
    symbols, noise = counted(rows, rng)
    level = level + 0.23 * rng.standard_normal(size)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - rng.weibull(1.9, size) * 2.1,
        noise_std=noise,
        preamble_count=symbols,
    )


def _undergone(
    table: pd.DataFrame, drawn: Draw, seed: int, side: int
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    added = np.zeros((len(drawn.hidden), len(table)))
    for name in sorted(drawn.hidden, key=lambda one: (one in LAST, one == LAST[-1], one)):
        own = np.random.default_rng([seed, 2204, side, *name.encode()])
        change = EFFECTS[name](Stint(table, seed, own, bool(drawn.rare)), drawn.strength)
        added[drawn.hidden.index(name)] = change.metres
        table = _changed(table, change)
    return table, added


def _changed(table: pd.DataFrame, change: Change) -> pd.DataFrame:
    """Return the table with what becomes of its rows; 0.56 of all that comes is of first paths.

    What is told of noise falls by the root of symbols that are not counted.
    """
    first, fewer = np.asarray(change.first_db), np.asarray(change.count_db)
    every = 10 * np.log10(0.44 + 0.56 * 10 ** (first / 10)) + change.all_db
    error = table["error_m"] + change.metres
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + every,
        first_path_power_dbm=table["first_path_power_dbm"] + first + change.all_db,
        noise_std=table["noise_std"] * 10 ** ((np.asarray(change.noise_db) + 0.5 * fewer) / 20),
        preamble_count=table["preamble_count"] * 10 ** (fewer / 20),
    )
