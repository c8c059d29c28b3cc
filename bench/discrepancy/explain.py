"""Which physics explains a located mismatch: every effect fitted, scored on held-out links."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from bench.discrepancy.ensemble import Ensemble
from bench.discrepancy.fit import FIT_MEMBERS, Fitted, Objective, refine, screen
from bench.discrepancy.gain import Tally, gain_interval, tally
from bench.discrepancy.nuisance import corrected
from bench.discrepancy.score import Estimate
from bench.discrepancy.world import Added, View, World
from bench.errors import BenchError
from bench.physics.effect import Effect
from bench.plugins import plugins

SCORE_MEMBERS = 12
SCORE_FIRST = 100  # replicates of scoring are not those of fitting
REFINED = 4  # best effects of the screening that are fitted fully
Tell = Callable[[str], None]


@dataclass(frozen=True)
class Contender:
    """A fitted effect on held-out links: its tally, and its gain over the current simulator."""

    effect: Effect
    tally: Tally
    gain: Estimate

    @property
    def name(self) -> str:
        """The effect's name."""
        return self.effect.name


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


def library() -> tuple[dict[str, type[Effect]], dict[str, str]]:
    """Return every effect that loads, by name, and why the others do not."""
    loaded: dict[str, type[Effect]] = {}
    skipped: dict[str, str] = {}
    for plugin in plugins("effects"):
        try:
            kind = plugin.load()
            if not (isinstance(kind, type) and issubclass(kind, Effect)):
                raise BenchError(f"effect {plugin.name!r} is no Effect")
            if getattr(kind, "fitted", True):
                loaded[plugin.name] = kind
        except BenchError as problem:
            skipped[plugin.name] = str(problem)
    return loaded, skipped


def explain(
    world: World,
    fit: View,
    held: View,
    added: Added,
    kinds: Mapping[str, type[Effect]],
    focus: tuple[str, ...],
    seed: int,
    tell: Tell = lambda _: None,
) -> Explanation:
    """Fit every effect of `kinds` on the fit rows and score it on the held-out rows.

    `focus` names the observables that were found to differ. A failing effect is reported in
    `skipped`; the rest goes on.
    """
    base = tally(world.ensemble(fit, added, FIT_MEMBERS))
    screened, skipped = _screened(world, fit, added, kinds, base, tell)
    best = sorted(screened, key=lambda name: -screened[name][1].gain)[:REFINED]
    before = world.ensemble(held, added, SCORE_MEMBERS, SCORE_FIRST)
    reference = tally(before)
    contenders = []
    for name in best:
        objective, start = screened[name]
        if start.gain <= 0:
            continue
        try:
            fitted = refine(objective, start)
            contenders.append(contender(world, held, added, fitted, reference, seed))
        except BenchError as problem:
            skipped[name] = str(problem)
    contenders.sort(key=lambda one: -one.gain.value)
    nuisance = tally(_nuisance(world, fit, held, added, before, focus))
    removable = gain_interval(reference, nuisance, seed)
    gains = {name: found.gain for name, (_, found) in screened.items()}
    return Explanation(tuple(contenders), reference, removable, nuisance, gains, skipped)


def _screened(
    world: World,
    fit: View,
    added: Added,
    kinds: Mapping[str, type[Effect]],
    base: Tally,
    tell: Tell,
) -> tuple[dict[str, tuple[Objective, Fitted]], dict[str, str]]:
    """Return the line search of every effect, and why others were skipped."""
    found: dict[str, tuple[Objective, Fitted]] = {}
    skipped: dict[str, str] = {}
    for name, kind in kinds.items():
        tell(f"trying {name}")
        objective = Objective(kind, world, fit, added, base)
        try:
            found[name] = (objective, screen(objective))
        except BenchError as problem:
            skipped[name] = str(problem)
    return found, skipped


def contender(
    world: World, held: View, added: Added, fitted: Fitted, reference: Tally, seed: int
) -> Contender:
    """Score a fitted effect on held-out rows."""
    made = world.ensemble(held, (*added, fitted.effect), SCORE_MEMBERS, SCORE_FIRST)
    scored = tally(made)
    return Contender(fitted.effect, scored, gain_interval(reference, scored, seed))


def _nuisance(
    world: World, fit: View, held: View, added: Added, before: Ensemble, focus: tuple[str, ...]
) -> Ensemble:
    """Return the held-out ensemble after the flexible regression."""
    learnt = world.ensemble(fit, added, SCORE_MEMBERS, SCORE_FIRST)
    return corrected(learnt, fit.covariates, before, held.covariates, focus)


def equivalents(explanation: Explanation, seed: int, share: float = 0.5) -> tuple[Contender, ...]:
    """Return the best contender and those that held-out links cannot tell from it."""
    if not explanation.contenders:
        return ()
    best, *others = explanation.contenders
    same = [best]
    for other in others:
        ahead = gain_interval(other.tally, best.tally, seed)
        close = other.gain.value >= share * best.gain.value
        if close and other.gain.above_zero and not ahead.above_zero:
            same.append(other)
    return tuple(same)
