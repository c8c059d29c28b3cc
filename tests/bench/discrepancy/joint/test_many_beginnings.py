"""Fits begin at points that do unlike things, and at plain forms of an effect."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.fit.starts import begun
from bench.discrepancy.joint.screen import Screen, Tried
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.pulse_ringing import PulseRinging


def _screen() -> Screen:
    """Return a screen of one link with two statistics that need no whitening."""
    made = object.__new__(Screen)
    made._flat = np.eye(2)[None]
    return made


def _point(nats: float, *response: float) -> Tried:
    return Tried(PathLoss(), np.array([response]), nats)


def test_of_points_that_do_the_same_the_likeliest_counts():
    loud, louder, other = _point(1.0, 1, 0), _point(2.0, 3, 0), _point(0.0, 0, 1)
    assert _screen().unlike([loud, other, louder], 3) == [louder, other]


def test_what_does_the_opposite_does_not_do_the_same():
    assert len(_screen().unlike([_point(1.0, 1, 0), _point(0.0, -1, 0)], 3)) == 2


def test_no_more_points_than_asked():
    assert len(_screen().unlike([_point(1.0, 1, 0), _point(0.0, 0, 1)], 1)) == 1


def test_beginnings_are_values_of_their_effects():
    for kind in (DiffuseTail, PulseRinging):
        for values in begun(kind):
            assert {name: getattr(kind(**values), name) for name in values} == values
    assert not begun(PathLoss)
