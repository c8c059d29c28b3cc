"""A day at the baths: who is ranged in which heat, when, and what is between.

numpy and pandas alone. In each heat one tag blinks at marks of Golomb's ruler of eleven, so that no
wait between any two blinks is that between two others; arches hear some blinks in a row.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.baths_hall import (
    ARCHES,
    ARCHES_M,
    BASIN_M,
    BATHS_M,
    COURSE,
    DAY_S,
    KINDS,
    PLACES,
    TAGS,
    carried,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat(np.arange(3, 8), [5, 5, 6, 5, 3])
"""How many arches a heat's tag hears."""
OF_ROWS: Integers = np.repeat(np.arange(1, 12), [17, 17, 16, 15, 13, 11, 9, 7, 5, 4, 2])
"""How many rows links have."""
STILL = 6  # heats whose tag stays where it is
RULER: Integers = np.array([0, 1, 4, 13, 28, 33, 47, 54, 64, 70, 72])
MARK_S, APART_S = 0.034, 0.0045  # of that ruler; between arches that are heard at one mark
NEAREST_M, LASTS_S = 1.8, 8.0  # that tags come to arches; until when they stay in the baths
BOARDS_M = ((34.6, 7.0), (34.6, 10.0), (34.6, 13.0))
MASTS_M = ((3.6, 10.0), (36.2, 4.6))
"""Where springers' boards begin, and where masts of slides are."""
THROUGH = ("wood", "glass", "brick", "concrete")
"""Benches, panes of the masters' room, walls of cabins, piers below the gallery."""
BEHIND_LOCKERS = {False: 0.17, True: 0.055}  # of links, and where these are rare
RARELY = ("blocked-path", "diffraction")


