"""Where no counts are logged, levels turned down look like another slope over the distance."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.select import uncounted
from bench.discrepancy.select.uncounted import lead_over_control, with_uncounted
from bench.discrepancy.select.verdict import Control, LeftOut
from bench.discrepancy.sets.settings import NAME_NATS
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.units import Floats

LINKS = 84


def _line_leaves(far_m: Floats, left_db: Floats) -> Floats:
    ways = np.stack([np.ones(LINKS), np.log10(far_m)], axis=1)
    return np.asarray(left_db - ways @ np.linalg.lstsq(ways, left_db, rcond=None)[0])


def _levels() -> tuple[Floats, Floats, Floats]:
    rng = np.random.default_rng(4)
    far_m = rng.uniform(8, 70, LINKS)
    return far_m, -52.0 - 20 * np.log10(far_m), rng.normal(0, 1.0, LINKS)


def test_what_is_turned_down_where_signals_are_strong_is_not_told_from_a_slope() -> None:
    far_m, level, noise = _levels()
    left = noise - 0.25 * np.maximum(level + 88, 0)
    assert lead_over_control(_line_leaves(far_m, left), left, level) < NAME_NATS


@pytest.mark.parametrize(("exponent", "offset_db"), [(2.8, -4.0), (1.7, -6.0), (2.3, 2.0)])
def test_a_slope_is_told_where_weak_signals_are_off_too(exponent: float, offset_db: float) -> None:
    far_m, level, noise = _levels()
    left = noise - offset_db - 10 * (exponent - 2) * np.log10(far_m)
    assert lead_over_control(_line_leaves(far_m, left), left, level) >= NAME_NATS


def test_a_path_loss_alone_is_said_with_a_control_that_could_not_be_tried(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(uncounted, "_as_well", lambda *_: True)
    none, gain = Control("", None), Estimate(1, 1, 1)
    loss, scale = PathLoss(), RangeScale()
    said = tuple(LeftOut(one, (), gain, 1.0, none) for one in (loss, scale))
    fit = SimpleNamespace(waveform=False)
    lacking = SimpleNamespace(fit=fit, untried={LevelControl.name: LevelControl})
    counted = SimpleNamespace(fit=fit, untried={})
    assert with_uncounted(counted, (loss, scale), said) == said  # type: ignore[arg-type]
    found = with_uncounted(lacking, (loss, scale), said)  # type: ignore[arg-type]
    assert [one.names for one in found] == [("path-loss", "level-control"), ("range-scale",)]
