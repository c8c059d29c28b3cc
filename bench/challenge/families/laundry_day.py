"""A shift of the laundry: which louvres ask which tags, where these are, and what is between.

numpy and pandas alone. At each errand from three to six louvres ask one tag, each with a beat of
its own, which knows nothing of the others'; some of its polls are lost.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.laundry_plan import (
    COURSE,
    DRIERS_M,
    HALL_M,
    KINDS,
    LOUVRES,
    LOUVRES_M,
    PLACES,
    SHIFT_S,
    TAGS,
    THROUGH,
    WASHERS_M,
    Errand,
    led,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
ASKED_BY: Integers = np.repeat(np.arange(3, 7), [7, 6, 6, 5])
"""How many louvres ask on errands."""
OF_ROWS: Integers = np.repeat(np.arange(1, 15), [13, 13, 12, 11, 10, 9, 8, 8, 7, 5, 4, 3, 1, 1])
"""How many rows links have."""
WAITING = 6  # errands whose tag rests
BEAT_S, LOST = (0.29, 0.37), 0.1  # of louvres: from one poll to the next; how many are lost
NEAREST_M = 1.6  # that tags come to louvres
BEHIND_STEEL = {False: 0.17, True: 0.055}  # of links, and where these are rare
RARELY = ("blocked-path", "diffraction")


def worked(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a shift."""
    asked, sizes = rng.permutation(ASKED_BY), rng.permutation(of_rows)
    begins_s = np.sort(rng.uniform(0.0, SHIFT_S, len(asked)))
    rests = rng.permutation(len(asked)) < WAITING
    ends = np.cumsum(asked)
    who = rng.permutation(np.arange(len(asked)) % len(TAGS))
    errands = [
        _errand(rng, f"errand {k}", int(who[k]), sizes[ends[k] - asked[k] : ends[k]],
                (float(begins_s[k]), float(rests[k])))
        for k in range(len(asked))
    ]  # fmt: skip
    hall = {f"room_{axis}_m": long for axis, long in zip("xyz", HALL_M, strict=True)}
    rows = pd.concat(errands, ignore_index=True).assign(channel=5, prf_mhz=64.0, **hall)
    rows["obstacles"] = _between(rng, rows, rare)
    rows["los"] = rows["obstacles"].str.len().eq(0)
    return rows


def _errand(
    rng: np.random.Generator, name: str, who: int, sizes: Integers, begins: tuple[float, float]
) -> pd.DataFrame:
    """Return the rows of one errand, by time; `begins`: when in s, and 1 if the tag rests."""
    begin_s, rests = begins
    which, since_s = _polls(rng, sizes)
    one = _course(rng, KINDS.index(TAGS[who].rstrip("0123456789")))
    one |= {"runs": 1.0 - rests}
    course = {name: np.full(len(which), value) for name, value in one.items()}
    course["into_s"] = rng.uniform(0.05, 0.35) * one["span_s"] + since_s
    course["gap_s"] = np.diff(since_s, prepend=-9.0)
    there = led(course, course["into_s"])
    louvre = _louvres(rng, there, len(sizes))[which]
    ends = {"tx": LOUVRES_M[louvre], "rx": there}
    at = {f"{end}_{a}_m": place[:, k] for end, place in ends.items() for k, a in enumerate("xyz")}
    told = {"azimuth_deg": _bearing(rng, course, ends["tx"]), "time_s": begin_s + since_s}
    return pd.DataFrame(course | at | _logged(rng, there, begin_s) | told).assign(
        tx=[f"louvre{k}" for k in louvre],
        rx=TAGS[who],
        link=[f"{name} via louvre{k}" for k in louvre],
        environment=PLACES[int(one["kind"])],
        true_range_m=np.sqrt(((there - ends["tx"]) ** 2).sum(axis=1)),
    )


