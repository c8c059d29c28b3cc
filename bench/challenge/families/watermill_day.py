"""A day at the watermill: which hatches hear whose tag, in which frames, and what is between.

numpy and pandas alone. In each grist one tag is heard by some hatches. A frame comes as often as
the damsel claps; in it each hatch has a slot, and waits by chance where the air is in use.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.watermill_race import (
    ARCH_M,
    COG_M,
    COURSE,
    DAY_S,
    HATCHES,
    HATCHES_M,
    KINDS,
    PLACES,
    ROOM_M,
    STOREYS_M,
    TAGS,
    TRAP_M,
    WALL_M,
    clear_m,
    gone_to,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD: Integers = np.repeat([3, 4, 5, 6, 7], [4, 7, 7, 5, 4])
"""How many hatches hear a grist's tag."""
OF_ROWS: Integers = np.repeat(np.arange(1, 13), [20, 20, 19, 17, 15, 13, 11, 8, 5, 3, 1, 1])
"""How many rows links have."""
RESTS = 5  # grists whose tag rests, each of another tag that has one in which it goes
FRAMES, FRAME_S, SLOT_S, WAITS_S = 14, 0.42, 0.031, 0.004  # of a grist; each; of a hatch; by chance
NEAREST_M, FREE_M, SEEN_S = 1.3, 0.3, 9.6  # to hatches; to sides; until when both are seen to
CARRIES_M, SAME = 11.0, 6.0  # over which a hatch hears less, to 1 / e; the likelier on one storey
CASED = {False: 0.15, True: 0.05}  # of links behind iron; where these are rare
LESS = {False: 1.0, True: 0.4}  # of all else then
RARELY = ("blocked-path", "diffraction")
Drawn = dict[str, float]


