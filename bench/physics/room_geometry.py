"""Draws the geometry of the simulated rooms: antennas, paths of the tag, obstacles between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.physics.room_plan import HEIGHT_M, ROW_TOTAL, ROWS_PER_LINK, Place, Plan, Thing, plan
from bench.physics.units import Floats

_RATE_HZ = 10.0  # ranges per second, as the laser tracker of the paper
_MARGIN_M = 0.25
_SHORTEST_M = 0.8
_METAL = ("LCD TV", "metal plate", "metal window")


@dataclass(frozen=True)
class _Links:
    """One place's links: L of them, `rows` [L] rows each, `sight` [L] line of sight."""

    place: Place
    things: tuple[Thing, ...]
    rows: NDArray[np.intp]
    sight: NDArray[np.bool_]
    anchor: Floats
    tag: Floats

    @cached_property
    def shares(self) -> Floats:
        """How often it is one of the things up to each of them; of metal more or less often."""
        kinds = [self.place.metal if thing.kind in _METAL else 1.0 for thing in self.things]
        share = np.array([thing.share for thing in self.things]) * kinds
        total = np.cumsum(share / share.sum())
        return np.asarray(total / total[-1])


def room_geometry(
    rng: np.random.Generator, rows: int = ROW_TOTAL, of: Plan | None = None
) -> pd.DataFrame:
    """Return the geometry columns of the rooms: 55 000 rows, or fewer of the same mixture.

    Nothing is simulated yet: positions, true range, sight, obstacles, devices, link, time. The
    plan is that of `rooms`, or another one `of` the same structure.
    """
    of = of or plan()
    counts = _shared_out(of.places, rows)
    parts = [
        _place(place, of.things, rng, *count)
        for place, count in zip(of.places, counts, strict=True)
        if sum(count)
    ]
    return pd.concat(parts, ignore_index=True)


def _shared_out(places: tuple[Place, ...], rows: int) -> list[tuple[int, int]]:
    """Return rows without and with sight of each place, `rows` in all, in the full mixture."""
    whole = np.array([[place.nlos_rows, place.los_rows] for place in places])
    exact = whole * rows / whole.sum()
    counts = np.floor(exact).astype(int)
    most = np.argsort((counts - exact).ravel(), kind="stable")[: rows - counts.sum()]
    counts.ravel()[most] += 1
    return [(int(blocked), int(clear)) for blocked, clear in counts]


def _place(
    place: Place, things: tuple[Thing, ...], rng: np.random.Generator, nlos: int, los: int
) -> pd.DataFrame:
    """Return the rows of one environment."""
    links = _links(place, things, rng, nlos, los)
    frame = _walk(links, rng)
    return _with_obstacles(frame, links, rng)


def _links(
    place: Place, things: tuple[Thing, ...], rng: np.random.Generator, nlos: int, los: int
) -> _Links:
    """Draw the links: how many rows each, and where anchor and tag stand."""
    blocked, clear = _sizes(rng, nlos), _sizes(rng, los)
    rows = np.concatenate([blocked, clear])
    sight = np.arange(len(rows)) >= len(blocked)
    anchor, tag = _ends(place, rng, len(rows))
    return _Links(place, things, rows, sight, anchor, tag)


