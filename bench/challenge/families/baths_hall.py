"""The swimming baths: swimmers, springers, scrubbers and riders of a slide, and rows of these.

numpy and pandas alone. Arches of the roof have radios, which caps and machines with tags hear.
Swimmers surge with every stroke; springers bounce along a board, ever less; scrubbers go round
figures of eight; riders slide down a spiral that narrows, ever nearer to their fastest.
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
BATHS_M = (40.0, 20.0, 8.0)
BASIN_M = ((7.0, 4.0), (32.0, 16.0))
"""Two corners of the basin, whose water is as high as the floor."""
ARCHES_M: Floats = np.array([
    (1.2, 3.2, 2.7), (6.4, 19.4, 4.8), (9.6, 0.6, 6.1), (14.8, 19.5, 2.6), (17.7, 0.5, 3.9),
    (20.3, 10.2, 7.6), (25.1, 19.4, 5.7), (27.9, 0.6, 2.8), (33.2, 19.3, 3.5), (35.6, 0.7, 5.2),
    (39.1, 12.4, 6.6),
])  # fmt: skip
"""Where arches have their radios, in m: on both sides by turns, at both ends, one amid the roof."""
ARCHES = len(ARCHES_M)
KINDS = {"swimmer": 4, "springer": 3, "scrubber": 2, "rider": 3}
"""How many tags there are of each kind."""
TAGS = tuple(f"{kind}{k}" for kind, count in KINDS.items() for k in range(count))
PLACES = {"swimmer": "basin", "springer": "boards", "scrubber": "decks", "rider": "slide"}
COURSE = (
    "kind", "from_x", "from_y", "from_z", "toward", "pace", "swell", "beat", "phase", "wears",
    "stirs", "into_s",
)  # fmt: skip
"""How a tag goes, known to nobody; see `carried`."""
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 7.9872  # channel 9
DAY_S = 10.5 * 3600
FLOATS_M = 5.3  # of a lane's rope, from one large float to the next
OPEN_PCT = 57.0  # from which the roof counts as rolled back
PASSO_M = 1.7388  # Venetian: five feet
LAWS = {
    "beads-of-water-on-arches": Law(("saturation", "logarithm", "power")),
    "scale-furs-the-nozzles": Law(("power", "parabola")),
    "steel-slide-close-by": Law(("inverse square", "power", "inverse")),
    "suncream-on-caps": Law(("logarithm", "power", "saturation")),
    "bathers-splash-about": Law(("linear", "power")),
    "lane-floats-pass": Law(("periodic",), FLOATS_M, "m", grows=False),
    "roof-rolled-back": Law(("step",), 0.088, "m"),
    "steam-room-left-ajar": Law(),
    "strokes-reach-less-far": Law(),
    "riders-ride-up-in-bends": Law(),
    "pumps-shake-their-arches": Law(),
    "deep-end-settles": Law(),
    "arch-struck-by-a-platform": Law(("position",), 0.42, "m", devices=("arch6",)),
    "arches-wired-crosswise": Law(("swap",), devices=("arch2", "arch8")),
    "passi-from-one-arch": Law(("unit",), 1 / PASSO_M, "1", grows=False, devices=("arch4",)),
}
"""What nobody's library has."""
Course = Mapping[str, Floats]


@dataclass(frozen=True)
class Splash:
    """What rows [n] bear: `late_m` of range; dB of all, of first paths, of noise, of counts."""

    late_m: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def _ahead(course: Course, along: Floats, across: Floats, up: Floats | float) -> Floats:
    """Return places so far along, across and above where courses begin, in m [n, 3]."""
    east, north = np.cos(course["toward"]), np.sin(course["toward"])
    return np.column_stack([
        course["from_x"] + east * along - north * across,
        course["from_y"] + north * along + east * across,
        course["from_z"] + up,
    ])  # fmt: skip


def swum_m(course: Course, gone_s: Floats) -> Floats:
    """Return how far swimmers have come in m [n]: with each stroke they surge."""
    turn = course["beat"] * gone_s + course["phase"]
    return np.asarray(
        course["pace"] * gone_s + course["swell"] * (np.sin(turn) - np.sin(course["phase"]))
    )


def _swimmer(course: Course, gone_s: Floats) -> Floats:
    bobs = 0.4 * course["swell"] * np.cos(course["beat"] * gone_s + course["phase"])
    return _ahead(course, swum_m(course, gone_s), np.zeros_like(gone_s), bobs)


