"""A night at the lighthouse: which cressets hear whose tag, how often, and what is between.

numpy and pandas alone. In each watch one tag flashes in groups, as lights do that are told apart
by these, and some cressets hear some of its flashes.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.lighthouse_station import (
    CALLINGS,
    COTTAGE_M,
    COURSE,
    CRESSETS,
    CRESSETS_M,
    HAUNTS,
    NIGHT_S,
    OIL_M,
    ROCK_M,
    RUNG_M,
    TAGS,
    TOWER_M,
    clear_m,
    gone_by,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD: Integers = np.repeat([3, 4, 5, 6, 7], [5, 6, 7, 7, 3])
"""How many cressets hear a watch's tag."""
OF_ROWS: Integers = np.repeat(np.arange(1, 11), [18, 22, 23, 21, 17, 14, 10, 6, 4, 2])
"""How many rows links have."""
RESTS = 5  # watches whose tag rests, each of another tag that has one in which it stirs
GROUP, GROUPS, FLASH_S, DARK_S = 3, 4, (0.36, 0.5), 0.7  # flashes; of a night; dark after groups
NEAREST_M, FREE_M, SEEN_S = 1.5, 0.3, 10.6  # to cressets; to sides; until when both are seen to
CARRIES_M = 8.5  # in which odds to be heard fall to 1 / e
SCREENED = {False: 0.16, True: 0.05}  # of links behind iron; where these are rare
FEWER = {False: 1.0, True: 0.4}  # of all else then
RARELY = ("blocked-path", "diffraction")
Drawn = dict[str, float]
Spans = dict[str, tuple[float, float]]


