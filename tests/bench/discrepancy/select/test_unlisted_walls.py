"""Links that are struck by less than walls make are no sure blocked paths where none is listed."""

from __future__ import annotations

from types import SimpleNamespace

import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select.unlisted import with_walls
from bench.discrepancy.select.verdict import Control, LeftOut
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.scene import scene


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
    fit = SimpleNamespace(waveform=False)
    search = SimpleNamespace(fit=fit, untried=untried, kinds={})
    assert with_walls(search, said).names == names  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("clear", "names"), [(False, ("blocked-path", "material-delay")), (True, ("blocked-path",))]
)
def test_walls_of_any_make_are_said_where_a_table_tells_only_which_ways_are_clear(
    clear: bool, names: tuple[str, ...]
) -> None:
    detour = ParameterEstimate("detour_m", 0.4, 0.3, 0.6, "m")
    said = LeftOut(BlockedPath(), (detour,), Estimate(9, 7, 11), 1.0, Control("", None))
    rows = pd.DataFrame({"true_range_m": [4.0, 7.0], "los": [True, clear]})
    fit = SimpleNamespace(waveform=False, scene=scene(rows))
    kinds = {"material-delay": MaterialDelay, "blocked-path": BlockedPath}
    search = SimpleNamespace(fit=fit, untried={}, kinds=kinds)
    assert with_walls(search, said, (BlockedPath(),)).names == names  # type: ignore[arg-type]
