"""A day at the ice rink: who is ranged in which heat, when, and what is between.

numpy and pandas alone. In each heat one tag is answered by some mullions, in rounds. In a round
each has a slot: its number times the round's modulo a prime, so no two ever share one, and each
comes soon after another at other times. Mullions answer in some rounds, by lot.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.icerink_rink import (
    AMID_M,
    COURSE,
    DAY_S,
    HALF_M,
    HALL_M,
    MULLIONS,
    MULLIONS_M,
    PLACES,
    SORTS,
    TAGS,
    gone_to,
    off_boards,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat(np.arange(2, 8), [3, 5, 6, 6, 6, 1])
"""By how many mullions a heat's tag is heard."""
OF_ROWS: Integers = np.repeat(np.arange(1, 14), [15, 16, 15, 14, 13, 11, 9, 8, 6, 5, 3, 2, 1])
"""How many rows links have."""
STILL = 6  # heats whose tag rests
PRIME, SLOT_S, ROUND_S = 17, 0.0103, 0.184  # slots of a round; how long one is, and a round
NEAREST_M, CLEAR_M, LASTS_S = 2.8, 0.5, 4.2  # to mullions; to boards; until when both are seen to
LIKELY_M = 15.0  # by which mullions are e times less likely to hear a tag
THROUGH = ("plastic", "glass", "concrete", "chipboard")
"""Boards, panes of the benches and boxes, stands' tiers, seats of stands."""
BEHIND_STEEL = {False: 0.16, True: 0.055}  # of links, and where these are rare
RARELY = ("blocked-path", "diffraction")


