"""A feast at the cathedral: who calls in which office, when, and what is between.

numpy and pandas alone. In each office one tag calls some bosses, round after round: in each round
all of them have their turn, in an order that is changed as bells are, by a plain hunt.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.cathedral_nave import (
    BOSSES,
    BOSSES_M,
    COURSE,
    FEAST_S,
    KINDS,
    PLACES,
    ROOM_M,
    TAGS,
    borne,
    clear_m,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
CHANGES: Integers = np.repeat(np.arange(3, 9), [7, 5, 5, 4, 3, 2])
"""How many bosses an office's tag calls."""
OF_ROWS: Integers = np.repeat(np.arange(1, 10), [17, 18, 19, 18, 16, 14, 12, 8, 5])
"""How many rows links have."""
RESTS = 6  # offices whose tag rests
ROUNDS, ROUND_S = 13, 0.33  # in an office
NEAREST_M, FREE_M, SEEN_S = 1.6, 0.3, 7.5  # to bosses; to sides; until when both are seen to
HEARS_M = 9.0  # within which a boss is called half as often as close by
THROUGH = ("wood", "brick", "glass", "concrete")
"""Stalls and pews, piers, a screen of glass at the porch, the pulpitum."""
METAL = {False: 0.15, True: 0.055}  # of links behind the choir's gate; where these are rare
RARELY = ("blocked-path", "diffraction")
Drawn = dict[str, float]


