"""Trays, racks, porters and moulds of a breadworks by night, ranged from corbels about the hall.

numpy and pandas alone; what it can hide is in `breadworks_effects`, waveforms in
`breadworks_waves`. Hall, channel and line of sight are known. Corbels answer a golden part of a
turn apart.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.breadworks_effects import EFFECTS
from bench.challenge.families.breadworks_faults import open_dbm
from bench.challenge.families.breadworks_hall import CORBELS, COURSE, LAWS, TAGS, Bake, Does
from bench.challenge.families.breadworks_night import RARELY, baked
from bench.challenge.families.case import Draw, Tables

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Bake", "hidden_in", "known", "tables"]
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
    "noise-floor": "mixer_rpm",
    "steam-let-into-ovens": "steam_l",
    "dough-swells-over-troughs": "swollen_cm",
    "hook-hung-close-by": "hook_gap_m",
    "flour-settles-since-swept": "swept_min",
    "tins-stacked-alongside": "tins",
    "supports-of-the-belt-pass": "spiral_m",
    "sifter-runs-on-a-low-hopper": "hopper_kg",
    "yeast-works-by-warmth-and-hours": "proved_h",
    "flue-buckles-as-ovens-heat": "oven_c",
}
IN_THE_END = ("brazas-from-one-corbel", "missed-answers-put-on-a-line", "range-rounding")
"""What becomes of ranges after all else, in this order."""
ASKED, GRAIN = 1024, 2.7  # symbols; counts of noise for each root of one
CORBEL_DB: Floats = 1.15 * np.sin(2.6 * np.arange(CORBELS) + 1.7)
TAG_DB: Floats = 0.95 * np.cos(1.9 * np.arange(len(TAGS)) - 0.6)
FADES_DB = (-4.6, 1.1, 3.5)  # of links: least, likeliest, most; none in the mean
STRAIGHT = 0.575  # of all that comes is of first paths
MEASURED = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
            "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the breadworks's own."""
    rng = np.random.default_rng([seed, 3701])
    night = sorted_out(baked(rng, drawn.rare), drawn, near=True)
    clean = _ranged(night, rng, drawn.scatter)
    other = night if drawn.paired else another_night(baked(rng, drawn.rare), drawn)
    again = pd.concat([other] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(again, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return baked(np.random.default_rng([seed, 3701]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    found, late_m = _hidden(clean, drawn, seed, 1)
    truth, _ = _hidden(simulated, drawn, seed, 2)
    found, clean, simulated, truth = (
        shown(table, drawn.listed) for table in (found, clean, simulated, truth)
    )
    return Tables(found, clean, simulated, truth, late_m)


def shown(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is shown: without courses, and obstacles only if they are listed."""
    return table.drop(columns=[*COURSE, *(() if listed else ("obstacles",))])


def another_night(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other batches, whose links are none of the recorded ones."""
    kept = sorted_out(rows, drawn, near=False)
    return kept.assign(link="another night, " + kept["link"])


def backwards(numbers: NDArray[np.int64]) -> Floats:
    """Return numbers < 256 as parts of one whose eight bits run backwards [n] (van der Corput)."""
    bits = (numbers[:, None] >> np.arange(8)) & 1
    return np.asarray(bits @ 0.5 ** np.arange(1.0, 9.0))


def sorted_out(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, mostly those of near links, or of far ones.

    Of links in order of distance ever fewer stay.
    """
    if drawn.same_mix:
        return rows
    far = rows.groupby("link")["true_range_m"].mean().sort_values(ascending=near)
    place = np.arange(len(far))
    stays = backwards(place) < 1.2 - 1.3 * place / len(far)
    return rows[rows["link"].isin(far.index[stays])].reset_index(drop=True)


def in_the_hall(bake: Bake) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links."""
    fades = bake.by_link(lambda n: bake.rng.triangular(*FADES_DB, n))
    return open_dbm(bake.far) + CORBEL_DB[bake.corbel] + TAG_DB[bake.tag] + fades


def added_up(bake: Bake) -> tuple[Floats, Floats]:
    """Return how many symbols are added up, and what is told of noise in counts, [n] each."""
    missed = np.floor(24.0 * bake.rng.weibull(1.25, bake.rows)).clip(max=130.0)
    symbols = ASKED - missed
    loud = 0.022 * TAG_DB[bake.tag] + 0.034 * strays(bake.rng, bake.rows)
    return symbols, GRAIN * np.sqrt(symbols) * np.exp(loud)


def strays(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1: bells, each as wide as a gamma's root has it [n]."""
    return np.asarray(rng.standard_normal(rows) * np.sqrt(rng.gamma(6.0, 1 / 6.0, rows)))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the breadworks's own ranges and levels.

    Errors are wider where it is weak; links keep a little of their own.
    """
    bake = Bake(rows, 0, rng)
    level = in_the_hall(bake)
    wide = 0.0105 + 0.0045 * 10 ** ((-92.0 - level) / 20).clip(max=3.0)
    own = bake.by_link(lambda n: rng.triangular(-0.011, 0.0, 0.011, n))
    error = scatter * (wide * strays(rng, bake.rows) + own)
    symbols, noise = added_up(bake)
    every = level + 0.28 * strays(rng, bake.rows)
    first = level + 10 * np.log10(STRAIGHT) + 0.36 * strays(rng, bake.rows)
    made = (error, bake.far + error, every, np.minimum(first, every), noise, symbols)
    return rows.assign(**dict(zip(MEASURED, made, strict=True)))


def _hidden(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    late_m = np.zeros((len(drawn.hidden), len(table)))
    ends = [name for name in IN_THE_END if name in drawn.hidden]
    for name in (*sorted({*drawn.hidden} - {*ends}), *ends):
        rng = np.random.default_rng([seed, 3702, side, *name.encode()])
        does = EFFECTS[name](Bake(table, seed, rng, bool(drawn.rare)), drawn.strength)
        late_m[drawn.hidden.index(name)] = does.late_m
        table = _done(table, does)
    return table, late_m


def _done(table: pd.DataFrame, does: Does) -> pd.DataFrame:
    """Return the table with what its rows get; noise falls by the root of symbols that are less."""
    first, count_db = np.asarray(does.first_db), np.asarray(does.count_db)
    every = does.all_db + 10 * np.log10(1 - STRAIGHT + STRAIGHT * 10 ** (first / 10))
    error = table["error_m"] + does.late_m
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + every,
        first_path_power_dbm=table["first_path_power_dbm"] + does.all_db + first,
        noise_std=table["noise_std"] * 10 ** ((np.asarray(does.noise_db) + count_db / 2) / 20),
        preamble_count=table["preamble_count"] * 10 ** (count_db / 20),
    )
