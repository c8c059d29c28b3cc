"""A night at the observatory: who is ranged, which sconces ask when, and what is between.

numpy and pandas alone. In each watch some sconces range one tag. Each asks at every so manieth slot
of the clock, a prime number of its own, as cicadas come out: thus two seldom ask at once.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.observatory_hall import (
    COURSE,
    HALL_M,
    NIGHT_S,
    PLACES,
    SCONCES,
    SCONCES_M,
    SORTS,
    TAGS,
    reached,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat(np.arange(3, 8), [4, 6, 7, 4, 2])
"""How many sconces range a watch's tag."""
OF_ROWS: Integers = np.repeat(np.arange(1, 14), [15, 15, 15, 13, 12, 10, 9, 7, 5, 4, 2, 1, 1])
"""How many rows links have."""
AT_REST = 6  # tags that rest in one of their watches
SLOT_S, PRIMES = 0.029, (5, 7, 11, 13, 17)
NEAREST_M, FARTHEST_S = 1.8, 9.5  # that tags come to sconces; until when they stay in the hall
PIERS_M = ((8.0, 11.0), (15.0, 7.0), (15.2, 15.0), (22.0, 11.0))
NEWELS_M = ((3.4, 18.4), (26.4, 3.6), (26.6, 18.2), (3.6, 3.8))
THROUGH = ("wood", "marble", "glass", "brick")
"""Cases of books, columns, glazed doors and instruments' piers."""
BEHIND_IRON = {False: 0.18, True: 0.055}  # of links, and where these are rare
RARELY = ("blocked-path", "diffraction")


def watched(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a night."""
    heard_by = rng.permutation(HEARD_BY)
    lots = np.split(rng.permutation(of_rows), np.cumsum(heard_by)[:-1])
    begins_s = np.sort(rng.random(len(lots)) ** 0.9) * NIGHT_S
    turn = rng.permutation(len(lots))
    who = [TAGS[k % len(TAGS)] for k in turn]
    moves = ~np.isin(turn, rng.choice(len(TAGS), AT_REST, replace=False))
    made = [_watch(rng, k, who[k], lot).assign(moves=float(moves[k])) for k, lot in enumerate(lots)]
    rows = pd.concat([_placed(one) for one in made], ignore_index=True)
    rows["time_s"] += np.repeat(begins_s, [len(one) for one in made])
    rows["obstacles"] = _between(rng, rows, rare)
    room = {f"room_{axis}_m": size for axis, size in zip("xyz", HALL_M, strict=True)}
    return rows.assign(los=rows["obstacles"].str.len().eq(0), channel=3, prf_mhz=64.0, **room)


def _watch(rng: np.random.Generator, number: int, tag: str, sizes: Integers) -> pd.DataFrame:
    """Return the rows of one watch by time, before its tag is placed."""
    which, since_s = _asked(rng, sizes)
    sort = tag.rstrip("0123456789")
    course = _course(rng, sort)
    begun = rng.uniform(0.1, 1.4)
    sconce = _near(rng, np.array([course["base_x"], course["base_y"]]), len(sizes))[which]
    turned = rng.uniform(0.0, 360.0)
    made = {name: np.full(len(which), value) for name, value in course.items()}
    made |= {"into_s": begun + since_s, "time_s": since_s, "turned": np.full(len(which), turned)}
    return pd.DataFrame(made | _logged(rng, since_s)).assign(
        tx=tag,
        rx=[f"sconce{k}" for k in sconce],
        link=[f"watch {number} at sconce{k}" for k in sconce],
        environment=PLACES[sort],
    )


def _placed(rows: pd.DataFrame) -> pd.DataFrame:
    """Return rows with where both ends are, how far apart, and from where tags see sconces."""
    inner = reached({n: rows[n].to_numpy(np.float64) for n in COURSE}, rows["into_s"].to_numpy())
    outer = SCONCES_M[rows["rx"].str.removeprefix("sconce").astype(int)]
    way = outer - inner
    ends = {f"tx_{a}_m": inner[:, k] for k, a in enumerate("xyz")}
    ends |= {f"rx_{a}_m": outer[:, k] for k, a in enumerate("xyz")}
    seen = np.degrees(np.arctan2(way[:, 0], way[:, 1])) - rows["turned"]
    made = rows.drop(columns="turned").assign(**ends, azimuth_deg=seen % 360.0)
    return made.assign(true_range_m=np.sqrt((way**2).sum(axis=1)))


def _asked(rng: np.random.Generator, sizes: Integers) -> tuple[Integers, Floats]:
    """Return which of a watch's sconces asks, and when after the first, in s, by time [sum]."""
    every = rng.choice(PRIMES, len(sizes))
    first = np.floor(rng.random(len(sizes)) * every)
    which = np.repeat(np.arange(len(sizes)), sizes)
    turn = np.concatenate([np.arange(size) for size in sizes])
    slot = first[which] + turn * every[which] + 0.06 * which  # those of one slot, one by one
    order = np.argsort(slot, kind="stable")
    return which[order], SLOT_S * (slot[order] - slot.min())


def _near(rng: np.random.Generator, place: Floats, count: int) -> Integers:
    """Return which sconces hear a tag [count]: by a race that near ones mostly win (Gumbel)."""
    far = np.hypot(*(SCONCES_M[:, :2] - place).T)
    return np.argsort(far / 10.0 - rng.gumbel(size=SCONCES))[:count].astype(np.int64)


def _course(rng: np.random.Generator, sort: str) -> dict[str, float]:
    """Return the course of a tag that keeps off sconces and stays in the hall."""
    ways: dict[str, Callable[[np.random.Generator], dict[str, float]]] = {
        "tube": _tube, "chair": _chair, "trolley": _trolley, "climber": _climber,
    }  # fmt: skip
    number = float(tuple(SORTS).index(sort))
    when = np.linspace(0.0, FARTHEST_S, 20)
    while True:
        course = ways[sort](rng) | {"sort": number, "moves": 1.0, "into_s": 0.0}
        way = reached({name: np.full(20, course[name]) for name in COURSE}, when)
        low, high = np.array([0.9, 0.9, 0.7]), np.array(HALL_M) - (0.9, 0.9, 1.0)
        apart = np.linalg.norm(way[:, None] - SCONCES_M, axis=2).min()
        if apart > NEAREST_M and (way > low).all() and (way < high).all():
            return course


def _based(x: float, y: float, z: float) -> dict[str, float]:
    return {"base_x": x, "base_y": y, "base_z": z}


def _tube(rng: np.random.Generator) -> dict[str, float]:
    """Return the course of a tube on one of the piers, to one or the other side."""
    base = _based(*PIERS_M[int(rng.integers(4))], rng.uniform(2.9, 3.7))
    goes = {"speed": rng.choice([-1.0, 1.0]) * rng.uniform(0.45, 1.0)}
    aim = {"bears": rng.uniform(-1.7, 1.7), "tilt": rng.uniform(-0.35, 1.0)}
    return base | goes | aim | {"lasts": rng.uniform(0.6, 1.8), "arm": rng.uniform(2.4, 3.6)}


def _chair(rng: np.random.Generator) -> dict[str, float]:
    """Return the course of a chair on rails round one of the piers."""
    base = _based(*PIERS_M[int(rng.integers(4))], rng.uniform(0.9, 2.8))
    goes = {"speed": rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 1.1), "tilt": 0.0}
    turns = {"bears": rng.uniform(-np.pi, np.pi), "arm": rng.uniform(3.2, 5.2)}
    return base | goes | turns | {"lasts": rng.uniform(1.6, 3.2)}


