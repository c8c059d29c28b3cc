"""Where the library's answer is unknown: what a law or a fault of the set-up says of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.law.found import FoundLaw, LawConstant, SetupFault
from bench.discrepancy.law.judge import judged, setup_fault
from bench.discrepancy.law.material import Material, material
from bench.discrepancy.law.search import Proposal, propose
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.state import Search, Selection
from bench.discrepancy.select.verdict import LeftOut, Unknown
from bench.discrepancy.settings import LAW_MEMBERS
from bench.errors import BenchError


@dataclass(frozen=True)
class Said:
    """What is said beside the verdicts: a law, a fault of the set-up, or neither."""

    law: FoundLaw | None = None
    fault: SetupFault | None = None


def proposed(search: Search, found: Selection) -> Proposal | None:
    """Return the law that working links speak for, where no known effect explains them."""
    if not any(isinstance(verdict, Unknown) for verdict in found.verdicts):
        return None
    search.progress("looking for a law without a name")
    views = (search.fit, search.discover) if search.work is None else (search.work,)
    step = Guard().safely("law", _proposed, None)
    return step(search.comparison, views, found.added, search.seed)


def _proposed(
    comparison: Comparison, views: tuple[View, ...], added: Added, seed: int
) -> Proposal | None:
    given = gathered(comparison, views, added)
    return None if given is None else propose(given, seed)


def borne_out(
    comparison: Comparison, sealed: View, added: Added, proposal: Proposal | None, seed: int
) -> Said:
    """Return the law, where sealed links bear it out: they may refuse it, and choose no other."""
    if proposal is None:
        return Said()
    return Guard().safely("law", _borne_out, Said())(comparison, sealed, added, proposal, seed)


def _borne_out(
    comparison: Comparison, sealed: View, added: Added, proposal: Proposal, seed: int
) -> Said:
    given = gathered(comparison, (sealed,), added)
    law = None if given is None else judged(proposal, given, seed)
    if law is None:
        return Said()
    try:  # what cannot be simulated again is no law of these columns
        law.effect  # noqa: B018
    except BenchError:
        return Said()
    return Said(law, setup_fault(proposal))


def named_fault(found: Selection) -> SetupFault | None:
    """Return the fault of the set-up that a named effect of the library is, None without one."""
    for verdict in found.verdicts:
        kind = type(verdict.effect).setup_fault if isinstance(verdict, LeftOut) else ""
        if kind and isinstance(verdict, LeftOut):
            sizes = [
                LawConstant(p.name, p.value, p.low, p.high, p.unit) for p in verdict.parameters
            ]
            said = ", ".join(f"{size.name} = {size}" for size in sizes)
            return SetupFault(kind, (), f"{kind} ({said})", tuple(sizes))
    return None


def gathered(
    comparison: Comparison, views: tuple[View, ...], added: Added, like: Material | None = None
) -> Material | None:
    """Return recorded - simulated ranges of all rows of views, None where ranges are not known.

    `like`: see `material`.
    """
    ensembles = [comparison.ensemble(view, added, LAW_MEMBERS) for view in views]
    if any(RANGE not in ensemble.names for ensemble in ensembles):
        return None
    frame = pd.concat([view.frame for view in views], ignore_index=True)
    residual = np.concatenate([ensemble.residual_of(RANGE) for ensemble in ensembles])
    return material(frame, residual, np.concatenate([view.links for view in views]), like)
