"""What is found beside named effects, but not beside the set they are of, is a form of theirs."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.select import left_by_names as module
from bench.discrepancy.select.state import Selection
from bench.discrepancy.select.unnamed import with_mean
from bench.discrepancy.sets.choice import MERE, Choice
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter

NAMED = (RangeScale(scale=0.002),)
SHIFT = {"range-scale": np.ones(6)}


@pytest.mark.parametrize(
    ("choice", "observable", "found", "of_form"),
    [
        (Choice(("range-scale",), shifts_m=SHIFT), "error_m", False, True),
        (Choice(("range-scale",), shifts_m=SHIFT), "error_m", True, False),
        (Choice(("range-scale",), shifts_m=SHIFT), "rx_power_dbm", False, False),
        (Choice(("range-scale",), (MERE,), shifts_m=SHIFT), "error_m", False, False),
        (Choice(("range-scale",), ("a law",), shifts_m=SHIFT), "error_m", False, False),
        (Choice(("time-lag",), shifts_m=SHIFT), "error_m", False, False),
        (Choice(), "error_m", False, False),
    ],
)
def test_a_form_is_nothing_without_a_name(
    monkeypatch: pytest.MonkeyPatch, choice: Choice, observable: str, found: bool, of_form: bool
) -> None:
    beside = []

    def left(search: SimpleNamespace, added: tuple[object, ...]) -> SimpleNamespace:
        beside.append((search.comparison.shift_m.tolist(), added))
        return SimpleNamespace(significant=found)

    monkeypatch.setattr(module, "ranges_left", left)
    monkeypatch.setattr(
        module, "replace", lambda _, comparison: SimpleNamespace(comparison=comparison)
    )
    jitter = TimestampJitter()
    search = SimpleNamespace(
        choice=choice, work=SimpleNamespace(rows=np.arange(6)), comparison=None, kinds={}
    )
    cell = SimpleNamespace(observable=observable, moment="mean")
    last = SimpleNamespace(located=SimpleNamespace(findings=(SimpleNamespace(cell=cell),)))
    said = module.left_by_names(search, (*NAMED, jitter), last)  # type: ignore[arg-type]
    assert said is of_form
    assert all(one == ([1.0] * 6, (jitter,)) for one in beside)


@pytest.mark.parametrize(
    ("name", "constant_m", "theirs"),
    [("ground-bounce", 0.02, True), ("ground-bounce", 0.04, False), ("range-scale", 0.02, False)],
)
def test_what_goes_up_and_down_has_a_mean(name: str, constant_m: float, theirs: bool) -> None:
    """A constant beside it is its own where that is smaller: it is in the simulator, unsaid."""
    waves = 0.03 * np.sin(np.linspace(0, 20, 200))
    choice = Choice((name,), (MERE,), shifts_m={name: waves, MERE: np.full(200, constant_m)})
    search = SimpleNamespace(choice=choice, work=SimpleNamespace(rows=np.arange(200)))
    seen = SimpleNamespace(cell=SimpleNamespace(observable="error_m"))
    located = SimpleNamespace(findings=(seen,))
    found = Selection((SimpleNamespace(names=(name,)),), (), (SimpleNamespace(located=located),))  # type: ignore[arg-type]
    assert with_mean(search, found).mean == ((seen,) if theirs else ())  # type: ignore[arg-type]


@pytest.mark.parametrize(("found", "theirs"), [(False, True), (True, False)])
def test_what_another_form_of_a_name_leaves_is_modelled_too(
    monkeypatch: pytest.MonkeyPatch, found: bool, theirs: bool
) -> None:
    """A drift of crystals that is a cubic of the temperature, of which the library has the line."""
    monkeypatch.setattr(module, "ranges_left", lambda *_: SimpleNamespace(significant=found))
    monkeypatch.setattr(module, "replace", lambda search, **_: search)
    choice = Choice(("range-scale",), shifts_m=SHIFT)
    search = SimpleNamespace(
        choice=choice, work=SimpleNamespace(rows=np.arange(6)), comparison=None, kinds={}
    )
    seen = SimpleNamespace(cell=SimpleNamespace(observable="error_m"))
    turn = SimpleNamespace(located=SimpleNamespace(findings=(seen,)))
    said = Selection((SimpleNamespace(names=("range-scale",)),), NAMED, (turn,))  # type: ignore[arg-type]
    assert with_mean(search, said).mean == ((seen,) if theirs else ())  # type: ignore[arg-type]
