"""A day at the distillery: whose run it is, which lintels drip answers, and what is between.

numpy and pandas alone. In each run one tag is heard by some lintels, each of which answers by a
drip of its own: so often, from some time on, as spirit drips from worms that are not alike.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.distillery_house import (
    COURSE,
    DAY_S,
    INNER_M,
    KINDS,
    LINTELS,
    LINTELS_M,
    PLACES,
    POTS_M,
    ROOM_M,
    TAGS,
    indoors_m,
    taken,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD: Integers = np.repeat([2, 4, 5, 6, 7, 9], [2, 7, 6, 5, 3, 2])
"""How many lintels hear a run's tag."""
OF_ROWS: Integers = np.repeat(np.arange(1, 11), [16, 19, 20, 19, 17, 14, 11, 8, 5, 2])
"""How many rows links have."""
RESTS = 6  # runs whose tag rests, each of another tag that has one in which it goes
DRIP_S, UNEVEN, WITHIN_S = (0.24, 0.42), 0.2, 4.6  # between drips; of that; a run's length
NEAREST_M, FREE_M, SEEN_S = 1.5, 0.32, 7.2  # to lintels; to sides; until when both are seen to
HEARS_M = 14.0  # over which a lintel is heard less often, to 1 / e
THROUGH = ("wood", "plywood", "glass")
"""Casks, bins of the barn, the spirit safe and sashes; brick is where the corner is cut."""
COPPER = {False: 0.145, True: 0.055}  # of links behind a still; where these are rare
RARELY = ("blocked-path", "diffraction")
Drawn = dict[str, float]


