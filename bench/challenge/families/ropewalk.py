"""Spinners, sledges, tops, bobbins and trucks of a ropewalk by day, called by struts along it.

numpy and pandas alone; what it can hide is in `ropewalk_effects`, waveforms in `ropewalk_waves`.
Hall, channel and line of sight are known. Struts call and tags answer, in rounds of uneven length.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.ropewalk_effects import EFFECTS
from bench.challenge.families.ropewalk_faults import open_dbm
from bench.challenge.families.ropewalk_shift import RARELY, worked
from bench.challenge.families.ropewalk_walk import COURSE, LAWS, STRUTS, TAGS, Due, Hank

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Hank", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = {
    "power-bias": "true_range_m",
    "path-loss": "true_range_m",
    "level-control": "true_range_m",
    "range-scale": "true_range_m",
    "time-lag": "time_s",
    "antenna-delay": "time_s",
    "exchange-motion": "reply_time_s",
    "clock-offset": "reply_time_s",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "noise-floor": "motor_a",
    "tar-clings-to-covers": "tar_g",
    "twist-stiffens-strands-over-tags": "twist_rpm",
    "copper-swung-close-by": "copper_gap_m",
    "oakum-bales-stacked-before": "oakum_bales",
    "oil-creeps-since-hemp-was-dressed": "dressed_h",
    "trestles-pass-underneath": "spun_m",
    "belt-thrown-off-at-low-steam": "steam_bar",
    "hemp-dust-hangs-by-the-hackles": "dust_g_m3",
    "walls-bow-out-under-snow": "snow_cm",
}
LAST = ("zhang-from-one-strut", "answers-booked-to-who-answers-next", "range-rounding")
"""What becomes of ranges after all else, in this order."""
ASKED, GRAIN = 1024, 2.5  # symbols; counts of noise for each root of one
STRUT_DB: Floats = 0.9 * np.sin(1.3 * np.arange(STRUTS) + 0.4)
TAG_DB: Floats = 0.8 * np.cos(2.6 * np.arange(len(TAGS)) + 1.1)
FADES_DB = 2.6  # of links: how far these go either way, by a half wave
STRAIGHT = 0.565  # of all that comes is of first paths
OWN_M = 0.005  # by which links' own errors scatter
MEASURED = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
            "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the ropewalk's own."""
    rng = np.random.default_rng([4101, seed])
    shift = thinned(worked(rng, drawn.rare), drawn, near=True)
    clean = _ranged(shift, rng, drawn.scatter)
    if not drawn.paired:
        shift = next_shift(worked(rng, drawn.rare), drawn)
    simulated = _ranged(pd.concat([shift] * drawn.ratio, ignore_index=True), rng, drawn.scatter)
    return hidden_in(drawn, seed, clean, simulated)


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return worked(np.random.default_rng([4101, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts_m = _owing(clean, drawn, seed, 1)
    truth, _ = _owing(simulated, drawn, seed, 2)
    shown = [hung_up(one, drawn.listed) for one in (recorded, clean, simulated, truth)]
    return Tables(shown[0], shown[1], shown[2], shown[3], shifts_m)


def hung_up(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is hung up: no courses, and obstacles only if they are listed."""
    return table.drop(columns=[*COURSE] + ["obstacles"] * (not listed))


def next_shift(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other strands, whose links are none of the recorded ones."""
    kept = thinned(rows, drawn, near=False)
    return kept.assign(link="next shift, " + kept["link"])


def thinned(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, mostly those of near links, or of far ones.

    Of links in order of distance the first half is taken, and of what follows one in four.
    """
    if drawn.same_mix:
        return rows
    order = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=near).index
    half = len(order) // 2
    taken = [*order[:half], *order[half::4]]
    return rows[rows["link"].isin(taken)].reset_index(drop=True)


def in_the_hall(hank: Hank) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links.

    These are a half wave's places by chance, of which most are at its turns (an arc's sine).
    """
    fades = hank.by_link(lambda n: FADES_DB * np.sin(hank.rng.uniform(-1.5, 1.5, n)))
    return open_dbm(hank.far) + STRUT_DB[hank.strut] + TAG_DB[hank.tag] + fades


def added_up(hank: Hank) -> tuple[Floats, Floats]:
    """Return how many symbols are added up, and what is told of noise in counts, [n] each."""
    missed = hank.rng.poisson(hank.rng.gamma(1.8, 17.0, hank.rows)).clip(max=160)
    symbols = ASKED - missed.astype(np.float64)
    loud = np.exp(0.02 * STRUT_DB[hank.strut] + 0.034 * freaks(hank.rng, hank.rows))
    return symbols, GRAIN * loud * np.sqrt(symbols)


def freaks(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1 [rows]: of a bell whose width is itself by chance.

    (Madan and Seneta 1990.)
    """
    return np.asarray((rng.standard_normal(rows) * np.sqrt(rng.gamma(5.0, 0.2, rows))).clip(-5, 5))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ropewalk's own ranges and levels.

    Errors are wider where it is weak; links keep a little of their own.
    """
    hank = Hank(rows, 0, rng)
    level = in_the_hall(hank)
    own = hank.by_link(lambda n: rng.normal(0.0, OWN_M, n))
    error = scatter * (own + wide_m(level) * freaks(rng, hank.rows))
    symbols, noise = added_up(hank)
    every = level + 0.3 * freaks(rng, hank.rows)
    first = level + 10 * np.log10(STRAIGHT) + 0.36 * freaks(rng, hank.rows)
    made = (error, hank.far + error, every, np.minimum(first, every), noise, symbols)
    return rows.assign(**dict(zip(MEASURED, made, strict=True)))


def wide_m(level: Floats) -> Floats:
    """Return how errors scatter by levels in dBm, in m [n]."""
    return np.sqrt(0.012**2 + 0.006**2 * (10 ** ((-88.0 - level) / 10)).clip(max=9.0))


def _owing(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    shifts_m = np.zeros((len(drawn.hidden), len(table)))
    first = sorted(name for name in drawn.hidden if name not in LAST)
    for name in (*first, *(one for one in LAST if one in drawn.hidden)):
        rng = np.random.default_rng([4102, side, seed, *name.encode()])
        due = EFFECTS[name](Hank(table, seed, rng, bool(drawn.rare)), drawn.strength)
        shifts_m[drawn.hidden.index(name)] = due.late_m
        table = _settled(table, due)
    return table, shifts_m


def _settled(table: pd.DataFrame, due: Due) -> pd.DataFrame:
    """Return the table once rows have settled; noise falls by the root of symbols that are less."""
    left = 1 - STRAIGHT + STRAIGHT * 10 ** (np.asarray(due.first_db) / 10)
    fewer = 10 ** (np.asarray(due.tally_db) / 20)
    louder = 10 ** (np.asarray(due.hiss_db) / 20)
    error = table["error_m"] + due.late_m
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + due.dim_db + 10 * np.log10(left),
        first_path_power_dbm=table["first_path_power_dbm"] + due.dim_db + due.first_db,
        noise_std=table["noise_std"] * louder * np.sqrt(fewer),
        preamble_count=table["preamble_count"] * fewer,
    )
