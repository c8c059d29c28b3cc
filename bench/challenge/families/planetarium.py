"""Planets, moons, ushers, comets and trolleys of a planetarium, which call coves about its dome.

numpy and pandas alone; what it can hide is in `planetarium_effects`, waveforms in
`planetarium_waves`. Hall, channel and line of sight are known. Tags call, coves answer as a beam
turns past them.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.planetarium_dome import COURSE, COVES, LAWS, TAGS, Fee, Seating
from bench.challenge.families.planetarium_effects import EFFECTS
from bench.challenge.families.planetarium_faults import open_dbm
from bench.challenge.families.planetarium_show import RARELY, shown

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Seating", "hidden_in", "known", "tables"]
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
    "noise-floor": "arc_a",
    "felt-glued-over-covers": "felt_mm",
    "breath-dampens-the-felt": "humid_pct",
    "slide-tins-stacked-near": "tins_gap_m",
    "programmes-piled-on-coves": "programmes",
    "valves-warm-since-switched-on": "switched_min",
    "fog-blown-about-tags": "fog_ml",
    "worn-teeth-pass-on-racks": "rack_m",
    "dimmers-trip-at-low-mains": "mains_v",
    "haze-gathers-under-the-dome": "haze_pct",
    "dome-swells-in-the-sun": "sun_w_m2",
}
LAST = ("sazhens-from-one-cove", "weak-answers-told-as-the-last", "answers-smoothed-as-they-come",
        "range-rounding")  # fmt: skip
"""What becomes of ranges after all else, in this order."""
ASKED, GRAIN = 1016, 2.4  # symbols; counts of noise for each root of one
COVE_DB: Floats = 1.0 * np.cos(2.2 * np.arange(COVES) + 0.7)
TAG_DB: Floats = 0.7 * np.sin(1.7 * np.arange(len(TAGS)) + 0.2)
FADES_DB = 1.7  # by which links' levels scatter
FIRSTS = 0.58  # of all that comes is of first paths
OWN_M = 0.005  # by which links' own errors scatter
NEARER, FARTHER = 0.64, 0.36  # of links in order of distance: up to these, from these on
MEASURED = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
            "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the planetarium's own."""
    rng = np.random.default_rng([5201, seed])
    evening = mixed(shown(rng, drawn.rare), drawn, near=True)
    clean = _ranged(evening, rng, drawn.scatter)
    if not drawn.paired:
        evening = matinee(shown(rng, drawn.rare), drawn)
    simulated = _ranged(pd.concat([evening] * drawn.ratio, ignore_index=True), rng, drawn.scatter)
    return hidden_in(drawn, seed, clean, simulated)


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return shown(np.random.default_rng([5201, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts_m = _paying(clean, drawn, seed, 1)
    truth, _ = _paying(simulated, drawn, seed, 2)
    told = [printed(one, drawn.listed) for one in (recorded, clean, simulated, truth)]
    return Tables(told[0], told[1], told[2], told[3], shifts_m)


def printed(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is printed: no courses, and obstacles only if they are listed."""
    return table.drop(columns=[*COURSE] if listed else [*COURSE, "obstacles"])


def matinee(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other shows, whose links are none of the recorded ones."""
    kept = mixed(rows, drawn, near=False)
    return kept.assign(link="matinee, " + kept["link"])


def mixed(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of nearer links, or of farther ones.

    What is amid these is in both: of places, no more than a part is.
    """
    if drawn.same_mix:
        return rows
    rank = rows.groupby("link")["true_range_m"].mean().rank(pct=True)
    taken = rank.index[rank <= NEARER if near else rank > FARTHER]
    return rows[rows["link"].isin(taken)].reset_index(drop=True)


def under_the_dome(seating: Seating) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links.

    These scatter evenly over a box in three ways at once.
    """
    fades = seating.each(
        lambda n: FADES_DB * 2 * seating.rng.uniform(-0.5, 0.5, (3, n)).sum(axis=0)
    )
    return open_dbm(seating.far) + COVE_DB[seating.cove] + TAG_DB[seating.tag] + fades


def summed(seating: Seating) -> tuple[Floats, Floats]:
    """Return how many symbols are summed, and what is told of noise in counts, [n] each."""
    missed = seating.rng.negative_binomial(2, 0.055, seating.rows).clip(max=170)
    symbols = ASKED - missed.astype(np.float64)
    loud = np.exp(0.018 * COVE_DB[seating.cove] + 0.033 * twinkles(seating.rng, seating.rows))
    return symbols, GRAIN * loud * np.sqrt(symbols)


def twinkles(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1 [rows]: Student's, of eight (1908)."""
    return np.asarray((np.sqrt(6 / 8) * rng.standard_t(8, rows)).clip(-5, 5))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the planetarium's own ranges and levels.

    Errors are wider where it is weak; links keep a little of their own.
    """
    seating = Seating(rows, 0, rng)
    level = under_the_dome(seating)
    own = seating.each(lambda n: rng.normal(0.0, OWN_M, n))
    error = scatter * (own + wide_m(level) * twinkles(rng, seating.rows))
    symbols, noise = summed(seating)
    every = level + 0.3 * twinkles(rng, seating.rows)
    first = level + 10 * np.log10(FIRSTS) + 0.35 * twinkles(rng, seating.rows)
    made = (error, seating.far + error, every, np.minimum(first, every), noise, symbols)
    return rows.assign(**dict(zip(MEASURED, made, strict=True)))


def wide_m(level: Floats) -> Floats:
    """Return how errors scatter by levels in dBm, in m [n]."""
    return np.asarray(0.0115 + 0.0052 * 10 ** ((-86.0 - level) / 20).clip(max=3.0))


def _paying(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    shifts_m = np.zeros((len(drawn.hidden), len(table)))
    order = sorted(drawn.hidden, key=lambda name: (LAST.index(name) if name in LAST else -1, name))
    for name in order:
        rng = np.random.default_rng([5202, side, seed, *name.encode()])
        fee = EFFECTS[name](Seating(table, seed, rng, bool(drawn.rare)), drawn.strength)
        shifts_m[drawn.hidden.index(name)] = fee.late_m
        table = _paid(table, fee)
    return table, shifts_m


def _paid(table: pd.DataFrame, fee: Fee) -> pd.DataFrame:
    """Return the table once rows have paid; noise falls by the root of symbols that are less."""
    left = 1 - FIRSTS + FIRSTS * 10 ** (np.asarray(fee.first_db) / 10)
    fewer = 10 ** (np.asarray(fee.count_db) / 20)
    noise = 10 ** (np.asarray(fee.noise_db) / 20) * np.sqrt(fewer)
    error = table["error_m"] + fee.late_m
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + fee.all_db + 10 * np.log10(left),
        first_path_power_dbm=table["first_path_power_dbm"] + fee.all_db + fee.first_db,
        noise_std=table["noise_std"] * noise,
        preamble_count=table["preamble_count"] * fewer,
    )
