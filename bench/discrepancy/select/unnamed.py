"""A curve for what has no name."""

from __future__ import annotations

from dataclasses import replace

from bench.discrepancy.compare.view import Added
from bench.discrepancy.confirm import improves
from bench.discrepancy.fit.residual_curve import unnamed_effects
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.left_by_names import of_form, pulled
from bench.discrepancy.select.settings import HARDLY_BENT, SMALLEST_BEND_M
from bench.discrepancy.select.state import Search, Selection
from bench.discrepancy.select.verdict import Unknown
from bench.discrepancy.sets.choice import MERE
from bench.physics.effects.fitted.unnamed import Unnamed


def unnamed(search: Search, found: Selection) -> Added:
    """Return a curve for a mismatch without a name, if it predicts links it was not fitted on.

    The richest that does: a constant, where a curve of few links does not. Also for the mean of a
    name that goes up and down (see `with_mean`).
    """
    rest = tuple(v for v in found.verdicts if isinstance(v, Unknown))
    if rest and rest[0].cause:  # no curve of what a recorder did
        return ()
    findings = rest[0].findings if rest else found.mean
    curves = Guard().safely("unnamed curve", unnamed_effects, ())
    for extra in curves(search.comparison, search.fit, found.added, findings) if findings else ():
        both = (*found.added, extra)
        if improves(search.comparison, search.discover, found.added, both, search.seed):
            return (extra,)
    return ()


def with_mean(search: Search, found: Selection) -> Selection:
    """Return the selection with what names leave where that is theirs (see `left_by_names`).

    The mean of one, a constant of a set beside names that hold, or another form of them: the
    simulator must not lose it.
    """
    choice, last = search.choice, found.rounds[-1]
    sure = not any(isinstance(verdict, Unknown) for verdict in found.verdicts)
    said = {name for names in found.names for name in names} & set(choice.names)
    if not (sure and said and search.work and last.located.findings):
        return found
    constant = MERE in choice.others and pulled(search, search.work)
    theirs = constant or of_form(search, found.added, last)
    return replace(found, mean=last.located.findings) if theirs else found


def curve_words(added: Added) -> str:
    """Return in words the curve without a name among some effects, "" without one."""
    curves = [one for one in added if isinstance(one, Unnamed)]
    if not curves:
        return ""
    curve = curves[-1]
    low, high = min(curve.shifts_m), max(curve.shifts_m)
    even = max(SMALLEST_BEND_M, HARDLY_BENT * abs(low + high) / 2)
    flat = f"a constant {(low + high) / 2:.3g} m" if high - low < even else ""
    bent = f"a smooth curve of {low:.3g} to {high:.3g} m over {curve.column}"
    spread = f", scatter {curve.spread_m:.2g} m" if curve.spread_m >= SMALLEST_BEND_M else ""
    return f"{flat or bent}{spread}; no physics is claimed"
