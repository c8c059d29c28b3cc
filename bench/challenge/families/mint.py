"""Fly presses, trucks, warders, coils, ladles and couriers, whom quoins call about a mint.

numpy and pandas alone; what it can hide is in `mint_effects`, waveforms in `mint_waves`. Court,
channel and line of sight are known. Quoins call tags between strikes of presses; tags measure.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.mint_court import COURSE, LAWS, QUOINS, TAGS, Tally, Toll
from bench.challenge.families.mint_effects import EFFECTS
from bench.challenge.families.mint_faults import open_dbm
from bench.challenge.families.mint_turns import RARELY, passed

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Tally", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = {
    "path-loss": "true_range_m",
    "power-bias": "true_range_m",
    "range-scale": "true_range_m",
    "level-control": "true_range_m",
    "antenna-delay": "time_s",
    "time-lag": "time_s",
    "clock-offset": "reply_time_s",
    "exchange-motion": "reply_time_s",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "noise-floor": "furnace_kw",
    "gold-dust-settles-on-quoins": "dust_mg",
    "pickle-fumes-eat-at-covers": "fume_ppm",
    "strip-is-rolled-thick": "strip_mm",
    "borax-creeps-since-fluxed": "fluxed_h",
    "coin-hopper-swung-close": "hopper_m",
    "bullion-piled-before-quoins": "bullion_t",
    "annealing-reddens-and-pales": "anneal_min",
    "ribs-of-reeding-wheels-pass": "reed_m",
    "fan-thrown-in-at-a-hot-flue": "flue_c",
    "caged-passage-guides-what-passes": "gate_cm",
    "seals-leak-by-what-pressures-differ": "vault_pa",
    "heights-told-by-a-barometer": "fans_pa",
    "strongroom-door-swings-its-quoins": "door_deg",
    "answers-held-while-presses-strike": "time_s",
}
AT_LAST = ("coarse-count-read-before-it-ripples", "toises-from-one-quoin",
           "bags-of-answers-opened-out-of-order", "answers-held-while-presses-strike",
           "range-rounding")  # fmt: skip
"""What becomes of ranges after all else, in this order."""
ASKED, COUNTS = 576, 2.6  # symbols; counts of noise for each root of one
QUOINS_DB: Floats = 0.9 * np.sin(1.3 + 2.7 * np.arange(QUOINS))
TAGS_DB: Floats = 0.8 * np.cos(0.4 + 1.9 * np.arange(len(TAGS)))
SHADOW_DB = 1.5  # by which links' levels scatter
DIRECT = 0.58  # of all that comes is of first paths
OWN_M = 0.005  # by which links' own errors scatter
NEARER, FARTHER = 0.65, 0.35  # of links in order of distance: up to these, from these on
TOLD = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
        "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the mint's own."""
    rng = np.random.default_rng([7301, seed])
    day = picked(passed(rng, drawn.rare), drawn, far=False)
    clean = _weighed(day, rng, drawn.scatter)
    if not drawn.paired:
        day = other_day(passed(rng, drawn.rare), drawn)
    whole = pd.concat([day] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _weighed(whole, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return passed(np.random.default_rng([7301, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, longer_m = _tolled(clean, drawn, seed, 1)
    truth, _ = _tolled(simulated, drawn, seed, 2)
    made = [entered(one, drawn.listed) for one in (recorded, clean, simulated, truth)]
    return Tables(made[0], made[1], made[2], made[3], longer_m)


def entered(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is entered: no courses, and obstacles only if they are listed."""
    return table.drop(columns=[*COURSE] + ["obstacles"] * (not listed))


def other_day(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of another day, whose links are none of the recorded ones."""
    return picked(rows.assign(link="other day, " + rows["link"]), drawn, far=True)


def picked(rows: pd.DataFrame, drawn: Draw, far: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of farther links, or of nearer ones.

    What is amid these is in both.
    """
    if drawn.same_mix:
        return rows
    of_link = rows.groupby("link")["true_range_m"].mean()
    order = of_link.rank(pct=True)[rows["link"]].to_numpy()
    return rows[order >= FARTHER if far else order <= NEARER].reset_index(drop=True)


def about_the_court(tally: Tally) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, in links' shadows."""
    ends = QUOINS_DB[tally.quoin] + TAGS_DB[tally.tag]
    shade = tally.links(lambda n: SHADOW_DB * tally.rng.logistic(0.0, 0.55, n).clip(-2.4, 2.4))
    return np.asarray(open_dbm(tally.far) + ends + shade)


def counted(tally: Tally) -> tuple[Floats, Floats]:
    """Return how many symbols are summed, and what is told of noise in counts, [n] each."""
    rng = tally.rng
    symbols = ASKED - 8.0 - rng.poisson(rng.gamma(2.0, 9.0, tally.rows)).clip(max=90)
    uneven = np.exp(0.03 * rng.standard_normal(tally.rows)) * 10 ** (0.012 * TAGS_DB[tally.tag])
    return symbols.astype(np.float64), COUNTS * uneven * np.sqrt(symbols)


def flips(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1 [rows], of a hyperbolic secant's law (Talacko 1956)."""
    part = rng.uniform(0.0, 1.0, rows).clip(1e-4, 1 - 1e-4)
    return np.asarray(2 / np.pi * np.log(np.tan(0.5 * np.pi * part)))


def scatters_m(level: Floats) -> Floats:
    """Return how errors scatter by levels in dBm, in m [n]: of clocks, and of noise."""
    return np.hypot(0.0145, 0.009 * 10 ** ((-90.0 - level) / 20).clip(max=3.0))


def _weighed(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the mint's own ranges and levels.

    Errors are wider where it is weak; links keep a little of their own.
    """
    tally = Tally(rows, 0, rng)
    level = about_the_court(tally)
    own = tally.links(lambda n: OWN_M * rng.triangular(-2.4, 0.0, 2.4, n))
    error = scatter * (own + scatters_m(level) * flips(rng, tally.rows))
    symbols, noise = counted(tally)
    every = level + 0.3 * flips(rng, tally.rows)
    first = level + 10 * np.log10(DIRECT) + 0.36 * flips(rng, tally.rows)
    made = (error, tally.far + error, every, np.minimum(first, every - 0.1), noise, symbols)
    return rows.assign(**dict(zip(TOLD, made, strict=True)))


def _tolled(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    order = sorted({*drawn.hidden} - {*AT_LAST}) + [n for n in AT_LAST if n in drawn.hidden]
    longer_m = np.zeros((len(drawn.hidden), len(table)))
    for name in order:
        rng = np.random.default_rng([7302, side, seed, *name.encode()])
        toll = EFFECTS[name](Tally(table, seed, rng, bool(drawn.rare)), drawn.strength)
        longer_m[drawn.hidden.index(name)] = toll.longer_m
        table = _taken_of(table, toll)
    return table, longer_m


def _taken_of(table: pd.DataFrame, toll: Toll) -> pd.DataFrame:
    """Return the table once a toll is taken; noise falls by the root of symbols that are less."""
    first_db, count_db = np.asarray(toll.first_db), np.asarray(toll.count_db)
    every_db = 10 * np.log10(1 - DIRECT + DIRECT * 10 ** (first_db / 10))
    noise_db = np.asarray(toll.noise_db) + 0.5 * count_db
    error = table["error_m"] + toll.longer_m
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + toll.level_db + every_db,
        first_path_power_dbm=table["first_path_power_dbm"] + toll.level_db + first_db,
        preamble_count=table["preamble_count"] * 10 ** (count_db / 20),
        noise_std=table["noise_std"] * 10 ** (noise_db / 20),
    )
