"""Independent scatter where nothing differs but how far rows lie from their own link.

A score of few simulated rows hardly falls where scatter is added to them: both sides then scatter.
So the variance within links is compared itself, and what it says of the size.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.crps import LIKELIHOOD, cluster_bootstrap
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select.candidates import Contender, Explanation
from bench.discrepancy.select.elsewhere import beyond_marks
from bench.discrepancy.select.link_mixture import Strike
from bench.discrepancy.select.own_draws import free_of, free_share
from bench.discrepancy.select.own_scatter import beyond_causes
from bench.discrepancy.select.refute import announced
from bench.discrepancy.select.scatter_shape import alike
from bench.discrepancy.select.scatter_size import beside_simulated, extras, sized, variances
from bench.discrepancy.select.state import Round, Search
from bench.discrepancy.select.stepwise import calm_rows, locate_left, versions
from bench.discrepancy.select.within_links import within
from bench.discrepancy.settings import (
    FORM_SHARE,
    LEAST_SCATTER_M,
    SCATTER_OF_LINKS,
    SEARCH_FIRST,
    SEARCH_MEMBERS,
    STRIKE_NATS,
)
from bench.physics.effect import Effect
from bench.physics.units import Floats

JUDGED = "evidence in the scatter within links"
SCATTERED = {(RANGE, "spread"), (RANGE, "rows")}


def scatter_alone(
    search: Search, added: Added, explanation: Explanation, located: Located
) -> Strike | None:
    """Return independent scatter as what all links are struck by, None where it is not that alone.

    Only where every finding is of how far ranges spread, links keep nothing of it and no other
    cause makes it. The mean of a link's few rows scatters with them, so links may be off, too; and
    so may means of some rows be, which is no finding where rows scatter so (`_beside_scatter`).
    """
    kind = _kind(search, added, explanation)
    seen = {(f.cell.observable, f.cell.moment) for f in located.findings}
    if kind is None or not SCATTERED & seen or {name for name, _ in seen} != {RANGE}:
        return None
    found = _scattering(search, added, kind)
    only = seen <= SCATTERED | {(RANGE, "link")}
    return found if found and (only or not _beside_scatter(search, added, found.effect)) else None


def _beside_scatter(search: Search, added: Added, effect: Effect) -> bool:
    """Return whether ranges differ by more than how far they spread, beside scatter, too.

    Recorded and simulated rows that do not scatter alike do not change places: means of some
    places then differ by more than permutations tell. With that scatter they do change places.
    """
    left = locate_left(search, (*added, effect), len(added) + 1)
    return any(f.cell.observable == RANGE and f.cell.moment != "spread" for f in left.findings)


def _kind(search: Search, added: Added, explanation: Explanation) -> type[Effect] | None:
    """Return the independent scatter that is offered, None where something speaks against it.

    Beside one simulated row a score hardly falls by it, and it may be no contender at all; where a
    law or a grid is there it was one, and what these leave is none.
    """
    kinds = [type(c.effect) for c in explanation.contenders if type(c.effect).independent]
    if kinds or search.choice.scattering or any(type(effect).marked for effect in added):
        return next(iter(kinds), None)
    return _offered(search, added)


def _offered(search: Search, added: Added) -> type[Effect] | None:
    """Return the library's independent scatter, None where it is not offered or there already."""
    able = [k for k in search.kinds.values() if k.independent and not k.marked and k.without_cir]
    named = {effect.physics for effect in added}
    return next((kind for kind in able if kind.name not in named), None)


def scatter_beside(search: Search, added: Added, located: Located) -> Round | None:
    """Return a round that adds independent scatter beside the causes that are named, None without.

    Among thousands of places nothing else may stand out, and loud levels hide what ranges do: this
    asks for one thing alone. Rows of a link must scatter by more than another form of the causes
    could make them.
    """
    kind = _offered(search, added)
    if kind is None or search.choice.scattering:
        return None
    found = _scattering(search, added, kind)
    if found is None or not beyond_marks(search, added, found.effect):
        return None
    turn = announced(search, Round(located, None, None), (*added, found.effect), found.effect)
    assert turn.explanation is not None
    first = Contender(found.effect, turn.explanation.base, found.evidence)
    return replace(turn, explanation=turn.explanation.led_by(first), strike=found)


