"""Late samples that are as dense as a tail's are of no few walls, whose places nobody told."""

from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.joint.dense import Zone, denser_nats, is_dense
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail

ROWS, AHEAD, SAMPLES = 200, 10, 110
DELAY = np.tile(np.arange(SAMPLES) - float(AHEAD), (ROWS, 1))
LATE = np.exp(-np.maximum(DELAY, 0.0) / 25.0) * (DELAY > 3)
TAIL = DiffuseTail()


@pytest.mark.parametrize(
    ("ways", "size", "dense"), [(0, 0.4, True), (5, 0.4, False), (0, 0.02, False)]
)
def test_a_tail_is_dense_and_few_ways_are_not_nor_what_is_too_weak_to_tell(ways, size, dense):
    rng = np.random.default_rng(1)
    added = _few(rng, ways) if ways else LATE * _chance(rng)
    recorded = np.abs(_bare(rng) + size * added), DELAY

    assert is_dense(_grain(recorded, size), (TAIL,), TAIL.name) is dense


def test_walls_that_are_heard_late_alone_are_not_lost_in_a_tail():
    rng = np.random.default_rng(3)
    late = 0.4 * _few(rng, 2) * (DELAY > 30) + 0.4 * LATE * _chance(rng) * (DELAY < 30)

    assert not is_dense(_grain((np.abs(_bare(rng) + late), DELAY), 0.4), (TAIL,), TAIL.name)


def test_nothing_is_said_without_waveforms():
    assert not is_dense(_grain(None, 0.4), (TAIL,), TAIL.name)


def _grain(recorded, size):
    def samples(effects):
        rngs = (np.random.default_rng([2, k]) for k in range(4))
        own = size if effects else 0.0
        return [(np.abs(_bare(rng) + own * LATE * _chance(rng)), DELAY) for rng in rngs]

    given = SimpleNamespace(of_links=lambda values: values.reshape(-1, 4, values.shape[1]).mean(1))
    return SimpleNamespace(recorded=recorded, samples=samples, given=given)


def _bare(rng):
    return 10.0 * (np.abs(DELAY) < 2) + 0.02 * _chance(rng)


def _chance(rng):
    return (rng.normal(size=DELAY.shape) + 1j * rng.normal(size=DELAY.shape)) / np.sqrt(2)


def _few(rng, ways):
    """Return as much power in a few pulses, each at a delay of its own."""
    out = np.zeros(DELAY.shape, complex)
    for _ in range(ways):
        at = AHEAD + rng.exponential(12.5, (ROWS, 1)) + 4
        turn = np.exp(2j * np.pi * rng.random((ROWS, 1)))
        out += 1.5 * turn * np.exp(-(((DELAY + AHEAD - at) / 1.2) ** 2))
    return out


def test_a_zone_speaks_for_a_tail_or_for_few_ways_or_for_neither():
    tail = denser_nats(Zone(4.0, 2.0, 0.1), 2.0, 1.0)

    assert tail > 8
    assert denser_nats(Zone(4.0, 1.5, 0.1), 2.0, 1.0) >= tail  # the error is a share of the ratio
    assert denser_nats(Zone(4.0, 5.0, 0.1), 2.0, 1.0) < -8
    assert denser_nats(Zone(1.5, 2.0, 0.1), 2.0, 1.0) == 0.0  # two thirds were there before
