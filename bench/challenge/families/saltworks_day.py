"""A day at the saltworks: who is ranged, which vanes ask when, and what is between.

numpy and pandas alone. In each turn some vanes range one tag. Each asks again after a wait that
grows by an eighth from one time to the next, so that those that began together fall apart.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.saltworks_pans import (
    COURSE,
    DAY_S,
    GANGS,
    PLACES,
    TAGS,
    VANES,
    VANES_M,
    WORKS_M,
    gone,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat(np.arange(3, 8), [5, 7, 6, 4, 2])
"""How many vanes range a turn's tag."""
OF_ROWS: Integers = np.repeat(np.arange(1, 13), [16, 16, 15, 14, 12, 10, 9, 7, 5, 4, 2, 1])
"""How many rows links have."""
RESTING = 6  # turns whose tag rests
WAITS_S, GROWS = (0.1, 0.2), 1.125  # first waits of turns; by what each is longer than the last
NEAREST_M, LASTS_S = 1.8, 9.0  # that tags come to vanes; until when they stay in the works
THROUGH = ("wood", "brick", "concrete", "chipboard")
"""Sluices' boards and stacked pallets, the boiling house, piers of weirs, hoardings of stalls."""
BEHIND_STEEL = {False: 0.17, True: 0.055}  # of links, and where these are rare
RARELY = ("blocked-path", "diffraction")


