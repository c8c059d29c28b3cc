"""The saltworks: rakers, tippers, harvesters and punts of sea salt's pans, and their rows.

numpy and pandas alone. Wind pumps' vanes about the pans have radios. Rakers pull salt by strokes
and step aside; tippers are hauled by a rope that slackens; harvesters wind inward by logarithmic
spirals; punts are taken along by the wind, whose drag goes by the square of what it is faster.
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
Levy = dict[str, Floats | float]
"""What rows [n] owe: `m` of range; dB of `all`, of `first` paths, of `noise`, of the `count`."""
WORKS_M = (64.0, 46.0)
VANES_M: Floats = np.array([
    (1.2, 1.8, 4.9), (15.7, 0.6, 6.3), (31.4, 1.5, 3.8), (47.2, 0.9, 5.6), (63.1, 2.3, 4.3),
    (0.7, 22.6, 5.9), (21.3, 23.4, 3.6), (43.8, 22.1, 6.6), (62.6, 24.0, 5.1), (2.0, 44.9, 4.1),
    (18.9, 45.3, 5.4), (38.2, 44.4, 6.1), (61.8, 45.1, 3.9),
])  # fmt: skip
"""Where vanes are, in m: on the dykes round the pans, and on the one between them."""
VANES = len(VANES_M)
GANGS = {"raker": 4, "tipper": 3, "harvester": 3, "punt": 3}
"""How many tags there are of each kind."""
TAGS = tuple(f"{gang}{k}" for gang, count in GANGS.items() for k in range(count))
PLACES = {"raker": "beds", "tipper": "causeway", "harvester": "crystallisers", "punt": "reservoir"}
COURSE = (
    "gang", "from_x", "from_y", "from_z", "bears", "speed", "lasts", "swing", "goes", "done_s",
)  # fmt: skip
"""How a tag goes, known to nobody; see `gone`."""
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 3.9936  # channel 2
DAY_S = 8.3 * 3600
CLAMPS_M = 6.9  # of rope from one clamp to the next
FURLED_MS = 10.5  # of wind, from which sails are furled
KEN_M = 60 / 33  # of Japan: six shaku
LAWS = {
    "gypsum-crusts-on-lids": Law(("saturation", "logarithm", "power")),
    "brine-deepens": Law(("power", "parabola")),
    "salt-heap-close-by": Law(("inverse", "power", "inverse square")),
    "iodine-stains-copper": Law(("logarithm", "power", "saturation")),
    "gulls-sit-on-booms": Law(("linear", "power")),
    "rope-clamps-pass": Law(("periodic",), CLAMPS_M, "m", grows=False),
    "sails-furled": Law(("step",), 0.093, "m"),
    "spray-blown-across": Law(),
    "strokes-longer-than-told": Law(),
    "spirals-wind-tighter": Law(),
    "one-phase-sags-while-hauling": Law(),
    "east-dyke-by-another-north": Law(),
    "vane-knocked-by-a-tipper": Law(("position",), 0.46, "m", devices=("vane6",)),
    "vanes-painted-crosswise": Law(("swap",), devices=("vane2", "vane10")),
    "ken-from-one-vane": Law(("unit",), 1 / KEN_M, "1", grows=False, devices=("vane5",)),
}
"""What nobody's library has."""
Course = Mapping[str, Floats]


def _from(course: Course, off: NDArray[np.complex128]) -> Floats:
    """Return places so far off where courses begin, by x + iy in m [n, 3]."""
    x, y = course["from_x"] + off.real, course["from_y"] + off.imag
    return np.stack([x, y, course["from_z"]], axis=1)


def stroke(turns: Floats) -> Floats:
    """Return how far out a rake is, by parabolas to and fro [n]; a turn is half of both."""
    whole, part = np.divmod(turns, 1.0)
    return np.asarray((1 - 2 * (whole % 2)) * 4 * part * (1 - part))


def _raked(course: Course, gone_s: Floats) -> Floats:
    """Return where rakes are: `swing` m out by strokes of `lasts` s, stepping aside."""
    out = course["swing"] * stroke(gone_s / course["lasts"])
    return _from(course, np.exp(1j * course["bears"]) * (out + 1j * course["speed"] * gone_s))


def _hauled(course: Course, gone_s: Floats) -> Floats:
    """Return where tippers are: brought to `speed` m/s by what is damped just so in `lasts` s."""
    slack = course["lasts"]
    along = gone_s - 2 * slack + (gone_s + 2 * slack) * np.exp(-gone_s / slack)
    return _from(course, np.exp(1j * course["bears"]) * course["speed"] * along)


