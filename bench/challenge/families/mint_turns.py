"""A day at the mint: which quoins call whose tag, between which strikes, and what is between.

numpy and pandas alone. In each turn one tag is called by some quoins; presses strike by an uneven
beat, and each quoin calls after some of the strikes, at an instant of its own.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.mint_court import (
    COURSE,
    COURT_M,
    DAY_S,
    KINDS,
    PLACES,
    QUOINS,
    QUOINS_M,
    REED_M,
    ROOM_M,
    TAGS,
    inside_m,
    taken,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Bools = NDArray[np.bool_]
CALLS: Integers = np.repeat([3, 4, 5, 6, 8], [4, 5, 7, 5, 4])
"""How many quoins call a turn's tag."""
OF_ROWS: Integers = np.repeat(np.arange(1, 12), [18, 19, 18, 17, 16, 14, 11, 7, 5, 3, 1])
"""How many rows links have."""
RESTS = 6  # turns whose tag rests, each of another tag that has one in which it goes
STRIKES, BEAT_S, AFTER_S = 14, (0.27, 0.4), 0.2  # of a turn; between these; until called
NEAREST_M, FREE_M, SEEN_S = 1.4, 0.3, 8.4  # to quoins; to sides; until when both are seen to
CARRIES_M = 13.0  # over which a quoin is less likely to call, to 1 / e
GRILLES = {False: 0.14, True: 0.05}  # of links behind gold in racks; where these are rare
LESS = {False: 1.0, True: 0.4}  # of all else then
RARELY = ("blocked-path", "diffraction")
Drawn = dict[str, float]


