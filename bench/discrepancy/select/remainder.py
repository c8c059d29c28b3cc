"""What the new simulator gets beyond what can be said: a statement and a simulator differ.

An effect whose name is refused may still bring simulated rows nearer to recorded ones: it is kept
where held-out links fit better with it.
"""

from __future__ import annotations

from collections.abc import Collection

from bench.discrepancy.compare.view import Added
from bench.discrepancy.confirm import improves
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.marks import idle
from bench.discrepancy.select.refute import Checked
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.verdict import Verdict


def fitting_best(
    search: Search,
    held: Checked,
    struck: Added,
    said: tuple[Verdict, ...],
    likely: Collection[str] = (),
) -> Added:
    """Return the effects of the new simulator: what is named, or all that was checked.

    All of it with waveforms, where held-out links fit better, beyond doubt, than with the names.
    `likely`: see `idle`.
    """
    useless = idle(held, likely)
    if not search.fit.waveform:  # ranges bear no marks: only logs may speak alone
        useless &= {effect.name for effect in search.logged}
    names = {name for verdict in said for name in verdict.names}
    named = tuple(e for e in (*struck, *held.added) if e.name not in useless and e.physics in names)
    every = tuple(e for e in held.simulated if e.name not in useless)
    if not (search.fit.waveform and _richer(every, named)):
        return named
    better = Guard().safely("what has no name", improves, False)
    whole = better(search.comparison, search.discover, named, every, search.seed)
    return every if whole else named


def _richer(every: Added, named: Added) -> bool:
    """Return whether there is an effect that is not named."""
    return bool({e.name for e in every} - {e.name for e in named})


def beyond_names(added: Added, said: tuple[Verdict, ...]) -> Added:
    """Return the effects of a simulator that no verdict names."""
    names = {name for verdict in said for name in verdict.names}
    return tuple(effect for effect in added if effect.physics not in names)