def wound_rad(course: Course, gone_s: Floats) -> Floats:
    """Return how far harvesters have gone round, in radians [n], at an even speed.

    They begin `swing` m from the middle and come in by `lasts` of the rest for each radian.
    """
    inward = course["lasts"]
    part = np.abs(course["speed"]) * gone_s * inward / np.hypot(1.0, inward) / course["swing"]
    return np.asarray(-np.log1p(-part.clip(0.0, 0.9)) / inward)


def wound(course: Course, gone_s: Floats) -> NDArray[np.complex128]:
    """Return how far harvesters are off their pans' middles, by x + iy in m [n]."""
    turned = wound_rad(course, gone_s)
    far = course["swing"] * np.exp(-course["lasts"] * turned)
    return np.asarray(far * np.exp(1j * (course["bears"] + np.sign(course["speed"]) * turned)))


def _wound(course: Course, gone_s: Floats) -> Floats:
    return _from(course, wound(course, gone_s))


def _blown(course: Course, gone_s: Floats) -> Floats:
    """Return where punts are: ever nearer to the wind's `speed`, and aside by `swing` / m."""
    slow = course["lasts"]
    along = course["speed"] * (gone_s - slow * np.log1p(gone_s / slow))
    return _from(course, np.exp(1j * course["bears"]) * (along + 1j * course["swing"] * along**2))


WAYS: tuple[Callable[[Course, Floats], Floats], ...] = (_raked, _hauled, _wound, _blown)
"""Of kinds as in GANGS."""


def gone(course: Course, done_s: Floats) -> Floats:
    """Return where tags are some time into their courses [n, 3], in m."""
    place = np.zeros((len(done_s), 3))
    for number, way in enumerate(WAYS):
        own = np.flatnonzero(course["gang"] == number)
        some = {name: course[name][own] for name in COURSE}
        place[own] = way(some, some["goes"] * done_s[own])
    return place


class Haul:
    """Rows of a table; `case` seeds what all tables of a case share, `rng` draws all else.

    `vane`, `tag`, `link` [n]: numbers of vanes, of tags as in TAGS, of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare = table, case, rng, rare
        self.vane: Integers = np.array([int(name[4:]) for name in table["rx"]], np.int64)
        number = {name: k for k, name in enumerate(TAGS)}
        self.tag: Integers = np.array([number[name] for name in table["tx"]], np.int64)
        link, names = pd.factorize(table["link"], sort=True)
        self.link: Integers = np.asarray(link, np.int64)
        self.links = len(names)

    def of(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def same(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 2603, what])

    def each(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what each link draws, at its rows [n]."""
        return np.asarray(draws(self.links), np.float64)[self.link]

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self.of("true_range_m")

    @cached_property
    def below(self) -> Floats:
        """Where tags are said to be [n, 3], in m."""
        return self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)

    @cached_property
    def above(self) -> Floats:
        """Where vanes are said to be [n, 3], in m."""
        return self.table[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy(np.float64)

    @cached_property
    def since_s(self) -> Floats:
        """How long ago a link was first asked, in s [n]."""
        begun = self.table.groupby("link")["time_s"].transform("min")
        return np.asarray(self.of("time_s") - begun.to_numpy(np.float64))

    def are(self, gang: str) -> NDArray[np.bool_]:
        """Return whether rows are of tags of a kind [n]."""
        return np.array([tag.startswith(gang) for tag in TAGS])[self.tag]

    def cross(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return self.table["obstacles"].map(lambda some: what in some).to_numpy(np.float64)

    def shut_off(self, share: float) -> Floats:
        """Return 1 at so many of all links by lot that are behind something, else 0 [n]."""
        behind = np.unique(self.link[self.table["obstacles"].map(len).to_numpy() > 0])
        count = min(len(behind), max(1, round(share * self.links)))
        return np.isin(self.link, self.rng.choice(behind, count, replace=False)).astype(np.float64)

    def stretched(self, tag_m: Floats | float, vane_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by so much [n, 3], in m [n]."""
        way = self.below - self.above
        return np.asarray(
            np.linalg.norm(way + tag_m - vane_m, axis=1) - np.linalg.norm(way, axis=1)
        )

    def course(self) -> dict[str, Floats]:
        """Return how tags go, [n] each."""
        return {name: self.of(name) for name in COURSE}

    def farther_after(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        course = self.course()
        now_s = course["done_s"]
        return self.stretched(gone(course, now_s + later_s) - gone(course, now_s))