def of_forms(search: Search, added: Added) -> float:
    """Return the variance in m2 by which rows of a link scatter where causes have other forms.

    Of a share of what each does to them there: what that leaves in rows of a link is no scatter.
    """
    left, none = (
        search.comparison.ensemble(search.both, some, SEARCH_MEMBERS, SEARCH_FIRST).simulated_of(
            RANGE
        )
        for some in (added, ())
    )
    change = (left - none).mean(axis=0, keepdims=True)
    return FORM_SHARE**2 * float(np.nanmean(within(_range_only(change, search.both.links))[0] ** 2))


def _range_only(values_m: Floats, links: NDArray[np.intp]) -> Ensemble:
    """Return ranges [m, n] as an ensemble of these alone."""
    return Ensemble((RANGE,), ("m",), values_m[..., None], links)


def _scattering(search: Search, added: Added, kind: type[Effect]) -> Strike | None:
    """Return independent scatter of the size that rows of links miss, None where it is none."""
    if search.work is None or not beyond_causes(search, (*added, kind()), kind()).adequate:
        return None
    made, recorded, simulated = beside_simulated(search, added)
    usable = np.isfinite(recorded)
    if not usable.any() or not np.isfinite(simulated).any():  # every link has one row
        return None
    spread, extra = variances(recorded, simulated)
    if extra <= 0 or _kept_by_links(search, added) > SCATTER_OF_LINKS * extra:
        return None
    if not alike(recorded[usable], simulated[np.isfinite(simulated)]):
        return None
    least = max(spread, LEAST_SCATTER_M**2)  # a simulator may have none at all
    least += of_forms(search, added) if added else 0.0
    if spread + extra <= least:
        return None
    nats = _nats(recorded, least, spread + extra) * free_share(made.links, usable)
    ours = float(free_share(made.links, usable)[usable].sum())
    shared = 1 + ours / free_of(search.comparison, search.work, simulated)  # both scatter by chance
    total = (nats * usable.sum() / shared)[usable]
    evidence = cluster_bootstrap(total, made.links[usable], 0, LIKELIHOOD)
    if evidence.value < STRIKE_NATS or not evidence.likely_above_zero:
        return None  # normal rows of all links make both at once, a few wild links the first alone
    effect, sizes = sized(search, added, kind, extras(made, recorded, simulated))
    return Strike(effect, evidence, sizes, np.empty(0, np.intp), JUDGED)


def _nats(values: Floats, narrow: float, wide: float) -> Floats:
    """Return how much likelier each of some normal values is with the wider variance."""
    return np.asarray(values**2 / 2 * (1 / narrow - 1 / wide) - np.log(wide / narrow) / 2)


def _kept_by_links(search: Search, added: Added) -> float:
    """Return the variance between links beyond the simulated one, in square metres.

    Of links to which the causes do nothing, where there are enough: elsewhere their own forms
    leave offsets, as of walls no two of a kind are alike.
    """
    assert search.work is not None
    calm = calm_rows(search.comparison, search.work, added)
    made = versions(search.comparison, search.work, added).rows(calm)
    values, code = made.versions_of(RANGE), np.unique(made.links, return_inverse=True)[1]
    count = np.bincount(code)
    means = np.stack([np.bincount(code, one) / count for one in values])
    inner = [np.nanmean(part**2) for part in within(made)]
    own = float(np.mean(1 / count))
    between = np.var(means[0]) - inner[0] * own
    return float(between - (np.var(means[1:], axis=1).mean() - inner[1] * own))
