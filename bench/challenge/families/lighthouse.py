"""Keepers, tenders, gulls, cans, lenses and donkeys, whom cressets hear about a lighthouse.

numpy and pandas alone; what it can hide is in `lighthouse_effects`, waveforms in
`lighthouse_waves`. Rock and line of sight are known. Tags flash in groups; cressets measure.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.lighthouse_effects import EFFECTS
from bench.challenge.families.lighthouse_faults import open_dbm
from bench.challenge.families.lighthouse_station import (
    COURSE,
    CRESSETS,
    LAWS,
    TAGS,
    Dues,
    Entries,
)
from bench.challenge.families.lighthouse_watch import RARELY, kept

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Entries", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = {
    "path-loss": "true_range_m",
    "power-bias": "true_range_m",
    "range-scale": "true_range_m",
    "level-control": "true_range_m",
    "heaving-line-stretches-by-its-own-weight": "true_range_m",
    "knots-of-the-line-counted-too-large": "true_range_m",
    "vernier-read-from-its-wrong-end": "true_range_m",
    "antenna-delay": "time_s",
    "time-lag": "time_s",
    "places-told-by-a-losing-chronometer": "time_s",
    "answers-late-until-the-clock-is-wound": "time_s",
    "beam-heats-ways-that-it-sweeps": "time_s",
    "clock-offset": "reply_time_s",
    "exchange-motion": "reply_time_s",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "noise-floor": "arc_a",
    "salt-crusts-on-cressets": "salt_g",
    "verdigris-creeps-over-lanterns": "green_d",
    "guano-thickens-on-ledges": "guano_mm",
    "mercury-of-the-lens-bath-dwindles": "mercury_kg",
    "boom-of-the-boat-derrick-close": "boom_m",
    "swell-lifts-before-the-landing": "swell_m",
    "siren-off-its-best-pressure": "siren_kpa",
    "rungs-of-the-ladder-pass": "ladder_m",
    "fog-bells-relay-closes": "sight_km",
    "spray-hangs-over-the-weather-side": "spray_mg",
    "warm-draught-rises-in-the-tower": "draught_k",
    "tide-gauge-sticks-in-its-well": "well_mm",
    "tower-bends-in-the-gale": "gale_m_s",
    "rock-heaves-with-the-tide": "tide_m",
}
LAST = ("heaving-line-stretches-by-its-own-weight", "knots-of-the-line-counted-too-large",
        "fathoms-from-one-cresset", "answers-booked-by-dead-reckoning",
        "answers-lean-to-the-watchs-first", "vernier-read-from-its-wrong-end",
        "range-rounding")  # fmt: skip
"""What becomes of ranges after all else, in this order."""
BURSTS, BURST, COUNTS = 36, 20, 2.2  # of symbols; symbols of each; noise for a root of one
COLD_K = 285.0  # at which noise is that
CRESSETS_DB: Floats = 0.6 * np.cos(1.7 * np.arange(CRESSETS))
TAGS_DB: Floats = 0.5 * np.sin(2.3 * np.arange(len(TAGS)))
OWN_DB = 1.6  # of links, to either side
FIRST = 0.61  # of all that comes is of first paths
OWN_M = 0.0135  # by which links' own errors are off, to either side
NEARER, FARTHER = 0.65, 0.37  # of links in order of distance: up to these, from these on
TOLD = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
        "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the lighthouse's own."""
    rng = np.random.default_rng([9301, seed])
    night = some_of(kept(rng, drawn.rare), drawn, far=False)
    clean = _heard(night, rng, drawn.scatter)
    if not drawn.paired:
        night = next_night(kept(rng, drawn.rare), drawn)
    whole = pd.concat([night] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _heard(whole, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return kept(np.random.default_rng([9301, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, more_m = _with(clean, drawn, seed, 1)
    truth, _ = _with(simulated, drawn, seed, 2)
    made = [logged(one, drawn.listed) for one in (recorded, clean, simulated, truth)]
    return Tables(made[0], made[1], made[2], made[3], more_m)


def logged(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is logged: no courses, and obstacles only if they are listed."""
    return table.drop(columns=[*COURSE] + ([] if listed else ["obstacles"]))


def next_night(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of another night, whose links are none of the recorded ones."""
    return some_of(rows.assign(link="next night, " + rows["link"]), drawn, far=True)


def some_of(rows: pd.DataFrame, drawn: Draw, far: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of farther links, or of nearer ones.

    What is amid these is in both.
    """
    if drawn.same_mix:
        return rows
    means = rows.groupby("link")["true_range_m"].mean()
    part = rows["link"].map(means.rank(pct=True))
    return rows[part >= FARTHER if far else part <= NEARER].reset_index(drop=True)


def about_the_rock(entries: Entries) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, of links by chance."""
    own = entries.per_link(lambda n: entries.rng.triangular(-OWN_DB, 0.4 * OWN_DB, OWN_DB, n))
    ends = CRESSETS_DB[entries.cresset] + TAGS_DB[entries.tag]
    return np.asarray(open_dbm(entries.far) + ends + own)


def summed(entries: Entries) -> tuple[Floats, Floats]:
    """Return how many symbols are summed, and what is told of noise in counts, [n] each.

    Some bursts of symbols are lost before lenses have found them; noise is that of warmth
    (Johnson 1928).
    """
    lost = entries.rng.geometric(0.24, entries.rows).clip(max=15)
    symbols = (BURST * (BURSTS - lost)).astype(np.float64)
    warm = np.sqrt((entries["temperature_c"] + 273.15) / COLD_K)
    uneven = np.exp(entries.rng.triangular(-0.08, 0.0, 0.08, entries.rows))
    return symbols, COUNTS * warm * uneven * np.sqrt(symbols)


def squalls(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1 [rows], now and then wider (a mixture of two normals)."""
    wide = np.where(rng.random(rows) < 0.12, 1.9, 0.808)
    return np.asarray(wide * rng.standard_normal(rows).clip(-3.0, 3.0))


def scatters_m(level: Floats) -> Floats:
    """Return how errors scatter by levels in dBm, in m [n]: evenly, and more where it is weak."""
    return np.asarray(0.0125 + 0.0045 * 10 ** ((-83.0 - level) / 20))


def _heard(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the lighthouse's own ranges and levels.

    Errors are wider where it is weak; links keep a little of their own.
    """
    entries = Entries(rows, 0, rng)
    level = about_the_rock(entries)
    own = OWN_M * entries.per_link(lambda n: rng.uniform(-1.0, 1.0, n))
    error = scatter * (own + scatters_m(level) * squalls(rng, entries.rows))
    symbols, noise = summed(entries)
    every = level + 0.28 * squalls(rng, entries.rows)
    first = level + 10 * np.log10(FIRST) + 0.36 * squalls(rng, entries.rows)
    made = (error, entries.far + error, every, np.minimum(first, every - 0.1), noise, symbols)
    return rows.assign(**dict(zip(TOLD, made, strict=True)))


def _with(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    added = {name: np.zeros(len(table)) for name in drawn.hidden}
    early = sorted({*drawn.hidden} - {*LAST})
    for name in (*early, *(one for one in LAST if one in drawn.hidden)):
        rng = np.random.default_rng([9302, side, seed, *name.encode()])
        dues = EFFECTS[name](Entries(table, seed, rng, bool(drawn.rare)), drawn.strength)
        added[name] = added[name] + dues.more_m
        table = _paid(table, dues)
    return table, np.array([*added.values()]).reshape(len(added), len(table))


def _paid(table: pd.DataFrame, dues: Dues) -> pd.DataFrame:
    """Return the table once dues are paid; of fewer symbols noise falls by the root.

    Of all that comes first paths are but a part.
    """
    error = table["error_m"] + dues.more_m
    lost = 10 * np.log10(1 - FIRST + FIRST * 10 ** (np.asarray(dues.first_db) / 10))
    fewer = np.asarray(dues.count_db)
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + dues.level_db + lost,
        first_path_power_dbm=table["first_path_power_dbm"] + dues.level_db + dues.first_db,
        preamble_count=table["preamble_count"] * 10 ** (fewer / 20),
        noise_std=table["noise_std"] * 10 ** ((np.asarray(dues.noise_db) + 0.5 * fewer) / 20),
    )
