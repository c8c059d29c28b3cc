"""A day at the shipyard: who is ranged on which job, when, and what is between.

numpy and pandas alone. On each job one tag is answered by some derricks, in rounds. Derricks answer
at marks of a ruler no two of which are as far apart as two others (Golomb), and take the next mark
each round.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.shipyard_slip import (
    COURSE,
    DERRICKS,
    DERRICKS_M,
    DOCK_M,
    KINDS,
    PLACES,
    TAGS,
    TIDE_S,
    come_to,
    inside_m,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HEARD_BY: Integers = np.repeat(np.arange(2, 8), [3, 5, 6, 5, 5, 3])
"""By how many derricks a job's tag is heard."""
OF_ROWS: Integers = np.repeat(np.arange(1, 12), [17, 17, 16, 15, 14, 12, 10, 8, 6, 4, 2])
"""How many rows links have."""
RESTS = 6  # jobs whose tag rests
ROUNDS, ROUND_S, RULER = 14, 0.213, (0, 1, 4, 10, 18, 23, 25)  # of a job; its marks, of 30
NEAREST_M, FREE_M, SEEN_S = 2.7, 0.8, 4.1  # to derricks; to sides; until when both are seen to
HALF_M = 11.0  # over which who is twice as far is heard a quarter as often
THROUGH = ("wood", "foam", "plywood", "glass")
"""Staging, mats for the tanks, moulds of ribs, panes of the drawing loft."""
STEEL = {False: 0.155, True: 0.055}  # of links, and where these are rare
RARELY = ("blocked-path", "diffraction")
Drawn = dict[str, float]


def manned(rng: np.random.Generator, rare: str, of_rows: Integers = OF_ROWS) -> pd.DataFrame:
    """Return what is known of the rows of a day."""
    crews = rng.permutation(HEARD_BY)
    ends = np.cumsum(crews)
    lengths = rng.permutation(of_rows)
    tags = rng.permutation(np.arange(len(crews)) % len(TAGS))
    rests = {*rng.choice(len(crews), RESTS, replace=False).tolist()}
    clock_s = TIDE_S * np.sort(rng.uniform(0.0, 0.997, len(crews)))
    jobs = []
    for job, (crew, end) in enumerate(zip(crews, ends, strict=True)):
        made = _job(rng, job, TAGS[tags[job]], lengths[end - crew : end], float(job not in rests))
        jobs.append(made.assign(time_s=made["time_s"] + clock_s[job]))
    rows = pd.concat(jobs, ignore_index=True)
    rows["obstacles"] = _between(rng, rows, rare)
    rows = rows.assign(los=[not some for some in rows["obstacles"]], channel=3, prf_mhz=64.0)
    return rows.assign(**{f"room_{axis}_m": DOCK_M[k] for k, axis in enumerate("xyz")})


def _job(
    rng: np.random.Generator, job: int, tag: str, lengths: Integers, goes: float
) -> pd.DataFrame:
    """Return the rows of one job by time, with places of its tag."""
    kind = tag.rstrip("0123456789")
    course = _course(rng, kind) | {"goes": goes, "into_s": rng.uniform(0.15, 0.8)}
    derricks = _hearing(rng, _along(course, np.zeros(1))[0], len(lengths))
    order, since_s = rung(rng, lengths)
    who = derricks[order]
    at, top = _along(course, since_s), DERRICKS_M[who]
    made = pd.DataFrame({name: course[name] + 0 * since_s for name in COURSE})
    made = made.assign(into_s=made["into_s"] + since_s, time_s=since_s, tx=tag)
    for end, place in (("tx", at), ("rx", top)):
        made[[f"{end}_{axis}_m" for axis in "xyz"]] = place
    run, faces = top - at, rng.uniform(0.0, 360.0)
    return made.assign(
        rx=np.char.add("derrick", who.astype(str)),
        link=[f"job {job} at derrick{k}" for k in who],
        environment=PLACES[kind],
        azimuth_deg=(np.degrees(np.arctan2(run[:, 1], run[:, 0])) - faces) % 360.0,
        true_range_m=np.sqrt((run**2).sum(axis=1)),
        **_logged(rng, since_s),
    )


def _along(course: Drawn, since_s: Floats) -> Floats:
    """Return where a tag is some time after a job began, in m [n, 3]."""
    whole = {name: np.full(since_s.shape, one) for name, one in course.items()}
    return come_to(whole, since_s + course["into_s"])


def rung(rng: np.random.Generator, lengths: Integers) -> tuple[Integers, Floats]:
    """Return which of a job's derricks answers, and when after the first, in s, by time [sum].

    `lengths`: how many times each does, of no more than ROUNDS, by lot.
    """
    asked = np.argsort(rng.random((len(lengths), ROUNDS)), axis=1) < np.asarray(lengths)[:, None]
    who, when = np.nonzero(asked)
    mark = np.array(RULER)[(who + when) % len(RULER)]
    at_s = ROUND_S * (when + mark / 30.0)
    order = np.argsort(at_s)
    return who[order].astype(np.int64), at_s[order] - at_s.min()


def _hearing(rng: np.random.Generator, at: Floats, count: int) -> Integers:
    """Return so many derricks that hear a tag in a place, near ones the more likely.

    Who waits least is first, of waits that grow with the square of how far (Efraimidis 2006).
    """
    far = np.sqrt(((DERRICKS_M - at) ** 2).sum(axis=1))
    waits = rng.standard_exponential(DERRICKS) * (1 + (far / HALF_M) ** 2)
    return np.argsort(waits)[:count].astype(np.int64)


