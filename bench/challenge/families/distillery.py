"""Casks, rummagers, maltmen, drays, hoists and cats, whom lintels hear about a distillery.

numpy and pandas alone; what it can hide is in `distillery_effects`, waveforms in
`distillery_waves`. Room, channel and line of sight are known. Lintels answer tags by drips.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.distillery_effects import EFFECTS
from bench.challenge.families.distillery_faults import open_dbm
from bench.challenge.families.distillery_house import COURSE, LAWS, LINTELS, TAGS, Duty, Run
from bench.challenge.families.distillery_shift import RARELY, worked

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Run", "hidden_in", "known", "tables"]
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
    "noise-floor": "boiler_kw",
    "peat-reek-clings-to-lintels": "reek_ppm",
    "angels-share-gone-from-casks": "cask_years",
    "worm-tubs-run-warm": "worm_c",
    "barley-swells-in-the-steep": "steep_h",
    "coppersmiths-stand-close": "smith_m",
    "draff-heaped-against-doors": "draff_t",
    "froth-rises-and-falls-in-washbacks": "froth_h",
    "teeth-of-mash-rakes-pass": "raked_m",
    "valve-lifts-at-high-steam": "steam_bar",
    "spirit-vapour-fills-the-still-house": "vapour_pct",
    "door-between-halls-shut-by-turns": "time_s",
    "loft-bends-under-barley": "loft_t",
    "places-queue-behind-answers": "time_s",
}
LAST_OF_ALL = ("gauge-narrows-past-a-mark", "klafters-from-one-lintel",
               "answers-overshoot-by-what-they-rose", "answers-vatted-over-a-run",
               "range-rounding")  # fmt: skip
"""What becomes of ranges after all else, in this order."""
ASKED, COUNTS = 512, 2.7  # symbols; counts of noise for each root of one
LINTEL_DB: Floats = 0.8 * np.cos(0.7 + 2.1 * np.arange(LINTELS))
TAG_DB: Floats = 0.7 * np.sin(0.9 + 1.7 * np.arange(len(TAGS)))
SHADOW_DB = 1.6  # by which links' levels scatter
STRAIGHT = 0.6  # of all that comes is of first paths
OWN_M = 0.0055  # by which links' own errors scatter
NEARER, FARTHER = 0.66, 0.34  # of links in order of distance: up to these, from these on
READ = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
        "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the distillery's own."""
    rng = np.random.default_rng([6201, seed])
    day = some_of(worked(rng, drawn.rare), drawn, far=False)
    clean = _gauged(day, rng, drawn.scatter)
    if not drawn.paired:
        day = next_day(worked(rng, drawn.rare), drawn)
    often = pd.concat([day] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _gauged(often, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return worked(np.random.default_rng([6201, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    found, late_m = _levied(clean, drawn, seed, 1)
    truth, _ = _levied(simulated, drawn, seed, 2)
    four = [booked(one, drawn.listed) for one in (found, clean, simulated, truth)]
    return Tables(four[0], four[1], four[2], four[3], late_m)


def booked(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table as it is booked: no courses, and obstacles only if they are listed."""
    unsaid = [*COURSE] if listed else [*COURSE, "obstacles"]
    return table.drop(columns=unsaid)


def next_day(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of the next day, whose links are none of the recorded ones."""
    return some_of(rows.assign(link="next day, " + rows["link"]), drawn, far=True)


def some_of(rows: pd.DataFrame, drawn: Draw, far: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of farther links, or of nearer ones.

    What is amid these is in both.
    """
    if drawn.same_mix:
        return rows
    means = rows.groupby("link")["true_range_m"].transform("mean")
    of_links = means.groupby(rows["link"]).first()
    least, most = of_links.quantile(FARTHER), of_links.quantile(NEARER)
    return rows[means >= least if far else means <= most].reset_index(drop=True)


def under_the_roof(run: Run) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, in links' shadows."""
    own = LINTEL_DB[run.lintel] + TAG_DB[run.tag]
    shade = run.by_link(lambda n: SHADOW_DB * run.rng.standard_normal(n).clip(-2.5, 2.5))
    return np.asarray(open_dbm(run.far) + own + shade)


def summed(run: Run) -> tuple[Floats, Floats]:
    """Return how many symbols are summed, and what is told of noise in counts, [n] each."""
    rng = run.rng
    symbols = ASKED - rng.negative_binomial(2, 0.12, run.rows).clip(max=70).astype(np.float64)
    uneven = rng.gamma(900.0, 1 / 900.0, run.rows) * 10 ** (0.012 * LINTEL_DB[run.lintel])
    return symbols, COUNTS * uneven * np.sqrt(symbols)


def odds(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1 [rows], as of means of few (Student 1908)."""
    return np.asarray((np.sqrt(6 / 8) * rng.standard_t(8, rows)).clip(-5.0, 5.0))


def _gauged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the distillery's own ranges and levels.

    Errors are wider where it is weak; links keep a little of their own.
    """
    run = Run(rows, 0, rng)
    level = under_the_roof(run)
    own = run.by_link(lambda n: OWN_M * rng.uniform(-1.73, 1.73, n))
    error = scatter * (own + spread_m(level) * odds(rng, run.rows))
    symbols, noise = summed(run)
    every = level + 0.28 * odds(rng, run.rows)
    first = level + 10 * np.log10(STRAIGHT) + 0.34 * odds(rng, run.rows)
    made = (error, run.far + error, every, np.minimum(first, every - 0.12), noise, symbols)
    return rows.assign(**dict(zip(READ, made, strict=True)))


def spread_m(level: Floats) -> Floats:
    """Return how errors scatter by levels in dBm, in m [n]: of clocks, and of noise."""
    return np.asarray(0.0125 + 0.0045 * 10 ** ((-86.0 - level) / 20).clip(max=3.0))


def _levied(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    order = [*sorted({*drawn.hidden} - {*LAST_OF_ALL})]
    order += [name for name in LAST_OF_ALL if name in drawn.hidden]
    late_m = np.zeros((len(drawn.hidden), len(table)))
    for name in order:
        rng = np.random.default_rng([6202, side, seed, *name.encode()])
        duty = EFFECTS[name](Run(table, seed, rng, bool(drawn.rare)), drawn.strength)
        late_m[drawn.hidden.index(name)] = duty.late_m
        table = _paid(table, duty)
    return table, late_m


def _paid(table: pd.DataFrame, duty: Duty) -> pd.DataFrame:
    """Return the table once duty is paid; noise falls by the root of symbols that are less."""
    fewer_db, first_db = np.asarray(duty.summed_db), np.asarray(duty.first_db)
    whole_db = 10 * np.log10(1 - STRAIGHT + STRAIGHT * 10 ** (first_db / 10))
    error = table["error_m"] + duty.late_m
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + duty.level_db + whole_db,
        first_path_power_dbm=table["first_path_power_dbm"] + duty.level_db + first_db,
        preamble_count=table["preamble_count"] * 10 ** (fewer_db / 20),
        noise_std=table["noise_std"] * 10 ** ((duty.noise_db + 0.5 * fewer_db) / 20),
    )
