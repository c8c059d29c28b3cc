"""What else a name of a set may do to the ranges: beside others, and beside causes left out.

How much a cause does is known less where the others of a set are not known either. And a cause that
brings too little evidence for a name of its own need not be absent: beside it a name would do
something else. So what a name does is a mixture over sets, each as likely as its evidence says
(Bayesian model averaging: Hoeting et al. 1999).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from bench.discrepancy.sets.believed import Believed, Unsure
from bench.discrepancy.sets.choice import Set
from bench.discrepancy.sets.settings import LEAST_SHARE, RIVAL_NATS

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest


def unsure(contest: Contest, causes: Set, name: str) -> Unsure:
    """Return what a name of the chosen set may do, in it and beside one cause more."""
    grown = _grown(contest, causes)
    shares = np.exp([0.0, *grown.values()])
    every = zip((causes, *grown), (shares / shares.sum()).tolist(), strict=True)
    sets = tuple(_believed(contest, one, name, share) for one, share in every)
    spread = np.stack([contest.spread(one) for one in contest.bare(name).T], axis=1)
    return Unsure(spread, sets, _alone(contest, causes, name))


def _alone(contest: Contest, causes: Set, name: str) -> Believed:
    """Return what rows say of a name if all else were known.

    What a receiver makes of waveform effects is known then, too, so nothing is flattened.
    """
    made = contest.evidence.of(causes)
    sizes = made.sizes[np.isin(made.places, contest.evidence.places[name])]
    seen = contest.weights[:, None] * contest.bare(name)
    plain = contest.evidence.with_blocks({name: (seen,)})
    return plain.broadly(replace(made, places=plain.places[name], sizes=sizes), name)


def _grown(contest: Contest, causes: Set) -> dict[Set, float]:
    """Return the sets of one cause more, with the logarithm of their odds beside the chosen one.

    A name costs so much because there are many, and because it must be sure: here only the first
    counts. What was refused on other grounds than its evidence is at most as likely as not.
    """
    able = [one for one in contest.able if one not in causes]
    sets = {one: (*causes, one) for one in able}
    contest.weigh(sets.values())
    odds = {o: contest.brings(some, o) - contest.price(o) + RIVAL_NATS for o, some in sets.items()}
    likely = [o for o in able if odds[o] > np.log(LEAST_SHARE) and _possible(contest, sets[o])]
    return {sets[o]: min(odds[o], 0.0) for o in likely}


def _possible(contest: Contest, causes: Set) -> bool:
    """Return whether physics allows what every name of a set does."""
    return all(contest.possible(causes, one) for one in causes if one in contest.kinds)


def _believed(contest: Contest, causes: Set, name: str, share: float) -> Believed:
    return contest.evidence.broadly(contest.evidence.of(causes), name, share)
