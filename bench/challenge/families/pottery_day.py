"""A day at the pottery: whose tag calls which purlins, how often, and what is between.

numpy and pandas alone. In each round one tag is answered by some purlins, at times between which
there is a least pause and then chance alone.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.pottery_floor import (
    COURSE,
    DAY_S,
    DRYING_X,
    DRYING_Y,
    GLAZE_X,
    GLAZE_Y,
    KILN_M,
    PURLINS,
    PURLINS_M,
    ROLLER_M,
    SHOPS,
    TAGS,
    TRADES,
    WORKS_M,
    at_trade,
    lengths,
    room_m,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
ANSWER: Integers = np.repeat([3, 4, 5, 6, 7], [6, 6, 6, 5, 4])
"""How many purlins answer a round's tag."""
OF_ROWS: Integers = np.repeat(np.arange(1, 11), [17, 22, 22, 20, 17, 13, 9, 6, 3, 1])
"""How many rows links have."""
IDLE = 5  # rounds whose tag rests, each of another tag that has one in which it goes
CALLS, PAUSE_S, CHANCE_S, SLOT_S = 12, 0.2, 0.16, 0.013
"""Calls of a round; s between these at least, and more by chance; of a purlin's slot."""
NEAREST_M, FREE_M, SEEN_S = 1.5, 0.3, 8.6  # to purlins; to walls; until when both are seen to
HEARD_M = 7.5  # in which odds to answer fall to 1 / e
TRAYS = {False: 0.17, True: 0.05}  # of links behind racks of trays; where these are rare
LESS = {False: 1.0, True: 0.4}  # of all else then
RARELY = ("blocked-path", "diffraction")
RACKS_X = (4.0, 9.5, 23.0, 31.0)  # along, of aisles of racks
Drawn = dict[str, float]


