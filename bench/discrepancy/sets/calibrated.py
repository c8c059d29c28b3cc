"""A constant that makes the mean of all ranges nothing is what a calibration took off.

Radios are often calibrated where they are used: what their errors are in the mean is taken off all
ranges. What walls or a scale add in the mean then stands beside a constant that is its opposite. No
antenna has that delay, and no other name does it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bench.discrepancy.data.grouped import group_means
from bench.discrepancy.sets.choice import Set, but
from bench.discrepancy.sets.rivals import with_constant
from bench.discrepancy.sets.settings import CALIBRATED_SHARE, LAW_M, LEAST_WEIGHT, RIVAL_NATS
from bench.discrepancy.settings import ONE_SIDED_95

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest

TAKEN_OFF = "what a calibration took off all ranges"


def without_calibration(contest: Contest, causes: Set) -> Set:
    """Return the set with a mere constant that others' mean is the opposite of as no name.

    Mere: a constant does as well as the name, within 3 nats.
    """
    for name in [one for one in causes if one in contest.library]:
        rest = but(causes, name)
        if not contest.library.intersection(rest):
            continue
        least = contest.evidence.of(causes).nats - RIVAL_NATS * contest.crowding
        nats, constant_m = with_constant(contest, contest.evidence, rest)
        if nats > least and _takes_the_mean(contest, constant_m):
            column = contest.seen(np.full((len(contest.known), 1), LAW_M))
            blocks = {**contest.evidence.blocks, TAKEN_OFF: (column,)}
            contest.evidence = contest.evidence.with_blocks(blocks)
            return (*rest, TAKEN_OFF)
    return causes


def _takes_the_mean(contest: Contest, constant_m: float) -> bool:
    """Return whether ranges have no mean, though others of a set must have left the opposite one.

    Within chance over links (90 %) and a quarter of the constant, which a delay of
    antennas would come to only by chance.
    """
    part = contest.evidence.weights > LEAST_WEIGHT
    left_m = contest.evidence.left_m[part]
    links = np.unique(contest.evidence.links[part], return_inverse=True)[1]
    first = np.unique(links, return_index=True)[1]
    means = group_means(left_m[:, None], links)[first, 0]
    error_m = float(np.std(means)) / np.sqrt(len(means))
    least_m = min(ONE_SIDED_95 * error_m, CALIBRATED_SHARE * abs(constant_m))
    return bool(abs(left_m.mean()) < least_m)
