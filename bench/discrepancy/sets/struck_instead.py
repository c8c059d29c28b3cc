"""Links struck at random in the place of names, or beside them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.view import Added, View
from bench.discrepancy.select.link_mixture import Strike, strike
from bench.discrepancy.select.state import Round, Search
from bench.discrepancy.select.stepwise import struck_round, untouched
from bench.discrepancy.sets.choose import chosen
from bench.discrepancy.sets.install import together
from bench.discrepancy.sets.settings import NAMED_STRUCK, NAMED_STRUCK_P
from bench.discrepancy.settings import LEAD_NATS
from bench.physics.effect import Effect


def struck_instead(search: Search, beside: Added, added: Added, turn: Round) -> Round | None:
    """Return a round in which links were struck at random, where that says more than the names.

    By 3 nats: names say which links are off, and what strikes at random may be any of them. Not
    where it strikes just those on which the names act: then it is these, of no two links alike.
    `turn` is the first round of the names.
    """
    if search.work is None or turn.explanation is None:
        return None
    rows, comparison = search.work, search.comparison
    found = strike(comparison, rows, beside, added, search.kinds, LEAD_NATS)
    found = found or _beside_what_it_spares(search, rows, beside, added)
    if found is None or any(strikes_the_named(search, rows, one, found.struck) for one in added):
        return None
    return struck_round(turn.located, turn.explanation, found)


def _beside_what_it_spares(
    search: Search, rows: View, beside: Added, added: Added
) -> Strike | None:
    """Return what strikes links beside the names of the others, where that says more than names.

    Links off by metres make names of what they share, and what is small is found on the others.
    """
    first = strike(search.comparison, rows, beside, beside, search.kinds)
    if first is None:
        return None
    spared = search.spared(first)
    spared = replace(spared, choice=chosen(spared, beside))
    if not spared.choice.names:
        return None
    names = together(spared, beside)
    return strike(search.comparison, rows, names, added, search.kinds, LEAD_NATS)


def strikes_the_named(search: Search, rows: View, effect: Effect, struck: NDArray[np.intp]) -> bool:
    """Return whether nearly all links on which an effect acts are `struck`, unlike by chance.

    Of so many struck ones among all (hypergeometric). A wall delays every link behind it.
    """
    from scipy.stats import hypergeom

    acting = np.unique(rows.links[~untouched(search.comparison, rows, (effect,))])
    every, both = np.unique(rows.links), np.intersect1d(acting, struck)
    if len(both) < NAMED_STRUCK * len(acting):
        return False
    chance = hypergeom.sf(len(both) - 1, len(every), len(acting), len(struck))
    return bool(chance <= NAMED_STRUCK_P)
