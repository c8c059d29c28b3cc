"""A loss is not said where neither levels nor waveforms are known."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select.told_by_levels import told_by_levels
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.ranging.antenna_delay import AntennaDelay

FITTED = (
    ParameterEstimate("loss_scale", 1.56, 1.29, 1.86, "ratio"),
    ParameterEstimate("delay_scale", 1.1, 0.9, 1.3, "ratio"),
)


def search(names: tuple[str, ...], waveform: bool) -> Any:
    """Return a search of recordings that tell so much."""
    recorded = SimpleNamespace(names=names)
    return cast("Any", SimpleNamespace(fit=SimpleNamespace(recorded=recorded, waveform=waveform)))


@pytest.mark.parametrize(
    ("names", "waveform", "told"),
    [
        (("error_m",), False, False),
        (("error_m", "rx_power_dbm"), False, True),
        (("error_m",), True, True),
    ],
)
def test_a_loss_is_told_by_levels(names: tuple[str, ...], waveform: bool, told: bool) -> None:
    loss, delay = told_by_levels(search(names, waveform), (), MaterialDelay(), FITTED)
    assert loss.determined is told
    assert delay.determined


def test_what_has_no_loss_stays() -> None:
    assert told_by_levels(search(("error_m",), False), (), AntennaDelay(), FITTED) == FITTED
