"""Effects in the company of the others: fitted together, dropped when useless, told from rivals.

Steps that only go forward are misled where two effects overlap: the first one found also takes
what belongs to the second. So after each step all are fitted again, and one that the others have
made needless is taken out; and whether another effect would do as well is asked at the end, with
all the others in place.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from bench.discrepancy.compare.skill import gain, gain_interval, gains, tally
from bench.discrepancy.compare.view import Added, Comparison, View, swapped, without
from bench.discrepancy.fit.per_device import with_values
from bench.discrepancy.fit.sandwich import off
from bench.discrepancy.fit.search import Fitted, Objective, refine, screen
from bench.discrepancy.select.candidates import (
    Contender,
    Explanation,
    contender,
)
from bench.discrepancy.settings import (
    BACKFIT_EVALUATIONS,
    BACKFIT_PASSES,
    BACKFIT_STALLED_NATS,
    EQUIVALENT_SHARE,
    FIT_MEMBERS,
    NOTHING_NATS,
    SCORE_FIRST,
    SCORE_MEMBERS,
    SIMPLER_SHARE,
    TIED_CONTENDERS,
    TOUCHED_NATS,
)
from bench.errors import BenchError
from bench.physics.effect import Effect


def chosen_first(explanation: Explanation, seed: int, margin: float) -> Explanation:
    """Return the explanation with the contender to add in front: best first, but simple before.

    An effect that draws every link anew can stand in for one that all links share (a detour in
    all links for a constant delay). So where such an effect gains most, a common one that does
    about as well on the observables it touches - half of the gain there at least, and not
    significantly behind - goes before it (a curve is not common in this sense). One that acts on
    the range alone needs only the half: it can imitate nothing else, and the other then has to
    show what it adds. And a curve comes only after the constant it contains, where that alone
    brings half of its gain.
    """
    every = explanation.contenders
    if not every:
        return explanation
    sure = [one for one in every if one.gain.likely_above_zero and one.gain.value > margin]
    first = every[0]
    if type(first.effect).per_link:
        kinds = ((one, type(one.effect)) for one in sure if one.gain.above_zero)
        common = [one for one, kind in kinds if not (kind.per_link or kind.contains)]
        common = [one for one in common if not type(one.effect).independent]
        alike = [one for one in common if _matches(explanation, one, first, seed)]
        first = alike[0] if alike else first
    inside = [one for one in sure if one.name in type(first.effect).contains]
    first = next(
        (one for one in inside if one.gain.value >= SIMPLER_SHARE * first.gain.value), first
    )
    return explanation.led_by(first)


def refitted(
    comparison: Comparison,
    views: tuple[View, View],
    added: Added,
    explanation: Explanation,
    kinds: Mapping[str, type[Effect]],
    seed: int,
) -> Explanation:
    """Return the explanation with the first contenders scored after all effects were fitted again.

    An effect added earlier may hold what belongs to a contender, and lets go of it only when both
    are fitted. Effects that draw every link anew are tried from their defaults too: what they do
    is easily held by the others. `views` are the fit and the held-out rows. All gains are counted
    from what the effects added so far reach when they are fitted again without anything new: what
    they gain by that is no merit of a contender.
    """
    likely = [one for one in explanation.contenders[:TIED_CONTENDERS] if one.gain.likely_above_zero]
    explanation = _from_refitted(comparison, views, added, explanation, seed)
    have = {effect.physics for effect in added}
    fresh = [kind() for kind in kinds.values() if kind.per_link and kind.name not in have]
    tries = [(one.effect, 1) for one in likely] + [(effect, 2) for effect in fresh]
    made = [*explanation.contenders]
    for effect, passes in tries:
        whole = polished(comparison, views[0], (*added, effect), passes, False)
        scored = tally(comparison.ensemble(views[1], whole, SCORE_MEMBERS, SCORE_FIRST))
        gained = gain_interval(explanation.base, scored, seed)
        made.append(Contender(whole[-1], scored, gained, whole))
    made.sort(key=lambda one: -one.gain.value)
    best = {one.name: one for one in reversed(made)}
    return replace(explanation, contenders=tuple(one for one in made if best[one.name] is one))


def _from_refitted(
    comparison: Comparison,
    views: tuple[View, View],
    added: Added,
    explanation: Explanation,
    seed: int,
) -> Explanation:
    """Return the explanation with gains over the effects added so far, fitted again if better."""
    alone = polished(comparison, views[0], added, 2, False)
    again = tally(comparison.ensemble(views[1], alone, SCORE_MEMBERS, SCORE_FIRST))
    if gain(explanation.base, again) <= 0:
        return explanation
    made = [
        replace(one, gain=gain_interval(again, one.tally, seed)) for one in explanation.contenders
    ]
    made.sort(key=lambda one: -one.gain.value)
    removable = gain_interval(again, explanation.nuisance, seed)
    return replace(explanation, contenders=tuple(made), base=again, removable=removable)


def beyond(explanation: Explanation, least: float) -> Explanation:
    """Return the explanation with only those contenders that gain more than `least` nats."""
    able = tuple(one for one in explanation.contenders if one.gain.value > least)
    return replace(explanation, contenders=able)


def _matches(explanation: Explanation, one: Contender, best: Contender, seed: int) -> bool:
    """Return whether `one` does about as well as `best` on the observables that it touches."""
    mine, its = (gains(explanation.base, each.tally) for each in (one, best))
    names = tuple(name for name, value in mine.items() if value > TOUCHED_NATS)
    reached = sum(mine[name] for name in names)
    if reached < SIMPLER_SHARE * sum(its.get(name, 0.0) for name in names):
        return False
    ahead = gain_interval(one.tally, best.tally, seed, names)
    return one.effect.stage == "ranging" or not ahead.above_zero


def polished(
    comparison: Comparison, fit: View, added: Added, passes: int = BACKFIT_PASSES, anew: bool = True
) -> Added:
    """Fit every added effect again, given the others, until nothing is gained.

    With `anew` the first pass searches the whole range of the parameters again, because what an
    effect stood in for may by now have a name of its own.
    """
    for number in range(passes):
        gained = 0.0
        for effect in added:
            if effect.fitted:
                better, more = _again(comparison, fit, added, effect, anew and number == 0)
                added = swapped(added, better)
                gained += more
        if gained < BACKFIT_STALLED_NATS:
            break
    return added


def _again(
    comparison: Comparison, fit: View, added: Added, effect: Effect, anew: bool, last: bool = False
) -> tuple[Effect, float]:
    """Return one effect fitted again, and what that gained on the fitted rows.

    In the `last` fit it does nothing more than it did: a warm-up that brought nothing stays out.
    What holds a curve of its own stays as it is: parameters would only move that about.
    """
    if any(getattr(effect, name) for name in type(effect).held):
        return effect, 0.0
    others = without(added, effect)
    base = tally(comparison.ensemble(fit, others, FIT_MEMBERS))
    objective = Objective(type(effect), comparison, fit, others, base)
    objective.held = {name: getattr(effect, name) for name in type(effect).instead}
    if last:
        objective.free = tuple(p for p in objective.free if not off(effect, p))
    try:
        before = objective({p.name: getattr(effect, p.name) for p in objective.free})
        if anew:
            screen(objective)
        if objective.best is None:  # in company it leaves an observable unknown in every row
            return effect, 0.0
        start = Fitted(objective.best[1], objective.best[0], 0)
        fitted = refine(objective, start, BACKFIT_EVALUATIONS)
    except BenchError:
        return effect, 0.0
    return fitted.effect, fitted.gain - (start.gain if before <= NOTHING_NATS else before)


def settled(comparison: Comparison, rows: View, added: Added) -> Added:
    """Return every added effect fitted once more on all working rows, parameters where they were.

    The choice of effects rests on held-out links; once made, more rows only sharpen it.
    """
    for effect in added:
        added = swapped(added, once_more(comparison, rows, added, effect))
    return added


def once_more(comparison: Comparison, rows: View, added: Added, effect: Effect) -> Effect:
    """Return one effect fitted once more beside all others that are added."""
    if effect.fitted:
        return _again(comparison, rows, added, effect, False, True)[0]
    return _relearnt(comparison, rows, added, effect)


def _relearnt(comparison: Comparison, rows: View, added: Added, effect: Effect) -> Effect:
    """Return an effect with values per device or level learnt from these rows, if it scores.

    A mark stays in the form that was chosen by what others can do beside it.
    """
    if type(effect).marked:
        return effect
    rest = without(added, effect)
    again = with_values(comparison, rows, rest, type(effect))
    if again is None:
        return effect
    now, then = (tally(comparison.ensemble(rows, (*rest, e), FIT_MEMBERS)) for e in (effect, again))
    return again if gain(now, then) > 0 else effect


def pruned(
    comparison: Comparison, held: View, added: Added, seed: int, margin: float, newcomer: str = ""
) -> Added:
    """Return the effects without those that held-out links do not miss.

    An effect stays if leaving it out costs more than `margin` nats, one-sided 95 % bound above
    zero. The least missed goes first. The `newcomer`, named where more links than these have
    shown its gain, stays if leaving it out costs anything.
    """
    while len(added) > 1:
        whole = tally(comparison.ensemble(held, added, SCORE_MEMBERS, SCORE_FIRST))
        missed = []
        for effect in added:
            rest = tally(
                comparison.ensemble(held, without(added, effect), SCORE_MEMBERS, SCORE_FIRST)
            )
            missed.append(gain_interval(rest, whole, seed))
        doubted = [i for i, e in enumerate(added) if e.name != newcomer or missed[i].value <= 0]
        least = min(doubted, key=lambda i: missed[i].value)
        if missed[least].likely_above_zero and missed[least].value > margin:
            break
        added = without(added, added[least])
    return added


def rivals(
    comparison: Comparison,
    views: tuple[View, View],
    added: Added,
    effect: Effect,
    others: tuple[Contender, ...],
    kinds: Mapping[str, type[Effect]],
    seed: int,
    share: float = EQUIVALENT_SHARE,
) -> tuple[Contender, ...]:
    """Return those of `others` that would do as well as `effect` with the rest of `added` in place.

    `views` are the fit and the held-out rows. A rival is fitted anew beside the rest; it stays one
    if it gains at least `share` of what `effect` gains there and held-out links do not put it
    behind.
    """
    fit, held = views
    rest = without(added, effect)
    reference = tally(comparison.ensemble(held, rest, SCORE_MEMBERS, SCORE_FIRST))
    best = contender(comparison, held, rest, Fitted(effect, 0.0, 0), reference, seed)
    have = {known.physics for known in added}
    out = []
    for other in others:
        if other.name in have:
            continue
        found = beside_others(comparison, fit, rest, other, kinds)
        if found is None:
            continue
        made = contender(comparison, held, rest, found, reference, seed)
        ahead = gain_interval(made.tally, best.tally, seed)
        close = made.gain.value >= share * best.gain.value and made.gain.likely_above_zero
        if close and not ahead.above_zero:
            out.append(made)
    return tuple(out)


def beside_others(
    comparison: Comparison,
    fit: View,
    rest: Added,
    other: Contender,
    kinds: Mapping[str, type[Effect]],
) -> Fitted | None:
    """Return a rival fitted beside the rest, None where that fails."""
    if not other.effect.fitted:
        found = with_values(comparison, fit, rest, type(other.effect))
        return Fitted(found, 0.0, 0) if found else None
    kind = kinds.get(other.effect.name, type(other.effect))
    base = tally(comparison.ensemble(fit, rest, FIT_MEMBERS))
    try:
        objective = Objective(kind, comparison, fit, rest, base)
        return refine(objective, screen(objective))
    except BenchError:
        return None
