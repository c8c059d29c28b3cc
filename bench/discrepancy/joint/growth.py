"""Sets of effects grow by one effect at a time: which larger ones are worth a fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from bench.discrepancy.compare.view import Added
from bench.discrepancy.joint.polish import Fit, key_of
from bench.discrepancy.joint.screen import Screen
from bench.discrepancy.joint.settings import GROWN, NAME_NATS

Fits = Mapping[frozenset[str], Fit]


def larger(sets: Sequence[Fit], known: Fits, screen: Screen) -> list[Added]:
    """Return the likeliest sets with one effect more of each, as far as the screen tells.

    Of each, because what leaves all links far off is not told from what leaves some: of two
    causes that both are loud either alone is about as likely as whatever widens the scatter.
    """
    out: dict[frozenset[str], Added] = {}
    for fit in sets:
        able = [one for one in screen.beside(fit.effects) if one.gained > -NAME_NATS / 2]
        for one in able[:GROWN] if all_used(fit, known) else ():
            out.setdefault(key_of((*fit.effects, one.effect)), (*fit.effects, one.effect))
    return [effects for key, effects in out.items() if key not in known]


def all_used(fit: Fit, known: Fits) -> bool:
    """Return whether no known set with a member less is surely likelier.

    What is added to that is added to the other set, too.
    """
    less = [known.get(key_of(fit.effects) - {name}) for name in fit.names]
    return all(fit.nats > one.nats - NAME_NATS for one in less if one)
