"""A shift of the saw mill: which tags ask which braces, where these are, and what stands between.

numpy and pandas alone. At each stint a tag asks from three to six braces, one after the other,
round after round; each brace hears it in some rounds in a row.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.sawmill_yard import (
    BRACES,
    BRACES_M,
    COURSE,
    HALL_M,
    KILNS_M,
    KINDS,
    PLACES,
    SHIFT_S,
    SITE_M,
    TAGS,
    THROUGH,
    Stint,
    brought,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
ASKED: Integers = np.repeat(np.arange(3, 7), [6, 8, 6, 4])
"""How many braces stints ask."""
OF_ROWS: Integers = np.repeat(np.arange(1, 14), [12, 13, 12, 11, 10, 9, 9, 8, 7, 6, 4, 2, 1])
"""How many rows links have."""
IDLE = 6  # stints whose tag stands
ROUND_S, UNEVEN_S, NEXT_S = 0.38, 0.03, 0.055  # a round; how uneven it is; to the next brace
SLOT_S, RETRIES = 0.0072, 0.3  # of replies; how likely another one is needed
NEAREST_M = 1.7  # that tags come to braces
BEHIND_STEEL = {False: 0.17, True: 0.06}  # of links, and where these are rare
RARELY = ("blocked-path", "diffraction")


def shift(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a shift."""
    asked, sizes = rng.permutation(ASKED), rng.permutation(of_rows)
    begins_s = np.sort(SHIFT_S * rng.random(len(asked)))
    idle = set(rng.choice(len(asked), IDLE, replace=False).tolist())
    lots = np.split(sizes, np.cumsum(asked)[:-1])
    stints = [_stint(rng, k, lot, float(begins_s[k]), k in idle) for k, lot in enumerate(lots)]
    rows = pd.concat(stints, ignore_index=True).assign(channel=1, prf_mhz=64.0)
    rows["obstacles"] = _between(rng, rows, rare)
    rows["los"] = rows["obstacles"].map(len) == 0
    return rows


def _stint(
    rng: np.random.Generator, number: int, sizes: Integers, begin_s: float, idle: bool
) -> pd.DataFrame:
    """Return the rows of one stint, by time."""
    who = int(rng.integers(len(TAGS)))
    which, round_, since_s = _rounds(rng, sizes)
    one = _course(rng, KINDS.index(TAGS[who].rstrip("0123456789")))
    one |= {"goes": 0.0 if idle else 1.0}
    course = {name: np.full(len(which), value) for name, value in one.items()}
    course["into_s"] = rng.uniform(0.05, 0.4) * one["lasts_s"] + since_s
    course["asked"] = pd.Series(since_s).groupby(round_).rank().to_numpy(np.float64) - 1.0
    there = brought(course, course["into_s"])
    brace = _braces(rng, there, len(sizes))[which]
    ends = {"tx": there, "rx": BRACES_M[brace]}
    at = {f"{end}_{a}_m": p[:, k] for end, p in ends.items() for k, a in enumerate("xyz")}
    return pd.DataFrame(course | at | _logged(rng, there, begin_s, which)).assign(
        tx=TAGS[who],
        rx=[f"brace{k}" for k in brace],
        link=[f"stint {number} from brace{k}" for k in brace],
        environment=PLACES[int(one["kind"])],
        true_range_m=np.linalg.norm(there - ends["rx"], axis=1),
        azimuth_deg=_bearing(rng, course, ends["rx"]),
        time_s=begin_s + since_s,
    )


def _rounds(rng: np.random.Generator, sizes: Integers) -> tuple[Integers, Integers, Floats]:
    """Return which brace is asked in which round, and when in s, by time, [sum of sizes] each."""
    begins_s = np.cumsum(rng.uniform(ROUND_S - UNEVEN_S, ROUND_S + UNEVEN_S, int(sizes.max())))
    first = rng.integers(0, sizes.max() - sizes + 1)
    which = np.repeat(np.arange(len(sizes)), sizes)
    round_ = np.concatenate([k + np.arange(n) for k, n in zip(first, sizes, strict=True)])
    since_s = begins_s[round_] + NEXT_S * which
    order = np.argsort(since_s)
    return which[order], round_[order], since_s[order] - since_s.min()


def _course(rng: np.random.Generator, kind: int) -> dict[str, float]:
    """Return the course of a tag, at up to 2.8 m/s, that stays on the site."""
    begins = {"at_x": 0.0, "at_y": 0.0, "at_z": 0.0}
    made = dict.fromkeys(COURSE, 0.0) | {"kind": float(kind), "lasts_s": rng.uniform(8.0, 11.0)}
    while True:
        made |= begins | {"heads": rng.uniform(0.0, 2 * np.pi)} | (_grapple, _carriage, _forklift,
            _sawyer)[kind](rng)  # fmt: skip
        steps = np.linspace(0.0, 1.0, 9) * made["lasts_s"]
        some = {name: np.full(9, value) for name, value in made.items()} | {"goes": np.ones(9)}
        at = brought(some, steps)
        near_m = np.linalg.norm(at[:, None] - BRACES_M, axis=2).min()
        inside = (at[:, :2] > 1.0).all() and (at[:, :2] < np.array(SITE_M) - 1.0).all()
        if inside and near_m > NEAREST_M:
            return made


def _grapple(rng: np.random.Generator) -> dict[str, float]:
    """Return a grapple's course over the yard."""
    at = {"at_x": rng.uniform(4.0, 26.0), "at_y": rng.uniform(5.0, 37.0)}
    return at | {"at_z": rng.uniform(1.2, 2.6), "pace": rng.uniform(6.0, 13.0),
                 "curl": rng.uniform(0.5, 2.6)}  # fmt: skip


