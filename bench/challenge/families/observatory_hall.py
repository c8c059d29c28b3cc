"""The observatory: tubes, chairs, trolleys and climbers in its hall of instruments, and their rows.

numpy and pandas alone. Sconces along four walls have radios. Tubes turn about the pole of the sky;
observers' chairs run to and fro on round rails; trolleys with mirrors are pushed off from rest;
climbers go up and down winding stairs, by helices.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
HALL_M = (30.0, 22.0, 10.0)
SCONCES_M: Floats = np.array([
    (0.4, 4.0, 3.2), (0.5, 11.5, 6.8), (0.4, 18.6, 4.4), (7.5, 21.6, 5.6), (15.2, 21.5, 2.9),
    (23.1, 21.6, 7.1), (29.6, 18.2, 3.7), (29.5, 10.6, 6.2), (29.6, 3.1, 4.9), (22.4, 0.4, 3.4),
    (14.6, 0.5, 7.4), (7.0, 0.4, 5.2),
])  # fmt: skip
"""Where sconces are, in m: three along each wall, round the hall."""
SCONCES = len(SCONCES_M)
SORTS = {"tube": 4, "chair": 3, "trolley": 2, "climber": 3}
"""How many tags there are of each sort."""
TAGS = tuple(f"{sort}{k}" for sort, count in SORTS.items() for k in range(count))
PLACES = {"tube": "mounts", "chair": "rails", "trolley": "mirror way", "climber": "stairs"}
COURSE = (
    "sort", "base_x", "base_y", "base_z", "bears", "speed", "lasts", "arm", "tilt", "moves",
    "into_s",
)  # fmt: skip
"""How a tag goes, known to nobody; see `reached`."""
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 4.4928  # channel 3
NIGHT_S = 9.2 * 3600
LATITUDE_RAD = np.radians(41.9)  # of the Roman College
ROLLERS_M = 4.7  # of the dome's curb from one roller to the next
WIDE_DEG = 58.0  # from which a slit stands wide open
CANNA_M = 2.234  # of Roman architects: ten palms
LAWS = {
    "dew-films-sconces": Law(("saturation", "logarithm", "power")),
    "hoar-grows-on-roof": Law(("power", "parabola")),
    "iron-pier-close-by": Law(("inverse", "power", "inverse square")),
    "silvering-tarnishes": Law(("logarithm", "power", "saturation")),
    "guests-lean-on-rails": Law(("linear", "power")),
    "dome-rollers-pass": Law(("periodic",), ROLLERS_M, "m", grows=False),
    "slit-stands-wide-open": Law(("step",), 0.092, "m"),
    "mist-comes-in-by-the-slit": Law(),
    "pole-set-for-another-city": Law(),
    "stairs-of-a-lower-rise": Law(),
    "red-lamps-warm-their-sconces": Law(),
    "north-wall-leans-out": Law(),
    "sconce-knocked-by-a-ladder": Law(("position",), 0.45, "m", devices=("sconce7",)),
    "sconces-lettered-crosswise": Law(("swap",), devices=("sconce1", "sconce9")),
    "canne-from-one-sconce": Law(("unit",), 1 / CANNA_M, "1", grows=False, devices=("sconce4",)),
}
"""What nobody's library has."""
Course = Mapping[str, Floats]


@dataclass(frozen=True)
class Toll:
    """What rows [n] bear: `late_m` of range; dB of all, of first paths, of noise, of counts."""

    late_m: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def _place(course: Course, east: Floats, north: Floats, up: Floats | float) -> Floats:
    """Return places so far from the bases of courses, in m [n, 3]."""
    return np.column_stack(
        [course["base_x"] + east, course["base_y"] + north, course["base_z"] + up]
    )


def turned_rad(course: Course, gone_s: Floats) -> Floats:
    """Return by how much tubes have turned, in radians [n]: their pace grows by half a cosine."""
    ramp = course["lasts"]
    slow = 0.5 * (gone_s - ramp / np.pi * np.sin(np.pi * gone_s / ramp))
    fast = gone_s - 0.5 * ramp
    pace = course["speed"] / (course["arm"] * np.cos(course["tilt"]))
    return np.asarray(pace * np.where(gone_s < ramp, slow, fast))


def aimed(course: Course, gone_s: Floats, latitude: Floats | float) -> Floats:
    """Return where tubes' ends are off their bases, east, north and up in m [n, 3].

    `tilt` is a declination, and `bears` the hour angle at first, both in radians.
    """
    hour = course["bears"] + turned_rad(course, gone_s)
    level, pole = np.cos(course["tilt"]) * np.cos(hour), np.sin(course["tilt"])
    east = -np.cos(course["tilt"]) * np.sin(hour)
    north = pole * np.cos(latitude) - level * np.sin(latitude)
    up = pole * np.sin(latitude) + level * np.cos(latitude)
    return np.asarray(course["arm"][:, None] * np.column_stack([east, north, up]))


