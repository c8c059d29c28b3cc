"""An evening at the planetarium: who calls in which show, when, and what is between.

numpy and pandas alone. In each show one tag calls some coves, each of them as the beam of the
lamp turns past it; coves begin and end their answers with some turn of it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.planetarium_dome import (
    BEARINGS,
    COURSE,
    COVES,
    COVES_M,
    EVENING_S,
    HALL_M,
    KINDS,
    MIDDLE_M,
    PLACES,
    TAGS,
    clear_m,
    come_by,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat(np.arange(3, 8), [7, 5, 6, 4, 4])
"""How many coves a show's tag calls."""
OF_ROWS: Integers = np.repeat(np.arange(1, 11), [22, 19, 17, 15, 13, 11, 9, 7, 6, 4])
"""How many rows links have."""
RESTS = 6  # shows whose tag rests
TURNS, TURN_S = 14, 0.31  # of the beam, in a show
NEAREST_M, FREE_M, SEEN_S = 1.7, 0.35, 7.0  # to coves; to sides; until when both are seen to
HEARS_M = 8.5  # by which a cove is called e times less
THROUGH = ("wood", "concrete", "glass", "plasterboard")
"""Backs of seats, piers, panes of the console's booth, walls of the vestibule."""
METAL = {False: 0.15, True: 0.055}  # of links behind the orrery's drum; where these are rare
BOOTH, VESTIBULE = 0.7, 3.9  # bearings of these
RARELY = ("blocked-path", "diffraction")
Drawn = dict[str, float]


