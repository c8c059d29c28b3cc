"""Beside a level control only what no curve of a level does is a name; SIMULATED statistics."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.joint.curve import any_curve, beside_own_curve, with_own_curve
from bench.discrepancy.joint.statistics import Moments
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.effects.receiver.noise_floor import NoiseFloor

Floats = NDArray[np.float64]
LINKS = 60
LEVEL = np.linspace(-100.0, -70.0, LINKS)
OVER = np.maximum(LEVEL + 85, 0)  # decibels above the start of a control
CURVED, LOSS, FLOOR = LevelControl(), PathLoss(exponent=2.5), NoiseFloor(level_db=3.0)


def _set(effects: tuple[Any, ...], responses: tuple[Floats, ...], left: Floats) -> Any:
    moments = SimpleNamespace(
        left=left, covariances={1: np.eye(2)}, uneven=None, own=None, within=0.0, spared=None
    )
    names = tuple(one.name for one in effects)
    return SimpleNamespace(
        effects=effects, names=names, responses=responses, moments=moments, parameters=2
    )


def _brings(true: Floats, effect: Any) -> float:
    """Return what an effect of the right response brings beside a control of another curve."""
    given: Any = SimpleNamespace(
        count=np.ones(LINKS, int), ways=np.ones((LINKS, 1)), links=LINKS, crowding=1.0
    )
    curve = np.stack([0.3 * OVER, np.zeros(LINKS)], axis=1)
    noise = np.random.default_rng(0).normal(size=(LINKS, 2))
    rest = _set((CURVED,), (curve,), noise + true)
    whole = _set((CURVED, effect), (curve, true), noise)
    return beside_own_curve(given, whole, rest, effect.name)


def test_what_shows_only_where_a_control_acts_is_another_form_of_its_curve() -> None:
    above = np.stack([0.25 * OVER, np.zeros(LINKS)], axis=1)
    everywhere = np.stack([np.linspace(4.0, -4.0, LINKS), np.zeros(LINKS)], axis=1)
    elsewhere = np.stack([np.zeros(LINKS), np.full(LINKS, 2.0)], axis=1)
    assert _brings(above, LOSS) < 8 < _brings(everywhere, LOSS)
    assert _brings(elsewhere, FLOOR) > 50


def test_beside_nothing_that_has_a_curve_of_its_own_all_stand() -> None:
    left = np.zeros((LINKS, 2))
    whole, rest = _set((LOSS, FLOOR), (left, left), left), _set((FLOOR,), (left,), left)
    given: Any = None
    assert beside_own_curve(given, whole, rest, LOSS.name) == float("inf")


def test_a_curve_goes_nowhere_where_nothing_is_done() -> None:
    far, parts = any_curve(np.stack([0.3 * OVER, np.zeros(LINKS)], axis=1))
    assert not far[LEVEL < -85].any()
    assert not far[:, 1].any()
    assert np.array_equal(parts.sum(axis=1), np.ones(LINKS))
    none, whole = any_curve(np.zeros((LINKS, 2)))
    assert not none.any()
    assert whole.shape == (LINKS, 1)


def test_any_curve_of_a_control_is_a_form_of_what_it_leaves() -> None:
    """Beside a cause whose form is known nothing is free; a control's own may go any way above."""
    response = np.stack([0.3 * OVER, np.zeros(LINKS)], axis=1)
    moments = Moments(response, response, {1: np.eye(2)}, response, response)
    loss: Any = SimpleNamespace(effects=(LOSS,), responses=(response,), moments=moments)
    control: Any = SimpleNamespace(effects=(CURVED,), responses=(response,), moments=moments)
    assert with_own_curve(loss).own is None
    own = with_own_curve(control).own
    assert own is not None
    assert not own[LEVEL < -85].any()
    assert not own[:, 1].any()
    bent = np.where(OVER > 8, -1.0, 1.0) * (OVER > 3)
    left = bent - own[:, 0] @ np.linalg.lstsq(own[:, 0], bent, rcond=None)[0]
    assert (left**2).sum() < 0.4 * (bent**2).sum()