def _tube(course: Course, gone_s: Floats) -> Floats:
    return _place(course, *aimed(course, gone_s, LATITUDE_RAD).T)


def _chair(course: Course, gone_s: Floats) -> Floats:
    """Return where chairs are: on round rails, to and fro by a sine."""
    swings = course["speed"] * course["lasts"] / course["arm"]
    angle = course["bears"] + swings * np.sin(gone_s / course["lasts"])
    return _place(course, course["arm"] * np.cos(angle), course["arm"] * np.sin(angle), 0.0)


def _trolley(course: Course, gone_s: Floats) -> Floats:
    """Return where trolleys are: their pace is a hyperbolic tangent of time."""
    along = course["speed"] * course["lasts"] * np.log(np.cosh(gone_s / course["lasts"]))
    return _place(course, along * np.cos(course["bears"]), along * np.sin(course["bears"]), 0.0)


def climbed_m(course: Course, gone_s: Floats) -> Floats:
    """Return how much higher climbers are in m [n]; `tilt` is how steep stairs are."""
    return np.asarray(course["speed"] * np.sin(course["tilt"]) * gone_s)


def _climber(course: Course, gone_s: Floats) -> Floats:
    """Return where climbers are: `arm` m from a newel, by a helix."""
    round_ = np.abs(course["speed"]) * np.cos(course["tilt"]) * gone_s / course["arm"]
    angle = course["bears"] + round_
    out = course["arm"] * np.stack([np.cos(angle), np.sin(angle)])
    return _place(course, out[0], out[1], climbed_m(course, gone_s))


WAYS: tuple[Callable[[Course, Floats], Floats], ...] = (_tube, _chair, _trolley, _climber)
"""Of sorts as in SORTS."""


def reached(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    every = np.stack([way(course, course["moves"] * into_s) for way in WAYS])
    return np.asarray(every[course["sort"].astype(np.int64), np.arange(len(into_s))])


class Exposure:
    """Rows of a table; `case` seeds what all tables of a case have alike, `rng` draws all else.

    `sconce`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare = table, case, rng, rare
        self.rows = len(table)
        sconces = table["rx"].str.removeprefix("sconce")
        self.sconce: Integers = np.asarray(sconces.to_numpy(str).astype(np.int64), np.int64)
        self.tag: Integers = np.array([TAGS.index(name) for name in table["tx"]], np.int64)
        links = np.unique(table["link"].to_numpy(str), return_inverse=True)
        self.link: Integers = np.array(links[1], np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 2703, what])

    def per_link(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what each link draws, at its rows [n]."""
        return np.asarray(draws(int(self.link.max()) + 1), np.float64)[self.link]

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def inner(self) -> Floats:
        """Where tags are said to be, in m [n, 3]."""
        return np.column_stack([self[f"tx_{axis}_m"] for axis in "xyz"])

    @cached_property
    def outer(self) -> Floats:
        """Where sconces are said to be, in m [n, 3]."""
        return np.column_stack([self[f"rx_{axis}_m"] for axis in "xyz"])

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def is_(self, sort: str) -> NDArray[np.bool_]:
        """Return which rows are of tags of a sort [n]."""
        return np.array([tag.rstrip("0123456789") == sort for tag in TAGS])[self.tag]

    def behind(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return np.array([float(what in some) for some in self.table["obstacles"]])

    def cut_off(self, share: float) -> Floats:
        """Return 1 at so many of all links by lot, of those behind something, else 0 [n]."""
        shut = np.array([len(some) > 0 for some in self.table["obstacles"]])
        among = np.unique(self.link[shut])
        count = min(max(1, round(share * (self.link.max() + 1))), len(among))
        chosen = self.rng.permutation(among)[:count]
        return np.isin(self.link, chosen).astype(np.float64)

    def longer(self, tag_m: Floats | float, sconce_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by so much [n, 3], in m [n]."""
        way = self.outer - self.inner
        moved = way + np.asarray(sconce_m) - np.asarray(tag_m)
        return np.asarray(np.linalg.norm(moved, axis=1) - np.linalg.norm(way, axis=1))

    def recedes_in(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        now_s = self.course["into_s"]
        return self.longer(reached(self.course, now_s + later_s) - reached(self.course, now_s))