def kept(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a night."""
    order, heard = rng.permutation(len(TAGS)), rng.permutation(HEARD)
    counts = np.split(rng.permutation(of_rows), np.cumsum(heard)[:-1])
    begins_s = np.sort(rng.uniform(0.0, NIGHT_S - 60.0, len(heard)))
    still = rng.permutation(len(TAGS))[:RESTS]
    idle = {*(still + len(TAGS) * rng.integers(0, 2, RESTS)).tolist()}
    made = []
    for k, count in enumerate(counts):
        tag = TAGS[order[k % len(TAGS)]]
        made.append(_watch(rng, k, tag, count, float(begins_s[k]), k not in idle))
    rows = pd.concat(made, ignore_index=True)
    rows["obstacles"] = _between(rng, rows, rare)
    return rows.assign(
        los=rows["obstacles"].map(len).eq(0), channel=2, prf_mhz=64.0,
        room_x_m=ROCK_M[0], room_y_m=ROCK_M[1], room_z_m=ROCK_M[2],
    )  # fmt: skip


def flashes(rng: np.random.Generator, counts: Integers) -> tuple[Integers, Floats]:
    """Return which cressets hear, and when after the first in s, [sum of counts] each.

    All hear flashes of one light, in groups with dark between; each a little later by its turn.
    """
    flash_s, number = rng.uniform(*FLASH_S), np.arange(GROUP * GROUPS)
    lit_s = flash_s * number + DARK_S * (number // GROUP)
    who = np.repeat(np.arange(len(counts)), counts)
    which = [rng.permutation(len(number))[:count] for count in counts.tolist()]
    at_s = lit_s[np.concatenate(which)] + 0.021 * who
    order = np.argsort(at_s, kind="stable")
    return who[order], at_s[order] - at_s.min()


def _watch(
    rng: np.random.Generator, number: int, tag: str, counts: Integers, begin_s: float, stirs: bool
) -> pd.DataFrame:
    """Return the rows of one watch by time, with places of its tag."""
    calling = tag.rstrip("0123456789")
    course = course_of(rng, calling) | {"stirs": float(stirs)}
    into_s = rng.uniform(0.1, 1.6)
    apart = np.linalg.norm(CRESSETS_M - _at(course, np.array([into_s])), axis=1)
    odds = np.exp(-apart / CARRIES_M) + 0.03
    chosen = rng.choice(CRESSETS, len(counts), replace=False, p=odds / odds.sum())
    which, since_s = flashes(rng, counts)
    cresset = chosen[which]
    here, there = _at(course, into_s + since_s), CRESSETS_M[cresset]
    rows = pd.DataFrame({name: np.full(len(which), course[name]) for name in COURSE})
    rows["into_s"] = into_s + since_s
    for end, at in (("tx", here), ("rx", there)):
        rows[[f"{end}_x_m", f"{end}_y_m", f"{end}_z_m"]] = at
    way = there - here
    faces = np.degrees(np.arctan2(way[:, 1], way[:, 0])) - rng.uniform(-180.0, 180.0)
    rows = rows.assign(**_logged(rng, since_s))
    return rows.assign(
        time_s=begin_s + since_s, tx=tag, rx=[f"cresset{k}" for k in cresset],
        environment=HAUNTS[calling], link=[f"watch {number} at cresset{k}" for k in cresset],
        azimuth_deg=(faces + 180.0) % 360.0 - 180.0, true_range_m=np.linalg.norm(way, axis=1),
    )  # fmt: skip


def _at(course: Drawn, into_s: Floats) -> Floats:
    """Return where a tag is some time into its course, in m [n, 3]."""
    return gone_by({name: np.full(len(into_s), one) for name, one in course.items()}, into_s)


BOUNDS: dict[str, Spans] = {
    "keeper": {"heart_x": (3.0, 35.0), "heart_y": (3.0, 24.0), "heart_z": (1.0, 1.7),
               "rate": (0.24, 0.36), "reach": (1.6, 2.6)},
    "tender": {"heart_x": (2.0, 36.0), "heart_y": (2.0, 25.0), "heart_z": (0.5, 1.2),
               "rate": (0.8, 1.3), "reach": (4.0, 9.0), "bend": (-0.4, 0.4)},
    "gull": {"heart_x": (4.0, 34.0), "heart_y": (4.0, 23.0), "heart_z": (4.0, 11.0),
             "rate": (0.4, 0.8), "reach": (0.9, 1.6), "bend": (0.35, 0.5)},
    "hoist": {"heart_x": (5.0, 21.0), "heart_y": (7.0, 21.0), "heart_z": (0.6, 5.0),
              "rate": (0.5, 0.8), "reach": (0.4, 0.7)},
    "lens": {"heart_x": (11.8, 12.2), "heart_y": (13.8, 14.2), "heart_z": (10.4, 12.6),
             "rate": (0.3, 0.42), "reach": (1.3, 2.1)},
    "donkey": {"heart_x": (4.0, 34.0), "heart_y": (4.0, 23.0), "heart_z": (0.8, 1.3),
               "rate": (0.22, 0.34), "reach": (2.2, 3.4), "bend": (0.08, 0.2)},
}  # fmt: skip
"""Between which values courses of each calling are drawn evenly; see what has tags go."""


def course_of(rng: np.random.Generator, calling: str) -> Drawn:
    """Return the course of a tag that keeps off cressets, sides and the oil tank."""
    seen_s = np.linspace(0.0, SEEN_S, 107)
    for _ in range(20_000):
        made = dict.fromkeys(COURSE, 0.0) | {"calling": float([*CALLINGS].index(calling))}
        made |= {name: float(rng.uniform(*span)) for name, span in BOUNDS[calling].items()}
        made |= {name: float(rng.uniform(-np.pi, np.pi)) for name in ("heads", "phase")}
        at = _at(made | {"stirs": 1.0}, seen_s)
        near = np.linalg.norm(at[:, None] - CRESSETS_M, axis=2).min()
        if clear_m(at).min() > FREE_M and near > NEAREST_M:
            return made
    raise AssertionError(calling)


def _logged(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is logged beside each row of a watch, [n] each."""
    count = len(since_s)

    def about(one: float, by: float, low: float, high: float) -> Floats:
        return np.asarray((one + by * rng.triangular(-1.0, 0.0, 1.0, count)).clip(low, high))

    return {
        "temperature_c": about(rng.uniform(-4.0, 31.0), 0.4, -5.0, 32.0),
        "reply_time_s": 0.0026 + 0.0012 * rng.integers(0, 7, count) + 0.0002 * rng.random(count),
        "arc_a": about(60.0 * rng.beta(1.0, 1.2), 0.8, 0.0, 62.0),
        "salt_g": about(28.0 * rng.beta(1.0, 1.5), 0.3, 0.1, 29.0),
        "green_d": about(300.0 * rng.beta(0.8, 1.5), 1.0, 1.0, 305.0),
        "guano_mm": about(rng.uniform(0.5, 15.0), 0.1, 0.3, 15.5),
        "mercury_kg": about(rng.uniform(5.0, 160.0), 0.6, 3.0, 162.0),
        "boom_m": about(0.7 + rng.gamma(1.4, 0.6), 0.02, 0.65, 5.0),
        "swell_m": about(4.0 * rng.beta(1.0, 1.2), 0.05, 0.0, 4.2),
        "siren_kpa": about(rng.uniform(120.0, 300.0), 1.0, 115.0, 305.0),
        "ladder_m": rng.uniform(0.0, 20.0) + 0.5 * since_s + RUNG_M * rng.random(count),
        "sight_km": about(rng.uniform(0.5, 14.0), 0.1, 0.3, 14.5),
        "spray_mg": about(11.0 * rng.beta(1.0, 1.1), 0.1, 0.0, 11.5),
        "draught_k": about(rng.uniform(1.0, 24.0), 0.2, 0.0, 25.0),
        "well_mm": about(rng.uniform(0.0, 90.0), 4.0, -5.0, 96.0),
        "gale_m_s": about(27.0 * rng.beta(1.1, 1.1), 0.5, 0.0, 28.0),
        "tide_m": about(rng.uniform(-2.4, 2.4), 0.05, -2.6, 2.6),
    }


def walls_met(one: Floats, other: Floats) -> tuple[Integers, Integers, Integers]:
    """Return how often straight ways between ends [n, 3] go through walls, [n] each.

    Of the tower; of the cottage, but that to the sea; and of that, which is all window.
    """
    way = np.where(np.abs(other - one) < 1e-9, 1e-9, other - one)[:, :2]
    off = one[:, :2] - np.array(TOWER_M[:2])
    square, half = (way**2).sum(axis=1), (off * way).sum(axis=1)
    root = half**2 - square * ((off**2).sum(axis=1) - TOWER_M[2] ** 2)
    parts = (-half[:, None] + np.sqrt(root.clip(0.0))[:, None] * [-1.0, 1.0]) / square[:, None]
    tower = (((parts > 0) & (parts < 1)).sum(axis=1) * (root > 0)).astype(np.int64)

    def crossed(axis: int, corner: int) -> Integers:
        part = (COTTAGE_M[corner, axis] - one[:, axis]) / way[:, axis]
        along = one[:, 1 - axis] + part.clip(0.0, 1.0) * way[:, 1 - axis]
        low, high = COTTAGE_M[:, 1 - axis]
        return np.asarray((part > 0) & (part < 1) & (along > low) & (along < high), np.int64)

    return tower, crossed(0, 0) + crossed(1, 0) + crossed(1, 1), crossed(0, 1)


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: iron by lot, the likelier low and by the oil tank.

    Else walls where they meet these; by lot, rocks' concrete, planks and boards of boats, the
    likelier the longer.
    """
    links = rows.groupby("link", sort=False).first()
    one, other = (links[[f"{end}_{a}_m" for a in "xyz"]].to_numpy(float) for end in ("tx", "rx"))
    amid, long_m = 0.5 * (one + other), np.linalg.norm(other - one, axis=1)
    lots = np.exp(-np.hypot(*(amid[:, :2] - np.array(OIL_M[:2])).T) / 12.0 - 0.08 * amid[:, 2])
    lots += 0.2
    iron = rng.choice(len(links), round(SCREENED[bool(rare)] * len(links)), replace=False,
                      p=lots / lots.sum())  # fmt: skip
    tower, cottage, window = walls_met(one, other)
    by_lot = {"concrete": 0.02 + 0.005 * long_m, "wood": 0.02 + 0.004 * long_m,
              "chipboard": 0.02 + 0.003 * long_m}  # fmt: skip
    struck = {what: rng.random(len(links)) < FEWER[rare in RARELY] * odds
              for what, odds in by_lot.items()}  # fmt: skip
    met: dict[str, list[str]] = {}
    for k, link in enumerate(links.index):
        some = ["brick"] * int(tower[k] + cottage[k]) + ["glass"] * int(window[k])
        some += [what for what, there in struck.items() if there[k]]
        met[link] = ["metal"] if k in iron else some
    return [[*met[link]] for link in rows["link"]]
