"""Boards, trucks, fettlers, pugs, saggars and dippers, who call purlins in a pottery.

numpy and pandas alone; what it can hide is in `pottery_effects`, waveforms in `pottery_waves`.
Works and line of sight are known. Tags call; purlins answer in slots, and measure.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.pottery_day import RARELY, fired
from bench.challenge.families.pottery_effects import EFFECTS
from bench.challenge.families.pottery_faults import open_dbm
from bench.challenge.families.pottery_floor import COURSE, LAWS, PURLINS, TAGS, Firing, Toll

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Firing", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = {
    "path-loss": "true_range_m",
    "power-bias": "true_range_m",
    "range-scale": "true_range_m",
    "level-control": "true_range_m",
    "folding-rule-gives-at-each-joint": "true_range_m",
    "worn-end-of-the-rule": "true_range_m",
    "time-lag": "time_s",
    "slip-main-fills-and-empties": "time_s",
    "heat-of-firings-stays-in-walls": "time_s",
    "beams-creep-down-through-the-day": "time_s",
    "answers-slow-after-each-meal": "time_s",
    "clock-offset": "reply_time_s",
    "exchange-motion": "reply_time_s",
    "temperature-drift": "temperature_c",
    "wet-ware-steams-by-warmth": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "noise-floor": "kiln_kw",
    "slip-cakes-on-aerials-until-it-falls": "slip_g",
    "soot-settles-on-purlins-since-swept": "swept_h",
    "glaze-runs-down-over-tags": "glaze_um",
    "weak-draught-lets-smoke-linger": "draught_pa",
    "rack-truck-parked-beside": "rack_m",
    "elements-load-the-mains": "load_ka",
    "shop-off-its-usual-damp": "damp_pct",
    "rollers-of-the-biscuit-way-pass": "rollers_m",
    "lid-of-the-clay-silo-shuts": "clay_t",
    "flint-dust-hangs-in-the-glaze-shop": "flint_mg",
    "kiln-warms-ways-that-pass-it": "kiln_k",
    "kiln-shoulders-purlins-aside": "kiln_k",
    "tags-ride-up-on-stacked-boards": "boards_n",
}
LATER_ON = ("worn-end-of-the-rule", "folding-rule-gives-at-each-joint", "ells-from-one-purlin",
            "answers-drawn-to-their-links-mean", "loudest-answer-of-a-round-drags-the-rest",
            "answers-filed-shortest-first", "range-rounding")  # fmt: skip
"""What becomes of ranges after all else, in this order."""
SYMBOLS, FEWEST, COUNTS = 256, 180, 2.7  # sent; summed at least; noise for a root of one
WARM_C = 24.0  # at which noise is that
PURLINS_DB: Floats = np.asarray(1.1 * (np.arange(PURLINS) * 0.618 % 1.0) - 0.55, np.float64)
TAGS_DB: Floats = np.asarray(np.arange(len(TAGS)) * 0.382 % 1.0 - 0.5, np.float64)
OWN_DB = 1.0  # of links
FIRST = 0.52  # of all that comes is of first paths
OWN_M = 0.009  # by which links' own errors are off
NEARER, FARTHER = 0.63, 0.36  # of links in order of distance: up to these, from these on
TOLD = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
        "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the pottery's own."""
    rng = np.random.default_rng([9601, seed])
    day = mixed_rows(fired(rng, drawn.rare), drawn, far=False)
    clean = _measured(day, rng, drawn.scatter)
    if not drawn.paired:
        day = day_after(fired(rng, drawn.rare), drawn)
    copies = pd.concat([day] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _measured(copies, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return fired(np.random.default_rng([9601, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, late_m = _hiding(clean, drawn, seed, 1)
    truth, _ = _hiding(simulated, drawn, seed, 2)
    told, plain, drawn_anew, true = (
        written(one, drawn.listed) for one in (recorded, clean, simulated, truth)
    )
    return Tables(told, plain, drawn_anew, true, late_m)


def written(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is written down: no courses, obstacles only if they are listed."""
    away = list(COURSE) if listed else [*COURSE, "obstacles"]
    return table.drop(columns=away)


def day_after(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of another day, whose links are none of the recorded ones."""
    return mixed_rows(rows.assign(link="another day, " + rows["link"]), drawn, far=True)


def mixed_rows(rows: pd.DataFrame, drawn: Draw, far: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of farther links, or of nearer ones.

    What is amid these is in both.
    """
    if drawn.same_mix:
        return rows
    place = rows.groupby("link")["true_range_m"].mean().rank(pct=True)
    own = rows["link"].map(place)
    return rows[own >= FARTHER if far else own <= NEARER].reset_index(drop=True)


def in_the_works(firing: Firing) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, of links by chance."""
    own = firing.each_link(lambda n: OWN_DB * firing.rng.triangular(-2.45, 0.0, 2.45, n))
    ends = PURLINS_DB[firing.purlin] + TAGS_DB[firing.tag]
    return np.asarray(open_dbm(firing.far) + ends + own)


def gathered(firing: Firing) -> tuple[Floats, Floats]:
    """Return how many symbols are summed, and what is told of noise in counts, [n] each.

    Some are lost before all is in step; noise is that of warmth.
    """
    part = firing.rng.beta(5.0, 1.6, firing.rows)
    symbols = np.rint(FEWEST + (SYMBOLS - FEWEST) * part)
    warm = np.sqrt((firing["temperature_c"] + 273.15) / (WARM_C + 273.15))
    uneven = np.exp(0.025 * firing.rng.standard_normal(firing.rows).clip(-2.5, 2.5))
    return symbols, COUNTS * warm * uneven * np.sqrt(symbols)


def shakes(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1 [rows]: mostly of a narrow bell, some of a wide one."""
    wide = np.where(rng.random(rows) < 0.12, 1.7, 0.87)
    return np.asarray(wide * rng.standard_normal(rows).clip(-3.2, 3.2))


def scatters_m(level: Floats) -> Floats:
    """Return how errors scatter by levels in dBm, in m [n]: more where it is weak."""
    return np.asarray(0.0155 + 0.0065 * 10 ** ((-84.0 - level) / 20))


def _measured(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the pottery's own ranges and levels.

    Errors are wider where it is weak; links keep a little of their own.
    """
    firing = Firing(rows, 0, rng)
    level = in_the_works(firing)
    own = firing.each_link(lambda n: OWN_M * rng.triangular(-2.45, 0.0, 2.45, n))
    error = scatter * (own + scatters_m(level) * shakes(rng, firing.rows))
    symbols, noise = gathered(firing)
    every = level + 0.28 * shakes(rng, firing.rows)
    first = np.minimum(level + 10 * np.log10(FIRST) + 0.42 * shakes(rng, firing.rows), every - 0.12)
    made = (error, firing.far + error, every, first, noise, symbols)
    return rows.assign(**dict(zip(TOLD, made, strict=True)))


def _hiding(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    more = {name: np.zeros(len(table)) for name in drawn.hidden}
    order = sorted(name for name in more if name not in LATER_ON)
    for name in (*order, *(one for one in LATER_ON if one in more)):
        rng = np.random.default_rng([9602, side, seed, *name.encode()])
        toll = EFFECTS[name](Firing(table, seed, rng, bool(drawn.rare)), drawn.strength)
        more[name] = more[name] + toll.more_m
        table = _paid(table, toll)
    return table, np.stack([*more.values()]) if more else np.zeros((0, len(table)))


def _paid(table: pd.DataFrame, toll: Toll) -> pd.DataFrame:
    """Return the table once tolls are paid; of fewer symbols noise falls by the root.

    Of all that comes first paths are but a part.
    """
    error = table["error_m"] + toll.more_m
    kept = 10 ** (np.asarray(toll.first_db) / 10)
    fewer = 10 ** (np.asarray(toll.count_db) / 20)
    every = table["rx_power_dbm"] + toll.level_db + 10 * np.log10(1 - FIRST + FIRST * kept)
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=every,
        first_path_power_dbm=table["first_path_power_dbm"] + toll.level_db + toll.first_db,
        noise_std=table["noise_std"] * np.sqrt(fewer) * 10 ** (np.asarray(toll.noise_db) / 20),
        preamble_count=table["preamble_count"] * fewer,
    )
