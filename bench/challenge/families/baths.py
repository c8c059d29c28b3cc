"""Swimmers, springers, scrubbers and riders of swimming baths, ranged from arches of their roof.

numpy and pandas alone; what it can hide is in `baths_effects`, waveforms in `baths_waves`. Hall,
channel and line of sight are known. Tags blink at marks of a Golomb ruler.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.baths_day import RARELY, bathed
from bench.challenge.families.baths_effects import EFFECTS
from bench.challenge.families.baths_faults import open_db
from bench.challenge.families.baths_hall import ARCHES, COURSE, LAWS, TAGS, Heat, Splash
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Heat", "hidden_in", "known", "tables"]
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
    "noise-floor": "filter_kw",
    "beads-of-water-on-arches": "beads_um",
    "scale-furs-the-nozzles": "fur_mm",
    "steel-slide-close-by": "slide_m",
    "suncream-on-caps": "cream_mg",
    "bathers-splash-about": "bathers",
    "lane-floats-pass": "rope_m",
    "roof-rolled-back": "roof_pct",
    "steam-room-left-ajar": "steam_pct",
    "pumps-shake-their-arches": "pump_hz",
}
AFTER_ALL = ("passi-from-one-arch", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SYMBOLS, GRAIN = 1009, 2.55  # asked for; counts of noise for each root of one
ARCH_DB: Floats = 1.3 * np.sin(2.4 * np.arange(ARCHES) + 0.4)
TAG_DB: Floats = 1.2 * np.cos(2.4 * np.arange(len(TAGS)) + 1.1)
EARLY = 0.58  # of all that comes is of first paths
UNTOLD = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
          "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the baths' own."""
    rng = np.random.default_rng([seed, 2802])
    day = rarer(bathed(rng, drawn.rare), drawn, near=True)
    clean = _ranged(day, rng, drawn.scatter)
    other = day if drawn.paired else day_after(bathed(rng, drawn.rare), drawn)
    again = pd.concat([other] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(again, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return bathed(np.random.default_rng([seed, 2802]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    found, added_m = _soaked(clean, drawn, seed, 1)
    truth, _ = _soaked(simulated, drawn, seed, 2)
    four = (found, clean, simulated, truth)
    found, clean, simulated, truth = (without_courses(one, drawn.listed) for one in four)
    return Tables(found, clean, simulated, truth, added_m)


def without_courses(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is handed on: no courses, and obstacles only if they are listed."""
    gone = [*COURSE] if listed else [*COURSE, "obstacles"]
    return table.drop(columns=gone, errors="ignore")


def day_after(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other heats, whose links are none of the recorded ones."""
    kept = rarer(rows, drawn, near=False)
    return kept.assign(link="day after, " + kept["link"])


def rarer(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, mostly those of near links, or of far ones.

    Of links by distance, all of the first third are kept, and of others the fewer the later: which
    ones, van der Corput's sequence of base 3 tells.
    """
    if drawn.same_mix:
        return rows
    far = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=near)
    number = np.arange(len(far))
    odd = sum((number // 3**k % 3) / 3.0 ** (k + 1) for k in range(5))
    kept = far.index[odd >= 1.3 * (number / len(far) - 0.3)]
    return rows[rows["link"].isin(kept)].reset_index(drop=True)


def in_the_baths(heat: Heat) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links."""
    fades = heat.each_link(lambda n: 5.5 * heat.rng.beta(5.0, 4.0, n) - 3.05)
    return open_db(heat.far) + ARCH_DB[heat.arch] + TAG_DB[heat.tag] + fades


def counted(heat: Heat) -> tuple[Floats, Floats]:
    """Return how many symbols are counted, and what is told of noise in counts, [n] each."""
    missed = np.floor(heat.rng.pareto(2.6, heat.rows) * 11.0).clip(max=80.0)
    symbols = SYMBOLS - missed
    loud = 0.027 * ARCH_DB[heat.arch] + 0.028 * heat.rng.normal(size=heat.rows).clip(-2.8, 2.8)
    return symbols, GRAIN * np.sqrt(symbols) * np.exp(loud)


def cut_bell(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances of a bell that is cut off at three times its scatter [rows]."""
    return rng.normal(size=rows).clip(-3.0, 3.0)


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the baths' own ranges and levels.

    Errors are of a bell, and wider where it is weak; links keep a little of their own.
    """
    heat = Heat(rows, 0, rng)
    level = in_the_baths(heat)
    wide = 0.0126 * np.sqrt(1 + 10 ** ((-95.5 - level) / 10))
    kept = heat.each_link(lambda n: rng.uniform(-0.008, 0.008, n))
    error = scatter * (wide * cut_bell(rng, heat.rows) + kept)
    symbols, noise = counted(heat)
    every = level + 0.28 * cut_bell(rng, heat.rows)
    first = every - 0.3 - 2.9 * rng.beta(1.8, 3.4, heat.rows)
    made = (error, heat.far + error, every, first, noise, symbols)
    return rows.assign(**dict(zip(UNTOLD, made, strict=True)))


def _soaked(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    added_m = np.zeros((len(drawn.hidden), len(table)))
    turn = sorted(drawn.hidden, key=lambda name: (name in AFTER_ALL, name))
    for name in turn:
        rng = np.random.default_rng([seed, 2806, side, *name.encode()])
        splash = EFFECTS[name](Heat(table, seed, rng, bool(drawn.rare)), drawn.strength)
        added_m[drawn.hidden.index(name)] = splash.late_m
        table = _suffered(table, splash)
    return table, added_m


def _suffered(table: pd.DataFrame, splash: Splash) -> pd.DataFrame:
    """Return the table with what its rows bear.

    What is told of noise falls by the root of symbols that are not counted.
    """
    first_db, all_db, count_db = splash.first_db, splash.all_db, np.asarray(splash.count_db)
    left_db = 10 * np.log10(1 - EARLY + EARLY * 10 ** (np.asarray(first_db) / 10))
    error = table["error_m"] + splash.late_m
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + all_db + left_db,
        first_path_power_dbm=table["first_path_power_dbm"] + all_db + first_db,
        noise_std=table["noise_std"] * 10 ** ((np.asarray(splash.noise_db) + count_db / 2) / 20),
        preamble_count=table["preamble_count"] * 10 ** (count_db / 20),
    )
