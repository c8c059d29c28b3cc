"""Delays that are scales: every device has a share of the distance of its own.

Clocks differ, and so do the units of speed that firmware was built with: a scale is seldom the same
in every device. What devices have of their own beside the common scale is nearly constant where
their links are of much the same length, and delays per device take it up. So where delays are named
they are held against a scale that differs by device: where that does as well, either may be there;
and delays beside a scale must bring what a name must, beyond what its devices may differ by, in
links in sight.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bench.discrepancy.sets.choice import Set, but
from bench.discrepancy.sets.in_sight import telling
from bench.discrepancy.sets.settings import NAME_NATS, OWN_SCALE, RIVAL_NATS
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.range_scale import TYPICAL_SCALE, RangeScale

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from bench.discrepancy.sets.choose import Contest
    from bench.discrepancy.sets.evidence import Evidence

BY_DEVICE = "a scale that differs by device"


def without_scales(contest: Contest, causes: Set) -> Set:
    """Return the set without delays beside a scale that does as well if it differs by device."""
    if not {AntennaDelay.name, RangeScale.name} <= set(causes):
        return causes
    made = _by_device(contest)
    if made is None:
        return causes
    made = made.among(telling(contest))
    alike = (*but(but(causes, AntennaDelay.name), RangeScale.name), BY_DEVICE)
    lead = made.of((*alike, AntennaDelay.name)).nats - made.of(alike).nats
    return but(causes, AntennaDelay.name) if lead < NAME_NATS * contest.crowding else causes


def scales_for_delays(contest: Contest, causes: Set) -> Set:
    """Return the scale's name where delays are named and it, by device, does as well; or none."""
    fit = AntennaDelay.name in causes and RangeScale.name in contest.library - set(causes)
    made = _by_device(contest) if fit else None
    if made is None:
        return ()
    other = made.of((*but(causes, AntennaDelay.name), BY_DEVICE))
    behind = contest.evidence.of(causes).nats - other.nats
    return (RangeScale.name,) if behind < RIVAL_NATS * contest.crowding else ()


def _by_device(contest: Contest) -> Evidence | None:
    """Return the evidence with a scale that differs by device; None without delays of devices."""
    blocks = contest.evidence.blocks
    if not {AntennaDelay.name, RangeScale.name} <= set(blocks):
        return None
    common, own = blocks[RangeScale.name][0], blocks[AntennaDelay.name][-1]
    share: NDArray[np.float64] = OWN_SCALE / TYPICAL_SCALE * common * (own != 0)
    return contest.evidence.with_blocks({**blocks, BY_DEVICE: (common, share)})
