"""Links that are struck by less than walls make are no sure blocked paths where none is listed."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select.unlisted import with_walls
from bench.discrepancy.select.verdict import Control, LeftOut
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.propagation.material_delay import MaterialDelay


@pytest.mark.parametrize(
    ("high_m", "listed", "names"),
    [
        (0.6, False, ("blocked-path", "material-delay")),
        (0.6, True, ("blocked-path",)),
        (1.9, False, ("blocked-path",)),
    ],
)
def test_short_detours_may_be_walls_that_nobody_listed(
    high_m: float, listed: bool, names: tuple[str, ...]
) -> None:
    detour = ParameterEstimate("detour_m", 0.4, 0.3, high_m, "m")
    said = LeftOut(BlockedPath(), (detour,), Estimate(9, 7, 11), 1.0, Control("", None))
    untried = {} if listed else {"material-delay": MaterialDelay}
    search = SimpleNamespace(fit=SimpleNamespace(waveform=False), untried=untried)
    assert with_walls(search, said).names == names  # type: ignore[arg-type]
