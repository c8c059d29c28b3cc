"""An evening at the velodrome: who is ranged in which race, when, and what is between.

numpy and pandas alone. In each race one tag is heard by some posts, lap by lap of these, as in an
elimination: all are heard in the first, and the last of them drops out whenever it is its turn. Who
was heard first in one lap is heard last in the next, as riders of a team take their pull.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.velodrome_track import (
    COURSE,
    EVENING_S,
    HALL_M,
    KINDS,
    LAP_M,
    PLACES,
    POSTS,
    POSTS_M,
    TAGS,
    ridden,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat(np.arange(3, 9), [5, 6, 5, 4, 2, 1])
"""By how many posts a race's tag is heard."""
OF_ROWS: Integers = np.repeat(np.arange(1, 12), [15, 16, 16, 14, 12, 10, 8, 7, 5, 4, 3])
"""How many rows links have."""
STILL = 6  # races whose tag stands still on the boards, as sprinters do
LAP_S, TURN_S, PULL_S = 0.058, 0.0046, 0.0007  # a round of posts; each one's turn; by chance
NEAREST_M, LASTS_S = 3.0, 2.4  # that tags come to posts; until when they are looked at
LIKELY_M = 15.0  # by which posts are e times less likely to hear a tag
THROUGH = ("plywood", "plastic", "wood", "glass")
"""Hoardings, screens of the infield, boards on edge, panes of the judges' cabin."""
BEHIND_VANS = {False: 0.16, True: 0.055}  # of links, and where these are rare
RARELY = ("blocked-path", "diffraction")


