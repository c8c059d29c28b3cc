"""What weighing sets of causes says."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.view import Added
from bench.discrepancy.sets.believed import Unsure

Set = tuple[str, ...]
MERE = "the same in all ranges"


@dataclass(frozen=True)
class Choice:
    """The names of most evidence, `others` (laws, faults of the set-up) beside them.

    `nats` maps names to the evidence that each brings beside the rest; `rivals` to other names
    that could stand in its place, some beside a constant (`constants_m`, by rival); `unsure` to
    what else it may do, in the set and beside causes left out; `shifts_m` to what it does to every
    row [n], names and others alike.
    `beside`: the effects that were in place, `view` the number of the rows. `mistaken`: columns set
    aside as measured that a law says are known before (see `mistaken`). `tied`: names that a device
    which stands elsewhere took the place of, though these do as well. `elsewhere`: devices of
    which one may stand elsewhere instead of the antenna delays. `faults`: of the set-up, that bring
    more than any name. `forms_do`: beside the names,
    no cause is worth its price beyond what another detector makes of waveforms that differ.
    """

    names: Set = ()
    others: Set = ()
    nats: dict[str, float] = field(default_factory=dict)
    rivals: dict[str, Set] = field(default_factory=dict)
    unsure: dict[str, Unsure] = field(default_factory=dict)
    shifts_m: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    beside: Set = ()
    view: int = -1
    mistaken: Set = ()
    constants_m: dict[str, float] = field(default_factory=dict)
    tied: Set = ()
    elsewhere: Set = ()
    faults: Set = ()
    forms_do: bool = False

    @property
    def scattering(self) -> Set:
        """The others by which rows differ, so that what they leave is no scatter: no constant."""
        return but(self.others, MERE)


def but(causes: Set, gone: str) -> Set:
    """Return a set without one of its causes."""
    return tuple(one for one in causes if one != gone)


def but_not(causes: Set, others: Set) -> Set:
    """Return the causes of a set that are not in another."""
    return tuple(one for one in causes if one not in others)


def shifting(beside: Added) -> Set:
    """Return the effects that shift ranges: scatter changes nothing there."""
    return tuple(effect.physics for effect in beside if not type(effect).independent)
