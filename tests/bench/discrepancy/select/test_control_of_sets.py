"""The negative control of a set's name: quiet where it must vanish, or as off as everywhere."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.select import controls
from bench.discrepancy.sets.choice import Choice
from bench.physics.effects.propagation.material_delay import MaterialDelay

INERT = np.arange(60) % 2 == 0


class Walls(MaterialDelay):
    """A wall in every other row, whatever the table says."""

    def inert(self, batch):
        return INERT


@pytest.mark.parametrize("waveform", [True, False])
@pytest.mark.parametrize(
    ("clear_m", "everywhere_m", "passed"),
    [(0.0, 0.07, True), (0.07, 0.07, True), (0.07, 0.0, False), (-0.07, 0.07, False)],
)
def test_another_form_of_the_delay_does_not_fail_the_control(
    monkeypatch: pytest.MonkeyPatch,
    clear_m: float,
    everywhere_m: float,
    passed: bool,
    waveform: bool,
) -> None:
    rng = np.random.default_rng(2)
    versions = rng.normal(0, 0.01, (9, 60, 2))
    versions[0, :, 0] += np.where(INERT, clear_m, 0.1)
    made = Ensemble(("error_m", "kurtosis"), ("m", "1"), versions, np.arange(60) // 2)
    monkeypatch.setattr(controls, "Base", lambda: SimpleNamespace(paths=lambda _: None))
    monkeypatch.setattr(controls, "everywhere_left", lambda *_: everywhere_m)
    search = SimpleNamespace(
        fit=SimpleNamespace(waveform=waveform),
        discover=SimpleNamespace(scene=None),
        comparison=SimpleNamespace(ensemble=lambda *_: made),
        choice=Choice(names=("material-delay",)),
        seed=0,
    )
    top = SimpleNamespace(cell=SimpleNamespace(observable="kurtosis"))
    found = controls.negative_control(search, (), Walls(), top)  # type: ignore[arg-type]
    assert found.passed is passed
