"""A late detection that held-out links do without goes with what was fitted beside it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from bench.discrepancy.joint import turn
from bench.discrepancy.select.state import Selection, State
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern
from bench.physics.effects.ranging.power_bias import PowerBias
from bench.physics.effects.receiver.late_detection import LateDetection


class Asked:
    """A search that knows what it may name."""

    def __init__(self, kinds: tuple[str, ...]) -> None:
        self.kinds = kinds

    def without(self, effect: Any) -> Asked:
        """Return the search without an effect."""
        return Asked(tuple(name for name in self.kinds if name != effect.name))


@pytest.mark.parametrize(("kept", "named"), [(True, True), (False, True), (False, False)])
def test_what_was_fitted_beside_a_late_detection_is_asked_anew_without(
    kept: bool, named: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And keeps its name where nothing has one without it: few late rows help no link held out."""
    asked = []

    def said(state: State, _: Any) -> Selection:
        late = LateDetection.name in state.search.kinds
        asked.append(late)
        added = (PowerBias(), *((LateDetection(),) if late and kept else ()))
        names = (PowerBias.name, *((LateDetection.name,) if late else ()))
        other: Any = SimpleNamespace(names=(PowerBias.name,) if named else ())
        return Selection((other,), added, (), together=names)

    monkeypatch.setattr(turn, "_as_indices_say", said)
    state: Any = State(Asked((LateDetection.name,)))  # type: ignore[arg-type]
    found = turn._selected(state, None)  # type: ignore[arg-type]
    assert asked == ([True] if kept else [True, False])
    assert (LateDetection.name in found.together) is (kept or not named)


def test_waveforms_of_any_simulator_see_a_patterns_gain_alone() -> None:
    frame = SimpleNamespace(columns=("azimuth_deg",))
    search: Any = SimpleNamespace(fit=SimpleNamespace(frame=frame), comparison=object())
    assert turn.in_waveforms(AntennaPattern, search).name == "pattern-gain"
    assert turn.in_waveforms(LateDetection, search) is LateDetection