def skated(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    heard_by = rng.permutation(HEARD_BY)
    lots = np.split(rng.permutation(of_rows), np.cumsum(heard_by)[:-1])
    tags = rng.permutation(np.resize(np.arange(len(TAGS)), len(lots)))
    begins_s = np.sort(rng.uniform(0.001, 0.999, len(lots))) * DAY_S
    goes = rng.permutation(np.arange(len(lots)) >= STILL).astype(np.float64)
    heats = []
    for number, lot in enumerate(lots):
        one = _heat(rng, number, TAGS[tags[number]], lot, goes[number])
        heats.append(one.assign(time_s=one["time_s"] + begins_s[number]))
    rows = pd.concat(heats, ignore_index=True)
    rows["obstacles"] = _between(rng, rows, rare)
    hall = {f"room_{axis}_m": size for axis, size in zip("xyz", HALL_M, strict=True)}
    return rows.assign(los=rows["obstacles"].str.len().eq(0), channel=2, prf_mhz=64.0, **hall)


def _heat(
    rng: np.random.Generator, number: int, tag: str, lengths: Integers, goes: float
) -> pd.DataFrame:
    """Return the rows of one heat by time, with places of its tag."""
    sort = tag.rstrip("0123456789")
    course = _course(rng, sort) | {"goes": goes, "into_s": rng.uniform(0.1, 0.8)}
    mullions = _hearing(rng, _places(course, np.zeros(1))[0], len(lengths))
    which, since_s = answered(rng, lengths)
    there, mullion = _places(course, since_s), mullions[which]
    way = MULLIONS_M[mullion] - there
    made = {name: np.full(len(which), course[name]) for name in COURSE}
    made |= {"into_s": course["into_s"] + since_s, "time_s": since_s}
    for k, axis in enumerate("xyz"):
        made |= {f"tx_{axis}_m": there[:, k], f"rx_{axis}_m": MULLIONS_M[mullion, k]}
    faces = rng.uniform(-180.0, 180.0)
    return pd.DataFrame(made | _noted(rng, since_s)).assign(
        tx=tag,
        rx=[f"mullion{k}" for k in mullion],
        link=[f"heat {number} at mullion{k}" for k in mullion],
        environment=PLACES[sort],
        azimuth_deg=(np.degrees(np.arctan2(way[:, 1], way[:, 0])) - faces) % 360.0,
        true_range_m=np.linalg.norm(way, axis=1),
    )


def _places(course: dict[str, float], since_s: Floats) -> Floats:
    """Return where a tag is some time after a heat began, in m [n, 3]."""
    all_ = {name: np.full(len(since_s), course[name]) for name in COURSE}
    return gone_to(all_, course["into_s"] + since_s)


def answered(rng: np.random.Generator, lengths: Integers) -> tuple[Integers, Floats]:
    """Return which of a heat's mullions answers, and when after the first, in s, by time [sum].

    `lengths`: how many times each mullion does, of fewer than PRIME rounds.
    """
    which, at_s = [], []
    for number, length in enumerate(lengths):
        rounds = rng.permutation(np.arange(1, PRIME))[:length]
        at_s.append(ROUND_S * rounds + SLOT_S * ((number + 1) * rounds % PRIME))
        which.append(np.full(length, number))
    when, who = np.concatenate(at_s), np.concatenate(which)
    order = np.argsort(when)
    return who[order].astype(np.int64), when[order] - when[order[0]]


def _hearing(rng: np.random.Generator, at: Floats, count: int) -> Integers:
    """Return so many mullions that hear a tag in a place, near ones the more likely.

    The largest of logarithms of odds and of Gumbel's chances are chosen.
    """
    far = np.linalg.norm(MULLIONS_M - at, axis=1)
    return np.argsort(far / LIKELY_M - rng.gumbel(size=MULLIONS))[:count].astype(np.int64)


def _course(rng: np.random.Generator, sort: str) -> dict[str, float]:
    """Return the course of a tag that keeps off mullions and boards."""
    ways: dict[str, Callable[[np.random.Generator], dict[str, float]]] = {
        "skater": _skater, "penguin": _penguin, "resurfacer": _resurfacer, "pair": _pair,
    }  # fmt: skip
    when = np.linspace(0.0, LASTS_S, 50)
    fixed = {"sort": float([*SORTS].index(sort)), "goes": 1.0, "into_s": 0.0}
    while True:
        made = dict.fromkeys(COURSE, 0.0) | ways[sort](rng) | fixed
        at = _places(made, when)
        free_m = np.linalg.norm(at[:, None] - MULLIONS_M, axis=2).min() - NEAREST_M
        if min(free_m, float(off_boards(at[:, 0], at[:, 1]).min()) - CLEAR_M) > 0:
            return made


def _somewhere(rng: np.random.Generator) -> dict[str, float]:
    """Return a place anywhere on the ice, and a direction."""
    east, north = (rng.uniform(mid - half, mid + half)
                   for mid, half in zip(AMID_M, HALF_M, strict=True))  # fmt: skip
    return {"east": east, "north": north, "heads": rng.uniform(-np.pi, np.pi)}


def _skater(rng: np.random.Generator) -> dict[str, float]:
    """Return a skater's course, on an edge to either side."""
    edge = rng.choice([-1.0, 1.0]) * rng.uniform(0.12, 0.42)
    goes = {"pace": rng.uniform(1.8, 3.6), "slows": rng.uniform(9.0, 22.0), "bends": edge}
    return _somewhere(rng) | goes | {"tall": rng.uniform(1.0, 1.6), "spans": 0.03}


def _penguin(rng: np.random.Generator) -> dict[str, float]:
    """Return the course of a penguin that is pushed off."""
    goes = {"pace": rng.uniform(1.7, 3.4), "slows": rng.uniform(0.25, 0.55)}
    return _somewhere(rng) | goes | {"tall": rng.uniform(0.6, 0.9)}


def _resurfacer(rng: np.random.Generator) -> dict[str, float]:
    """Return a resurfacer's course, `spans` m off the boards, either way round."""
    goes = {"east": rng.uniform(0.0, 150.0), "spans": rng.uniform(1.0, 5.5)}
    pace = rng.choice([-1.0, 1.0]) * rng.uniform(1.5, 2.6)
    return goes | {"pace": pace, "tall": rng.uniform(1.9, 2.4)}


def _pair(rng: np.random.Generator) -> dict[str, float]:
    """Return the course of who turns about a partner, either way round."""
    turns = rng.choice([-1.0, 1.0]) * rng.uniform(0.9, 1.4)
    goes = {"pace": turns, "slows": rng.uniform(14.0, 24.0), "spans": rng.uniform(1.1, 1.9)}
    return _somewhere(rng) | goes | {"tall": rng.uniform(0.4, 0.9)}


def _noted(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is noted for each row [n]: of mornings and evenings, of an empty and full rink.

    `glide_m` is how far the guard's wagon has come along the glass.
    """
    rows = len(since_s)
    each = rng.normal(size=(11, rows))
    return {
        "temperature_c": 6.0 + 9.5 * np.cos(rng.uniform(0.0, np.pi)) + 0.4 * each[0],
        "reply_time_s": 0.0032 + 0.0088 * rng.beta(1.4, 1.4, rows),
        "chiller_kw": (240.0 * rng.beta(0.9, 1.1) + 4.0 * each[1]).clip(0.0, 250.0),
        "frost_mm": (rng.gamma(1.3, 3.2) + 0.15 * np.abs(each[2])).clip(0.0, 18.0),
        "slush_cm": (rng.uniform(0.5, 12.0) + 0.2 * each[3]).clip(0.1, 13.0),
        "cube_gap_m": (rng.uniform(0.7, 4.2) + 0.05 * each[4]).clip(0.5, 4.5),
        "flooded_min": np.exp(rng.uniform(0.0, 4.6) + 0.1 * each[5]),
        "sticks": rng.binomial(28, rng.beta(1.1, 1.2), rows).astype(np.float64),
        "brine_c": -8.6 + 3.4 * np.sin(rng.uniform(-np.pi, np.pi)) + 0.15 * each[6],
        "humid_pct": (rng.uniform(45.0, 95.0) + 0.7 * each[7]).clip(40.0, 98.0),
        "snow_cm": (55.0 * rng.beta(1.2, 1.1) + 0.5 * each[8]).clip(0.0, 56.0),
        "glide_m": rng.uniform(0.0, 170.0) + 1.3 * since_s + 0.25 * np.abs(each[9]),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: steel of a parked resurfacer by lot, else some things.

    Boards where both ends are low, panes where mullions stand in the stands, tiers where ways end
    far up the stands' ends, seats where they come low along these.
    """
    links = rows.groupby("link", sort=False).first()
    tall, high = links["tx_z_m"].to_numpy(), links["rx_z_m"].to_numpy()
    low, roof = (high < 4.2) & (tall < 1.2), high > 9.0
    ends = (np.abs(links["rx_x_m"].to_numpy() - AMID_M[0]) > 29.0) & ~roof
    odds = np.stack([0.14 + 0.3 * low, 0.3 * ~roof, 0.05 + 0.14 * ends,
                     0.04 + 0.09 * (high < 3.4)]) * np.where(roof, 0.45, 1.0)  # fmt: skip
    met = rng.random(odds.shape) < odds * (0.4 if rare in RARELY else 1.0)
    steel = rng.permutation(len(links)) < round(BEHIND_STEEL[bool(rare)] * len(links))
    some: dict[object, list[str]] = {}
    for k, link in enumerate(links.index):
        by_way = [what for what, there in zip(THROUGH, met[:, k], strict=True) if there]
        some[link] = ["metal"] if steel[k] else by_way
    return [[*some[link]] for link in rows["link"]]