def passed(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    order, calls = rng.permutation(len(TAGS)), rng.permutation(CALLS)
    counts = np.split(rng.permutation(of_rows), np.cumsum(calls)[:-1])
    begins_s = np.sort(rng.uniform(0.0, DAY_S - 12.0, len(calls)))
    again = rng.permutation(len(calls) - len(TAGS))[:RESTS]  # of tags that have two turns
    rests = again + len(TAGS) * rng.integers(0, 2, len(again))
    turns = [
        _turn(rng, number, TAGS[order[number % len(TAGS)]], own, begins_s[number],
              number not in rests)
        for number, own in enumerate(counts)
    ]  # fmt: skip
    rows = pd.concat(turns, ignore_index=True)
    rows["obstacles"] = _between(rng, rows, rare)
    return rows.assign(
        los=rows["obstacles"].str.len().eq(0), channel=9, prf_mhz=64.0,
        **{f"room_{axis}_m": size for axis, size in zip("xyz", ROOM_M, strict=True)},
    )  # fmt: skip


def called(rng: np.random.Generator, counts: Integers) -> tuple[Integers, Floats]:
    """Return which of the quoins call, and when after the first in s, [sum of counts] each.

    Each has its instant after strikes, and of these it takes as many as it has rows, by lot.
    """
    strikes_s = np.cumsum(rng.uniform(*BEAT_S, STRIKES))
    instants = AFTER_S * (rng.random() + np.arange(len(counts)) * 0.618034) % AFTER_S
    who = np.repeat(np.arange(len(counts)), counts)
    which = np.concatenate([rng.choice(STRIKES, count, replace=False) for count in counts])
    at_s = strikes_s[which] + instants[who] + 0.003 * rng.random(len(who))
    order = np.argsort(at_s)
    return who[order].astype(np.int64), at_s[order] - at_s.min()


def _turn(
    rng: np.random.Generator, number: int, tag: str, counts: Integers, begin_s: float, moving: bool
) -> pd.DataFrame:
    """Return the rows of one turn by time, with places of its tag."""
    kind = tag.rstrip("0123456789")
    course = course_of(rng, kind) | {"moving": float(moving)}
    begun = rng.uniform(0.2, 1.8)
    away = np.linalg.norm(QUOINS_M - _at(course, np.array([begun])), axis=1)
    weigh = np.exp(-away / CARRIES_M)
    quoins = rng.choice(QUOINS, len(counts), replace=False, p=weigh / weigh.sum())
    which, since_s = called(rng, counts)
    ends = {"tx": QUOINS_M[quoins[which]], "rx": _at(course, begun + since_s)}
    known = {name: np.full(len(which), course[name]) for name in COURSE}
    known["into_s"] = begun + since_s
    known |= {
        f"{end}_{axis}_m": at[:, k] for end, at in ends.items() for k, axis in enumerate("xyz")
    }
    way = ends["tx"] - ends["rx"]
    faces = np.degrees(np.arctan2(way[:, 1], way[:, 0])) - rng.uniform(0.0, 360.0)
    return pd.DataFrame(known | _beside(rng, since_s)).assign(
        time_s=begin_s + since_s, tx=[f"quoin{k}" for k in quoins[which]], rx=tag,
        environment=PLACES[kind], link=[f"turn {number} from quoin{k}" for k in quoins[which]],
        azimuth_deg=(faces + 180.0) % 360.0 - 180.0, true_range_m=np.linalg.norm(way, axis=1),
    )  # fmt: skip


def _at(course: Drawn, into_s: Floats) -> Floats:
    """Return where a tag is some time into its course, in m [n, 3]."""
    return taken({name: np.full(len(into_s), one) for name, one in course.items()}, into_s)


def course_of(rng: np.random.Generator, kind: str) -> Drawn:
    """Return the course of a tag that keeps off quoins and sides."""
    seen_s = np.linspace(0.0, SEEN_S, 106)
    for _ in range(20_000):
        made = dict.fromkeys(COURSE, 0.0) | {"moving": 1.0, "way": float([*KINDS].index(kind))}
        made |= {"begins": rng.uniform(-np.pi, np.pi), "mid_x": rng.uniform(1.0, 37.0),
                 "mid_y": rng.uniform(1.0, 29.0)} | BEGINS[kind](rng)  # fmt: skip
        at = _at(made, seen_s)
        if inside_m(at).min() < FREE_M:
            continue
        if np.linalg.norm(at[:, None] - QUOINS_M, axis=2).min() > NEAREST_M:
            return made
    raise AssertionError(kind)


def _press(rng: np.random.Generator) -> Drawn:
    return {"mid_x": rng.uniform(26.0, 37.0), "mid_z": rng.uniform(1.5, 2.1),
            "bears": rng.uniform(-np.pi, np.pi), "fast": rng.uniform(0.7, 1.2),
            "size": rng.uniform(0.8, 1.5), "second": rng.uniform(0.9, 1.7)}  # fmt: skip


def _truck(rng: np.random.Generator) -> Drawn:
    return {"mid_z": rng.uniform(0.7, 1.3), "bears": rng.choice(4) * 0.5 * np.pi,
            "fast": rng.uniform(0.6, 1.2),
            "second": rng.choice([-1.0, 1.0]) * rng.uniform(0.04, 0.11)}  # fmt: skip


def _warder(rng: np.random.Generator) -> Drawn:
    return {"mid_z": rng.uniform(1.1, 1.6), "bears": rng.choice(4) * 0.5 * np.pi,
            "fast": rng.uniform(0.13, 0.24), "size": rng.uniform(1.6, 3.0),
            "second": rng.uniform(0.7, 1.5)}  # fmt: skip


def _coil(rng: np.random.Generator) -> Drawn:
    return {"mid_y": rng.uniform(21.0, 29.0), "mid_z": rng.uniform(0.8, 1.8),
            "fast": rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 1.0),
            "size": rng.uniform(0.5, 1.0), "second": rng.uniform(0.25, 0.6)}  # fmt: skip


def _ladle(rng: np.random.Generator) -> Drawn:
    return {"mid_x": rng.uniform(1.0, 12.0), "mid_z": rng.uniform(1.6, 3.6),
            "bears": rng.choice(4) * 0.5 * np.pi + rng.normal(0.0, 0.15),
            "size": rng.uniform(3.0, 6.5), "second": rng.uniform(5.5, 7.5)}  # fmt: skip


def _courier(rng: np.random.Generator) -> Drawn:
    return {"mid_z": rng.uniform(1.0, 1.5), "bears": rng.choice(4) * 0.5 * np.pi,
            "fast": rng.uniform(0.7, 1.3), "size": rng.choice([-1.0, 1.0]) * rng.uniform(1.6, 3.6),
            "second": rng.uniform(1.5, 4.5)}  # fmt: skip


BEGINS: dict[str, Callable[[np.random.Generator], Drawn]] = dict(
    zip(KINDS, (_press, _truck, _warder, _coil, _ladle, _courier), strict=True)
)


