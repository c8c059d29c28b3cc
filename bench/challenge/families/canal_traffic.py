"""A day at the ship lock: who passes, which davits range them when, and what is between.

numpy and pandas alone. At each locking the davits along one tag's way ask it in turn, in rounds of
a length that the locking has; each davit misses one stretch of rounds.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.canal_chamber import (
    COPING_M,
    COURSE,
    CREW,
    DAVITS,
    DAVITS_M,
    DAY_S,
    FULL_M,
    HEELS_M,
    LOCK_M,
    PLACES,
    TAGS,
    stood,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
ASKED_BY: Integers = np.repeat(np.arange(2, 8), [3, 5, 6, 5, 4, 3])
"""How many davits range a locking's tag."""
OF_ROWS: Integers = np.repeat(np.arange(1, 14), [17, 17, 16, 14, 12, 11, 9, 7, 5, 3, 2, 1, 1])
"""How many rows links have."""
MOORED = 6  # lockings whose tag rests
ROUNDS_S = (0.24, 0.36, 0.48)  # how long rounds are
SLOT_S = 0.007  # from one davit's turn to the next one's
NEAREST_M, LAID_M = 1.6, 4.6  # that tags come to davits; how far off copings they go
THROUGH = ("wood", "concrete", "plywood", "glass")
"""Deckloads and fenders, the copings' edges, hatches, the panes of wheelhouses."""
BEHIND_STEEL = {False: 0.17, True: 0.055}  # of links, and where these are rare
RARELY = ("blocked-path", "diffraction")
RIDES_M = 1.1  # of barges' tags over water