def bathed(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    heard_by = rng.permutation(HEARD_BY)
    lots = np.split(rng.permutation(of_rows), np.cumsum(heard_by)[:-1])
    begins_s = DAY_S * np.sort(rng.triangular(0.0, 0.65, 1.0, len(lots)))
    who = rng.permutation(np.arange(len(lots)) % len(TAGS))
    stirs = rng.permutation(np.arange(len(lots)) >= STILL)
    heats = [_heat(rng, k, TAGS[who[k]], lot, float(stirs[k])) for k, lot in enumerate(lots)]
    rows = pd.concat(heats, ignore_index=True)
    rows["time_s"] += np.repeat(begins_s, [len(one) for one in heats])
    rows["obstacles"] = _between(rng, rows, rare)
    room = {f"room_{axis}_m": size for axis, size in zip("xyz", BATHS_M, strict=True)}
    return rows.assign(los=rows["obstacles"].str.len().eq(0), channel=9, prf_mhz=64.0, **room)


def _heat(
    rng: np.random.Generator, number: int, tag: str, sizes: Integers, stirs: float
) -> pd.DataFrame:
    """Return the rows of one heat by time, with places of its tag."""
    which, since_s = _blinks(rng, sizes)
    kind = tag.rstrip("0123456789")
    one = _course(rng, kind) | {"stirs": stirs, "into_s": rng.uniform(0.1, 1.2)}
    course = {name: np.full(len(which), one[name]) for name in COURSE}
    course["into_s"] = course["into_s"] + since_s
    low = carried(course, course["into_s"])
    arch = _heard(rng, low[0], len(sizes))[which]
    way = ARCHES_M[arch] - low
    ends = {f"tx_{a}_m": ARCHES_M[arch, k] for k, a in enumerate("xyz")}
    ends |= {f"rx_{a}_m": low[:, k] for k, a in enumerate("xyz")}
    faces = one["toward"] + rng.uniform(-np.pi, np.pi)
    seen = np.degrees(np.arctan2(way[:, 1], way[:, 0]) - faces) % 360.0
    return pd.DataFrame(course | ends | {"time_s": since_s} | _logged(rng, since_s)).assign(
        tx=[f"arch{k}" for k in arch],
        rx=tag,
        link=[f"heat {number} below arch{k}" for k in arch],
        environment=PLACES[kind],
        azimuth_deg=seen,
        true_range_m=np.linalg.norm(way, axis=1),
    )


def _blinks(rng: np.random.Generator, sizes: Integers) -> tuple[Integers, Floats]:
    """Return which of a heat's arches is heard, and when after the first, in s, by time [sum]."""
    first = rng.integers(0, len(RULER) - sizes + 1)
    which = np.repeat(np.arange(len(sizes)), sizes)
    marks = np.concatenate([RULER[k : k + size] for k, size in zip(first, sizes, strict=True)])
    at_s = MARK_S * marks + APART_S * which
    order = np.argsort(at_s)
    return which[order], at_s[order] - at_s.min()


def _heard(rng: np.random.Generator, place: Floats, count: int) -> Integers:
    """Return which arches a tag hears [count]: those whose roots of chance are largest, by ways.

    Each has a weight that a way halves every 9 m (Efraimidis, Spirakis 2006).
    """
    weight = 0.5 ** (np.linalg.norm(ARCHES_M - place, axis=1) / 9.0)
    return np.argsort(-(rng.random(ARCHES) ** (1 / weight)))[:count].astype(np.int64)


def _course(rng: np.random.Generator, kind: str) -> dict[str, float]:
    """Return the course of a tag that keeps off arches and stays in the baths."""
    ways: dict[str, Callable[[np.random.Generator], dict[str, float]]] = {
        "swimmer": _swimmer, "springer": _springer, "scrubber": _scrubber, "rider": _rider,
    }  # fmt: skip
    number, when = float([*KINDS].index(kind)), np.linspace(0.0, LASTS_S, 25)
    while True:
        made = ways[kind](rng) | {"kind": number, "stirs": 1.0, "into_s": 0.0}
        at = carried({name: np.full(25, made[name]) for name in COURSE}, when)
        near_m = np.linalg.norm(at[:, None] - ARCHES_M, axis=2).min()
        inside = (at > (0.8, 0.8, 0.1)).all() and (at < np.array(BATHS_M) - 0.8).all()
        if near_m > NEAREST_M and inside:
            return made


def _begun(x: float, y: float, z: float) -> dict[str, float]:
    return {"from_x": x, "from_y": y, "from_z": z}


def _swimmer(rng: np.random.Generator) -> dict[str, float]:
    """Return a swimmer's course along one of six lanes, to either end."""
    (west, south), (east, north) = BASIN_M
    back = bool(rng.integers(2))
    lane = south + (north - south) * (0.5 + float(rng.integers(6))) / 6
    start = rng.uniform(west + 1.0, east - 11.5)
    at = _begun(west + east - start if back else start, lane, rng.uniform(0.24, 0.4))
    goes = {"toward": np.pi * back, "pace": rng.uniform(0.85, 1.3), "wears": 1.0}
    return at | goes | {"swell": rng.uniform(0.05, 0.12), "beat": rng.uniform(2.2, 3.0),
                        "phase": rng.uniform(0.0, 6.28)}  # fmt: skip


def _springer(rng: np.random.Generator) -> dict[str, float]:
    """Return a springer's course out along a board, over the basin's end."""
    x, y = BOARDS_M[int(rng.integers(3))]
    at = _begun(x + rng.uniform(-0.3, 1.2), y, rng.choice([2.2, 3.9]) + rng.uniform(-0.1, 0.5))
    goes = {"toward": np.pi, "pace": rng.uniform(0.25, 0.55), "wears": rng.uniform(3.0, 7.0)}
    return at | goes | {"swell": rng.uniform(0.35, 0.6), "beat": rng.uniform(1.5, 2.3),
                        "phase": rng.uniform(0.0, 6.28)}  # fmt: skip


def _scrubber(rng: np.random.Generator) -> dict[str, float]:
    """Return a scrubber's course on the decks along the basin, south or north of it."""
    y = 2.1 if rng.integers(2) else 17.9
    at = _begun(rng.uniform(6.0, 34.0), y, rng.uniform(0.5, 0.95))
    eight = {"swell": rng.uniform(2.4, 4.0), "wears": rng.uniform(0.4, 0.9)}
    turns = {"beat": rng.choice([-1.0, 1.0]) * rng.uniform(0.22, 0.4), "pace": 0.0}
    return at | eight | turns | {"toward": rng.uniform(-0.12, 0.12),
                                 "phase": rng.uniform(0.0, 6.28)}  # fmt: skip


def _rider(rng: np.random.Generator) -> dict[str, float]:
    """Return a rider's course down one of the slides."""
    at = _begun(*MASTS_M[int(rng.integers(2))], rng.uniform(3.4, 6.2))
    goes = {"pace": rng.uniform(0.9, 1.7), "wears": rng.uniform(0.8, 2.0), "toward": 0.0}
    return at | goes | {"swell": rng.uniform(1.9, 2.7), "beat": rng.uniform(0.04, 0.1),
                        "phase": rng.uniform(0.0, 6.28)}  # fmt: skip


def _logged(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is logged for each row [n]: of quiet hours and of crowded ones."""
    each = rng.normal(size=(10, len(since_s)))
    return {
        "temperature_c": rng.uniform(13.0, 39.0) + 0.9 * each[0],
        "reply_time_s": 0.0025 + 0.0013 * rng.chisquare(5.0, len(since_s)).clip(max=20.0),
        "filter_kw": (rng.uniform(1.0, 30.0) + 1.2 * each[1]).clip(0.3, 33.0),
        "beads_um": rng.gamma(1.6, 26.0) + 6.0 * np.abs(each[2]),
        "fur_mm": (8.0 * rng.beta(1.1, 1.1) + 0.3 * each[3]).clip(0.05, 9.0),
        "slide_m": (rng.uniform(1.3, 6.5) + 0.2 * each[4]).clip(1.1, 7.2),
        "cream_mg": np.exp(rng.uniform(0.0, 3.5) + 0.2 * each[5]),
        "bathers": rng.poisson(rng.gamma(2.2, 4.5), len(since_s)).astype(np.float64),
        "roof_pct": (rng.uniform(0.0, 108.0) + 3.5 * each[6]).clip(0.0, 100.0),
        "steam_pct": (rng.uniform(15.0, 96.0) + 2.0 * each[7]).clip(5.0, 100.0),
        "ajar_deg": (rng.uniform(0.0, 88.0) + 2.5 * each[8]).clip(0.0, 92.0),
        "pump_hz": (rng.uniform(3.0, 50.0) + 1.5 * each[9]).clip(1.0, 54.0),
        "rope_m": rng.uniform(0.0, 520.0) + 1.1 * since_s + 0.5 * rng.random(len(since_s)),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: lockers of steel by lot, else some things.

    Benches and cabins where tags are low, the gallery's piers on long ways, panes anywhere.
    """
    links = rows.groupby("link", sort=False)[["rx_z_m", "true_range_m"]].first()
    low, long = links["rx_z_m"].lt(1.2).to_numpy(), links["true_range_m"].gt(13.0).to_numpy()
    odds = np.stack([0.09 + 0.17 * low, np.full(len(low), 0.14), 0.05 + 0.15 * low,
                     0.04 + 0.24 * long])  # fmt: skip
    met = rng.random(odds.shape) < odds * (0.4 if rare in RARELY else 1.0)
    shut = np.arange(len(links)) < round(BEHIND_LOCKERS[bool(rare)] * len(links))
    shut = rng.permutation(shut)
    some: dict[str, list[str]] = {}
    for number, link in enumerate(links.index):
        here = [what for what, there in zip(THROUGH, met[:, number], strict=True) if there]
        some[str(link)] = ["metal"] if shut[number] else here
    return [[*some[link]] for link in rows["link"]]
