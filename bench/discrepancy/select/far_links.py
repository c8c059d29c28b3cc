"""Links whose ranges lie far off those of all others: who stood in the way, no column may know.

Walls and bodies that a table does not list strike links at random, and a model that reads the table
cannot say which. The recordings can: a link keeps its offset.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.view import Added, View
from bench.discrepancy.data.device_rows import devices_of
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.settings import FAR_LIST, FAR_M, FAR_SHARE, FAR_STD, LONG_SHARE
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.stepwise import versions
from bench.discrepancy.settings import MAD_TO_STD
from bench.physics.units import Floats

SIGHT = "los"
LEAVE_OUT = "if it knows of listed obstacles alone, leave that column out"
ALL_LISTED = "; all of them have listed obstacles in their way"


@dataclass(frozen=True)
class FarLinks:
    """Offsets [L] of links in metres; `far` [k] numbers those far off the others, worst first."""

    offset_m: Floats
    far: NDArray[np.intp]

    @property
    def calm_m(self) -> float:
        """The median offset of all links: of most of them nothing is far off."""
        return float(np.median(self.offset_m))

    @property
    def long(self) -> bool:
        """Whether far links are told as a rule by ranges that are too long, as obstacles make."""
        beyond = self.offset_m[self.far] > self.calm_m
        return len(self.far) > 1 and float(beyond.mean()) >= LONG_SHARE

    def worst(self, names: NDArray[Any]) -> str:
        """Return the worst of them with their offsets; `names` [L] are those of all links."""
        return ", ".join(
            f"{names[one]} ({self.offset_m[one]:+.2f} m)" for one in self.far[:FAR_LIST]
        )


def far_links(offset_m: Floats) -> FarLinks:
    """Return which links' mean residuals [L] are far off the others: none where too many are."""
    aside = np.abs(offset_m - np.median(offset_m))
    scale = MAD_TO_STD * float(np.median(aside))
    far = np.flatnonzero(aside > max(FAR_M, FAR_STD * scale))
    kept = far if len(far) <= FAR_SHARE * len(offset_m) else far[:0]
    return FarLinks(offset_m, kept[np.argsort(-aside[kept])])


def links_in_the_way(search: Search, added: Added) -> str:
    """Return which links read far longer than the others beside some effects, "" for none."""
    rows = search.both
    made = versions(search.comparison, rows, added)
    if RANGE not in made.names:
        return ""
    left, codes = made.residual_of(RANGE), np.unique(rows.links, return_inverse=True)[1]
    offset_m = np.bincount(codes, np.nan_to_num(left)) / np.bincount(codes)
    found = far_links(offset_m)
    if not found.long:
        return ""
    who = _device(rows, codes, found.far)
    names = rows.frame["link"].astype(str).to_numpy()[np.unique(codes, return_index=True)[1]]
    open_ways = np.bincount(codes, rows.scene.obstacle_count() == 0) > 0
    listed = not open_ways[found.far].any()  # something is listed in the way of all of them
    return (
        f"{len(found.far)} of {len(offset_m)} links read far longer than the others, "
        f"whose offset is {found.calm_m:+.2f} m in the median: {found.worst(names)}"
        f"{who or (ALL_LISTED if listed else _advice(rows, np.isin(codes, found.far)))}"
    )


def _device(rows: View, codes: NDArray[np.intp], far: NDArray[np.intp]) -> str:
    """Return which device's all far links are, as most of its own are far, "" where none's."""
    for name, mask in devices_of(rows.frame).items():
        own = np.bincount(codes, mask) > 0
        if own[far].all() and 2 * len(far) > own.sum() and not own.all():
            return f"; all of them are links of {name}, of {own.sum()}: look at that device first"
    return ""


def _advice(rows: View, far: NDArray[np.bool_]) -> str:
    """Return what to do about rows [n] that are far off, of links that are not all behind walls."""
    listed = "; if something stands in their way, list it (`obstacles`, `los`)"
    if SIGHT not in rows.frame or rows.scene.blocked()[far].any():
        return listed
    return f"{listed}; {SIGHT} says line of sight of all of them: {LEAVE_OUT}"
