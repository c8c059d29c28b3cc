"""A shift at the colliery: who is ranged in which wind, when, and what is between.

numpy and pandas alone. In each wind one tag is heard by some props, round by round: in each round
whoever listens answers in a slot that it has by lot, and some listen in every other round alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.colliery_pit import (
    COURSE,
    HALL_M,
    KINDS,
    PLACES,
    PROPS,
    PROPS_M,
    SHIFT_S,
    TAGS,
    carried,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat(np.arange(2, 8), [3, 5, 6, 5, 6, 1])
"""By how many props a wind's tag is heard."""
OF_ROWS: Integers = np.repeat(np.arange(1, 15), [14, 15, 15, 14, 12, 10, 9, 7, 5, 4, 3, 2, 2, 1])
"""How many rows links have."""
STILL = 6  # winds whose tag rests
ROUND_S, SLOTS, SLOT_S = 0.104, 8, 0.0128  # a round of slots; how many there are; how long
OFTEN = 7  # rows above which a link's prop listens in every round
NEAREST_M, LASTS_S = 3.0, 2.6  # that tags come to props; until when they are looked at
LIKELY_M = 13.0  # by which props are e times less likely to hear a tag
THROUGH = ("marble", "wood", "brick", "plastic")
"""Packs of waste stone, chocks of timber, stoppings, curtains of brattice."""
BEHIND_TUBS = {False: 0.16, True: 0.055}  # of links, and where these are rare
RARELY = ("blocked-path", "diffraction")


