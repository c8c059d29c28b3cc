"""The laundry: bags, shuttles, trolleys and folders, what nobody knows of them, and rows.

numpy and pandas alone. Bags roll down sloping rails until friction holds them at one speed;
shuttles take cakes of linen along washers and driers and lift them; trolleys are towed and swing in
behind who tows them; folders walk round corners of tables. Louvres of air ducts have radios, which
ask.
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
HALL_M = (46.0, 28.0, 6.8)
"""The hall: from west to east, from south to north, how high."""
LOUVRES_M: Floats = np.array(
    [(2.0, 2.5, 4.9), (12.5, 1.2, 5.6), (24.0, 2.0, 4.4), (35.5, 1.4, 5.2), (44.6, 3.6, 4.7),
     (44.9, 14.2, 5.9), (43.8, 26.2, 5.3), (31.0, 26.9, 4.6), (19.5, 26.6, 5.8), (7.5, 26.4, 5.1),
     (1.2, 14.8, 3.0), (22.8, 13.6, 6.1)]
)  # fmt: skip
"""Where louvres are, in m."""
LOUVRES = len(LOUVRES_M)
TAGS = (
    "bag0", "bag1", "bag2", "bag3", "shuttle0", "shuttle1", "trolley0", "trolley1", "trolley2",
    "folder0", "folder1", "folder2",
)  # fmt: skip
KINDS = ("bag", "shuttle", "trolley", "folder")
PLACES = ("rails", "machines", "aisles", "tables")
"""Where each kind is."""
WASHERS_M, DRIERS_M = 6.0, 22.0  # how far north lines of washers and of driers are
THROUGH = ("linen", "plasterboard", "concrete", "glass")
"""What may stand between: heaps of linen, partitions, pillars, panes of the foremen's room."""
COURSE = (
    "kind", "from_x", "from_y", "from_z", "toward", "rate", "lever", "extra", "runs", "span_s",
    "into_s", "gap_s",
)  # fmt: skip
"""How a tag goes, and how long since any louvre asked it, known to nobody; see `led`."""
SWAY_S, SLOPE, CORNER_M = 2.7, 0.04, 0.9  # of bags aside; of rails; how round folders go
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 6.4896  # channel 5
SHIFT_S = 7.4 * 3600
RIBS_M = 0.66  # of drums, from one rib to the next
AUNE_M = 1.1884  # of Paris
LAWS = {
    "lint-on-grilles": Law(("saturation", "logarithm", "power")),
    "piles-tower-up": Law(("power", "parabola")),
    "presses-close-by": Law(("inverse", "power", "inverse square")),
    "softener-films-tags": Law(("logarithm", "power", "saturation")),
    "ironers-steam": Law(("linear", "power")),
    "drum-ribs-pass": Law(("periodic",), RIBS_M, "m", grows=False),
    "dock-doors-rolled-up": Law(("step",), 0.096, "m"),
    "springs-sink-laden": Law(),
    "bags-lean-back-at-first": Law(),
    "hands-warm-tags": Law(),
    "polls-collide": Law(),
    "heights-off-a-sloping-floor": Law(),
    "louvre-knocked-by-a-bag": Law(("position",), 0.45, "m", devices=("louvre8",)),
    "louvres-tagged-crosswise": Law(("swap",), devices=("louvre3", "louvre9")),
    "aunes-from-one-louvre": Law(
        ("unit",), 1 / AUNE_M, "1", grows=False, devices=("louvre5",)
    ),
}  # fmt: skip
"""What nobody's library has."""


@dataclass(frozen=True)
class Change:
    """What becomes of rows [n]: metres; dB of all, of first paths, of noise, of what is counted."""

    metres: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def smooth(part: Floats) -> Floats:
    """Return how much of a way is gone by a part of its time [n]: at rest at both ends."""
    u = part.clip(0.0, 1.0)
    return np.asarray(u * u * (3.0 - 2.0 * u))


def _rolled(course: Mapping[str, Floats], gone_s: Floats) -> list[Floats]:
    """Return how far bags are along rails, aside of these and above where they began, in m."""
    slows_s = np.where(course["kind"] < 0.5, course["lever"], 1.0)
    along = course["rate"] * (gone_s + slows_s * np.expm1(-gone_s / slows_s))
    aside = course["extra"] * np.sin(2 * np.pi * gone_s / SWAY_S)
    return [along, aside, -SLOPE * along]


def _towed(course: Mapping[str, Floats], gone_s: Floats) -> list[Floats]:
    """Return how far trolleys are along the way of who tows them, and aside: by tractrices."""
    bar_m = np.where(course["kind"] == 2.0, course["extra"], 1.0)
    begun = np.where(course["kind"] == 2.0, course["lever"], 0.0)
    angle = 2 * np.arctan(np.tan(0.5 * begun) * np.exp(-course["rate"] * gone_s / bar_m))
    along = course["rate"] * gone_s - bar_m * (np.cos(angle) - np.cos(begun))
    return [along, -bar_m * (np.sin(angle) - np.sin(begun)), np.zeros(len(gone_s))]