def _polls(rng: np.random.Generator, sizes: Integers) -> tuple[Integers, Floats]:
    """Return which louvre asks, and how long after the first poll in s, by time, [sum] each."""
    times = []
    for size in sizes:
        beats = np.cumsum(rng.geometric(1 - LOST, size))
        times.append(rng.uniform(0.0, 1.1) + rng.uniform(*BEAT_S) * beats)
    which, since_s = np.repeat(np.arange(len(sizes)), sizes), np.concatenate(times)
    order = np.argsort(since_s, kind="stable")
    return which[order], since_s[order] - since_s.min()


def _course(rng: np.random.Generator, kind: int) -> dict[str, float]:
    """Return the course of a tag, at up to 2.4 m/s, that stays in the hall."""
    ways = (_bag, _shuttle, _trolley, _folder)
    while True:
        made = dict.fromkeys(COURSE, 0.0) | {"kind": float(kind), "span_s": rng.uniform(10.0, 12.5)}
        made |= ways[kind](rng)
        some = {name: np.full(9, value) for name, value in made.items()} | {"runs": np.ones(9)}
        at = led(some, np.linspace(0.0, 1.0, 9) * made["span_s"])
        near_m = np.sqrt(((at[:, None] - LOUVRES_M) ** 2).sum(axis=2)).min()
        inside = (at[:, :2] > 0.9).all() and (at[:, :2] < np.array(HALL_M[:2]) - 0.9).all()
        if inside and near_m > NEAREST_M:
            return made


def _bag(rng: np.random.Generator) -> dict[str, float]:
    """Return a bag's course along or across the hall."""
    at = {"from_x": rng.uniform(2.0, 44.0), "from_y": rng.uniform(2.0, 26.0)}
    goes = {"toward": float(rng.integers(4)) * np.pi / 2, "rate": rng.uniform(0.9, 2.1)}
    return (
        at | goes | {"from_z": rng.uniform(3.9, 4.8), "lever": rng.uniform(0.9, 2.4),
                     "extra": rng.uniform(0.05, 0.22)}
    )  # fmt: skip


def _shuttle(rng: np.random.Generator) -> dict[str, float]:
    """Return a shuttle's course along washers or driers."""
    at = {"from_x": rng.uniform(5.0, 41.0), "from_y": float(rng.choice([WASHERS_M, DRIERS_M]))}
    goes = {"toward": float(rng.integers(2)) * np.pi, "rate": rng.uniform(7.0, 15.0)}
    return at | goes | {"from_z": rng.uniform(1.6, 3.2), "extra": rng.uniform(0.0, 1.1)}


def _trolley(rng: np.random.Generator) -> dict[str, float]:
    """Return a trolley's course anywhere."""
    at = {"from_x": rng.uniform(3.0, 43.0), "from_y": rng.uniform(3.0, 25.0)}
    tows = {"lever": rng.uniform(-2.2, 2.2), "extra": rng.uniform(1.2, 2.8)}
    goes = {"toward": rng.uniform(0.0, 2 * np.pi), "rate": rng.uniform(0.8, 1.6)}
    return at | tows | goes | {"from_z": rng.uniform(0.8, 1.5)}


def _folder(rng: np.random.Generator) -> dict[str, float]:
    """Return a folder's course round a corner of a table."""
    at = {"from_x": rng.uniform(3.0, 43.0), "from_y": rng.uniform(8.0, 20.0)}
    turns = {"lever": rng.choice([-1.0, 1.0]) * rng.uniform(0.15, 0.8)}
    goes = {"toward": rng.uniform(0.0, 2 * np.pi), "rate": rng.uniform(0.6, 1.25)}
    return at | turns | goes | {"from_z": rng.uniform(0.9, 1.6), "extra": rng.uniform(2.0, 7.0)}