def shown(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of an evening."""
    casts = rng.permutation(HEARD_BY)
    lengths = np.split(rng.permutation(of_rows), np.cumsum(casts)[:-1])
    tags = rng.permutation(np.arange(len(casts)) % len(TAGS))
    moves = rng.permutation(np.arange(len(casts)) >= RESTS)
    opens_s = np.sort(rng.uniform(0.0, EVENING_S - 10.0, len(casts)))
    shows = []
    for k, own in enumerate(lengths):
        rows = _show(rng, TAGS[tags[k]], own, float(moves[k]))
        link = f"show {k} at " + rows["rx"]
        shows.append(rows.assign(link=link, time_s=rows["time_s"] + opens_s[k]))
    rows = pd.concat(shows, ignore_index=True)
    rows["obstacles"] = _between(rng, rows, rare)
    rows = rows.assign(los=rows["obstacles"].map(len).eq(0), channel=5, prf_mhz=64.0)
    return rows.assign(**dict(zip(("room_x_m", "room_y_m", "room_z_m"), HALL_M, strict=True)))


def _show(rng: np.random.Generator, tag: str, lengths: Integers, goes: float) -> pd.DataFrame:
    """Return the rows of one show by time, with places of its tag."""
    kind = tag.rstrip("0123456789")
    course = _course(rng, kind) | {"goes": goes, "into_s": rng.uniform(0.2, 2.0)}
    coves = _called(rng, _along(course, np.zeros(1))[0], len(lengths))
    order, since_s = swept(rng, coves, lengths)
    at, post = _along(course, since_s), COVES_M[order]
    made = pd.DataFrame({name: course[name] + 0 * since_s for name in COURSE})
    made = made.assign(into_s=made["into_s"] + since_s, time_s=since_s, tx=tag)
    made["rx"] = [f"cove{k}" for k in order]
    for end, place in (("tx", at), ("rx", post)):
        made[[f"{end}_{axis}_m" for axis in "xyz"]] = place
    run, faces = post - at, rng.uniform(-180.0, 180.0)
    return made.assign(
        environment=PLACES[kind],
        azimuth_deg=(np.degrees(np.arctan2(run[:, 1], run[:, 0])) - faces + 180.0) % 360.0 - 180.0,
        true_range_m=np.linalg.norm(run, axis=1),
        **_noted(rng, since_s),
    )


def _along(course: Drawn, since_s: Floats) -> Floats:
    """Return where a tag is some time after a show began, in m [n, 3]."""
    whole = {name: one + 0 * since_s for name, one in course.items()}
    return come_by(whole, whole["into_s"] + since_s)


def swept(rng: np.random.Generator, coves: Integers, lengths: Integers) -> tuple[Integers, Floats]:
    """Return which cove is called, and when after the first, in s, by time [sum of lengths].

    As the beam turns past; `lengths`: how many turns on end each cove answers.
    """
    who = np.repeat(coves, lengths)
    begins = np.repeat(rng.integers(0, TURNS - lengths, endpoint=True), lengths)
    count = np.concatenate([np.arange(one) for one in lengths.tolist()])
    at_s = TURN_S * (begins + count + BEARINGS[who] / (2 * np.pi))
    order = np.argsort(at_s)
    return who[order].astype(np.int64), at_s[order] - at_s.min()


def _called(rng: np.random.Generator, at: Floats, count: int) -> Integers:
    """Return so many coves that a tag in a place calls, near ones the more likely."""
    odds = np.exp(-np.linalg.norm(COVES_M - at, axis=1) / HEARS_M)
    return rng.choice(COVES, count, replace=False, p=odds / odds.sum()).astype(np.int64)


def _course(rng: np.random.Generator, kind: str) -> Drawn:
    """Return the course of a tag that keeps off coves and sides."""
    when = np.arange(0.0, SEEN_S, 0.1)
    while True:
        made = {"goes": 1.0, "into_s": 0.0, "kind": float(list(KINDS).index(kind))}
        made |= {"bears": rng.uniform(0.0, 2 * np.pi), "sense": float(rng.choice([-1.0, 1.0]))}
        made |= SETS_OFF[kind](rng)
        at = _along(made, when)
        near = np.linalg.norm(at[:, None] - COVES_M, axis=2).min()
        if near > NEAREST_M and clear_m(at).min() > FREE_M:
            return {name: made[name] for name in COURSE}


def _planet(rng: np.random.Generator) -> Drawn:
    return {"out": rng.uniform(2.6, 5.6), "up": rng.uniform(0.8, 1.7), "size": rng.beta(5.0, 7.0),
            "rate": rng.uniform(0.22, 0.4), "phase": rng.uniform(0.0, 2 * np.pi)}  # fmt: skip


def _moon(rng: np.random.Generator) -> Drawn:
    return {"out": rng.uniform(2.0, 6.5), "up": rng.uniform(0.9, 1.8),
            "size": rng.uniform(0.6, 1.1), "rate": rng.uniform(0.2, 0.4),
            "phase": rng.uniform(0.0, 2 * np.pi)}  # fmt: skip


def _usher(rng: np.random.Generator) -> Drawn:
    out = rng.uniform(4.5, 10.2)
    return {"out": out, "up": rng.uniform(0.9, 1.4), "size": rng.uniform(0.03, 0.1),
            "rate": rng.uniform(0.8, 1.6) / out, "phase": rng.uniform(4.5, 6.0)}  # fmt: skip


def _comet(rng: np.random.Generator) -> Drawn:
    return {"out": rng.uniform(-5.0, 5.0), "up": rng.uniform(3.0, 5.2),
            "size": rng.uniform(2.5, 4.8), "rate": rng.uniform(0.28, 0.5),
            "phase": rng.uniform(0.0, 2 * np.pi)}  # fmt: skip


def _trolley(rng: np.random.Generator) -> Drawn:
    return {"out": rng.uniform(10.2, 10.9), "up": 0.0, "size": 0.0,
            "rate": rng.uniform(0.06, 0.12), "phase": rng.uniform(0.12, 0.85)}  # fmt: skip


SETS_OFF: dict[str, Callable[[np.random.Generator], Drawn]] = {
    "planet": _planet, "moon": _moon, "usher": _usher, "comet": _comet, "trolley": _trolley,
}  # fmt: skip


def _noted(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is noted for each row [n], of which most is a show's, but for a little.

    `rack_m` is how far a rack has gone by, `tins_gap_m` how far off tins of slides are stacked.
    """
    rows = len(since_s)

    def about(middle: float, by: float, low: float, high: float) -> Floats:
        return np.asarray((middle + by * rng.standard_normal(rows).clip(-2.2, 2.2)).clip(low, high))

    return {
        "temperature_c": about(rng.uniform(6.0, 35.0), 0.3, 4.0, 37.0),
        "reply_time_s": 0.005 + 0.0085 * np.sqrt(rng.random(rows)),
        "arc_a": about(rng.triangular(0.0, 25.0, 90.0), 1.1, 0.0, 95.0),
        "felt_mm": about(rng.exponential(7.0), 0.1, 0.0, 30.0),
        "humid_pct": about(rng.uniform(18.0, 96.0), 0.7, 15.0, 98.0),
        "tins_gap_m": about(rng.triangular(0.7, 0.9, 3.0), 0.02, 0.68, 3.1),
        "programmes": rng.poisson(rng.gamma(1.6, 9.0), rows).clip(max=60).astype(np.float64),
        "switched_min": np.exp(rng.uniform(-0.7, 4.8) + about(0.0, 0.04, -0.1, 0.1)),
        "fog_ml": about(rng.uniform(0.2, 1.0) ** 2 * 60.0, 0.5, 0.5, 62.0),
        "rack_m": rng.uniform(0.0, 90.0) + 0.9 * since_s + rng.uniform(0.0, 0.6, rows),
        "mains_v": about(rng.uniform(212.0, 231.0), 0.25, 210.0, 233.0),
        "haze_pct": about(100.0 * rng.beta(1.3, 1.7), 1.0, 0.0, 100.0),
        "sun_w_m2": about(rng.uniform(0.0, 900.0), 8.0, 0.0, 920.0),
    }


def _toward(bearing: Floats, at: float) -> NDArray[np.bool_]:
    """Return which bearings are within 50 degrees of one [n]."""
    return np.asarray(np.cos(bearing - at) > np.cos(np.radians(50.0)))


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: the orrery's iron drum by lot, or else some things.

    Seats the more the lower ways are, piers by how far these are, and by bearings of coves the
    booth and the vestibule.
    """
    ends = rows.groupby("link", sort=False)[
        ["rx_x_m", "rx_y_m", "rx_z_m", "tx_z_m", "true_range_m"]
    ].first()
    bears = np.arctan2(ends["rx_y_m"] - MIDDLE_M[1], ends["rx_x_m"] - MIDDLE_M[0]).to_numpy()
    low = 1 / (1 + (ends[["rx_z_m", "tx_z_m"]].mean(axis=1) / 2.6) ** 2)
    odds = np.column_stack([0.05 + 0.27 * low, 0.02 + 0.007 * ends["true_range_m"],
                            0.06 + 0.3 * _toward(bears, BOOTH),
                            0.05 + 0.27 * _toward(bears, VESTIBULE)])  # fmt: skip
    met = rng.random(odds.shape) < odds * (0.4 if rare in RARELY else 1.0)
    iron = rng.permutation(len(ends)) < round(METAL[bool(rare)] * len(ends))
    some = {
        link: ["metal"] if drum else [THROUGH[k] for k in np.flatnonzero(own)]
        for link, drum, own in zip(ends.index, iron, met, strict=True)
    }
    return [[*some[link]] for link in rows["link"]]