def led(course: Mapping[str, Floats], into_s: Floats) -> Floats:
    """Return where tags are some time into their courses [n, 3], in m.

    All go `toward` some direction. Bags come up to `rate` m/s, by a factor of e nearer to it each
    `lever` s, and sway by `extra` m. Shuttles go `rate` m in all, and up `extra` m on the second
    half. Trolleys are on a bar of `extra` m, `lever` off the way of who tows them at `rate` m/s.
    Folders walk at `rate` m/s along hyperbolas, whose bend is `extra` m off, `lever` aside a metre.
    """
    gone_s = course["runs"] * into_s
    rate, lever, extra = course["rate"], course["lever"], course["extra"]
    part = gone_s / course["span_s"]
    still = np.zeros(len(part))
    walked = rate * gone_s
    bends = np.hypot(walked - extra, CORNER_M) - np.hypot(extra, CORNER_M)
    ways = [
        _rolled(course, gone_s),
        [rate * smooth(part), still, extra * smooth(2 * part - 1)],
        _towed(course, gone_s),
        [walked, lever * bends, still],
    ]
    along, aside, up = np.select(
        [course["kind"] == k for k in range(4)], [np.stack(way) for way in ways]
    )
    cos, sin = np.cos(course["toward"]), np.sin(course["toward"])
    moved = np.stack([along * cos - aside * sin, along * sin + aside * cos, up])
    return np.asarray((moved + np.stack([course[f"from_{axis}"] for axis in "xyz"])).T)


class Errand:
    """Rows of a table; all tables of a case share what `stable` seeds, `rng` draws all else."""

    def __init__(
        self, table: pd.DataFrame, stable: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.stable, self.rng, self.rare = table, stable, rng, rare
        self.rows = len(table)

    def read(self, name: str) -> Floats:
        """Return a column [n]."""
        return self.table[name].to_numpy(np.float64)

    def common(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.stable, 2303, what])

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self.read("true_range_m")

    @cached_property
    def louvre(self) -> Integers:
        """Numbers of louvres [n]."""
        return np.array([int(name.removeprefix("louvre")) for name in self.table["tx"]], np.int64)

    @cached_property
    def tag(self) -> Integers:
        """Numbers of tags [n], as in TAGS."""
        return np.array([TAGS.index(name) for name in self.table["rx"]], np.int64)

    def are(self, kind: str) -> Floats:
        """Return 1 at rows of tags of a kind, else 0 [n]."""
        return np.asarray(self.table["rx"].str.startswith(kind), np.float64)

    @cached_property
    def link(self) -> Integers:
        """Numbers of links [n], from 0 on."""
        return np.unique(self.table["link"].to_numpy(str), return_inverse=True)[1].astype(np.int64)

    @cached_property
    def errand(self) -> Integers:
        """Numbers of errands [n], from 0 on."""
        names = np.array([name.split(" via ")[0] for name in self.table["link"]])
        return np.unique(names, return_inverse=True)[1].astype(np.int64)

    def of_links(self, lots: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what each link draws, at its rows [n]."""
        return np.asarray(lots(1 + int(self.link.max())), np.float64)[self.link]

    @cached_property
    def since_s(self) -> Floats:
        """How long after the first row of their errands rows are, in s [n]."""
        time = self.read("time_s")
        first = np.full(1 + int(self.errand.max()), np.inf)
        np.minimum.at(first, self.errand, time)
        return np.asarray(time - first[self.errand])

    @cached_property
    def there(self) -> Floats:
        """Where tags are said to be [n, 3], in m."""
        return np.column_stack([self.read(f"rx_{axis}_m") for axis in "xyz"])

    @cached_property
    def above(self) -> Floats:
        """Where louvres are said to be [n, 3], in m."""
        return LOUVRES_M[self.louvre]

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags go, [n] each."""
        return {name: self.read(name) for name in COURSE}

    def goes_through(self, what: str) -> Floats:
        """Return 1 where a straight way goes through such a thing, else 0 [n]."""
        return np.array([float(what in some) for some in self.table["obstacles"]])

    def unseen(self, share: float) -> Floats:
        """Return 1 at links out of sight, by lot so many of all links, else 0 [n]."""
        met = np.array([len(some) > 0 for some in self.table["obstacles"]])
        links = np.unique(self.link[met])
        count = min(len(links), max(1, round(share * (1 + int(self.link.max())))))
        return np.isin(self.link, self.rng.permutation(links)[:count]).astype(np.float64)

    def longer(self, tag_m: Floats | float, louvre_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by so much [n, 3], in m [n]."""
        apart = self.there - self.above
        off = np.sqrt(((apart + tag_m - louvre_m) ** 2).sum(axis=1))
        return np.asarray(off - np.sqrt((apart**2).sum(axis=1)))

    def longer_in(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        now = self.course["into_s"]
        return self.longer(led(self.course, now + later_s) - led(self.course, now))
