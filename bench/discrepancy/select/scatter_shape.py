"""Whether what is left scatters as independent scatter does: one hump, as wide on both sides."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added, Comparison, View, without
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.data.two_samples import two_samples
from bench.discrepancy.locate.row_scatter import about_links
from bench.discrepancy.select.adequacy import Adequacy
from bench.discrepancy.select.settings import (
    BOUNDED_P,
    FEWEST_SHAPED,
    NO_SCATTER_SHARE,
    OVERDONE_P,
    SHAPE_Z,
)
from bench.discrepancy.select.within_links import components, drawn_by_rows
from bench.discrepancy.settings import (
    LEAST_SCATTER_M,
    SCATTER_SHAPE_P,
    SCORE_FIRST,
    SCORE_MEMBERS,
    STEADY_P,
)
from bench.physics.effect import Effect
from bench.physics.units import Floats

OTHER_SHAPE = "recorded ranges scatter in another shape: one-sided, in two humps or with long tails"


def scatters_alike(comparison: Comparison, view: View, added: Added, effect: Effect) -> Adequacy:
    """Return whether ranges beside the simulator's mean are distributed as simulated ones are.

    Asked of independent scatter alone: it is named for a distribution, and a score hardly tells
    one wide hump from two narrow ones (two-sample test of Kolmogorov and Smirnov). Where every row
    draws its own, rows of one link must scatter more than they do without it, and not far less than
    with it: a score of single rows takes for scatter what links keep.
    """
    if not type(effect).independent or RANGE not in view.recorded.names:
        return Adequacy(True)
    whole, rest = (
        comparison.ensemble(view, one, SCORE_MEMBERS, SCORE_FIRST)
        for one in (added, without(added, effect))
    )
    if steady(whole, rest):
        return Adequacy(False, 1.0, note="rows of one link scatter no more than simulated ones")
    if overdone(whole, rest):
        return Adequacy(False, 1.0, note="rows of one link scatter far less than with it")
    return shape(whole)


def steady(whole: Ensemble, rest: Ensemble) -> bool:
    """Return whether ranges of one link scatter no more than in `rest`, where `whole` does more.

    One-sided tests of both variances within links (Fisher 1925) and of the ranks of deviations,
    which a few simulated ranges far off leave as they are, at 5 % together; False where no link
    has several rows, or an effect moves all rows of a link alike.
    """
    seen = _within(whole, rest)
    if seen is None:
        return False
    return not min(_chances(rest, seen, "greater")) <= STEADY_P / 2


def overdone(whole: Ensemble, rest: Ensemble) -> bool:
    """Return whether ranges of one link surely scatter less than in `whole`, more so than `rest`.

    By both tests of `steady`. A scatter as wide as offsets that links keep is such: a score of
    single rows does not tell these from those.
    """
    seen = _within(whole, rest)
    return seen is not None and max(_chances(whole, seen, "less")) <= OVERDONE_P


def _within(whole: Ensemble, rest: Ensemble) -> NDArray[np.bool_] | None:
    """Return the rows [n] that tell how ranges of one link scatter, None without or where unmoved.

    Those of links of several, known in all versions.
    """
    change = whole.simulated_of(RANGE) - rest.simulated_of(RANGE)
    if not drawn_by_rows(change, whole.links):
        return None
    code = np.unique(rest.links, return_inverse=True)[1]
    known = [np.isfinite(one.versions_of(RANGE)).all(axis=0) for one in (whole, rest)]
    several = (np.bincount(code)[code] > 1) & known[0] & known[1]
    return several if int(several.sum()) > len(np.unique(code[several])) else None


def _chances(
    made: Ensemble, rows: NDArray[np.bool_], side: Literal["greater", "less"]
) -> tuple[float, float]:
    """Return the chances that ranges of one link scatter as much more or less than simulated ones.

    Of variances, then of ranks; over some rows [n].
    """
    from scipy.stats import f

    values = made.versions_of(RANGE)[:, rows]
    code = np.unique(made.links[rows], return_inverse=True)[1]
    free = int(rows.sum()) - len(np.unique(code))
    beside = values - values[1:].mean(axis=0)
    within = np.array([components(one, code)[1] for one in beside])
    m = len(within) - 1
    simulated = max(float(within[1:].mean()) * m / max(m - 1, 1), LEAST_SCATTER_M**2)
    law = f(free, free * max(m - 1, 1))
    far = float(within[0]) * m / (m + 1) / simulated
    return float(law.sf(far) if side == "greater" else law.cdf(far)), _ranked(beside, code, side)


def _ranked(beside: Floats, code: NDArray[np.intp], side: Literal["greater", "less"]) -> float:
    """Return the chance that deviations from links rank as far above or below simulated ones.

    Of values [1 + m, n] beside the mean of the simulated ones, to which these are nearer than a
    new one is.
    """
    from scipy.stats import mannwhitneyu

    away = about_links(beside, code)
    m = len(away) - 1
    recorded, simulated = away[0] * np.sqrt(m / (m + 1)), away[1:] * np.sqrt(m / max(m - 1, 1))
    return float(mannwhitneyu(recorded, simulated.ravel(), alternative=side).pvalue)


def alike(recorded_m: Floats, simulated_m: Floats) -> bool:
    """Return whether two scatters are of one shape, whatever their widths.

    Where simulated rows hardly scatter theirs is none: then whether recorded ones are normal.
    """
    from scipy.stats import kstest

    if np.var(simulated_m) < NO_SCATTER_SHARE * np.var(recorded_m):
        normal = kstest(recorded_m / np.std(recorded_m), "norm")
        return bool(normal.pvalue > SCATTER_SHAPE_P)
    own, other = (
        one / max(float(np.std(one)), LEAST_SCATTER_M) for one in (recorded_m, simulated_m)
    )
    return two_samples(own, other)[1] > SCATTER_SHAPE_P


def shape(ensemble: Ensemble) -> Adequacy:
    """Return whether recorded and simulated ranges scatter alike around the ensemble's mean.

    Beside what they all have in common: a constant is another cause's, or nameless, and no shape.
    """
    versions = ensemble.versions_of(RANGE)
    m = len(versions) - 1
    if m < 2:
        return Adequacy(True)
    middle = versions[1:].mean(axis=0)
    recorded = versions[0] - middle
    simulated = (versions[1:] - middle) * np.sqrt((m + 1) / (m - 1))  # as far as a new one is
    known = np.isfinite(recorded)
    own = recorded[known] - recorded[known].mean()
    apart, chance = two_samples(own, simulated[np.isfinite(simulated)].ravel())
    z = float(apart * np.sqrt(max(len(own), 1)))
    fine = chance > SCATTER_SHAPE_P or bounded(own, ensemble.links[known])
    return Adequacy(fine, apart, z, note="" if fine else OTHER_SHAPE)


def bounded(own_m: Floats, links: NDArray[np.intp]) -> bool:
    """Return whether errors [n] are of one bounded, even shape that all links [n] have in common.

    Jitter need not be normal: that of a spurious tone has the two ends of an arcsine, that of data
    two humps (bounded jitter, the dual-Dirac model: Agilent 5989-3206EN). A detour, a second
    path or a late row is one-sided, has tails, or another width in every link.
    """
    from scipy.stats import f_oneway, kurtosis, skew

    beside = own_m - own_m.mean()
    n = len(own_m)
    if n < FEWEST_SHAPED or float(beside.std()) < LEAST_SCATTER_M:
        return False
    # Over the standard errors that both have of normal values (Fisher 1930).
    tails, leaning = kurtosis(beside) / np.sqrt(24 / n), skew(beside) / np.sqrt(6 / n)
    if tails > -SHAPE_Z or abs(leaning) > SHAPE_Z:
        return False
    parts = [np.abs(beside[links == one]) for one in np.unique(links)]
    several = [one for one in parts if len(one) > 1]
    return len(several) > 1 and bool(f_oneway(*several).pvalue > BOUNDED_P)
