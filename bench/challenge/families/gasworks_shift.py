"""A shift at the gasworks: which brackets call whose tag, how often, and what is between.

numpy and pandas alone. In each charge of retorts one tag is called by some brackets. Each bracket
calls by a period of its own, as clockwork has it, and is not heard each time.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.gasworks_yard import (
    BRACKETS,
    BRACKETS_M,
    COURSE,
    DAY_S,
    DOORS_M,
    FLIGHT_M,
    PLACES,
    RETORTS_M,
    SHED_M,
    TAGS,
    TANKS_M,
    TRADES,
    YARD_M,
    gone_on,
    room_m,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
CALLED: Integers = np.repeat([3, 4, 5, 6, 7], [4, 5, 9, 5, 4])
"""How many brackets call a charge's tag."""
OF_ROWS: Integers = np.repeat(np.arange(1, 10), [16, 19, 20, 20, 18, 15, 12, 9, 6])
"""How many rows links have."""
RESTS = 5  # charges whose tag rests, each of another tag that has one in which it works
CALLS, PERIODS_S = 12, (0.47, 0.66)  # of a bracket in a charge; between these, of brackets
NEAREST_M, FREE_M, SEEN_S = 1.5, 0.3, 10.4  # to brackets; to sides; until when both are seen to
CARRIES_M = 8.0  # over which a bracket is called by less, by a half
SCREENED = {False: 0.15, True: 0.05}  # of links behind iron; where these are rare
FEWER = {False: 1.0, True: 0.4}  # of all else then
RARELY = ("blocked-path", "diffraction")
Drawn = dict[str, float]