def _sizes(rng: np.random.Generator, total: int) -> NDArray[np.intp]:
    """Return sizes of links that sum to `total`."""
    low, high = ROWS_PER_LINK
    drawn = rng.integers(low, high + 1, total // low + 1)
    ends = np.minimum(np.cumsum(drawn), total)
    sizes = np.diff(ends, prepend=0)
    return np.asarray(sizes[sizes > 0], np.intp)


def _ends(place: Place, rng: np.random.Generator, links: int) -> tuple[Floats, Floats]:
    """Draw anchor and tag positions [L, 3], at least 0.8 m apart."""
    anchor, tag = _corner_points(place, rng, links), _points(place, rng, links, second=True)
    for _ in range(50):
        near = np.linalg.norm(anchor[:, :2] - tag[:, :2], axis=1) < _SHORTEST_M + 0.4
        if not near.any():
            break
        tag[near] = _points(place, rng, int(near.sum()), second=True)
    return anchor, tag


def _points(place: Place, rng: np.random.Generator, count: int, *, second: bool) -> Floats:
    """Draw tag positions within the place; behind the wall where there is one."""
    low, high = _bounds(place, second)
    spot = rng.uniform([*low, 0.6], [*high, 1.6], (count, 3))
    return np.asarray(spot)


def _corner_points(place: Place, rng: np.random.Generator, count: int) -> Floats:
    """Draw anchor positions: on tripods and shelves, rather near the walls."""
    low, high = _bounds(place, second=False)
    toward = rng.beta(0.6, 0.6, (count, 2))
    flat = low + toward * (high - low)
    return np.column_stack([flat, rng.uniform(1.0, 2.2, count)])


def _bounds(place: Place, second: bool) -> tuple[Floats, Floats]:
    floor = np.array(place.floor_m or (12.0, 12.0))
    low, high = np.full(2, _MARGIN_M), floor - _MARGIN_M
    if place.wall_at_m is not None:
        wall = place.wall_at_m
        low[0], high[0] = (wall + 0.4, high[0]) if second else (low[0], wall - 0.4)
    return low, high


def _walk(links: _Links, rng: np.random.Generator) -> pd.DataFrame:
    """Return one row per range: the tag moves slowly along a straight path of its own."""
    count = len(links.rows)
    link = np.repeat(np.arange(count), links.rows)
    step = np.concatenate([np.arange(size) for size in links.rows])
    speed, course = rng.uniform(0.03, 0.3, count), rng.uniform(0, 2 * np.pi, count)
    way = np.column_stack([np.cos(course), np.sin(course), np.zeros(count)]) * speed[:, None]
    tag = links.tag[link] + way[link] * (step / _RATE_HZ)[:, None]
    tag[:, 2] += 0.01 * rng.standard_normal(len(tag))
    low, high = _bounds(links.place, second=True)
    tag[:, :2] = np.clip(tag[:, :2], low - 0.1, high + 0.1)
    frame = pd.DataFrame({"environment": links.place.name, "los": links.sight[link]})
    frame["link"] = np.char.add(f"{links.place.name}-", np.char.zfill(link.astype("U4"), 4))
    frame["tx"] = np.char.add("anchor-", (link % 4 + 1).astype("U1"))
    frame["rx"] = "tag"
    for axis, name in enumerate("xyz"):
        frame[f"tx_{name}_m"], frame[f"rx_{name}_m"] = links.anchor[link, axis], tag[:, axis]
    frame["true_range_m"] = np.linalg.norm(tag - links.anchor[link], axis=1)
    frame["azimuth_deg"] = rng.uniform(-180, 180, count)[link]
    frame["time_s"] = np.arange(len(frame)) / _RATE_HZ
    floor = links.place.floor_m or (np.nan, np.nan)
    sizes = (*floor, HEIGHT_M if links.place.floor_m else np.nan)
    return frame.assign(**{f"room_{a}_m": size for a, size in zip("xyz", sizes, strict=True)})


def _with_obstacles(frame: pd.DataFrame, links: _Links, rng: np.random.Generator) -> pd.DataFrame:
    """Add the obstacle columns: kinds, thickness, place on the line, edges, incidence."""
    link = np.repeat(np.arange(len(links.rows)), links.rows)
    step = np.concatenate([np.arange(size) for size in links.rows])
    first = frame.index.to_numpy() - step
    drawn = [_drawn(links, at, rng) for at in range(len(links.rows))]
    kinds = [each[0] for each in drawn]
    count = np.array([len(each) for each in kinds], np.intp)
    padded = np.full((len(drawn), 5, max(1, count.max(initial=0))), np.nan)
    for at, each in enumerate(drawn):
        padded[at, :, : count[at]] = each[1:]
    thick, place, near, far, angle = np.moveaxis(padded[link], 1, 0)
    moved = _sideways(frame, first)[:, None] * place
    edges = np.maximum(near + moved, 0.02), np.maximum(far - moved, 0.02)
    columns = [_cells(each, count[link]) for each in (thick, place, *edges, angle)]
    columns = [_objects(kinds)[link], *columns]
    return frame.assign(**dict(zip(_COLUMNS, columns, strict=True)))


def _objects(cells: Sequence[Any]) -> NDArray[Any]:
    """Return an array with one cell per entry, whatever it holds."""
    made = np.empty(len(cells), object)
    made[:] = list(cells)
    return made


def _cells(padded: Floats, count: NDArray[np.intp]) -> NDArray[Any]:
    """Return the first `count` [n] values of each row of `padded` [n, M] as one array each."""
    made = np.empty(len(padded), object)
    for size in np.unique(count):
        rows = np.flatnonzero(count == size)
        made[rows] = _objects(list(padded[rows, :size]))
    return made


_COLUMNS = (
    "obstacles",
    "obstacle_thickness_m",
    "obstacle_at",
    "obstacle_clearance_m",
    "obstacle_far_clearance_m",
    "obstacle_incidence_deg",
)


def _sideways(frame: pd.DataFrame, first: NDArray[np.intp]) -> Floats:
    """Return how far the tag has moved across its link's first straight line [n] in metres."""
    tag = frame[["rx_x_m", "rx_y_m"]].to_numpy()
    anchor = frame[["tx_x_m", "tx_y_m"]].to_numpy()
    line = tag[first] - anchor[first]
    across = np.column_stack([-line[:, 1], line[:, 0]]) / np.linalg.norm(line, axis=1)[:, None]
    return np.asarray(np.einsum("na,na->n", tag - tag[first], across))


def _drawn(
    links: _Links, at: int, rng: np.random.Generator
) -> tuple[list[str], Floats, Floats, Floats, Floats, Floats]:
    """Draw the obstacles of one link: one, sometimes two; none with line of sight."""
    known = links.things
    if links.sight[at]:
        chosen = []
    else:
        count = 1 + int(rng.random() < 0.12)
        places = np.searchsorted(links.shares, rng.random(count), "right")
        chosen = [known[place] for place in places]
    thick = links.place.thickness * np.array([rng.uniform(*t.thickness_m) for t in chosen])
    width = np.array([rng.uniform(*thing.width_m) for thing in chosen])
    near = width * rng.uniform(0.1, 0.5, len(chosen))
    place, angle = rng.uniform(0.15, 0.85, len(chosen)), rng.uniform(0, 40, len(chosen))
    kinds, far = [thing.kind for thing in chosen], width - near
    if links.place.wall_at_m is None:
        return kinds, thick, place, near, far, angle
    return _through_wall(links, at, rng)


def _through_wall(
    links: _Links, at: int, rng: np.random.Generator
) -> tuple[list[str], Floats, Floats, Floats, Floats, Floats]:
    """Return the one wall between two rooms, its place and angle from the geometry."""
    way = links.tag[at] - links.anchor[at]
    share = ((links.place.wall_at_m or 0.0) - links.anchor[at][0]) / way[0]
    angle = np.degrees(np.arccos(np.clip(abs(way[0]) / np.linalg.norm(way), 0, 1)))
    edge = np.array([rng.uniform(1.0, 2.5)])
    thick = np.array([rng.uniform(0.1, 0.3)])
    return ["wall"], thick, np.array([share]), edge, edge + 1.0, np.array([angle])
