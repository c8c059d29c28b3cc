"""The log evidence of sets of causes, of devices of which all may be off, or one alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bench.discrepancy.sets.blocks import Blocks
from bench.discrepancy.sets.choice import Set, but
from bench.discrepancy.sets.evidence import Evidence, Weighed


def weighed(
    evidence: Evidence, single: Mapping[str, Blocks], sets: Sequence[Set]
) -> dict[Set, float]:
    """Return the log evidence of sets in nats, all at once.

    `single` are, by effect, the causes that one device alone has a value of it.
    """
    every = dict(zip(sets, evidence.of_all(sets), strict=True))
    alone = [(key, name) for key in sets for name in key if name in single]
    others = evidence.of_all([_of_one(evidence, every[key], n, single[n]) for key, n in alone])
    best = {key: [made.nats] for key, made in every.items()}
    for (key, name), other in zip(alone, others, strict=True):
        best[key].append(other.nats - float(np.log(len(single[name]))))
    return {key: max(*nats, -np.inf) for key, nats in best.items()}


def _of_one(evidence: Evidence, made: Weighed, name: str, single: Blocks) -> Set:
    """Return a set in which one device alone has a value of an effect: that of the largest."""
    widths = evidence.widths[name]
    first = sum(widths[: int(np.argmax(widths))])  # the widest part is that of the devices
    mine = evidence.places[name][first : first + len(single)]
    of_device = made.factors[np.isin(made.places, mine)]
    loudest = list(single)[int(np.argmax(np.abs(of_device)))]
    return (*but(made.causes, name), loudest)
