"""Where the library says unknown, or leaves much: what a law or a fault of the set-up says."""

from __future__ import annotations

from dataclasses import dataclass, replace

from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.observables import LEVEL, RANGE
from bench.discrepancy.joint.verdicts import LEFT_OF_WAVES
from bench.discrepancy.law.between import told_from_detectors, told_from_forms
from bench.discrepancy.law.found import FoundLaw, SetupFault
from bench.discrepancy.law.gather import gathered, proposed
from bench.discrepancy.law.instead import (
    calms,
    does_the_same,
    effect_of,
    leads,
    narrowed,
    shifting,
    undone,
    without_names,
)
from bench.discrepancy.law.judge import gains_among, judged, setup_fault, tied_names
from bench.discrepancy.law.likeness import form_words
from bench.discrepancy.law.named_faults import named_fault
from bench.discrepancy.law.of_scatter import independent, predicts
from bench.discrepancy.law.own_forms import forms_of_names
from bench.discrepancy.law.own_levels import at_right_distances
from bench.discrepancy.law.search import Proposal
from bench.discrepancy.law.settings import LAW_INSTEAD_NATS, LAW_NATS
from bench.discrepancy.law.structures import cost
from bench.discrepancy.select.elsewhere import without_others
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.refute import working
from bench.discrepancy.select.state import Search, Selection
from bench.discrepancy.select.verdict import Unknown
from bench.errors import BenchError


@dataclass(frozen=True)
class Weighed:
    """What the library says (`found`), and a law that working links speak for.

    `instead`: the selection without the library's names, where the law does better than all of
    them together; None where the law is of what they leave. `form`: see `FoundLaw.of_library`.
    """

    found: Selection
    proposal: Proposal | None = None
    instead: Selection | None = None
    form: str = ""

    @property
    def added(self) -> Added:
        """The effects that the law comes on top of."""
        return (self.instead or self.found).added


@dataclass(frozen=True)
class Said:
    """The selection that holds, with a law, a fault of the set-up, or neither."""

    found: Selection
    law: FoundLaw | None = None
    fault: SetupFault | None = None


def weighed(search: Search, found: Selection) -> Weighed:
    """Return what the library says beside the law of what it does not explain.

    A law is looked for where the verdict is unknown, and beside names whose values could bend to
    anything (a clock that wanders follows a warm-up). Where it fails, what the library says stands.
    Where marks say what spoilt the recordings, no law is of the radio.
    """
    if any(isinstance(verdict, Unknown) and verdict.cause for verdict in found.verdicts):
        return Weighed(found)
    unknown = any(isinstance(verdict, Unknown) for verdict in found.verdicts)
    if not unknown and not shifting(found) and not independent(found.added):
        return Weighed(found)
    search.progress("looking for a law without a name")
    made = Guard().safely("law", _weighed, Weighed(found))(search, found, unknown)
    law = made.proposal
    if law is None:
        return made
    if setup_fault(law):
        made = _with_right_levels(search, made, law)
    words = Guard().safely("form of a law", form_words, "")
    differ = _waveforms_differ(found)
    return replace(made, form=words(search, made.instead or found, law, differ))


def _with_right_levels(search: Search, made: Weighed, fault: Proposal) -> Weighed:
    """Return what is said without names of levels that gain only where distances are wrong."""
    held = Guard().safely("levels", at_right_distances, made.instead or made.found)(
        search, made.instead or made.found, fault
    )
    return replace(made, instead=held) if made.instead else replace(made, found=held)


def _weighed(search: Search, found: Selection, unknown: bool) -> Weighed:
    """Return the law of what the names leave, or one that does better than all of them."""
    views = working(search)
    if predicted := _in_place_of_scatter(search, found, views):
        return predicted
    rest = gathered(search.comparison, views, found.added)
    after = proposed(search, rest)
    if after is not None and not _beyond_names(search, found, after):
        after = None
    if after is not None and _waveforms_differ(found) and not _beyond_detectors(after):
        after = None
    if after is not None and not _beyond_forms(search, found, views, after):
        after = None
    beside = Weighed(found, after if unknown else None)
    if unknown and rest and (held := undone(search, found, views, rest, after)):
        return Weighed(found, held[1], held[0])
    named = shifting(found)
    if rest is None or not named:
        return beside
    kept = tuple(effect for effect in found.added if effect not in named)
    whole = gathered(search.comparison, views, kept)
    alone = proposed(search, whole)
    if alone is None:
        return beside
    struck = [effect for effect in named if type(effect).strikes]
    better = calms(search, kept, alone) if struck else leads(alone, rest, after, named)
    if not better or (not struck and does_the_same(search, named, alone)):
        return beside
    narrower = None if struck else narrowed(search, found, alone, views)
    if narrower is not None:
        return _weighed(search, narrower, unknown)
    return Weighed(found, alone, without_names(found, kept))