def worked(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a shift."""
    heard_by = rng.permutation(HEARD_BY)
    lots = np.split(rng.permutation(of_rows), np.cumsum(heard_by)[:-1])
    begins_s = np.sort(rng.uniform(60.0, SHIFT_S - 60.0, len(lots)))
    who = rng.permutation(np.resize(np.arange(len(TAGS)), len(lots)))
    goes = np.ones(len(lots))
    goes[rng.choice(len(lots), STILL, replace=False)] = 0.0
    winds = [_wind(rng, k, TAGS[who[k]], lot, goes[k]) for k, lot in enumerate(lots)]
    rows = pd.concat(winds, ignore_index=True)
    rows["time_s"] += np.repeat(begins_s, [len(one) for one in winds])
    rows["obstacles"] = _between(rng, rows, rare)
    hall = {f"room_{axis}_m": size for axis, size in zip("xyz", HALL_M, strict=True)}
    return rows.assign(los=rows["obstacles"].str.len().eq(0), channel=3, prf_mhz=64.0, **hall)


def _wind(
    rng: np.random.Generator, number: int, tag: str, lengths: Integers, goes: float
) -> pd.DataFrame:
    """Return the rows of one wind by time, with places of its tag."""
    kind = tag.rstrip("0123456789")
    one = _course(rng, kind, tag) | {"goes": goes, "into_s": rng.uniform(0.2, 1.0)}
    begun = {name: np.full(1, one[name]) for name in COURSE}
    props = _hearing(rng, carried(begun, begun["into_s"])[0], len(lengths))
    which, since_s = answered(rng, lengths)
    course = {name: np.full(len(which), one[name]) for name in COURSE}
    course["into_s"] = course["into_s"] + since_s
    there, prop = carried(course, course["into_s"]), props[which]
    way = PROPS_M[prop] - there
    ends = {f"tx_{a}_m": there[:, k] for k, a in enumerate("xyz")}
    ends |= {f"rx_{a}_m": PROPS_M[prop, k] for k, a in enumerate("xyz")}
    faces = np.degrees(np.arctan2(way[:, 1], way[:, 0]) - rng.uniform(-np.pi, np.pi)) % 360.0
    return pd.DataFrame(course | ends | {"time_s": since_s} | _noted(rng, since_s)).assign(
        tx=tag,
        rx=[f"prop{k}" for k in prop],
        link=[f"wind {number} at prop{k}" for k in prop],
        environment=PLACES[kind],
        azimuth_deg=faces,
        true_range_m=np.linalg.norm(way, axis=1),
    )


def answered(rng: np.random.Generator, lengths: Integers) -> tuple[Integers, Floats]:
    """Return which of a wind's props answers, and when after the first, in s, by time [sum].

    `lengths`: how many answers each prop gives.
    """
    every = np.where(lengths > OFTEN, 1, rng.integers(1, 3, len(lengths)))
    first = rng.integers(0, every)
    rounds = [first[k] + every[k] * np.arange(lengths[k]) for k in range(len(lengths))]
    which = np.repeat(np.arange(len(lengths)), lengths)
    round_ = np.concatenate(rounds)
    slots = np.stack([rng.permutation(SLOTS) for _ in range(int(round_.max()) + 1)])
    at_s = ROUND_S * round_ + SLOT_S * slots[round_, which]
    order = np.argsort(at_s)
    return which[order], at_s[order] - at_s.min()


def _hearing(rng: np.random.Generator, at: Floats, count: int) -> Integers:
    """Return so many props that hear a tag in a place, near ones the more likely."""
    far = np.linalg.norm(PROPS_M - at, axis=1)
    odds = 1 / (1 + (far / LIKELY_M) ** 2)
    return rng.choice(PROPS, count, replace=False, p=odds / odds.sum()).astype(np.int64)


def _course(rng: np.random.Generator, kind: str, tag: str) -> dict[str, float]:
    """Return the course of a tag that keeps off props."""
    ways: dict[str, Callable[[np.random.Generator], dict[str, float]]] = {
        "skip": _skip, "tub": _tub, "boom": _boom, "lamp": _lamp,
    }  # fmt: skip
    number, when = float([*KINDS].index(kind)), np.linspace(0.0, LASTS_S, 40)
    while True:
        made = {"lane": 1.0 if tag[-1] == "0" else -1.0} | ways[kind](rng)
        made |= {"kind": number, "goes": 1.0, "into_s": 0.0, "phase": rng.uniform(-np.pi, np.pi)}
        at = carried({name: np.full(40, made[name]) for name in COURSE}, when)
        if np.linalg.norm(at[:, None] - PROPS_M, axis=2).min() > NEAREST_M:
            return made


def _skip(rng: np.random.Generator) -> dict[str, float]:
    """Return a skip's course: anywhere on its way, on a rope that swings it to and fro."""
    goes = {"begins": rng.uniform(1.2, 5.6), "pace": 0.0, "tall": rng.uniform(1.4, 1.9)}
    return goes | {"sways": rng.uniform(0.006, 0.02), "beat": rng.uniform(4.0, 6.5)}


def _tub(rng: np.random.Generator) -> dict[str, float]:
    """Return a tub's course, either way along rails."""
    pace = rng.choice([-1.0, 1.0]) * rng.uniform(2.6, 4.6)
    goes = {"begins": rng.uniform(14.0, 56.0), "pace": pace, "tall": rng.uniform(1.1, 1.5)}
    return goes | {"sways": rng.uniform(0.05, 0.16), "beat": rng.uniform(1.6, 2.6)}


def _boom(rng: np.random.Generator) -> dict[str, float]:
    """Return a boom's course, whose `tall` is how far its head is off its axis."""
    pace = rng.choice([-1.0, 1.0]) * rng.uniform(0.8, 1.3)
    goes = {"begins": rng.uniform(4.2, 6.2), "pace": pace, "tall": rng.uniform(1.3, 2.3)}
    return goes | {"sways": rng.uniform(0.4, 1.2), "beat": 1.0}


def _lamp(rng: np.random.Generator) -> dict[str, float]:
    """Return a miner's course along the manway, whose `lane` is where this is across."""
    pace = rng.choice([-1.0, 1.0]) * rng.uniform(1.0, 1.8)
    goes = {"begins": rng.uniform(9.0, 53.0), "lane": rng.uniform(33.5, 37.0), "pace": pace}
    gait = {"sways": rng.uniform(0.015, 0.035), "beat": rng.uniform(5.0, 6.2)}
    return goes | gait | {"tall": rng.uniform(1.55, 1.85)}


def _noted(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is noted for each row [n]: of fresh air and of stale, of rest and of drilling."""
    count = len(since_s)
    each = rng.normal(size=(11, count))
    return {
        "temperature_c": 22.0 + 12.0 * rng.uniform(-1.0, 1.0) + 0.6 * each[0],
        "reply_time_s": 0.004 + 0.008 * rng.beta(1.4, 1.4, count),
        "drill_bpm": (2900.0 * rng.beta(1.2, 0.9) + 45.0 * each[1]).clip(0.0),
        "dust_g": (rng.weibull(1.1) * 42.0 + 3.0 * np.abs(each[2])).clip(0.0, 260.0),
        "drip_ml": (rng.uniform(4.0, 70.0) + 1.2 * each[3]).clip(1.0, 75.0),
        "belt_gap_m": (rng.uniform(0.5, 3.6) + 0.06 * each[4]).clip(0.4, 3.8),
        "hung_d": np.exp(rng.uniform(0.2, 4.8) + 0.15 * each[5]),
        "chocks": rng.poisson(16.0 * rng.beta(1.2, 1.4), count).astype(np.float64),
        "ch4_pct": (rng.uniform(-0.1, 2.3) + 0.05 * each[6]).clip(0.0, 2.5),
        "haze_pct": (rng.uniform(4.0, 92.0) + 2.0 * each[7]).clip(1.0, 100.0),
        "draught_ms": (rng.uniform(0.0, 5.4) + 0.12 * each[8]).clip(0.0, 6.0),
        "belt_m": rng.uniform(0.0, 160.0) + 2.7 * since_s + 0.35 * np.abs(each[9]),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: tubs of steel by lot, else some things.

    Packs of stone on long ways, chocks where both ends are low, stoppings off the manway's side,
    curtains anywhere but high up.
    """
    links = rows.groupby("link", sort=False)[["tx_y_m", "tx_z_m", "rx_z_m", "true_range_m"]].first()
    low = (links["tx_z_m"] < 2.2) & (links["rx_z_m"] < 3.0)
    long, high = links["true_range_m"] > 19.0, links["rx_z_m"] > 9.0
    odds = np.stack([0.06 + 0.22 * long, 0.08 + 0.2 * low, 0.05 + 0.16 * (links["tx_y_m"] > 30),
                     0.24 - 0.18 * high])  # fmt: skip
    odds = odds * (0.4 if rare in RARELY else 1.0)
    met = rng.random(odds.shape) < odds
    tubs = rng.permutation(len(links)) < round(BEHIND_TUBS[bool(rare)] * len(links))
    some = {
        link: ["metal"] if tubs[k] else [w for w, there in zip(THROUGH, met[:, k], strict=True)
                                         if there]
        for k, link in enumerate(links.index)
    }  # fmt: skip
    return [[*some[link]] for link in rows["link"]]