def worked(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    heard_by, sizes = rng.permutation(HEARD_BY), rng.permutation(of_rows)
    lots = np.split(sizes, np.cumsum(heard_by)[:-1])
    begins_s = np.sort(rng.beta(1.2, 1.4, len(lots))) * DAY_S
    rests = np.isin(np.arange(len(lots)), rng.choice(len(lots), RESTING, replace=False))
    who = rng.permutation(np.resize(np.arange(len(TAGS)), len(lots)))
    turns = [
        _turn(rng, k, TAGS[who[k]], lot, {"goes": float(not rests[k]), "begins": begins_s[k]})
        for k, lot in enumerate(lots)
    ]
    rows = pd.concat(turns, ignore_index=True)
    rows["obstacles"] = _between(rng, rows, rare)
    return rows.assign(los=rows["obstacles"].map(len).eq(0), channel=2, prf_mhz=64.0)


def _turn(
    rng: np.random.Generator, number: int, tag: str, sizes: Integers, when: dict[str, float]
) -> pd.DataFrame:
    """Return the rows of one turn by time, with places of its tag."""
    which, since_s = _asked(rng, sizes)
    gang = tag.rstrip("0123456789")
    one = _course(rng, gang) | {"goes": when["goes"], "done_s": rng.uniform(0.1, 1.5)}
    course = {name: np.full(len(which), one[name]) for name in COURSE}
    course["done_s"] = course["done_s"] + since_s
    low = gone(course, course["done_s"])
    vane = _hearing(rng, low[0], len(sizes))[which]
    high = VANES_M[vane]
    ends = {f"tx_{a}_m": low[:, k] for k, a in enumerate("xyz")}
    ends |= {f"rx_{a}_m": high[:, k] for k, a in enumerate("xyz")}
    way = high - low
    seen = np.degrees(np.arctan2(way[:, 1], way[:, 0]) - one["bears"]) - rng.uniform(0.0, 360.0)
    told = {"time_s": when["begins"] + since_s, "azimuth_deg": seen % 360.0}
    return pd.DataFrame(course | ends | told | _logged(rng, since_s)).assign(
        tx=tag,
        rx=[f"vane{k}" for k in vane],
        link=[f"turn {number} by vane{k}" for k in vane],
        environment=PLACES[gang],
        true_range_m=np.linalg.norm(way, axis=1),
    )


def _asked(rng: np.random.Generator, sizes: Integers) -> tuple[Integers, Floats]:
    """Return which of a turn's vanes asks, and when after the first, in s, by time [sum] each."""
    first_s = rng.uniform(*WAITS_S)
    begin_s = rng.uniform(0.0, 3 * first_s, len(sizes))
    wait = (GROWS ** np.arange(sizes.max()) - 1) / (GROWS - 1)
    which = np.repeat(np.arange(len(sizes)), sizes)
    at_s = np.concatenate([begin_s[k] + first_s * wait[:size] for k, size in enumerate(sizes)])
    order = np.argsort(at_s, kind="stable")
    return which[order], at_s[order] - at_s.min()


def _hearing(rng: np.random.Generator, place: Floats, count: int) -> Integers:
    """Return which vanes hear a tag [count]: the nearer, the sooner, and none twice."""
    far = np.linalg.norm(VANES_M - place, axis=1)
    odds = np.exp(-far / 16.0)
    return np.asarray(rng.choice(VANES, count, replace=False, p=odds / odds.sum()), np.int64)


def _course(rng: np.random.Generator, gang: str) -> dict[str, float]:
    """Return the course of a tag that keeps off vanes and stays in the works."""
    ways: dict[str, Callable[[np.random.Generator], dict[str, float]]] = {
        "raker": _raker, "tipper": _tipper, "harvester": _harvester, "punt": _punt,
    }  # fmt: skip
    while True:
        made = ways[gang](rng) | {"gang": float(list(GANGS).index(gang))}
        made |= {"goes": 1.0, "done_s": 0.0}
        at = gone({name: np.full(19, made[name]) for name in COURSE}, np.linspace(0.0, LASTS_S, 19))
        near_m = np.linalg.norm(at[:, None] - VANES_M, axis=2).min()
        inside = (at[:, :2] > 1.0).all() and (at[:, :2] < np.array(WORKS_M) - 1.0).all()
        if near_m > NEAREST_M and inside:
            return made


def _begun(rng: np.random.Generator, low_m: float, high_m: float) -> dict[str, float]:
    """Return where a tag begins, anywhere in the works."""
    at = {"from_x": rng.uniform(3.0, WORKS_M[0] - 3.0), "from_y": rng.uniform(3.0, 43.0)}
    return at | {"from_z": rng.uniform(low_m, high_m)}


def _raker(rng: np.random.Generator) -> dict[str, float]:
    """Return a raker's course along a bed's edge."""
    goes = {"bears": rng.uniform(-np.pi, np.pi), "speed": rng.choice([-1.0, 1.0]) * 0.22}
    return _begun(rng, 0.7, 1.3) | goes | {"lasts": rng.uniform(2.6, 4.2), "swing": 1.25}


def _tipper(rng: np.random.Generator) -> dict[str, float]:
    """Return a tipper's course along the causeway, north or south of the dyke between pans."""
    goes = {"bears": np.pi * float(rng.integers(2)), "speed": rng.uniform(1.0, 2.4), "swing": 0.0}
    aside = {"from_y": rng.choice([19.2, 26.6])}
    return _begun(rng, 1.35, 1.5) | aside | goes | {"lasts": rng.uniform(0.5, 1.6)}


def _harvester(rng: np.random.Generator) -> dict[str, float]:
    """Return a harvester's course inward about the middle of a pan."""
    middle = {"from_x": rng.choice([13.0, 32.0, 51.0]), "from_y": rng.choice([11.5, 34.0])}
    goes = {"speed": rng.choice([-1.0, 1.0]) * rng.uniform(0.9, 1.6)}
    turns = {"bears": rng.uniform(-np.pi, np.pi), "lasts": rng.uniform(0.06, 0.16)}
    return _begun(rng, 2.3, 2.7) | middle | goes | turns | {"swing": rng.uniform(4.5, 9.5)}


def _punt(rng: np.random.Generator) -> dict[str, float]:
    """Return a punt's course before the wind."""
    goes = {"bears": rng.uniform(-np.pi, np.pi), "speed": rng.uniform(0.9, 1.9)}
    return _begun(rng, 0.5, 0.9) | goes | {"lasts": rng.uniform(0.8, 3.0),
                                           "swing": rng.uniform(-0.03, 0.03)}  # fmt: skip


def _logged(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is logged for each row [n]: of raw mornings and of afternoons that bake."""
    each = rng.normal(size=(8, len(since_s)))
    return {
        "temperature_c": rng.triangular(1.0, 17.0, 38.0) + 1.2 * each[0],
        "reply_time_s": (0.0085 * np.exp(0.52 * each[1])).clip(0.0028, 0.03),
        "wind_ms": (rng.uniform(0.8, 15.5) + 0.9 * each[2]).clip(0.2, 18.0),
        "brine_cm": (rng.uniform(3.0, 30.0) + 1.1 * each[3]).clip(1.0, 33.0),
        "crust_um": rng.gamma(1.4, 30.0) + rng.gamma(1.3, 6.0, len(since_s)),
        "iodine_ug": rng.lognormal(1.7, 0.95) * np.exp(0.22 * each[4]),
        "heap_m": (rng.uniform(1.4, 12.5) + 0.45 * each[5]).clip(1.1, 14.0),
        "gulls": rng.binomial(16, rng.beta(1.1, 1.2), len(since_s)).astype(np.float64),
        "haul_a": (rng.uniform(4.0, 90.0) + 4.0 * each[6]).clip(1.0, 99.0),
        "haul_m": rng.uniform(0.0, 870.0) + 1.7 * since_s + 0.3 * np.abs(each[7]),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: a belt's trough of steel by lot, else some things.

    Boards and piers where tags are low, the boiling house on long ways, hoardings anywhere.
    """
    links = rows.drop_duplicates("link")
    low, far = links["tx_z_m"].lt(1.0).to_numpy(), links["true_range_m"].gt(17.0).to_numpy()
    odds = np.stack([0.12 + 0.26 * low, 0.05 + 0.24 * far, 0.06 + 0.16 * low,
                     np.full(len(low), 0.14)], axis=1)  # fmt: skip
    met = rng.random(odds.shape) < odds * (0.4 if rare in RARELY else 1.0)
    count = round(BEHIND_STEEL[bool(rare)] * len(links))
    steel = {*rng.choice(links["link"].to_numpy(str), count, replace=False)}
    some = {
        link: ["metal"] if link in steel else [*np.array(THROUGH)[own]]
        for link, own in zip(links["link"], met, strict=True)
    }
    return [[str(what) for what in some[link]] for link in rows["link"]]
