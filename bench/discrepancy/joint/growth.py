"""Where sets of effects begin, and how they grow by one at a time: which are worth a fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from bench.discrepancy.compare.view import Added
from bench.discrepancy.joint.polish import Fit, key_of, likeliest
from bench.discrepancy.joint.screen import Screen
from bench.discrepancy.joint.settings import GROWN, NAME_NATS
from bench.discrepancy.joint.statistics import Statistics

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


def begun(given: Statistics, tries: Sequence[Added]) -> tuple[Statistics, Fit | None]:
    """Return the likeliest of some sets, and the statistics that are known beside it.

    A coarse rounding leaves nothing of weak samples, so no level of them: where no set leaves all
    statistics known, those that every one leaves known.
    """
    found = likeliest(given, tries)
    if found is None:
        for effects in tries:
            given = given.knowing(effects)
        found = likeliest(given, tries)
    return given, found