def _in_place_of_scatter(
    search: Search, found: Selection, views: tuple[View, ...]
) -> Weighed | None:
    """Return a law in the place of independent scatter, None where none predicts most of it."""
    kept = tuple(one for one in found.added if one not in independent(found.added))
    if len(kept) == len(found.added):
        return None
    alone = proposed(search, gathered(search.comparison, views, kept))
    if alone is None or alone.best.nats < LAW_INSTEAD_NATS:
        return None
    if not predicts(search.comparison, search.both, kept, effect_of(alone)):
        return None
    return Weighed(found, alone, without_names(found, kept))


def _beyond_names(search: Search, found: Selection, law: Proposal) -> bool:
    """Return whether a law holds, too, where effects that were found do nothing.

    What they leave by their form is no law of its own. Asked of ranges, where such rows are enough.
    """
    if search.work is None:
        return True
    for view in without_others(search.work, found.added):
        rows = gathered(search.comparison, (view,), found.added, law.given)
        if rows is not None and not gains_among(law, rows, search.seed):
            return False
    return True


def _waveforms_differ(found: Selection) -> bool:
    """Return whether anything without a name shows in more than ranges: it may shift these too."""
    unknown = [verdict for verdict in found.verdicts if isinstance(verdict, Unknown)]
    seen = {finding.cell.observable for verdict in unknown for finding in verdict.findings}
    return bool(seen - {RANGE, LEVEL}) or any(LEFT_OF_WAVES in one.note for one in unknown)


def _beyond_detectors(law: Proposal) -> bool:
    """Return whether a law is worth its price beside what a detector may make of a waveform."""
    return _worth(law, told_from_detectors(law.given, law.best.structure, law.best.fitted))


def _beyond_forms(search: Search, found: Selection, views: tuple[View, ...], law: Proposal) -> bool:
    """Return whether a law is worth its price beside other forms of what is named."""
    forms = forms_of_names(search, found, views)
    if not forms.any():
        return True
    best = law.best
    return _worth(law, told_from_forms(law.given, best.structure, best.fitted, forms))


def _worth(law: Proposal, nats: float) -> bool:
    """Return whether a log-likelihood that a law gains pays for it."""
    rows = law.share * len(law.given.residual_m)
    return law.share * nats - cost(law.best.structure, rows) > LAW_NATS


def borne_out(comparison: Comparison, sealed: View, weighing: Weighed, seed: int) -> Said:
    """Return the law, where sealed links bear it out: they may refuse it, and choose no other."""
    without = Said(weighing.found, None, named_fault(weighing.found))
    if weighing.proposal is None:
        return without
    step = Guard().safely("law", _borne_out, without)
    return step(comparison, sealed, weighing, without, seed)


def _borne_out(
    comparison: Comparison, sealed: View, weighing: Weighed, without: Said, seed: int
) -> Said:
    assert weighing.proposal is not None
    given = gathered(comparison, (sealed,), weighing.added, weighing.proposal.given)
    law = None if given is None else judged(weighing.proposal, given, seed)
    if law is None or not _runs(law):
        return without
    held = weighing.instead or weighing.found
    rivals = (*tied_names(law, held.tied), *law.rivals)
    law = replace(law, of_library=weighing.form, rivals=rivals)
    return Said(held, law, setup_fault(weighing.proposal) or named_fault(held))


def _runs(law: FoundLaw) -> bool:
    """Return whether a law can be written down: what cannot be simulated is not said."""
    try:
        return bool(law.effect.expression)
    except BenchError:
        return False