def ground(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    order, heard = rng.permutation(len(TAGS)), rng.permutation(HEARD)
    counts = np.split(rng.permutation(of_rows), np.cumsum(heard)[:-1])
    begins_s = DAY_S * (np.arange(len(heard)) + rng.uniform(0.1, 0.8, len(heard))) / len(heard)
    twice = rng.permutation(len(heard) - len(TAGS))[:RESTS]
    still = {int(k + len(TAGS) * late) for k, late in zip(twice, rng.random(RESTS) < 0.5,
                                                          strict=True)}  # fmt: skip
    made = [
        _grist(rng, number, TAGS[order[number % len(TAGS)]], own, begins_s[number],
               number not in still)
        for number, own in enumerate(counts)
    ]  # fmt: skip
    rows = pd.concat(made, ignore_index=True)
    rows["obstacles"] = _between(rng, rows, rare)
    size = dict(zip(("room_x_m", "room_y_m", "room_z_m"), ROOM_M, strict=True))
    return rows.assign(los=rows["obstacles"].map(len).eq(0), channel=3, prf_mhz=64.0, **size)


def slots(rng: np.random.Generator, counts: Integers) -> tuple[Integers, Floats]:
    """Return which of the hatches hear, and when after the first in s, [sum of counts] each.

    Of all frames each takes as many as it has rows, by lot.
    """
    who = np.repeat(np.arange(len(counts)), counts)
    frame = np.concatenate([rng.permutation(FRAMES)[:count] for count in counts])
    at_s = FRAME_S * frame + SLOT_S * who + rng.exponential(WAITS_S, len(who)).clip(max=0.02)
    order = np.argsort(at_s)
    return who[order].astype(np.int64), at_s[order] - at_s.min()


def storey(high_m: Floats) -> Integers:
    """Return on which storey heights in m [...] are, from 0 on."""
    return np.asarray(np.searchsorted(STOREYS_M, high_m, side="right") - 1, np.int64)


def _grist(
    rng: np.random.Generator, number: int, tag: str, counts: Integers, begin_s: float, astir: bool
) -> pd.DataFrame:
    """Return the rows of one grist by time, with places of its tag."""
    kind = tag.rstrip("0123456789")
    course = course_of(rng, kind) | {"astir": float(astir)}
    begun = rng.uniform(0.1, 1.9)
    here = _at(course, np.array([begun]))
    near = np.exp(-np.linalg.norm(HATCHES_M - here, axis=1) / CARRIES_M)
    near *= np.where(storey(HATCHES_M[:, 2]) == storey(here[:, 2]), SAME, 1.0)
    hatches = rng.choice(HATCHES, len(counts), replace=False, p=near / near.sum())
    which, since_s = slots(rng, counts)
    tags_m, hatches_m = _at(course, begun + since_s), HATCHES_M[hatches[which]]
    known = {name: np.full(len(which), course[name]) for name in COURSE}
    known["into_s"] = begun + since_s
    for end, at in (("tx", tags_m), ("rx", hatches_m)):
        known |= {f"{end}_{axis}_m": at[:, k] for k, axis in enumerate("xyz")}
    way = hatches_m - tags_m
    aims = np.degrees(np.arctan2(way[:, 1], way[:, 0])) + rng.uniform(0.0, 360.0)
    return pd.DataFrame(known | _written(rng, since_s)).assign(
        time_s=begin_s + since_s, tx=tag, rx=[f"hatch{k}" for k in hatches[which]],
        environment=PLACES[kind], link=[f"grist {number} at hatch{k}" for k in hatches[which]],
        azimuth_deg=(aims + 180.0) % 360.0 - 180.0, true_range_m=np.linalg.norm(way, axis=1),
    )  # fmt: skip


def _at(course: Drawn, into_s: Floats) -> Floats:
    """Return where a tag is some time into its course, in m [n, 3]."""
    return gone_to({name: np.full(len(into_s), one) for name, one in course.items()}, into_s)


def course_of(rng: np.random.Generator, kind: str) -> Drawn:
    """Return the course of a tag that keeps off hatches and sides."""
    seen_s = np.linspace(0.0, SEEN_S, 121)
    for _ in range(20_000):
        made = dict.fromkeys(COURSE, 0.0) | {"gang": float([*KINDS].index(kind)), "astir": 1.0}
        made |= {"phase": rng.uniform(-np.pi, np.pi), "mid_x": rng.uniform(1.0, 19.0),
                 "mid_y": rng.uniform(1.0, 17.0)} | BEGINS[kind](rng)  # fmt: skip
        at = _at(made, seen_s)
        apart = np.linalg.norm(at[:, None] - HATCHES_M, axis=2)
        if clear_m(at).min() > FREE_M and apart.min() > NEAREST_M:
            return made
    raise AssertionError(kind)


def _paddle(rng: np.random.Generator) -> Drawn:
    return {"mid_x": rng.uniform(22.5, 25.5), "mid_y": rng.uniform(8.6, 9.4), "mid_z": 4.4,
            "faces": 0.5 * np.pi, "pace": rng.uniform(0.28, 0.48),
            "reach": rng.uniform(2.6, 3.6)}  # fmt: skip


def _sack(rng: np.random.Generator) -> Drawn:
    return {"mid_x": rng.uniform(8.0, 12.0), "mid_y": rng.uniform(7.5, 10.5),
            "mid_z": rng.uniform(0.6, 5.5), "faces": rng.uniform(-np.pi, np.pi),
            "pace": rng.uniform(0.4, 0.75), "twist": rng.uniform(0.5, 1.6),
            "reach": rng.uniform(0.25, 0.5)}  # fmt: skip


def _miller(rng: np.random.Generator) -> Drawn:
    return {"mid_z": STOREYS_M[1] + rng.uniform(1.0, 1.5), "faces": rng.uniform(-np.pi, np.pi),
            "pace": rng.choice([-1.0, 1.0]) * rng.uniform(0.4, 0.65),
            "reach": rng.uniform(1.3, 2.2)}  # fmt: skip


def _drift(rng: np.random.Generator) -> Drawn:
    return {"mid_x": rng.uniform(21.0, 27.0), "mid_y": rng.uniform(1.0, 9.0),
            "mid_z": rng.uniform(0.35, 0.6), "faces": 0.5 * np.pi + rng.normal(0.0, 0.08),
            "pace": rng.uniform(0.8, 1.4), "reach": rng.uniform(5.0, 9.0),
            "twist": rng.uniform(0.2, 0.6)}  # fmt: skip


def _cart(rng: np.random.Generator) -> Drawn:
    return {"mid_z": rng.uniform(0.7, 1.3), "pace": rng.uniform(0.6, 1.1),
            "reach": rng.uniform(0.8, 1.8),
            "twist": rng.choice([-1.0, 1.0]) * rng.uniform(0.2, 0.6)}  # fmt: skip


def _bucket(rng: np.random.Generator) -> Drawn:
    return {"mid_z": rng.uniform(0.7, 2.5), "faces": rng.choice(4) * 0.5 * np.pi,
            "pace": rng.uniform(0.6, 1.1), "reach": rng.uniform(5.0, 8.5),
            "twist": rng.uniform(0.3, 0.5), "phase": rng.random()}  # fmt: skip


BEGINS: dict[str, Callable[[np.random.Generator], Drawn]] = dict(
    zip(KINDS, (_paddle, _sack, _miller, _drift, _cart, _bucket), strict=True)
)


def _written(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is written down beside each row of a grist, [n] each."""
    count = len(since_s)

    def about(one: float, by: float, low: float, high: float) -> Floats:
        return np.asarray((one + by * rng.triangular(-2.0, 0.0, 2.0, count)).clip(low, high))

    return {
        "temperature_c": about(rng.uniform(2.0, 33.0), 0.25, 1.0, 34.0),
        "reply_time_s": 0.0032 + 0.0012 * rng.integers(0, 7, count) + 0.0002 * rng.random(count),
        "dynamo_a": about(60.0 * rng.beta(1.1, 1.4), 0.5, 0.0, 62.0),
        "meal_g": about(30.0 * rng.beta(0.9, 1.5), 0.25, 0.1, 31.0),
        "rain_h": about(18.0 * rng.beta(0.9, 1.3), 0.1, 0.05, 18.5),
        "sacks": about(rng.uniform(1.0, 14.0), 0.08, 0.8, 14.5),
        "swept_h": about(rng.uniform(0.2, 30.0), 0.1, 0.1, 30.5),
        "crane_m": about(0.55 + rng.gamma(1.4, 0.6), 0.02, 0.5, 5.0),
        "pond_m": about(2.4 * rng.beta(1.0, 1.1), 0.015, 0.0, 2.5),
        "tenter_mm": about(rng.uniform(0.2, 3.8), 0.02, 0.1, 3.9),
        "spur_m": rng.uniform(0.0, 50.0) + 1.1 * since_s + COG_M * rng.random(count),
        "penstock_cm": about(rng.uniform(15.0, 46.0), 0.25, 14.0, 47.0),
        "spray_g": about(8.0 * rng.beta(1.0, 1.2), 0.06, 0.0, 8.3),
        "damp_pct": about(rng.uniform(11.0, 21.0), 0.1, 10.5, 21.5),
        "warm_c": about(rng.uniform(4.0, 36.0), 0.2, 3.0, 37.0),
        "governor_mm": about(rng.uniform(0.0, 60.0), 0.5, 0.0, 61.0),
        "bin_t": about(9.0 * rng.beta(1.0, 1.1), 0.05, 0.0, 9.2),
    }


def floors_between(one: Floats, other: Floats) -> Integers:
    """Return how many floors of oak straight ways between ends [n, 3] go through [n].

    None where they go through the trap, nor in the wheel house.
    """
    made = np.zeros(len(one), np.int64)
    for high in STOREYS_M[1:]:
        rise = other[:, 2] - one[:, 2]
        part = (high - one[:, 2]) / np.where(np.abs(rise) < 1e-9, 1e-9, rise)
        at = one + part.clip(0.0, 1.0)[:, None] * (other - one)
        trap = ((at[:, :2] > TRAP_M[0]) & (at[:, :2] < TRAP_M[1])).all(axis=1)
        made += (part > 0.0) & (part < 1.0) & (at[:, 0] < WALL_M) & ~trap
    return made


def through_the_wall(one: Floats, other: Floats) -> NDArray[np.bool_]:
    """Return whether straight ways between ends [n, 3] go through the wheel house's wall [n]."""
    across = other[:, 0] - one[:, 0]
    part = (WALL_M - one[:, 0]) / np.where(np.abs(across) < 1e-9, 1e-9, across)
    along = one[:, 1] + part.clip(0.0, 1.0) * (other[:, 1] - one[:, 1])
    return np.asarray((part > 0.0) & (part < 1.0) & (along < ARCH_M))


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: iron casings by lot, the likelier low and amid.

    Else floors and the wall where they meet these, plywood of hoppers, glass of screens and
    concrete of piers by lot.
    """
    first = rows.drop_duplicates("link")
    one, other = (first[[f"{end}_{a}_m" for a in "xyz"]].to_numpy(float) for end in ("tx", "rx"))
    middle, far = 0.5 * (one + other), np.linalg.norm(one - other, axis=1)
    weigh = np.exp(-0.12 * middle[:, 2] - 0.08 * np.abs(middle[:, 0] - WALL_M))
    cased = rng.choice(len(first), round(CASED[bool(rare)] * len(first)), replace=False,
                       p=weigh / weigh.sum())  # fmt: skip
    some = [["wood"] * count for count in floors_between(one, other)]
    odds = {"plywood": 0.02 + 0.009 * far, "glass": 0.03 + 0.003 * far,
            "concrete": np.where(middle[:, 0] > WALL_M - 2.0, 0.16, 0.01)}  # fmt: skip
    walls = through_the_wall(one, other)
    for what, odd in odds.items():
        for k in np.flatnonzero(rng.random(len(first)) < LESS[rare in RARELY] * odd):
            some[k].append(what)
    for k in np.flatnonzero(walls):
        some[k].append("brick")
    for k in cased:
        some[k] = ["metal"]
    by_link = dict(zip(first["link"], some, strict=True))
    return [list(by_link[link]) for link in rows["link"]]
