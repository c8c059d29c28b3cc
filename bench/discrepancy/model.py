"""The loop: locate, explain, add the effect, until nothing significant is left."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from bench.discrepancy.cells import Cell
from bench.discrepancy.context import (
    beyond,
    chosen_first,
    polished,
    pruned,
    refitted,
    rivals,
    settled,
)
from bench.discrepancy.explain import (
    SCORE_FIRST,
    SCORE_MEMBERS,
    Contender,
    Explanation,
    Tell,
    equivalents,
    explain,
)
from bench.discrepancy.gain import gain, gain_interval, tally
from bench.discrepancy.journal import Journal
from bench.discrepancy.locate import Finding, Located, locate
from bench.discrepancy.score import Estimate, cluster_bootstrap
from bench.discrepancy.strikes import Strike, apart, strikable, strike, witnessed
from bench.discrepancy.uncertainty import parameter_intervals
from bench.discrepancy.verdict import Ambiguous, Control, LeftOut, NoMismatch, Unknown, Verdict
from bench.discrepancy.world import Added, View, World, without
from bench.physics.base import Base
from bench.physics.effect import Effect

SEARCH_MEMBERS = 16
SEARCH_FIRST = 1000  # replicates of the search are fresh in every round
ROUNDS = 9
MARGIN = 0.01  # nats of gain that an effect must reach at least: about 1 % of one score
WAVE_MARGIN = 0.03  # the same where a whole waveform is compared: some twenty scores, not one
SHARE_MORE = 0.02  # of the gain reached so far, that another effect must gain on waveforms
SHARE_LEFT = 0.25  # of what could still be removed, that another effect must gain there
SCATTER_MARGIN = 0.05  # of independent scatter: less is what misfitted effects leave
APART = 5.0  # nats of evidence for offsets per link: p = 0.0008 by chi-squared
SURE = 0.005  # family-wise p value below which a mismatch needs no second witness
SHARE = 0.6  # of what a flexible regression removes, that named effects must remove


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
        views = (self.discover, self.fit, self.work)
        kept = [view.leaving(found.struck) if view else None for view in views]
        assert kept[0] is not None
        assert kept[1] is not None
        calm = replace(self, discover=kept[0], fit=kept[1], work=kept[2])
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
        rounds.append(Round(located, _led(explanation, best), best.effect))
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
    verdicts = step(_verdicts, search, rounds, added)
    kept = tuple(e for e in (*struck, *added) if any(e.physics in v.names for v in verdicts))
    return Diagnosis(verdicts, kept, tuple(rounds), skipped)


def _led(explanation: Explanation, best: Contender) -> Explanation:
    """Return the explanation with the contender that is added in front."""
    rest = tuple(one for one in explanation.contenders if one.name != best.name)
    return replace(explanation, contenders=(best, *rest))


def _struck_round(located: Located, explanation: Explanation, found: Strike) -> Round:
    """Return a round in which an effect that strikes links at random was found."""
    first = Contender(found.effect, explanation.base, found.evidence)
    shown = replace(explanation, contenders=(first, *explanation.contenders))
    return Round(located, shown, found.effect, found)


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


def _verdicts(search: Search, rounds: list[Round], added: Added) -> tuple[Verdict, ...]:
    """Return what can be said: names that hold, and what is left."""
    last = rounds[-1]
    struck = tuple(_struck_out(search, turn, turn.strike) for turn in rounds if turn.strike)
    if not added and not _real(search, last):
        return struck or (NoMismatch(last.located.detectable, last.located.p),)
    share = _share(search, _since_struck(rounds), added)
    unexplained = last.located.significant and last.added is None
    removable = last.explanation.removable if last.explanation else Estimate(0, 0, 0)
    # Once effects are fitted, their parameters are only known so well: what that leaves is small.
    least = MARGIN if added else 0.0
    worth = unexplained and removable.above_zero and removable.value > least
    worth = worth or (not added and _real(search, last))
    if worth and share < SHARE:
        return (*struck, _unknown(last, "the best known effects remove too little of it"))
    named = (*struck, *_named(search, rounds, added, share))
    return (*named, _unknown(last, "left after the named effects")) if worth else named


def _since_struck(rounds: list[Round]) -> Explanation:
    """Return the first explanation on the links that are judged at the end."""
    start = max((i + 1 for i, turn in enumerate(rounds) if turn.strike), default=0)
    return next(turn.explanation for turn in (*rounds[start:], *rounds) if turn.explanation)


def _struck_out(search: Search, turn: Round, found: Strike) -> LeftOut:
    """Return the verdict on an effect that strikes links at random."""
    control = negative_control(search, (), found.effect, turn.located.findings[0])
    findings = turn.located.findings
    return LeftOut(found.effect, found.parameters, found.evidence, 1.0, control, findings)


def _real(search: Search, last: Round) -> bool:
    """Return whether a located mismatch holds up where nothing was added.

    Something can be removed on held-out links, or the search leaves no doubt by itself, or links
    have offsets of their own (which are there although nothing predicts them).
    """
    if not last.located.significant or last.explanation is None:
        return False
    if last.explanation.removable.above_zero or last.located.p <= SURE:
        return True
    return search.work is not None and apart(search.world, search.work, ()) > APART


def _unknown(last: Round, note: str) -> Unknown:
    """Return the verdict on what no effect explains."""
    assert last.explanation is not None
    tried = {c.name: c.gain.value for c in last.explanation.contenders}
    return Unknown(last.located.findings, last.explanation.removable, tried, note)


def _share(search: Search, first: Explanation, added: Added) -> float:
    """Return the gain of all added effects as a fraction of the flexible regression's."""
    if not added:
        return 0.0
    before, after = (
        tally(search.world.ensemble(search.discover, effects, SCORE_MEMBERS, SCORE_FIRST))
        for effects in ((), added)
    )
    reached = gain_interval(before, after, search.seed).value
    return float(reached / max(first.removable.value, reached, 1e-9))


