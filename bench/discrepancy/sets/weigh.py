"""The log evidence of sets of causes, of devices of which all may be off, or one or two alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import comb, log

import numpy as np

from bench.discrepancy.sets.blocks import Blocks
from bench.discrepancy.sets.choice import Set, but
from bench.discrepancy.sets.evidence import Evidence, Weighed

FEW = (1, 2)  # devices that are off alone: more have values of one common size


def weighed(
    evidence: Evidence, single: Mapping[str, Blocks], sets: Sequence[Set]
) -> dict[Set, float]:
    """Return the log evidence of sets in nats, all at once.

    `single` are, by effect, the causes that one device alone has a value of it. Which few devices
    these are is paid for.
    """
    every = dict(zip(sets, evidence.of_all(sets), strict=True))
    alone = [
        (key, name, few)
        for key in sets
        for name in key
        for few in FEW
        if len(single.get(name, ())) > few
    ]
    others = evidence.of_all([_of_few(evidence, every[k], n, single[n], f) for k, n, f in alone])
    best = {key: [made.nats] for key, made in every.items()}
    for (key, name, few), other in zip(alone, others, strict=True):
        best[key].append(other.nats - log(comb(len(single[name]), few)))
    return {key: max(*nats, -np.inf) for key, nats in best.items()}


def _of_few(evidence: Evidence, made: Weighed, name: str, single: Blocks, few: int) -> Set:
    """Return a set in which so few devices have a value of an effect: those of the largest."""
    widths = evidence.widths[name]
    first = sum(widths[: int(np.argmax(widths))])  # the widest part is that of the devices
    mine = evidence.places[name][first : first + len(single)]
    of_device = made.factors[np.isin(made.places, mine)]
    loudest = np.argsort(-np.abs(of_device))[:few]
    return (*but(made.causes, name), *(list(single)[int(one)] for one in loudest))
