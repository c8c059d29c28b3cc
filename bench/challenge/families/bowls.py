"""Bowls, rollers, players and umpires of a bowls green, ranged by knots of the net over its skin.

numpy and pandas alone; what it can hide is in `bowls_effects`, waveforms in `bowls_waves`. The
channel and line of sight are known; a room is not, as the skin is round. Tags blink, knots answer
and log what they hear.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.bowls_effects import EFFECTS
from bench.challenge.families.bowls_faults import open_db
from bench.challenge.families.bowls_match import RARELY, played
from bench.challenge.families.bowls_rinks import COURSE, KNOTS, LAWS, TAGS, Change, End
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Change", "End", "hidden_in", "known", "tables"]
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
    "noise-floor": "inside_pa",
    "grip-wax-on-shells": "wax_mg",
    "nap-stands-up": "nap_mm",
    "blower-close-by": "blower_m",
    "rain-runs-down-the-skin": "rain_mmh",
    "skirt-tubes-filled": "skirt_l",
    "heating-loops-passed": "loop_m",
    "airlock-held-open": "airlock_pct",
    "skin-breathes": "inside_pa",
}
AT_LAST = ("fathoms-from-one-knot", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SYMBOLS, GRAIN = 996.0, 2.7  # counted; counts of noise for each root of one
KNOT_DB: Floats = np.random.default_rng(2401).normal(0.0, 0.9, KNOTS).clip(-1.6, 1.6)
TAG_DB: Floats = 0.9 * np.sin(1.9 * np.arange(len(TAGS)))
EARLY = 0.6  # of all that comes is of first paths
MEASURED = (
    "error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std", "preamble_count"
)  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the green's own."""
    rng = np.random.default_rng([seed, 2402])
    clean = _ranged(thinned(played(rng, drawn.rare), drawn, 1), rng, drawn.scatter)
    rows = clean.drop(columns=list(MEASURED))
    if not drawn.paired:
        rows = next_match(played(rng, drawn.rare), drawn)
    more = pd.concat([rows] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(more, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return played(np.random.default_rng([seed, 2402]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, metres = _suffered(clean, drawn, seed, 1)
    truth, _ = _suffered(simulated, drawn, seed, 2)
    found, plain, other, true = (
        as_told(one, drawn.listed) for one in (recorded, clean, simulated, truth)
    )
    return Tables(found, plain, other, true, metres)


def as_told(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is told: no courses, and obstacles only if they are listed."""
    return table.drop(columns=[*COURSE, *([] if listed else ["obstacles"])], errors="ignore")


def next_match(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other ends, whose links are none of the recorded ones."""
    rows = thinned(rows, drawn, -1)
    return rows.assign(link=[f"next match, {name}" for name in rows["link"]])


def thinned(rows: pd.DataFrame, drawn: Draw, sign: int) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of near links mostly, or of far ones.

    Of links in turn, from the nearest on or, by the `sign`, from the farthest, ever fewer stay.
    """
    if drawn.same_mix:
        return rows
    order = (sign * rows.groupby("link")["true_range_m"].mean()).rank(method="first").astype(int)
    part = order / len(order)
    keeps = 1 + np.floor(9.0 * (part - 0.35).clip(lower=0.0)).astype(int)
    stays = order % keeps == 0
    return rows[rows["link"].map(stays).to_numpy(bool)].reset_index(drop=True)


def on_the_green(rows: pd.DataFrame, rng: np.random.Generator) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links."""
    end = End(rows, 0, rng)
    fades = end.by_link(lambda n: 1.1 * rng.normal(size=n).clip(-2.5, 1.8))
    return open_db(end.far) + KNOT_DB[end.knot] + TAG_DB[end.tag] + fades


def counted(rows: pd.DataFrame, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return how many symbols are counted, and what is told of noise in counts, [n] each."""
    symbols = SYMBOLS - rng.binomial(40, 0.2, len(rows))
    own = 1 + 0.03 * KNOT_DB[End(rows, 0, rng).knot]
    scatter = 1 + 0.03 * rng.normal(size=len(rows)).clip(-2.0, 2.0)
    return symbols.astype(np.float64), np.asarray(GRAIN * np.sqrt(symbols) * own * scatter)


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the green's own ranges and levels.

    Errors are of a bell, wider for some rows by chance, and wider where it is weak; links keep a
    little of their own.
    """
    level, size, end = on_the_green(rows, rng), len(rows), End(rows, 0, rng)
    wide = 0.015 * np.hypot(1.0, 10 ** ((-89.0 - level) / 20)) * rng.uniform(0.7, 1.3, size)
    kept = end.by_link(lambda n: rng.uniform(-0.006, 0.006, n))
    error = scatter * (wide * rng.normal(size=size) + kept)
    symbols, noise = counted(rows, rng)
    level = level + 0.22 * rng.normal(size=size)
    return rows.assign(
        error_m=error,
        range_m=rows["true_range_m"] + error,
        rx_power_dbm=level,
        first_path_power_dbm=level - 0.3 - rng.gamma(2.2, 0.8, size).clip(max=5.5),
        noise_std=noise,
        preamble_count=symbols,
    )


def _suffered(
    table: pd.DataFrame, drawn: Draw, seed: int, side: int
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    added = {name: np.zeros(len(table)) for name in drawn.hidden}
    for name in sorted(drawn.hidden, key=lambda one: (_place(one), one)):
        own = np.random.default_rng([seed, 2406, side, *name.encode()])
        change = EFFECTS[name](End(table, seed, own, bool(drawn.rare)), drawn.strength)
        added[name] = added[name] + change.metres
        table = _with(table, change)
    return table, np.array([added[name] for name in drawn.hidden]).reshape(-1, len(table))


def _place(name: str) -> int:
    return AT_LAST.index(name) if name in AT_LAST else -1


def _with(table: pd.DataFrame, change: Change) -> pd.DataFrame:
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