def raced(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of an evening."""
    heard_by = rng.permutation(HEARD_BY)
    lots = np.split(rng.permutation(of_rows), np.cumsum(heard_by)[:-1])
    waits = rng.gamma(3.0, 1.0, len(lots) + 1)
    begins_s = EVENING_S * (np.cumsum(waits) / waits.sum())[:-1]
    who = rng.permutation(np.resize(np.arange(len(TAGS)), len(lots)))
    goes = np.ones(len(lots))
    goes[rng.choice(len(lots), STILL, replace=False)] = 0.0
    races = [_race(rng, k, TAGS[who[k]], lot, goes[k]) for k, lot in enumerate(lots)]
    rows = pd.concat(races, ignore_index=True)
    rows["time_s"] += np.repeat(begins_s, [len(one) for one in races])
    rows["obstacles"] = _between(rng, rows, rare)
    hall = {f"room_{axis}_m": size for axis, size in zip("xyz", HALL_M, strict=True)}
    return rows.assign(los=rows["obstacles"].str.len().eq(0), channel=1, prf_mhz=64.0, **hall)


def _race(
    rng: np.random.Generator, number: int, tag: str, laps: Integers, goes: float
) -> pd.DataFrame:
    """Return the rows of one race by time, with places of its tag."""
    kind = tag.rstrip("0123456789")
    one = _course(rng, kind) | {"goes": goes, "into_s": rng.uniform(0.25, 1.2)}
    begun = {name: np.full(1, one[name]) for name in COURSE}
    posts = _hearing(rng, ridden(begun, begun["into_s"])[0], len(laps))
    which, since_s = eliminated(rng, laps)
    course = {name: np.full(len(which), one[name]) for name in COURSE}
    course["into_s"] = course["into_s"] + since_s
    there, post = ridden(course, course["into_s"]), posts[which]
    way = POSTS_M[post] - there
    ends = {f"tx_{a}_m": there[:, k] for k, a in enumerate("xyz")}
    ends |= {f"rx_{a}_m": POSTS_M[post, k] for k, a in enumerate("xyz")}
    back = np.degrees(np.arctan2(way[:, 1], way[:, 0]) - rng.uniform(0.0, 2 * np.pi)) % 360.0
    return pd.DataFrame(course | ends | {"time_s": since_s} | _noted(rng, since_s)).assign(
        tx=tag,
        rx=[f"post{k}" for k in post],
        link=[f"race {number} before post{k}" for k in post],
        environment=PLACES[kind],
        azimuth_deg=back,
        true_range_m=np.linalg.norm(way, axis=1),
    )


def eliminated(rng: np.random.Generator, laps: Integers) -> tuple[Integers, Floats]:
    """Return which of a race's posts is heard, and when after the first, in s, by time [sum].

    `laps`: in how many laps each post is heard, the first ones.
    """
    which, at_s = [], []
    for lap in range(int(laps.max())):
        left = np.roll(np.flatnonzero(laps > lap), -lap)
        which.append(left)
        at_s.append(LAP_S * lap + TURN_S * np.arange(len(left)) + PULL_S * rng.random(len(left)))
    when = np.concatenate(at_s)
    return np.concatenate(which), when - when[0]


def _hearing(rng: np.random.Generator, at: Floats, count: int) -> Integers:
    """Return so many posts that hear a tag in a place, near ones the more likely."""
    far = np.linalg.norm(POSTS_M - at, axis=1)
    odds = np.exp(-far / LIKELY_M)
    return rng.choice(POSTS, count, replace=False, p=odds / odds.sum()).astype(np.int64)


def _course(rng: np.random.Generator, kind: str) -> dict[str, float]:
    """Return the course of a tag that keeps off posts."""
    ways: dict[str, Callable[[np.random.Generator], dict[str, float]]] = {
        "sprinter": _sprinter, "derny": _derny, "slinger": _slinger, "holder": _holder,
    }  # fmt: skip
    number, when = float([*KINDS].index(kind)), np.linspace(0.0, LASTS_S, 40)
    while True:
        made = ways[kind](rng) | {"kind": number, "goes": 1.0, "into_s": 0.0}
        made |= {"along": rng.uniform(0.0, LAP_M), "rides": rng.uniform(-np.pi, np.pi)}
        at = ridden({name: np.full(40, made[name]) for name in COURSE}, when)
        if np.linalg.norm(at[:, None] - POSTS_M, axis=2).min() > NEAREST_M:
            return made


def _sprinter(rng: np.random.Generator) -> dict[str, float]:
    """Return a sprinter's course: from high on the boards, ever faster."""
    goes = {"lane": rng.uniform(1.5, 4.8), "pace": rng.uniform(11.0, 15.5)}
    legs = {"pedal": rng.uniform(0.02, 0.05), "beat": rng.uniform(10.0, 14.0)}
    return goes | legs | {"gathers": rng.uniform(0.6, 2.4), "tall": rng.uniform(0.9, 1.2)}


def _derny(rng: np.random.Generator) -> dict[str, float]:
    """Return a derny's course, about the blue line."""
    goes = {"lane": rng.uniform(2.3, 3.3), "pace": rng.uniform(12.0, 16.0), "pedal": 0.0}
    return goes | {
        "gathers": rng.uniform(0.3, 0.9), "beat": rng.uniform(0.8, 1.5),
        "tall": rng.uniform(1.3, 1.6),
    }  # fmt: skip


def _slinger(rng: np.random.Generator) -> dict[str, float]:
    """Return a slinger's course, who comes in slowly and is thrown on."""
    goes = {"lane": rng.uniform(0.3, 3.6), "pace": rng.uniform(7.5, 10.5)}
    legs = {"pedal": rng.uniform(0.03, 0.06), "beat": rng.uniform(7.0, 10.0)}
    return goes | legs | {"gathers": rng.uniform(3.0, 5.5), "tall": rng.uniform(1.0, 1.3)}


def _holder(rng: np.random.Generator) -> dict[str, float]:
    """Return the course of a holder who runs along with a starter, low on the boards."""
    goes = {"lane": rng.uniform(0.2, 1.4), "pace": rng.uniform(3.0, 5.5), "pedal": 0.0, "beat": 1.0}
    return goes | {"gathers": rng.uniform(0.35, 0.8), "tall": rng.uniform(1.2, 1.5)}


def _noted(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is noted for each row [n]: of full houses and of training alone."""
    count = len(since_s)
    each = rng.normal(size=(10, count))
    return {
        "temperature_c": 21.0 + 11.0 * rng.uniform(-1.0, 1.0) + 0.7 * each[0],
        "reply_time_s": 0.0025 + 0.0055 * rng.beta(1.5, 1.5, count),
        "derny_rpm": (2600.0 * rng.beta(1.1, 1.0) + 40.0 * each[1]).clip(0.0),
        "wax_um": rng.gamma(1.6, 24.0) + 4.0 * np.abs(each[2]),
        "damp_pct": (rng.uniform(25.0, 85.0) + 1.5 * each[3]).clip(20.0, 90.0),
        "board_m": (rng.uniform(0.9, 4.2) + 0.1 * each[4]).clip(0.8, 4.5),
        "oil_ul": np.exp(rng.uniform(1.0, 4.6) + 0.2 * each[5]),
        "flags": rng.poisson(22.0 * rng.beta(1.1, 1.3), count).astype(np.float64),
        "gate_pct": (rng.uniform(-8.0, 100.0) + 2.5 * each[6]).clip(0.0, 100.0),
        "fog_pct": (rng.uniform(5.0, 96.0) + 2.0 * each[7]).clip(2.0, 100.0),
        "fans_hz": (rng.uniform(0.0, 24.0) + 0.5 * each[8]).clip(0.0, 26.0),
        "under_m": rng.uniform(0.0, 140.0) + 12.0 * since_s + 0.4 * np.abs(each[9]),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: vans of steel by lot, else some things.

    Hoardings where posts are behind the balustrade, screens on long ways, boards on edge where tags
    are low, panes where posts are high.
    """
    links = rows.groupby("link", sort=False)[["tx_z_m", "rx_z_m", "true_range_m"]].first()
    high, low, long = links["rx_z_m"] > 6.0, links["tx_z_m"] < 1.9, links["true_range_m"] > 17.0
    odds = np.stack([0.3 - 0.2 * high, 0.05 + 0.22 * long, 0.04 + 0.2 * low, 0.05 + 0.2 * high])
    odds = odds * (0.4 if rare in RARELY else 1.0)
    met = rng.random(odds.shape) < odds
    vans = rng.permutation(len(links)) < round(BEHIND_VANS[bool(rare)] * len(links))
    some = {
        link: ["metal"] if vans[k] else [w for w, there in zip(THROUGH, met[:, k], strict=True)
                                         if there]
        for k, link in enumerate(links.index)
    }  # fmt: skip
    return [[*some[link]] for link in rows["link"]]
