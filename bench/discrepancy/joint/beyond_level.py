"""What a member of a set brings beyond a level that is off everywhere, and beyond scatter.

A transmit power, antennas and cables are in no table, so levels may be off by so many decibels in
all links and say nothing: a pulse that is a little wider loses a little of its peak, too. And
simulated links may scatter more than recorded ones do, as similar ones stand for the same: what
makes links more alike is then likelier though it moves no mean to where that is. So neither counts
for a name; what makes links scatter more is judged by its own scatter.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.over_distance import LEVELS
from bench.discrepancy.joint.form import variances
from bench.discrepancy.joint.likelihood import columns_of, paid, white, whitened
from bench.discrepancy.joint.polish import Fit
from bench.discrepancy.joint.settings import FORMS, LEVEL_DB
from bench.discrepancy.joint.spared import scattered_as
from bench.discrepancy.joint.statistics import Statistics
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern

Floats = NDArray[np.float64]


def beyond_level(given: Statistics, fit: Fit, rest: Fit) -> float:
    """Return the evidence of a set over the `rest` of it beside one level in all links, in nats.

    A pattern's beside a level of every device: one anchor that is weak, in a corner, is weak over
    a quarter of all bearings. With the scatter of the rest where the set makes links more alike.
    """
    weaker = _weaker_devices(given, fit, rest)
    before, after = (np.log(variances(one.moments)).sum() for one in (rest, fit))
    if after < before:
        fit = replace(fit, moments=scattered_as(fit.moments, rest.moments))
    return _evidence(given, fit, weaker) - _evidence(given, rest, weaker)


def _weaker_devices(given: Statistics, fit: Fit, rest: Fit) -> list[Floats]:
    """Return what links [L, p] of each device would be with a level of their own.

    As statistics follow the level of a new pattern, so would they follow another; none without one.
    """
    parts = zip(fit.effects, fit.responses, strict=True)
    new = [r for e, r in parts if e.name not in rest.names and e.physics == AntennaPattern.name]
    if not new:
        return []
    level_db = new[0][:, np.isin(given.names, LEVELS)].mean(axis=1)
    per_db = level_db @ new[0] / max(float(level_db @ level_db), 1e-12)
    return [LEVEL_DB * share[:, None] * per_db for share in given.devices.T]


def _evidence(given: Statistics, fit: Fit, weaker: list[Floats]) -> float:
    """Return the evidence of a set, whatever its forms, beside a level of all links, in nats.

    And beside what `weaker` devices do.
    """
    seen = whitened(given, fit.moments, fit.responses)
    levels = LEVEL_DB * np.isin(given.names, LEVELS).astype(np.float64)
    beside = [np.tile(levels, (given.links, 1)), *weaker]
    level = np.stack([white(seen.matrices, one) for one in beside], axis=2)
    every = (
        [columns_of(seen.matrices, form * one, given.ways) for one in fit.responses]
        for form in FORMS
    )
    best = max(seen.nats([*columns, level]) for columns in every)
    return paid(given, best + fit.moments.within, fit.parameters)
