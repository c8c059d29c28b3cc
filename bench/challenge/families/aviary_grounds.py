"""The aviary: storks, ibises and keepers below a net, what nobody knows of them, and rows.

numpy and pandas alone. Storks soar on helices; ibises hop from perch to perch over a hump; keepers
wind their way along paths. Nestboxes with receivers hang on the net's masts, a wall of rock, trees
of a grove, the winter house and posts of the fence.
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
WIDE_M, DEEP_M, NET_M = 66.0, 44.0, 15.0
"""The aviary: from west to east, from south to north, and how high its net hangs."""
NESTBOXES_M: Floats = np.array(
    [(16.5, 14.0, 9.6), (49.5, 14.0, 10.4), (16.5, 30.0, 10.1), (49.5, 30.0, 9.2),
     (9.0, 43.3, 3.2), (31.0, 43.5, 5.1), (55.0, 43.2, 4.4),
     (27.5, 19.0, 4.3), (38.5, 25.0, 3.6),
     (0.7, 11.0, 2.4), (0.8, 32.0, 2.9),
     (65.2, 9.0, 1.9), (65.3, 36.0, 2.2), (35.0, 0.6, 1.7)]
)  # fmt: skip
"""Where nestboxes are, in m."""
NESTBOXES, ON_MASTS = len(NESTBOXES_M), 4
STORKS, IBISES, KEEPERS = 4, 4, 3
TAGS = (
    *(f"stork{k}" for k in range(STORKS)),
    *(f"ibis{k}" for k in range(IBISES)),
    *(f"keeper{k}" for k in range(KEEPERS)),
)
ZONES = ("thermal", "perches", "paths")
"""Where storks, ibises and keepers are."""
GROVE_M = (33.0, 22.0, 8.5, 2.6, 8.4)  # its middle and radius; crowns from where to where
POND_M = (52.0, 22.0, 7.6, 6.2)  # its middle and half axes
BETWEEN = ("foliage", "wood", "brick", "glass")
"""What may stand between: crowns, trunks, the rock wall's piers, and panes of the winter house."""
COURSE = (
    "kind", "at_x", "at_y", "at_z", "heads", "reach_m", "wheel", "climb_m", "goes", "lasts_s",
    "into_s",
)  # fmt: skip
"""How a tag moves, known to nobody; `kind` as in ZONES, the others: see `flown`."""
WINDING_M = 5.5  # of a path, from one bend to the next but one
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 4.4928  # channel 3
DAY_S = 9.2 * 3600  # from opening to closing
PADDLES_M = 0.83  # of the pond's wheel, from one paddle to the next
GAZ_M = 0.8382  # of Akbar
LAWS = {
    "droppings-on-lids": Law(("saturation", "logarithm", "power")),
    "visitors-close-by": Law(("inverse", "power", "inverse square")),
    "plumage-soaked": Law(("parabola", "power")),
    "hoppers-full": Law(("linear", "power")),
    "powder-down-settles": Law(("logarithm", "power", "saturation")),
    "wheel-paddles-pass": Law(("periodic",), PADDLES_M, "m", grows=False),
    "winter-curtain-down": Law(("step",), 0.094, "m"),
    "storks-bank": Law(),
    "wind-drifts-flyers": Law(),
    "masts-lean-downwind": Law(),
    "plan-sheared": Law(),
    "tags-wake-slowly": Law(),
    "nestbox-dragged-by-a-branch": Law(("position",), 0.47, "m", devices=("nestbox7",)),
    "nestboxes-noted-crosswise": Law(("swap",), devices=("nestbox4", "nestbox10")),
    "gaz-from-one-nestbox": Law(("unit",), 1 / GAZ_M, "1", grows=False, devices=("nestbox9",)),
}
"""What nobody's library has."""


