"""A day on the bowls green: which tags blink, which knots hear them, and what is between.

numpy and pandas alone. At each end one tag blinks, after gaps that a shift register draws, so that
two tags never meet again and again; from three to seven knots hear some of its blinks and answer
one after another.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.bowls_rinks import (
    COURSE,
    DAY_S,
    GREEN_M,
    KINDS,
    KNOTS,
    KNOTS_M,
    PLACES,
    TAGS,
    THROUGH,
    End,
    led,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat(np.arange(3, 8), [6, 5, 5, 5, 2])
"""How many knots hear ends."""
OF_ROWS: Integers = np.repeat(np.arange(1, 16), [14, 14, 13, 12, 11, 10, 8, 7, 5, 4, 3, 2, 2, 1, 1])
"""How many rows links have."""
LYING = 5  # ends whose tag rests
GAPS_S: Floats = np.array([0.17, 0.26, 0.35, 0.44])  # from one blink to the next
TURN_S = 0.0034  # from one answer to the next
NEAREST_M = 1.7  # that tags come to knots
BEHIND_STEEL = {False: 0.17, True: 0.055}  # of links, and where these are rare
RARELY = ("blocked-path", "diffraction")


def played(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    heard, sizes = rng.permutation(HEARD_BY), rng.permutation(of_rows)
    lots = np.split(sizes, np.cumsum(heard)[:-1])
    begins_s = np.sort(DAY_S * rng.beta(1.3, 1.1, len(heard)))
    lies = rng.permutation(len(heard)) < LYING
    who = rng.permutation(np.resize(np.arange(len(TAGS)), len(heard)))
    ends = [
        _end(rng, k, int(who[k]), lots[k], (float(begins_s[k]), bool(lies[k])))
        for k in range(len(heard))
    ]
    rows = pd.concat(ends, ignore_index=True).assign(channel=4, prf_mhz=64.0)
    rows["obstacles"] = _between(rng, rows, rare)
    return rows.assign(los=rows["obstacles"].map(len).eq(0))


def _end(
    rng: np.random.Generator, number: int, who: int, sizes: Integers, begins: tuple[float, bool]
) -> pd.DataFrame:
    """Return the rows of one end, by time; `begins`: when in s, and whether the tag lies still."""
    begin_s, lies = begins
    which, since_s = _answers(rng, sizes)
    kind = KINDS.index(TAGS[who].rstrip("0123456789"))
    one = _course(rng, kind) | {"runs": 0.0 if lies else 1.0}
    course = {name: np.full(len(which), value) for name, value in one.items()}
    course["into_s"] = rng.uniform(0.04, 0.3) * one["span_s"] + since_s
    there = led(course, course["into_s"])
    knot = _near(rng, there, len(sizes))[which]
    places = {"tx": there, "rx": KNOTS_M[knot]}
    at = {f"{e}_{a}_m": where[:, k] for e, where in places.items() for k, a in enumerate("xyz")}
    told = {"azimuth_deg": _facing(rng, course, places["rx"]), "time_s": begin_s + since_s}
    return pd.DataFrame(course | at | _logged(rng, there, begin_s) | told).assign(
        tx=TAGS[who],
        rx=[f"knot{k}" for k in knot],
        link=[f"end {number} to knot{k}" for k in knot],
        environment=PLACES[kind],
        true_range_m=np.linalg.norm(there - places["rx"], axis=1),
    )


def _answers(rng: np.random.Generator, sizes: Integers) -> tuple[Integers, Floats]:
    """Return which knot answers, and how long after the first answer in s, by time [sum] each."""
    blinks = int(sizes.max()) + int(rng.integers(0, 3))
    blink_s = np.cumsum(rng.choice(GAPS_S, blinks))
    turn = rng.permutation(len(sizes))
    parts = [blink_s[rng.permutation(blinks)[:size]] for size in sizes]
    which = np.repeat(np.arange(len(sizes)), sizes)
    since_s = np.concatenate(parts) + TURN_S * turn[which]
    order = np.argsort(since_s, kind="stable")
    return which[order], since_s[order] - since_s.min()


def _course(rng: np.random.Generator, kind: int) -> dict[str, float]:
    """Return the course of a tag that stays on the green."""
    ways: tuple[Callable[[np.random.Generator], dict[str, float]], ...]
    ways = (_bowl, _roller, _player, _umpire)
    while True:
        made = dict.fromkeys(COURSE, 0.0) | {"kind": float(kind), "span_s": rng.uniform(8.5, 10.5)}
        made |= ways[kind](rng)
        some = {name: np.full(13, value) for name, value in made.items()} | {"runs": np.ones(13)}
        at = led(some, np.linspace(0.0, 1.0, 13) * made["span_s"])
        near_m = np.linalg.norm(at[:, None] - KNOTS_M, axis=2).min()
        on = (at[:, :2] > 1.4).all() and (at[:, :2] < np.array(GREEN_M) - 1.4).all()
        if on and near_m > NEAREST_M:
            return made


def _from(rng: np.random.Generator, low_m: float, high_m: float) -> dict[str, float]:
    """Return where a tag begins."""
    at = {"from_x": rng.uniform(2.0, GREEN_M[0] - 2.0), "from_y": rng.uniform(2.0, 24.0)}
    return at | {"from_z": rng.uniform(low_m, high_m)}


def _bowl(rng: np.random.Generator) -> dict[str, float]:
    """Return a bowl's course from a mat at one end of a rink or the other."""
    sent = float(rng.integers(2))
    away = {"from_x": 3.0 + 36.0 * sent + rng.uniform(-1.2, 1.2)}
    goes = {"toward": np.pi * sent + rng.uniform(-0.06, 0.06), "quick": rng.uniform(2.9, 4.3)}
    bias = rng.choice([-1.0, 1.0]) * rng.uniform(0.1, 0.24)
    return _from(rng, 0.06, 0.07) | away | goes | {"bias": bias, "wide": rng.uniform(0.27, 0.36)}


