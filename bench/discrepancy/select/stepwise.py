"""The steps of one round: locate, explain, order, and what is added or taken out again.

`bench.discrepancy.method` calls them one after the other.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.reuse import reuse
from bench.discrepancy.compare.skill import Tally, gain, gain_interval, tally
from bench.discrepancy.compare.view import Added, Comparison, View, without
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.locate.permutation_test import locate
from bench.discrepancy.select.backfitting import beyond, chosen_first, pruned, refitted
from bench.discrepancy.select.by_offsets import witnessed
from bench.discrepancy.select.candidates import Contender, Explanation, explain
from bench.discrepancy.select.link_mixture import Strike, strikable, strike
from bench.discrepancy.select.own_draws import (
    beside_similar,
    beyond_own_draws,
    copied,
    within_links,
)
from bench.discrepancy.select.predictive_cells import kept
from bench.discrepancy.select.settings import FEWEST_SEVERAL
from bench.discrepancy.select.state import Round, Search
from bench.discrepancy.select.within_links import of_links, within
from bench.discrepancy.settings import (
    FAMILY_WISE,
    FEW_VERSIONS,
    MARGIN_NATS,
    MOVED_M,
    ONE_SIDED_95,
    REMOVED_SHARE,
    SCATTER_MARGIN_NATS,
    SCATTER_OF_LINKS,
    SCORE_FIRST,
    SCORE_MEMBERS,
    SEARCH_FIRST,
    SEARCH_MEMBERS,
    SIMPLER_SHARE,
    SURE_P,
    WAVE_LEFT_SHARE,
    WAVE_MARGIN_NATS,
    WAVE_MARGIN_SHARE,
)
from bench.physics.effect import Effect


def locate_left(search: Search, added: Added, turn: int, share: float = 1.0) -> Located:
    """Search for what the effects added so far leave, at a share of the error of all searches."""
    first = SEARCH_FIRST + turn * SEARCH_MEMBERS
    ensemble = search.comparison.ensemble(search.searched, added, SEARCH_MEMBERS, first)
    return located_in(search, search.searched, ensemble, turn, share * FAMILY_WISE)


def ranges_left(search: Search, added: Added) -> Located:
    """Search for what effects leave of ranges alone, in all rows that are searched."""
    rows = search.searched
    made = search.comparison.ensemble(rows, added, SEARCH_MEMBERS, SEARCH_FIRST)
    return located_in(search, rows, kept(made, (RANGE,)), 0, FAMILY_WISE)


def located_in(
    search: Search, seen: View, ensemble: Ensemble, turn: int, family_wise: float
) -> Located:
    """Return what rows that are seen beside their simulated versions show, at a level."""
    own = search.comparison.distinct(seen)
    few = borrows(ensemble, own)
    level = family_wise / 2 if few else family_wise  # two searches share the error of one
    crowding, number = search.comparison.crowding(seen), search.seed + turn
    alone = 1.0 if search.comparison.paired(seen) else crowding
    scatter = within_links(search.comparison, seen, ensemble)
    located = locate(
        ensemble.first(own), seen.covariates, number, level, crowding=alone,
        reused=reuse(search.comparison, seen), scatter=scatter,
        copied=copied(search.comparison, seen),
    )  # fmt: skip
    if located.significant and own > 1 and len(ensemble.simulated) >= own + FEW_VERSIONS:
        return beyond_own_draws(
            located, ensemble, search.comparison, seen, number, scatter, family_wise
        )
    if located.significant or not few:
        return located
    wider = beside_similar(ensemble, search.comparison, seen, number, level)
    return wider if wider.significant else located


def borrows(ensemble: Ensemble, own: int) -> bool:
    """Return whether scatter is borrowed from similar links: a row has few versions of its own."""
    return own < FEW_VERSIONS and len(ensemble.simulated) >= own + FEW_VERSIONS


def versions(comparison: Comparison, view: View, added: Added) -> Ensemble:
    """Return the versions of rows that tell what scatter is, borrowed ones where own ones are few.

    The mean of these is the rows' own.
    """
    made, own = (
        comparison.ensemble(view, added, SEARCH_MEMBERS, SEARCH_FIRST),
        comparison.distinct(view),
    )
    return made.beside(own) if borrows(made, own) else made.first(own)


def contradicted(search: Search, added: Added, located: Located) -> Effect | None:
    """Return an added effect whose signature what is left contradicts, None where none is.

    Scatter that is independent from row to row leaves no offsets that links keep; where such
    offsets are found after all, it only stood in for something else, unless rows of one link
    scatter as it makes them: both are there then. One search in twenty finds offsets by chance, so
    a doubtful one needs a witness: that rows of all links have some in common. Beside other causes
    the links count to which these do nothing: elsewhere their own forms leave such offsets.
    """
    effect = next((e for e in added if type(e).independent), None)
    cells = [f for f in located.findings if (f.cell.moment, f.cell.observable) == ("link", RANGE)]
    if effect is None or not cells or _scatters_inside(search, added, effect):
        return None
    rest = without(added, effect)
    asked = calm_rows(search.comparison, search.searched, rest)
    sure = bool(asked.all()) and min(f.p for f in cells) <= SURE_P
    return effect if sure or _kept_by_links(search, rest, asked) else None


def untouched(comparison: Comparison, view: View, added: Added) -> NDArray[np.bool_]:
    """Return the rows [n] of links no row of which effects move by a millimetre."""
    whole, none = (
        comparison.ensemble(view, some, SEARCH_MEMBERS, SEARCH_FIRST).simulated_of(RANGE)
        for some in (added, ())
    )
    moved = np.abs((whole - none).mean(axis=0)) > MOVED_M
    code = np.unique(view.links, return_inverse=True)[1]
    return np.asarray(np.bincount(code, moved)[code] == 0, np.bool_)


def calm_rows(comparison: Comparison, view: View, added: Added) -> NDArray[np.bool_]:
    """Return the rows [n] of `untouched` links, all of them where such links are few."""
    calm = untouched(comparison, view, added)
    few = len(np.unique(view.links[calm])) < FEWEST_SEVERAL
    return np.ones_like(calm) if few else calm


def calm_for(search: Search, added: Added, effect: Effect) -> Search:
    """Return the search on the links to which causes beside an independent scatter do nothing.

    As it is for other effects, and where such links are few. Elsewhere other forms of the causes
    leave offsets of links, which are no scatter.
    """
    rest, rows = without(added, effect), search.work
    if not type(effect).independent or type(effect).marked or not rest or rows is None:
        return search
    calm = calm_rows(search.comparison, rows, rest)
    if calm.all():
        return search
    touched = np.unique(rows.links[~calm])
    views = search.discover.leaving(touched), search.fit.leaving(touched), rows.leaving(touched)
    return replace(search, discover=views[0], fit=views[1], work=views[2])


def _scatters_inside(search: Search, added: Added, effect: Effect) -> bool:
    """Return whether most rows of one link scatter by most of what an effect makes them."""
    whole, rest = (
        versions(search.comparison, search.searched, some)
        for some in (added, without(added, effect))
    )
    (recorded, bare), (_, made) = within(rest), within(whole)
    if not np.isfinite(recorded).any():  # every link has one row
        return False
    least, most, seen = (float(np.nanmedian(one**2)) for one in (bare, made, recorded))
    return most > least and seen - least > SCATTER_OF_LINKS * (most - least)


def _kept_by_links(search: Search, rest: Added, asked: NDArray[np.bool_]) -> bool:
    """Return whether the `asked` rows [n] of a link have part of a mismatch of ranges in common.

    At 5 %.
    """
    made = versions(search.comparison, search.searched, rest).rows(asked)
    share, error = of_links(made, RANGE)
    return share > ONE_SIDED_95 * error


def explain_left(search: Search, added: Added, located: Located) -> Explanation:
    """Fit the library on the fit links, score it on the discover links."""
    focus = tuple(dict.fromkeys(f.cell.observable for f in located.findings))
    have = {effect.physics for effect in added}
    kinds = {
        n: k for n, k in search.kinds.items() if n not in have and not strikable(k, search.fit)
    }
    views = search.fit, search.discover
    return explain(search.comparison, *views, added, kinds, focus, search.seed, search.progress)


def order(search: Search, added: Added, explanation: Explanation) -> Explanation:
    """Return the explanation with the contender to add in front.

    Recordings of the range alone have one observable, on which nothing more can be told.
    """
    if not search.fit.waveform:
        return explanation
    if added:
        views = (search.fit, search.discover)
        explanation = refitted(
            search.comparison, views, added, explanation, search.kinds, search.seed
        )
        explanation = beyond(explanation, WAVE_LEFT_SHARE * explanation.removable.value)
    explanation = beyond(explanation, margin(search, added))
    return chosen_first(explanation, search.seed, MARGIN_NATS)


def margin(search: Search, added: Added) -> float:
    """Return the nats that one effect among `added`, or on top of them, must be worth.

    With waveforms, where much is compared, a share of what is reached already: an effect whose
    curve is a little wrong leaves that much, and something else always fits it.
    """
    if not search.fit.waveform:
        return MARGIN_NATS
    before, after = (
        tally(search.comparison.ensemble(search.discover, effects, SCORE_MEMBERS, SCORE_FIRST))
        for effects in ((), added)
    )
    return max(WAVE_MARGIN_NATS, WAVE_MARGIN_SHARE * gain(before, after))


def scored(search: Search, added: Added) -> Tally:
    """Return the tally of effects on held-out rows."""
    made = search.comparison.ensemble(search.discover, added, SCORE_MEMBERS, SCORE_FIRST)
    return tally(made)


def loses(search: Search, now: Added, before: Added) -> bool:
    """Return whether held-out links lose what an effect must be worth where `now` has come.

    `before` was there before; both are fitted.
    """
    lost = gain_interval(scored(search, now), scored(search, before), search.seed)
    return lost.likely_above_zero and lost.value > margin(search, now)


def best_contender(
    explanation: Explanation, scatter_nats: float = SCATTER_MARGIN_NATS
) -> Contender | None:
    """Return the contender to add: a gain beyond the margin, its one-sided bound above zero.

    Independent scatter stands for what cannot be predicted, so it is no answer where a regression
    removes much more than it, nor where it gains less than `scatter_nats`. Nor where
    something else is seen by a mark that scatter cannot leave,
    and brings half of its gain.
    """
    structure = max(REMOVED_SHARE * explanation.removable.value, scatter_nats)
    able = (
        c
        for c in explanation.contenders
        if not type(c.effect).independent or c.gain.value > structure
    )
    best = next(able, None)
    if best and type(best.effect).independent:
        least = SIMPLER_SHARE * best.gain.value
        marked = (c for c in explanation.contenders if type(c.effect).marked)
        best = next((c for c in marked if c.gain.value >= least), best)
    if best is None or not best.gain.likely_above_zero or best.gain.value <= MARGIN_NATS:
        return None
    return best


def witnessed_by_links(search: Search, added: Added, explanation: Explanation) -> Contender | None:
    """Return the contender that the offsets of links speak for where scores do for none.

    Only a first effect: of what fitted effects leave, something always speaks for another.
    """
    if search.work is None or added:
        return None
    effects = tuple(c.effect for c in explanation.contenders if c.gain.value > MARGIN_NATS)
    found = witnessed(search.comparison, search.work, added, effects)
    return next((c for c in explanation.contenders if c.effect is found), None)


def strike_links(search: Search, added: Added, best: Contender | None) -> Strike | None:
    """Return what strikes links at random, if that explains them better than `best` does."""
    if search.work is None:
        return None
    rival = with_contender(added, best) if best else added
    return strike(search.comparison, search.work, added, rival, search.kinds)


def struck_round(located: Located, explanation: Explanation, found: Strike) -> Round:
    """Return a round in which an effect that strikes links at random was found."""
    first = Contender(found.effect, explanation.base, found.evidence)
    return Round(located, explanation.led_by(first), found.effect, found)


def with_contender(added: Added, best: Contender) -> Added:
    """Return the effects with the contender added, or in place of the one of its physics."""
    rest = (known for known in added if known.physics != best.effect.physics)
    return best.company or (*rest, best.effect)


def prune(search: Search, added: Added, least: float, newcomer: Effect, located: Located) -> Added:
    """Return the effects that held-out links miss.

    A newcomer that both working views have shown, beyond doubt, is not pruned on one of them. Nor
    is what bears its mark, whatever scores say: something else would have to stand for it.
    """
    sure = search.work is not None and located.p <= SURE_P
    crossed = newcomer.name if sure else ""
    kept = pruned(search.comparison, search.discover, added, search.seed, least, crossed)
    missed = {effect.name for effect in added} - {effect.name for effect in kept}
    return tuple(e for e in added if e.name not in missed or bears_mark(search, e))


def bears_mark(search: Search, effect: Effect) -> bool:
    """Return whether recorded rows bear the mark of an effect: it is there, whatever it gains.

    Of ranges alone every effect that is `marked` was fitted by its mark, and logs of the receiver
    may show others.
    """
    kind = type(effect)
    if any(one.name == effect.name for one in search.logged):
        return True
    return bool(kind.by_mark(search.fit.frame)) or (kind.marked and not search.fit.waveform)
