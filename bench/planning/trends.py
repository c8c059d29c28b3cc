"""Explanations of what has no name: the error follows one thing that a user can change."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.observables import RANGE
from bench.physics.effects.fitted.unnamed import Unnamed
from bench.planning.alternatives import Alternative, Past
from bench.planning.scatter import Floats, components, log_likelihood
from bench.planning.settings import LEAST_SCATTER, TREND_NATS, TREND_REACH, WALKERS
from bench.planning.world import Added
from bench.recordings.motion import SPEED

NOTHING = ""  # the column of an error that follows none
COLUMNS = {
    "true_range_m": "distance",
    "reply_time_s": "reply time",
    "temperature_c": "temperature",
    "time_s": "time",
    SPEED: "radial speed",
    "tx_z_m": "height of the transmitter",
    "tx_power_dbm": "transmit power",
}


def trends(past: Past, rest: Added, seed: int) -> tuple[Alternative, ...]:
    """Return straight lines over what can be changed that explain the error about equally well.

    Among them that it follows none of these. The likeliest first; those far behind it are left out.
    Each is drawn by resampling links.
    """
    found = past.evidence
    if RANGE not in found.names:
        return ()
    left = past.residual(rest)[0][:, [found.names.index(RANGE)]]
    made = {}
    for column, words in COLUMNS.items():
        value = numeric(found.frame, column)
        if np.isfinite(value).all() and np.ptp(value) > 0:
            made[column] = (_likelihood(left, value, found.links), f"the error follows {words}")
    if made:
        made[NOTHING] = (_likelihood(left, None, found.links), "the error is the same everywhere")
    best = max((score for score, _ in made.values()), default=0.0)
    near = sorted((-s, c) for c, (s, _) in made.items() if s > best - TREND_NATS)
    return tuple(_drawn(past, rest, left, column, made[column][1], seed) for _, column in near)


def _likelihood(left: Floats, value: Floats | None, links: np.ndarray) -> float:
    at = np.zeros(len(left)) if value is None else value
    rest = left - _line(left, at, np.ones(len(at)), int(value is not None))(at)[:, None]
    scatter = components(rest, links)
    within = scatter.within + LEAST_SCATTER["m"] ** 2
    return log_likelihood(rest, links, type(scatter)(within, scatter.between))


def _line(left: Floats, value: Floats, weight: Floats, degree: int) -> np.poly1d:
    return np.poly1d(np.polyfit(value, left[:, 0], degree, w=np.sqrt(weight)))


def _drawn(past: Past, rest: Added, left: Floats, column: str, name: str, seed: int) -> Alternative:
    """Return a line over a column, fitted again to links drawn with replacement."""
    degree = int(column != NOTHING)
    column = column or "true_range_m"
    value, links = numeric(past.evidence.frame, column), past.evidence.links
    count, rng = int(links.max()) + 1, np.random.default_rng(seed)
    reach = TREND_REACH * np.ptp(value)
    knots = (float(value.min() - reach), float(value.max() + reach))
    draws = []
    for _ in range(WALKERS):
        drawn = rng.multinomial(count, np.full(count, 1 / count))
        weight = np.asarray(drawn[links], np.float64)
        line = _line(left, value, weight, degree)
        ends = (float(line(knots[0])), float(line(knots[1])))
        draws.append((*rest, Unnamed(column=column, knots=knots, shifts_m=ends)))
    return Alternative(name, tuple(draws))
