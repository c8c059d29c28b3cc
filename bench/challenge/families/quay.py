"""Straddle carriers on a quay, ranged from masts along it: ranges and levels on the move, no CIR.

numpy and pandas alone; what it can hide is in `quay_effects`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Draw, Tables
from bench.challenge.families.quay_effects import EFFECTS, LAWS, MASTS_M, PRIVATE, STACKS, Log

Floats = NDArray[np.float64]
DRIVES, ROWS, STEP_S, REACH_M = 20, 4, 0.7, 34.0
SCATTER_M = 0.02
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
    "wet-radome": "humidity_pct",
    "hull-at-high-tide": "tide_m",
    "busy-channel": "load_hz",
    "trolley-overhead": "trolley_m",
}
RARELY = ("blocked-path", "material-delay", "temperature-drift")


def tables(drawn: Draw, seed: int) -> Tables:
    """Return the tables of a case whose simulator is the quay's own."""
    rng = np.random.default_rng([seed, 41])
    rows = _driven(rng, "all" if drawn.same_mix else "near", drawn.rare)
    clean = _heard(rows, rng, drawn.scatter)
    if not drawn.paired:
        rows = _driven(rng, "all" if drawn.same_mix else "far", drawn.rare)
        rows = rows.assign(link="model " + rows["link"])
    parts = [_heard(rows, rng, drawn.scatter) for _ in range(drawn.ratio)]
    return hidden_in(drawn, seed, clean, pd.concat(parts, ignore_index=True))


def known(drawn: Draw, seed: int) -> pd.DataFrame:
    """Return rows for another simulator to measure."""
    return _driven(np.random.default_rng([seed, 41]), "all", drawn.rare)


def hidden_in(drawn: Draw, seed: int, clean: pd.DataFrame, simulated: pd.DataFrame) -> Tables:
    """Return a case's tables from two tables that nothing is hidden in."""
    recorded, shifts = _with(clean, drawn, seed, 42)
    truth = _with(simulated, drawn, seed, 43)[0]
    gone = [PRIVATE] if drawn.listed else [PRIVATE, "obstacles"]
    recorded, clean, simulated, truth = (
        one.drop(columns=gone) for one in (recorded, clean, simulated, truth)
    )
    return Tables(recorded, clean, simulated, truth, shifts)


def _driven(rng: np.random.Generator, where: str, rare: str) -> pd.DataFrame:
    """Return what is known of the rows: straight drives along the quay, some carriers parked."""
    weather = _weather(rng, where, rare)
    parts = [_drive(rng, number) | _long(day) for number, day in enumerate(weather)]
    frame = pd.DataFrame({name: np.concatenate([one[name] for one in parts]) for name in parts[0]})
    near = {"all": REACH_M, "near": 20.0, "far": REACH_M}[where]
    middle = frame.groupby("link")["true_range_m"].transform("mean")
    frame = frame[(middle < near) & (middle > (11.0 if where == "far" else 0.0))]
    frame = frame.reset_index(drop=True)
    return frame.assign(
        reply_time_s=rng.choice([0.002, 0.012, 0.03, 0.06], len(frame)),
        trolley_m=rng.uniform(0, 30, len(frame)),
        load_hz=np.round(rng.lognormal(np.log(25), 0.8, len(frame)), 1),
        obstacles=_stacks(rng, frame["link"], 0.07 if rare == "material-delay" else 0.3),
    )


def _weather(rng: np.random.Generator, where: str, rare: str) -> list[dict[str, float]]:
    """Return what holds during each drive: every one is on a day of its own."""
    cold, warm = {"all": (2, 30), "near": (2, 20), "far": (10, 30)}[where]
    out = []
    for number in range(DRIVES):
        warmth = rng.uniform(cold, warm)
        if rare == "temperature-drift":
            warmth = 44.0 if number % 10 == 4 else 15 + 0.1 * warmth
        out.append(
            {
                "temperature_c": warmth,
                "tide_m": rng.uniform(0.0, 2.4),
                "humidity_pct": 100 * rng.beta(4, 2),
            }
        )
    return out


def _long(day: dict[str, float]) -> dict[str, Any]:
    """Return what holds during a drive for each of its rows."""
    return {name: np.full(ROWS * len(MASTS_M), value) for name, value in day.items()}


