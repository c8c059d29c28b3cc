"""Censers, vergers, doves, pilgrims, masons and choristers, who call bosses about a cathedral.

numpy and pandas alone; what it can hide is in `cathedral_effects`, waveforms in `cathedral_waves`.
Room, channel and line of sight are known. Tags call, bosses answer in changes.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.cathedral_effects import EFFECTS
from bench.challenge.families.cathedral_faults import open_dbm
from bench.challenge.families.cathedral_nave import BOSSES, COURSE, LAWS, TAGS, Dues, Vigil
from bench.challenge.families.cathedral_office import RARELY, held

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Vigil", "hidden_in", "known", "tables"]
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
    "noise-floor": "organ_kw",
    "wax-gutters-over-covers": "wax_mm",
    "incense-thickens-about-tags": "incense_g",
    "candlestands-drawn-close": "stand_m",
    "hassocks-heaped-before-bosses": "hassocks",
    "pipes-cool-since-stoked": "stoked_min",
    "damp-rises-behind-bosses": "damp_pct",
    "joints-of-flags-pass-underfoot": "paced_m",
    "blower-runs-at-slack-wind": "wind_mm",
    "candles-warm-ways-that-pass-them": "candles",
    "clock-of-places-set-right-each-quarter": "time_s",
}
AFTERWARDS = ("answers-no-longer-than-a-chain", "passus-from-one-boss",
              "longer-of-two-answers-told", "answers-kept-until-they-differ-enough",
              "range-rounding")  # fmt: skip
"""What becomes of ranges after all else, in this order."""
ASKED, COUNTS = 1024, 2.1  # symbols; counts of noise for each root of one
BOSS_DB: Floats = 0.9 * np.sin(1.3 + 2.4 * np.arange(BOSSES))
TAG_DB: Floats = 0.8 * np.cos(0.4 + 1.9 * np.arange(len(TAGS)))
SHADES = 7.0  # of a gamma by which links' powers fade
STRAIGHT = 0.55  # of all that comes is of first paths
OWN_M = 0.005  # by which links' own errors scatter
NEAR, FAR = 0.65, 0.35  # of links in order of distance: up to these, from these on
READ = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
        "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the cathedral's own."""
    rng = np.random.default_rng([5401, seed])
    feast = of_a_mix(held(rng, drawn.rare), drawn, nearer=True)
    clean = _ranged(feast, rng, drawn.scatter)
    if not drawn.paired:
        feast = octave(held(rng, drawn.rare), drawn)
    simulated = _ranged(pd.concat([feast] * drawn.ratio, ignore_index=True), rng, drawn.scatter)
    return hidden_in(drawn, seed, clean, simulated)


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return held(np.random.default_rng([5401, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts_m = _with_dues(clean, drawn, seed, 1)
    truth = _with_dues(simulated, drawn, seed, 2)[0]
    shown = [written(one, drawn.listed) for one in (recorded, clean, simulated, truth)]
    return Tables(shown[0], shown[1], shown[2], shown[3], shifts_m)


def written(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is written: no courses, and obstacles only if they are listed."""
    kept = table.drop(columns=[*COURSE])
    return kept if listed else kept.drop(columns="obstacles")


def octave(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of a feast's octave, whose links are none of the recorded ones."""
    rows = of_a_mix(rows, drawn, nearer=False)
    return rows.assign(link=["octave, " + link for link in rows["link"]])


def of_a_mix(rows: pd.DataFrame, drawn: Draw, nearer: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of nearer links, or of farther ones.

    What is amid these is in both: of places, no more than a part is.
    """
    if drawn.same_mix:
        return rows
    far = rows.groupby("link")["true_range_m"].mean()
    rank = rows["link"].map(far.rank(pct=True))
    return rows[rank <= NEAR if nearer else rank > FAR].reset_index(drop=True)


def under_the_vault(vigil: Vigil) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, with fades of links.

    Powers of these are gammas, as over Nakagami's ways.
    """
    fades = vigil.each(lambda n: vigil.rng.gamma(SHADES, 1 / SHADES, n).clip(0.2, 2.4))
    own = BOSS_DB[vigil.boss] + TAG_DB[vigil.tag]
    return np.asarray(open_dbm(vigil.far) + own + 10 * np.log10(fades))


def added_up(vigil: Vigil) -> tuple[Floats, Floats]:
    """Return how many symbols are added up, and what is told of noise in counts, [n] each."""
    rng = vigil.rng
    lost = rng.poisson(rng.exponential(28.0, vigil.rows).clip(max=120.0))
    symbols = ASKED - lost.astype(np.float64)
    louder = 10 ** (0.01 * BOSS_DB[vigil.boss]) * (1 + 0.032 * chances(rng, vigil.rows))
    return symbols, COUNTS * louder * np.sqrt(symbols)


def chances(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1 [rows]: of ten, one is of twice as wide ones (Tukey)."""
    wide = np.where(rng.random(rows) < 0.1, 2.0, 1.0)
    return np.asarray((wide * rng.standard_normal(rows) / np.sqrt(1.3)).clip(-5.0, 5.0))


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the cathedral's own ranges and levels.

    Errors are wider where it is weak; links keep a little of their own.
    """
    vigil = Vigil(rows, 0, rng)
    level = under_the_vault(vigil)
    own = vigil.each(lambda n: OWN_M * rng.standard_normal(n))
    error = scatter * (own + wide_m(level) * chances(rng, vigil.rows))
    symbols, noise = added_up(vigil)
    every = level + 0.3 * chances(rng, vigil.rows)
    first = level + 10 * np.log10(STRAIGHT) + 0.36 * chances(rng, vigil.rows)
    made = [error, vigil.far + error, every, np.minimum(first, every - 0.1), noise, symbols]
    return rows.assign(**dict(zip(READ, made, strict=True)))


def wide_m(level: Floats) -> Floats:
    """Return how errors scatter by levels in dBm, in m [n]: of clocks, and of noise."""
    return np.asarray(np.hypot(0.0145, 0.0065 * 10 ** ((-82.0 - level) / 20).clip(max=3.2)))


def _with_dues(
    table: pd.DataFrame, drawn: Draw, seed: int, side: int
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    first = sorted(name for name in drawn.hidden if name not in AFTERWARDS)
    added = {}
    for name in (*first, *(one for one in AFTERWARDS if one in drawn.hidden)):
        rng = np.random.default_rng([5402, seed, side, *name.encode()])
        dues = EFFECTS[name](Vigil(table, seed, rng, bool(drawn.rare)), drawn.strength)
        added[name] = np.zeros(len(table)) + dues.late_m
        table = _paid(table, dues)
    return table, np.array([added[name] for name in drawn.hidden]).reshape(-1, len(table))


def _paid(table: pd.DataFrame, dues: Dues) -> pd.DataFrame:
    """Return the table once rows have paid; noise falls by the root of symbols that are less."""
    of_first = 10 ** (np.asarray(dues.first_db) / 10)
    every_db = dues.level_db + 10 * np.log10(1 + STRAIGHT * (of_first - 1))
    symbols = 10 ** (np.asarray(dues.summed_db) / 20)
    noise_db = np.asarray(dues.noise_db) + 0.5 * np.asarray(dues.summed_db)
    error = table["error_m"] + dues.late_m
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + every_db,
        first_path_power_dbm=table["first_path_power_dbm"] + dues.level_db + dues.first_db,
        noise_std=table["noise_std"] * 10 ** (noise_db / 20),
        preamble_count=table["preamble_count"] * symbols,
    )
