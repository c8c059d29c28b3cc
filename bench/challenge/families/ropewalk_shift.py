"""A shift at the ropewalk: who is ranged on which strand, when, and what is between.

numpy and pandas alone. On each strand one tag answers some struts. These call in rounds that are
now longer, now shorter; each begins and ends its own calls at some round, and has a place within
rounds by multiples of the golden section.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.ropewalk_walk import (
    COURSE,
    HALL_M,
    KINDS,
    PLACES,
    REACH,
    SHIFT_S,
    STRUTS,
    STRUTS_M,
    TAGS,
    come_to,
    within_m,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat(np.arange(2, 8), [5, 4, 5, 5, 5, 4])
"""How many struts a strand's tag answers."""
OF_ROWS: Integers = np.repeat(np.arange(1, 13), [20, 18, 17, 16, 14, 12, 9, 7, 5, 4, 2, 1])
"""How many rows links have."""
RESTS = 6  # strands whose tag rests
ROUNDS, ROUND_S = 15, 0.26  # of a strand
SWINGS, GOLDEN = 0.27, (np.sqrt(5) - 1) / 2  # of rounds, by which they begin sooner or later
NEAREST_M, FREE_M, SEEN_S = 2.1, 0.45, 6.7  # to struts; to sides; until when both are seen to
HALF_M = 15.0  # at which a strut is answered half as likely
THROUGH = ("wood", "brick", "chipboard", "plasterboard")
"""Racks of bobbins, piers of cross walls, hatches of the tar house, the clerk's partition."""
METAL = {False: 0.15, True: 0.055}  # of links, and where these are rare
RARELY = ("blocked-path", "diffraction")
Drawn = dict[str, float]


