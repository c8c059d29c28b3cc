"""A night at the breadworks: who is ranged in which batch, when, and what is between.

numpy and pandas alone. In each batch one tag is answered by some corbels, in turns. In a turn these
are a golden part of it apart, as leaves are about a stem, and the whole turns from turn to turn by
another part, so none answers along with another nor at even times.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.breadworks_hall import (
    COOLERS_M,
    CORBELS,
    CORBELS_M,
    COURSE,
    HALL_M,
    KINDS,
    NIGHT_S,
    PLACES,
    TABLES_M,
    TAGS,
    brought_to,
    off_walls,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat(np.arange(2, 8), [4, 5, 6, 4, 6, 2])
"""By how many corbels a batch's tag is heard."""
OF_ROWS: Integers = np.repeat(np.arange(1, 13), [15, 16, 15, 14, 13, 11, 9, 8, 6, 5, 3, 2])
"""How many rows links have."""
STILL = 6  # batches whose tag rests
TURNS, TURN_S, FILLED = 15, 0.205, 0.93  # of a batch; how long one is; a part that is for answers
GOLDEN, ONWARD = 0.5 * (5**0.5 - 1), 2**0.5 - 1  # parts of a turn: to the next corbel; turn to turn
CLOSEST_M, CLEAR_M, UNTIL_S = 2.6, 0.9, 4.2  # to corbels; to walls; until when both are seen to
HEARS_M = 17.0  # by which odds to hear a tag are half as good
THROUGH = ("plastic", "plasterboard", "brick", "glass")
"""Crates of loaves, walls of the store among sacks, ovens' fronts, panes of provers."""
BEHIND_RACKS = {False: 0.16, True: 0.055}  # of links, and where these are rare
RARELY = ("blocked-path", "diffraction")


