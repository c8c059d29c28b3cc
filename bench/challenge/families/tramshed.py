"""Trams, traversers, sweepers, jacks, blocks and poles, whom rosettes call in a tram shed.

numpy and pandas alone; what it can hide is in `tramshed_effects`, waveforms in `tramshed_waves`.
Shed and line of sight are known. Rosettes call by rounds that slow down; tags measure.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.tramshed_depot import COURSE, LAWS, ROSETTES, TAGS, Fares, Fine
from bench.challenge.families.tramshed_effects import EFFECTS
from bench.challenge.families.tramshed_faults import open_dbm
from bench.challenge.families.tramshed_roster import RARELY, worked

__all__ = ["CAUSES", "KNOWN", "LAWS", "RARELY", "Fares", "hidden_in", "known", "tables"]
Floats = NDArray[np.float64]
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = {
    "path-loss": "true_range_m",
    "power-bias": "true_range_m",
    "range-scale": "true_range_m",
    "level-control": "true_range_m",
    "tape-spliced-past-a-mark": "true_range_m",
    "ranges-told-as-chords-of-a-curve": "true_range_m",
    "antenna-delay": "time_s",
    "time-lag": "time_s",
    "feeder-sections-fed-by-turns": "time_s",
    "answers-late-as-crews-change": "time_s",
    "clock-offset": "reply_time_s",
    "exchange-motion": "reply_time_s",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "noise-floor": "motor_a",
    "sand-packs-in-its-boxes": "sand_kg",
    "carbon-films-rosettes-since-wiped": "wiped_d",
    "varnish-lies-thick-on-tags": "varnish_um",
    "slack-wire-lets-rosettes-hang": "tension_kn",
    "tower-wagon-parked-close": "wagon_m",
    "feeders-warm-by-their-current": "feeder_ka",
    "lamps-off-their-rated-voltage": "line_v",
    "sleepers-pass-underneath": "sleepers_m",
    "air-governor-lets-the-compressor-run": "tank_bar",
    "brake-dust-hangs-along-the-pits": "brake_mg",
    "air-shimmers-about-the-drying-boiler": "boiler_k",
    "relay-holds-between-two-pressures": "relay_kpa",
    "girders-bow-under-lifted-cars": "lifted_t",
    "setts-heave-with-frost": "frost_mm",
}
LATER_ON = ("ranges-told-as-chords-of-a-curve", "tape-spliced-past-a-mark",
            "braccia-from-one-rosette", "answers-merged-with-the-next",
            "first-answers-smeared-by-the-last-caller", "range-rounding")  # fmt: skip
"""What becomes of ranges after all else, in this order."""
SYMBOLS, CHUNK, COUNTS = 1024, 16, 2.0  # sent; that are lost at once; noise for a root of one
MILD_K = 288.0  # at which noise is that
ROSETTES_DB: Floats = 0.55 * np.sin(2.1 * np.arange(ROSETTES) + 0.4)
TAGS_DB: Floats = 0.5 * np.cos(1.9 * np.arange(len(TAGS)))
OWN_DB = 1.1  # of links
FIRST = 0.58  # of all that comes is of first paths
OWN_M = 0.0095  # by which links' own errors are off
NEARER, FARTHER = 0.65, 0.37  # of links in order of distance: up to these, from these on
TOLD = ("error_m", "range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
        "preamble_count")  # fmt: skip
"""Columns that are not known before anything is measured."""


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the tram shed's own."""
    rng = np.random.default_rng([9501, seed])
    day = mixed_rows(worked(rng, drawn.rare), drawn, far=False)
    clean = _measured(day, rng, drawn.scatter)
    if not drawn.paired:
        day = day_after(worked(rng, drawn.rare), drawn)
    copies = pd.concat([day] * drawn.ratio, ignore_index=True)
    return hidden_in(drawn, seed, clean, _measured(copies, rng, drawn.scatter))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return worked(np.random.default_rng([9501, seed]), drawn.rare)


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
    return table.drop(columns=[*COURSE, *([] if listed else ["obstacles"])])


def day_after(rows: pd.DataFrame, drawn: Draw) -> pd.DataFrame:
    """Return rows of another day, whose links are none of the recorded ones."""
    return mixed_rows(rows.assign(link="day after, " + rows["link"]), drawn, far=True)


