"""The tram shed: a hall with an arcade and an office, who works there, and rows of these.

numpy and pandas alone. Rosettes, at which wires are held, call tags. Trams turn out at points;
traversers start and stop softly; sweepers weave sharply; jacks lift by strokes; blocks swing and
come to rest; trolley poles are walked round from rest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
SHED_M = (46.0, 31.0, 9.5)
ARCADE_Y, ARCADE_X = 19.5, (9.0, 41.0)
"""A brick wall along the shed, from roof to floor."""
ARCHES_X = ((15.0, 19.5), (28.0, 33.0))
"""Openings in the arcade."""
OFFICE_X, OFFICE_Y = 36.5, (0.0, 12.0)
"""A partition of glass across the shed."""
BOILER_M = (24.0, 13.0, 1.2)  # along, across and radius of a drying boiler
DAY_S = 11.0 * 3600
LIGHT_M_US = 299.792458
WAVE_M = 0.299792458 / 7.9872  # channel 9
ROSETTES_M: Floats = np.array([
    [0.6, 4.4, 5.2], [0.5, 12.2, 3.1], [0.7, 19.0, 6.8], [0.6, 27.2, 4.0], [7.6, 0.5, 6.0],
    [8.4, 15.6, 8.2], [7.9, 30.4, 2.8], [14.6, 8.0, 7.4], [15.8, 24.6, 8.6], [16.4, 0.6, 3.4],
    [20.8, 30.5, 5.6], [22.6, 18.6, 4.6], [26.2, 6.4, 8.8], [27.4, 0.5, 2.6], [29.8, 25.2, 7.0],
    [31.6, 14.4, 5.0], [34.8, 30.4, 3.6], [37.8, 0.6, 7.2], [38.6, 20.6, 2.9], [45.4, 6.2, 4.4],
    [45.5, 14.8, 6.4], [45.3, 25.8, 5.4],
])  # fmt: skip
ROSETTES = len(ROSETTES_M)
DUTIES = {"tram": 3, "traverser": 2, "sweeper": 3, "jack": 2, "block": 2, "pole": 2}
"""How many tags there are of each duty."""
TAGS = tuple(f"{duty}{k}" for duty, count in DUTIES.items() for k in range(count))
ROADS = {"tram": "running road", "traverser": "traverser pit", "sweeper": "washing road",
         "jack": "lifting road", "block": "truck shop", "pole": "turning road"}  # fmt: skip
COURSE = ("duty", "from_x", "from_y", "from_z", "points", "pace", "span", "curl", "phase",
          "goes", "into_s")  # fmt: skip
"""How a tag goes, known to nobody; see `at_duty`."""
SLEEPER_M = 0.73
GOVERNOR_BAR = 5.4  # under which a compressor is let run
BRACCIO_M = 0.5836
LAWS = {
    "sand-packs-in-its-boxes": Law(("saturation", "logarithm", "power")),
    "carbon-films-rosettes-since-wiped": Law(("logarithm", "power", "saturation")),
    "varnish-lies-thick-on-tags": Law(("linear", "power")),
    "slack-wire-lets-rosettes-hang": Law(("inverse", "power", "inverse square")),
    "tower-wagon-parked-close": Law(("inverse square", "inverse", "power")),
    "feeders-warm-by-their-current": Law(("power", "parabola")),
    "lamps-off-their-rated-voltage": Law(("parabola",)),
    "sleepers-pass-underneath": Law(("periodic",), SLEEPER_M, "m", grows=False),
    "air-governor-lets-the-compressor-run": Law(("step",), 0.091, "m"),
    "brake-dust-hangs-along-the-pits": Law(),
    "air-shimmers-about-the-drying-boiler": Law(),
    "feeder-sections-fed-by-turns": Law(),
    "relay-holds-between-two-pressures": Law(),
    "trams-turn-out-at-later-blades": Law(),
    "traversers-overrun-their-lever": Law(),
    "sweepers-weave-broader-than-told": Law(),
    "jacks-sink-between-strokes": Law(),
    "blocks-hang-on-longer-falls": Law(),
    "poles-trail-behind-their-rope": Law(),
    "places-drawn-to-the-middle-of-a-turn": Law(),
    "rosettes-hang-low-amid-their-spans": Law(),
    "survey-closed-without-its-misclosure": Law(),
    "girders-bow-under-lifted-cars": Law(),
    "setts-heave-with-frost": Law(),
    "answers-late-as-crews-change": Law(),
    "answers-merged-with-the-next": Law(),
    "first-answers-smeared-by-the-last-caller": Law(),
    "tape-spliced-past-a-mark": Law(),
    "ranges-told-as-chords-of-a-curve": Law(),
    "rosette-torn-by-a-dewired-pole": Law(("position",), 0.45, "m", devices=("rosette14",)),
    "rosettes-stencilled-for-each-other": Law(("swap",), devices=("rosette3", "rosette15")),
    "braccia-from-one-rosette": Law(("unit",), 1 / BRACCIO_M, "1", grows=False,
                                    devices=("rosette11",)),
}  # fmt: skip
"""What nobody's library has."""
Course = dict[str, Floats]
BLADES_M, SOFT_S, WEAVES, STROKE_S, RESTS_S, FROM_REST_S = 2.4, 9.0, 0.95, 2.2, 7.0, 1.8
"""Of turnouts; of traversers; radians a second; of jacks; of blocks to 1 / e; of poles."""


