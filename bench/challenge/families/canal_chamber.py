"""The ship lock: barges, gates' leaves, mules and keepers of a canal's chamber, and their rows.

numpy and pandas alone. Davits along both copings have radios. Barges coast in still water, whose
drag goes by the square of their speed; leaves of the gates swing as cams have them; mules haul
along rails, from rest; keepers stroll along the copings and weave.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.case import Law

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Toll = dict[str, Floats | float]
"""What rows [n] bear: `m` of range; dB of `all`, of `first` paths, of `noise`, of the `count`."""
LOCK_M = (58.0, 9.0)
"""The chamber between its copings: along it, and across it."""
COPING_M, FULL_M = 6.2, 5.2  # over the tail water: of copings, and of water in a full chamber
DAVITS_M: Floats = np.array([
    (2.5, -1.6, 9.4), (10.8, -2.1, 8.1), (19.6, -1.2, 10.6), (27.3, -2.4, 7.9), (36.1, -1.5, 9.9),
    (45.2, -2.2, 8.6), (55.4, -1.3, 10.2), (5.9, 10.4, 8.3), (14.7, 11.2, 10.1), (23.8, 10.6, 7.8),
    (31.5, 11.4, 9.2), (40.4, 10.3, 10.8), (49.7, 11.5, 8.4), (56.8, 10.8, 9.6),
])  # fmt: skip
"""Where davits are, in m: seven on either side."""
DAVITS = len(DAVITS_M)
CREW = {"barge": 5, "leaf": 4, "mule": 2, "keeper": 3}
"""How many tags there are of each kind."""
TAGS = tuple(f"{kind}{k}" for kind, count in CREW.items() for k in range(count))
PLACES = {"barge": "chamber", "leaf": "gates", "mule": "rails", "keeper": "coping"}
HEELS_M: Floats = np.array([(4.0, 0.0), (4.0, 9.0), (52.5, 0.0), (52.5, 9.0)])
"""Where leaves turn, in m."""
LEAF_M = 4.1  # from a leaf's heel to its tag
HEAVE_M, HEAVE_S = 0.11, 9.0  # barges' sway in half; s
GAIT, STEP_S, WEAVE_M = 0.22, 0.9, 6.0  # how uneven keepers go; s a radian; m a radian
COURSE = (
    "craft", "from_x", "from_y", "from_z", "bears", "speed", "reach", "phase", "goes", "done_s",
)  # fmt: skip
"""How a tag goes, known to nobody; see `stood`."""
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 7.9872  # channel 9
DAY_S = 9.4 * 3600
SLOSH_S = 19.7  # from one swing of the chamber's water to the next
FROST_C = 1.5  # below which lids freeze over
ROEDE_M = 3.767358  # of the Rhineland
LAWS = {
    "slime-on-lids": Law(("saturation", "logarithm", "power")),
    "wash-splashes-up": Law(("power", "parabola")),
    "sluice-rack-close-by": Law(("inverse", "power", "inverse square")),
    "verdigris-creeps": Law(("logarithm", "power", "saturation")),
    "fenders-hung-out": Law(("linear", "power")),
    "chamber-sloshes": Law(("periodic",), SLOSH_S, "s", grows=False),
    "lids-freeze-over": Law(("step",), 0.097, "m"),
    "sluices-spray": Law(),
    "gauge-well-lags": Law(),
    "leaves-swing-wider": Law(),
    "nearer-of-two-antennas": Law(),
    "cabinet-restarted": Law(),
    "davit-bent-by-a-barge": Law(("position",), 0.47, "m", devices=("davit7",)),
    "davits-addressed-crosswise": Law(("swap",), devices=("davit4", "davit11")),
    "roeden-from-one-davit": Law(("unit",), 1 / ROEDE_M, "1", grows=False, devices=("davit2",)),
}
"""What nobody's library has."""
Course = Mapping[str, Floats]


def turned(course: Course, along: Floats, aside: Floats) -> Floats:
    """Return where tags are that many m along and aside of their ways [n, 3], in m."""
    ahead = np.exp(1j * course["bears"]) * (along + 1j * aside)
    begun = [course[f"from_{axis}"] for axis in "xyz"]
    return np.stack([begun[0] + ahead.real, begun[1] + ahead.imag, begun[2]], axis=1)


def _coasted(course: Course, gone_s: Floats) -> Floats:
    """Return where barges are: e times slower by each `reach` m that they have come."""
    along = course["reach"] * np.log1p(course["speed"] * gone_s / course["reach"])
    heaved = course["phase"] + 2 * np.pi * gone_s / HEAVE_S
    return turned(course, along, HEAVE_M * (np.sin(heaved) - np.sin(course["phase"])))


