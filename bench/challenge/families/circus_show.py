"""Two shows of the circus: who is ranged in which act, when, and what is between.

numpy and pandas alone. In each act one tag is heard by some poles, round by round: in which slot of
a round a pole listens, powers of two tell, so that no two poles meet again in the same order at the
same distance within twelve rounds (Welch's arrays of Costas).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.circus_tent import (
    COURSE,
    DAY_S,
    KINDS,
    PLACES,
    POLES,
    POLES_M,
    TAGS,
    TENT_M,
    WIRE_M,
    shown,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat(np.arange(3, 9), [4, 6, 5, 4, 3, 1])
"""By how many poles an act's tag is heard."""
OF_ROWS: Integers = np.repeat(np.arange(1, 11), [16, 17, 16, 15, 13, 11, 9, 8, 5, 4])
"""How many rows links have."""
STILL = 6  # acts whose tag stays where it is
PRIME, ROOT = 13, 2  # poles listen in slots that are powers of ROOT, less whole PRIMEs
ROUND_S, SLOT_S, ROUNDS = 0.16, 0.0075, 12
NEAREST_M, LASTS_S = 1.9, 5.0  # that tags come to poles; until when they stay in the tent
RING_M = (22.0, 18.0)  # the ring's middle
WIRES_M = ((9.0, 15.7, 6.8), (9.0, 20.3, 5.2))  # where wires begin, eastward
THROUGH = ("wood", "plywood", "glass", "chipboard")
"""Tiers of seats, flats of scenery, the panes of the bandstand, the ring's fence."""
BEHIND_WAGONS = {False: 0.17, True: 0.055}  # of links, and where these are rare
RARELY = ("blocked-path", "diffraction")