@dataclass(frozen=True)
class Fine:
    """What rows [n] are fined: m of range, dB of levels, of first paths, of noise, of counts."""

    late_m: Floats | float = 0.0
    level_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def room_m(at: Floats) -> Floats:
    """Return how far places [n, 3] are from walls, floor, roof and boiler in m [n]; < 0 beyond."""
    to_boiler = np.hypot(at[:, 0] - BOILER_M[0], at[:, 1] - BOILER_M[1]) - BOILER_M[2]
    return np.asarray(np.column_stack([at, np.array(SHED_M) - at, to_boiler]).min(axis=1))


def _from(course: Course, ahead: Floats, aside: Floats, up: Floats | float = 0.0) -> Floats:
    """Return places so far ahead, aside and up of where courses begin, in m [n, 3]."""
    east, north = np.cos(course["points"]), np.sin(course["points"])
    off = (ahead * east - aside * north, ahead * north + aside * east, up + 0.0 * ahead)
    begun = np.stack([course["from_x"], course["from_y"], course["from_z"]], axis=1)
    return np.asarray(begun + np.stack(off, axis=1))


def turns_out(course: Course, gone_s: Floats, later_m: float = 0.0) -> Floats:
    """Return where trams are, in m [n, 3]: straight on, `span` m aside past blades at `curl` m."""
    ahead = course["pace"] * gone_s
    blades = course["curl"] + later_m
    aside = np.tanh((ahead - blades) / BLADES_M) + np.tanh(blades / BLADES_M)
    return _from(course, ahead, 0.5 * course["span"] * aside)


def traverses(course: Course, gone_s: Floats, over: float = 0.0) -> Floats:
    """Return where traversers are, in m [n, 3]: as cycloids, faster and slower by turns."""
    turn = 2 * np.pi / SOFT_S
    soft = np.sin(turn * gone_s + course["phase"]) - np.sin(course["phase"])
    ahead = course["pace"] * (1 + over) * (gone_s - 0.8 * soft / turn)
    return _from(course, ahead, course["curl"] * ahead)


def weaves(course: Course, gone_s: Floats, broader: float = 0.0) -> Floats:
    """Return where sweepers are, in m [n, 3]: onward, to and fro at an even pace (a triangle)."""

    def side(at: Floats) -> Floats:
        return np.asarray(np.arcsin(0.96 * np.sin(at)) / np.arcsin(0.96))

    aside = side(WEAVES * gone_s + course["phase"]) - side(course["phase"])
    return _from(course, course["pace"] * gone_s, course["span"] * (1 + broader) * aside)


def jacked(course: Course, gone_s: Floats, sinks: float = 0.0) -> Floats:
    """Return where jacks are, in m [n, 3]: up by strokes, sinking again by a part of each."""
    stroke = 2 * np.pi * gone_s / STROKE_S
    up = gone_s - STROKE_S / (2 * np.pi) * np.sin(stroke)
    aside = course["span"] * np.expm1(-gone_s / 4.0)
    return _from(course, aside, 0.5 * aside, course["pace"] * (1 - sinks) * up)