def _roller(rng: np.random.Generator) -> dict[str, float]:
    """Return a roller's course along a rink."""
    wide = rng.uniform(5.0, 11.0)
    goes = {"toward": np.pi * float(rng.integers(2)), "bias": rng.uniform(0.0, 2 * np.pi)}
    return _from(rng, 0.5, 0.7) | goes | {"wide": wide, "quick": 4 * wide / rng.uniform(0.8, 1.5)}


def _player(rng: np.random.Generator) -> dict[str, float]:
    """Return a player's course after a bowl, or along a bank."""
    bias = rng.choice([-1.0, 1.0]) * rng.uniform(0.005, 0.05)
    goes = {"toward": rng.uniform(0.0, 2 * np.pi), "quick": rng.uniform(0.9, 1.7), "bias": bias}
    return _from(rng, 0.9, 1.5) | goes | {"wide": rng.uniform(0.3, 1.6)}


def _umpire(rng: np.random.Generator) -> dict[str, float]:
    """Return an umpire's course about a head."""
    goes = {"toward": rng.uniform(0.0, 2 * np.pi), "bias": rng.uniform(0.0, 2 * np.pi)}
    quick = rng.choice([-1.0, 1.0]) * rng.uniform(0.6, 1.2)
    return _from(rng, 1.0, 1.4) | goes | {"wide": rng.uniform(1.8, 4.0), "quick": quick}


def _facing(rng: np.random.Generator, course: dict[str, Floats], aloft: Floats) -> Floats:
    """Return where knots are from the way that a tag would go, worn anyhow, in degrees [n]."""
    gone = course | {"runs": np.ones(len(aloft))}
    ahead = led(gone, course["into_s"] + 0.04) - led(gone, course["into_s"] - 0.04)
    to = aloft - led(course, course["into_s"])
    turned = np.arctan2(to[:, 1], to[:, 0]) - np.arctan2(ahead[:, 1], ahead[:, 0])
    return np.asarray(np.degrees(turned + rng.uniform(0.0, 2 * np.pi)) % 360.0)


def _near(rng: np.random.Generator, there: Floats, count: int) -> Integers:
    """Return which knots hear a tag [count]: near ones mostly, and none twice."""
    far = np.linalg.norm(KNOTS_M - there.mean(axis=0), axis=1)
    odds = 1 / (1 + (far / 14.0) ** 2)
    return rng.choice(KNOTS, count, replace=False, p=odds / odds.sum()).astype(np.int64)


def _logged(rng: np.random.Generator, there: Floats, begin_s: float) -> dict[str, Floats]:
    """Return what is logged for each row: warm at noon, and the more so up the green's far end."""
    n, part = len(there), begin_s / DAY_S
    warm_c = 9.0 + 15.0 * np.sin(np.pi * part) + rng.normal(0.0, 2.4) + 0.16 * there[:, 0]
    reply_s = 0.0105 * (0.35 + rng.gamma(2.2, 0.5, n))
    return {
        "temperature_c": warm_c + rng.normal(0.0, 1.3, n),
        "reply_time_s": reply_s.clip(0.003, 0.05),
        "inside_pa": 245.0 + rng.triangular(-75.0, 0.0, 75.0) + rng.normal(0.0, 9.0, n),
        "wax_mg": rng.gamma(1.2, 14.0) + rng.gamma(1.5, 3.0, n),
        "nap_mm": np.clip(rng.uniform(0.6, 7.4) + rng.normal(0.0, 0.5, n), 0.3, 9.0),
        "blower_m": np.clip(rng.uniform(1.4, 11.0) + rng.normal(0.0, 0.6, n), 1.0, 12.5),
        "rain_mmh": rng.exponential(4.0) + rng.gamma(1.2, 0.7, n),
        "skirt_l": np.clip(900.0 * rng.beta(0.9, 0.9) + rng.normal(0.0, 70.0, n), 5.0, 1000.0),
        "loop_m": rng.uniform(0.0, 40.0) + np.cumsum(rng.gamma(2.0, 0.22, n)),
        "airlock_pct": np.clip(100 * rng.beta(0.7, 0.7) + rng.normal(0.0, 12.0, n), 0.0, 100.0),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: scoreboards of steel by lot, else more than one thing.

    Benches where ways begin low, hoardings along both banks, walls and panes of the club in a
    corner.
    """
    end = End(rows, 0, rng)
    first = np.unique(end.link, return_index=True)[1]
    (x, y, low), far = end.below[first].T, end.far[first]
    club = (x < 14.0) & (y < 10.0)
    seldom = 0.42 if rare in RARELY else 1.0
    odds = {
        "wood": 0.1 + 0.34 * np.exp(-low / 0.7),
        "chipboard": 0.06 + 0.36 * (np.abs(y - 13.0) > 8.0),
        "plasterboard": 0.04 + 0.3 * club + 0.1 * far / (far + 15.0),
        "glass": 0.03 + 0.3 * club,
    }
    met = {what: rng.random(len(first)) < seldom * odds[what] for what in THROUGH}
    steel = rng.permutation(len(first)) < round(BEHIND_STEEL[bool(rare)] * len(first))
    some = [
        ["metal"] if steel[k] else [what for what in THROUGH if met[what][k]]
        for k in range(len(first))
    ]
    return [list(some[k]) for k in end.link]
