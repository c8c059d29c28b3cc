"""Stokers, barrows, bells, skips, lamplighters and rams, whom brackets call about a gasworks.

numpy and pandas alone; what it can hide is in `gasworks_effects`, waveforms in `gasworks_waves`.
Yard and line of sight are known. Brackets call by periods of their own; tags measure.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.gasworks_effects import EFFECTS
from bench.challenge.families.gasworks_faults import open_dbm
from bench.challenge.families.gasworks_shift import RARELY, worked
from bench.challenge.families.gasworks_yard import BRACKETS, COURSE, LAWS, TAGS, Bill, Charge

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Charge", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = {
    "path-loss": "true_range_m",
    "power-bias": "true_range_m",
    "range-scale": "true_range_m",
    "level-control": "true_range_m",
    "inches-booked-to-a-short-yard": "true_range_m",
    "dial-hung-off-its-centre": "true_range_m",
    "antenna-delay": "time_s",
    "time-lag": "time_s",
    "places-told-at-the-last-tick": "time_s",
    "answers-wait-for-the-exhausters-stroke": "time_s",
    "clock-offset": "reply_time_s",
    "exchange-motion": "reply_time_s",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "noise-floor": "sparks_hz",
    "tar-clings-to-brackets": "tar_g",
    "naphthalene-grows-in-vents": "frost_d",
    "scurf-thickens-on-mouthpieces": "scurf_mm",
    "lime-spends-itself-in-purifiers": "lime_h",
    "jib-of-the-coke-crane-close": "jib_m",
    "holder-lifts-before-brackets": "lift_m",
    "exhauster-off-its-best-speed": "exhaust_rpm",
    "flights-of-the-conveyor-pass": "flights_m",
    "governor-valve-slams-shut": "main_mbar",
    "smoke-hangs-under-the-retort-roof": "smoke_mg",
    "steam-of-quenched-coke-drifts": "steam_kg",
    "fires-glow-through-open-doors": "fire_c",
    "gauge-drags-behind-its-pressure": "gauge_mm",
    "made-ground-gives-under-coal": "coal_t",
    "retort-wall-bellies-as-it-heats": "bench_c",
}
LAST = ("dial-hung-off-its-centre", "aunes-from-one-bracket", "inches-booked-to-a-short-yard",
        "answers-come-by-a-damped-float", "third-answers-told-as-the-second",
        "range-rounding")  # fmt: skip
"""What becomes of ranges after all else, in this order."""
BLOCKS, BLOCK, COUNTS = (
    44,
    16,
    2.4,
)  # of symbols; symbols of each; counts of noise for a root of one
COLD_K = 290.0  # at which noise is that
BRACKETS_DB: Floats = 0.65 * np.sin(2.4 * np.arange(BRACKETS))
TAGS_DB: Floats = 0.55 * np.cos(1.9 * np.arange(len(TAGS)))
LIT_DB, DARK_DB, LIT, OWN_DB = 0.7, -1.2, 0.63, 0.7  # of links: some lit, the others in a shade
FIRST = 0.58  # of all that comes is of first paths
OWN_M = 0.0085  # by which links' own errors scatter
NEARER, FARTHER = 0.66, 0.36  # of links in order of distance: up to these, from these on
TOLD = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
        "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the gasworks' own."""
    rng = np.random.default_rng([9201, seed])
    shift = some_of(worked(rng, drawn.rare), drawn, far=False)
    clean = _called(shift, rng, drawn.scatter)
    if not drawn.paired:
        shift = next_shift(worked(rng, drawn.rare), drawn)
    whole = pd.concat([shift] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _called(whole, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return worked(np.random.default_rng([9201, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, more_m = _with(clean, drawn, seed, 1)
    truth, _ = _with(simulated, drawn, seed, 2)
    kept = [booked(one, drawn.listed) for one in (recorded, clean, simulated, truth)]
    return Tables(kept[0], kept[1], kept[2], kept[3], more_m)


def booked(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is kept: no courses, and obstacles only if they are listed."""
    return table.drop(columns=[*COURSE] + ([] if listed else ["obstacles"]))


def next_shift(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of another shift, whose links are none of the recorded ones."""
    return some_of(rows.assign(link="by night, " + rows["link"]), drawn, far=True)


def some_of(rows: pd.DataFrame, drawn: Draw, far: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of farther links, or of nearer ones.

    What is amid these is in both.
    """
    if drawn.same_mix:
        return rows
    order = rows.groupby("link")["true_range_m"].mean().rank(pct=True)
    part = rows["link"].map(order)
    return rows[part >= FARTHER if far else part <= NEARER].reset_index(drop=True)


def about_the_yard(charge: Charge) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, of links lit or in a shade."""
    lit = charge.per_link(lambda n: np.where(charge.rng.random(n) < LIT, LIT_DB, DARK_DB))
    own = charge.per_link(lambda n: OWN_DB * charge.rng.standard_normal(n).clip(-2.2, 2.2))
    ends = BRACKETS_DB[charge.bracket] + TAGS_DB[charge.tag]
    return np.asarray(open_dbm(charge.far) + ends + lit + own)


def counted(charge: Charge) -> tuple[Floats, Floats]:
    """Return how many symbols are summed, and what is told of noise in counts, [n] each.

    Some blocks of symbols are lost before tags have found them; noise is that of warmth
    (Johnson 1928).
    """
    lost = charge.rng.gamma(1.6, 2.0, charge.rows).astype(np.int64).clip(max=16)
    symbols = (BLOCK * (BLOCKS - lost)).astype(np.float64)
    warm = np.sqrt((charge["temperature_c"] + 273.15) / COLD_K)
    uneven = np.exp(0.03 * charge.rng.standard_normal(charge.rows).clip(-3.0, 3.0))
    return symbols, COUNTS * warm * uneven * np.sqrt(symbols)


def sparks(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by about 1 [rows], of a logistic law (Verhulst 1845)."""
    return np.asarray(rng.logistic(0.0, np.sqrt(3.0) / np.pi, rows).clip(-5.0, 5.0))


def scatters_m(level: Floats) -> Floats:
    """Return how errors scatter by levels in dBm, in m [n]: evenly, and by noise beside these."""
    return np.asarray(np.hypot(0.0145, 0.0065 * 10 ** ((-84.0 - level) / 20)))


def _called(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the gasworks' own ranges and levels.

    Errors are wider where it is weak; links keep a little of their own.
    """
    charge = Charge(rows, 0, rng)
    level = about_the_yard(charge)
    own = OWN_M * charge.per_link(lambda n: 2 * rng.beta(1.5, 1.5, n) - 1)
    error = scatter * (own + scatters_m(level) * sparks(rng, charge.rows))
    symbols, noise = counted(charge)
    every = level + 0.3 * sparks(rng, charge.rows)
    first = level + 10 * np.log10(FIRST) + 0.38 * sparks(rng, charge.rows)
    made = (error, charge.far + error, every, np.minimum(first, every - 0.1), noise, symbols)
    return rows.assign(**dict(zip(TOLD, made, strict=True)))


def _with(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    added = {name: np.zeros(len(table)) for name in drawn.hidden}
    early = sorted({*drawn.hidden} - {*LAST})
    for name in (*early, *(one for one in LAST if one in drawn.hidden)):
        rng = np.random.default_rng([9202, side, seed, *name.encode()])
        bill = EFFECTS[name](Charge(table, seed, rng, bool(drawn.rare)), drawn.strength)
        added[name] = added[name] + bill.more_m
        table = _settled(table, bill)
    return table, np.array([*added.values()]).reshape(len(added), len(table))


def _settled(table: pd.DataFrame, bill: Bill) -> pd.DataFrame:
    """Return the table once its bill is settled; of fewer symbols noise falls by the root.

    Of all that comes first paths are but a part.
    """
    error = table["error_m"] + bill.more_m
    lost = 10 * np.log10(1 - FIRST + FIRST * 10 ** (np.asarray(bill.first_db) / 10))
    fewer = np.asarray(bill.count_db)
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + bill.level_db + lost,
        first_path_power_dbm=table["first_path_power_dbm"] + bill.level_db + bill.first_db,
        preamble_count=table["preamble_count"] * 10 ** (fewer / 20),
        noise_std=table["noise_std"] * 10 ** ((np.asarray(bill.noise_db) + 0.5 * fewer) / 20),
    )