def _course(rng: np.random.Generator, kind: str) -> Drawn:
    """Return the course of a tag that keeps off derricks and sides."""
    ways: dict[str, Callable[[np.random.Generator], Drawn]] = {
        "cradle": _cradle, "drum": _drum, "hauler": _hauler, "punt": _punt,
    }  # fmt: skip
    when = np.arange(0.0, SEEN_S, 0.1)
    while True:
        made = {"up": 0.0, "goes": 1.0, "into_s": 0.0, "begins": 0.0} | ways[kind](rng)
        made |= {"kind": float([*KINDS].index(kind))}
        at = _along(made, when)
        near = np.linalg.norm(at[:, None] - DERRICKS_M, axis=2).min()
        if near > NEAREST_M and inside_m(at[:, 0], at[:, 1]).min() > FREE_M:
            return {name: made[name] for name in COURSE}


def _somewhere(rng: np.random.Generator) -> Drawn:
    """Return a place anywhere in the dock, and a bearing."""
    east, north = np.array(DOCK_M[:2]) * rng.random(2)
    return {"east": float(east), "north": float(north), "bears": 2 * np.pi * rng.random()}


def _cradle(rng: np.random.Generator) -> Drawn:
    """Return a cradle's course: `pace` is what it comes to, `size` what pulls, in m/s2."""
    goes = {"pace": rng.uniform(1.9, 3.4), "size": rng.uniform(0.6, 1.3)}
    return _somewhere(rng) | goes | {"up": rng.uniform(1.1, 2.4)}


def _drum(rng: np.random.Generator) -> Drawn:
    """Return a drum's course: `size` is half as wide as it is."""
    goes = {"pace": rng.uniform(0.7, 1.3), "size": rng.uniform(0.6, 1.1)}
    return _somewhere(rng) | goes | {"begins": rng.uniform(-np.pi, np.pi)}


def _hauler(rng: np.random.Generator) -> Drawn:
    """Return a hauler's course: `size` of a capstan's half, radians that are off it already."""
    goes = {"pace": rng.uniform(1.0, 1.8), "size": rng.uniform(0.5, 1.0)}
    return _somewhere(rng) | goes | {"begins": rng.uniform(1.5, 5.0), "up": rng.uniform(0.9, 1.6)}


def _punt(rng: np.random.Generator) -> Drawn:
    """Return a punt's course on a line of `size` m."""
    goes = {"pace": rng.uniform(1.2, 2.0), "size": rng.uniform(2.5, 5.5)}
    return _somewhere(rng) | goes | {"begins": rng.uniform(0.5, 1.6), "up": rng.uniform(0.4, 0.8)}


def _logged(rng: np.random.Generator, since_s: Floats) -> dict[str, Floats]:
    """Return what is logged for each row [n]: of a frosty morning, or of a hot noon.

    `keel_m` is how far along the keel a crane has come.
    """

    def about(mean: float, by: float, low: float, high: float) -> Floats:
        return np.asarray((mean + by * rng.standard_normal(len(since_s))).clip(low, high))

    odd = rng.beta(1.2, 1.5)
    return {
        "temperature_c": about(rng.uniform(4.0, 30.0), 0.4, 2.0, 32.0),
        "reply_time_s": 0.0034 + 0.0086 * rng.beta(1.35, 1.35, len(since_s)),
        "weld_a": about(420.0 * rng.beta(0.8, 0.9), 5.0, 0.0, 420.0),
        "salt_g": about(rng.gamma(1.5, 3.6), 0.12, 0.0, 24.0),
        "weed_cm": about(rng.uniform(0.8, 24.0), 0.25, 0.3, 25.0),
        "anvil_gap_m": about(0.8 + 2.9 * rng.beta(1.0, 1.4), 0.03, 0.75, 3.8),
        "wetted_h": np.exp(rng.uniform(-1.8, 2.9) + 0.07 * rng.standard_normal(len(since_s))),
        "shackles": rng.binomial(32, odd, len(since_s)).astype(np.float64),
        "draught_m": about(rng.uniform(1.4, 4.8), 0.05, 1.2, 5.0),
        "fog_m": about(rng.uniform(0.1, 8.5), 0.05, 0.0, 9.0),
        "tide_m": about(2.7 - 2.4 * np.cos(np.pi * rng.random() * 2), 0.03, 0.0, 5.5),
        "ballast_t": about(rng.uniform(-64.0, 64.0), 1.0, -66.0, 66.0),
        "keel_m": rng.uniform(0.0, 120.0) + 1.1 * since_s + rng.uniform(0.0, 0.5, len(since_s)),
    }


def _between(rng: np.random.Generator, rows: pd.DataFrame, rare: str) -> list[list[str]]:
    """Return what straight ways go through: a stack of ribs of steel by lot, or else some things.

    Staging along the hull, mats by the tanks, moulds in the west, panes where derricks are high.
    """
    links = rows.groupby("link", sort=False).first()
    crosses = (links["tx_y_m"] - 19.0) * (links["rx_y_m"] - 19.0) < 0
    high, west = links["rx_z_m"] > 5.5, links["tx_x_m"] < 22.0
    odds = np.column_stack([0.14 + 0.26 * crosses, 0.06 + 0.2 * (links["rx_z_m"] > 8.0),
                            0.05 + 0.24 * west, 0.06 + 0.14 * high])  # fmt: skip
    met = rng.random(odds.shape) < odds * (0.4 if rare in RARELY else 1.0)
    count = round(STEEL[bool(rare)] * len(links))
    steel = np.isin(np.arange(len(links)), rng.choice(len(links), count, replace=False))
    some = [["metal"] if is_steel else [*np.array(THROUGH)[own]]
            for is_steel, own in zip(steel, met, strict=True)]  # fmt: skip
    by_link = dict(zip(links.index, some, strict=True))
    return [[str(what) for what in by_link[link]] for link in rows["link"]]