def held(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a feast."""
    count = rng.permutation(CHANGES)
    lengths = np.split(rng.permutation(of_rows), np.cumsum(count)[:-1])
    every = np.resize(rng.permutation(len(TAGS)), len(count))
    still = np.isin(np.arange(len(count)), rng.choice(len(count), RESTS, replace=False))
    begin_s = np.sort(rng.random(len(count))) * (FEAST_S - 9.0)
    offices = [
        _office(rng, k, TAGS[every[k]], lengths[k], begin_s[k], not still[k])
        for k in range(len(count))
    ]
    rows = pd.concat(offices, ignore_index=True)
    rows["obstacles"] = _between(rng, rows, rare)
    rows["los"] = ~rows["obstacles"].map(bool)
    rows["channel"], rows["prf_mhz"] = 2, 64.0
    return rows.assign(room_x_m=ROOM_M[0], room_y_m=ROOM_M[1], room_z_m=ROOM_M[2])


def _office(
    rng: np.random.Generator, number: int, tag: str, lengths: Integers, begin_s: float, goes: bool
) -> pd.DataFrame:
    """Return the rows of one office by time, with places of its tag."""
    kind = tag.rstrip("0123456789")
    course = course_of(rng, kind) | {"goes": float(goes)}
    into_s = rng.uniform(0.1, 2.2)
    near = np.linalg.norm(BOSSES_M - _along(course, np.array([into_s]))[0], axis=1)
    odds = 1 / (1 + (near / HEARS_M) ** 2)
    called = rng.choice(BOSSES, len(lengths), replace=False, p=odds / odds.sum())
    turn, since_s = rung_in_changes(rng, lengths)
    boss = called[turn]
    made = pd.DataFrame({name: np.full(len(boss), course[name]) for name in COURSE})
    made["into_s"] = into_s + since_s
    tag_m, boss_m = _along(course, into_s + since_s), BOSSES_M[boss]
    for k, axis in enumerate("xyz"):
        made[f"tx_{axis}_m"], made[f"rx_{axis}_m"] = tag_m[:, k], boss_m[:, k]
    run = boss_m - tag_m
    bears = np.degrees(np.arctan2(run[:, 1], run[:, 0])) - rng.uniform(0.0, 360.0)
    return made.assign(
        time_s=begin_s + since_s,
        tx=tag,
        rx=[f"boss{k}" for k in boss],
        link=[f"office {number} at boss{k}" for k in boss],
        environment=PLACES[kind],
        azimuth_deg=180.0 - (180.0 - bears) % 360.0,
        true_range_m=np.sqrt((run**2).sum(axis=1)),
        **_noted(rng, since_s),
    )


def hunted(bells: int, rounds: int) -> Integers:
    """Return the order of bells in each round, by a plain hunt [rounds, bells].

    In turn all pairs from the first place on change, and all from the second on.
    """
    rows = [np.arange(bells)]
    for k in range(rounds - 1):
        row = rows[-1].copy()
        for place in range(k % 2, bells - 1, 2):
            row[[place, place + 1]] = row[[place + 1, place]]
        rows.append(row)
    return np.array(rows, np.int64)


def rung_in_changes(rng: np.random.Generator, lengths: Integers) -> tuple[Integers, Floats]:
    """Return which of the bosses called, and when after the first, in s, [sum of lengths] by time.

    Each answers so many rounds on end.
    """
    order = hunted(len(lengths), ROUNDS)
    begins = rng.integers(0, ROUNDS + 1 - lengths)
    since = np.arange(ROUNDS)[:, None] - begins[order]
    there = (since >= 0) & (since < lengths[order])
    at_s = ROUND_S * (np.arange(ROUNDS)[:, None] + np.arange(len(lengths)) / len(lengths))
    return order[there], at_s[there] - at_s[there].min()


def _along(course: Drawn, into_s: Floats) -> Floats:
    """Return where a tag is some time into its course, in m [n, 3]."""
    return borne({name: np.full(len(into_s), one) for name, one in course.items()}, into_s)


def course_of(rng: np.random.Generator, kind: str) -> Drawn:
    """Return the course of a tag that keeps off bosses and sides."""
    seen_s = np.linspace(0.0, SEEN_S, 90)
    blank = dict.fromkeys(COURSE, 0.0) | {"goes": 1.0, "gait": float([*KINDS].index(kind))}
    for _ in range(10_000):
        made = blank | BEGINS[kind](rng)
        at = _along(made, seen_s)
        off = np.linalg.norm(at[:, None] - BOSSES_M, axis=2)
        if off.min() > NEAREST_M and clear_m(at).min() > FREE_M:
            return made
    raise AssertionError(kind)


def _censer(rng: np.random.Generator) -> Drawn:
    rope = rng.uniform(6.2, 8.6)
    return {"mid_x": rng.uniform(25.0, 27.0), "mid_y": rng.uniform(12.0, 14.0), "reach": rope,
            "lift": rope + rng.uniform(1.2, 2.0), "broad": rng.uniform(0.25, 0.6),
            "turn": rng.normal(0.5 * np.pi, 0.3), "tempo": rng.uniform(-np.pi, np.pi)}  # fmt: skip


def _verger(rng: np.random.Generator) -> Drawn:
    return {"mid_x": rng.uniform(1.5, 36.0), "mid_y": rng.uniform(8.5, 17.5),
            "lift": rng.uniform(1.0, 1.5), "turn": rng.uniform(-np.pi, np.pi),
            "tempo": rng.choice([-1.0, 1.0]) * rng.uniform(0.8, 1.5)}  # fmt: skip


def _dove(rng: np.random.Generator) -> Drawn:
    return {"mid_x": rng.uniform(5.0, 33.0), "mid_y": rng.uniform(12.0, 14.0),
            "lift": rng.uniform(5.0, 10.5), "reach": rng.uniform(1.8, 4.2),
            "broad": rng.uniform(1.5, 3.2), "turn": rng.uniform(-np.pi, np.pi),
            "tempo": rng.choice([-1.0, 1.0]) * rng.uniform(0.35, 0.65)}  # fmt: skip


def _pilgrim(rng: np.random.Generator) -> Drawn:
    ring = 1.0 + 0.4 * rng.integers(0, 11)
    return {"mid_x": 9.4, "mid_y": 13.0, "lift": rng.uniform(0.8, 1.4), "reach": ring,
            "broad": rng.uniform(1.2, 2.6), "turn": rng.uniform(-np.pi, np.pi),
            "tempo": rng.choice([-1.0, 1.0]) * rng.uniform(0.7, 1.3) / ring}  # fmt: skip


def _mason(rng: np.random.Generator) -> Drawn:
    return {"mid_x": rng.uniform(2.0, 36.0), "mid_y": float(rng.choice([7.9, 18.1])),
            "lift": rng.uniform(1.0, 12.0), "turn": rng.uniform(-np.pi, np.pi),
            "tempo": rng.choice([-1.0, 1.0]) * rng.uniform(0.35, 0.8)}  # fmt: skip


def _chorister(rng: np.random.Generator) -> Drawn:
    long = rng.uniform(3.5, 8.5)
    return {"mid_x": rng.uniform(10.0, 29.0), "mid_y": rng.uniform(12.4, 13.6),
            "lift": rng.uniform(0.9, 1.4), "reach": long, "broad": rng.uniform(2.2, 4.6),
            "turn": rng.uniform(-np.pi, np.pi),
            "tempo": rng.choice([-1.0, 1.0]) * rng.uniform(0.9, 1.6) / long}  # fmt: skip


BEGINS: dict[str, Callable[[np.random.Generator], Drawn]] = {
    "censer": _censer, "verger": _verger, "dove": _dove, "pilgrim": _pilgrim, "mason": _mason,
    "chorister": _chorister,
}  # fmt: skip


def _noted(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is noted for each row [n], of which most is an office's, but for a little.

    `paced_m` is how far along the flags a tag says it has come, `stand_m` how far off candlestands
    are.
    """
    rows = len(since_s)

    def near(one: float, by: float, low: float, high: float) -> Floats:
        return np.asarray((one + by * rng.uniform(-1.7, 1.7, rows)).clip(low, high))

    return {
        "temperature_c": near(rng.uniform(3.0, 33.0), 0.25, 2.0, 34.0),
        "reply_time_s": 0.0045 + 0.0095 * rng.beta(2.0, 1.3, rows),
        "organ_kw": near(14.0 * rng.beta(1.1, 1.9), 0.2, 0.0, 15.0),
        "wax_mm": near(rng.gamma(1.1, 6.0), 0.1, 0.0, 28.0),
        "incense_g": near(70.0 * rng.beta(0.8, 1.6), 0.6, 0.4, 72.0),
        "stand_m": near(0.65 + rng.gamma(1.3, 0.6), 0.02, 0.6, 4.0),
        "hassocks": rng.binomial(48, rng.beta(0.9, 1.6), rows).astype(np.float64),
        "stoked_min": near(1.0, 0.04, 0.9, 1.1) * 10 ** rng.uniform(-0.2, 2.2),
        "damp_pct": near(rng.uniform(8.0, 97.0), 0.8, 5.0, 99.0),
        "paced_m": rng.uniform(0.0, 60.0) + 1.1 * since_s + 0.5 * rng.random(rows),
        "wind_mm": near(rng.uniform(44.0, 74.0), 0.4, 42.0, 76.0),
        "candles": near(float(rng.integers(0, 240)), 1.0, 0.0, 242.0).round(),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: the choir's gate of iron by lot, or else some things.

    Stalls the more the lower ways are, piers the longer these are across the nave, the pulpitum
    where ways pass the crossing's east side, glass by the porch at the west.
    """
    one = rows.groupby("link", sort=False).first()
    run = (one["tx_x_m"] - one["rx_x_m"]).abs(), (one["tx_y_m"] - one["rx_y_m"]).abs()
    low = np.exp(-(one["tx_z_m"] + one["rx_z_m"]) / 7.0)
    passes = (one["tx_x_m"] - 30.0) * (one["rx_x_m"] - 30.0) < 0
    west = one[["tx_x_m", "rx_x_m"]].min(axis=1) < 6.0
    odds = np.column_stack([0.04 + 0.55 * low, 0.04 + 0.016 * run[1] + 0.004 * run[0],
                            0.06 + 0.3 * west, 0.06 + 0.42 * passes])  # fmt: skip
    met = rng.random(odds.shape) < odds * (0.4 if rare in RARELY else 1.0)
    gate = np.zeros(len(one), np.bool_)
    gate[rng.choice(len(one), round(METAL[bool(rare)] * len(one)), replace=False)] = True
    some = {
        name: ["metal"] if iron else [THROUGH[k] for k in np.flatnonzero(own)]
        for name, iron, own in zip(one.index, gate, met, strict=True)
    }
    return [list(some[name]) for name in rows["link"]]