def swings(course: Course, gone_s: Floats, longer: float = 0.0) -> Floats:
    """Return where blocks are, in m [n, 3]: in ellipses ever smaller, the slower if longer."""
    pace = course["pace"] / np.sqrt(1 + longer)

    def at(when: Floats) -> Complexes:
        angle = pace * when + course["phase"]
        arm = course["span"] * np.exp(-when / RESTS_S)
        return np.asarray(arm * (np.cos(angle) + 1j * course["curl"] * np.sin(angle)))

    off = at(gone_s) - at(0.0 * gone_s)
    return _from(course, off.real, off.imag)


def walked_round(course: Course, gone_s: Floats, trails: float = 0.0) -> Floats:
    """Return where ends of poles are, in m [n, 3]: round, from rest ever faster (a hyperbola)."""
    run_s = np.sqrt(gone_s**2 + FROM_REST_S**2) - FROM_REST_S
    angle = course["pace"] * run_s * (1 - trails)
    angle = angle + course["phase"]
    arm, begun = course["span"], course["phase"]
    ahead, aside = np.cos(angle) - np.cos(begun), np.sin(angle) - np.sin(begun)
    return _from(course, arm * ahead, arm * aside, 0.2 * arm * aside)


WAYS = (turns_out, traverses, weaves, jacked, swings, walked_round)


def at_duty(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = course["goes"] * np.maximum(into_s, 0.0)
    places = np.full((len(gone_s), 3), np.nan)
    for number, way in enumerate(WAYS):
        some = course["duty"] == number
        if some.any():
            places[some] = way({name: one[some] for name, one in course.items()}, gone_s[some])
    return places


def lengths(ways: Floats) -> Floats:
    """Return how long ways [n, 3] are in m [n]."""
    return np.asarray(np.sqrt(np.einsum("ij,ij->i", ways, ways)))


class Fares:
    """Rows of a table; `case` seeds what tables of a case have alike, `rng` draws all else.

    `tag`, `rosette` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare, self.rows = table, case, rng, rare, len(table)
        numbers = {tag: k for k, tag in enumerate(TAGS)}
        self.tag: Integers = np.asarray([numbers[one] for one in table["rx"]], np.int64)
        own = [int(one.removeprefix("rosette")) for one in table["tx"]]
        self.rosette: Integers = np.asarray(own, np.int64)
        codes, links = pd.factorize(table["link"], sort=True)
        self.link, self.links = np.asarray(codes, np.int64), len(links)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[column], np.float64)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have alike."""
        return np.random.default_rng([9503, what, self.case])

    def each_link(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what links draw, one each, at their rows [n]."""
        return np.asarray(draws(self.links)[self.link], np.float64)

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def tag_m(self) -> Floats:
        """Where tags are said to be, in m [n, 3]."""
        return np.column_stack([self[f"rx_{axis}_m"] for axis in "xyz"])

    @cached_property
    def rosette_m(self) -> Floats:
        """Where rosettes are said to be, in m [n, 3]."""
        return np.column_stack([self[f"tx_{axis}_m"] for axis in "xyz"])

    @cached_property
    def course(self) -> Course:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def on(self, duty: str) -> NDArray[np.bool_]:
        """Return which rows are of tags of a duty [n]."""
        return np.asarray(self.table["rx"].str.startswith(duty), np.bool_)

    def through(self, what: str) -> Floats:
        """Return how many such things straight ways go through [n]."""
        return np.array([sum(one == what for one in some) for some in self.table["obstacles"]],
                        np.float64)  # fmt: skip

    def shut_off(self, share: float) -> Floats:
        """Return 1 at a share of all links, by lot of those behind something, else 0 [n]."""
        behind = self.table["obstacles"].map(len).gt(0).to_numpy()
        some = self.rng.permutation(np.unique(self.link[behind]))
        return np.isin(self.link, some[: max(1, round(share * self.links))]).astype(np.float64)

    def longer_m(self, tag_off: Floats | float, rosette_off: Floats | float = 0.0) -> Floats:
        """Return by how much ways grow whose ends are off by so much in m [n, 3], in m [n]."""
        way = self.tag_m - self.rosette_m
        return np.asarray(lengths(way + tag_off - rosette_off) - lengths(way))

    def moves_off(self, later_s: Floats | float) -> Floats:
        """Return by how much ways grow some time later, in m [n]."""
        now = self.course["into_s"]
        return self.longer_m(at_duty(self.course, now + later_s) - at_duty(self.course, now))
