"""Skaters, penguins, resurfacers and pairs of an ice rink, ranged from mullions about the ice.

numpy and pandas alone; what it can hide is in `icerink_effects`, waveforms in `icerink_waves`.
Hall, channel and line of sight are known. Mullions answer in slots of rounds, by a prime.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.icerink_effects import EFFECTS
from bench.challenge.families.icerink_faults import open_dbm
from bench.challenge.families.icerink_rink import COURSE, LAWS, MULLIONS, TAGS, Marks, Period
from bench.challenge.families.icerink_session import RARELY, skated

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Period", "hidden_in", "known", "tables"]
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
    "noise-floor": "chiller_kw",
    "frost-grows-on-mullions": "frost_mm",
    "slush-heaps-on-boards": "slush_cm",
    "scoreboard-let-down-close-by": "cube_gap_m",
    "film-spreads-since-flooded": "flooded_min",
    "carbon-sticks-in-the-rack": "sticks",
    "panes-pass-alongside": "glide_m",
    "compressor-runs-on-warm-brine": "brine_c",
    "air-dews-above-ice": "humid_pct",
    "truss-sags-under-snow": "snow_cm",
}
IN_THE_END = ("lokte-from-one-mullion", "answers-sent-twice", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SYMBOLS, GRAIN = 1016, 2.55  # asked for; counts of noise for each root of one
MULLION_DB: Floats = 1.1 * np.cos(2.1 * np.arange(MULLIONS) + 0.4)
TAG_DB: Floats = 1.0 * np.sin(3.3 * np.arange(len(TAGS)) + 0.9)
STRAIGHT = 0.58  # of all that comes is of first paths
MEASURED = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
            "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the ice rink's own."""
    rng = np.random.default_rng([seed, 3601])
    day = mixed(skated(rng, drawn.rare), drawn, near=True)
    clean = _ranged(day, rng, drawn.scatter)
    other = day if drawn.paired else another_day(skated(rng, drawn.rare), drawn)
    again = pd.concat([other] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(again, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return skated(np.random.default_rng([seed, 3601]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    found, late_m = _marked(clean, drawn, seed, 1)
    truth, _ = _marked(simulated, drawn, seed, 2)
    shown = [as_shown(one, drawn.listed) for one in (found, clean, simulated, truth)]
    return Tables(shown[0], shown[1], shown[2], shown[3], late_m)


def as_shown(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is shown: no courses, and obstacles only if they are listed."""
    return table.drop(columns=[*COURSE] if listed else [*COURSE, "obstacles"])


def another_day(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other heats, whose links are none of the recorded ones."""
    kept = mixed(rows, drawn, near=False)
    return kept.assign(link="another day, " + kept["link"])


def mixed(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, mostly those of near links, or of far ones.

    Links stay the less likely the later they are by distance; multiples of one over the plastic
    number tell which.
    """
    if drawn.same_mix:
        return rows
    order = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=near).index
    place = np.arange(len(order))
    stays = (place / 1.3247179572) % 1.0 > 1.35 * place / len(order) - 0.25
    return rows[rows["link"].isin(order[stays])].reset_index(drop=True)


def in_the_hall(period: Period) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links."""
    fades = period.each_link(lambda n: period.rng.logistic(0.0, 0.95, n).clip(-4.5, 4.5))
    return open_dbm(period.far) + MULLION_DB[period.mullion] + TAG_DB[period.tag] + fades


def added_up(period: Period) -> tuple[Floats, Floats]:
    """Return how many symbols are added up, and what is told of noise in counts, [n] each."""
    missed = period.rng.negative_binomial(3, 0.11, period.rows).clip(max=130)
    symbols = np.asarray(SYMBOLS - missed, np.float64)
    loud = 0.025 * TAG_DB[period.tag] + 0.032 * chances(period.rng, period.rows)
    return symbols, GRAIN * np.sqrt(symbols) * np.exp(loud)


def chances(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1: a bell, and beside it a triangle [n]."""
    return np.asarray(0.6 * rng.normal(size=rows) + 0.8 * rng.triangular(-1, 0, 1, rows) * 6**0.5)


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ice rink's own ranges and levels.

    Errors are wider where it is weak; links keep a little of their own.
    """
    period = Period(rows, 0, rng)
    level = in_the_hall(period)
    wide = np.hypot(0.0125, 0.008 * 10 ** ((-90.0 - level) / 20).clip(max=3.0))
    own = period.each_link(lambda n: rng.uniform(-0.009, 0.009, n))
    error = scatter * (wide * chances(rng, period.rows) + own)
    symbols, noise = added_up(period)
    every = level + 0.3 * chances(rng, period.rows)
    first = level + 10 * np.log10(STRAIGHT) + 0.38 * chances(rng, period.rows)
    made = (error, period.far + error, every, np.minimum(first, every), noise, symbols)
    return rows.assign(**dict(zip(MEASURED, made, strict=True)))


def _marked(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    late_m = np.zeros((len(drawn.hidden), len(table)))
    last = {name: k for k, name in enumerate(IN_THE_END, 1)}
    for name in sorted(drawn.hidden, key=lambda one: (last.get(one, 0), one)):
        rng = np.random.default_rng([seed, 3602, side, *name.encode()])
        marks = EFFECTS[name](Period(table, seed, rng, bool(drawn.rare)), drawn.strength)
        late_m[drawn.hidden.index(name)] = marks.late_m
        table = _with(table, marks)
    return table, late_m


def _with(table: pd.DataFrame, marks: Marks) -> pd.DataFrame:
    """Return the table with what its rows get; noise falls by the root of symbols that are less."""
    first, count_db = np.asarray(marks.first_db), np.asarray(marks.count_db)
    every = marks.all_db + 10 * np.log10(1 - STRAIGHT + STRAIGHT * 10 ** (first / 10))
    error = table["error_m"] + marks.late_m
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + every,
        first_path_power_dbm=table["first_path_power_dbm"] + marks.all_db + first,
        noise_std=table["noise_std"] * 10 ** ((np.asarray(marks.noise_db) + count_db / 2) / 20),
        preamble_count=table["preamble_count"] * 10 ** (count_db / 20),
    )
