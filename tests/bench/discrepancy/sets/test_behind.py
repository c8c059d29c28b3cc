"""A law that acts only behind what a wall's delay is about is no other cause than walls."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.sets import formed
from bench.discrepancy.sets.formed import Formed
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.ranging.range_scale import RangeScale


@pytest.mark.parametrize(
    ("gate", "name", "another"),
    [
        ('(obstacles == "brick")', "material-delay", False),
        ("(los < 0.5)", "material-delay", False),
        ('(rx == "a2")', "material-delay", True),
        ('(obstacles == "brick")', "range-scale", True),
    ],
)
def test_a_law_behind_walls_is_about_walls(
    monkeypatch: pytest.MonkeyPatch, gate: str, name: str, another: bool
) -> None:
    monkeypatch.setattr(formed, "_within", lambda *_: False)
    over = frozenset({formed._gate(gate), "temperature_c"})
    law = Formed("a law", (np.ones((3, 1)),), 9.0, over, False, np.ones((3, 1)))
    kinds = {"material-delay": MaterialDelay, "range-scale": RangeScale}
    contest = SimpleNamespace(kinds=kinds)
    assert formed._another(contest, (name,), (name,), law) is another  # type: ignore[arg-type]