def _named(search: Search, rounds: list[Round], added: Added, share: float) -> tuple[Verdict, ...]:
    """Return one verdict per added effect: named alone, or with those that do as well."""
    out: list[Verdict] = []
    for turn in rounds:
        if turn.added is None or turn.explanation is None or turn.strike:
            continue
        effect = next((e for e in added if e.name == turn.added.name), None)
        if effect is None or any(effect.physics in v.names for v in out):
            continue
        same = equivalents(turn.explanation, search.seed)
        if len(added) > 1:
            views = (search.fit, search.discover)
            held = rivals(search.world, views, added, effect, same[1:], search.kinds, search.seed)
            same = (same[0], *held)
        options = tuple(
            _left_out(search, turn, effect if i == 0 else c.effect, c.gain, added, share)
            for i, c in enumerate(same)
        )
        passed = tuple(o for o in options if o.control.passed is not False) or options[:1]
        out.append(passed[0] if len(passed) == 1 else Ambiguous(passed, separating(passed)))
    return tuple(out)


def _left_out(
    search: Search, turn: Round, effect: Effect, gain: Estimate, added: Added, share: float
) -> LeftOut:
    """Return a named effect with its intervals and negative control."""
    others = without(added, turn.added) if turn.added else added
    intervals = parameter_intervals(search.world, search.sharpest, others, effect)
    control = negative_control(search, others, effect, turn.located.findings[0])
    return LeftOut(effect, intervals, gain, share, control, turn.located.findings)


def negative_control(search: Search, others: Added, effect: Effect, top: Finding) -> Control:
    """Return what is left where the effect must vanish (a wall delay where there is no wall)."""
    words = type(effect).control
    inert = effect.inert(Base().paths(search.discover.scene))
    if inert.sum() < 10 or inert.all():
        return Control(words, None)
    ensemble = search.world.ensemble(search.discover, others, SEARCH_MEMBERS, SEARCH_FIRST)
    cell = Cell(top.cell.observable, "mean", top.cell.place)
    if cell.observable not in ensemble.names:
        return Control(words, None)
    residual = ensemble.residual[:, ensemble.names.index(cell.observable)]
    quiet = cluster_bootstrap(residual[inert], ensemble.links[inert], search.seed)
    loud = float(np.nanmean(np.abs(residual[~inert])))
    passed = quiet.low <= 0 <= quiet.high or abs(quiet.value) < 0.25 * loud
    return Control(words, bool(passed), int(inert.sum()), quiet)


def separating(options: tuple[LeftOut, ...]) -> str:
    """Return which measurement would tell the options apart."""
    kinds = [type(option.effect) for option in options]
    wanted = [f"{k.name} vanishes in {k.control}" for k in kinds if k.control]
    if wanted:
        return f"record rows where only one must vanish: {'; '.join(dict.fromkeys(wanted))}"
    return "compare signatures: " + "; ".join(f"{k.name}: {k.signature}" for k in kinds)