@dataclass(frozen=True)
class Change:
    """What becomes of rows [n]: metres; dB of all, of first paths, of noise, of what is counted."""

    metres: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def flown(course: Mapping[str, Floats], into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, [n, 3] in m.

    Storks: `heads` is the angle they begin at round (at_x, at_y), `reach_m` their radius, `wheel`
    by how much they turn. Ibises, from at rest to at rest, and keepers, evenly, go `reach_m` into
    the direction of `heads`; `wheel` is how high ibises' hump is, how far keepers wind aside. All
    climb `climb_m` meanwhile.
    """
    part = course["goes"] * into_s / course["lasts_s"]
    kind, heads, reach, wheel = (course[name] for name in ("kind", "heads", "reach_m", "wheel"))
    angle = heads + wheel * part
    soared = [reach * np.cos(angle), reach * np.sin(angle), course["climb_m"] * part]
    hop = part.clip(0.0, 1.0)
    gone = hop - np.sin(2 * np.pi * hop) / (2 * np.pi)
    over = course["climb_m"] * gone + 4.0 * wheel * gone * (1 - gone)
    hopped = [reach * gone * np.cos(heads), reach * gone * np.sin(heads), over]
    along = reach * part
    aside = wheel * np.sin(2 * np.pi * along / WINDING_M)
    walked = [
        along * np.cos(heads) - aside * np.sin(heads),
        along * np.sin(heads) + aside * np.cos(heads),
        course["climb_m"] * part,
    ]
    begun = np.stack([course[f"at_{axis}"] for axis in "xyz"])
    moved = np.select([kind < 0.5, kind < 1.5], [np.stack(soared), np.stack(hopped)], walked)
    return np.asarray((begun + moved).T)


@dataclass
class Watch:
    """Rows of a table that are watched; all tables of a case share what `stable` seeds.

    `rng` draws all else; `rare`: causes are to be rare.
    """

    table: pd.DataFrame
    stable: int
    rng: np.random.Generator
    rare: bool = False

    def of(self, name: str) -> Floats:
        """Return a column [n]."""
        return self.table[name].to_numpy(np.float64)

    @cached_property
    def rows(self) -> int:
        """How many rows there are."""
        return len(self.table)

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self.of("true_range_m")

    @cached_property
    def box(self) -> Integers:
        """Numbers of nestboxes [n]."""
        return np.array([int(name[7:]) for name in self.table["rx"]], np.int64)

    @cached_property
    def tag(self) -> Integers:
        """Numbers of tags [n], as in TAGS."""
        number = {name: k for k, name in enumerate(TAGS)}
        return np.array([number[name] for name in self.table["tx"]], np.int64)

    def worn_by(self, *kinds: str) -> Floats:
        """Return 1 at rows of tags of such kinds, else 0 [n]."""
        return np.array([float(name.startswith(kinds)) for name in self.table["tx"]])

    @cached_property
    def link(self) -> Integers:
        """Numbers of links [n]."""
        return np.asarray(pd.factorize(self.table["link"], sort=True)[0], np.int64)

    @cached_property
    def spell(self) -> Integers:
        """Numbers of the watches that rows are of [n]."""
        told = self.table["link"].str.rsplit(" at ", n=1).str[0]
        return np.asarray(pd.factorize(told, sort=True)[0], np.int64)

    @cached_property
    def there(self) -> Floats:
        """Where tags are said to be [n, 3], in m."""
        return self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)

    @cached_property
    def hung(self) -> Floats:
        """Where nestboxes are said to be [n, 3], in m."""
        return NESTBOXES_M[self.box]

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags move, [n] each."""
        return {name: self.of(name) for name in COURSE}

    @cached_property
    def since_s(self) -> Floats:
        """How long after the first row of their watches rows are, in s [n]."""
        time = pd.Series(self.of("time_s"))
        return (time - time.groupby(self.spell).transform("min")).to_numpy(np.float64)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.stable, 2105, what])

    def by_link(self, lots: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what each link draws, at its rows [n]."""
        return np.asarray(lots(1 + int(self.link.max())), np.float64)[self.link]

    @cached_property
    def shaded(self) -> Floats:
        """1 where something stands between, else 0 [n]."""
        return np.array([float(len(things) > 0) for things in self.table["obstacles"]])

    def behind(self, share: float) -> Floats:
        """Return 1 at as many of the shaded links as are that share of all links, else 0 [n]."""
        ranks = self.by_link(lambda n: self.rng.permutation(n) + 1.0) * self.shaded
        order = np.unique(ranks[ranks > 0])
        most = max(1, round(share * (1 + int(self.link.max()))))
        last = order[min(most, len(order)) - 1] if len(order) else 0.0
        return np.asarray((ranks > 0) & (ranks <= last), np.float64)

    def through(self, what: str) -> Floats:
        """Return 1 where straight paths go through such a thing, else 0 [n]."""
        return np.array([float(what in things) for things in self.table["obstacles"]])

    @cached_property
    def amid_m(self) -> Floats:
        """How many metres of straight paths are amid the grove's crowns [n]."""
        step = self.hung - self.there
        enters, leaves = _in_disc(self.there[:, :2] - GROVE_M[:2], step[:, :2], GROVE_M[2])
        up = np.where(np.abs(step[:, 2]) < 1e-9, 1e-9, step[:, 2])
        low, high = ((edge - self.there[:, 2]) / up for edge in GROVE_M[3:])
        enters = np.maximum(enters, np.minimum(low, high))
        leaves = np.minimum(leaves, np.maximum(low, high))
        return np.asarray((leaves - enters).clip(0.0) * self.far)

    def lengthens(self, tag_m: Floats | float, box_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by so much [n, 3], in m [n]."""
        apart = self.there - self.hung
        off = np.sqrt(((apart + tag_m - box_m) ** 2).sum(axis=1))
        return np.asarray(off - np.sqrt((apart**2).sum(axis=1)))

    def goes_in(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        now = self.course["into_s"]
        return self.lengthens(flown(self.course, now + later_s) - flown(self.course, now))


def _in_disc(begun: Floats, step: Floats, radius: float) -> tuple[Floats, Floats]:
    """Return between which parts of ways [n, 2] these are within a radius of 0, in [0, 1]."""
    square = (step**2).sum(axis=1).clip(1e-12)
    middle = -(begun * step).sum(axis=1) / square
    root = np.sqrt((middle**2 - ((begun**2).sum(axis=1) - radius**2) / square).clip(0.0))
    return (middle - root).clip(0.0, 1.0), (middle + root).clip(0.0, 1.0)
