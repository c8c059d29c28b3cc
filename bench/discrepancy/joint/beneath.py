"""Where the fit of a ringing beside a dense tail begins: at what rows have in common late.

Mean profiles of the two are much alike, and beside all of a tail a ringing finds nothing left to
do. But a ringing is alike in all rows, and what comes by many ways is not: a share K of a late
power that is constant makes the ratio of the mean squared power over the squared mean power
K^2 + 4 K (1 - K) + r (1 - K)^2, of waves by chance alone r (Rice 1945: r = 2). So that ratio tells
how much of each late sample rings.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from operator import itemgetter

import numpy as np

from bench.discrepancy.compare.records import Samples
from bench.discrepancy.compare.view import Added
from bench.discrepancy.fit.starts import inside
from bench.discrepancy.joint.grain import Grain, levels_of, mean_about
from bench.discrepancy.joint.quiet_moments import mean_known
from bench.discrepancy.joint.settings import (
    BENEATH_ABOUT,
    BENEATH_BEGUN_DB,
    BENEATH_DB,
    BENEATH_DECAYS_NS,
    BENEATH_DELAYS_NS,
    BENEATH_LEAST,
    GRAIN_WEAKEST,
    GRAIN_ZONES_NS,
)
from bench.discrepancy.joint.statistics import Floats
from bench.physics.effect import Effect
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.receiver.pulse_ringing import PulseRinging

BEGUN = PulseRinging(ring_db=BENEATH_BEGUN_DB, on_top=1.0)


def beneath(grain: Grain, effects: Added) -> Added | None:
    """Return effects with a ringing beside their tail from which a fit may begin.

    None where there is no tail, or where hardly a late sample has anything in common.
    """
    tail = next((one for one in effects if isinstance(one, DiffuseTail)), None)
    if grain.recorded is None or tail is None:
        return None
    rest = tuple(one for one in effects if not isinstance(one, PulseRinging))
    bare = tuple(one for one in rest if one is not tail)
    ringing = _ringing(grain, bare, *_in_common(grain, rest))
    weaker = replace(tail, level_db=_bounded(tail, "level_db", tail.level_db - BENEATH_DB))
    return None if ringing is None else (*bare, weaker, ringing)


def _in_common(grain: Grain, rest: Added) -> tuple[Floats, Floats]:
    """Return the mean late power beside the crest that rings [K], and its share of all [K].

    0 where it is too early to say, or too little.
    """
    assert grain.recorded is not None
    recorded = _powers(grain.recorded)
    every = np.mean([_ratio(_powers(one)) for one in grain.samples(rest)], axis=0)
    by_chance, seen = (mean_about(one, BENEATH_ABOUT) for one in (every, _ratio(recorded)))
    share = np.linspace(0, 1, 101)[:, None]
    foreseen = share**2 + 4 * share * (1 - share) + by_chance * (1 - share) ** 2
    nearest = np.abs(foreseen - seen).argmin(axis=0)
    delay = mean_known(grain.recorded[1], 0)
    late = (delay > GRAIN_ZONES_NS[0]) & (delay < GRAIN_ZONES_NS[-2])
    steady = np.where(late, share[nearest, 0], 0.0)
    steady[steady < BENEATH_LEAST] = 0.0
    return recorded.mean(axis=0) * steady, steady


def _ringing(grain: Grain, bare: Added, power: Floats, steady: Floats) -> PulseRinging | None:
    """Return the ringing whose mean late power beside the crest is most like `power` [K]."""
    if not steady.any():
        return None
    alone, amplitude = _mean_power(grain, bare), np.sqrt(power)
    found: list[tuple[float, PulseRinging]] = []
    for delay_ns, decay_ns in product(BENEATH_DELAYS_NS, BENEATH_DECAYS_NS):
        one = replace(BEGUN, ring_delay_ns=delay_ns, ring_decay_ns=decay_ns)
        more = np.sqrt(np.maximum(_mean_power(grain, (*bare, one)) - alone, 0)) * (steady > 0)
        alike = float(amplitude @ more)
        size = alike / max(float(more @ more), np.finfo(float).tiny)
        found.append((size * alike, _louder(one, 20 * np.log10(max(size, GRAIN_WEAKEST)))))
    return max(found, key=itemgetter(0))[1]


def _louder(ringing: PulseRinging, by_db: float) -> PulseRinging:
    """Return a ringing that is so much louder, less what the fit begins with less."""
    level_db = ringing.ring_db + by_db - BENEATH_DB
    return replace(ringing, ring_db=_bounded(ringing, "ring_db", level_db))


def _bounded(effect: Effect, name: str, value: float) -> float:
    """Return a value within the bounds of a parameter of an effect."""
    return inside(next(p for p in effect.parameters() if p.name == name), value)


def _mean_power(grain: Grain, effects: Added) -> Floats:
    """Return the mean power of samples beside the crest [K], as simulated once."""
    return np.asarray(_powers(grain.samples(effects, 1)[0]).mean(axis=0))


def _powers(samples: Samples) -> Floats:
    """Return the powers of samples [n, K] beside the crest of each row."""
    return np.asarray(10 ** (levels_of(samples) / 10))


def _ratio(power: Floats) -> Floats:
    """Return the mean squared power over the squared mean power, sample by sample [K]."""
    return np.asarray((power**2).mean(axis=0) / power.mean(axis=0) ** 2)
