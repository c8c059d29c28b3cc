"""The saw mill: grapples, carriages, forklifts and sawyers, what nobody knows of them, and rows.

numpy and pandas alone. Grapples of a gantry crane swing logs over a yard; carriages go to and fro
along saws; forklifts steer along spirals between stacks; sawyers walk, now faster, now slower.
Braces with receivers are on masts of the yard, trusses of the hall and fronts of drying kilns.
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
SITE_M = (70.0, 42.0)
"""The site: from west to east, from south to north."""
HALL_M = (31.0, 56.0, 8.0, 34.0, 7.4)  # the saw hall: west, east, south, north, how high
KILNS_M = (59.0, 11.0, 33.0, 5.2)  # fronts of kilns: how far east, from, to, how high
BRACES_M: Floats = np.array(
    [(3.2, 4.1, 6.2), (3.0, 38.2, 5.7), (27.4, 2.6, 5.1), (26.1, 39.5, 6.6),
     (32.2, 9.4, 4.8), (32.0, 32.6, 5.3), (44.3, 8.6, 3.9), (43.8, 33.3, 4.4),
     (55.1, 10.2, 4.7), (54.4, 31.8, 5.1),
     (59.3, 14.6, 2.7), (59.4, 22.3, 2.1), (59.2, 30.4, 3.2)]
)  # fmt: skip
"""Where braces are, in m."""
BRACES, IN_YARD, IN_HALL = len(BRACES_M), slice(0, 4), slice(4, 10)
AT_KILNS = 10  # and all braces after it
TAGS = (
    "grapple0", "grapple1", "carriage0", "carriage1", "carriage2", "forklift0", "forklift1",
    "forklift2", "sawyer0", "sawyer1", "sawyer2",
)  # fmt: skip
KINDS = ("grapple", "carriage", "forklift", "sawyer")
PLACES = ("log yard", "saw line", "lumber yard", "gangways")
"""Where each kind is."""
THROUGH = ("wood", "chipboard", "brick", "glass")
"""What may stand between: stacks, partitions, walls of kilns, panes of cabs."""
COURSE = (
    "kind", "at_x", "at_y", "at_z", "heads", "pace", "bend", "curl", "goes", "lasts_s", "into_s",
    "asked",
)  # fmt: skip
"""How a tag goes, and as which of a round it is asked, known to nobody; see `brought`."""
KNOTS, WEIGHTS = np.polynomial.legendre.leggauss(8)  # along spirals
STRIDES_S = 5.2  # sawyers are fast and slow in turn
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 3.4944  # channel 1
SHIFT_S = 8.6 * 3600
BREAKS = (0.31, 0.68)  # parts of a shift after which the mill starts again
LUG_M = 0.71  # from one lug of the log chain to the next
FINE_DB = 6.0  # of level, in which a fine gain goes through all of its words
YARD_M = 0.9144
LAWS = {
    "resin-on-lids": Law(("saturation", "logarithm", "power")),
    "sawdust-drifts": Law(("power", "parabola")),
    "blades-lose-strain": Law(("inverse", "power", "inverse square")),
    "vents-steam": Law(("linear", "power")),
    "chain-lugs-pass": Law(("periodic",), LUG_M, "m", grows=False),
    "fine-gain-cycles": Law(("periodic",), FINE_DB, "dB", grows=False),
    "firmware-changed-at-noon": Law(("step",), 0.099, "m"),
    "kiln-braces-swell": Law(),
    "logs-slide-at-turns": Law(),
    "masts-tilt-laden": Law(),
    "hall-surveyed-from-another-corner": Law(),
    "first-of-a-round-is-late": Law(),
    "brace-bent-by-a-log": Law(("position",), 0.48, "m", devices=("brace6",)),
    "braces-labelled-crosswise": Law(("swap",), devices=("brace2", "brace7")),
    "yards-from-one-brace": Law(
        ("unit",), 1 / YARD_M, "1", grows=False, devices=("brace5",)
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


def eased(part: Floats) -> Floats:
    """Return how much of a way is gone by a part of its time [n], with the least jerk."""
    u = part.clip(0.0, 1.0)
    return np.asarray(u**3 * (10 - 15 * u + 6 * u**2))


def _spiral(way: Floats, course: Mapping[str, Floats]) -> tuple[Floats, Floats]:
    """Return where spirals are after so many metres [n] each, from where they begin, in m."""
    at = 0.5 * way[:, None] * (KNOTS + 1)
    turned = course["heads"][:, None] + course["bend"][:, None] * at
    turned = turned + 0.5 * course["curl"][:, None] * at**2
    x, y = (0.5 * way * (one(turned) @ WEIGHTS) for one in (np.cos, np.sin))
    return np.asarray(x), np.asarray(y)


def brought(course: Mapping[str, Floats], into_s: Floats) -> Floats:
    """Return where tags are some time into their courses [n, 3], in m.

    Grapples go `pace` metres into the direction of `heads`, the bridge later than the trolley, and
    `curl` up and down again. Carriages swing by `pace` metres, `bend` radians a second, `heads` at
    first. Forklifts go at `pace` m/s along spirals that bend by `bend` and by `curl` more a metre.
    Sawyers go at `pace` m/s, and `curl` metres ahead of that or behind.
    """
    gone_s = course["goes"] * into_s
    heads, pace, curl = course["heads"], course["pace"], course["curl"]
    part = gone_s / course["lasts_s"]
    late = eased((part - 0.16) / 0.84)
    lifted = curl * np.sin(np.pi * part.clip(0.0, 1.0)) ** 2
    grapple = [pace * np.cos(heads) * eased(part / 0.9), pace * np.sin(heads) * late, lifted]
    swung = pace * (np.sin(heads + course["bend"] * gone_s) - np.sin(heads))
    still = np.zeros(len(part))
    along = pace * gone_s + curl * (1 - np.cos(2 * np.pi * gone_s / STRIDES_S))
    ways = [
        grapple,
        [swung, still, still],
        [*_spiral(pace * gone_s, course), still],
        [along * np.cos(heads), along * np.sin(heads), still],
    ]
    moved = np.select([course["kind"] == k for k in range(4)], [np.stack(way) for way in ways])
    return np.asarray((np.stack([course[f"at_{axis}"] for axis in "xyz"]) + moved).T)


class Stint:
    """Rows of a table; all tables of a case share what `stable` seeds, `rng` draws all else."""

    def __init__(
        self, table: pd.DataFrame, stable: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.stable, self.rng, self.rare = table, stable, rng, rare
        self.n = len(table)

    def column(self, name: str) -> Floats:
        """Return a column [n]."""
        return self.table[name].to_numpy(np.float64)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.stable, 2203, what])

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self.column("true_range_m")

    @cached_property
    def brace(self) -> Integers:
        """Numbers of braces [n]."""
        return np.array([int(name[len("brace") :]) for name in self.table["rx"]], np.int64)

    @cached_property
    def tag(self) -> Integers:
        """Numbers of tags [n], as in TAGS."""
        return np.array([TAGS.index(name) for name in self.table["tx"]], np.int64)

    def of_kind(self, kind: str) -> Floats:
        """Return 1 at rows of such tags, else 0 [n]."""
        return np.asarray(self.table["tx"].str.startswith(kind), np.float64)

    @cached_property
    def link(self) -> Integers:
        """Numbers of links [n], from 0 on, by their names."""
        return np.asarray(self.table["link"].astype("category").cat.codes, np.int64)

    @cached_property
    def stint(self) -> Integers:
        """Numbers of stints [n], from 0 on, by their names."""
        name = self.table["link"].str.split(" from ").str[0]
        return np.asarray(name.astype("category").cat.codes, np.int64)

    def by_link(self, lots: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what each link draws, at its rows [n]."""
        return np.asarray(lots(int(self.link.max()) + 1), np.float64)[self.link]

    def by_stint(self, lots: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what each stint draws, at its rows [n]."""
        return np.asarray(lots(int(self.stint.max()) + 1), np.float64)[self.stint]

    @cached_property
    def there(self) -> Floats:
        """Where tags are said to be [n, 3], in m."""
        return np.column_stack([self.column(f"tx_{axis}_m") for axis in "xyz"])

    @cached_property
    def fixed(self) -> Floats:
        """Where braces are said to be [n, 3], in m."""
        return BRACES_M[self.brace]

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags go, [n] each."""
        return {name: self.column(name) for name in COURSE}

    def has(self, what: str) -> Floats:
        """Return 1 where a straight way goes through such a thing, else 0 [n]."""
        return self.table["obstacles"].map(lambda some: float(what in some)).to_numpy(np.float64)

    def out_of_sight(self, share: float) -> Floats:
        """Return 1 at some links that something stands in the way of, so many of all, else 0."""
        stands = self.table["obstacles"].map(len).to_numpy() > 0
        links = np.unique(self.link[stands])
        count = min(len(links), max(1, round(share * (int(self.link.max()) + 1))))
        chosen = self.rng.choice(links, count, replace=False) if len(links) else links
        return np.isin(self.link, chosen).astype(np.float64)

    def longer(self, tag_m: Floats | float, brace_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by so much [n, 3], in m [n]."""
        apart = self.there - self.fixed
        off = np.linalg.norm(apart + tag_m - brace_m, axis=1)
        return np.asarray(off - np.linalg.norm(apart, axis=1))

    def carried(self, later_s: Floats | float) -> Floats:
        """Return how far tags have come some time later [n, 3], in m."""
        now = self.course["into_s"]
        return brought(self.course, now + later_s) - brought(self.course, now)

    def grown(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        return self.longer(self.carried(later_s))
