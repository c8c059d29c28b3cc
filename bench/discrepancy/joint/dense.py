"""Whether late samples come by more ways than walls make: so dense that chance alone sizes them.

Where nobody told the places of walls, their reflections cannot be tried, and do the same to mean
profiles as a tail. They come by a few ways: of one in the time that a pulse lasts, or fewer, waves
of any phase have a mean squared power of three times its squared mean, or more; of very many, as
in a tail, of twice (each way adds its fourth moment over its number: Middleton 1977). Where so much
of a zone is what was added, and its samples scatter as a tail's, none of it is a wall's.
"""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass

import numpy as np

from bench.discrepancy.compare.records import Samples
from bench.discrepancy.compare.view import Added
from bench.discrepancy.joint.grain import Grain, within, zones_of
from bench.discrepancy.joint.quiet_moments import mean_known
from bench.discrepancy.joint.settings import CLASS_NATS, DENSE_SHARE, GRAIN_LEAST, GRAIN_ZONES_NS
from bench.discrepancy.joint.statistics import Floats


@dataclass(frozen=True)
class Zone:
    """A zone of delay: mean `power`, mean squared over squared mean power, its standard error."""

    power: float
    ratio: float
    error: float


def dense_of(grain: Grain, effects: Added, untried: Container[str]) -> tuple[str, ...]:
    """Return the names of effects that resemble walls' but are denser than what these reflect.

    Asked where walls are `untried` alone: elsewhere nothing hangs on it.
    """
    alike = (one.name for one in effects if type(one).resembles in untried)
    return tuple(name for name in alike if is_dense(grain, effects, name))


def is_dense(grain: Grain, effects: Added, name: str) -> bool:
    """Return whether what one effect of a set adds is surely denser than what walls reflect.

    In no zone by few ways: walls may be heard in some alone.
    """
    if grain.recorded is None:
        return False
    rest = tuple(effect for effect in effects if effect.name != name)
    seen = zones(grain.recorded, grain)
    tail, bare = ([zones(one, grain) for one in grain.samples(some)] for some in (effects, rest))
    each = [
        denser_nats(one, _mean([z[k].ratio for z in tail]), _mean([z[k].power for z in bare]))
        for k, one in enumerate(seen)
    ]
    return sum(each) >= CLASS_NATS and min(each) > -CLASS_NATS


def denser_nats(seen: Zone, tail: float, bare_power: float) -> float:
    """Return the nats by which a zone is a tail's, of such a ratio, rather than of few ways.

    0 where less than `DENSE_SHARE` of its power was added. What is denser than that tail is not
    farther from few ways than it is.
    """
    share = 1 - bare_power / seen.power
    if share < DENSE_SHARE:
        return 0.0
    error = np.hypot(seen.error, GRAIN_LEAST[0] * seen.ratio)
    left = max(seen.ratio - tail, 0.0)
    return float(0.5 * (min(left - share**2, 0.0) ** 2 - left**2) / error**2)


def zones(samples: Samples, grain: Grain) -> list[Zone]:
    """Return the zones of late samples that have enough of them."""
    magnitude, delay = samples[0], mean_known(samples[1], 0)
    every = (magnitude[:, zone] for zone in zones_of(delay, GRAIN_ZONES_NS))
    return [Zone(float(np.nanmean(one**2)), *_ratio(one, grain)) for one in every]


def _ratio(magnitude: Floats, grain: Grain) -> tuple[float, float]:
    logarithm, error = within(magnitude, grain.given)
    return float(np.exp(logarithm)), float(np.exp(logarithm) * error)


def _mean(values: list[float]) -> float:
    return float(np.mean(values))
