"""What one member of a set brings where the others do nothing.

Forms of effects are never exactly right, and what a loud one leaves may look like another. But
where it does nothing at all - a path loss to the noise that is logged - no form of it does either.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.data.observables import LEVEL
from bench.discrepancy.joint.form import variances
from bench.discrepancy.joint.likelihood import evidence, left_free, white, whitener
from bench.discrepancy.joint.polish import Fit
from bench.discrepancy.joint.settings import ACTS, LEFT_NATS, NAME_NATS, NAME_SHARE, SCATTERS
from bench.discrepancy.joint.statistics import Moments, Statistics
from bench.discrepancy.select.second_level import harmonics, predicts
from bench.discrepancy.settings import FIT_MEMBERS
from bench.physics.effects.fitted.pattern_gain import PatternGain
from bench.physics.effects.propagation.antenna_pattern import heading_rad
from bench.physics.effects.propagation.path_loss import PathLoss

Floats = NDArray[np.float64]


def brought_alone(given: Statistics, fit: Fit, rest: Fit, name: str) -> float:
    """Return the evidence of a member over the `rest` in statistics that no other moves, in nats.

    0 where there are none.
    """
    return _gain(given, fit, rest, untouched(given, fit, name))


def refuted(given: Statistics, fit: Fit, name: str, alone: float, brings: float) -> bool:
    """Return whether a member is not seen where it alone would show, and would be plain to see.

    So a noise floor that makes up for another's form in the profile, where noise is logged.
    `alone`: what it brings there (see `brought_alone`); a small loss beside all that it `brings` is
    a matter of its form.
    """
    if alone >= min(0.0, -NAME_SHARE * brings) or len(fit.names) == 1:
        return False
    return _plain(given, fit, name, untouched(given, fit, name))


def unlogged(given: Statistics, fit: Fit, rest: Fit, name: str) -> bool:
    """Return whether receivers log a member, no other moves that log, and it does not show there.

    What lowers weak samples alone, as a mean that is taken off, looks like less noise but to them.
    """
    place = _log(given, fit, name)
    if not len(place) or _gain(given, fit, rest, place) > 0:
        return False
    return _plain(given, fit, name, place)


def _plain(given: Statistics, fit: Fit, name: str, places: NDArray[np.intp]) -> bool:
    """Return whether what a member does to some statistics would be plain to see."""
    place, some = fit.names.index(name), _among(fit, places)
    response = some.responses[place]
    matrices, _ = whitener(given, some.moments, [response])
    foreseen = 0.5 * float((white(matrices, response) ** 2).sum())
    return given.worth(foreseen, (fit.effects[place],)) > NAME_NATS


def logged(given: Statistics, fit: Fit, rest: Fit, name: str) -> bool:
    """Return whether a member is what receivers log of it, which no other of the set moves.

    What has no form would do as well to a log of noise: but noise is what that is a log of. It must
    be of the size that the log says, too.
    """
    place = _log(given, fit, name)
    if _gain(given, fit, rest, place) < NAME_NATS:
        return False
    some = _among(fit, place)
    return left_free(given, some.moments, some.responses, some.parameters)[0] < LEFT_NATS


def _log(given: Statistics, fit: Fit, name: str) -> NDArray[np.intp]:
    """Return the place of the log of a member [1], where no other moves it; else none [0]."""
    column = type(fit.effects[fit.names.index(name)]).logged_as
    places = untouched(given, fit, name)
    return places[[given.names[one] == column for one in places]]


def untouched(given: Statistics, fit: Fit, name: str) -> NDArray[np.intp]:
    """Return the places of statistics of which others than `name` move no mean nor scatter."""
    others = [one for n, one in zip(fit.names, fit.responses, strict=True) if n != name]
    moved = np.abs(np.stack(others)).max(axis=(0, 1)) if others else 0.0
    kept = tuple(effect for effect in fit.effects if effect.name != name)
    wider = variances(given.needed(kept)) > SCATTERS * variances(given.needed(()))
    return np.flatnonzero((moved < ACTS) & ~wider)


def _gain(given: Statistics, fit: Fit, rest: Fit, places: NDArray[np.intp]) -> float:
    """Return the evidence of a set over the rest of it by some statistics alone, in nats."""
    if not len(places):
        return 0.0
    some = [_among(one, places) for one in (fit, rest)]
    whole, less = (evidence(given, one.moments, one.responses, one.parameters) for one in some)
    return whole - less


def _among(fit: Fit, places: NDArray[np.intp]) -> Fit:
    """Return a set as some statistics show it."""
    responses = tuple(one[:, places] for one in fit.responses)
    return replace(fit, moments=_part(fit.moments, places), responses=responses)


def _part(moments: Moments, places: NDArray[np.intp]) -> Moments:
    """Return some of the statistics; how rows scatter within links is not told by statistic."""
    some = _some(moments.covariances, places)
    spared = moments.spared and replace(
        moments.spared, covariances=_some(moments.spared.covariances, places)
    )
    own, uneven = (None if one is None else one[:, places] for one in (moments.own, moments.uneven))
    spread, rows = moments.spread_left[:, places], moments.rows_left[:, places]
    return replace(
        moments,
        left=moments.left[:, places],
        mean=moments.mean[:, places],
        covariances=some,
        spread_left=spread,
        rows_left=rows,
        within=0.0,
        own=own,
        uneven=uneven,
        spared=spared,
    )


def _some(covariances: Mapping[int, Floats], places: NDArray[np.intp]) -> dict[int, Floats]:
    """Return covariances of some statistics."""
    return {n: one[np.ix_(places, places)] for n, one in covariances.items()}


def beside_a_gain(given: Statistics, fit: Fit, rest: Fit, name: str) -> bool:
    """Return whether levels of links left out follow a path loss beside any gain over the heading.

    However loud the gain is: it does not know the distance. Of a set of these two alone.
    """
    if name != PathLoss.name or rest.names != (PatternGain.name,):
        return False
    before, after = (
        given.comparison.ensemble(given.rows, one.effects, FIT_MEMBERS) for one in (rest, fit)
    )
    if LEVEL not in before.names or LEVEL not in after.names:
        return False
    left = before.residual_of(LEVEL)
    mean_db = [one.simulated_of(LEVEL).mean(axis=0) for one in (before, after)]
    known = np.isfinite(left) & np.isfinite(mean_db[1] - mean_db[0])
    others = np.column_stack([np.ones(len(left)), harmonics(heading_rad(given.rows.scene))])
    change = (mean_db[1] - mean_db[0])[known]
    return predicts(left[known], change, others[known], given.rows.links[known])
