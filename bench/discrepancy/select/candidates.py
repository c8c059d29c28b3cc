"""Which physics explains a located mismatch: every effect fitted, scored on held-out links."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

import pandas as pd

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.skill import Tally, alike, gain_interval, tally
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.columns import known_columns
from bench.discrepancy.fit.per_device import fits_itself, latent_effects, with_values
from bench.discrepancy.fit.reference_regression import corrected
from bench.discrepancy.fit.search import (
    Fitted,
    Objective,
    members_for,
    pursue,
    refine,
    screen,
)
from bench.discrepancy.select.side_by_side import by_name, searched
from bench.discrepancy.settings import (
    CURVE_FREEDOM_NATS,
    EQUIVALENT_SHARE,
    FAR_BEHIND,
    FIT_MEMBERS,
    NEARLY_SHARE,
    REFINED,
    SAME_LINKS,
    SCORE_FIRST,
    SCORE_MEMBERS,
    WORTH_FITTING_NATS,
    WORTH_PURSUING,
)
from bench.errors import BenchError
from bench.physics.effect import Effect
from bench.plugins import plugins
from bench.recordings.motion import SPEED, why_unknown

Progress = Callable[[str], None]
T = TypeVar("T")


@dataclass(frozen=True)
class Contender:
    """A fitted effect on held-out links: its tally, and its gain over the current simulator.

    `company`: all effects, itself the last, where they were fitted again together with it.
    """

    effect: Effect
    tally: Tally
    gain: Estimate
    company: Added = ()

    @property
    def name(self) -> str:
        """The name of the physics: that of the library's effect."""
        return self.effect.physics


@dataclass(frozen=True)
class Explanation:
    """All contenders, best first, with what a flexible regression removes (`removable`).

    `base` is the current simulator's tally; `skipped` maps effects that failed to the reason.
    """

    contenders: tuple[Contender, ...]
    base: Tally
    removable: Estimate
    nuisance: Tally
    screened: Mapping[str, float]
    skipped: Mapping[str, str]

    def led_by(self, first: Contender) -> Explanation:
        """Return the explanation with a contender in front: the one that is added."""
        rest = (one for one in self.contenders if one.name != first.name)
        return replace(self, contenders=(first, *rest))


def library() -> tuple[dict[str, type[Effect]], dict[str, str]]:
    """Return every effect that loads, by name, and why the others do not."""
    loaded: dict[str, type[Effect]] = {}
    skipped: dict[str, str] = {}
    for plugin in plugins("effects"):
        try:
            kind = plugin.load()
            if not (isinstance(kind, type) and issubclass(kind, Effect)):
                raise BenchError(f"effect {plugin.name!r} is no Effect")
            if kind.fitted or fits_itself(kind):
                loaded[plugin.name] = kind
        except BenchError as problem:
            skipped[plugin.name] = str(problem)
    return loaded, skipped


def offered(
    kinds: Mapping[str, type[Effect]], frame: pd.DataFrame, waveform: bool, again: bool = True
) -> tuple[dict[str, type[Effect]], dict[str, str]]:
    """Return the effects that a table says anything about, and what the others need.

    CIRs count as a column only where they are compared. `again`: the simulator can be run again;
    the rows of another simulator's table cannot have every effect put into them.
    """
    columns = known_columns(frame) - (set() if waveform else {"cir"})
    rerun = "a simulator that can be run again"
    lacking = {
        name: kind.lacking(columns).replace(SPEED, why_unknown(frame))
        or ("" if again or kind.on_tables else rerun)
        or kind.unmarked(frame)
        for name, kind in kinds.items()
    }
    able = {name: kind for name, kind in kinds.items() if not lacking[name]}
    return able, {n: f"could not be tried: needs {words}" for n, words in lacking.items() if words}


def explain(
    comparison: Comparison,
    fit: View,
    held: View,
    added: Added,
    kinds: Mapping[str, type[Effect]],
    focus: tuple[str, ...],
    seed: int,
    progress: Progress = lambda _: None,
) -> Explanation:
    """Fit every effect of `kinds` on the fit rows and score it on the held-out rows.

    `focus` names the observables that were found to differ. A failing effect is reported in
    `skipped`; the rest goes on. Where paths alone are simulated, which is cheap, the two sets of
    links also change places, and scores are those of both (cross-fitting: every link is scored
    by parameters that it had no part in); the parameters stay those of the fit rows.
    """
    there = _one_way(comparison, fit, held, added, kinds, focus, seed, progress)
    if fit.waveform or not there.contenders:
        return there
    wanted = {c.effect.name for c in there.contenders}
    some = {name: kind for name, kind in kinds.items() if name in wanted}
    return crossed(there, _one_way(comparison, held, fit, added, some, focus, seed, progress), seed)