def _springer(course: Course, gone_s: Floats) -> Floats:
    """Return where springers are: out along a board that swings, with a damping."""
    swings = np.exp(-gone_s / course["wears"]) * np.sin(course["beat"] * gone_s + course["phase"])
    return _ahead(course, course["pace"] * gone_s, np.zeros_like(gone_s), course["swell"] * swings)


def _scrubber(course: Course, gone_s: Floats) -> Floats:
    """Return where scrubbers are: on figures of eight (Gerono's), along and across."""
    turn = course["beat"] * gone_s + course["phase"]
    return _ahead(course, course["swell"] * np.sin(turn), course["wears"] * np.sin(2 * turn), 0.0)


def slid_m(course: Course, gone_s: Floats) -> Floats:
    """Return how far riders have slid in m [n]: what drags them grows with their pace."""
    lag = course["wears"]
    return np.asarray(course["pace"] * (gone_s + lag * np.expm1(-gone_s / lag)))


def round_rad(course: Course, gone_s: Floats) -> Floats:
    """Return where on their spiral riders are, in radians [n]."""
    narrower = 1 - course["beat"] * slid_m(course, gone_s) / course["swell"]
    return np.asarray(course["phase"] - np.log(narrower) / course["beat"])


def _rider(course: Course, gone_s: Floats) -> Floats:
    """Return where riders are: `swell` m from the slide's mast at first, by a logarithmic spiral.

    `beat` is by how much nearer to the mast they come for each metre; they fall as evenly.
    """
    slid = slid_m(course, gone_s)
    out, angle = course["swell"] - course["beat"] * slid, round_rad(course, gone_s)
    return _ahead(course, out * np.cos(angle), out * np.sin(angle), -0.22 * slid)


WAYS: tuple[Callable[[Course, Floats], Floats], ...] = (_swimmer, _springer, _scrubber, _rider)
"""Of kinds as in KINDS."""


def carried(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    gone_s = course["stirs"] * into_s
    found = np.zeros((len(into_s), 3))
    for number, way in enumerate(WAYS):
        own = course["kind"] == number
        found[own] = way({name: course[name][own] for name in COURSE}, gone_s[own])
    return found


class Heat:
    """Rows of a table; `case` seeds what all tables of a case have alike, `rng` draws all else.

    `arch`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare = table, case, rng, rare
        self.rows = len(table)
        self.arch: Integers = np.array([int(name[4:]) for name in table["tx"]], np.int64)
        self.tag: Integers = np.array([TAGS.index(name) for name in table["rx"]], np.int64)
        self.link: Integers = np.asarray(pd.factorize(table["link"])[0], np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def alike(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 2803, what])

    def each_link(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what each link draws, at its rows [n]."""
        return np.asarray(draws(int(self.link.max()) + 1), np.float64)[self.link]

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def low(self) -> Floats:
        """Where tags are said to be, in m [n, 3]."""
        return np.column_stack([self[f"rx_{axis}_m"] for axis in "xyz"])

    @cached_property
    def high(self) -> Floats:
        """Where arches are said to be, in m [n, 3]."""
        return np.column_stack([self[f"tx_{axis}_m"] for axis in "xyz"])

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def are(self, kind: str) -> NDArray[np.bool_]:
        """Return which rows are of tags of a kind [n]."""
        return np.array([tag.startswith(kind) for tag in TAGS])[self.tag]

    def through(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return np.array([float(what in some) for some in self.table["obstacles"]])

    def unseen(self, share: float) -> Floats:
        """Return 1 at so many of all links by lot, of those behind something, else 0 [n]."""
        behind = self.table["obstacles"].str.len().gt(0).to_numpy()
        among = np.unique(self.link[behind])
        count = int(np.clip(round(share * (self.link.max() + 1)), 1, len(among)))
        return np.isin(self.link, self.rng.choice(among, count, replace=False)).astype(np.float64)

    def farther(self, tag_m: Floats | float, arch_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by so much [n, 3], in m [n]."""
        way = self.low - self.high
        moved = way + np.asarray(tag_m) - np.asarray(arch_m)
        return np.asarray(np.sqrt((moved**2).sum(axis=1)) - np.sqrt((way**2).sum(axis=1)))

    def stretches_by(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        now_s = self.course["into_s"]
        return self.farther(carried(self.course, now_s + later_s) - carried(self.course, now_s))
