"""Sets with an idle member are not added to: the same is added to those without it."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.joint.growth import all_used
from bench.discrepancy.joint.polish import Fit, key_of
from bench.discrepancy.joint.settings import NAME_NATS
from bench.discrepancy.joint.statistics import Moments
from bench.physics.effect import Effect
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.noise_floor import NoiseFloor

NOISE, LOSS = NoiseFloor(), PathLoss()


def _fit(nats: float, *effects: Effect) -> Fit:
    left = np.zeros((2, 1))
    return Fit(effects, Moments(left, left, {}, left, left), (), nats)


def _known(*fits: Fit) -> dict[frozenset[str], Fit]:
    return {key_of(fit.effects): fit for fit in fits}


def test_a_set_that_one_of_its_members_beats_alone_is_not_added_to():
    alone = _fit(100.0, NOISE)
    assert not all_used(_fit(100.0 - 2 * NAME_NATS, NOISE, LOSS), _known(alone))
    assert all_used(_fit(100.0 - NAME_NATS / 2, NOISE, LOSS), _known(alone))
    assert all_used(_fit(100.0 + NAME_NATS, NOISE, LOSS), _known(alone))


def test_a_set_no_part_of_which_is_known_is_added_to():
    assert all_used(_fit(-1e6, NOISE, LOSS), {})
    assert all_used(_fit(-1e6, NOISE), _known(_fit(0.0, LOSS)))
