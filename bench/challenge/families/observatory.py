"""Tubes, chairs, trolleys and climbers of an observatory's hall, ranged by sconces on its walls.

numpy and pandas alone; what it can hide is in `observatory_effects`, waveforms in
`observatory_waves`. Hall, channel and line of sight are known. Sconces ask at slots of primes.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.observatory_effects import EFFECTS
from bench.challenge.families.observatory_faults import open_db
from bench.challenge.families.observatory_hall import COURSE, LAWS, SCONCES, TAGS, Exposure, Toll
from bench.challenge.families.observatory_night import RARELY, watched

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Exposure", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
BY_COLUMN = {
    "time_s": ("time-lag", "antenna-delay"),
    "reply_time_s": ("exchange-motion", "clock-offset"),
    "true_range_m": ("range-scale", "power-bias", "path-loss", "level-control"),
    "temperature_c": ("temperature-drift",),
    "azimuth_deg": ("antenna-pattern",),
    "dome_a": ("noise-floor",),
    "dew_um": ("dew-films-sconces",),
    "hoar_mm": ("hoar-grows-on-roof",),
    "pier_m": ("iron-pier-close-by",),
    "tarnish_nm": ("silvering-tarnishes",),
    "guests": ("guests-lean-on-rails",),
    "curb_m": ("dome-rollers-pass",),
    "slit_deg": ("slit-stands-wide-open", "mist-comes-in-by-the-slit"),
    "lamp_w": ("red-lamps-warm-their-sconces",),
}
CAUSES = {name: column for column, names in BY_COLUMN.items() for name in names}
AFTER_ALL = ("canne-from-one-sconce", "range-rounding")
"""What becomes of ranges after all else, in this order."""
SYMBOLS, GRAIN = 1014, 2.65  # asked for; counts of noise for each root of one
SCONCE_DB: Floats = np.random.default_rng(2701).normal(0.0, 0.7, SCONCES).clip(-1.4, 1.4)
TAG_DB: Floats = np.linspace(-1.3, 1.3, len(TAGS))[(7 * np.arange(len(TAGS))) % len(TAGS)]
EARLY = 0.57  # of all that comes is of first paths
LEVELS = ("rx_power_dbm", "first_path_power_dbm")
UNTOLD = ("error_m", "range_m", *LEVELS, "noise_std", "preamble_count")
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the observatory's own."""
    rng = np.random.default_rng([seed, 2702])
    night = fewer(watched(rng, drawn.rare), drawn, near=True)
    clean = _ranged(night, rng, drawn.scatter)
    other = night if drawn.paired else next_night(watched(rng, drawn.rare), drawn)
    again = pd.concat(drawn.ratio * [other], ignore_index=True)
    return hidden_in(drawn, seed, clean, _ranged(again, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return watched(np.random.default_rng([seed, 2702]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    found, added_m = _burdened(clean, drawn, seed, 1)
    truth, _ = _burdened(simulated, drawn, seed, 2)
    found, clean, simulated, truth = (
        filed(one, drawn.listed) for one in (found, clean, simulated, truth)
    )
    return Tables(found, clean, simulated, truth, added_m)


def filed(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is filed: no courses, and obstacles only if they are listed."""
    gone = {*COURSE} if listed else {*COURSE, "obstacles"}
    return table[[name for name in table if name not in gone]]


def next_night(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of other watches, whose links are none of the recorded ones."""
    kept = fewer(rows, drawn, near=False)
    return kept.assign(link="next night, " + kept["link"])


def fewer(rows: pd.DataFrame, drawn: Draw, near: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, mostly those of near links, or of far ones.

    By distance, a link stays the less often the later it is in turn; which ones do, the golden
    section tells.
    """
    if drawn.same_mix:
        return rows
    far = rows.groupby("link")["true_range_m"].mean()
    late = far.rank(method="first", ascending=near).to_numpy() / len(far)
    stays = np.modf(0.618034 * np.argsort(np.argsort(late)))[0] > 1.15 * (late - 0.18)
    return rows[rows["link"].isin(far.index[stays])].reset_index(drop=True)


def in_the_hall(shot: Exposure) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links."""
    fades = shot.per_link(lambda n: 10 * np.log10(shot.rng.wald(1.0, 8.0, n).clip(0.35, 2.4)))
    return open_db(shot.far) + SCONCE_DB[shot.sconce] + TAG_DB[shot.tag] + fades


def counted(shot: Exposure) -> tuple[Floats, Floats]:
    """Return how many symbols are counted, and what is told of noise in counts, [n] each."""
    missed = shot.rng.negative_binomial(2.5, 0.2, shot.rows).clip(max=70)
    symbols = np.asarray(SYMBOLS - missed, np.float64)
    loud = 0.028 * SCONCE_DB[shot.sconce] + 0.027 * shot.rng.normal(size=shot.rows).clip(-3, 3)
    return symbols, GRAIN * np.sqrt(symbols) * np.exp(loud)


def four_even(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1 and end at 3.46: sums of four even ones [rows]."""
    return np.asarray(np.sqrt(3.0) * rng.uniform(-1.0, 1.0, (rows, 4)).sum(axis=1) / 2)


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the observatory's own ranges and levels.

    Errors are sums of even ones, and wider where it is weak; links keep a little of their own.
    """
    shot = Exposure(rows, 0, rng)
    level = in_the_hall(shot)
    wide = 0.013 * np.sqrt(1 + 10 ** ((-92.0 - level) / 10))
    kept = shot.per_link(lambda n: rng.normal(0.0, 0.0045, n).clip(-0.01, 0.01))
    error = scatter * (wide * four_even(rng, shot.rows) + kept)
    symbols, noise = counted(shot)
    every = level + rng.triangular(-0.5, 0.0, 0.5, shot.rows)
    first = every - 0.35 - 2.6 * rng.beta(1.6, 3.2, shot.rows)
    made = (error, shot.far + error, every, first, noise, symbols)
    return rows.assign(**dict(zip(UNTOLD, made, strict=True)))


def _burdened(
    table: pd.DataFrame, drawn: Draw, seed: int, side: int
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    added_m = np.zeros((len(drawn.hidden), len(table)))
    last = [name for name in AFTER_ALL if name in drawn.hidden]
    for name in [*sorted({*drawn.hidden} - {*last}), *last]:
        rng = np.random.default_rng([seed, 2706, side, *name.encode()])
        toll = EFFECTS[name](Exposure(table, seed, rng, bool(drawn.rare)), drawn.strength)
        added_m[drawn.hidden.index(name)] = toll.late_m
        table = _bearing(table, toll)
    return table, added_m


def _bearing(table: pd.DataFrame, toll: Toll) -> pd.DataFrame:
    """Return the table with what its rows bear.

    What is told of noise falls by the root of symbols that are not counted.
    """
    error = table["error_m"] + toll.late_m
    lost = 10 * np.log10(1 - EARLY + EARLY * 10 ** (np.asarray(toll.first_db) / 10))
    quieter = np.asarray(toll.noise_db) + np.asarray(toll.count_db) / 2
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + toll.all_db + lost,
        first_path_power_dbm=table["first_path_power_dbm"] + toll.all_db + toll.first_db,
        noise_std=table["noise_std"] * 10 ** (quieter / 20),
        preamble_count=table["preamble_count"] * 10 ** (np.asarray(toll.count_db) / 20),
    )
