"""Wheels, sacks, millers, drift, carts and buckets, whom hatches hear about a watermill.

numpy and pandas alone; what it can hide is in `watermill_effects`, waveforms in `watermill_waves`.
Mill, channel and line of sight are known. Tags send in frames; hatches measure.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.watermill_day import RARELY, ground
from bench.challenge.families.watermill_effects import EFFECTS
from bench.challenge.families.watermill_faults import open_dbm
from bench.challenge.families.watermill_race import COURSE, HATCHES, LAWS, TAGS, Due, Grist

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Grist", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = {
    "path-loss": "true_range_m",
    "power-bias": "true_range_m",
    "range-scale": "true_range_m",
    "level-control": "true_range_m",
    "sag-of-a-line-taken-off": "true_range_m",
    "antenna-delay": "time_s",
    "time-lag": "time_s",
    "answers-late-until-charged-again": "time_s",
    "clock-offset": "reply_time_s",
    "exchange-motion": "reply_time_s",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "noise-floor": "dynamo_a",
    "meal-cakes-about-hatches": "meal_g",
    "thatch-soaks-since-it-rains": "rain_h",
    "sacks-stacked-before-hatches": "sacks",
    "bran-settles-since-swept": "swept_h",
    "stone-crane-hung-close": "crane_m",
    "pond-presses-on-the-breast": "pond_m",
    "stones-tentered-too-near-or-too-far": "tenter_mm",
    "cogs-of-the-great-spur-pass": "spur_m",
    "penstock-lifted-past-its-stop": "penstock_cm",
    "spray-hangs-in-the-wheel-house": "spray_g",
    "steam-of-damp-grain-by-warmth": "damp_pct",
    "rods-of-the-governor-have-play": "governor_mm",
    "floors-sag-under-full-bins": "bin_t",
}
LAST = ("notch-stuck-in-the-tally-stick", "ells-from-one-hatch", "changes-of-ranges-told-by-halves",
        "slips-hung-one-nail-behind", "range-rounding")  # fmt: skip
"""What becomes of ranges after all else, in this order."""
BLOCKS, BLOCK, COUNTS = 42, 8, 3.1  # of symbols; symbols of each; counts of noise for a root of one
HATCHES_DB: Floats = 1.3 * ((7 * np.arange(HATCHES)) % HATCHES / (HATCHES - 1) - 0.5)
TAGS_DB: Floats = 1.1 * ((4 * np.arange(len(TAGS))) % len(TAGS) / (len(TAGS) - 1) - 0.5)
SHADE_DB = 1.4  # by which links' levels scatter
FIRST = 0.61  # of all that comes is of first paths
OWN_M = 0.006  # by which links' own errors scatter
NEARER, FARTHER = 0.66, 0.36  # of links in order of distance: up to these, from these on
TOLD = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
        "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the watermill's own."""
    rng = np.random.default_rng([8401, seed])
    day = sifted(ground(rng, drawn.rare), drawn, far=False)
    clean = _heard(day, rng, drawn.scatter)
    if not drawn.paired:
        day = another(ground(rng, drawn.rare), drawn)
    whole = pd.concat([day] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _heard(whole, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return ground(np.random.default_rng([8401, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, late_m = _with(clean, drawn, seed, 1)
    truth = _with(simulated, drawn, seed, 2)[0]
    told = [bagged(one, drawn.listed) for one in (recorded, clean, simulated, truth)]
    return Tables(told[0], told[1], told[2], told[3], late_m)


def bagged(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is kept: no courses, and obstacles only if they are listed."""
    return table.drop(columns=[*COURSE] if listed else [*COURSE, "obstacles"])


def another(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of another day, whose links are none of the recorded ones."""
    return sifted(rows.assign(link="at the next moon, " + rows["link"]), drawn, far=True)


def sifted(rows: pd.DataFrame, drawn: Draw, far: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of farther links, or of nearer ones.

    What is amid these is in both.
    """
    if drawn.same_mix:
        return rows
    place = rows.groupby("link")["true_range_m"].mean().rank(pct=True)
    kept = place >= FARTHER if far else place <= NEARER
    return rows[rows["link"].map(kept)].reset_index(drop=True)


def about_the_mill(grist: Grist) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, in links' shadows.

    Shadows are deeper than glints are bright (Gumbel).
    """
    shade = grist.each(lambda n: 0.577 - grist.rng.gumbel(0.0, 1.0, n).clip(-1.6, 2.8))
    ends = HATCHES_DB[grist.hatch] + TAGS_DB[grist.tag]
    return np.asarray(open_dbm(grist.far) + ends + SHADE_DB * shade)


def counted(grist: Grist) -> tuple[Floats, Floats]:
    """Return how many symbols are summed, and what is told of noise in counts, [n] each.

    Symbols are found by blocks, of which some are lost; hatches are not as quiet as each other.
    """
    lost = grist.rng.geometric(0.28, grist.rows).clip(max=14) + 1
    symbols = (BLOCK * (BLOCKS - lost)).astype(np.float64)
    uneven = grist.rng.gamma(900.0, 1 / 900.0, grist.rows) * 10 ** (0.02 * HATCHES_DB[grist.hatch])
    return symbols, COUNTS * uneven * np.sqrt(symbols)


def husks(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1 [rows]: even ones, mixed by gammas (Madan and Seneta)."""
    return np.asarray(np.sqrt(rng.gamma(2.5, 0.4, rows)) * rng.standard_normal(rows)).clip(-5, 5)


def scatters_m(level: Floats) -> Floats:
    """Return how errors scatter by levels in dBm, in m [n]: evenly, and more where it is weak."""
    return np.asarray(0.0135 + 0.0035 * 10 ** ((-82.0 - level) / 16).clip(max=4.0))


def _heard(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the mill's own ranges and levels.

    Errors are wider where it is weak; links keep a little of their own.
    """
    grist = Grist(rows, 0, rng)
    level = about_the_mill(grist)
    own = OWN_M * grist.each(lambda n: rng.uniform(-1.6, 1.6, n))
    error = scatter * (own + scatters_m(level) * husks(rng, grist.rows))
    symbols, noise = counted(grist)
    every = level + 0.32 * husks(rng, grist.rows)
    first = level + 10 * np.log10(FIRST) + 0.4 * husks(rng, grist.rows)
    made = (error, grist.far + error, every, np.minimum(first, every - 0.1), noise, symbols)
    return rows.assign(**dict(zip(TOLD, made, strict=True)))


def _with(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    late_m = dict.fromkeys(drawn.hidden, np.zeros(len(table)))
    for name in sorted(drawn.hidden, key=lambda one: (LAST.index(one) if one in LAST else -1, one)):
        rng = np.random.default_rng([8402, seed, side, *name.encode()])
        due = EFFECTS[name](Grist(table, seed, rng, bool(drawn.rare)), drawn.strength)
        late_m[name] = np.zeros(len(table)) + due.late_m
        table = _paid(table, due)
    return table, np.stack([*late_m.values()]) if late_m else np.zeros((0, len(table)))


def _paid(table: pd.DataFrame, due: Due) -> pd.DataFrame:
    """Return the table once it paid what is due; noise falls by the root of symbols that are less.

    Of all that comes first paths are but a part.
    """
    first = 10 ** (np.asarray(due.first_db) / 10)
    every_db = due.level_db + 10 * np.log10(1 + FIRST * (first - 1))
    error = table["error_m"] + due.late_m
    noise_by = 10 ** ((np.asarray(due.noise_db) + 0.5 * np.asarray(due.count_db)) / 20)
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + every_db,
        first_path_power_dbm=table["first_path_power_dbm"] + due.level_db + due.first_db,
        preamble_count=table["preamble_count"] * 10 ** (np.asarray(due.count_db) / 20),
        noise_std=table["noise_std"] * noise_by,
    )