def _beside(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is written down beside each row of a turn, [n] each."""
    count = len(since_s)

    def near(one: float, by: float, low: float, high: float) -> Floats:
        return np.asarray(np.clip(one + by * rng.uniform(-1.7, 1.7, count), low, high))

    return {
        "temperature_c": near(rng.uniform(7.0, 36.0), 0.2, 6.0, 37.0),
        "reply_time_s": 0.0045 + 0.0095 * rng.beta(1.3, 1.3, count),
        "furnace_kw": near(30.0 * rng.beta(1.0, 1.5), 0.3, 0.0, 31.0),
        "dust_mg": near(40.0 * rng.beta(0.9, 1.4), 0.3, 0.1, 41.0),
        "fume_ppm": near(70.0 * rng.beta(0.9, 1.3), 0.4, 0.2, 72.0),
        "strip_mm": near(rng.uniform(0.8, 9.0), 0.06, 0.6, 9.2),
        "fluxed_h": near(rng.uniform(0.3, 26.0), 0.1, 0.1, 26.5),
        "hopper_m": near(0.75 + rng.gamma(1.3, 0.65), 0.02, 0.7, 5.0),
        "bullion_t": near(6.0 * rng.beta(1.0, 1.2), 0.04, 0.0, 6.2),
        "anneal_min": near(rng.uniform(0.0, 48.0), 0.2, 0.0, 48.0),
        "reed_m": rng.uniform(0.0, 60.0) + 1.3 * since_s + REED_M * rng.random(count),
        "flue_c": near(rng.uniform(140.0, 370.0), 2.0, 130.0, 380.0),
        "gate_cm": near(rng.uniform(5.0, 16.0), 0.1, 4.5, 16.5),
        "vault_pa": near(rng.normal(0.0, 22.0), 0.6, -60.0, 60.0),
        "hall_pa": near(rng.normal(0.0, 22.0), 0.6, -60.0, 60.0),
        "fans_pa": near(rng.uniform(-6.0, 6.0), 0.15, -6.5, 6.5),
        "door_deg": near(95.0 * rng.beta(0.8, 1.0), 0.4, 0.0, 96.0),
    }


def over_the_court(one: Floats, other: Floats) -> Bools:
    """Return whether straight ways between ends [n, 3] go over the open court [n].

    (Cyrus and Beck 1978.)
    """
    way = other[:, :2] - one[:, :2]
    way = np.where(np.abs(way) < 1e-9, 1e-9, way)
    cuts = np.stack([(COURT_M[k] - one[:, :2]) / way for k in (0, 1)])
    enters = cuts.min(axis=0).max(axis=1).clip(min=0.0)
    leaves = cuts.max(axis=0).min(axis=1).clip(max=1.0)
    return np.asarray(leaves > enters)


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: racks of gold by lot, the likelier the lower.

    Else brick where they go over the court, concrete from the strongroom, marble counters where
    they are low, chipboard of crates and glass by their lengths.
    """
    first = rows.drop_duplicates("link")
    ends = [first[[f"{end}_{a}_m" for a in "xyz"]].to_numpy(np.float64) for end in ("tx", "rx")]
    middle, long_m = 0.5 * (ends[0] + ends[1]), np.linalg.norm(ends[0] - ends[1], axis=1)
    weigh = np.exp(-0.5 * middle[:, 2])
    picked = rng.choice(len(first), round(GRILLES[bool(rare)] * len(first)), replace=False,
                        p=weigh / weigh.sum())  # fmt: skip
    odds = {
        "concrete": np.where(first["environment"].eq("strongroom"), 0.2, 0.02),
        "marble": np.where(middle[:, 2] < 2.4, 0.3, 0.05),
        "chipboard": 0.03 + 0.016 * long_m, "glass": 0.02 + 0.012 * long_m,
    }  # fmt: skip
    met = {"brick": over_the_court(*ends)} | {
        what: rng.random(len(first)) < LESS[rare in RARELY] * odd for what, odd in odds.items()
    }
    some = [[what for what, there in met.items() if there[k]] for k in range(len(first))]
    for k in picked:
        some[k] = ["metal"]
    by_link = dict(zip(first["link"], some, strict=True))
    return [list(by_link[link]) for link in rows["link"]]