def worked(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    heard, lengths = rng.permutation(HEARD), [*rng.permutation(of_rows)]
    begins_s = np.sort(rng.uniform(0.0, DAY_S - 12.0, len(heard)))
    tags = rng.permutation(len(TAGS))
    twice = rng.permutation(np.arange(len(TAGS), len(heard)))[:RESTS]
    rests = twice - len(TAGS) * rng.integers(0, 2, RESTS)
    runs = []
    for number, count in enumerate(heard.tolist()):
        own, lengths = np.array(lengths[:count], np.int64), lengths[count:]
        tag = TAGS[tags[number % len(TAGS)]]
        runs.append(_run(rng, number, tag, own, begins_s[number], number not in rests))
    rows = pd.concat(runs, ignore_index=True)
    rows["obstacles"] = _between(rng, rows, rare)
    return rows.assign(
        los=[not some for some in rows["obstacles"]],
        channel=5, prf_mhz=64.0,
        room_x_m=ROOM_M[0], room_y_m=ROOM_M[1], room_z_m=ROOM_M[2],
    )  # fmt: skip


def drips(rng: np.random.Generator, lengths: Integers) -> tuple[Integers, Floats]:
    """Return which of the lintels answers, and when after the first in s [sum of lengths].

    By time; each has a pace of its own, from which it strays a little.
    """
    who, at_s = [], []
    for lintel, count in enumerate(lengths.tolist()):
        pace = rng.uniform(*DRIP_S)
        begin = rng.uniform(0.0, max(WITHIN_S - count * pace, 0.3))
        at_s.append(begin + pace * (np.arange(count) + UNEVEN * rng.random(count)))
        who.append(np.full(count, lintel))
    every = np.concatenate(at_s)
    order = np.argsort(every)
    return np.concatenate(who)[order], every[order] - every.min()


def _run(
    rng: np.random.Generator, number: int, tag: str, lengths: Integers, begin_s: float, goes: bool
) -> pd.DataFrame:
    """Return the rows of one run by time, with places of its tag."""
    kind = tag.rstrip("0123456789")
    course = course_of(rng, kind) | {"goes": float(goes)}
    begun = rng.uniform(0.1, 2.1)
    away = np.linalg.norm(LINTELS_M - _seen(course, np.array([begun])), axis=1)
    odds = np.exp(-away / HEARS_M)
    lintels = rng.choice(LINTELS, len(lengths), replace=False, p=odds / odds.sum())
    which, since_s = drips(rng, lengths)
    tag_m, there_m = _seen(course, begun + since_s), LINTELS_M[lintels[which]]
    known = {name: np.full(len(which), course[name]) for name in COURSE}
    known["into_s"] = begun + since_s
    for end, at in (("tx", tag_m), ("rx", there_m)):
        known |= {f"{end}_{axis}_m": at[:, k] for k, axis in enumerate("xyz")}
    way = there_m - tag_m
    heading = np.degrees(np.arctan2(way[:, 1], way[:, 0])) + rng.uniform(-180.0, 180.0)
    return pd.DataFrame(known | _noted(rng, since_s)).assign(
        time_s=begin_s + since_s, tx=tag, environment=PLACES[kind],
        rx=[f"lintel{k}" for k in lintels[which]],
        link=[f"run {number} over lintel{k}" for k in lintels[which]],
        azimuth_deg=(heading + 180.0) % 360.0 - 180.0,
        true_range_m=np.linalg.norm(way, axis=1),
    )  # fmt: skip


def _seen(course: Drawn, into_s: Floats) -> Floats:
    """Return where a tag is some time into its course, in m [n, 3]."""
    return taken({name: np.full(len(into_s), one) for name, one in course.items()}, into_s)


def course_of(rng: np.random.Generator, kind: str) -> Drawn:
    """Return the course of a tag that keeps off lintels and sides."""
    seen_s = np.arange(0.0, SEEN_S, 0.08)
    for _ in range(10_000):
        made = dict.fromkeys(COURSE, 0.0) | {"goes": 1.0, "sort": float([*KINDS].index(kind))}
        made |= {"phase": rng.uniform(-np.pi, np.pi)} | BEGINS[kind](rng)
        at = _seen(made, seen_s)
        nearest = np.linalg.norm(at[:, None] - LINTELS_M, axis=2).min()
        if nearest > NEAREST_M and indoors_m(at).min() > FREE_M:
            return made
    raise AssertionError(kind)


def _either(rng: np.random.Generator, low: float, high: float) -> float:
    return float(rng.choice([-1.0, 1.0]) * rng.uniform(low, high))


def _cask(rng: np.random.Generator) -> Drawn:
    return {"at_x": rng.uniform(1.0, 19.0), "at_y": rng.uniform(1.0, 9.0), "at_z": 0.95,
            "aim": rng.choice([0.0, 0.5 * np.pi]) + rng.normal(0.0, 0.1),
            "pace": _either(rng, 0.5, 1.0), "wide": rng.uniform(0.42, 0.52),
            "small": rng.uniform(0.08, 0.2)}  # fmt: skip


def _rummager(rng: np.random.Generator) -> Drawn:
    pot = POTS_M[rng.integers(5)]
    return {"at_x": pot[0], "at_y": pot[1], "at_z": rng.uniform(1.0, 2.2),
            "aim": rng.uniform(-np.pi, np.pi), "pace": _either(rng, 0.3, 0.6),
            "wide": rng.uniform(1.1, 2.0), "small": rng.uniform(0.1, 0.25)}  # fmt: skip


def _maltman(rng: np.random.Generator) -> Drawn:
    return {"at_x": rng.uniform(1.0, 20.0), "at_y": rng.uniform(2.5, 7.5),
            "at_z": rng.uniform(1.1, 1.5), "aim": rng.choice([0.0, np.pi]),
            "pace": rng.uniform(0.45, 0.75), "wide": rng.uniform(1.2, 2.2),
            "small": rng.uniform(0.05, 0.3)}  # fmt: skip


def _dray(rng: np.random.Generator) -> Drawn:
    return {"at_x": rng.uniform(1.0, 33.0), "at_y": rng.uniform(2.0, 8.0),
            "at_z": rng.uniform(1.2, 2.2), "aim": rng.choice([0.0, np.pi]) + rng.normal(0.0, 0.12),
            "pace": rng.uniform(0.5, 1.3), "small": rng.uniform(-0.05, 0.25)}  # fmt: skip


def _hoist(rng: np.random.Generator) -> Drawn:
    rise = rng.uniform(3.0, 6.0) * rng.choice([-1.0, 1.0])
    return {"at_x": rng.uniform(21.0, 33.0), "at_y": rng.uniform(1.0, 23.0),
            "at_z": rng.uniform(1.0, 3.2) if rise > 0 else rng.uniform(5.5, 8.5),
            "aim": rng.uniform(-np.pi, np.pi), "pace": rng.uniform(0.1, 0.4),
            "wide": rise, "small": rng.uniform(3.5, 6.0)}  # fmt: skip


def _cat(rng: np.random.Generator) -> Drawn:
    return {"at_x": rng.uniform(3.0, 31.0), "at_y": rng.uniform(2.0, 20.0),
            "at_z": rng.uniform(0.5, 1.2), "pace": _either(rng, 0.25, 0.5),
            "wide": rng.uniform(1.6, 3.6), "small": rng.uniform(0.03, 0.07)}  # fmt: skip


BEGINS: dict[str, Callable[[np.random.Generator], Drawn]] = dict(
    zip(KINDS, (_cask, _rummager, _maltman, _dray, _hoist, _cat), strict=True)
)


def _noted(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is written down beside each row of a run, [n] each."""
    count = len(since_s)

    def about(one: float, by: float, low: float, high: float) -> Floats:
        return np.asarray(np.clip(one + by * rng.standard_normal(count), low, high))

    return {
        "temperature_c": about(rng.uniform(5.0, 38.0), 0.2, 4.0, 39.0),
        "reply_time_s": 0.004 + 0.011 * np.sqrt(rng.random(count)),
        "boiler_kw": about(24.0 * rng.beta(1.0, 1.6), 0.3, 0.0, 25.0),
        "reek_ppm": about(55.0 * rng.beta(0.9, 1.5), 0.4, 0.2, 56.0),
        "cask_years": about(30.0 * rng.beta(0.9, 1.3), 0.1, 0.1, 31.0),
        "worm_c": about(rng.uniform(8.0, 58.0), 0.5, 6.0, 60.0),
        "steep_h": about(rng.uniform(0.5, 60.0), 0.2, 0.2, 61.0),
        "smith_m": about(0.8 + rng.gamma(1.2, 0.7), 0.02, 0.75, 5.0),
        "draff_t": about(9.0 * rng.beta(1.0, 1.2), 0.05, 0.0, 9.2),
        "froth_h": about(rng.uniform(0.0, 54.0), 0.2, 0.0, 54.0),
        "raked_m": rng.uniform(0.0, 50.0) + 0.9 * since_s + 0.47 * rng.random(count),
        "steam_bar": about(rng.uniform(1.3, 3.2), 0.03, 1.2, 3.4),
        "vapour_pct": about(12.0 * rng.beta(1.1, 1.4), 0.05, 0.0, 12.5),
        "loft_t": about(rng.uniform(0.0, 40.0), 0.1, 0.0, 40.5),
    }


def cuts_the_corner(one: Floats, other: Floats) -> NDArray[np.bool_]:
    """Return whether straight ways between ends [n, 3] go outside of the L [n].

    They do where the inner corner is to the one side of a way and the L's outer one is too.
    """
    part = np.linspace(0.0, 1.0, 120)[:, None, None]
    at = one[:, :2] + part * (other[:, :2] - one[:, :2])
    return np.asarray(((at[..., 0] < INNER_M[0]) & (at[..., 1] > INNER_M[1])).any(axis=0))


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: copper by lot, the likelier the nearer to a pot.

    Else brick where the corner is cut, casks the more the longer ways are, bins where they are
    low, glass in the still house.
    """
    one = rows.drop_duplicates("link")
    ends = [one[[f"{end}_{a}_m" for a in "xyz"]].to_numpy(np.float64) for end in ("tx", "rx")]
    middle, long_m = 0.5 * (ends[0] + ends[1]), np.linalg.norm(ends[0] - ends[1], axis=1)
    pot_m = np.linalg.norm(middle[:, None, :2] - POTS_M[:, :2], axis=2).min(axis=1)
    weigh = 1 / (1 + (pot_m / 3.0) ** 2)
    copper = rng.choice(
        len(one), round(COPPER[bool(rare)] * len(one)), replace=False, p=weigh / weigh.sum()
    )
    odds = np.column_stack([
        0.04 + 0.014 * long_m, 0.05 + 0.4 * (middle[:, 2] < 2.6),
        0.06 + 0.22 * (middle[:, 0] > INNER_M[0]),
    ])  # fmt: skip
    met = rng.random(odds.shape) < odds * (0.4 if rare in RARELY else 1.0)
    wall, some = cuts_the_corner(*ends), {}
    for k, link in enumerate(one["link"]):
        own = (["brick"] if wall[k] else []) + [THROUGH[j] for j in np.flatnonzero(met[k])]
        some[link] = ["metal"] if k in copper else own
    return [list(some[link]) for link in rows["link"]]