def _bearing(rng: np.random.Generator, course: dict[str, Floats], above: Floats) -> Floats:
    """Return where louvres are from the way that a tag would go, worn anyhow, in degrees [n]."""
    gone = course | {"runs": np.ones(len(above))}
    before, after = (led(gone, course["into_s"] + step) for step in (-0.05, 0.05))
    here = led(course, course["into_s"])
    faces = np.arctan2(*(after - before)[:, 1::-1].T) + np.pi / 7 * rng.integers(14)
    return np.asarray(np.degrees(np.arctan2(*(above - here)[:, 1::-1].T) - faces) % 360.0)


def _louvres(rng: np.random.Generator, there: Floats, count: int) -> Integers:
    """Return which louvres ask a tag [count]: by how long each would take to hear it, by chance."""
    far = np.sqrt(((LOUVRES_M - there.mean(axis=0)) ** 2).sum(axis=1))
    waits = rng.exponential(1.0, LOUVRES) * np.exp(far / 13.0)
    return np.argsort(waits)[:count].astype(np.int64)


def _logged(rng: np.random.Generator, there: Floats, begin_s: float) -> dict[str, Floats]:
    """Return what is logged for each row: warmer by and by, and by driers and below the roof."""
    n, part = len(there), begin_s / SHIFT_S
    drier = np.exp(-(((there[:, 1] - DRIERS_M) / 5.0) ** 2))
    warm_c = 18.0 + 8.0 * -np.expm1(-3.0 * part) + rng.normal(0.0, 1.8) + 9.0 * drier
    reply_s = 0.0115 * np.exp(0.7 * rng.normal(size=n))
    return {
        "temperature_c": warm_c + 0.9 * there[:, 2] + rng.normal(0.0, 1.2, n),
        "reply_time_s": reply_s.clip(0.003, 0.055),
        "lint_g": rng.weibull(1.1) * 9.0 + rng.gamma(1.5, 1.6, n),
        "pile_cm": np.clip(rng.uniform(5.0, 95.0) + rng.normal(0.0, 8.0, n), 2.0, 115.0),
        "press_m": np.clip(rng.uniform(1.2, 8.5) + rng.normal(0.0, 0.5, n), 0.9, 10.0),
        "softener_ml": rng.exponential(11.0) + rng.gamma(1.5, 1.5, n),
        "steam_kgh": np.clip(90.0 * rng.beta(0.9, 0.9) + rng.normal(0.0, 9.0, n), 1.0, 105.0),
        "drum_m": rng.uniform(0.0, 60.0) + np.cumsum(rng.gamma(1.8, 0.19, n)),
        "door_pct": np.clip(100 * rng.beta(0.7, 0.7) + rng.normal(0.0, 13.0, n), 0.0, 100.0),
        "linen_kg": np.clip(rng.uniform(4.0, 62.0) + rng.normal(0.0, 4.0, n), 0.0, 70.0),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: machines of steel by lot, else more than one thing.

    Heaps of linen where ways end low, partitions in the east, pillars on long ways, panes in the
    south-east, where foremen sit.
    """
    errand = Errand(rows, 0, rng)
    first = np.unique(errand.link, return_index=True)[1]
    low, far = errand.there[first, 2], errand.far[first]
    east, south = errand.above[first, 0], errand.above[first, 1]
    seldom = 0.42 if rare in RARELY else 1.0
    odds = {
        "linen": 0.1 + 0.42 / (1 + np.exp((low - 2.2) / 0.5)),
        "plasterboard": 0.05 + 0.3 * (east > 34.0),
        "concrete": 0.02 + 0.19 * far / (far + 12.0),
        "glass": 0.03 + 0.34 * ((east > 34.0) & (south < 6.0)),
    }
    met = [(what, rng.random(len(first)) < seldom * odds[what]) for what in THROUGH]
    steel = rng.permutation(len(first)) < round(BEHIND_STEEL[bool(rare)] * len(first))
    some = [
        ["metal"] if steel[k] else [what for what, there in met if there[k]]
        for k in range(len(first))
    ]
    return [[*some[k]] for k in errand.link]
