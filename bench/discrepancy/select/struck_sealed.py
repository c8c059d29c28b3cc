"""Whether held-out links bear out what strikes links at random: by their own offsets.

A mean score asks for the form of a detour in every link; offsets ask how many links are off, and
how far, as the working links said.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.select.link_mixture import (
    EXTRA_M,
    Mixture,
    Strike,
    offsets,
    strikable,
    unstruck,
)
from bench.discrepancy.select.settings import SHARES_TOLD
from bench.discrepancy.select.struck_shifts import struck_m
from bench.discrepancy.settings import BEHIND_M, OFFSET_FIRST, OFFSET_MEMBERS, WILD_SHARES


def struck_nats(comparison: Comparison, view: View, added: Added, found: Strike) -> float | None:
    """Return the log likelihood of offsets of links with a strike over that without, in nats.

    `added` are the effects beside it. The size is what other links told, the share anywhere that
    they leave it (the mean likelihood over its interval); how calm links scatter, and how many are
    anything at all, is likeliest here in both. None where no offsets judged it.
    """
    kind, told = type(found.effect), {one.name: one for one in found.parameters}
    if kind.strikes is None or not strikable(kind, view):
        return None
    name, size = kind.strikes[0], told[kind.strikes[1]].value
    seen = offsets(comparison, view, added, kind)
    bare = comparison.ensemble(view, added, OFFSET_MEMBERS // 2, OFFSET_FIRST)
    struck = struck_m(comparison, view, added, kind, size, seen, bare)

    def nats(share: float) -> float:
        ways = product(EXTRA_M, BEHIND_M, WILD_SHARES)
        tried = (Mixture(0.0, *one, share, size) for one in ways)
        return max(float(np.log(one.density(seen, struck)).sum()) for one in tried)

    shares = np.linspace(told[name].low, told[name].high, SHARES_TOLD)
    every = np.array([nats(float(share)) for share in shares])
    return float(np.logaddexp.reduce(every) - np.log(len(every))) - unstruck(seen).nats
