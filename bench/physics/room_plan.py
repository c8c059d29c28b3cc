"""The plan of the simulated rooms: which rows, in which rooms, behind which obstacles.

The structure follows the Deep UWB dataset (Angarano et al., Zenodo 10.5281/zenodo.4290069): three
office-like rooms of 10 x 5, 5 x 5 and 5 x 3.5 m, an outdoor place, and ranges through a wall; ten
obstacle kinds; a tag moving along short paths while an anchor stands still. Widths, thicknesses
and the mix of obstacles are not published; those here are plausible ones for such objects.
`ideal_plan` is the plan of `rooms` as it was before docs/rooms.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

HEIGHT_M = 2.8


@dataclass(frozen=True)
class Place:
    """One environment: its floor in metres (None: open space), rows without and with sight.

    `metal` multiplies the share of metal obstacles, `thickness` that of their material;
    `wall_at_m` is where a wall divides it.
    """

    name: str
    floor_m: tuple[float, float] | None
    nlos_rows: int
    los_rows: int
    metal: float = 1.0
    thickness: float = 1.0
    wall_at_m: float | None = None


@dataclass(frozen=True)
class Thing:
    """An obstacle kind: its share of the links, and the range of thickness and width in metres.

    `thickness_m` counts the material in the way: a full box or several plates are thick.
    """

    kind: str
    share: float
    thickness_m: tuple[float, float]
    width_m: tuple[float, float]


@dataclass(frozen=True)
class Plan:
    """The environments and the obstacle kinds that rows are drawn from."""

    places: tuple[Place, ...]
    things: tuple[Thing, ...]


LICENCE = "Apache-2.0 (simulated by uwb-bench)"
ROW_TOTAL = 55_000
ROWS_PER_LINK = (20, 40)


def plan() -> Plan:
    """Return the plan of `rooms`."""
    return Plan(places(), things())


def ideal_plan() -> Plan:
    """Return the plan of `rooms-ideal`: larger metal plates, more material, nothing unlisted."""
    shares = {"big": (0.34, 0.6), "medium": (0.38, 1.1), "small": (0.28, 0.85)}
    widths = {"LCD TV": (0.6, 1.2), "metal plate": (0.4, 1.0), "metal window": (0.6, 1.2)}
    return Plan(
        tuple(_with_shares(place, shares) for place in places()),
        tuple(replace(one, width_m=widths.get(one.kind, one.width_m)) for one in things()),
    )


def _with_shares(place: Place, shares: Mapping[str, tuple[float, float]]) -> Place:
    metal, thickness = shares.get(place.name, (place.metal, place.thickness))
    return replace(place, metal=metal, thickness=thickness)


def places() -> tuple[Place, ...]:
    """Return the environments with the row counts of the paper; 55 000 rows in all."""
    return (
        Place("big", (10.0, 5.0), 18_422, 1_564, metal=0.05, thickness=0.1),
        Place("medium", (5.0, 5.0), 13_210, 1_564, metal=0.12, thickness=0.6),
        Place("small", (5.0, 3.5), 17_601, 1_563, metal=0.06, thickness=0.2),
        Place("outdoor", None, 400, 138),
        Place("through-the-wall", (10.0, 5.0), 538, 0, wall_at_m=5.0),
    )


def things() -> tuple[Thing, ...]:
    """Return the ten obstacle kinds and how often each stands in the straight line."""
    return (
        Thing("wall", 0.01, (0.08, 0.15), (0.8, 2.0)),
        Thing("polystyrene plate", 0.10, (0.03, 0.15), (0.6, 1.2)),
        Thing("plastic", 0.15, (0.01, 0.15), (0.4, 0.8)),
        Thing("plywood plate", 0.10, (0.006, 0.025), (0.6, 1.5)),
        Thing("cardboard box", 0.13, (0.03, 0.25), (0.4, 1.0)),
        Thing("LCD TV", 0.10, (0.002, 0.004), (0.25, 0.45)),
        Thing("metal plate", 0.16, (0.001, 0.004), (0.15, 0.3)),
        Thing("wood door", 0.14, (0.03, 0.07), (0.8, 1.0)),
        Thing("glass plate", 0.12, (0.004, 0.02), (0.6, 1.4)),
        Thing("metal window", 0.05, (0.001, 0.003), (0.2, 0.4)),
    )
