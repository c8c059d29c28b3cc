"""The velodrome: sprinters, dernies, slingers and holders on banked boards, and rows of these.

numpy and pandas alone. Posts with radios stand behind the balustrade and on the infield, and hang
below the roof. Boards follow a line seven laps of which are a kilometre; its bends come and go by a
fourth power, and boards are banked the more the more it bends.
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
HALL_M = (72.0, 54.0, 12.6)
MIDDLE_M = (36.0, 27.0)
LAP_M, STRAIGHT_M = 1000.0 / 7, 18.0
BEND_M = LAP_M / 2 - STRAIGHT_M
FLAT_RAD, STEEP_RAD = np.radians(13.0), np.radians(30.0)  # on straights; by which bends add to it
GRAVITY = 9.81  # m/s2
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 3.4944  # channel 1
EVENING_S = 5.5 * 3600
JOIST_M = 1.37  # from one joist below the boards to the next
GATE_PCT = 46.0  # from which the tunnel's gate counts as open
ENDAZE_M = 0.6525  # of Constantinople
STATIONS_M: Floats = np.array([4.0, 24.0, 42.0, 61.0, 83.0, 104.0, 127.0])
"""Where along the line posts stand behind the balustrade, 0 at the first straight's begin."""
RISES_M: Floats = np.array([1.2, 2.6, 0.9, 2.0, 1.5, 2.9, 1.1])
"""How high these have their radios above the boards' upper edge, square to these."""
BALUSTRADE_M = 7.3  # across boards from the line to posts behind the balustrade
OTHERS_M = ((27.5, 30.5, 2.3), (45.0, 22.5, 3.2), (21.0, 20.0, 10.4), (37.0, 36.0, 11.3),
            (53.0, 27.0, 9.7))  # fmt: skip
"""Where all others are, in m: two on the infield, three below the roof."""
KINDS = {"sprinter": 3, "derny": 2, "slinger": 3, "holder": 3}
"""How many tags there are of each kind."""
TAGS = tuple(f"{kind}{k}" for kind, count in KINDS.items() for k in range(count))
PLACES = {"sprinter": "sprint", "derny": "keirin", "slinger": "madison", "holder": "start"}
COURSE = ("kind", "along", "lane", "rides", "tall", "pace", "gathers", "pedal", "beat", "goes",
          "into_s")  # fmt: skip
"""How a tag goes, known to nobody; see `ridden`."""
LAWS = {
    "wax-films-the-posts": Law(("saturation", "logarithm", "power")),
    "boards-swell-in-damp": Law(("power", "parabola")),
    "lap-board-close-by": Law(("inverse square", "power", "inverse")),
    "chain-oil-on-tags": Law(("logarithm", "power", "saturation")),
    "flags-wave-in-stands": Law(("linear", "power")),
    "joists-pass-below": Law(("periodic",), JOIST_M, "m", grows=False),
    "tunnel-gate-stands-open": Law(("step",), 0.094, "m"),
    "fog-that-fans-thin": Law(),
    "riders-pressed-down-in-bends": Law(),
    "boards-flatter-than-drawn": Law(),
    "ignition-pulls-dernies-tags": Law(),
    "stations-chained-along-another-line": Law(),
    "post-struck-by-a-bicycle": Law(("position",), 0.48, "m", devices=("post7",)),
    "posts-plugged-crosswise": Law(("swap",), devices=("post0", "post5")),
    "endazes-from-one-post": Law(("unit",), 1 / ENDAZE_M, "1", grows=False, devices=("post8",)),
}
"""What nobody's library has."""
Course = Mapping[str, Floats]


@dataclass(frozen=True)
class Handicap:
    """What rows [n] bear: `late_m` of range; dB of all, of first paths, of noise, of counts."""

    late_m: Floats | float = 0.0
    all_db: Floats | float = 0.0
    first_db: Floats | float = 0.0
    noise_db: Floats | float = 0.0
    count_db: Floats | float = 0.0


def bends(along_m: Floats) -> Floats:
    """Return how much the line bends, as a part of the most it does [n]."""
    into = np.mod(along_m, LAP_M / 2) - STRAIGHT_M
    return np.where(into > 0, 1 - (2 * into / BEND_M - 1) ** 4, 0.0)


MOST_BENT = 1.25 * np.pi / BEND_M
"""How much the line bends at most, in 1 / m: half a turn each bend."""


def _line() -> Floats:
    """Return along, x, y and heading of the line, each twentieth of a metre [4, k]."""
    along = np.linspace(0.0, LAP_M, 2858)
    step, middles = along[1], 0.5 * (along[1:] + along[:-1])
    heading = np.append(0.0, np.cumsum(MOST_BENT * bends(middles) * step))
    heading *= 2 * np.pi / heading[-1]
    amid = 0.5 * (heading[1:] + heading[:-1])
    x, y = (np.append(0.0, np.cumsum(turn(amid) * step)) for turn in (np.cos, np.sin))
    x, y = (one - 0.5 * (one.max() + one.min()) for one in (x, y))
    return np.stack([along, x + MIDDLE_M[0], y + MIDDLE_M[1], heading])


LINE = _line()


def on_boards(along_m: Floats, lane_m: Floats, tall_m: Floats, flatter: float = 0.0) -> Floats:
    """Return places so far along, up across boards, and square above these, in m [n, 3].

    `flatter`: the part of their bank that boards lack.
    """
    x, y, heading = (np.interp(np.mod(along_m, LAP_M), LINE[0], one) for one in LINE[1:])
    bank = (1 - flatter) * (FLAT_RAD + STEEP_RAD * bends(along_m))
    out = lane_m * np.cos(bank) - tall_m * np.sin(bank)
    up = lane_m * np.sin(bank) + tall_m * np.cos(bank)
    return np.stack([x + out * np.sin(heading), y - out * np.cos(heading), up], axis=1)


