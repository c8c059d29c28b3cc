"""A day of harvest at the granary: who is ranged in which load, when, and what is between.

numpy and pandas alone. In each load one tag is heard by some spouts, which contend for slots: who
answers in a slot alone is heard, and those that answer in one together wait up to twice as long
before they try again, as stations on one cable do (Metcalfe and Boggs 1976).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.granary_bins import (
    BIN_M,
    BINS_M,
    COURSE,
    DAY_S,
    HALL_M,
    KINDS,
    PLACES,
    SPOUTS,
    SPOUTS_M,
    TAGS,
    shifted,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat(np.arange(2, 8), [3, 5, 6, 6, 5, 2])
"""By how many spouts a load's tag is heard."""
OF_ROWS: Integers = np.repeat(np.arange(1, 13), [15, 16, 16, 15, 13, 11, 9, 8, 6, 4, 3, 3])
"""How many rows links have."""
STILL = 6  # loads whose tag rests
SLOT_S, RESTS = 0.0115, 6  # how long a slot is; slots that a spout rests that was heard
SHORTEST, LONGEST = 4, 32  # slots within which spouts answer: at first, and at most
NEAREST_M, LASTS_S = 3.0, 2.6  # that tags come to spouts; until when they are looked at
LIKELY_M = 17.0  # by which spouts are e times less likely to hear a tag
THROUGH = ("concrete", "wood", "plywood", "brick")
"""Staves of round bins, piled boxes, hoppers, the bays of the flat store."""
BEHIND_LORRIES = {False: 0.16, True: 0.055}  # of links, and where these are rare
RARELY = ("blocked-path", "diffraction")


