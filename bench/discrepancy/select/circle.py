"""A search that goes round in a circle: two effects that each take the other's place again."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bench.discrepancy.select.state import State

Place = tuple[frozenset[str], frozenset[str], tuple[str, ...], int]


@dataclass
class Circle:
    """The places that a search has been at, in their order."""

    past: list[Place] = field(default_factory=list)

    def closed_by(self, state: State) -> bool:
        """Return whether a search is where it was some rounds ago, with others between.

        The same effects in place, the same to choose from, the same links: what follows is what
        followed then. A round that changes nothing is no circle: it may draw anew.
        """
        here = _place(state)
        back = here in self.past and here != self.past[-1]
        self.past.append(here)
        return back


def _place(state: State) -> Place:
    """Return all that decides what the next round does, but for the draws of its test."""
    search = state.search
    links = len(np.unique(search.searched.links))
    added = frozenset(effect.name for effect in state.added)
    return added, frozenset(search.kinds), search.choice.names, links