def _carriage(rng: np.random.Generator) -> dict[str, float]:
    """Return a carriage's course along one of two saws."""
    at = {"at_x": rng.uniform(38.0, 49.0), "at_y": float(rng.choice([15.5, 25.0])), "at_z": 1.4}
    return at | {"pace": rng.uniform(2.2, 3.6), "bend": rng.uniform(0.5, 0.75)}


def _forklift(rng: np.random.Generator) -> dict[str, float]:
    """Return a forklift's course anywhere."""
    at = {"at_x": rng.uniform(8.0, 66.0), "at_y": rng.uniform(4.0, 38.0)}
    turns = {"bend": rng.normal(0.0, 0.07), "curl": rng.normal(0.0, 0.012)}
    return at | turns | {"at_z": rng.uniform(1.6, 2.4), "pace": rng.uniform(0.9, 2.3)}


def _sawyer(rng: np.random.Generator) -> dict[str, float]:
    """Return a sawyer's course in the hall or before kilns."""
    at = {"at_x": rng.uniform(33.0, 66.0), "at_y": rng.uniform(9.0, 33.0)}
    return at | {"at_z": rng.uniform(0.9, 1.6), "pace": rng.uniform(0.7, 1.4),
                 "curl": rng.uniform(-0.35, 0.35)}  # fmt: skip


def _bearing(rng: np.random.Generator, course: dict[str, Floats], fixed: Floats) -> Floats:
    """Return where braces are from the way a tag faces, mounted anyhow, in degrees [n]."""
    now, soon = (brought(course, course["into_s"] + step) for step in (-0.02, 0.02))
    faces = np.arctan2(soon[:, 1] - now[:, 1], soon[:, 0] - now[:, 0])
    to = fixed - 0.5 * (now + soon)
    mounted = 2 * np.pi / 9 * rng.integers(9)
    return np.asarray(np.degrees(np.arctan2(to[:, 1], to[:, 0]) - faces - mounted) % 360.0)


def _braces(rng: np.random.Generator, there: Floats, count: int) -> Integers:
    """Return which braces a tag asks [count], in turn: near ones mostly, by lots (Gumbel)."""
    far = np.linalg.norm(BRACES_M - there.mean(axis=0), axis=1)
    return np.argsort(far / 11.0 - rng.gumbel(size=BRACES))[:count].astype(np.int64)


def _logged(
    rng: np.random.Generator, there: Floats, begin_s: float, which: Integers
) -> dict[str, Floats]:
    """Return what is logged for each row: it is warm and damp before kilns, and warmer by and by.

    Replies come in the order in which braces are asked; some are repeated.
    """
    n, part = len(there), begin_s / SHIFT_S
    kiln = np.exp(-((KILNS_M[0] - there[:, 0]).clip(0.0) / 9.0))
    warm_c = 6.0 + 11.0 * part**0.7 + rng.normal(0.0, 3.0) + 15.0 * kiln
    damp = rng.uniform(38.0, 66.0) + 20.0 * kiln
    again = rng.geometric(1 - RETRIES, n) - 1.0
    reply_s = 0.005 + SLOT_S * which + 0.009 * again + rng.uniform(0.0, 0.003, n)
    return {
        "temperature_c": warm_c + rng.normal(0.0, 1.5, n),
        "humidity_pct": np.clip(damp + rng.normal(0.0, 3.0, n), 25.0, 97.0),
        "reply_time_s": reply_s.clip(max=0.052),
        "resin_g": rng.exponential(9.0) + rng.gamma(2.0, 2.0, n),
        "dust_cm": np.clip(rng.uniform(1.0, 15.0) + rng.normal(0.0, 1.4, n), 0.3, 18.0),
        "strain_kn": np.clip(rng.uniform(5.0, 24.0) + rng.normal(0.0, 1.5, n), 4.0, 27.0),
        "vent_kgs": np.clip(12.0 * rng.beta(0.9, 0.9) + rng.normal(0.0, 1.3, n), 0.1, 14.0),
        "chain_m": rng.uniform(0.0, 70.0) + np.cumsum(rng.exponential(0.33, n)),
        "load_t": np.clip(rng.uniform(0.2, 2.6) + rng.normal(0.0, 0.2, n), 0.0, 3.0),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: kiln cars and banded stacks of steel by lot, else more.

    Stacks where ways are low, partitions between inside and outside of the hall, walls of kilns
    near these, panes of cabs where forklifts are.
    """
    stint = Stint(rows, 0, rng)
    first = np.unique(stint.link, return_index=True)[1]
    there, fixed = stint.there[first], stint.fixed[first]
    seldom = 0.42 if rare in RARELY else 1.0
    apart = _inside(there) != _inside(fixed)
    odds = {
        "wood": 0.12 + 0.3 * np.exp(-(fixed[:, 2] - 2.0).clip(0.0) / 3.0),
        "chipboard": 0.04 + 0.42 * apart,
        "brick": 0.03 + 0.17 * (fixed[:, 0] > HALL_M[1]),
        "glass": 0.03 + 0.3 * stint.of_kind("forklift")[first],
    }
    met = {what: rng.random(len(first)) < seldom * odds[what] for what in THROUGH}
    count = round(BEHIND_STEEL[bool(rare)] * len(first))
    steel = np.isin(np.arange(len(first)), rng.choice(len(first), count, replace=False))
    some = [
        ["metal"] if steel[k] else [what for what in THROUGH if met[what][k]]
        for k in range(len(first))
    ]
    return [list(some[k]) for k in stint.link]


def _inside(at: Floats) -> NDArray[np.bool_]:
    """Return whether places [n, 3] are in the saw hall [n]."""
    x, y = at[:, 0], at[:, 1]
    west, east, south, north, _ = HALL_M
    return np.asarray((x > west) & (x < east) & (y > south) & (y < north), np.bool_)
