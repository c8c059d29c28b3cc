"""The names of a chosen set as effects: each fitted beside the others, with a round of its own."""

from __future__ import annotations

from dataclasses import replace
from operator import itemgetter

import numpy as np

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.skill import Tally, gain, gain_interval, tally
from bench.discrepancy.compare.view import Added, without
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.fit.per_device import fits_itself, latent_effects, with_values
from bench.discrepancy.fit.search import Fitted, Objective, plainer, refine, screen, valued
from bench.discrepancy.fit.walls import of_every_kind
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select.candidates import Contender, Explanation, regressed
from bench.discrepancy.select.state import Round, Search
from bench.discrepancy.sets.blocks import named_kinds
from bench.discrepancy.sets.levels_in_turn import in_turn
from bench.discrepancy.sets.settings import RIVAL_NATS
from bench.discrepancy.sets.shifted import Shifted, beside_constants
from bench.discrepancy.settings import (
    CURVE_FREEDOM_NATS,
    FIT_MEMBERS,
    LONGEST_DELAY_NS,
    SCORE_FIRST,
    SCORE_MEMBERS,
)
from bench.errors import BenchError
from bench.forked import both, in_forks
from bench.physics.effect import Effect
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.units import C_M_PER_NS


def installed(search: Search, beside: Added, located: Located) -> tuple[Added, tuple[Round, ...]]:
    """Return the effects with those of the choice, and a round for each of these."""
    added = together(search, beside)
    return added, rounds_of(search, beside, added, located)


def together(search: Search, beside: Added) -> Added:
    """Return the effects with those of the choice: each fitted to what the others leave.

    What they do is known from the set, where all were fitted at once: one fitted after the other
    would take of what they have in common.
    """
    choice = search.choice

    def alone(name: str) -> Effect | None:
        others = [shift for one, shift in choice.shifts_m.items() if one != name]
        shift = np.sum([np.zeros(len(choice.shifts_m[name])), *others], axis=0)
        shifted = replace(search, comparison=Shifted(search.comparison, shift))
        return best_form(shifted, beside, name)

    made = in_forks(alone, choice.names)
    return in_turn(search, (*beside, *(effect for effect in made if effect)))


def best_form(search: Search, added: Added, name: str) -> Effect | None:
    """Return the form of some physics that fits all working rows best, beside other effects.

    A curve has to gain something for its freedom. What a library form can do without costs as much
    as its fit, and is asked where no curve is better.
    """
    rows, comparison = search.sharpest, search.comparison
    base = tally(comparison.ensemble(rows, added, FIT_MEMBERS))

    def worth(form: Effect) -> float:
        return gain(base, tally(comparison.ensemble(rows, (*added, form), FIT_MEMBERS)))

    curves = latent_effects(comparison, rows, added, name)
    forms = [(worth(curve) - CURVE_FREEDOM_NATS, curve) for curve in curves]
    most = max((gained for gained, _ in forms), default=-np.inf)
    library = _of_library(search, added, name, base, most)
    forms = [*((worth(form), form) for form in library), *forms]
    return max(forms, key=itemgetter(0), default=(0.0, None))[1]


def _of_library(
    search: Search, added: Added, name: str, base: Tally, most: float = -np.inf
) -> list[Effect]:
    """Return the form of the library, without what it can do without if it gains over `most`."""
    kind = named_kinds(search.kinds, search.sharpest).get(name)
    if kind is None:
        return []
    try:
        if fits_itself(kind):
            found = with_values(search.comparison, search.sharpest, added, kind)
            return [found] if found else []
        objective = Objective(kind, search.comparison, search.sharpest, added, base)
        if not kind.fitted:
            return []
        fitted = refine(objective, _begun(search, objective, name))
        if fitted.gain > most:
            fitted = plainer(objective, fitted, RIVAL_NATS / len(search.sharpest.rows))
        return [fitted.effect, *_by_kind(search, added, fitted.effect)]
    except BenchError:
        return []


