"""Where a law is of one device, another device may have one of its own."""

from __future__ import annotations

from dataclasses import replace

from bench.discrepancy.compare.view import Comparison, View
from bench.discrepancy.law.found import FoundLaw
from bench.discrepancy.law.gather import gathered, proposed
from bench.discrepancy.law.judge import judged
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.refute import working
from bench.discrepancy.select.state import Search, Selection

OF_DEVICES = ("tx is ", "rx is ")


def with_second(
    search: Search, comparison: Comparison, sealed: View, found: Selection, law: FoundLaw
) -> FoundLaw:
    """Return a law with that of another device beside it, where sealed links bear that out, too.

    `found` is the selection that the law comes on top of. As it is where it is of no one device.
    """
    if not law.where.startswith(OF_DEVICES):
        return law
    step = Guard().safely("second law", _second, None)
    return replace(law, beside=step(search, comparison, sealed, found, law))


def _second(
    search: Search, comparison: Comparison, sealed: View, found: Selection, law: FoundLaw
) -> FoundLaw | None:
    """Return the law of another device beside one that is in place, None where there is none."""
    added = (*found.added, law.effect)
    proposal = proposed(search, gathered(search.comparison, working(search), added))
    if proposal is None:
        return None
    where = proposal.best.structure.where
    if not where.startswith(OF_DEVICES) or where == law.where:
        return None
    given = gathered(comparison, (sealed,), added, proposal.given)
    return None if given is None else judged(proposal, given, search.seed)
