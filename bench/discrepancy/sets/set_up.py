"""Faults of the set-up that take part: devices that stand elsewhere, are swapped, have own units.

They have no name to be given; they are there so that no name is given for them.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.compare.view import View
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.law.settings import LAW_SAME_PLACE_M
from bench.discrepancy.law.swaps import FAR_END
from bench.discrepancy.sets.blocks import Blocks, standard
from bench.discrepancy.sets.settings import DEVICE_ROWS, LAW_M, LAW_SCALE, MOST_DEVICES

Floats = NDArray[np.float64]
PLACE, UNIT, PLACES = "the position of ", "the unit of ", "the places of "
PLAN = "the plan of every "
SETUP = (PLACE, UNIT, PLACES, PLAN)


def of_setup(rows: View) -> Blocks:
    """Return devices that stand elsewhere, are swapped, or have a unit of their own."""
    ends = {"tx", "rx"} | {f"{end}_{axis}_m" for end in ("tx", "rx") for axis in "xyz"}
    if not ends <= set(rows.frame):
        return {}
    return _Plan(rows.frame, rows.scene.true_range_m).faults()


def is_fault(cause: str) -> bool:
    """Return whether a cause is a fault of the set-up (see `of_setup`)."""
    return cause.startswith(SETUP)


class _Plan:
    """Where devices stand still, of the ends that they are recorded at, and what may be wrong."""

    def __init__(self, frame: pd.DataFrame, true_m: Floats) -> None:
        self.true_m = true_m
        self.names = {end: frame[end].astype(str).to_numpy(dtype=object) for end in FAR_END}
        self.at = {end: _positions(frame, end) for end in FAR_END}
        self.stands = {end: _standing(self.names[end], self.at[end]) for end in FAR_END}
        way = (self.at["tx"] - self.at["rx"]) / np.maximum(true_m, 1e-3)[:, None]
        self.line = {"tx": way, "rx": -way}

    def faults(self) -> Blocks:
        """Return the blocks: a device that is at both ends in turn is off in all its rows."""
        out: Blocks = {}
        for end, stands in self.stands.items():
            moved = {}
            for name in stands:
                mine = (self.names[end] == name)[:, None]
                moved[name] = LAW_M * self.line[end] * mine
                grown = LAW_SCALE * self.true_m[:, None] * mine
                for key, columns in ((f"{PLACE}{name}", moved[name]), (f"{UNIT}{name}", grown)):
                    before = out[key][0] if key in out and self._is_one(name) else 0.0
                    out[key] = (columns + before,)
            if len(stands) > 1:  # a plan that is stretched, turned or old moves all of them at once
                out[f"{PLACE}every {end}"] = (np.hstack(list(moved.values())),)
            out[f"{PLAN}{end}"] = (self._turned(end),)
            for pair in combinations(stands, 2):
                out[f"{PLACES}{pair[0]} and {pair[1]}"] = (self._swapped(end, *pair)[:, None],)
        return out

    def _turned(self, end: str) -> Floats:
        """Return what a plan that is turned, stretched, aslant and moved does to rows [n, 6]."""
        x, y = standard(self.at[end][:, 0]), standard(self.at[end][:, 1])
        along, across = self.line[end][:, 0], self.line[end][:, 1]
        ways = (along * x, across * y, along * y, across * x, along, across)
        return LAW_M * np.stack(ways, axis=1)

    def _is_one(self, name: str) -> bool:
        """Return whether a name stands at one place at whichever end."""
        places = [stands[name] for stands in self.stands.values() if name in stands]
        return bool(np.ptp(np.stack(places), axis=0).max() <= LAW_SAME_PLACE_M)

    def _swapped(self, end: str, one: str, two: str) -> Floats:
        """Return what two devices at an end do to rows [n] where each is the other.

        At the other end, too, if they are the same there; what lies between both is as long.
        """
        shift = np.zeros(len(self.true_m))
        for name, other in ((one, two), (two, one)):
            really = self.stands[end][other]
            for side in FAR_END if self._is_one(name) else (end,):
                far = FAR_END[side]
                mine = (self.names[side] == name) & (name in self.stands[side])
                mine &= ~((self.names[far] == other) & self._is_one(other))
                away = np.linalg.norm(self.at[far][mine] - really, axis=1)
                shift[mine] = away - self.true_m[mine]
        return shift


def _positions(frame: pd.DataFrame, end: str) -> Floats:
    """Return where the device at an end is [n, 3], in metres."""
    return np.stack([np.nan_to_num(numeric(frame, f"{end}_{axis}_m")) for axis in "xyz"], axis=1)


def _standing(names: NDArray[np.object_], at: Floats) -> dict[str, Floats]:
    """Return the places [3] of the devices at an end that stand still, most rows first."""
    stands: dict[str, Floats] = {}
    often, counts = np.unique(names, return_counts=True)
    for name in often[np.argsort(-counts, kind="stable")][:MOST_DEVICES]:
        mine = names == name
        if mine.sum() >= DEVICE_ROWS and np.ptp(at[mine], axis=0).max() <= LAW_SAME_PLACE_M:
            stands[str(name)] = at[mine][0]
    return stands