def harvested(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    heard_by = rng.permutation(HEARD_BY)
    lots = np.split(rng.permutation(of_rows), np.cumsum(heard_by)[:-1])
    tags = rng.permutation(np.resize(np.arange(len(TAGS)), len(lots)))
    begins_s = np.sort(rng.uniform(0.002, 0.998, len(lots))) * DAY_S
    runs = rng.permutation(np.arange(len(lots)) >= STILL).astype(np.float64)
    loads = []
    for number, lot in enumerate(lots):
        one = _load(rng, number, TAGS[tags[number]], lot, runs[number])
        loads.append(one.assign(time_s=one["time_s"] + begins_s[number]))
    rows = pd.concat(loads, ignore_index=True)
    rows["obstacles"] = _between(rng, rows, rare)
    room = dict(zip(("room_x_m", "room_y_m", "room_z_m"), HALL_M, strict=True))
    free = rows["obstacles"].str.len().eq(0)
    return rows.assign(los=free, channel=4, prf_mhz=64.0, **room)


def _load(
    rng: np.random.Generator, number: int, tag: str, lengths: Integers, runs: float
) -> pd.DataFrame:
    """Return the rows of one load by time, with places of its tag."""
    kind = tag.rstrip("0123456789")
    course = _course(rng, kind, tag) | {"runs": runs, "into_s": rng.uniform(0.15, 0.9)}
    spouts = _hearing(rng, _places(course, np.zeros(1))[0], len(lengths))
    which, since_s = contended(rng, lengths)
    there, spout = _places(course, since_s), spouts[which]
    way = SPOUTS_M[spout] - there
    made = {name: np.full(len(which), course[name]) for name in COURSE}
    made |= {"into_s": course["into_s"] + since_s, "time_s": since_s}
    for k, axis in enumerate("xyz"):
        made |= {f"tx_{axis}_m": there[:, k], f"rx_{axis}_m": SPOUTS_M[spout, k]}
    faces = rng.uniform(0.0, 360.0)
    return pd.DataFrame(made | _noted(rng, since_s)).assign(
        tx=tag,
        rx=[f"spout{k}" for k in spout],
        link=[f"load {number} at spout{k}" for k in spout],
        environment=PLACES[kind],
        azimuth_deg=(np.degrees(np.arctan2(way[:, 1], way[:, 0])) - faces) % 360.0,
        true_range_m=np.sqrt((way**2).sum(axis=1)),
    )


def _places(course: dict[str, float], since_s: Floats) -> Floats:
    """Return where a tag is some time after a load began, in m [n, 3]."""
    all_ = {name: np.full(len(since_s), course[name]) for name in COURSE}
    return shifted(all_, course["into_s"] + since_s)


def contended(rng: np.random.Generator, lengths: Integers) -> tuple[Integers, Floats]:
    """Return which of a load's spouts is heard, and when after the first, in s, by time [sum].

    `lengths`: how many times each spout is heard.
    """
    left, within = lengths.copy(), np.full(len(lengths), SHORTEST)
    due = rng.integers(0, within)
    heard: list[tuple[int, int]] = []
    for slot in range(10_000):
        ready = np.flatnonzero((left > 0) & (due == slot))
        alone = len(ready) == 1
        within[ready] = SHORTEST if alone else np.minimum(2 * within[ready], LONGEST)
        due[ready] = slot + 1 + RESTS * alone + rng.integers(0, within[ready])
        if alone:
            left[ready] -= 1
            heard.append((int(ready[0]), slot))
        if not left.any():
            break
    which, slots = np.array(heard, np.int64).T
    return which, SLOT_S * (slots - slots[0])


def _hearing(rng: np.random.Generator, at: Floats, count: int) -> Integers:
    """Return so many spouts that hear a tag in a place, near ones the more likely.

    Each waits for a chance of its own, those that are likely less long: the first ones hear.
    """
    far = np.sqrt(((SPOUTS_M - at) ** 2).sum(axis=1))
    waits = rng.exponential(size=SPOUTS) * np.exp(far / LIKELY_M)
    return np.argsort(waits)[:count].astype(np.int64)


def _course(rng: np.random.Generator, kind: str, tag: str) -> dict[str, float]:
    """Return the course of a tag that keeps off spouts and bins."""
    ways: dict[str, Callable[[np.random.Generator], dict[str, float]]] = {
        "auger": _auger, "bucket": _bucket, "sack": _sack, "barrow": _barrow,
    }  # fmt: skip
    craft, when = float([*KINDS].index(kind)), np.linspace(0.0, LASTS_S, 40)
    while True:
        made = {"side": 1.0 if int(tag[-1]) % 2 == 0 else -1.0} | ways[kind](rng)
        made |= {"craft": craft, "runs": 1.0, "into_s": 0.0}
        at = _places(made, when)
        free_m = np.linalg.norm(at[:, None] - SPOUTS_M, axis=2).min() - NEAREST_M
        bare_m = np.linalg.norm(at[:, None, :2] - BINS_M, axis=2).min() - BIN_M
        if min(free_m, bare_m) > 0:
            return made


def _either(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a rate between two, either way."""
    return float(rng.uniform(low, high) * (2 * rng.integers(2) - 1))


def _auger(rng: np.random.Generator) -> dict[str, float]:
    """Return an auger's course, which sweeps either way."""
    goes = {"outset": rng.uniform(2.2, 4.8), "rate": _either(rng, 0.45, 0.85), "nods": 0.0}
    shaft = {"bent": rng.uniform(0.3, 0.65), "phase": rng.uniform(-np.pi, np.pi)}
    return goes | shaft | {"height": rng.uniform(0.7, 1.2)}


def _bucket(rng: np.random.Generator) -> dict[str, float]:
    """Return a bucket's course, whose `height` is how far it sticks out of its leg."""
    goes = {"outset": rng.uniform(0.9, 7.2), "rate": rng.uniform(1.1, 1.9), "nods": 0.0}
    return goes | {"bent": 0.0, "phase": 0.0, "height": rng.uniform(-0.2, 0.2)}


def _sack(rng: np.random.Generator) -> dict[str, float]:
    """Return a sack's course from a trough's one side toward the other."""
    goes = {"outset": rng.uniform(4.8, 7.4), "rate": rng.uniform(0.42, 0.62), "nods": 0.0}
    return goes | {"bent": 0.0, "phase": rng.uniform(0.2, 1.1), "height": rng.uniform(0.2, 0.45)}


def _barrow(rng: np.random.Generator) -> dict[str, float]:
    """Return a barrow's course, whose `side` is how much wider its oval is."""
    goes = {"outset": rng.uniform(-np.pi, np.pi), "side": rng.uniform(-0.6, 0.8)}
    gait = {"nods": rng.uniform(0.02, 0.045), "bent": rng.uniform(4.6, 5.8)}
    turn = {"rate": _either(rng, 0.9, 1.7), "phase": rng.uniform(-np.pi, np.pi)}
    return goes | gait | turn | {"height": rng.uniform(0.8, 1.3)}


def _noted(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is noted for each row [n]: of cool mornings and hot noons, of idle and full."""
    count = len(since_s)
    each = rng.normal(size=(11, count))
    return {
        "temperature_c": 19.0 + 14.0 * np.sin(rng.uniform(-1.5, 1.5)) + 0.5 * each[0],
        "reply_time_s": 0.0035 + 0.0085 * rng.beta(1.3, 1.5, count),
        "mill_kw": (75.0 * rng.beta(1.1, 0.9) + 1.2 * each[1]).clip(0.0, 75.0),
        "chaff_g": (rng.gamma(1.4, 32.0) + 2.0 * np.abs(each[2])).clip(0.0, 220.0),
        "caked_mm": (rng.uniform(0.4, 10.0) + 0.15 * each[3]).clip(0.1, 10.5),
        "drier_gap_m": (rng.uniform(0.6, 3.8) + 0.05 * each[4]).clip(0.45, 4.0),
        "greased_h": np.exp(rng.uniform(0.4, 5.0) + 0.12 * each[5]),
        "sacks": rng.binomial(30, rng.beta(1.2, 1.3), count).astype(np.float64),
        "magnet_a": (rng.uniform(2.0, 33.0) + 0.5 * each[6]).clip(0.0, 35.0),
        "moist_pct": (rng.uniform(9.5, 19.5) + 0.2 * each[7]).clip(9.0, 20.0),
        "filled_pct": (100.0 * rng.beta(1.5, 1.0) + 0.8 * each[8]).clip(0.0, 100.0),
        "chain_m": rng.uniform(0.0, 140.0) + 1.6 * since_s + 0.3 * np.abs(each[9]),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: lorries of steel by lot, else some things.

    Bins where ways come by these, boxes where both ends are low, hoppers below the elevator's
    head, brick on ways to and from the flat store.
    """
    links = rows.groupby("link", sort=False).first()
    ends = [links[[f"{end}_{a}_m" for a in "xyz"]].to_numpy() for end in ("tx", "rx")]
    low = np.maximum(ends[0][:, 2], ends[1][:, 2]) < 4.5
    east = (ends[0][:, 0] > 36.0) != (ends[1][:, 0] > 36.0)
    odds = np.stack([0.45 * _by_bins(*ends), 0.07 + 0.2 * low, 0.08 + 0.02 * ends[0][:, 2],
                     0.06 + 0.16 * east])  # fmt: skip
    met = rng.random(odds.shape) < odds * (0.4 if rare in RARELY else 1.0)
    lorry = rng.permutation(len(links)) < round(BEHIND_LORRIES[bool(rare)] * len(links))
    some: dict[object, list[str]] = {}
    for k, link in enumerate(links.index):
        by_way = [what for what, there in zip(THROUGH, met[:, k], strict=True) if there]
        some[link] = ["metal"] if lorry[k] else by_way
    return [[*some[link]] for link in rows["link"]]


def _by_bins(begin: Floats, end: Floats) -> NDArray[np.bool_]:
    """Return which ways go through a round bin, seen from above [n]."""
    way = (end - begin)[:, None, :2]
    off = BINS_M - begin[:, None, :2]
    part = ((off * way).sum(axis=2) / (way**2).sum(axis=2)).clip(0.0, 1.0)
    return np.asarray((np.linalg.norm(off - part[:, :, None] * way, axis=2) < BIN_M).any(axis=1))