def baked(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a night."""
    heard_by = rng.permutation(HEARD_BY)
    lots = np.split(rng.permutation(of_rows), np.cumsum(heard_by)[:-1])
    tags = rng.permutation(np.arange(len(lots)) % len(TAGS))
    goes = rng.permutation(np.arange(len(lots)) >= STILL).astype(np.float64)
    starts_s = np.sort(rng.random(len(lots))) * 0.998 * NIGHT_S
    made = [_batch(rng, k, TAGS[tags[k]], lot, goes[k]) for k, lot in enumerate(lots)]
    made = [one.assign(time_s=one["time_s"] + at) for one, at in zip(made, starts_s, strict=True)]
    rows = pd.concat(made, ignore_index=True)
    rows["obstacles"] = _in_the_way(rng, rows, rare)
    hall = {f"room_{axis}_m": size for axis, size in zip("xyz", HALL_M, strict=True)}
    return rows.assign(los=rows["obstacles"].map(len).eq(0), channel=5, prf_mhz=64.0, **hall)


def _batch(
    rng: np.random.Generator, number: int, tag: str, lengths: Integers, goes: float
) -> pd.DataFrame:
    """Return the rows of one batch by time, with places of its tag."""
    kind = tag.rstrip("0123456789")
    course = _course(rng, kind) | {"goes": goes, "into_s": rng.uniform(0.1, 0.9)}
    corbels = _hearing(rng, _along(course, np.zeros(1))[0], len(lengths))
    which, since_s = called(rng, lengths)
    corbel = corbels[which]
    at, there = _along(course, since_s), CORBELS_M[corbel]
    made = {name: np.full(len(which), course[name]) for name in COURSE}
    made |= {"into_s": course["into_s"] + since_s, "time_s": since_s}
    made |= {f"tx_{axis}_m": at[:, k] for k, axis in enumerate("xyz")}
    made |= {f"rx_{axis}_m": there[:, k] for k, axis in enumerate("xyz")}
    bearing = np.degrees(np.arctan2(*(there - at)[:, 1::-1].T))
    return pd.DataFrame(made | _written(rng, since_s)).assign(
        tx=tag,
        rx=[f"corbel{k}" for k in corbel],
        link=[f"batch {number} at corbel{k}" for k in corbel],
        environment=PLACES[kind],
        azimuth_deg=(bearing + rng.uniform(0.0, 360.0)) % 360.0,
        true_range_m=np.linalg.norm(there - at, axis=1),
    )


def _along(course: dict[str, float], since_s: Floats) -> Floats:
    """Return where a tag is some time after a batch began, in m [n, 3]."""
    every = {name: np.full(len(since_s), course[name]) for name in COURSE}
    return brought_to(every, course["into_s"] + since_s)


def called(rng: np.random.Generator, lengths: Integers) -> tuple[Integers, Floats]:
    """Return which of a batch's corbels answers, and when after the first, in s, by time [sum].

    `lengths`: how many times each corbel does, of no more than TURNS, by lot.
    """
    turns = [np.sort(rng.choice(TURNS, length, replace=False)) for length in lengths]
    who = np.repeat(np.arange(len(lengths)), lengths)
    turn = np.concatenate(turns)
    at_s = TURN_S * (turn + FILLED * np.mod(GOLDEN * who + ONWARD * turn, 1.0))
    order = np.argsort(at_s)
    return who[order].astype(np.int64), at_s[order] - at_s[order[0]]


def _hearing(rng: np.random.Generator, at: Floats, count: int) -> Integers:
    """Return so many corbels that hear a tag in a place, near ones the more likely."""
    far = np.linalg.norm(CORBELS_M - at, axis=1)
    odds = 0.5 ** (far / HEARS_M)
    return rng.choice(CORBELS, count, replace=False, p=odds / odds.sum()).astype(np.int64)


def _course(rng: np.random.Generator, kind: str) -> dict[str, float]:
    """Return the course of a tag that keeps off corbels and walls."""
    ways = {"tray": _tray, "rack": _rack, "porter": _porter, "mould": _mould}
    when = np.linspace(0.0, UNTIL_S, 45)
    fixed = {"kind": float([*KINDS].index(kind)), "goes": 1.0, "into_s": 0.0}
    while True:
        made = dict.fromkeys(COURSE, 0.0) | ways[kind](rng) | fixed
        at = _along(made, when)
        close = np.linalg.norm(at[:, None] - CORBELS_M, axis=2).min()
        if close > CLOSEST_M and off_walls(at).min() > CLEAR_M:
            return made


def _anywhere(rng: np.random.Generator) -> dict[str, float]:
    """Return a place anywhere in the hall, and a direction."""
    x, y = (rng.uniform(0.0, most) for most in HALL_M[:2])
    return {"from_x": x, "from_y": y, "toward": rng.uniform(-np.pi, np.pi)}


def _about(rng: np.random.Generator, middles: tuple[tuple[float, float], ...]) -> dict[str, float]:
    """Return one of two middles, and an angle about it."""
    x, y = middles[int(rng.integers(len(middles)))]
    return {"from_x": x, "from_y": y, "toward": rng.uniform(-np.pi, np.pi)}


def _tray(rng: np.random.Generator) -> dict[str, float]:
    """Return a tray's course up a spiral cooler, either way round."""
    pace = rng.choice([-1.0, 1.0]) * rng.uniform(0.7, 1.3)
    goes = {"level": rng.uniform(0.5, 3.0), "reach": rng.uniform(2.2, 3.4), "speed": pace}
    return _about(rng, COOLERS_M) | goes


def _rack(rng: np.random.Generator) -> dict[str, float]:
    """Return the course of a rack that is shoved."""
    goes = {"speed": rng.uniform(1.5, 2.9), "fades": rng.uniform(2.4, 6.5)}
    return _anywhere(rng) | goes | {"level": rng.uniform(0.5, 1.9)}


def _porter(rng: np.random.Generator) -> dict[str, float]:
    """Return a porter's course; `reach` m from bend to bend and back, which begin anywhere."""
    sways = {"swing": rng.uniform(0.45, 0.95), "reach": rng.uniform(5.0, 9.0)}
    goes = {"speed": rng.uniform(1.1, 1.9), "fades": rng.uniform(0.0, 2 * np.pi)}
    return _anywhere(rng) | sways | goes | {"level": rng.uniform(1.1, 1.6)}


def _mould(rng: np.random.Generator) -> dict[str, float]:
    """Return a mould's course on a table; a step takes `fades` s, either way round."""
    goes = {"fades": rng.uniform(1.6, 2.6), "speed": rng.choice([-1.0, 1.0])}
    return _about(rng, TABLES_M) | goes | {"reach": rng.uniform(1.8, 2.8), "level": 1.05}


def _written(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is written down for each row [n]: of a cold store, or of ovens at full heat.

    `spiral_m` is how far the cooler's belt has come.
    """
    rows = len(since_s)
    stray = rng.normal(size=(10, rows))
    return {
        "temperature_c": 28.0 + 10.0 * np.sin(rng.uniform(-0.5, 0.5) * np.pi) + 0.45 * stray[0],
        "reply_time_s": 0.0032 + 0.0094 * rng.beta(1.3, 1.3, rows),
        "mixer_rpm": (330.0 * rng.beta(0.9, 1.0) + 5.0 * stray[1]).clip(0.0, 340.0),
        "steam_l": (rng.gamma(1.4, 3.4) + 0.15 * np.abs(stray[2])).clip(0.0, 20.0),
        "swollen_cm": (rng.uniform(1.0, 24.0) + 0.3 * stray[3]).clip(0.2, 25.0),
        "hook_gap_m": (0.75 + 2.6 * rng.beta(0.9, 1.3) + 0.03 * stray[4]).clip(0.7, 3.6),
        "swept_min": np.exp(rng.uniform(0.2, 5.2) + 0.08 * stray[5]),
        "tins": rng.binomial(36, rng.beta(1.2, 1.1), rows).astype(np.float64),
        "hopper_kg": (rng.uniform(60.0, 430.0) + 6.0 * stray[6]).clip(20.0, 450.0),
        "proved_h": (rng.uniform(0.1, 5.5) + 0.04 * np.abs(stray[7])).clip(0.1, 6.0),
        "oven_c": (rng.uniform(40.0, 260.0) + 1.5 * stray[8]).clip(30.0, 270.0),
        "spiral_m": rng.uniform(0.0, 140.0) + 0.9 * since_s + 0.2 * np.abs(stray[9]),
    }


def _in_the_way(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: a rack of steel by lot, or else some things.

    Crates where tags are low, the store's walls toward the east, ovens' fronts toward the north,
    provers' panes amid the hall; flues' corbels see over half of these.
    """
    links = rows.groupby("link", sort=False).first()
    x, y = links["rx_x_m"].to_numpy(), links["rx_y_m"].to_numpy()
    low, high = links["tx_z_m"].to_numpy() < 1.3, links["rx_z_m"].to_numpy() > 7.0
    odds = np.stack([0.18 + 0.2 * low, 0.06 + 0.3 * (x > 38.0), 0.05 + 0.22 * (y > 25.0),
                     0.08 + 0.16 * (np.abs(x - 26.0) < 8.0)])  # fmt: skip
    odds = odds * np.where(high, 0.5, 1.0) * (0.4 if rare in RARELY else 1.0)
    met = rng.random(odds.shape) < odds
    racks = rng.permutation(len(links)) < round(BEHIND_RACKS[bool(rare)] * len(links))
    some = {
        link: ["metal"] if racks[k] else [what for what, is_met in zip(THROUGH, met[:, k],
                                                                      strict=True) if is_met]
        for k, link in enumerate(links.index)
    }  # fmt: skip
    return [[*some[link]] for link in rows["link"]]