def _drive(rng: np.random.Generator, number: int) -> dict[str, Any]:
    """Return one drive past all masts, polled in turn: even acceleration along a straight line."""
    start, turned = rng.uniform([3, 2], [42, 11]), rng.uniform(-180, 180)
    pace, gain, drift = rng.normal(0, 1.5), rng.uniform(-0.4, 0.4), rng.uniform(-0.4, 0.4)
    moves, carrier = number % 6 != 2, int(rng.integers(0, 4))
    mast, row = (a.ravel() for a in np.meshgrid(np.arange(len(MASTS_M)), np.arange(ROWS)))
    when = row * STEP_S + 0.06 * mast
    speed = moves * np.stack([pace + gain * when, drift + 0 * when], axis=1)
    moved = moves * np.stack([pace * when + gain * when**2 / 2, drift * when], axis=1)
    here = np.column_stack([start + moved, np.full(len(when), 1.6 + 0.1 * carrier)])
    gap = here - np.array(MASTS_M, np.float64)[mast]
    heading = np.degrees(np.arctan2(speed[:, 1], speed[:, 0])) if moves else turned
    bearing = np.degrees(np.arctan2(-gap[:, 1], -gap[:, 0]))
    far = np.linalg.norm(gap, axis=1)
    ends = {f"tx_{a}_m": v for a, v in zip("xyz", here.T, strict=True)}
    ends |= {f"rx_{a}_m": v for a, v in zip("xyz", (here - gap).T, strict=True)}
    return ends | {
        "link": np.array([f"q{number}-{one}" for one in mast]),
        "tx": np.full(len(mast), f"lift{carrier}"),
        "rx": np.array([f"mast{one}" for one in mast]),
        "time_s": number * 420.0 + when,
        "true_range_m": far,
        "azimuth_deg": (bearing - heading + 180) % 360 - 180,
        PRIVATE: (gap[:, :2] * speed).sum(axis=1) / far,
    }


def _stacks(rng: np.random.Generator, links: pd.Series, share: float) -> pd.Series:
    """Return what stands in the direct path of each row: at most two stacks of goods."""
    drawn = {
        link: [str(rng.choice(list(STACKS))) for _ in range(1 + (rng.random() < 0.25))]
        for link in links.unique()
    }
    struck = {link: rng.random() < share for link in drawn}
    return pd.Series([drawn[one] if struck[one] else [] for one in links], dtype=object)


def _heard(rows: pd.DataFrame, rng: np.random.Generator, scatter: float) -> pd.DataFrame:
    """Return the table with the ranges and levels of this quay's own radio."""
    far = rows["true_range_m"].to_numpy(np.float64)
    codes, links = pd.factorize(rows["link"])
    level = -59.5 - 20 * np.log10(far) + rng.uniform(-1.5, 1.5, len(links))[codes]
    level = level + rng.normal(0, 0.35, len(rows))
    spread = SCATTER_M * scatter * np.sqrt(1 + 10 ** ((-93 - level) / 10))  # louder is steadier
    error = spread * rng.normal(size=len(rows))
    first = level - 1.0 - rng.exponential(0.7, len(rows))
    made = rows.assign(range_m=far + error, error_m=error, rx_power_dbm=level)
    return made.assign(first_path_power_dbm=first)


def _with(table: pd.DataFrame, drawn: Draw, seed: int, part: int) -> tuple[pd.DataFrame, Floats]:
    """Return the table with the hidden effects in it, and what each adds to the ranges in m.

    A radio rounds last, whatever else is hidden.
    """
    own = int(np.random.default_rng([seed, 44]).integers(2**31))
    rng, shifts = np.random.default_rng([seed, part]), np.zeros((len(drawn.hidden), len(table)))
    for name in sorted(drawn.hidden, key=lambda one: one == "range-rounding"):
        place = drawn.hidden.index(name)
        shifts[place], gain = EFFECTS[name](Log(table, own, rng, bool(drawn.rare)), drawn.strength)
        error = table["error_m"] + shifts[place]
        table = table.assign(error_m=error, range_m=table["true_range_m"] + error)
        for level in ("rx_power_dbm", "first_path_power_dbm"):
            if level in table:
                table = table.assign(**{level: table[level] + gain})
    return table, shifts