def crossed(there: Explanation, back: Explanation, seed: int) -> Explanation:
    """Return the contenders of `there` with scores on the links of both explanations.

    One that did not get so far on the way back counts there as no gain.
    """
    base, nuisance = there.base.beside(back.base), there.nuisance.beside(back.nuisance)
    again = {c.name: c.tally for c in back.contenders}  # maybe in another of its forms
    tallies = [c.tally.beside(again.get(c.name, back.base)) for c in there.contenders]
    contenders = [
        Contender(c.effect, made, gain_interval(base, made, seed))
        for c, made in zip(there.contenders, tallies, strict=True)
    ]
    contenders.sort(key=lambda one: -one.gain.value)
    removable = gain_interval(base, nuisance, seed)
    return replace(
        there, contenders=tuple(contenders), base=base, nuisance=nuisance, removable=removable
    )


def _one_way(
    comparison: Comparison,
    fit: View,
    held: View,
    added: Added,
    kinds: Mapping[str, type[Effect]],
    focus: tuple[str, ...],
    seed: int,
    progress: Progress,
) -> Explanation:
    """Fit on some rows and score on others."""
    base = tally(comparison.ensemble(fit, added, FIT_MEMBERS))
    screened, skipped = _screened(comparison, fit, added, kinds, base, progress)
    before = comparison.ensemble(held, added, SCORE_MEMBERS, SCORE_FIRST)
    reference = tally(before)
    have = {effect.physics for effect in added}
    own = latent_effects(comparison, fit, added)
    own_fits, failed = by_name(
        lambda _, name: with_values(comparison, fit, added, kinds[name]),
        None,
        [name for name, kind in kinds.items() if fits_itself(kind)],
        far=False,
    )
    skipped |= failed
    found = [e for e in (*own, *own_fits.values()) if e is not None and e.physics not in have]
    terms = [Fitted(effect, 0.0, 0) for effect in found]
    contenders = [contender(comparison, held, added, one, reference, seed) for one in terms]

    fits, failed = searched(refine, {n: screened[n] for n in _promising(screened, contenders)})
    skipped |= failed
    if fit.waveform:
        near = {name: (screened[name][0], fits[name]) for name in _near(fits)}
        more, failed = searched(pursue, near)
        fits, skipped = fits | more, skipped | failed
    judged = _Judged(comparison, held, added, fits, reference, seed)
    made, failed = by_name(_scored, judged, list(fits), fit.waveform)
    skipped |= failed
    contenders = _best_of_each([*contenders, *made.values()])
    contenders.sort(key=lambda one: -one.gain.value)
    nuisance = tally(regressed(comparison, fit, held, added, focus))
    removable = gain_interval(reference, nuisance, seed)
    gains = {name: found.gain for name, (_, found) in screened.items()}
    return Explanation(tuple(contenders), reference, removable, nuisance, gains, skipped)


def _near(fits: Mapping[str, Fitted]) -> list[str]:
    """Return the names of the fits that may come out best when searched further."""
    top = max((one.gain for one in fits.values()), default=0.0)
    return [name for name, one in fits.items() if one.gain > WORTH_PURSUING * top]


def _promising(
    screened: Mapping[str, tuple[Objective, Fitted]], known: list[Contender]
) -> list[str]:
    """Return the effects worth a full fit: the best few, none far behind the best."""
    gains = {name: found.gain for name, (_, found) in screened.items()}
    top = max([*gains.values(), *(one.gain.value for one in known), 0.0])
    names = sorted(gains, key=lambda name: -gains[name])[:REFINED]
    return [name for name in names if gains[name] > max(FAR_BEHIND * top, WORTH_FITTING_NATS)]