def worked(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a shift."""
    crews = rng.permutation(HEARD_BY)
    lengths = np.split(rng.permutation(of_rows), np.cumsum(crews)[:-1])
    tags = rng.permutation(np.arange(len(crews)) % len(TAGS))
    moves = rng.permutation(np.arange(len(crews)) >= RESTS)
    clock_s = np.sort(rng.uniform(0.0, SHIFT_S - 10.0, len(crews)))
    strands = [
        _strand(rng, TAGS[tags[k]], own, float(moves[k])).pipe(_numbered, k, clock_s[k])
        for k, own in enumerate(lengths)
    ]
    rows = pd.concat(strands, ignore_index=True)
    rows["obstacles"] = _between(rng, rows, rare)
    rows = rows.assign(los=rows["obstacles"].map(len).eq(0), channel=1, prf_mhz=64.0)
    return rows.assign(**dict(zip(("room_x_m", "room_y_m", "room_z_m"), HALL_M, strict=True)))


def _numbered(rows: pd.DataFrame, strand: int, clock_s: float) -> pd.DataFrame:
    link = f"strand {strand} at " + rows["tx"]
    return rows.assign(link=link, time_s=rows["time_s"] + clock_s)


def _strand(rng: np.random.Generator, tag: str, lengths: Integers, goes: float) -> pd.DataFrame:
    """Return the rows of one strand by time, with places of its tag."""
    kind = tag.rstrip("0123456789")
    course = _course(rng, kind) | {"goes": goes, "into_s": rng.uniform(0.3, 2.4)}
    struts = _calling(rng, _along(course, np.zeros(1))[0], len(lengths))
    order, since_s = called(rng, lengths)
    who = struts[order]
    at, post = _along(course, since_s), STRUTS_M[who]
    made = pd.DataFrame({name: course[name] + 0 * since_s for name in COURSE})
    made = made.assign(into_s=made["into_s"] + since_s, time_s=since_s, rx=tag)
    made["tx"] = [f"strut{k}" for k in who]
    for end, place in (("tx", post), ("rx", at)):
        made[[f"{end}_{axis}_m" for axis in "xyz"]] = place
    run, faces = post - at, rng.uniform(0.0, 360.0)
    return made.assign(
        environment=PLACES[kind],
        azimuth_deg=(np.degrees(np.arctan2(run[:, 1], run[:, 0])) - faces) % 360.0,
        true_range_m=np.linalg.norm(run, axis=1),
        **_logged(rng, since_s),
    )


def _along(course: Drawn, since_s: Floats) -> Floats:
    """Return where a tag is some time after a strand began, in m [n, 3]."""
    whole = {name: one + 0 * since_s for name, one in course.items()}
    return come_to(whole, whole["into_s"] + since_s)


def begun_s(rounds: Floats) -> Floats:
    """Return when rounds begin, in s [...]: these are uneven by a sine."""
    return ROUND_S * (rounds + SWINGS * np.sin(1.9 * rounds))


def called(rng: np.random.Generator, lengths: Integers) -> tuple[Integers, Floats]:
    """Return which of a strand's struts calls, and when after the first, in s, by time [sum].

    `lengths`: how many times each does, in rounds one after the other.
    """
    who = np.repeat(np.arange(len(lengths)), lengths)
    begins = rng.integers(0, ROUNDS - lengths, endpoint=True)
    count = np.concatenate([np.arange(one) for one in lengths.tolist()])
    slot = 0.4 * ROUND_S * ((0.3 + who * GOLDEN) % 1.0)
    at_s = begun_s((begins[who] + count).astype(np.float64)) + slot
    order = np.argsort(at_s)
    return who[order].astype(np.int64), at_s[order] - at_s.min()


def _calling(rng: np.random.Generator, at: Floats, count: int) -> Integers:
    """Return so many struts that a tag in a place answers, near ones the more likely."""
    far = np.linalg.norm(STRUTS_M - at, axis=1)
    odds = 1 / (1 + (far / HALF_M) ** 3)
    return rng.choice(STRUTS, count, replace=False, p=odds / odds.sum()).astype(np.int64)


def _course(rng: np.random.Generator, kind: str) -> Drawn:
    """Return the course of a tag that keeps off struts and sides."""
    when = np.arange(0.0, SEEN_S, 0.1)
    while True:
        made = {"goes": 1.0, "into_s": 0.0, "kind": float(list(KINDS).index(kind))}
        made |= {"east": rng.uniform(1.0, 87.0), "heads": float(rng.choice([-1.0, 1.0]))}
        made |= SETS_OUT[kind](rng)
        at = _along(made, when)
        near = np.linalg.norm(at[:, None] - STRUTS_M, axis=2).min()
        if near > NEAREST_M and within_m(at).min() > FREE_M:
            return {name: made[name] for name in COURSE}


def _spinner(rng: np.random.Generator) -> Drawn:
    return {"north": rng.uniform(1.8, 6.6), "up": rng.uniform(0.95, 1.3),
            "pace": rng.uniform(0.8, 1.5), "size": rng.uniform(0.3, 0.8),
            "turn": rng.uniform(4.5, 8.0)}  # fmt: skip


def _sledge(rng: np.random.Generator) -> Drawn:
    return {"north": rng.uniform(2.4, 6.0), "up": rng.uniform(0.6, 1.1),
            "pace": rng.uniform(1.15, 1.4), "size": rng.uniform(20.0, 26.0),
            "turn": rng.uniform(3.2, 5.0)}  # fmt: skip


def _top(rng: np.random.Generator) -> Drawn:
    return {"north": rng.uniform(2.6, 5.8), "up": rng.uniform(1.1, 1.5),
            "pace": rng.uniform(0.8, 1.4), "size": rng.uniform(0.3, 0.5),
            "turn": rng.uniform(0.0, 2 * np.pi)}  # fmt: skip


def _bobbin(rng: np.random.Generator) -> Drawn:
    arm = rng.uniform(0.8, 1.15)
    return {"north": rng.uniform(3.4, 5.0), "up": 0.6 + arm * (1 + REACH), "size": arm,
            "pace": rng.uniform(0.8, 1.3), "turn": rng.uniform(0.0, 2 * np.pi)}  # fmt: skip


def _truck(rng: np.random.Generator) -> Drawn:
    return {"north": rng.uniform(1.6, 6.8), "up": rng.uniform(1.4, 2.2), "pace": 0.0,
            "size": rng.uniform(7.0, 13.0), "turn": rng.uniform(7.5, 10.0)}  # fmt: skip


SETS_OUT: dict[str, Callable[[np.random.Generator], Drawn]] = {
    "spinner": _spinner, "sledge": _sledge, "top": _top, "bobbin": _bobbin, "truck": _truck,
}  # fmt: skip


def _logged(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is logged for each row [n], of which most is a strand's, but for a little.

    `spun_m` is how much yarn a wheel has spun, `copper_gap_m` how far off the copper is swung.
    """
    rows = len(since_s)

    def near(middle: float, by: float, low: float, high: float) -> Floats:
        return np.asarray((middle + by * rng.uniform(-1.7, 1.7, rows)).clip(low, high))

    return {
        "temperature_c": near(rng.uniform(3.0, 32.0), 0.35, 1.0, 34.0),
        "reply_time_s": 0.0042 + 0.0096 * rng.beta(1.2, 1.2, rows),
        "motor_a": near(310.0 * rng.beta(0.7, 0.8), 4.0, 0.0, 310.0),
        "tar_g": near(rng.gamma(1.4, 4.2), 0.15, 0.0, 26.0),
        "twist_rpm": near(rng.uniform(20.0, 280.0), 2.5, 15.0, 290.0),
        "copper_gap_m": near(0.7 + 3.4 * rng.beta(0.9, 1.5), 0.03, 0.65, 4.2),
        "oakum_bales": rng.binomial(26, rng.beta(1.1, 1.3), rows).astype(np.float64),
        "dressed_h": np.exp(rng.uniform(-1.6, 3.0) + near(0.0, 0.06, -0.1, 0.1)),
        "spun_m": rng.uniform(0.0, 150.0) + 1.3 * since_s + rng.uniform(0.0, 0.7, rows),
        "steam_bar": near(rng.uniform(2.2, 5.4), 0.05, 2.0, 5.6),
        "snow_cm": near(45.0 * rng.beta(0.9, 1.1), 0.4, 0.0, 46.0),
        "dust_g_m3": near(rng.gamma(2.2, 1.4), 0.08, 0.0, 12.0),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: iron of a machine by lot, or else some things.

    Racks by either wall, a pier for each so many m of the way, hatches in the west, the clerk's
    partition in the east.
    """
    ends = rows.groupby("link", sort=False)[["tx_x_m", "tx_y_m", "rx_x_m"]].first()
    long = (ends["tx_x_m"] - ends["rx_x_m"]).abs()
    west, east = ends["rx_x_m"] < 21.0, ends["rx_x_m"] > 64.0
    odds = np.column_stack([0.12 + 0.2 * ((ends["tx_y_m"] - 4.2).abs() > 3.0),
                            0.06 + 0.22 * (1 - np.exp(-long / 24.0)),
                            0.05 + 0.26 * west, 0.05 + 0.2 * east])  # fmt: skip
    met = rng.random(odds.shape) < odds * (0.4 if rare in RARELY else 1.0)
    iron = rng.permutation(len(ends)) < round(METAL[bool(rare)] * len(ends))
    some = {
        link: ["metal"]
        if is_iron
        else [what for what, one in zip(THROUGH, own, strict=True) if one]
        for link, is_iron, own in zip(ends.index, iron, met, strict=True)
    }
    return [list(some[link]) for link in rows["link"]]