POSTS_M: Floats = np.vstack(
    [on_boards(STATIONS_M, np.full(len(STATIONS_M), BALUSTRADE_M), RISES_M), np.array(OTHERS_M)]
)
"""Where posts have their radios, in m [POSTS, 3]."""
POSTS = len(POSTS_M)


def _pedalled(course: Course, gone_s: Floats) -> Floats:
    """Return how far legs are ahead of an even pace in m, two strokes each turn [n]."""
    turn = 2 * course["beat"] * gone_s
    return np.asarray(course["pedal"] * (np.sin(turn + course["rides"]) - np.sin(course["rides"])))


def _sprinter(course: Course, gone_s: Floats) -> tuple[Floats, Floats]:
    """Return how far sprinters have come, gathering speed, and by how much they have dived."""
    far = course["pace"] * gone_s + 0.5 * course["gathers"] * gone_s**2 + _pedalled(course, gone_s)
    return far, -0.4 * course["lane"] * (1 - np.exp(-((gone_s / 1.6) ** 2)))


def _derny(course: Course, gone_s: Floats) -> tuple[Floats, Floats]:
    """Return how far dernies have come, surging, and how they weave."""
    surge = np.sin(course["beat"] * gone_s + course["rides"]) - np.sin(course["rides"])
    far = course["pace"] * gone_s + course["gathers"] * surge
    return far, 0.12 * np.sin(0.8 * gone_s + 2 * course["rides"])


def _slinger(course: Course, gone_s: Floats) -> tuple[Floats, Floats]:
    """Return how far slingers have come, whom mates throw by hand after a while, and how low."""
    long_s = 0.18
    when, begun = (np.logaddexp(0.0, (t - 0.9) / long_s) for t in (gone_s, 0.0 * gone_s))
    far = course["pace"] * gone_s + course["gathers"] * long_s * (when - begun)
    return far + _pedalled(course, gone_s), 0.3 * (gone_s / (1 + gone_s))


def _holder(course: Course, gone_s: Floats) -> tuple[Floats, Floats]:
    """Return how far holders have run, from rest until they are as fast as they can be."""
    far = course["pace"] * (gone_s + course["gathers"] * np.expm1(-gone_s / course["gathers"]))
    return far, np.zeros_like(gone_s)


WAYS: tuple[Callable[[Course, Floats], tuple[Floats, Floats]], ...] = (
    _sprinter, _derny, _slinger, _holder,
)  # fmt: skip
"""Of kinds as in KINDS."""


def along_and_lane(course: Course, into_s: Floats) -> tuple[Floats, Floats]:
    """Return where along the line and across boards tags are some time into courses, in m [n]."""
    gone_s = course["goes"] * into_s
    along, lane = course["along"].copy(), course["lane"].copy()
    for number, way in enumerate(WAYS):
        own = course["kind"] == number
        far, aside = way({name: course[name][own] for name in COURSE}, gone_s[own])
        along[own] += far
        lane[own] += aside
    return along, lane


def ridden(course: Course, into_s: Floats) -> Floats:
    """Return where tags are some time into their courses, in m [n, 3]."""
    return on_boards(*along_and_lane(course, into_s), course["tall"])


class Race:
    """Rows of a table; `case` seeds what all tables of a case have alike, `rng` draws all else.

    `post`, `tag` [n]: numbers of these, of tags as in TAGS; `link` [n]: of links from 0 on.
    """

    def __init__(
        self, table: pd.DataFrame, case: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.case, self.rng, self.rare = table, case, rng, rare
        self.rows = len(table)
        self.post: Integers = table["rx"].str.removeprefix("post").to_numpy().astype(np.int64)
        self.tag: Integers = np.array([TAGS.index(name) for name in table["tx"]], np.int64)
        self.link: Integers = np.asarray(pd.factorize(table["link"])[0], np.int64)

    def __getitem__(self, column: str) -> Floats:
        """Return a column [n]."""
        return self.table[column].to_numpy(np.float64)

    def same(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.case, 3303, what])

    def per_link(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what each link draws, at its rows [n]."""
        return np.asarray(draws(int(self.link.max()) + 1), np.float64)[self.link]

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def rider(self) -> Floats:
        """Where tags are said to be, in m [n, 3]."""
        return self.table[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy(np.float64)

    @cached_property
    def hears(self) -> Floats:
        """Where posts' radios are said to be, in m [n, 3]."""
        return self.table[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy(np.float64)

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def are(self, *kinds: str) -> NDArray[np.bool_]:
        """Return which rows are of tags of some kinds [n]."""
        return np.asarray(self.table["tx"].str.startswith(kinds), np.bool_)

    def through(self, what: str) -> Floats:
        """Return 1 where straight ways go through such a thing, else 0 [n]."""
        return np.array([float(what in some) for some in self.table["obstacles"]])

    def hidden(self, share: float) -> Floats:
        """Return 1 at so many of all links by lot, of those behind something, else 0 [n]."""
        behind = self.table["obstacles"].str.len().gt(0).to_numpy()
        some = self.rng.permutation(np.unique(self.link[behind]))
        count = min(max(1, round(share * (int(self.link.max()) + 1))), len(some))
        return np.isin(self.link, some[:count]).astype(np.float64)

    def longer(self, tag_m: Floats | float, post_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by so much [n, 3], in m [n]."""
        way = self.rider - self.hears
        off = np.asarray(tag_m) - np.asarray(post_m)
        return np.asarray(np.linalg.norm(way + off, axis=1) - np.linalg.norm(way, axis=1))

    def widens(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        now_s = self.course["into_s"]
        return self.longer(ridden(self.course, now_s + later_s) - ridden(self.course, now_s))
