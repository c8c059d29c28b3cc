"""Whether links agree on a member of a set: it is no effect of all links if few of them decide.

The likelihood of links may be wrong for some: one that is odd as no simulated link is gains many
nats from any effect that makes its oddity less rare. How far links differ in what they gain tells
how far their sum is by chance (Vuong 1989, a test of models neither of which need be right). Links
in which a member does nothing, as what it needs is not in their way, are not asked; but where some
were struck at random, others may have been, too, and what is odd is odd behind an obstacle as well.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.joint.beyond_level import beyond_level
from bench.discrepancy.joint.likelihood import link_nats
from bench.discrepancy.joint.polish import Fit
from bench.discrepancy.joint.settings import ACTS, FEWEST_ALIKE, NAME_NATS
from bench.discrepancy.joint.statistics import Statistics
from bench.discrepancy.settings import ONE_SIDED_95


def links_agree(given: Statistics, fit: Fit, rest: Fit, struck: bool = False) -> bool:
    """Return whether links speak for a set over the `rest` of it beyond how they differ.

    Less what its parameters cost. Where rows of links tell, too, these are not asked. `struck`:
    links may have been struck at random, so all are asked.
    """
    if given.told_within:
        return True
    whole, less = (link_nats(given, one.moments, one.responses) for one in (fit, rest))
    cost = (fit.parameters - rest.parameters) / 2 * float(np.log(given.links))
    gains = np.asarray(whole - less)[_acted_on(fit, rest) | struck]
    if len(gains) < FEWEST_ALIKE:
        return False
    error = float(np.std(gains, ddof=1) * np.sqrt(len(gains)))
    return float(gains.sum()) - cost >= ONE_SIDED_95 * error


def _acted_on(fit: Fit, rest: Fit) -> NDArray[np.bool_]:
    """Return in which links [L] what a set has beside the `rest` of it does anything."""
    more = [r for n, r in zip(fit.names, fit.responses, strict=True) if n not in rest.names]
    return np.asarray(np.abs(np.stack(more)).max(axis=(0, 2)) >= ACTS)


def brings_its_own(given: Statistics, fit: Fit, rest: Fit, struck: bool) -> bool:
    """Return whether a set does more than its rest and a level would, and links agree on that.

    See `links_agree` for `struck`.
    """
    agreed = links_agree(given, fit, rest, struck)
    return agreed and beyond_level(given, fit, rest) >= NAME_NATS