def _best_of_each(contenders: list[Contender]) -> list[Contender]:
    """Return for every physics the form of it that scored best.

    A curve that contains the library's form has to gain `CURVE_FREEDOM_NATS` beside it.
    """

    def worth(one: Contender) -> float:
        return one.gain.value - CURVE_FREEDOM_NATS * (one.name in type(one.effect).contains)

    best: dict[str, Contender] = {}
    for one in contenders:
        if one.name not in best or worth(one) > worth(best[one.name]):
            best[one.name] = one
    return list(best.values())


def _screened(
    comparison: Comparison,
    fit: View,
    added: Added,
    kinds: Mapping[str, type[Effect]],
    base: Tally,
    progress: Progress,
) -> tuple[dict[str, tuple[Objective, Fitted]], dict[str, str]]:
    """Return the line search of every effect, and why others were skipped."""
    searched_for = {name: kind for name, kind in kinds.items() if kind.fitted}
    able = [name for name, kind in searched_for.items() if fit.waveform or kind.without_cir]

    progress(f"trying {len(able)} effects")
    objectives = {name: Objective(kinds[name], comparison, fit, added, base) for name in able}
    found, failed = searched(_screen, {name: (one, None) for name, one in objectives.items()})
    return {name: (objectives[name], one) for name, one in found.items()}, failed


def _screen(objective: Objective, _: Fitted | None) -> Fitted:
    return screen(objective)


@dataclass(frozen=True)
class _Judged:
    """What scoring a fit needs beside its name."""

    comparison: Comparison
    held: View
    added: Added
    fits: Mapping[str, Fitted]
    reference: Tally
    seed: int


def _scored(judged: _Judged, name: str) -> Contender:
    """Return a fit with its score on held-out rows."""
    one = judged
    fitted = one.fits[name]
    return contender(one.comparison, one.held, one.added, fitted, one.reference, one.seed)


def contender(
    comparison: Comparison, held: View, added: Added, fitted: Fitted, reference: Tally, seed: int
) -> Contender:
    """Score a fitted effect on held-out rows."""
    members = members_for(type(fitted.effect), held, SCORE_MEMBERS)
    made = comparison.ensemble(held, (*added, fitted.effect), members, SCORE_FIRST)
    scored = tally(made)
    return Contender(fitted.effect, scored, gain_interval(reference, scored, seed))


def regressed(
    comparison: Comparison, fit: View, held: View, added: Added, focus: tuple[str, ...]
) -> Ensemble:
    """Return the held-out ensemble after the flexible regression of the observables of `focus`."""
    before = comparison.ensemble(held, added, SCORE_MEMBERS, SCORE_FIRST)
    learnt = comparison.ensemble(fit, added, SCORE_MEMBERS, SCORE_FIRST)
    return corrected(learnt, fit.covariates, before, held.covariates, focus)


def equivalents(
    explanation: Explanation, seed: int, share: float = EQUIVALENT_SHARE
) -> tuple[Contender, ...]:
    """Return the best contender and those that held-out links cannot tell from it.

    Where the best is not sure itself, others need only be as good. Two that both gain for sure,
    and as much, but on different links are two causes, not two names of one.
    """
    if not explanation.contenders:
        return ()
    best, *others = explanation.contenders
    same = [best]
    for other in others:
        ahead = gain_interval(other.tally, best.tally, seed)
        close = other.gain.value >= share * best.gain.value
        likely = other.gain.likely_above_zero or not best.gain.above_zero
        if type(best.effect).marked and type(other.effect).independent:
            continue  # scatter leaves no such mark
        if close and likely and not ahead.above_zero and _same_links(explanation, best, other):
            same.append(other)
    return tuple(same)


def nearly_as_good(explanation: Explanation, same: tuple[Contender, ...]) -> tuple[Contender, ...]:
    """Return contenders that gain nearly as much as the best on the same links.

    A form that is a little wrong costs that much, also where scores put it behind beyond doubt, and
    makes its gain less sure.
    """
    best, known = explanation.contenders[0], {one.name for one in same}
    able = (c for c in explanation.contenders if c.name not in known)
    near = (c for c in able if c.gain.value >= NEARLY_SHARE * best.gain.value)
    return tuple(c for c in near if _same_links(explanation, best, c))


def _same_links(explanation: Explanation, best: Contender, other: Contender) -> bool:
    """Return whether two contenders gain on the same links, as far as both gain for sure."""
    if not (best.gain.above_zero and other.gain.above_zero):
        return True
    return alike(explanation.base, best.tally, other.tally) >= SAME_LINKS