def leaf_angle(course: Course, gone_s: Floats) -> Floats:
    """Return how far leaves are open, in radians [n]: from rest to rest, as cams have it."""
    part = (gone_s / course["reach"]).clip(0.0, 1.0)
    return np.asarray(
        course["phase"] + course["speed"] * (part - np.sin(2 * np.pi * part) / (2 * np.pi))
    )


def _swung(course: Course, gone_s: Floats) -> Floats:
    """Return where leaves' tags are, by their heels; `bears` is 1 or -1, by the side."""
    tip = LEAF_M * np.exp(1j * course["bears"] * leaf_angle(course, gone_s))
    heel = [course[f"from_{axis}"] for axis in "xyz"]
    return np.stack([heel[0] + tip.real, heel[1] + tip.imag, heel[2]], axis=1)


def _hauled(course: Course, gone_s: Floats) -> Floats:
    """Return where mules are: up to `speed` m/s in some `reach` s."""
    along = course["speed"] * (gone_s - course["reach"] * np.tanh(gone_s / course["reach"]))
    return turned(course, along, np.zeros(len(along)))


def _strolled(course: Course, gone_s: Floats) -> Floats:
    """Return where keepers are: by uneven steps, `reach` m aside at the most by half."""
    uneven = np.cos(course["phase"] + gone_s / STEP_S) - np.cos(course["phase"])
    along = course["speed"] * (gone_s - GAIT * STEP_S * uneven)
    return turned(course, along, course["reach"] * (1 - np.cos(along / WEAVE_M)))


WAYS: tuple[Callable[[Course, Floats], Floats], ...] = (_coasted, _swung, _hauled, _strolled)
"""Of kinds as in CREW."""


def stood(course: Course, done_s: Floats) -> Floats:
    """Return where tags are some time into their courses [n, 3], in m."""
    place = np.zeros((len(done_s), 3))
    for craft, way in enumerate(WAYS):
        own = np.flatnonzero(course["craft"] == craft)
        some = {name: course[name][own] for name in COURSE}
        place[own] = way(some, some["goes"] * done_s[own])
    return place


class Passage:
    """Rows of a table; `case` seeds what all tables of a case share, `rng` draws all else.

    `davit`, `tag`, `link` [n]: numbers of davits, of tags as in TAGS, of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare = table, case, rng, rare
        self.davit: Integers = table["rx"].str[5:].to_numpy(str).astype(np.int64)
        self.tag: Integers = np.array([TAGS.index(name) for name in table["tx"]], np.int64)
        names, link = np.unique(table["link"].to_numpy(str), return_inverse=True)
        self.link: Integers = link.astype(np.int64)
        self.links = len(names)

    def of(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def same(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 2503, what])

    def each(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what each link draws, at its rows [n]."""
        return np.asarray(draws(self.links))[self.link].astype(np.float64)

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self.of("true_range_m")

    @cached_property
    def afloat(self) -> Floats:
        """Where tags are said to be [n, 3], in m."""
        return np.stack([self.of(f"tx_{axis}_m") for axis in "xyz"], axis=1)

    @cached_property
    def ashore(self) -> Floats:
        """Where davits are said to be [n, 3], in m."""
        return np.stack([self.of(f"rx_{axis}_m") for axis in "xyz"], axis=1)

    @cached_property
    def floor(self) -> Floats:
        """How high the water is below barges, the copings below all else, in m [n]."""
        return np.where(self.are("barge"), FULL_M - self.of("head_m"), COPING_M)

    def are(self, kind: str) -> NDArray[np.bool_]:
        """Return whether rows are of tags of a kind [n]."""
        return np.array([tag.startswith(kind) for tag in TAGS])[self.tag]

    def cross(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return np.array([what in some for some in self.table["obstacles"]], np.float64)

    def shut_off(self, share: float) -> Floats:
        """Return 1 at so many of all links by lot that are behind something, else 0 [n]."""
        behind = np.unique(self.link[[len(some) > 0 for some in self.table["obstacles"]]])
        lot = self.rng.permutation(behind)[: max(1, round(share * self.links))]
        return np.isin(self.link, lot).astype(np.float64)

    def drawn_out(self, tag_m: Floats | float, davit_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by so much [n, 3], in m [n]."""
        way = self.afloat - self.ashore
        now, then = (np.sqrt(np.sum(one**2, axis=1)) for one in (way, way + tag_m - davit_m))
        return np.asarray(then - now)

    def course(self) -> dict[str, Floats]:
        """Return how tags go, [n] each."""
        return {name: self.of(name) for name in COURSE}

    def onward_by(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        course = self.course()
        done = course["done_s"]
        return self.drawn_out(stood(course, done + later_s) - stood(course, done))
