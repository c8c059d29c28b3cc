"""Pickers that weave along rows of trees, ranged from posts on both sides: ranges and levels.

numpy and pandas alone; what it can hide is in `orchard_effects`, its waveforms in `orchard_waves`.
No room and no CIR; leaves weaken what crosses rows. Exchanges are double-sided.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.orchard_effects import EFFECTS
from bench.challenge.families.orchard_plot import (
    COURSE,
    GROUND_M,
    LAWS,
    PICKERS,
    POSTS_M,
    STACKS,
    Plot,
    Yield,
)

Floats = NDArray[np.float64]
COURSES, ROUNDS, ROUND_S, TURN_S = 14, 4, 0.8, 0.023
ROWS_M, CROWN_M = 4.1, 1.3  # between rows of trees; leaves in each
KNOWN = tuple(name for name in EFFECTS if name not in LAWS)
CAUSES = {
    "time-lag": "time_s",
    "exchange-motion": "reply_time_s",
    "antenna-delay": "time_s",
    "clock-offset": "reply_time_s",
    "temperature-drift": "temperature_c",
    "antenna-pattern": "azimuth_deg",
    "power-bias": "true_range_m",
    "path-loss": "true_range_m",
    "range-scale": "true_range_m",
    "level-control": "true_range_m",
    "dew-on-leaves": "dew_mm",
    "crates-aboard": "crates_kg",
    "irrigation-turns": "time_s",
    "sprayer-runs": "pump_bar",
    "leaves-grow": "leaf_area_index",
}
RARELY = ("blocked-path", "diffraction", "exchange-motion")
BY_FIRMWARE = ("yards-from-one-post", "slew-limited", "range-rounding")
RARE_SHARE = 0.07


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the orchard's own."""
    rng = np.random.default_rng([711, seed])
    rows = picked(grown(rng, drawn.rare), "" if drawn.same_mix else "close")
    clean = _logged(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = picked(grown(rng, drawn.rare), "" if drawn.same_mix else "wide")
        rows = rows.assign(link="virtual " + rows["link"])
    simulated = pd.concat(
        [_logged(rows, rng, drawn.scatter) for _ in range(drawn.ratio)], ignore_index=True
    )
    return hidden_in(drawn, seed, clean, simulated)


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return grown(np.random.default_rng([711, seed]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts = _harvested(clean, drawn, seed, "field")
    truth, _ = _harvested(simulated, drawn, seed, "model")
    recorded, clean, simulated, truth = (
        open_to_all(one, drawn.listed) for one in (recorded, clean, simulated, truth)
    )
    return Tables(recorded, clean, simulated, truth, shifts)


def open_to_all(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without the pickers' courses, and what stands between unless listed."""
    private = list(COURSE) if listed else [*COURSE, "obstacles"]
    return table.drop(columns=private, errors="ignore")


def grown(
    rng: np.random.Generator, rare: str, rounds: int = ROUNDS, courses: int = COURSES
) -> pd.DataFrame:
    """Return what is known of the rows of a day: courses along rows, some of them at rest."""
    rests = rng.permutation(courses) < round(0.22 * courses)
    if rare == "exchange-motion":
        rests = rng.permutation(courses) >= 2
    day = np.sort(rng.uniform(0, 9.5 * 3600, courses))
    parts = [_course(rng, one, rounds, day[one], bool(rests[one])) for one in range(courses)]
    table = pd.concat(parts, ignore_index=True)
    size = len(table)
    table["reply_time_s"] = np.minimum(0.004 + rng.exponential(0.045, size), 0.2)
    table["pump_bar"] = rng.uniform(0, 7.5, size)
    table["crates_kg"] = 340 * rng.beta(0.9, 0.9, size)
    table["satellites"] = rng.integers(5, 19, size).astype(np.float64)
    table["obstacles"] = _stacked(rng, table["link"], RARE_SHARE if rare == "diffraction" else 0.18)
    return table


def picked(rows: pd.DataFrame, which: str) -> pd.DataFrame:
    """Return all rows, or links by their distance: `close` ones or `wide` ones are likelier."""
    if not which:
        return rows
    mean = rows.groupby("link", sort=False)["true_range_m"].transform("mean")
    place = mean.rank(method="dense") / mean.nunique()
    golden = np.mod(np.arange(rows["link"].nunique()) * 0.61803, 1)  # even, and not of chance
    keep = pd.Series(golden, index=rows["link"].unique())
    chance = 1.25 - place if which == "close" else 0.25 + place
    return rows[rows["link"].map(keep) < chance**2].reset_index(drop=True)


def _course(
    rng: np.random.Generator, number: int, rounds: int, begin_s: float, rests: bool
) -> pd.DataFrame:
    """Return one course: all posts range a picker, round by round, while it weaves on."""
    post = np.tile(np.arange(len(POSTS_M)), rounds)
    when = np.arange(len(post)) * TURN_S + np.repeat(np.arange(rounds), len(POSTS_M)) * (
        ROUND_S - TURN_S * len(POSTS_M)
    )
    pace = 0.0 if rests else float(rng.choice([-1, 1])) * rng.uniform(0.8, 3.2)
    weave = 0.0 if rests else rng.uniform(0.1, 0.5)
    rate, phase = rng.uniform(0.4, 1.1), rng.uniform(0, 2 * np.pi) + 0 * when
    phase = phase + rate * when
    here = np.empty((len(when), 3))
    here[:, 0] = rng.uniform(9, GROUND_M[0] - 9) + pace * when
    row = (rng.integers(0, int(GROUND_M[1] / ROWS_M)) + 0.5) * ROWS_M
    here[:, 1] = row + weave * (np.sin(phase) - np.sin(phase[0]))
    here[:, 2] = rng.uniform(1.0, 1.5)
    way = POSTS_M[post] - here
    ahead = np.arctan2(weave * rate * np.cos(phase), pace if pace else 1.0)
    seen = np.degrees(np.arctan2(way[:, 1], way[:, 0]) - ahead)
    made: dict[str, Any] = {
        "link": [f"course {number} to post {one}" for one in post],
        "tx": f"picker{rng.integers(PICKERS)}",
        "rx": [f"post{one}" for one in post],
        "environment": "upper block" if row > GROUND_M[1] / 2 else "lower block",
        "time_s": begin_s + when,
        "azimuth_deg": np.mod(seen, 360),
        "true_range_m": np.linalg.norm(way, axis=1),
    }
    made |= {f"tx_{axis}_m": here[:, one] for one, axis in enumerate("xyz")}
    made |= {f"rx_{axis}_m": POSTS_M[post, one] for one, axis in enumerate("xyz")}
    made |= dict(zip(COURSE, (pace, weave, rate, phase), strict=True))
    return pd.DataFrame(made | _weather(rng, begin_s, len(when)))


def _weather(rng: np.random.Generator, begin_s: float, size: int) -> dict[str, Floats]:
    """Return warmth, dew and leaves: by the time of the day, and as posts stand in the shade."""
    warm = 9 + 17 * np.sin(begin_s / 3600 / 9.5 * np.pi) + rng.normal(0, 3)
    dew = rng.gamma(0.9, 0.16) * rng.uniform(0.6, 1.4, size)
    leaves = rng.uniform(0.2, 5.5) * rng.uniform(0.8, 1.2, size)
    near = warm + rng.normal(0, 1.2, size)
    return {"temperature_c": near, "dew_mm": dew, "leaf_area_index": leaves}


def _stacked(rng: np.random.Generator, links: pd.Series, steel: float) -> pd.Series:
    """Return what stands in the straight path: a trailer, one or two stacks, or nothing."""
    kinds: dict[str, list[str]] = {}
    for link in links.unique():
        some = [str(one) for one in rng.permutation(list(STACKS))[: rng.integers(1, 3)]]
        kinds[link] = ["metal"] if rng.random() < steel else some if rng.random() < 0.32 else []
    return links.map(kinds)


def in_leaves(rows: pd.DataFrame) -> Floats:
    """Return the level in dBm: as in the open, less what leaves of the rows crossed take [n]."""
    far = rows["true_range_m"].to_numpy(np.float64)
    ends = (rows[f"{end}_y_m"].to_numpy(np.float64) for end in ("tx", "rx"))
    crossed = np.abs(np.subtract(*ends)) / ROWS_M
    leaves = np.minimum(CROWN_M * crossed * far / np.maximum(far, 1), 14)
    return np.asarray(-55.5 - 20 * np.log10(far) - 0.45 * 3.4944**0.284 * leaves**0.9)


def _logged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the orchard's own radio."""
    size, (which, links) = len(rows), pd.factorize(rows["link"])
    level = in_leaves(rows) + rng.normal(0, 1.0, len(links))[which]
    level = level - rng.exponential(0.45, size)  # leaves that move
    error = 0.019 * scatter * rng.normal(size=size) * rng.choice([0.8, 1.6], size, p=[0.85, 0.15])
    out = rows.assign(error_m=error, range_m=rows["true_range_m"] + error, rx_power_dbm=level)
    out["first_path_power_dbm"] = level - rng.gamma(3.0, 0.5, size)
    out["noise_std"] = rng.normal(97.0, 3.5, size)
    return out.assign(preamble_count=np.rint(1018 - rng.gamma(2.0, 2.0, size)))


def _harvested(
    table: pd.DataFrame, drawn: Draw, seed: int, where: str
) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    rng = np.random.default_rng([712, seed, *where.encode()])
    shifts = dict.fromkeys(drawn.hidden, np.zeros(len(table)))
    natural = [name for name in drawn.hidden if name not in BY_FIRMWARE]
    for name in (*natural, *(one for one in BY_FIRMWARE if one in drawn.hidden)):
        plot = Plot(table, seed, rng, seldom=bool(drawn.rare))
        gives = EFFECTS[name](plot, drawn.strength)
        shifts[name], table = gives.metres, _given(table, gives)
    return table, np.array([*shifts.values()]).reshape(len(shifts), len(table))


def _given(table: pd.DataFrame, gives: Yield) -> pd.DataFrame:
    """Return the table with what an effect gives to its rows or takes."""
    out = table.assign(error_m=table["error_m"] + gives.metres)
    out["range_m"] = out["true_range_m"] + out["error_m"]
    out["rx_power_dbm"] += gives.whole + 0.75 * np.asarray(gives.edge)
    out["first_path_power_dbm"] += gives.whole + np.asarray(gives.edge)
    out["noise_std"] *= 10 ** (np.asarray(gives.hiss) / 20)
    out["preamble_count"] *= 10 ** (np.asarray(gives.count) / 20)
    return out
