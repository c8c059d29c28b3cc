"""The paper's positioning test, SIMULATED: four anchors in the medium room, a tag in its middle.

One set-up says little about positions (its four links are four draws of the range error), so the
obstacles are drawn anew for every set-up; the paper has one set-up with and one without sight.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.physics.room_plan import HEIGHT_M, Place, Thing, places, things
from bench.physics.rooms import simulator
from bench.recordings.table import Recordings

ROOM = "medium"
ANCHORS_M = np.array([[0.3, 0.3, 2.2], [4.7, 0.3, 1.0], [4.7, 4.7, 2.2], [0.3, 4.7, 1.0]])
TAG_M = np.array([2.5, 2.5, 1.2])
RATE_HZ = 10.0
METAL = ("LCD TV", "metal plate", "metal window")


def fixed_tag(los: bool, setups: int, epochs: int, seed: int) -> Recordings:
    """Return the ranges of `setups` set-ups of `epochs` epochs, four rows an epoch.

    Rows are ordered by set-up, then epoch, then anchor; `setup` and `anchor` are columns. Without
    sight one obstacle stands in every direct path, drawn as in the simulated rooms.
    """
    rng = np.random.default_rng(seed)
    setup, epoch, anchor = (axis.ravel() for axis in np.indices((setups, epochs, len(ANCHORS_M))))
    frame = pd.DataFrame({"setup": setup, "anchor": anchor, "environment": ROOM, "los": los})
    names = np.char.add(np.char.add(f"set-up {los} ", setup.astype("U5")), " anchor ")
    frame["link"] = np.char.add(names, anchor.astype("U2"))
    frame["tx"], frame["rx"] = np.char.add("anchor-", anchor.astype("U2")), "tag"
    for axis, name in enumerate("xyz"):
        frame[f"tx_{name}_m"], frame[f"rx_{name}_m"] = ANCHORS_M[anchor, axis], TAG_M[axis]
    frame["true_range_m"] = np.linalg.norm(ANCHORS_M[anchor] - TAG_M, axis=1)
    frame["time_s"] = epoch / RATE_HZ
    for name, size in _room().items():
        frame[name] = size
    for name, cells in _obstacles(los, setups, setup * len(ANCHORS_M) + anchor, rng).items():
        frame[name] = pd.Series(cells)
    return simulator().simulate(frame, seed=seed)


def _room() -> dict[str, float]:
    width, depth = _place().floor_m or (np.nan, np.nan)
    return {"room_x_m": width, "room_y_m": depth, "room_z_m": HEIGHT_M}


def _place() -> Place:
    return next(place for place in places() if place.name == ROOM)


def _obstacles(
    los: bool, setups: int, link: NDArray[np.intp], rng: np.random.Generator
) -> dict[str, list[object]]:
    """Return the obstacle columns of the rows, the same for all rows of a link."""
    turns = rng.uniform(-180, 180, setups * len(ANCHORS_M))
    drawn = [{} if los else _obstacle(rng) for _ in turns]
    columns: dict[str, list[object]] = {"azimuth_deg": list(turns[link])}
    for name in _NUMBERS:
        columns[name] = [np.array([drawn[i][name]] if drawn[i] else []) for i in link]
    columns["obstacles"] = [[str(drawn[i]["kind"])] if drawn[i] else [] for i in link]
    return columns


_NUMBERS = (
    "obstacle_thickness_m",
    "obstacle_at",
    "obstacle_clearance_m",
    "obstacle_far_clearance_m",
    "obstacle_incidence_deg",
)


def _obstacle(rng: np.random.Generator) -> dict[str, float | str]:
    """Draw one obstacle with the shares, sizes and places of the medium room."""
    known = things()
    share = np.array([_share(thing) for thing in known])
    thing = known[rng.choice(len(known), p=share / share.sum())]
    width = rng.uniform(*thing.width_m)
    near = width * rng.uniform(0.1, 0.5)
    return {
        "kind": thing.kind,
        "obstacle_thickness_m": _place().thickness * rng.uniform(*thing.thickness_m),
        "obstacle_at": rng.uniform(0.15, 0.85),
        "obstacle_clearance_m": near,
        "obstacle_far_clearance_m": width - near,
        "obstacle_incidence_deg": rng.uniform(0, 40),
    }


def _share(thing: Thing) -> float:
    return thing.share * (_place().metal if thing.kind in METAL else 1.0)