def worked(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a shift."""
    tags, called = rng.permutation(len(TAGS)), rng.permutation(CALLED)
    ends = np.cumsum(called)
    counts = np.split(rng.permutation(of_rows), ends[:-1])
    begins_s = np.sort(rng.uniform(0.0, DAY_S - 60.0, len(called)))
    again = rng.permutation(len(called) - len(TAGS))[:RESTS]
    idle = {*(again + len(TAGS) * rng.integers(0, 2, RESTS)).tolist()}
    made = [
        _charge(rng, k, TAGS[tags[k % len(TAGS)]], counts[k], float(begins_s[k]), k not in idle)
        for k in range(len(called))
    ]  # fmt: skip
    rows = pd.concat(made, ignore_index=True)
    rows["obstacles"] = _between(rng, rows, rare)
    return rows.assign(
        los=rows["obstacles"].map(len).eq(0), channel=1, prf_mhz=64.0,
        room_x_m=YARD_M[0], room_y_m=YARD_M[1], room_z_m=YARD_M[2],
    )  # fmt: skip


def calls(rng: np.random.Generator, counts: Integers) -> tuple[Integers, Floats]:
    """Return which brackets call, and when after the first in s, [sum of counts] each.

    Of all its calls as many of each are heard as it has rows, by lot.
    """
    who, at_s = [], []
    for k, count in enumerate(counts.tolist()):
        period_s, begin_s = rng.uniform(*PERIODS_S), rng.uniform(0.0, 0.4)
        who += [k] * count
        at_s += (begin_s + period_s * rng.choice(CALLS, count, replace=False)).tolist()
    order = np.argsort(at_s)
    when = np.array(at_s)[order]
    return np.array(who, np.int64)[order], when - when[0]


def _charge(
    rng: np.random.Generator, number: int, tag: str, counts: Integers, begin_s: float, works: bool
) -> pd.DataFrame:
    """Return the rows of one charge by time, with places of its tag."""
    trade = tag.rstrip("0123456789")
    course = course_of(rng, trade) | {"works": float(works)}
    into_s = rng.uniform(0.1, 1.9)
    apart = np.linalg.norm(BRACKETS_M - _at(course, np.array([into_s])), axis=1)
    odds = 1 / (1 + (apart / CARRIES_M) ** 2)
    chosen = rng.choice(BRACKETS, len(counts), replace=False, p=odds / odds.sum())
    which, since_s = calls(rng, counts)
    bracket = chosen[which]
    there, here = BRACKETS_M[bracket], _at(course, into_s + since_s)
    rows = pd.DataFrame({name: np.full(len(which), course[name]) for name in COURSE})
    rows["into_s"] = into_s + since_s
    for end, at in (("tx", there), ("rx", here)):
        rows[[f"{end}_x_m", f"{end}_y_m", f"{end}_z_m"]] = at
    way = there - here
    faces = np.degrees(np.arctan2(way[:, 1], way[:, 0])) - rng.uniform(-180.0, 180.0)
    rows = rows.assign(**_noted(rng, since_s))
    return rows.assign(
        time_s=begin_s + since_s, tx=[f"bracket{k}" for k in bracket], rx=tag,
        environment=PLACES[trade], link=[f"charge {number} by bracket{k}" for k in bracket],
        azimuth_deg=(faces + 180.0) % 360.0 - 180.0, true_range_m=np.linalg.norm(way, axis=1),
    )  # fmt: skip


def _at(course: Drawn, into_s: Floats) -> Floats:
    """Return where a tag is some time into its course, in m [n, 3]."""
    return gone_on({name: np.full(len(into_s), one) for name, one in course.items()}, into_s)


def course_of(rng: np.random.Generator, trade: str) -> Drawn:
    """Return the course of a tag that keeps off brackets, sides and tanks."""
    seen_s = np.linspace(0.0, SEEN_S, 105)
    for _ in range(20_000):
        made = dict.fromkeys(COURSE, 0.0) | {"trade": float([*TRADES].index(trade)), "works": 1.0}
        made |= {"turn": rng.uniform(-np.pi, np.pi), "bears": rng.uniform(-np.pi, np.pi)}
        made = SETS_OUT[trade](rng, made)
        at = _at(made, seen_s)
        near = np.linalg.norm(at[:, None] - BRACKETS_M, axis=2).min()
        if room_m(at).min() > FREE_M and near > NEAREST_M:
            return made
    raise AssertionError(trade)


def _within(rng: np.random.Generator, made: Drawn, low: Drawn, high: Drawn) -> Drawn:
    """Return a course with values drawn evenly, put into it."""
    made |= {name: float(rng.uniform(low[name], high[name])) for name in low}
    return made


def _evenly(**of: tuple[float, float]) -> Callable[[np.random.Generator, Drawn], Drawn]:
    low = {name: one[0] for name, one in of.items()}
    high = {name: one[1] for name, one in of.items()}
    return lambda rng, made: _within(rng, made, low, high)


SETS_OUT: dict[str, Callable[[np.random.Generator, Drawn], Drawn]] = {
    "stoker": _evenly(mid_x=(1.5, 14.5), mid_y=(1.5, 23.0), mid_z=(1.0, 1.5), pace=(0.45, 0.7),
                      span=(1.5, 2.6)),
    "barrow": _evenly(mid_x=(17.0, 40.0), mid_y=(9.0, 23.5), mid_z=(0.6, 1.0), pace=(0.7, 1.2),
                      curl=(-0.12, 0.12)),
    "bell": _evenly(mid_x=(37.9, 38.1), mid_y=(20.7, 20.9), mid_z=(1.0, 4.5),
                    pace=(0.12, 0.2), span=(2.2, 2.9), curl=(0.6, 0.9)),
    "skip": _evenly(mid_x=(2.0, 40.0), mid_y=(9.0, 23.0), mid_z=(0.6, 3.0), pace=(0.5, 0.8),
                    span=(0.15, 0.45)),
    "lamplighter": _evenly(mid_x=(4.0, 38.0), mid_y=(4.0, 21.0), mid_z=(1.1, 1.8),
                           pace=(0.28, 0.42), span=(2.2, 3.4)),
    "ram": _evenly(mid_x=(2.0, 15.0), mid_y=(1.5, 23.0), mid_z=(0.9, 2.4), pace=(0.6, 0.95),
                   span=(1.0, 1.4), curl=(2.2, 3.2)),
}  # fmt: skip


def _noted(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is written down beside each row of a charge, [n] each."""
    count = len(since_s)

    def near(one: float, by: float, low: float, high: float) -> Floats:
        return np.asarray((one + by * rng.logistic(0.0, 0.5, count)).clip(low, high))

    return {
        "temperature_c": near(rng.uniform(3.0, 34.0), 0.2, 1.0, 36.0),
        "reply_time_s": 0.0030 + 0.0015 * rng.integers(0, 6, count) + 0.0003 * rng.random(count),
        "sparks_hz": near(90.0 * rng.beta(1.0, 1.3), 0.6, 0.0, 93.0),
        "tar_g": near(36.0 * rng.beta(1.0, 1.6), 0.2, 0.1, 38.0),
        "frost_d": near(24.0 * rng.beta(0.9, 1.4), 0.1, 0.05, 25.0),
        "scurf_mm": near(rng.uniform(0.5, 12.0), 0.07, 0.3, 12.6),
        "lime_h": near(rng.uniform(0.3, 40.0), 0.1, 0.2, 41.0),
        "jib_m": near(0.6 + rng.gamma(1.3, 0.7), 0.02, 0.55, 5.5),
        "lift_m": near(6.0 * rng.beta(1.0, 1.1), 0.03, 0.0, 6.3),
        "exhaust_rpm": near(rng.uniform(40.0, 120.0), 0.4, 38.0, 122.0),
        "flights_m": rng.uniform(0.0, 60.0) + 0.9 * since_s + FLIGHT_M * rng.random(count),
        "main_mbar": near(rng.uniform(12.0, 30.0), 0.2, 11.0, 31.0),
        "smoke_mg": near(9.0 * rng.beta(1.1, 1.2), 0.05, 0.0, 9.4),
        "steam_kg": near(14.0 * rng.beta(1.0, 1.1), 0.08, 0.0, 14.6),
        "fire_c": near(rng.uniform(620.0, 1180.0), 2.0, 600.0, 1200.0),
        "gauge_mm": near(rng.uniform(0.0, 80.0), 3.0, -5.0, 86.0),
        "coal_t": near(120.0 * rng.beta(1.0, 1.1), 0.5, 0.0, 122.0),
        "bench_c": near(rng.uniform(20.0, 260.0), 1.0, 15.0, 266.0),
    }


def walls_met(one: Floats, other: Floats) -> tuple[NDArray[np.bool_], Integers]:
    """Return whether straight ways between ends [n, 3] go through the retort house's wall [n].

    And how often through sides of the shed, which has none to the south [n].
    """
    way = np.where(np.abs(other - one) < 1e-9, 1e-9, other - one)

    def crossed(axis: int, side: float, low: float, high: float) -> NDArray[np.bool_]:
        part = (side - one[:, axis]) / way[:, axis]
        along = one[:, 1 - axis] + part.clip(0.0, 1.0) * way[:, 1 - axis]
        return np.asarray((part > 0) & (part < 1) & (along > low) & (along < high))

    (west, south), (east, north) = SHED_M.tolist()
    shed = crossed(0, west, south, north).astype(np.int64) + crossed(0, east, south, north)
    return crossed(0, RETORTS_M, 0.0, DOORS_M), shed + crossed(1, north, west, east)


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: iron by lot, the likelier low and by the gasholder.

    Else walls and sides of the shed where they meet these; by lot, heaps' concrete bays, glass of
    lanterns and boards of staging, the likelier the longer.
    """
    links = rows.groupby("link", sort=False).first()
    one, other = (links[[f"{end}_{a}_m" for a in "xyz"]].to_numpy(float) for end in ("tx", "rx"))
    amid, long_m = 0.5 * (one + other), np.linalg.norm(other - one, axis=1)
    to_holder = np.linalg.norm(amid[:, :2] - TANKS_M[-1, :2], axis=1)
    lots = np.exp(-0.1 * amid[:, 2]) * (0.6 + np.exp(-to_holder / 9.0))
    iron = rng.choice(len(links), round(SCREENED[bool(rare)] * len(links)), replace=False,
                      p=lots / lots.sum())  # fmt: skip
    wall, shed = walls_met(one, other)
    by_lot = {"concrete": 0.04 + 0.006 * long_m, "glass": 0.03 + 0.004 * long_m,
              "chipboard": 0.05 + 0.007 * long_m}  # fmt: skip
    struck = {what: rng.random(len(links)) < FEWER[rare in RARELY] * odds
              for what, odds in by_lot.items()}  # fmt: skip
    met: dict[str, list[str]] = {}
    for k, link in enumerate(links.index):
        some = ["brick"] * int(wall[k]) + ["wood"] * int(shed[k])
        some += [what for what, there in struck.items() if there[k]]
        met[link] = ["metal"] if k in iron else some
    return [[*met[link]] for link in rows["link"]]