def mixed_rows(rows: pd.DataFrame, drawn: Draw, far: bool) -> pd.DataFrame:
    """Return all rows; where the mix is to differ, those of farther links, or of nearer ones.

    What is amid these is in both.
    """
    if drawn.same_mix:
        return rows
    order = rows.groupby("link")["true_range_m"].mean().rank(pct=True)
    kept = order[order >= FARTHER] if far else order[order <= NEARER]
    return rows[rows["link"].isin(kept.index)].reset_index(drop=True)


def in_the_shed(fares: Fares) -> Floats:
    """Return levels in dBm [n]: by distances, by ends that differ, of links by chance."""
    own = fares.each_link(lambda n: OWN_DB * fares.rng.logistic(0.0, 0.5, n).clip(-2.2, 2.2))
    return np.asarray(open_dbm(fares.far) + ROSETTES_DB[fares.rosette] + TAGS_DB[fares.tag] + own)


def gathered(fares: Fares) -> tuple[Floats, Floats]:
    """Return how many symbols are gathered, and what is told of noise in counts, [n] each.

    Some are lost until it is known what to gather; noise is that of warmth (Nyquist 1928).
    """
    lost = fares.rng.negative_binomial(3, 0.3, fares.rows).clip(max=24)
    symbols = np.asarray(SYMBOLS - CHUNK * lost, np.float64)
    warm = np.sqrt((fares["temperature_c"] + 273.15) / MILD_K)
    uneven = 1 + 0.06 * (fares.rng.random(fares.rows) + fares.rng.random(fares.rows) - 1)
    return symbols, COUNTS * warm * uneven * np.sqrt(symbols)


def jolts(rng: np.random.Generator, rows: int) -> Floats:
    """Return chances that scatter by 1 [rows]: of Student's law of seven degrees, cut off."""
    return np.asarray((rng.standard_t(7, rows) * np.sqrt(5 / 7)).clip(-3.6, 3.6))


def scatters_m(level: Floats) -> Floats:
    """Return how errors scatter by levels in dBm, in m [n]: more where it is weak."""
    return np.asarray(np.hypot(0.0165, 0.009 * 10 ** ((-89.0 - level) / 20)))


def _measured(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the tram shed's own ranges and levels.

    Errors are wider where it is weak; links keep a little of their own.
    """
    fares = Fares(rows, 0, rng)
    level = in_the_shed(fares)
    own = fares.each_link(lambda n: OWN_M * rng.standard_normal(n).clip(-2.2, 2.2))
    error = scatter * (own + scatters_m(level) * jolts(rng, fares.rows))
    symbols, noise = gathered(fares)
    every = level + 0.3 * jolts(rng, fares.rows)
    first = np.minimum(level + 10 * np.log10(FIRST) + 0.4 * jolts(rng, fares.rows), every - 0.1)
    made = (error, fares.far + error, every, first, noise, symbols)
    return rows.assign(**dict(zip(TOLD, made, strict=True)))


def _hiding(table: pd.DataFrame, drawn: Draw, seed: int, side: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with what is hidden in it, and what each of that adds to ranges in m."""
    late = {name: np.zeros(len(table)) for name in drawn.hidden}
    for name in sorted(late, key=lambda one: (LATER_ON.index(one) + 1 if one in LATER_ON else 0,
                                              one)):  # fmt: skip
        rng = np.random.default_rng([9502, side, seed, *name.encode()])
        fine = EFFECTS[name](Fares(table, seed, rng, bool(drawn.rare)), drawn.strength)
        late[name] = late[name] + fine.late_m
        table = _levied(table, fine)
    return table, np.vstack([*late.values()]) if late else np.zeros((0, len(table)))


def _levied(table: pd.DataFrame, fine: Fine) -> pd.DataFrame:
    """Return the table once fines are levied; of fewer symbols noise falls by the root.

    Of all that comes first paths are but a part.
    """
    error = table["error_m"] + fine.late_m
    kept = 10 ** (np.asarray(fine.first_db) / 10)
    fewer = 10 ** (np.asarray(fine.count_db) / 20)
    return table.assign(
        error_m=error,
        range_m=table["true_range_m"] + error,
        rx_power_dbm=table["rx_power_dbm"] + fine.level_db + 10 * np.log10(1 + FIRST * (kept - 1)),
        first_path_power_dbm=table["first_path_power_dbm"] + fine.level_db + fine.first_db,
        noise_std=table["noise_std"] * np.sqrt(fewer) * 10 ** (np.asarray(fine.noise_db) / 20),
        preamble_count=table["preamble_count"] * fewer,
    )
