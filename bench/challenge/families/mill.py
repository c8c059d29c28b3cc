"""Sacks in an old mill that swing on hoists, ranged from posts: ranges and levels, no CIR.

numpy and pandas alone; what it can hide is in `mill_effects`, its waveforms are in `mill_waves`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.mill_effects import (
    EFFECTS,
    FABRIC,
    HALL_M,
    LAWS,
    POSTS_M,
    PRIVATE,
    SACKS,
    Rows,
)

Floats = NDArray[np.float64]
RUNS, REPEATS, STEP_S = 14, 5, 0.7
NEAR_M, FAR_M = 13.0, 8.5  # of links where the mix of distances is another one
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
    "flour-dust": "dust_g_m3",
    "belt-load": "belt_load_kg",
    "sluice-open": "sluice_cm",
}
RARELY = ("material-delay", "diffraction", "blocked-path")
LAST = ("there-and-back", "range-rounding")  # what is written down wrongly comes after all else


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the mill's own."""
    rng = np.random.default_rng([seed, 211])
    rows = mixed(swung(rng, drawn.rare), "" if drawn.same_mix else "near")
    clean = _ranged(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = mixed(swung(rng, drawn.rare), "" if drawn.same_mix else "far")
        rows = rows.assign(link="sim-" + rows["link"])
    parts = [_ranged(rows, rng, drawn.scatter) for _ in range(drawn.ratio)]
    return hidden_in(drawn, seed, clean, pd.concat(parts, ignore_index=True))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return swung(np.random.default_rng([seed, 211]), drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts = _with(clean, drawn, seed, 212)
    truth, _ = _with(simulated, drawn, seed, 213)
    recorded, clean, simulated, truth = (
        shown_of(one, drawn.listed) for one in (recorded, clean, simulated, truth)
    )
    return Tables(recorded, clean, simulated, truth, shifts)


def shown_of(table: pd.DataFrame, listed: bool) -> pd.DataFrame:
    """Return the table without what nobody wrote down."""
    return table.drop(columns=[*PRIVATE] if listed else [*PRIVATE, "obstacles"])


def swung(
    rng: np.random.Generator, rare: str, repeats: int = REPEATS, runs: int = RUNS
) -> pd.DataFrame:
    """Return what is known of the rows: runs of a swinging or hanging sack past all posts."""
    frame = pd.concat([_run(rng, number, repeats) for number in range(runs)], ignore_index=True)
    shares = {"material-delay": (0.06, 0.0), "diffraction": (0.0, 0.06)}.get(rare, (0.3, 0.2))
    return frame.assign(
        reply_time_s=0.003 + 0.12 * rng.beta(0.8, 1.2, len(frame)),
        belt_load_kg=rng.triangular(0, 120, 300, len(frame)),
        obstacles=_in_between(rng, frame["link"], *shares),
    )


def mixed(rows: pd.DataFrame, where: str) -> pd.DataFrame:
    """Return all rows, or those of links that are near or far."""
    middle = rows.groupby("link")["true_range_m"].transform("mean")
    kept = {"": middle > 0, "near": middle < NEAR_M, "far": middle > FAR_M}[where]
    return rows[kept].reset_index(drop=True)


def _run(rng: np.random.Generator, number: int, repeats: int) -> pd.DataFrame:
    """Return one run: a sack polls the posts in turn while it swings, or hangs still."""
    post, row = (a.ravel() for a in np.meshgrid(np.arange(len(POSTS_M)), np.arange(repeats)))
    when = row * STEP_S + 0.05 * post
    beat = rng.uniform(0.25, 0.6)
    turned = rng.uniform(0, 2 * np.pi) + beat * when
    sway = np.array([*rng.uniform(-3.5, 3.5, 2), rng.uniform(-0.5, 0.5)]) * (number % 5 != 2)
    sack = rng.uniform([5, 4.6, 1.1], [21, 9.4, 2.2]) + np.sin(turned)[:, None] * sway
    gap = sack - POSTS_M[post]
    facing = rng.uniform(0, 360) + 25 * np.sin(when)
    bearing = np.degrees(np.arctan2(-gap[:, 1], -gap[:, 0]))
    on_s = rng.exponential(900) + when
    made: dict[str, Any] = {
        "link": [f"run{number}/{one}" for one in post],
        "tx": f"sack{rng.integers(SACKS)}",
    }
    made |= {"rx": [f"post{one}" for one in post], "time_s": number * 730.0 + when}
    made |= {f"tx_{a}_m": v for a, v in zip("xyz", sack.T, strict=True)}
    made |= {f"rx_{a}_m": v for a, v in zip("xyz", POSTS_M[post].T, strict=True)}
    made |= {f"room_{a}_m": v for a, v in zip("xyz", HALL_M, strict=True)}
    made |= {"true_range_m": np.linalg.norm(gap, axis=1)}
    made |= {"azimuth_deg": (bearing - facing + 180) % 360 - 180}
    made |= {"temperature_c": _warmed(rng.uniform(6, 24), on_s)}
    made |= {"dust_g_m3": rng.gamma(1.6, 5.5) * rng.lognormal(0, 0.5, len(when))}
    made |= {"sluice_cm": rng.uniform(0, 62, len(when))}
    made |= dict(zip(PRIVATE, (*sway, beat, turned), strict=True))
    return pd.DataFrame(made)


def _warmed(room_c: float, on_s: Floats) -> Floats:
    """Return how warm a tag is: its chip warms within minutes, its case within half an hour."""
    return np.asarray(room_c + 6 * (1 - np.exp(-on_s / 80)) + 11 * (1 - np.exp(-on_s / 1500)))


def _in_between(rng: np.random.Generator, links: pd.Series, walls: float, iron: float) -> pd.Series:
    """Return what stands in the straight path of the links: walls, or an iron machine."""
    kinds = {}
    for link in links.unique():
        chance = rng.random()
        some = [str(one) for one in rng.choice(list(FABRIC), rng.integers(1, 3), replace=False)]
        kinds[link] = some if chance < walls else ["metal"] if chance > 1 - iron else []
    return pd.Series([kinds[link] for link in links], dtype=object)


def _ranged(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of the mill's own radio."""
    far, count = rows["true_range_m"].to_numpy(np.float64), len(rows)
    codes, links = pd.factorize(rows["link"])
    level = -63.2 - 18.5 * np.log10(far) + rng.normal(0, 1.1, len(links))[codes]
    level = level + rng.normal(0, 0.35, count)
    error = 0.012 * scatter * (1 + 10 ** ((level + 88) / -20) / 4) * rng.logistic(size=count)
    made = rows.assign(range_m=far + error, error_m=error, rx_power_dbm=level)
    return made.assign(
        first_path_power_dbm=level - 0.7 - rng.gamma(2.0, 0.45, count),
        noise_std=61.0 * rng.lognormal(0, 0.06, count),
        preamble_count=rng.integers(492, 513, count).astype(np.float64),
    )


def _with(table: pd.DataFrame, drawn: Draw, seed: int, part: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m."""
    own = int(np.random.default_rng([seed, 214]).integers(2**31))
    rng, shifts = np.random.default_rng([seed, part]), np.zeros((len(drawn.hidden), len(table)))
    for name in sorted(drawn.hidden, key=lambda one: one in LAST and 1 + LAST.index(one)):
        change = EFFECTS[name](Rows(table, own, rng, bool(drawn.rare)), drawn.strength)
        shifts[drawn.hidden.index(name)] = change.longer_m
        error = table["error_m"] + change.longer_m
        first = table["first_path_power_dbm"] + change.louder_db + change.straight_db
        level = table["rx_power_dbm"] + change.louder_db + 0.8 * np.asarray(change.straight_db)
        table = table.assign(
            error_m=error, range_m=table["true_range_m"] + error, rx_power_dbm=level,
            first_path_power_dbm=first, noise_std=table["noise_std"] * change.noisier,
            preamble_count=table["preamble_count"] * change.symbols,
        )  # fmt: skip
    return table, shifts
