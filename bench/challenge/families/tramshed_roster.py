"""A day at the tram shed: which rosettes call whose tag, how often, and what is between.

numpy and pandas alone. In each turn some rosettes call one tag by rounds that come ever slower,
as a bell does that is left swinging.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.tramshed_depot import (
    ARCADE_X,
    ARCADE_Y,
    ARCHES_X,
    COURSE,
    DAY_S,
    DUTIES,
    OFFICE_X,
    OFFICE_Y,
    ROADS,
    ROSETTES,
    ROSETTES_M,
    SHED_M,
    SLEEPER_M,
    TAGS,
    at_duty,
    lengths,
    room_m,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
CALLERS: Integers = np.repeat([3, 4, 5, 6, 7], [5, 6, 6, 7, 4])
"""How many rosettes call a turn's tag."""
OF_ROWS: Integers = np.repeat(np.arange(1, 12), [19, 23, 22, 20, 18, 14, 10, 6, 4, 2, 1])
"""How many rows links have."""
IDLE = 5  # turns whose tag rests, each of another tag that has one in which it goes
ROUNDS, ROUND_S, SLOWER, AFTER_S = 13, (0.3, 0.42), 1.07, 0.017
"""Rounds a turn; s to the second; times longer each next; s from a rosette to the next."""
NEAREST_M, FREE_M, SEEN_S = 1.6, 0.3, 10.4  # to rosettes; to walls; until when both are seen to
HEARD_M = 7.0  # in which odds to be called fall to 1 / e
IRON = {False: 0.17, True: 0.05}  # of links behind trams; where these are rare
LESS = {False: 1.0, True: 0.4}  # of all else then
RARELY = ("blocked-path", "diffraction")
PARKED_Y = (4.0, 8.5, 26.0)  # of roads with trams that stand there
Drawn = dict[str, float]


