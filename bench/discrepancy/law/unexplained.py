"""Where the library says unknown, or leaves much: what a law or a fault of the set-up says."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from bench.discrepancy.compare.residual_range import residual_range
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.observables import LEVEL, RANGE
from bench.discrepancy.joint.verdicts import LEFT_OF_WAVES
from bench.discrepancy.law.between import told_from_detectors, told_from_forms
from bench.discrepancy.law.found import FoundLaw, SetupFault
from bench.discrepancy.law.judge import gains_among, judged, setup_fault, tied_names
from bench.discrepancy.law.likelihood import unmoved
from bench.discrepancy.law.likeness import form_words
from bench.discrepancy.law.material import BEHIND, NO_SIGHT, Material, material
from bench.discrepancy.law.named_faults import named_fault
from bench.discrepancy.law.of_scatter import independent, predicts
from bench.discrepancy.law.own_forms import forms_of_names
from bench.discrepancy.law.rounding import rounds_alike
from bench.discrepancy.law.search import Proposal, propose
from bench.discrepancy.law.settings import (
    LAW_INSTEAD_NATS,
    LAW_MEMBERS,
    LAW_NATS,
    LAW_TIED_NATS,
    LAW_VALUE_NATS,
)
from bench.discrepancy.law.structures import cost
from bench.discrepancy.select.elsewhere import without_others
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.link_mixture import left_far, strike
from bench.discrepancy.select.refute import swapped_for, working
from bench.discrepancy.select.state import Search, Selection
from bench.discrepancy.select.verdict import Ambiguous, LeftOut, Unknown
from bench.discrepancy.sets.settings import EXPLAINED_STRAYS
from bench.errors import BenchError
from bench.physics.effects.ranging.law import Law, with_constants
from bench.physics.materials import is_listed

OBSTACLES, SIGHT, CONSTANT = "obstacles", "los", "constant"


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
    if not unknown and not _shifting(found) and not independent(found.added):
        return Weighed(found)
    search.progress("looking for a law without a name")
    made = Guard().safely("law", _weighed, Weighed(found))(search, found, unknown)
    if made.proposal is None:
        return made
    words = Guard().safely("form of a law", form_words, "")
    differ = _waveforms_differ(found)
    return replace(made, form=words(search, made.instead or found, made.proposal, differ))


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
    named = _shifting(found)
    if rest is None or not named:
        return beside
    kept = tuple(effect for effect in found.added if effect not in named)
    whole = gathered(search.comparison, views, kept)
    alone = proposed(search, whole)
    if alone is None:
        return beside
    struck = [effect for effect in named if type(effect).strikes]
    better = _calms(search, kept, alone) if struck else _leads(alone, rest, after, named)
    if not better:
        return beside
    narrower = None if struck else _narrowed(search, found, alone, views)
    if narrower is not None:
        return _weighed(search, narrower, unknown)
    return Weighed(found, alone, _without_names(found, kept))


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
    if not predicts(search.comparison, search.both, kept, _effect(alone)):
        return None
    return Weighed(found, alone, _without_names(found, kept))


def proposed(search: Search, rows: Material | None) -> Proposal | None:
    """Return the law that rows speak for, None where the library has effects for all such laws.

    What holds only behind something in the way is a delay or a detour by it, whatever its form. A
    constant behind what the library does not list is said: a rack is more than its metal.
    """
    law = None if rows is None else propose(rows, search.seed)
    if law is None or not law.best.structure.where.startswith((BEHIND, NO_SIGHT)):
        return law
    of_kind = law.best.structure.where.removeprefix(BEHIND)
    if law.best.structure.form == CONSTANT and of_kind != law.best.structure.where:
        return None if is_listed(of_kind) else law
    column = SIGHT if law.best.structure.where.startswith(NO_SIGHT) else OBSTACLES
    ways = [way for kind in search.kinds.values() for way in kind.needs]
    return None if any(column in way for way in ways) else law


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


def _narrowed(
    search: Search, found: Selection, alone: Proposal, views: tuple[View, ...]
) -> Selection | None:
    """Return the selection with a class cut down to members that the law does not beat.

    None where the law beats every other member of every class too: a constant law is an antenna
    delay, though the class was led by an effect that only comes near one.
    """
    for verdict in (one for one in found.verdicts if isinstance(one, Ambiguous)):
        first, *others = verdict.options
        if first.effect.name not in {effect.name for effect in _shifting(found)}:
            continue
        held = [o for o in others if _stands(search, found, alone, views, first, o)]
        if held:
            left = held[0] if len(held) == 1 else replace(verdict, options=tuple(held))
            said = tuple(left if one is verdict else one for one in found.verdicts)
            added = swapped_for(found.added, first.effect, held[0].effect)
            return replace(found, verdicts=said, added=added)
    return None


def _stands(
    search: Search,
    found: Selection,
    alone: Proposal,
    views: tuple[View, ...],
    first: LeftOut,
    option: LeftOut,
) -> bool:
    """Return whether the law does not beat the names with `option` in the place of `first`."""
    swapped = replace(found, added=swapped_for(found.added, first.effect, option.effect))
    rest = gathered(search.comparison, views, swapped.added)
    return rest is not None and not _leads(alone, rest, None, _shifting(swapped))


def _shifting(found: Selection) -> Added:
    """Return the named effects that shift ranges: those of the range, and what strikes links.

    What else was named has other evidence, and what was named `together` was weighed against laws.
    Scatter shifts nothing: a law leaves it to the scale. Nor does a grid that ranges lie on.
    """
    return tuple(
        effect
        for effect in found.added
        if (effect.stage == "ranging" or type(effect).strikes) and not type(effect).independent
        if not type(effect).marked
        if effect.physics not in found.together
    )


def _calms(search: Search, kept: Added, alone: Proposal) -> bool:
    """Return whether no link is struck any more where a law is in place, as it says which were.

    Nobody can predict what is struck at random: where a law over known covariates does, it is none.
    One that hits a few of them, and others beside, only leaves so much that nothing is made of it.
    """
    if search.work is None or alone.best.nats < LAW_INSTEAD_NATS:
        return False
    added = (*kept, _effect(alone))
    comparison, rows, kinds = search.comparison, search.work, search.kinds
    if strike(comparison, rows, added, added, kinds) is not None:
        return False
    before = strike(comparison, rows, kept, kept, kinds)
    if before is None:
        return True
    return left_far(comparison, rows, kept, added, before.struck) <= EXPLAINED_STRAYS


def _effect(proposal: Proposal) -> Law:
    """Return a proposed law as an effect of the simulator."""
    return with_constants(proposal.best.structure.expression, proposal.best.fitted.constants)


def _leads(alone: Proposal, rest: Material, after: Proposal | None, named: Added) -> bool:
    """Return whether a law alone beats the named effects, and them with a law of what they leave.

    The law pays for its form among all and for its constants; a library effect only what its
    values gain from noise, so that one that is the truth is not beaten. One law goes before names
    and a law that do about as well.
    """
    before = unmoved(alone.given.residual_m).likelihood
    library = alone.share * (unmoved(rest.residual_m).likelihood - before)
    library -= LAW_VALUE_NATS * sum(effect.freed for effect in named)
    lead = alone.best.nats - library
    both = lead - (max(after.best.nats, 0.0) if after else 0.0)
    return lead >= LAW_INSTEAD_NATS and both >= -LAW_TIED_NATS


def _without_names(found: Selection, kept: Added) -> Selection:
    """Return the selection with all names taken back but those of `kept` effects."""
    first = next(turn for turn in found.rounds if turn.explanation)
    assert first.explanation is not None
    physics = {effect.physics for effect in kept}
    stay = tuple(v for v in found.verdicts if physics & set(v.names))
    gone = [v.names for v in found.verdicts if v.names and v not in stay]
    if not gone:  # only effects go that no verdict names
        return replace(found, added=kept)
    names = " and ".join(" or ".join(group) for group in gone)
    tried = {c.name: c.gain.value for c in first.explanation.contenders}
    note = f"a law does better than {names}"
    unknown = Unknown(first.located.findings, first.explanation.removable, tried, note)
    return replace(found, verdicts=(*stay, unknown), added=kept)


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


def gathered(
    comparison: Comparison, views: tuple[View, ...], added: Added, like: Material | None = None
) -> Material | None:
    """Return recorded - simulated ranges of all rows of views, None where ranges are not known.

    `like`: see `material`.
    """
    made = [one for view in views if (one := residual_range(comparison, view, added, LAW_MEMBERS))]
    if len(made) < len(views):
        return None
    frame = pd.concat([view.frame for view in views], ignore_index=True)
    residual = np.concatenate([left for _, left in made])
    rows = material(frame, residual, np.concatenate([view.links for view in views]), like)
    bears = any(type(one).marked for one in added)
    return replace(rows, rounded=bears or rounds_alike(comparison, rows))
