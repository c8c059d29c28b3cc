"""Visitors of an abbey with tags on a strap, ranged from lamps: ranges and levels, no CIR.

numpy and pandas alone; what it can hide is in `abbey_effects`. They stroll along arcs of circles
or stand still; the radio also reports how many symbols it accumulated, and its noise.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.abbey_effects import EFFECTS, LAMPS_M, LAWS, PRIVATE, STONES, Book
from bench.challenge.families.case import Draw, Tables

Floats = NDArray[np.float64]
STROLLS, ROWS, STEP_S = 18, 4, 0.9
SCATTER_M, SYMBOLS = 0.019, 512.0
PLACES = {"cloister": (7.0, 29.0), "nave": (11.0, 18.0), "crypt": (6.0, 12.0)}  # degrees C
NEAR_M, FAR_M = 18.0, 12.0  # of links where the mix of distances is another one
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
    "hours-awake": "awake_h",
    "crowd": "visitors",
    "wall-beside": "wall_gap_m",
}
RARELY = ("time-lag", "material-delay", "blocked-path")


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the abbey's own."""
    rng = np.random.default_rng([seed, 61])
    rows = _strolled(rng, "all" if drawn.same_mix else "near", drawn.rare)
    clean = _heard(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = _strolled(rng, "all" if drawn.same_mix else "far", drawn.rare)
        rows = rows.assign(link="plan " + rows["link"])
    parts = [_heard(rows, rng, drawn.scatter) for _ in range(drawn.ratio)]
    return hidden_in(drawn, seed, clean, pd.concat(parts, ignore_index=True))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _strolled(np.random.default_rng([seed, 61]), "all", drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts = _with(clean, drawn, seed, 62)
    truth = _with(simulated, drawn, seed, 63)[0]
    gone = list(PRIVATE) if drawn.listed else [*PRIVATE, "obstacles"]
    recorded, clean, simulated, truth = (
        one.drop(columns=gone) for one in (recorded, clean, simulated, truth)
    )
    return Tables(recorded, clean, simulated, truth, shifts)


def _strolled(rng: np.random.Generator, where: str, rare: str) -> pd.DataFrame:
    """Return what is known of the rows: strolls in three places, a quarter of them on the spot."""
    parts = [_stroll(rng, number, rare) for number in range(STROLLS)]
    frame = pd.concat(parts, ignore_index=True)
    middle = frame.groupby("link")["true_range_m"].transform("mean")
    kept = {"all": middle > 0, "near": middle < NEAR_M, "far": middle > FAR_M}[where]
    frame = frame[kept].reset_index(drop=True)
    return frame.assign(
        reply_time_s=rng.choice([0.004, 0.03, 0.08, 0.15], len(frame)),
        visitors=rng.negative_binomial(2, 0.07, len(frame)).astype(np.float64),
        wall_gap_m=rng.uniform(0.25, 4.0, len(frame)),
        obstacles=_between(rng, frame["link"], 0.07 if rare == "material-delay" else 0.3),
    )


def _stroll(rng: np.random.Generator, number: int, rare: str) -> pd.DataFrame:
    """Return one stroll past all lamps, polled in turn: even pace along an arc of a circle."""
    lamp, row = (a.ravel() for a in np.meshgrid(np.arange(len(LAMPS_M)), np.arange(ROWS)))
    when = row * STEP_S + 0.04 * lamp
    stands = number % 4 == 1 if rare != "time-lag" else number % 9 != 3
    here, speed, turning = _arc(rng, when, stands)
    gap = here - np.array(LAMPS_M, np.float64)[lamp]
    facing = np.degrees(np.arctan2(speed[:, 1], speed[:, 0])) if not stands else rng.uniform(0, 360)
    bearing = np.degrees(np.arctan2(-gap[:, 1], -gap[:, 0]))
    far, pace = np.linalg.norm(gap, axis=1), (gap * speed).sum(axis=1)
    visitor, place = int(rng.integers(5)), str(rng.choice(list(PLACES), p=[0.4, 0.4, 0.2]))
    ends = {f"tx_{a}_m": v for a, v in zip("xyz", here.T, strict=True)}
    ends |= {f"rx_{a}_m": v for a, v in zip("xyz", (here - gap).T, strict=True)}
    kept: dict[str, Any] = {
        "link": [f"v{number}-{one}" for one in lamp],
        "tx": f"tag{visitor}",
        "rx": [f"lamp{one}" for one in lamp],
        "environment": place,
        "time_s": number * 510.0 + when,
        "true_range_m": far,
        "azimuth_deg": (bearing - facing + 180) % 360 - 180,
        "temperature_c": rng.uniform(*PLACES[place]),
        "awake_h": rng.uniform(0.2, 9.0),
        PRIVATE[0]: pace / far,
        PRIVATE[1]: ((speed**2).sum(axis=1) + (gap * turning).sum(axis=1)) / far - pace**2 / far**3,
    }
    return pd.DataFrame(kept | ends)


def _arc(rng: np.random.Generator, when: Floats, stands: bool) -> tuple[Floats, Floats, Floats]:
    """Return positions in m, speeds in m/s and accelerations in m/s^2 [n, 3] on a circle."""
    middle, radius = rng.uniform([8, 7], [26, 17]), rng.uniform(2.0, 6.0)
    rate = 0.0 if stands else rng.choice([-1, 1]) * rng.uniform(0.5, 1.6) / radius
    angle = rng.uniform(0, 2 * np.pi) + rate * when
    out = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    along = radius * rate * np.column_stack([-np.sin(angle), np.cos(angle)])
    flat = np.zeros((len(when), 1))
    high = flat + rng.uniform(1.05, 1.45)
    here, speed = np.hstack([middle + out, high]), np.hstack([along, flat])
    return here, speed, np.hstack([-(rate**2) * out, flat])


def _between(rng: np.random.Generator, links: pd.Series, share: float) -> pd.Series:
    """Return what stands in the direct path of each row: one or two walls, or an iron grille."""
    drawn = {}
    for link in links.unique():
        walls = [str(one) for one in rng.choice(list(STONES), 1 + int(rng.random() < 0.3))]
        grille = ["metal"] if rng.random() < 0.18 else []
        drawn[link] = walls if rng.random() < share else grille
    return pd.Series([drawn[one] for one in links], dtype=object)


def _heard(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of this abbey's own radio."""
    far = rows["true_range_m"].to_numpy(np.float64)
    codes, links = pd.factorize(rows["link"])
    level = -60.8 - 20 * np.log10(far) + rng.laplace(0, 0.8, len(links))[codes]
    level = level + rng.uniform(-0.6, 0.6, len(rows))
    error = SCATTER_M * scatter * np.hypot(1, far / 30) * rng.normal(size=len(rows))
    first = level - 1.3 - np.abs(rng.normal(0, 0.8, len(rows)))
    made = rows.assign(range_m=far + error, error_m=error, rx_power_dbm=level)
    hiss = 46.0 * np.sqrt(rng.gamma(40, 1 / 40, len(rows)))
    return made.assign(first_path_power_dbm=first, noise_std=hiss, preamble_count=SYMBOLS)


def _with(table: pd.DataFrame, drawn: Draw, seed: int, part: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m.

    What a radio writes down wrongly comes after all that it measures.
    """
    own = int(np.random.default_rng([seed, 64]).integers(2**31))
    rng, shifts = np.random.default_rng([seed, part]), np.zeros((len(drawn.hidden), len(table)))
    last = ("nanoseconds-for-metres", "range-rounding", "stale-reading")
    for name in sorted(drawn.hidden, key=lambda one: one in last and 1 + last.index(one)):
        change = EFFECTS[name](Book(table, own, rng, bool(drawn.rare)), drawn.strength)
        shifts[drawn.hidden.index(name)] = change.longer_m
        error = table["error_m"] + change.longer_m
        table = table.assign(error_m=error, range_m=table["true_range_m"] + error)
        for column in ("rx_power_dbm", "first_path_power_dbm"):
            table[column] = table[column] + change.louder_db
        for column, times in (("noise_std", change.noisier), ("preamble_count", change.symbols)):
            if column in table:
                table[column] = table[column] * times
    return table, shifts
