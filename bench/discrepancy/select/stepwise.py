"""The loop: locate, explain, add the effect, until nothing significant is left."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from bench.checkpoint.journal import Journal
from bench.discrepancy.compare.resimulation import Added, View, World, without
from bench.discrepancy.compare.skill import gain, tally
from bench.discrepancy.locate.permutation_test import Located, locate
from bench.discrepancy.select.backfitting import (
    beyond,
    chosen_first,
    polished,
    pruned,
    refitted,
    settled,
)
from bench.discrepancy.select.candidates import (
    SCORE_FIRST,
    SCORE_MEMBERS,
    Contender,
    Explanation,
    Tell,
    explain,
)
from bench.discrepancy.select.conclude import (
    MARGIN,
    SEARCH_FIRST,
    SEARCH_MEMBERS,
    SHARE,
    SURE,
    verdicts,
)
from bench.discrepancy.select.link_mixture import Strike, strikable, strike, witnessed
from bench.discrepancy.select.verdict import Verdict
from bench.physics.effect import Effect

ROUNDS = 9
WAVE_MARGIN = 0.03  # the same where a whole waveform is compared: some twenty scores, not one
SHARE_MORE = 0.02  # of the gain reached so far, that another effect must gain on waveforms
SHARE_LEFT = 0.25  # of what could still be removed, that another effect must gain there
SCATTER_MARGIN = 0.05  # of independent scatter: less is what misfitted effects leave


@dataclass(frozen=True)
class Round:
    """One turn of the loop: what was located, who competed, what was added.

    `strike` is set where that strikes links at random (see `strikes`): what follows is judged on
    the links it did not strike.
    """

    located: Located
    explanation: Explanation | None
    added: Effect | None
    strike: Strike | None = None


@dataclass(frozen=True)
class Diagnosis:
    """Verdicts with the effects to add (`added`), and how the search went."""

    verdicts: tuple[Verdict, ...]
    added: Added
    rounds: tuple[Round, ...]
    skipped: Mapping[str, str] = field(default_factory=dict)

    @property
    def names(self) -> tuple[tuple[str, ...], ...]:
        """Names of every verdict that names something."""
        return tuple(verdict.names for verdict in self.verdicts if verdict.names)


@dataclass(frozen=True)
class Search:
    """What every step shares: the simulated world, the two working views, the library, the seed.

    `work` are the rows of both views, on which the chosen effects are fitted at the end; None
    where that would cost too much. `journal` keeps the results of steps that take long.
    """

    world: World
    discover: View
    fit: View
    kinds: Mapping[str, type[Effect]]
    seed: int
    tell: Tell = lambda _: None
    work: View | None = None
    journal: Journal = field(default_factory=Journal)

    @property
    def sharpest(self) -> View:
        """The rows that the final parameters are fitted on."""
        return self.fit if self.work is None else self.work

    @property
    def searched(self) -> View:
        """The rows that are searched: both views where scores are those of both (see `explain`)."""
        return self.discover if self.work is None else self.work

    def locate(self, added: Added, turn: int) -> Located:
        """Search for what is left."""
        first = SEARCH_FIRST + turn * SEARCH_MEMBERS
        seen = self.searched
        ensemble = self.world.ensemble(seen, added, SEARCH_MEMBERS, first)
        ensemble = ensemble.first(self.world.distinct(seen))
        return locate(ensemble, seen.covariates, self.seed + turn)

    def explain(self, added: Added, located: Located) -> Explanation:
        """Fit the library on the fit links, score it on the discover links."""
        focus = tuple(dict.fromkeys(f.cell.observable for f in located.findings))
        have = {effect.physics for effect in added}
        world = self.world
        kinds = {
            n: k for n, k in self.kinds.items() if n not in have and not strikable(k, self.fit)
        }
        return explain(world, self.fit, self.discover, added, kinds, focus, self.seed, self.tell)

    def strike(self, added: Added, best: Contender | None) -> Strike | None:
        """Return what strikes links at random, if that explains them better than `best` does."""
        if self.work is None:
            return None
        rival = (best.company or _with(added, best.effect)) if best else added
        return strike(self.world, self.work, added, rival, self.kinds)

    def witnessed(self, added: Added, explanation: Explanation | None) -> Contender | None:
        """Return the contender that the offsets of links speak for where scores do for none.

        Only a first effect: of what fitted effects leave, something always speaks for another.
        """
        if self.work is None or explanation is None or added:
            return None
        effects = tuple(one.effect for one in explanation.contenders if one.gain.value > MARGIN)
        found = witnessed(self.world, self.work, added, effects)
        return next((c for c in explanation.contenders if c.effect is found), None)

    def calm(self, found: Strike) -> Search:
        """Return a search on the links that were not struck, by other effects."""
        calm = replace(
            self,
            discover=self.discover.leaving(found.struck),
            fit=self.fit.leaving(found.struck),
            work=self.work and self.work.leaving(found.struck),
        )
        return calm.without(found.effect)

    def without(self, effect: Effect) -> Search:
        """Return a search that leaves this effect out of the library."""
        return replace(self, kinds={n: k for n, k in self.kinds.items() if n != effect.name})

    def order(self, added: Added, explanation: Explanation) -> Explanation:
        """Return the explanation with the contender to add in front.

        Recordings of the range alone have one observable, on which nothing more can be told.
        """
        if not self.fit.waveform:
            return explanation
        if added:
            views = (self.fit, self.discover)
            explanation = refitted(self.world, views, added, explanation, self.kinds, self.seed)
            explanation = beyond(explanation, SHARE_LEFT * explanation.removable.value)
        explanation = beyond(explanation, self.margin(added))
        return chosen_first(explanation, self.seed, MARGIN)

    def margin(self, added: Added) -> float:
        """Return the nats that one effect among `added`, or on top of them, must be worth.

        With waveforms, where much is compared, a share of what is reached already: an effect whose
        curve is a little wrong leaves that much, and something else always fits it.
        """
        if not self.fit.waveform:
            return MARGIN
        before, after = (
            tally(self.world.ensemble(self.discover, effects, SCORE_MEMBERS, SCORE_FIRST))
            for effects in ((), added)
        )
        return max(WAVE_MARGIN, SHARE_MORE * gain(before, after))


def diagnose(search: Search) -> Diagnosis:
    """Run the loop on the working links and return the verdicts."""
    rounds: list[Round] = []
    added: Added = ()
    skipped: dict[str, str] = {}
    step = search.journal.step
    for turn in search.journal.rounds(ROUNDS):
        search.tell(f"searching (round {turn + 1})")
        located = step(search.locate, added, turn)
        refuted = contradicted(added, located)
        if refuted:
            search, added = search.without(refuted), without(added, refuted)
            located = step(search.locate, added, turn)
        explanation = step(search.explain, added, located) if located.significant else None
        explanation = step(search.order, added, explanation) if explanation else None
        best = _best(explanation) or step(search.witnessed, added, explanation)
        skipped |= dict(explanation.skipped) if explanation else {}
        found = step(search.strike, added, best) if explanation else None
        if found and explanation:
            rounds.append(_struck_round(located, explanation, found))
            search = search.calm(found)
            added = step(polished, search.world, search.fit, added)  # by what was not struck
            continue
        if best is None or explanation is None:
            rounds.append(Round(located, explanation, None))
            break
        rounds.append(Round(located, explanation.led_by(best), best.effect))
        before, added = added, best.company or _with(added, best.effect)
        if len(added) > 1 or search.fit.waveform:
            added = step(polished, search.world, search.fit, added, anew=len(added) > 1)
            margin = step(search.margin, added)
            sure = search.work is not None and located.p <= SURE  # and scored on both views
            crossed = best.effect.name if sure else ""
            views = search.world, search.discover
            added = step(pruned, *views, added, search.seed, margin, crossed)
        if {e.name for e in added} <= {e.name for e in before}:
            if best.effect.name not in search.kinds:
                break
            search = search.without(best.effect)  # what was added was taken out again
    if search.work is not None and added:
        added = step(settled, search.world, search.work, added)
    struck = tuple(turn.strike.effect for turn in rounds if turn.strike)
    said = step(verdicts, search, rounds, added)
    kept = tuple(e for e in (*struck, *added) if any(e.physics in v.names for v in said))
    return Diagnosis(said, kept, tuple(rounds), skipped)


def _struck_round(located: Located, explanation: Explanation, found: Strike) -> Round:
    """Return a round in which an effect that strikes links at random was found."""
    first = Contender(found.effect, explanation.base, found.evidence)
    return Round(located, explanation.led_by(first), found.effect, found)


def contradicted(added: Added, located: Located) -> Effect | None:
    """Return an added effect whose signature what is left contradicts, None where none is.

    Scatter that is independent from row to row leaves no offsets that links keep; where such
    offsets are found after all, it only stood in for something else.
    """
    left = any(f.cell.moment == "link" and f.cell.observable == "error_m" for f in located.findings)
    return next((e for e in added if type(e).independent), None) if left else None


def _best(explanation: Explanation | None) -> Contender | None:
    """Return the contender to add: a gain beyond the margin, its one-sided bound above zero.

    Independent scatter stands for what cannot be predicted, so it is no answer where a regression
    removes much more than it.
    """
    if explanation is None:
        return None
    structure = max(SHARE * explanation.removable.value, SCATTER_MARGIN)
    able = (c for c in explanation.contenders if not _only_scatter(c) or c.gain.value > structure)
    best = next(able, None)
    if best is None or not best.gain.likely_above_zero or best.gain.value <= MARGIN:
        return None
    return best


def _only_scatter(contender: Contender) -> bool:
    """Return whether a contender is scatter, independent from row to row."""
    return type(contender.effect).independent


def _with(added: Added, effect: Effect) -> Added:
    """Return the effects with `effect` added, or in place of the one of its name."""
    physics = effect.physics
    return (*(known for known in added if known.physics != physics), effect)