def worked(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    duty, callers = rng.permutation(len(TAGS)), rng.permutation(CALLERS)
    shares = np.split(rng.permutation(of_rows), np.cumsum(callers)[:-1])
    begins_s = np.sort(rng.uniform(30.0, DAY_S - 60.0, len(callers)))
    rests = {int(k + len(TAGS) * rng.integers(2)) for k in rng.permutation(len(TAGS))[:IDLE]}
    turns = [
        _turn(rng, k, TAGS[duty[k % len(TAGS)]], share, float(begins_s[k]), k not in rests)
        for k, share in enumerate(shares)
    ]
    rows = pd.concat(turns, ignore_index=True)
    rows["obstacles"] = _between(rng, rows, rare)
    return rows.assign(
        los=~rows["obstacles"].map(bool), channel=9, prf_mhz=64.0,
        room_x_m=SHED_M[0], room_y_m=SHED_M[1], room_z_m=SHED_M[2],
    )  # fmt: skip


def rings(rng: np.random.Generator, shares: Integers) -> tuple[Integers, Floats]:
    """Return who calls, and when after the first in s, [sum of shares] each.

    Each calls in some of the rounds, a little after who is before it in these.
    """
    pause_s = rng.uniform(*ROUND_S) * SLOWER ** np.arange(ROUNDS - 1)
    round_s = np.concatenate([[0.0], np.cumsum(pause_s)])
    takes = [np.sort(rng.choice(ROUNDS, share, replace=False)) for share in shares.tolist()]
    who = np.concatenate([np.full(len(one), k) for k, one in enumerate(takes)])
    when_s = round_s[np.concatenate(takes)] + AFTER_S * who
    order = when_s.argsort(kind="stable")
    return who[order], when_s[order] - when_s.min()


def _turn(
    rng: np.random.Generator, number: int, tag: str, shares: Integers, begin_s: float, goes: bool
) -> pd.DataFrame:
    """Return the rows of one turn by time, with places of its tag."""
    duty = tag.rstrip("0123456789")
    course = course_of(rng, duty) | {"goes": float(goes)}
    into_s = float(rng.uniform(0.2, 1.5))
    odds = 0.02 + np.exp(-lengths(ROSETTES_M - _at(course, np.array([into_s]))) / HEARD_M)
    chosen = rng.choice(ROSETTES, len(shares), replace=False, p=odds / odds.sum())
    who, since_s = rings(rng, shares)
    rows = pd.DataFrame(course, index=np.arange(len(who)))
    rows["into_s"] = into_s + since_s
    there, here = ROSETTES_M[chosen[who]], _at(course, into_s + since_s)
    for end, at in (("tx", there), ("rx", here)):
        rows[[f"{end}_{axis}_m" for axis in "xyz"]] = at
    aim = np.degrees(np.arctan2(*(here - there)[:, 1::-1].T)) - rng.uniform(-180.0, 180.0)
    return rows.assign(
        **_written(rng, since_s), time_s=begin_s + since_s, environment=ROADS[duty],
        tx=[f"rosette{k}" for k in chosen[who]], rx=tag, azimuth_deg=180.0 - (180.0 - aim) % 360.0,
        link=[f"turn {number} by rosette{k}" for k in chosen[who]],
        true_range_m=np.linalg.norm(here - there, axis=1),
    )  # fmt: skip


def _at(course: Drawn, into_s: Floats) -> Floats:
    """Return where a tag is some time into its course, in m [n, 3]."""
    return at_duty({name: np.full(into_s.shape, one) for name, one in course.items()}, into_s)


SPANS: dict[str, dict[str, tuple[float, float]]] = {
    "tram": {"from_x": (3.0, 43.0), "from_y": (3.0, 28.0), "from_z": (2.6, 3.2),
             "pace": (0.7, 1.2), "span": (2.2, 3.4), "curl": (2.0, 5.0)},
    "traverser": {"from_x": (3.0, 43.0), "from_y": (3.0, 28.0), "from_z": (0.6, 1.1),
                  "pace": (0.5, 0.9), "curl": (-0.1, 0.1)},
    "sweeper": {"from_x": (3.0, 43.0), "from_y": (3.0, 28.0), "from_z": (1.0, 1.6),
                "pace": (0.4, 0.7), "span": (0.8, 1.3)},
    "jack": {"from_x": (4.0, 42.0), "from_y": (4.0, 27.0), "from_z": (0.6, 1.0),
             "pace": (0.24, 0.4), "span": (1.4, 2.2)},
    "block": {"from_x": (5.0, 41.0), "from_y": (5.0, 26.0), "from_z": (2.0, 6.0),
              "pace": (0.6, 0.9), "span": (1.2, 2.0), "curl": (0.3, 0.8)},
    "pole": {"from_x": (5.0, 41.0), "from_y": (5.0, 26.0), "from_z": (4.0, 6.0),
             "pace": (0.26, 0.4), "span": (2.4, 3.4)},
}  # fmt: skip
"""Between which values courses of each duty are drawn evenly; see what has tags go."""


def course_of(rng: np.random.Generator, duty: str) -> Drawn:
    """Return the course of a tag that keeps off rosettes, walls and the boiler."""
    seen_s, number = np.linspace(0.0, SEEN_S, 95), float([*DUTIES].index(duty))
    for _ in range(30_000):
        made = dict.fromkeys(COURSE, 0.0) | {"duty": number, "goes": 1.0}
        made |= {name: float(rng.uniform(*span)) for name, span in SPANS[duty].items()}
        made |= {name: float(rng.uniform(0.0, 2 * np.pi)) for name in ("points", "phase")}
        at = _at(made, seen_s)
        if room_m(at).min() > FREE_M and _off_rosettes(at) > NEAREST_M:
            return made
    raise AssertionError(duty)


def _off_rosettes(at: Floats) -> float:
    """Return how near places [n, 3] come to rosettes in m."""
    return float(np.sqrt(((at[:, None] - ROSETTES_M) ** 2).sum(axis=2).min()))


def _written(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is logged beside each row of a turn, [n] each."""

    def near(one: float, by: float, least: float) -> Floats:
        return np.maximum(one + by * rng.uniform(-1.0, 1.0, len(since_s)), least)

    return {
        "temperature_c": near(rng.uniform(-5.0, 33.0), 0.5, -6.0),
        "reply_time_s": 0.0024 + 0.0011 * rng.integers(0, 8, len(since_s)) + near(1e-4, 1e-4, 0.0),
        "motor_a": near(70.0 * rng.beta(1.0, 1.3), 1.0, 0.0),
        "sand_kg": near(34.0 * rng.beta(1.0, 1.5), 0.3, 0.1),
        "wiped_d": near(240.0 * rng.beta(0.8, 1.6), 0.5, 0.5),
        "varnish_um": near(rng.uniform(40.0, 900.0), 5.0, 20.0),
        "tension_kn": near(rng.uniform(1.6, 13.0), 0.05, 1.5),
        "wagon_m": near(0.75 + rng.gamma(1.3, 0.6), 0.02, 0.7),
        "feeder_ka": near(2.4 * rng.beta(1.0, 1.2), 0.03, 0.0),
        "line_v": near(rng.uniform(440.0, 660.0), 1.5, 400.0),
        "sleepers_m": rng.uniform(0.0, 30.0) + 0.7 * since_s + SLEEPER_M * rng.random(len(since_s)),
        "tank_bar": near(rng.uniform(2.5, 8.6), 0.05, 2.0),
        "brake_mg": near(9.0 * rng.beta(1.0, 1.1), 0.1, 0.0),
        "boiler_k": near(rng.uniform(2.0, 60.0), 0.5, 1.0),
        "relay_kpa": near(rng.uniform(0.0, 100.0), 5.0, -6.0),
        "lifted_t": near(16.0 * rng.beta(1.1, 1.1), 0.1, 0.0),
        "frost_mm": near(60.0 * rng.beta(1.0, 1.2), 0.5, 0.0),
    }


def walls_met(one: Floats, other: Floats) -> tuple[Integers, Integers]:
    """Return whether straight ways between ends [n, 3] go through arcade and office, [n] each."""
    way = other - one

    def where(axis: int, at: float) -> Floats:
        along = np.where(np.abs(way[:, axis]) < 1e-9, 1e-9, way[:, axis])
        part = (at - one[:, axis]) / along
        return np.where((part > 0) & (part < 1), one[:, 1 - axis] + part * way[:, 1 - axis], np.nan)

    def within(at: Floats, span: tuple[float, float]) -> NDArray[np.bool_]:
        return np.asarray((at > span[0]) & (at < span[1]))

    along, across = where(1, ARCADE_Y), where(0, OFFICE_X)
    open_ = np.any([within(along, arch) for arch in ARCHES_X], axis=0)
    arcade = within(along, ARCADE_X) & ~open_
    return arcade.astype(np.int64), within(across, OFFICE_Y).astype(np.int64)


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: trams by lot, the likelier low and over their roads.

    Else walls where they meet these; by lot, pillars' concrete, sleepers and boards of trams.
    """
    links = rows.drop_duplicates("link")
    one, other = (links[[f"{end}_{a}_m" for a in "xyz"]].to_numpy(float) for end in ("tx", "rx"))
    long_m, amid = lengths(other - one), 0.5 * (one + other)
    over = np.abs(amid[:, 1, None] - np.array(PARKED_Y)).min(axis=1)
    odds = 0.15 + np.exp(-over / 4.0 - 0.1 * amid[:, 2])
    count = round(IRON[bool(rare)] * len(links))
    iron = {*rng.choice(len(links), count, replace=False, p=odds / odds.sum()).tolist()}
    less = LESS[rare in RARELY]
    by_lot = {
        what: rng.random(len(links)) < less * (0.02 + each * long_m)
        for what, each in (("concrete", 0.005), ("wood", 0.004), ("chipboard", 0.003))
    }
    arcade, office = walls_met(one, other)
    met: dict[str, list[str]] = {}
    for k, link in enumerate(links["link"]):
        some = ["brick"] * int(arcade[k]) + ["glass"] * int(office[k])
        some += [what for what, struck in by_lot.items() if struck[k]]
        met[link] = ["metal"] if k in iron else some
    return [[*met[link]] for link in rows["link"]]
