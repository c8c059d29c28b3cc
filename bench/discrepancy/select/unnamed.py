"""A curve for what has no name."""

from __future__ import annotations

from bench.discrepancy.compare.view import Added
from bench.discrepancy.confirm import improves
from bench.discrepancy.fit.residual_curve import unnamed_effect
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.state import Search, Selection
from bench.discrepancy.select.verdict import Unknown


def unnamed(search: Search, found: Selection) -> Added:
    """Return a curve for a mismatch without a name, if it predicts links it was not fitted on."""
    rest = tuple(v for v in found.verdicts if isinstance(v, Unknown))
    if not rest or rest[0].cause:  # no curve of what a recorder did
        return ()
    curve = Guard().safely("unnamed curve", unnamed_effect, None)
    extra = curve(search.comparison, search.fit, found.added, rest[0].findings)
    if extra is None:
        return ()
    both = (*found.added, extra)
    helps = improves(search.comparison, search.discover, found.added, both, search.seed)
    return (extra,) if helps else ()