def _begun(search: Search, objective: Objective, name: str) -> Fitted:
    """Return where the fit of a library form begins: also with about what the set has it do."""
    begun, shift_m = screen(objective, on_ranges=True), search.choice.shifts_m.get(name)
    if shift_m is None or len(shift_m) != len(objective.view.rows):
        return begun
    like = objective.kind.like(objective.view.scene, shift_m)
    gained = objective(like) if like else begun.gain
    return Fitted(valued(objective.kind, like), gained, 1) if gained > begun.gain else begun


def _by_kind(search: Search, added: Added, plain: Effect) -> list[Effect]:
    """Return what obstacles do to waveforms with delays of every kind's own, none of others."""
    if not (isinstance(plain, MaterialDelay) and search.sharpest.waveform):
        return []
    found = of_every_kind(search.comparison, search.sharpest, added, plain)
    return [found] if found else []


def _regressed(search: Search, beside: Added, located: Located) -> Tally:
    """Return what is left once a regression removed what known columns tell of what was found."""
    focus = tuple(dict.fromkeys(f.cell.observable for f in located.findings))
    return tally(regressed(search.comparison, search.fit, search.discover, beside, focus))


def rounds_of(search: Search, beside: Added, added: Added, located: Located) -> tuple[Round, ...]:
    """Return one round for every effect of the choice, with those that could stand in its place.

    What a regression would remove is learnt meanwhile.
    """
    mine = [e for e in added if e.physics in search.choice.names and e not in beside]
    contests, nuisance = both(
        lambda: [_contest(search, added, effect) for effect in mine],
        lambda: _regressed(search, beside, located),
    )
    reference = tally(_scores(search, beside))
    removable = gain_interval(reference, nuisance, search.seed)
    found = [Explanation(made, reference, removable, nuisance, {}, {}) for made in contests]
    return tuple(Round(located, one, e) for one, e in zip(found, mine, strict=True))


def _contest(search: Search, added: Added, effect: Effect) -> tuple[Contender, ...]:
    """Return an effect of a set and what could stand in its place, scored beside the others."""
    rest = without(added, effect)
    base = tally(_beside(search, rest))
    others = (_rival(search, rest, one, base) for one in search.choice.rivals[effect.physics])
    return _contender(search, rest, effect, base), *(one for one in others if one)


def _rival(search: Search, rest: Added, name: str, base: Tally) -> Contender | None:
    """Return a name that could stand in the place of another, beside the constant that it needs."""
    if name not in search.choice.constants_m:
        plain = best_form(search, rest, name)
        return _contender(search, rest, plain, base) if plain else None
    constant_ns = 2 * search.choice.constants_m[name] / C_M_PER_NS  # of both delays together
    beside = (
        *rest,
        AntennaDelay(delay_ns=float(np.clip(constant_ns, -LONGEST_DELAY_NS, LONGEST_DELAY_NS))),
    )
    effect = best_form(search, beside, name)
    if effect is None:
        return None
    return replace(_contender(search, beside, effect, base), company=(*beside, effect))


def _contender(search: Search, rest: Added, effect: Effect, base: Tally) -> Contender:
    scored = tally(_beside(search, (*rest, effect)))
    whole = gain_interval(base, scored, search.seed)
    if whole.high < 0 and not _loses_alone(search, effect):
        whole = gain_interval(base, scored, search.seed, (RANGE,))
    return Contender(effect, scored, whole)


def _loses_alone(search: Search, effect: Effect) -> bool:
    """Return whether held-out links are surely worse with a name of a set beside no other of it.

    If not, what loses beside the others is a level of which several took what is there once: of
    that ranges, which speak for a set, know nothing.
    """
    before, after = (tally(_beside(search, some)) for some in ((), (effect,)))
    return gain_interval(before, after, search.seed).high < 0


def _scores(search: Search, added: Added) -> Ensemble:
    return search.comparison.ensemble(search.discover, added, SCORE_MEMBERS, SCORE_FIRST)


def _beside(search: Search, added: Added) -> Ensemble:
    """Return held-out rows beside simulated ones, with constants as the choice says."""
    made = beside_constants(search, search.discover)
    return made.ensemble(search.discover, added, SCORE_MEMBERS, SCORE_FIRST)