def _trolley(rng: np.random.Generator) -> dict[str, float]:
    """Return the course of a trolley along or across the hall."""
    base = _based(rng.uniform(2.5, 27.5), rng.uniform(2.5, 19.5), rng.uniform(0.8, 1.3))
    goes = {"speed": rng.uniform(0.6, 1.5), "bears": np.pi / 2 * float(rng.integers(4))}
    return base | goes | {"lasts": rng.uniform(0.8, 2.2), "arm": 1.0, "tilt": 0.0}


def _climber(rng: np.random.Generator) -> dict[str, float]:
    """Return the course of a climber about one of the newels, upward or downward."""
    base = _based(*NEWELS_M[int(rng.integers(4))], rng.uniform(1.0, 6.8))
    goes = {"speed": rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 0.85)}
    stairs = {"arm": rng.uniform(1.0, 1.5), "tilt": rng.uniform(0.42, 0.55)}
    return base | goes | stairs | {"bears": rng.uniform(-np.pi, np.pi), "lasts": 1.0}


def _logged(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is logged for each row [n]: of clear nights and of damp ones."""
    each = rng.normal(size=(9, len(since_s)))
    return {
        "temperature_c": rng.uniform(-3.0, 33.0) + 1.1 * each[0],
        "reply_time_s": (0.008 + 0.0045 * each[1] + 0.0012 * each[1] ** 2).clip(0.0026, 0.03),
        "dome_a": (rng.uniform(2.0, 58.0) + 2.4 * each[2]).clip(0.5, 62.0),
        "dew_um": rng.weibull(1.1) * 40.0 + 7.0 * np.abs(each[3]),
        "hoar_mm": (rng.uniform(0.3, 9.0) + 0.4 * each[4]).clip(0.05, 10.0),
        "pier_m": (rng.uniform(1.3, 12.0) + 0.4 * each[5]).clip(1.1, 13.5),
        "tarnish_nm": np.exp(rng.uniform(0.0, 3.6) + 0.22 * each[6]),
        "guests": rng.poisson(rng.uniform(0.0, 15.0), len(since_s)).astype(np.float64),
        "slit_deg": (rng.uniform(0.0, 110.0) + 4.0 * each[7]).clip(0.0, 115.0),
        "damp_pct": (rng.uniform(22.0, 97.0) + 2.0 * each[8]).clip(15.0, 100.0),
        "lamp_w": rng.uniform(0.0, 36.0) + rng.uniform(0.0, 5.0, len(since_s)),
        "curb_m": rng.uniform(0.0, 460.0) + 1.3 * since_s + 0.4 * rng.random(len(since_s)),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: iron stands by lot, else some things.

    Cases and piers of brick where tags are low, columns on long ways, glass anywhere.
    """
    links = rows.groupby("link", sort=False)[["tx_z_m", "true_range_m"]].first()
    low, long = links["tx_z_m"].lt(2.2).to_numpy(), links["true_range_m"].gt(11.0).to_numpy()
    odds = np.column_stack([0.07 + 0.2 * low, 0.04 + 0.2 * long, np.full(len(low), 0.13),
                            0.04 + 0.2 * low])  # fmt: skip
    met = rng.random(odds.shape) < odds * (0.4 if rare in RARELY else 1.0)
    iron = rng.permutation(len(links)) < round(BEHIND_IRON[bool(rare)] * len(links))
    some = [
        ["metal"] if shut else [what for what, there in zip(THROUGH, own, strict=True) if there]
        for shut, own in zip(iron, met, strict=True)
    ]
    of_link = dict(zip(links.index, some, strict=True))
    return [list(of_link[link]) for link in rows["link"]]
