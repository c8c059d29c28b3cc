"""Barges, gates' leaves, mules and keepers of a ship lock, ranged by davits along its copings.

numpy and pandas alone; what it can hide is in `canal_effects`, waveforms in `canal_waves`. The
channel and line of sight are known; there is no room. Davits ask in turn, and log what they hear.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.canal_chamber import COURSE, DAVITS, LAWS, TAGS, Passage, Toll
from bench.challenge.families.canal_effects import EFFECTS
from bench.challenge.families.canal_faults import open_db
from bench.challenge.families.canal_traffic import RARELY, passed
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Passage", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
OF_COLUMNS = {
    "time_s": ("time-lag", "antenna-delay", "chamber-sloshes", "cabinet-restarted"),
    "reply_time_s": ("exchange-motion", "clock-offset"),
    "true_range_m": ("range-scale", "power-bias", "path-loss", "level-control"),
    "temperature_c": ("temperature-drift", "lids-freeze-over"),
    "azimuth_deg": ("antenna-pattern", "nearer-of-two-antennas"),
    "pump_kw": ("noise-floor",),
    "slime_um": ("slime-on-lids",),
    "wash_cm": ("wash-splashes-up",),
    "rack_m": ("sluice-rack-close-by",),
    "verdigris_mg": ("verdigris-creeps",),
    "fenders": ("fenders-hung-out",),
    "sluice_pct": ("sluices-spray",),
    "fill_mms": ("gauge-well-lags",),
}
CAUSES = {name: column for column, names in OF_COLUMNS.items() for name in names}
LAST = {"roeden-from-one-davit": 1, "range-rounding": 2}
"""What becomes of ranges after all else, in this order."""
SYMBOLS, GRAIN = 1004.0, 2.75  # counted; counts of noise for each root of one
DAVIT_DB: Floats = 1.3 * (np.modf(0.618034 * np.arange(1, DAVITS + 1))[0] * 2 - 1)
TAG_DB: Floats = np.random.default_rng(2501).triangular(-1.4, 0.0, 1.4, len(TAGS))
EARLY = 0.58  # of all that comes is of first paths
LEVELS = ("rx_power_dbm", "first_path_power_dbm")
UNTOLD = ("error_m", "range_m", *LEVELS, "noise_std", "preamble_count")
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the lock's own."""
    rng = np.random.default_rng([seed, 2502])
    day = winnowed(passed(rng, drawn.rare), drawn, 1.0)
    clean = _ranged(day, rng, drawn.scatter)
    other = day if drawn.paired else next_tide(passed(rng, drawn.rare), drawn)
    often = other.loc[np.tile(other.index, drawn.ratio)].reset_index(drop=True)
    simulated = _ranged(often, rng, drawn.scatter)
    return hidden_in(drawn, seed, clean, simulated)


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return passed(np.random.default_rng([seed, 2502]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, added_m = _borne(clean, drawn, seed, 1)
    true = _borne(simulated, drawn, seed, 2)[0]
    return Tables(
        logged(recorded, drawn.listed),
        logged(clean, drawn.listed),
        logged(simulated, drawn.listed),
        logged(true, drawn.listed),
        added_m,
    )


def logged(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is logged: no courses, and obstacles only if they are listed."""
    made = table[[name for name in table if name not in COURSE]]
    return made if listed else made.drop(columns="obstacles", errors="ignore")


def next_tide(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other lockings, whose links are none of the recorded ones."""
    kept = winnowed(rows, drawn, -1.0)
    return kept.assign(link="next tide, " + kept["link"])


def winnowed(rows: pd.DataFrame, drawn: Draw, sign: float) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of near links mostly, or of far ones.

    Links stay at even steps of a sum of shares, which fall from the nearest on or, by the `sign`,
    from the farthest.
    """
    if drawn.same_mix:
        return rows
    order = rows.groupby("link")["true_range_m"].mean().mul(sign).sort_values(kind="stable")
    share = 1.06 * (1 - np.linspace(0.0, 1.0, len(order)) ** 1.5).clip(0.05, 0.94)
    stays = order.index[np.diff(np.floor(np.cumsum(share)), prepend=0.0) > 0]
    return rows[rows["link"].isin(stays)].reset_index(drop=True)


def at_the_lock(passage: Passage) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links."""
    fades = passage.each(lambda n: 1.3 * np.arctanh(passage.rng.uniform(-0.93, 0.86, n)))
    return open_db(passage.far) + DAVIT_DB[passage.davit] + TAG_DB[passage.tag] + fades


def counted(passage: Passage) -> tuple[Floats, Floats]:
    """Return how many symbols are counted, and what is told of noise in counts, [n] each."""
    symbols = SYMBOLS - passage.rng.negative_binomial(3, 0.2, len(passage.far)).clip(max=50)
    own = (1 + 0.025 * DAVIT_DB)[passage.davit] * passage.rng.triangular(
        0.93, 1, 1.07, len(symbols)
    )
    return symbols.astype(np.float64), GRAIN * np.sqrt(symbols) * own


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the lock's own ranges and levels.

    Errors are of Student's curve, cut off, and wider where it is weak; links keep a little of
    their own.
    """
    passage, size = Passage(rows, 0, rng), len(rows)
    level = at_the_lock(passage)
    wide = 0.0115 * (1 + 10 ** ((-94.0 - level) / 16))
    kept = passage.each(lambda n: 0.006 * np.sin(rng.uniform(0, 2 * np.pi, n)))
    error = scatter * (wide * rng.standard_t(7.0, size).clip(-4.2, 4.2) + kept)
    symbols, noise = counted(passage)
    every = level + rng.normal(0.0, 0.2, size)
    first = every - 0.25 - 1.6 * rng.weibull(1.4, size).clip(max=3.2)
    made = zip(UNTOLD, (error, passage.far + error, every, first, noise, symbols), strict=True)
    return rows.assign(**dict(made))


def _borne(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    added_m = np.zeros((len(drawn.hidden), len(table)))
    for name in sorted(drawn.hidden, key=lambda one: (LAST.get(one, 0), one)):
        own = np.random.default_rng([seed, 2506, side, *name.encode()])
        toll = EFFECTS[name](Passage(table, seed, own, bool(drawn.rare)), drawn.strength)
        added_m[drawn.hidden.index(name)] = toll.get("m", 0.0)
        table = _with(table, toll)
    return table, added_m


def _with(table: pd.DataFrame, toll: Toll) -> pd.DataFrame:
    """Return the table with what its rows have to bear.

    What is told of noise falls by the root of symbols that are not counted.
    """
    m, every, first, noise, count = (
        np.asarray(toll.get(name, 0.0)) for name in ("m", "all", "first", "noise", "count")
    )
    made = table.copy()
    made["error_m"] += m
    made["range_m"] = made["true_range_m"] + made["error_m"]
    made["first_path_power_dbm"] += every + first
    made["rx_power_dbm"] += every + 10 * np.log10(1 + EARLY * (10 ** (first / 10) - 1))
    made["noise_std"] *= 10 ** ((noise + 0.5 * count) / 20)
    made["preamble_count"] *= 10 ** (count / 20)
    return made
