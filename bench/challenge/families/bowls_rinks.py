"""The bowls green: bowls, rollers, players and umpires below a skin of air, and rows of these.

numpy and pandas alone. A blower holds a skin up over rinks of carpet; a net of ropes lies on it,
whose knots have radios. Bowls run on a bias, which turns them the faster the slower they are (Cross
1998); rollers press carpets to and fro; players follow, and umpires walk round heads of bowls.
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
GREEN_M = (42.0, 26.0)
"""The green: along its rinks, and across them."""
CROWN_M = 9.2  # how high the skin is, which is half an ellipse across
KNOTS_AT = (
    (2.4, 38), (3.1, 143), (9.2, 76), (10.6, 23), (14.8, 157), (18.3, 108), (21.7, 61), (25.1, 31),
    (28.4, 149), (32.2, 92), (38.7, 46), (39.6, 134),
)  # fmt: skip
"""Where knots are: how far along in m, and how far round the skin in degrees."""
KNOTS = len(KNOTS_AT)
ALONG_M: Floats = np.array([at for at, _ in KNOTS_AT])
ROUND: Floats = np.radians([at for _, at in KNOTS_AT])


def on_the_skin(angle: Floats) -> Floats:
    """Return how far across and how high the skin is at angles in rad [..., 2], in m."""
    half = GREEN_M[1] / 2
    return np.stack([half * (1 + np.cos(angle)), CROWN_M * np.sin(angle)], axis=-1)


KNOTS_M = np.asarray(np.column_stack([ALONG_M, on_the_skin(ROUND)]).round(2), np.float64)
"""Where knots are, in m."""
TAGS = (
    "bowl0", "bowl1", "bowl2", "bowl3", "bowl4", "roller0", "roller1", "player0", "player1",
    "player2", "umpire0", "umpire1", "umpire2",
)  # fmt: skip
KINDS = ("bowl", "roller", "player", "umpire")
PLACES = ("rinks", "carpet", "banks", "heads")
"""Where each kind is."""
THROUGH = ("wood", "chipboard", "plasterboard", "glass")
"""What may stand between: benches, hoardings, walls of the changing rooms, panes of the club's."""
COURSE = (
    "kind", "from_x", "from_y", "from_z", "toward", "quick", "bias", "wide", "runs", "span_s",
    "into_s",
)  # fmt: skip
"""How a tag goes, known to nobody; see `led`."""
KEEN = 0.96  # how sharply rollers turn round; 1 is at once
OVAL = 0.6  # how wide umpires' ways are, of how long
CREEPS = 0.05  # m/s that rollers come on aside
PER_PPM_M = 149.896229  # metres for each second of a reply
WAVE_M = 0.299792458 / 3.9936  # channel 4
DAY_S = 8.2 * 3600
LOOPS_M = 0.84  # from one heating pipe below the carpet to the next
FATHOM_M = 1.8288
LAWS = {
    "grip-wax-on-shells": Law(("saturation", "logarithm", "power")),
    "nap-stands-up": Law(("power", "parabola")),
    "blower-close-by": Law(("inverse", "power", "inverse square")),
    "rain-runs-down-the-skin": Law(("power", "logarithm", "saturation")),
    "skirt-tubes-filled": Law(("linear", "power")),
    "heating-loops-passed": Law(("periodic",), LOOPS_M, "m", grows=False),
    "airlock-held-open": Law(("step",), 0.093, "m"),
    "skin-breathes": Law(),
    "crown-of-the-green-left-out": Law(),
    "tag-on-the-rollers-drum": Law(),
    "heights-taped-down-the-slope": Law(),
    "converter-remembers-last-answer": Law(),
    "knot-dragged-by-a-floodlight": Law(("position",), 0.48, "m", devices=("knot6",)),
    "knots-plugged-crosswise": Law(("swap",), devices=("knot3", "knot8")),
    "fathoms-from-one-knot": Law(
        ("unit",), 1 / FATHOM_M, "1", grows=False, devices=("knot10",)
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


def _bowled(course: Mapping[str, Floats], gone_s: Floats) -> list[Floats]:
    """Return how far bowls are along and aside of how they were sent, in m.

    They slow down evenly, and turn by `bias` with each factor of e that they are slower.
    """
    bowls = course["kind"] < 0.5
    first = np.where(bowls, course["quick"], 1.0)
    slows = np.where(bowls, course["wide"], 1.0)
    power = 2.0 - 1j * np.where(bowls, course["bias"], 0.0)
    left = (1 - slows * gone_s / first).clip(1e-9)
    way = first**2 / slows * (1 - left**power) / power
    return [way.real, way.imag]


def _to_and_fro(course: Mapping[str, Floats], gone_s: Floats) -> list[Floats]:
    """Return how far rollers are along and aside, in m: all but evenly, and round at both ends."""
    turns = np.where(course["kind"] == 1.0, 2 * np.pi / course["quick"].clip(1.0), 0.0)
    at, begun = (np.arcsin(KEEN * np.sin(course["bias"] + turns * s)) for s in (gone_s, 0 * gone_s))
    return [course["wide"] * (at - begun) / np.arcsin(KEEN), CREEPS * gone_s]


def _followed(course: Mapping[str, Floats], gone_s: Floats) -> list[Floats]:
    """Return how far players are along and aside, in m: from rest, along a parabola."""
    along = course["quick"] * gone_s**2 / (gone_s + course["wide"].clip(0.1))
    return [along, course["bias"] * along**2]


def _circled(course: Mapping[str, Floats], gone_s: Floats) -> list[Floats]:
    """Return how far umpires are along and aside on their ovals, in m."""
    at = course["bias"] + course["quick"] * gone_s / course["wide"].clip(0.1)
    along = np.cos(at) - np.cos(course["bias"])
    aside = OVAL * (np.sin(at) - np.sin(course["bias"]))
    return [course["wide"] * along, course["wide"] * aside]


def rolled(course: Mapping[str, Floats], into_s: Floats) -> Floats:
    """Return how far tags are along and aside of their ways, some time into these [2, n], in m.

    Bowls are sent at `quick` m/s and slow down by `wide` m/s2. Rollers are back after `quick` s,
    `wide` m to either side, begun at an angle `bias`. Players come up to `quick` m/s in some `wide`
    s, `bias` aside a metre squared. Umpires go at `quick` m/s about ovals `wide` m in half.
    """
    gone_s = course["runs"] * into_s
    ways = [np.stack(way(course, gone_s)) for way in (_bowled, _to_and_fro, _followed, _circled)]
    return np.asarray(np.select([course["kind"] == k for k in range(4)], ways))


def led(course: Mapping[str, Floats], into_s: Floats) -> Floats:
    """Return where tags are some time into their courses [n, 3], in m."""
    along, aside = rolled(course, into_s)
    cos, sin = np.cos(course["toward"]), np.sin(course["toward"])
    moved = [along * cos - aside * sin, along * sin + aside * cos, np.zeros(len(along))]
    return np.column_stack([course[f"from_{a}"] + m for a, m in zip("xyz", moved, strict=True)])


class End:
    """Rows of a table; all tables of a case share what `stable` seeds, `rng` draws all else."""

    def __init__(
        self, table: pd.DataFrame, stable: int, rng: np.random.Generator, rare: bool = False
    ) -> None:
        self.table, self.stable, self.rng, self.rare = table, stable, rng, rare
        self.rows = len(table)

    def __getitem__(self, name: str) -> Floats:
        """Return a column [n]."""
        return np.asarray(self.table[name], np.float64)

    def shared(self, what: int) -> np.random.Generator:
        """Return random numbers that all tables of a case have in common."""
        return np.random.default_rng([self.stable, 2403, what])

    @cached_property
    def far(self) -> Floats:
        """True distances in m [n]."""
        return self["true_range_m"]

    @cached_property
    def knot(self) -> Integers:
        """Numbers of knots [n]."""
        return self.table["rx"].str.slice(4).to_numpy(str).astype(np.int64)

    @cached_property
    def tag(self) -> Integers:
        """Numbers of tags [n], as in TAGS."""
        return self.table["tx"].map(TAGS.index).to_numpy(np.int64)

    def are(self, kind: str) -> Floats:
        """Return 1 at rows of tags of a kind, else 0 [n]."""
        return np.asarray(self.table["tx"].str.startswith(kind), np.float64)

    @cached_property
    def link(self) -> Integers:
        """Numbers of links [n], from 0 on."""
        return pd.factorize(self.table["link"], sort=True)[0].astype(np.int64)

    @cached_property
    def end(self) -> Integers:
        """Numbers of ends [n], from 0 on."""
        names = self.table["link"].str.split(" to ").str[0]
        return np.asarray(pd.factorize(names, sort=True)[0], np.int64)

    @cached_property
    def copy(self) -> Integers:
        """How many rows of the same link and moment are before rows [n]: copies of a table."""
        return np.asarray(self.table.groupby(["link", "time_s"]).cumcount(), np.int64)

    def by_link(self, draws: Callable[[int], NDArray[np.generic]]) -> Floats:
        """Return what each link draws, at its rows [n]."""
        return np.asarray(draws(int(self.link.max()) + 1), np.float64)[self.link]

    @cached_property
    def below(self) -> Floats:
        """Where tags are said to be [n, 3], in m."""
        return self.table[[f"tx_{axis}_m" for axis in "xyz"]].to_numpy(np.float64)

    @cached_property
    def aloft(self) -> Floats:
        """Where knots are said to be [n, 3], in m."""
        return KNOTS_M[self.knot]

    @cached_property
    def course(self) -> dict[str, Floats]:
        """How tags go, [n] each."""
        return {name: self[name] for name in COURSE}

    def meets(self, what: str) -> Floats:
        """Return 1 where a straight way meets such a thing, else 0 [n]."""
        return self.table["obstacles"].map(lambda some: what in some).to_numpy(np.float64)

    def struck(self, share: float) -> Floats:
        """Return 1 at links behind something, by lot so many of all links, else 0 [n]."""
        behind = self.table["obstacles"].str.len().gt(0).to_numpy(bool)
        among = self.rng.permutation(np.unique(self.link[behind]))
        count = round(share * (int(self.link.max()) + 1))
        return np.isin(self.link, among[: max(1, count)]).astype(np.float64)

    def stretched(self, tag_m: Floats | float, knot_m: Floats | float = 0.0) -> Floats:
        """Return by how much ways are longer whose ends are off by so much [n, 3], in m [n]."""
        apart = self.below - self.aloft
        return np.asarray(
            np.linalg.norm(apart + tag_m - knot_m, axis=1) - np.linalg.norm(apart, axis=1)
        )

    def stretches_in(self, later_s: Floats | float) -> Floats:
        """Return by how much ways are longer some time later, in m [n]."""
        now = self.course["into_s"]
        return self.stretched(led(self.course, now + later_s) - led(self.course, now))