def staged(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    heard_by = rng.permutation(HEARD_BY)
    lots = np.split(rng.permutation(of_rows), np.cumsum(heard_by)[:-1])
    begins_s = np.sort(_two_shows(rng, len(lots)))
    who = rng.permutation(np.arange(len(lots)) % len(TAGS))
    goes = rng.permutation(np.arange(len(lots)) >= STILL)
    acts = [_act(rng, k, TAGS[who[k]], lot, float(goes[k])) for k, lot in enumerate(lots)]
    rows = pd.concat(acts, ignore_index=True)
    rows["time_s"] += np.repeat(begins_s, [len(one) for one in acts])
    rows["obstacles"] = _between(rng, rows, rare)
    room = {f"room_{axis}_m": size for axis, size in zip("xyz", TENT_M, strict=True)}
    return rows.assign(los=rows["obstacles"].map(len) == 0, channel=5, prf_mhz=64.0, **room)


def _two_shows(rng: np.random.Generator, acts: int) -> Floats:
    """Return when acts begin, in s [acts]: two hours after noon, and two before the end."""
    show = rng.integers(0, 2, acts)
    return np.asarray(show * (DAY_S - 7400.0) + 7200.0 * rng.beta(1.3, 1.3, acts), np.float64)


def _act(
    rng: np.random.Generator, number: int, tag: str, sizes: Integers, goes: float
) -> pd.DataFrame:
    """Return the rows of one act by time, with places of its tag."""
    kind = tag.rstrip("0123456789")
    one = _course(rng, kind) | {"goes": goes, "into_s": rng.uniform(0.1, 1.0)}
    begun = {name: np.full(1, one[name]) for name in COURSE}
    poles = _hearing(rng, shown(begun, begun["into_s"])[0], len(sizes))
    which, since_s = _slots(rng, poles, sizes)
    course = {name: np.full(len(which), one[name]) for name in COURSE}
    course["into_s"] = course["into_s"] + since_s
    there, pole = shown(course, course["into_s"]), poles[which]
    way = POLES_M[pole] - there
    ends = {f"tx_{a}_m": there[:, k] for k, a in enumerate("xyz")}
    ends |= {f"rx_{a}_m": POLES_M[pole, k] for k, a in enumerate("xyz")}
    faces = rng.uniform(0.0, 2 * np.pi)
    seen = np.degrees(np.arctan2(way[:, 1], way[:, 0]) - faces) % 360.0
    return pd.DataFrame(course | ends | {"time_s": since_s} | _noted(rng, since_s)).assign(
        tx=tag,
        rx=[f"pole{k}" for k in pole],
        link=[f"act {number} below pole{k}" for k in pole],
        environment=PLACES[kind],
        azimuth_deg=seen,
        true_range_m=np.linalg.norm(way, axis=1),
    )


def _slots(rng: np.random.Generator, poles: Integers, sizes: Integers) -> tuple[Integers, Floats]:
    """Return which of an act's poles hears, and when after the first, in s, by time [sum]."""
    first = rng.integers(0, ROUNDS - sizes + 1)
    which = np.repeat(np.arange(len(sizes)), sizes)
    rounds = np.concatenate([k + np.arange(size) for k, size in zip(first, sizes, strict=True)])
    at_s = ROUND_S * rounds + SLOT_S * slot_of(poles[which], rounds)
    order = np.argsort(at_s)
    return which[order], at_s[order] - at_s.min()


def slot_of(pole: Integers, rounds: Integers) -> Integers:
    """Return in which slot of a round a pole listens, of 1 to 12 [n]."""
    powers = np.array([pow(ROOT, k, PRIME) for k in range(PRIME - 1)], np.int64)
    return np.asarray(powers[(pole + rounds) % (PRIME - 1)])


def _hearing(rng: np.random.Generator, place: Floats, count: int) -> Integers:
    """Return which poles hear a tag [count]: those nearest once chance has been put on (Gumbel)."""
    far = np.linalg.norm(POLES_M - place, axis=1)
    return np.argsort(far / 12.0 - rng.gumbel(size=POLES))[:count].astype(np.int64)


def _course(rng: np.random.Generator, kind: str) -> dict[str, float]:
    """Return the course of a tag that keeps off poles and stays in the tent."""
    ways: dict[str, Callable[[np.random.Generator], dict[str, float]]] = {
        "flier": _flier, "spinner": _spinner, "cyclist": _cyclist, "walker": _walker,
    }  # fmt: skip
    number, when = float([*KINDS].index(kind)), np.linspace(0.0, LASTS_S, 30)
    while True:
        made = ways[kind](rng) | {"kind": number, "goes": 1.0, "into_s": 0.0}
        made["phase"] = rng.uniform(-np.pi, np.pi)
        at = shown({name: np.full(30, made[name]) for name in COURSE}, when)
        near_m = np.linalg.norm(at[:, None] - POLES_M, axis=2).min()
        if near_m > NEAREST_M and (at > 0.7).all() and (at < np.array(TENT_M) - 0.7).all():
            return made


def _hung(x: float, y: float, z: float) -> dict[str, float]:
    return {"hung_x": x, "hung_y": y, "hung_z": z}


def _flier(rng: np.random.Generator) -> dict[str, float]:
    """Return a flier's course, on a trapeze that hangs in the cupola."""
    at = _hung(rng.uniform(13.0, 31.0), rng.uniform(13.0, 23.0), rng.uniform(9.6, 12.2))
    swings = {"reach": rng.uniform(3.4, 5.6), "throw": rng.uniform(0.45, 0.95)}
    return at | swings | {"aim": rng.uniform(-0.3, 0.3), "girth": 0.0, "rate": 1.0}


def _spinner(rng: np.random.Generator) -> dict[str, float]:
    """Return a spinner's course, on a strap of the cupola."""
    at = _hung(rng.uniform(17.0, 27.0), rng.uniform(14.0, 22.0), 12.6)
    goes = {"reach": rng.uniform(5.5, 9.5), "throw": rng.uniform(1.6, 3.2), "rate": 1.0}
    return at | goes | {"girth": rng.uniform(-1.4, 1.4), "aim": rng.uniform(-np.pi, np.pi)}


def _cyclist(rng: np.random.Generator) -> dict[str, float]:
    """Return a cyclist's course: three, four or five loops on the way round the ring."""
    at = _hung(*RING_M, rng.uniform(1.2, 2.4))
    goes = {"reach": rng.uniform(3.6, 4.8), "throw": rng.uniform(0.5, 1.1), "aim": 0.0}
    pace = rng.choice([-1.0, 1.0]) * rng.uniform(0.25, 0.5)
    return at | goes | {"girth": float(rng.integers(3, 6)), "rate": pace}


def _walker(rng: np.random.Generator) -> dict[str, float]:
    """Return a walker's course along one of the wires, from some place on."""
    x, y, z = WIRES_M[int(rng.integers(2))]
    goes = {"reach": rng.uniform(0.6, 1.1), "throw": rng.uniform(0.06, 0.2), "aim": 0.0}
    start = rng.uniform(0.5, WIRE_M - 6.5)
    return _hung(x, y, z + 1.1) | goes | {"girth": start, "rate": rng.uniform(2.6, 4.2)}


def _noted(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is noted for each row [n]: of matinees and of full houses."""
    each = rng.normal(size=(10, len(since_s)))
    return {
        "temperature_c": rng.uniform(4.0, 37.0) + 0.8 * each[0],
        "reply_time_s": 0.003 + 0.006 * rng.beta(1.4, 1.6, len(since_s)),
        "dim_pct": (rng.uniform(0.0, 100.0) + 3.0 * each[1]).clip(0.0, 100.0),
        "chalk_mg": rng.gamma(1.5, 30.0) + 5.0 * np.abs(each[2]),
        "rain_mm": (9.0 * rng.beta(1.0, 1.2) + 0.25 * each[3]).clip(0.05, 10.0),
        "cage_m": (rng.uniform(1.2, 7.5) + 0.2 * each[4]).clip(1.0, 8.0),
        "rosin_g": np.exp(rng.uniform(-0.5, 3.0) + 0.2 * each[5]),
        "watchers": rng.binomial(26, rng.beta(1.2, 1.2), len(since_s)).astype(np.float64),
        "laced_pct": (rng.uniform(-5.0, 112.0) + 3.0 * each[6]).clip(0.0, 100.0),
        "smoke_pct": (rng.uniform(8.0, 95.0) + 2.5 * each[7]).clip(3.0, 100.0),
        "lamp_kw": (rng.uniform(0.3, 12.0) + 0.3 * each[8]).clip(0.1, 13.0),
        "gust_ms": np.abs(rng.weibull(2.0) * 9.0 + 0.7 * each[9]).clip(0.2, 24.0),
        "fence_m": rng.uniform(0.0, 380.0) + 1.4 * since_s + 0.6 * rng.random(len(since_s)),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: wagons of steel by lot, else some things.

    Tiers and flats where poles' radios are low, the fence where tags are, panes on long ways.
    """
    links = rows.groupby("link", sort=False)[["tx_z_m", "rx_z_m", "true_range_m"]].first()
    low, down, long = links["rx_z_m"] < 4.0, links["tx_z_m"] < 2.6, links["true_range_m"] > 16.0
    odds = np.stack([0.07 + 0.24 * low, 0.06 + 0.16 * low, 0.06 + 0.18 * long, 0.02 + 0.4 * down])
    odds = odds * (0.4 if rare in RARELY else 1.0)
    met = np.array(THROUGH, object)[:, None] * (rng.random(odds.shape) < odds)
    steel = rng.choice(len(links), round(BEHIND_WAGONS[bool(rare)] * len(links)), replace=False)
    some = {link: [w for w in met[:, k] if w] for k, link in enumerate(links.index)}
    some |= {links.index[k]: ["metal"] for k in steel}
    return [[*some[link]] for link in rows["link"]]