def fired(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    order, answer = rng.permutation(len(TAGS)), rng.permutation(ANSWER)
    shares = np.split(rng.permutation(of_rows), np.cumsum(answer)[:-1])
    begins_s = np.sort(rng.uniform(20.0, DAY_S - 40.0, len(answer)))
    twice = rng.permutation(len(answer) - len(TAGS))[:IDLE]
    rests = {*(twice + len(TAGS) * rng.integers(2, size=IDLE)).tolist()}
    rounds = [
        _round(rng, k, TAGS[order[k % len(TAGS)]], share, float(begins_s[k]), k not in rests)
        for k, share in enumerate(shares)
    ]
    rows = pd.concat(rounds, ignore_index=True)
    rows["obstacles"] = _between(rng, rows, rare)
    return rows.assign(
        los=[not some for some in rows["obstacles"]], channel=4, prf_mhz=16.0,
        room_x_m=WORKS_M[0], room_y_m=WORKS_M[1], room_z_m=WORKS_M[2],
    )  # fmt: skip


def calls(rng: np.random.Generator, shares: Integers) -> tuple[Integers, Floats]:
    """Return who answers, and when after the first in s, [sum of shares] each.

    Each answers some of the calls, in a slot of its own.
    """
    pauses_s = PAUSE_S + rng.exponential(CHANCE_S, CALLS - 1).clip(max=3 * CHANCE_S)
    call_s = np.append(0.0, np.cumsum(pauses_s))
    which = [rng.choice(CALLS, share, replace=False) for share in shares.tolist()]
    who = np.repeat(np.arange(len(shares)), shares)
    when_s = call_s[np.concatenate(which)] + SLOT_S * who
    order = np.argsort(when_s, kind="stable")
    return who[order], when_s[order] - when_s.min()


def _round(
    rng: np.random.Generator, number: int, tag: str, shares: Integers, begin_s: float, goes: bool
) -> pd.DataFrame:
    """Return the rows of one round by time, with places of its tag."""
    trade = tag.rstrip("0123456789")
    course = course_of(rng, trade) | {"stirs": float(goes)}
    into_s = float(rng.uniform(0.3, 1.3))
    odds = 0.03 + np.exp(-lengths(PURLINS_M - _at(course, np.array([into_s]))) / HEARD_M)
    chosen = rng.choice(PURLINS, len(shares), replace=False, p=odds / odds.sum())
    who, since_s = calls(rng, shares)
    here, there = _at(course, into_s + since_s), PURLINS_M[chosen[who]]
    rows = pd.DataFrame(course, index=np.arange(len(who))).assign(into_s=into_s + since_s)
    for end, at in (("tx", here), ("rx", there)):
        rows[[f"{end}_{axis}_m" for axis in "xyz"]] = at
    way = there - here
    aim = np.degrees(np.arctan2(way[:, 1], way[:, 0])) - rng.uniform(0.0, 360.0)
    return rows.assign(
        **_written(rng, since_s), time_s=begin_s + since_s, environment=SHOPS[trade],
        tx=tag, rx=[f"purlin{k}" for k in chosen[who]], azimuth_deg=(aim + 180.0) % 360.0 - 180.0,
        link=[f"round {number} at purlin{k}" for k in chosen[who]], true_range_m=lengths(way),
    )  # fmt: skip


def _at(course: Drawn, into_s: Floats) -> Floats:
    """Return where a tag is some time into its course, in m [n, 3]."""
    return at_trade({name: np.full(into_s.shape, one) for name, one in course.items()}, into_s)


SPANS: dict[str, dict[str, tuple[float, float]]] = {
    "board": {"from_z": (1.5, 1.9), "brisk": (0.7, 1.1), "bent": (0.06, 0.14)},
    "truck": {"from_z": (0.5, 1.4), "brisk": (1.2, 1.9), "wide": (2.6, 4.4)},
    "fettler": {"from_z": (1.0, 1.6), "brisk": (0.4, 0.6), "wide": (1.1, 1.7),
                "bent": (0.06, 0.14)},
    "pug": {"from_z": (1.0, 2.0), "brisk": (0.4, 0.55), "wide": (0.8, 1.3), "bent": (0.3, 0.5)},
    "saggar": {"from_z": (0.5, 1.2), "brisk": (0.34, 0.5), "wide": (0.2, 0.4)},
    "dipper": {"from_z": (0.9, 1.5), "brisk": (0.55, 0.75), "wide": (1.0, 1.6),
               "bent": (0.6, 0.9)},
}  # fmt: skip
"""Between which values courses of each trade are drawn evenly; see what has tags go."""


def course_of(rng: np.random.Generator, trade: str) -> Drawn:
    """Return the course of a tag that keeps off purlins, walls and the kiln."""
    seen_s, number = np.linspace(0.0, SEEN_S, 80), float([*TRADES].index(trade))
    own = SPANS[trade] | {"from_x": (2.0, WORKS_M[0] - 2.0), "from_y": (2.0, WORKS_M[1] - 2.0)}
    for _ in range(30_000):
        made = dict.fromkeys(COURSE, 0.0) | {"trade": number, "stirs": 1.0}
        made |= {name: float(rng.uniform(*span)) for name, span in own.items()}
        made |= {name: float(rng.uniform(-np.pi, np.pi)) for name in ("heads", "turned")}
        at = _at(made, seen_s)
        if room_m(at).min() > FREE_M and _off_purlins(at) > NEAREST_M:
            return made
    raise AssertionError(trade)


def _off_purlins(at: Floats) -> float:
    """Return how near places [n, 3] come to purlins in m."""
    return float(np.linalg.norm(at[:, None] - PURLINS_M, axis=2).min())


def _written(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is logged beside each row of a round, [n] each; orders and air are of nothing."""
    rows = len(since_s)

    def near(one: float, by: float, least: float) -> Floats:
        return np.maximum(one + by * rng.uniform(-1.0, 1.0, rows), least)

    return {
        "temperature_c": near(rng.uniform(6.0, 46.0), 0.6, 5.0),
        "reply_time_s": 0.0021 + 0.0009 * rng.integers(0, 7, rows) + near(8e-5, 8e-5, 0.0),
        "kiln_kw": near(180.0 * rng.beta(1.1, 1.2), 2.0, 0.0),
        "slip_g": near(60.0 * rng.beta(0.9, 1.4), 0.5, 0.1),
        "swept_h": near(300.0 * rng.beta(0.7, 1.7), 0.5, 0.3),
        "glaze_um": near(rng.uniform(30.0, 1100.0), 6.0, 10.0),
        "draught_pa": near(rng.uniform(2.2, 20.0), 0.1, 2.0),
        "rack_m": near(0.8 + rng.gamma(1.2, 0.7), 0.02, 0.75),
        "load_ka": near(3.0 * rng.beta(1.0, 1.1), 0.03, 0.0),
        "damp_pct": near(rng.uniform(22.0, 92.0), 0.8, 15.0),
        "rollers_m": rng.uniform(0.0, 25.0) + 0.5 * since_s + ROLLER_M * rng.random(rows),
        "clay_t": near(rng.uniform(1.0, 12.0), 0.05, 0.5),
        "flint_mg": near(8.0 * rng.beta(1.0, 1.1), 0.1, 0.0),
        "kiln_k": near(rng.uniform(20.0, 900.0), 3.0, 10.0),
        "wet_kg": near(40.0 * rng.beta(1.1, 1.2), 0.3, 0.0),
        "boards_n": np.full(rows, float(rng.integers(0, 9))),
        "orders_n": np.full(rows, float(rng.poisson(14))),
        "barometer_hpa": near(rng.normal(1012.0, 7.0), 0.2, 900.0),
    }


def walls_met(one: Floats, other: Floats) -> dict[str, NDArray[np.bool_]]:
    """Return whether straight ways between ends [n, 3] go through kiln, drying and glaze shops.

    [n] each, by what these are of.
    """
    way = other - one

    def crossed(axis: int, at: float, span: tuple[float, float]) -> NDArray[np.bool_]:
        apart = (one[:, axis] - at) * (other[:, axis] - at) < 0
        part = (at - one[:, axis]) / np.where(apart, way[:, axis], 1.0)
        where = one[:, 1 - axis] + part * way[:, 1 - axis]
        return np.asarray(apart & (where > span[0]) & (where < span[1]))

    off = one[:, :2] - np.array(KILN_M[:2])
    level = way[:, :2]
    part = -(off * level).sum(axis=1) / np.maximum((level**2).sum(axis=1), 1e-12)
    closest = np.linalg.norm(off + part.clip(0.0, 1.0)[:, None] * level, axis=1)
    return {
        "brick": np.asarray(closest < KILN_M[2]),
        "wood": crossed(1, DRYING_Y, DRYING_X),
        "glass": crossed(0, GLAZE_X, GLAZE_Y),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: racks of trays by lot, likelier low and by aisles.

    Else what they meet; by lot, piers of concrete, bats of plaster and boards of chips.
    """
    links = rows.drop_duplicates("link")
    one, other = (links[[f"{end}_{a}_m" for a in "xyz"]].to_numpy(float) for end in ("tx", "rx"))
    far, amid = lengths(other - one), 0.5 * (one + other)
    aisle = np.abs(amid[:, 0, None] - np.array(RACKS_X)).min(axis=1)
    odds = 0.12 + np.exp(-aisle / 3.0 - amid[:, 2] / 6.0)
    racks = rng.choice(len(links), round(TRAYS[bool(rare)] * len(links)), False, odds / odds.sum())
    less = LESS[rare in RARELY]
    lots = (("concrete", 0.005), ("plasterboard", 0.005), ("chipboard", 0.004))
    met = walls_met(one, other) | {
        what: rng.random(len(links)) < less * (0.02 + each * far) for what, each in lots
    }
    said = {link: [what for what, struck in met.items() if struck[k]]
            for k, link in enumerate(links["link"])}  # fmt: skip
    said |= {links["link"].iloc[k]: ["metal"] for k in racks}
    return [[*said[link]] for link in rows["link"]]
