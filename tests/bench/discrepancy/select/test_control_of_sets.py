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
        comparison=SimpleNamespace(ensemble=lambda *_: made, crowding=lambda _: 1.0),
        choice=Choice(names=("material-delay",)),
        seed=0,
    )
    top = SimpleNamespace(cell=SimpleNamespace(observable="kurtosis"))
    found = controls.negative_control(search, (), Walls(), top)  # type: ignore[arg-type]
    assert found.passed is passed


def test_what_a_nameless_cause_does_where_nothing_stands_speaks_against_no_name(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One device stands elsewhere: its clear rows are off, as the set says."""
    rng, rows = np.random.default_rng(2), np.arange(60)
    versions = rng.normal(0, 0.01, (9, 60, 1))
    versions[0, :, 0] += np.where(INERT, 0.2, 0.1)
    made = Ensemble(("error_m",), ("m",), versions, rows // 2)
    monkeypatch.setattr(controls, "Base", lambda: SimpleNamespace(paths=lambda _: None))
    monkeypatch.setattr(controls, "everywhere_left", lambda *_: 0.0)
    search = SimpleNamespace(
        discover=SimpleNamespace(scene=None, rows=rows),
        work=SimpleNamespace(rows=rows[::-1]),
        comparison=SimpleNamespace(ensemble=lambda *_: made, crowding=lambda _: 1.0),
        choice=Choice(
            names=("material-delay",),
            others=("the position of a1",),
            shifts_m={"the position of a1": np.where(INERT, 0.2, 0.0)[::-1]},
        ),
        seed=0,
    )
    top = SimpleNamespace(cell=SimpleNamespace(observable="error_m"))
    found = controls.negative_control(search, (), Walls(), top)  # type: ignore[arg-type]
    assert found.passed is True


def test_the_control_asks_what_the_effect_acts_on(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside a level control counts differ most, also where no wall stands: walls move none."""
    rng = np.random.default_rng(2)
    versions = rng.normal(0, 1.0, (9, 60, 2))
    walls = versions.copy()
    walls[1:, :, 0] -= np.where(INERT, 0.0, 20.0)
    versions[0, :, 0] -= np.where(INERT, 0.0, 20.0)
    versions[0, :, 1] += 40.0
    names, units, links = ("energy_db", "preamble_count"), ("dB", "symbols"), np.arange(60) // 2
    without, beside = (Ensemble(names, units, one, links) for one in (versions, walls))
    monkeypatch.setattr(controls, "Base", lambda: SimpleNamespace(paths=lambda _: None))
    search = SimpleNamespace(
        discover=SimpleNamespace(scene=None),
        comparison=SimpleNamespace(
            ensemble=lambda _, added, *__: beside if added else without, crowding=lambda _: 1.0
        ),
        choice=Choice(),
        seed=0,
    )
    top = SimpleNamespace(cell=SimpleNamespace(observable="preamble_count"))
    found = controls.negative_control(search, (), Walls(), top)  # type: ignore[arg-type]
    assert found.passed is True
    assert found.left is not None
    assert found.left.unit == "dB"


def test_what_is_left_where_a_name_acts_is_beside_nameless_causes_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The fit of the names took in the constant of a nameless cause: nothing is left anywhere."""
    rng, rows = np.random.default_rng(2), np.arange(60)
    versions = rng.normal(0, 0.01, (9, 60, 1))
    made = Ensemble(("error_m",), ("m",), versions, rows // 2)
    monkeypatch.setattr(controls, "Base", lambda: SimpleNamespace(paths=lambda _: None))
    search = SimpleNamespace(
        discover=SimpleNamespace(scene=None, rows=rows),
        work=SimpleNamespace(rows=rows),
        comparison=SimpleNamespace(ensemble=lambda *_: made, crowding=lambda _: 1.0),
        choice=Choice(
            names=("material-delay",),
            others=("delays",),
            shifts_m={"delays": np.full(60, -0.2)},
        ),
        seed=0,
    )
    top = SimpleNamespace(cell=SimpleNamespace(observable="error_m"))
    found = controls.negative_control(search, (), Walls(), top)  # type: ignore[arg-type]
    assert found.passed is True