def passed(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    asked_by, sizes = rng.permutation(ASKED_BY), rng.permutation(of_rows)
    count, ends = len(asked_by), np.cumsum(asked_by)
    who = rng.permutation(np.resize(np.arange(len(TAGS)), count))
    begins_s = DAY_S * np.sort(rng.triangular(0.0, 0.35, 1.0, count))
    rests = rng.permutation(count) < MOORED
    parts: list[pd.DataFrame] = []
    for k in range(count):
        own = _locking(rng, k, TAGS[who[k]], sizes[ends[k] - asked_by[k] : ends[k]])
        parts.append(own.assign(time_s=own["time_s"] + begins_s[k]))
    rows = pd.concat(parts, ignore_index=True)
    return _told(rng, rows, rests, rare)


def _told(
    rng: np.random.Generator, rows: pd.DataFrame, rests: NDArray[np.bool_], rare: str
) -> pd.DataFrame:
    """Return rows with what is told of positions, once it is known whose tags rest."""
    locking = rows["link"].str.extract(r"(\d+)")[0].astype(int).to_numpy()
    rows["goes"] = np.where(rests[locking], 0.0, 1.0)
    tag = stood({name: rows[name].to_numpy() for name in COURSE}, rows["done_s"].to_numpy())
    davit = DAVITS_M[rows["rx"].str[5:].astype(int)]
    for axis, name in enumerate("xyz"):
        rows[f"tx_{name}_m"], rows[f"rx_{name}_m"] = tag[:, axis], davit[:, axis]
    off = davit - tag
    seen = np.degrees(np.arctan2(off[:, 1], off[:, 0]))
    rows["azimuth_deg"] = (seen - rows["azimuth_deg"]) % 360.0
    rows["true_range_m"] = np.sqrt((off**2).sum(axis=1))
    rows["obstacles"] = _between(rng, rows, rare)
    rows["los"] = [not some for some in rows["obstacles"]]
    return rows.assign(channel=9, prf_mhz=64.0)


def _locking(rng: np.random.Generator, number: int, tag: str, sizes: Integers) -> pd.DataFrame:
    """Return the rows of one locking by time, which is 0 at its first round."""
    kind, head_m = tag.rstrip("0123456789"), rng.uniform(0.3, 4.8)
    course = _course(rng, tag, head_m)
    one = {name: np.full(1, value) for name, value in course.items()}
    davit = _along(rng, stood(one, np.full(1, 3.0))[0], len(sizes))
    turn, since_s = _rounds(rng, sizes)
    rows = pd.DataFrame(_logged(rng, len(turn), head_m)).assign(**course)
    heading = np.degrees(course["bears"]) + rng.uniform(0.0, 360.0)
    return rows.assign(
        tx=tag,
        rx=[f"davit{davit[k]}" for k in turn],
        link=[f"locking {number} by davit{davit[k]}" for k in turn],
        environment=PLACES[kind],
        time_s=since_s,
        done_s=course["done_s"] + since_s,
        azimuth_deg=heading,
    )


def _rounds(rng: np.random.Generator, sizes: Integers) -> tuple[Integers, Floats]:
    """Return which davit asks, and how long after the first round in s, by time [sum] each.

    What a davit has is all rounds but one stretch, which may lap over the end.
    """
    rounds = int(sizes.max()) + int(rng.integers(1, 4))
    pitch_s, slots = float(rng.choice(ROUNDS_S)), rng.permutation(DAVITS)
    begins = rng.integers(0, rounds, len(sizes))
    asked = [(begins[k] + np.arange(size)) % rounds for k, size in enumerate(sizes)]
    turn = np.repeat(np.arange(len(sizes)), sizes)
    at_s = pitch_s * np.concatenate(asked) + SLOT_S * slots[turn]
    order = np.argsort(at_s)
    return turn[order], at_s[order]


def _along(rng: np.random.Generator, place: Floats, count: int) -> Integers:
    """Return which davits ask a tag [count]: the nearer, the sooner, and none twice."""
    far = np.sqrt(((DAVITS_M - place) ** 2).sum(axis=1))
    keen = rng.gumbel(size=DAVITS) - 4.0 * np.log1p(far / 15.0)
    return np.asarray(np.argsort(-keen)[:count], np.int64)


def _course(rng: np.random.Generator, tag: str, head_m: float) -> dict[str, float]:
    """Return the course of a tag that keeps off davits and stays at the lock."""
    ways: dict[str, Callable[[np.random.Generator, str, float], dict[str, float]]] = {
        "barge": _barge, "leaf": _leaf, "mule": _mule, "keeper": _keeper,
    }  # fmt: skip
    kind = tag.rstrip("0123456789")
    while True:
        made = ways[kind](rng, tag, head_m) | {"craft": float(list(CREW).index(kind))}
        made |= {"goes": 1.0, "done_s": rng.uniform(0.2, 1.6)}
        at = stood({name: np.full(17, made[name]) for name in COURSE}, np.linspace(0.0, 9.5, 17))
        near = np.sqrt(((at[:, None] - DAVITS_M) ** 2).sum(axis=2)).min()
        inside = np.abs(at[:, :2] / np.array(LOCK_M) - 0.5) < 0.5 + np.array([0.0, LAID_M / 9.0])
        if near > NEAREST_M and inside.all():
            return made


def _barge(rng: np.random.Generator, _: str, head_m: float) -> dict[str, float]:
    """Return a barge's course up or down the chamber."""
    way = {"bears": np.pi * float(rng.integers(2)) + rng.normal(0.0, 0.015)}
    way |= {"speed": rng.uniform(0.5, 1.7), "reach": rng.uniform(5.0, 20.0)}
    at = {"from_x": rng.uniform(4.0, 54.0), "from_y": rng.uniform(2.4, 6.6)}
    return way | at | {"from_z": FULL_M - head_m + RIDES_M, "phase": rng.uniform(0.0, 2 * np.pi)}


def _leaf(rng: np.random.Generator, tag: str, _: float) -> dict[str, float]:
    """Return how a leaf is opened or shut."""
    heel = int(tag[-1])
    opens = bool(rng.integers(2))
    wide = rng.uniform(1.0, 1.2)
    swing = {"phase": 0.04 if opens else wide, "speed": wide if opens else -wide}
    side = {"bears": 1.0 if HEELS_M[heel, 1] == 0.0 else -1.0, "reach": rng.uniform(8.0, 12.0)}
    at = {"from_x": HEELS_M[heel, 0], "from_y": HEELS_M[heel, 1], "from_z": rng.uniform(6.9, 7.1)}
    return swing | side | at


def _mule(rng: np.random.Generator, tag: str, _: float) -> dict[str, float]:
    """Return a mule's course along its own rails."""
    way = {"bears": np.pi * float(rng.integers(2)), "phase": 0.0}
    way |= {"speed": rng.uniform(1.1, 2.6), "reach": rng.uniform(1.0, 3.0)}
    aside = -3.9 if tag == "mule0" else LOCK_M[1] + 3.9
    return way | {"from_x": rng.uniform(2.0, 56.0), "from_y": aside, "from_z": COPING_M + 1.3}


def _keeper(rng: np.random.Generator, _: str, __: float) -> dict[str, float]:
    """Return a keeper's course along a coping, or off to the sluices' racks."""
    way = {"bears": rng.choice([0.0, np.pi]) + rng.normal(0.0, 0.12), "phase": rng.uniform(0, 6.28)}
    way |= {"speed": rng.uniform(0.8, 1.5), "reach": rng.uniform(-0.5, 0.5)}
    aside = rng.uniform(0.6, 3.6)
    at = {"from_y": -aside if rng.integers(2) else LOCK_M[1] + aside}
    return way | at | {"from_x": rng.uniform(1.0, 57.0), "from_z": COPING_M + rng.uniform(1.0, 1.5)}


def _logged(rng: np.random.Generator, n: int, head_m: float) -> dict[str, Floats]:
    """Return what is logged for each of n rows: of frosty mornings and of summer noons."""
    each = rng.normal(size=(8, n))
    return {
        "temperature_c": rng.triangular(-9.0, 8.0, 29.0) + 1.1 * each[0],
        "reply_time_s": (0.0088 * np.exp(0.5 * each[1])).clip(0.0028, 0.03),
        "head_m": np.full(n, head_m),
        "fill_mms": rng.uniform(-16.0, 16.0) + 0.7 * each[2],
        "sluice_pct": (100.0 * rng.beta(0.9, 1.0) + 5.0 * each[3]).clip(0.0, 100.0),
        "slime_um": rng.gamma(1.3, 32.0) + rng.gamma(1.4, 6.0, n),
        "wash_cm": (rng.uniform(1.0, 26.0) + 1.6 * each[4]).clip(0.5, 30.0),
        "rack_m": (rng.uniform(1.5, 13.0) + 0.5 * each[5]).clip(1.1, 14.0),
        "verdigris_mg": rng.lognormal(1.8, 0.9) * np.exp(0.25 * each[6]),
        "fenders": rng.binomial(24, rng.beta(1.1, 1.1), n).astype(np.float64),
        "pump_kw": (rng.uniform(4.0, 75.0) + 3.0 * each[7]).clip(1.0, 80.0),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: sluices' hoists of steel by lot, else some things.

    Edges of copings where the tag is low, deckloads in the chamber, hatches and panes anywhere.
    """
    links = rows.drop_duplicates("link")
    low = (links["tx_z_m"] < COPING_M).to_numpy()
    far = links["true_range_m"].to_numpy()
    floats = links["tx"].str.startswith("barge").to_numpy()
    odds = np.stack(
        [0.1 + 0.24 * floats, 0.04 + 0.4 * low, 0.07 + 0.14 * floats, 0.05 + 0.2 * (far > 18.0)]
    )
    met = rng.random(odds.shape) < odds * (0.4 if rare in RARELY else 1.0)
    steel = rng.permutation(len(links)) < round(BEHIND_STEEL[bool(rare)] * len(links))
    some = [
        ["metal"]
        if steel[k]
        else [what for what, there in zip(THROUGH, met[:, k], strict=True) if there]
        for k in range(len(links))
    ]
    return [list(one) for one in rows["link"].map(dict(zip(links["link"], some, strict=True)))]
