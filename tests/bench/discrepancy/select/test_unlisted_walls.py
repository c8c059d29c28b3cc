"""Links that are struck by less than walls make are no sure blocked paths where none is listed."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

import bench
from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select.unlisted import with_edges, with_walls
from bench.discrepancy.select.verdict import Control, LeftOut, as_dict
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.propagation.diffraction import Diffraction
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.ranging.range_scale import RangeScale
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
    search = SimpleNamespace(fit=fit, every=fit, untried=untried, kinds={})
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
    search = SimpleNamespace(fit=fit, every=fit, untried={}, kinds=kinds)
    assert with_walls(search, said).names == names  # type: ignore[arg-type]


def of_walls(named: str) -> LeftOut:
    """Return a name of what goes through walls, or of what blocks."""
    effect = MaterialDelay() if named == "material-delay" else BlockedPath()
    detour = ParameterEstimate("detour_m", 0.4, 0.3, 0.6, "m")
    return LeftOut(effect, (detour,), Estimate(9, 7, 11), 1.0, Control("", None))


@pytest.mark.parametrize("named", ["material-delay", "blocked-path"])
@pytest.mark.parametrize(
    ("kind", "edge_m", "around"),
    [("crate", None, True), ("crate", 0.3, False), ("brick wall", None, False)],
)
def test_behind_objects_waves_may_go_around_where_edges_are_not_listed(
    named: str, kind: str, edge_m: float | None, around: bool
) -> None:
    rows = pd.DataFrame({"true_range_m": [4.0, 7.0, 9.0], "obstacles": [[kind], [], [kind]]})
    if edge_m is not None:
        rows["obstacle_clearance_m"] = [[edge_m], [], [edge_m]]
    kinds = {"diffraction": Diffraction}
    search = SimpleNamespace(searched=SimpleNamespace(scene=scene(rows)), kinds=kinds)
    (said,) = with_edges(search, (of_walls(named),))  # type: ignore[arg-type]
    assert said.names == ((named, "diffraction") if around else (named,))
    told = as_dict(said)["options"]
    assert told[0]["gain"]["value"] == 9
    assert [one["gain"] for one in told[1:]] == [None] * around  # was not tried: none of its own
    assert [one["values"] for one in told[1:]] == [{}] * around


def test_a_name_of_something_else_stays_alone_behind_objects() -> None:
    rows = pd.DataFrame({"true_range_m": [4.0, 7.0], "obstacles": [["rack"], ["rack"]]})
    kinds = {"diffraction": Diffraction}
    search = SimpleNamespace(searched=SimpleNamespace(scene=scene(rows)), kinds=kinds)
    said = LeftOut(RangeScale(0.01), (), Estimate(9, 7, 11), 1.0, Control("", None))
    assert with_edges(search, (said,)) == (said,)  # type: ignore[arg-type]


def of_walls_in_some_ways(seed: int) -> pd.DataFrame:
    """Return ranges of 80 links, half of them out of sight; SIMULATED."""
    rng = np.random.default_rng(seed)
    links = np.repeat(np.arange(80), 4)
    far_m = np.random.default_rng(3).uniform(4, 18, 80)
    frame = pd.DataFrame({"link": [f"L{n}" for n in links], "true_range_m": far_m[links]})
    frame = frame.assign(los=links % 2 == 0, rx_power_dbm=-60 - 20 * np.log10(far_m[links]))
    return frame.assign(range_m=frame["true_range_m"] + rng.normal(0, 0.02, len(links)))


@pytest.mark.filterwarnings("ignore")
def test_delays_of_every_links_own_out_of_sight_are_walls_or_what_blocks() -> None:
    recorded, simulated = of_walls_in_some_ways(1), of_walls_in_some_ways(2)
    links = pd.factorize(recorded["link"])[0]
    late_m = np.random.default_rng(4).uniform(0.02, 0.4, 80)[links]
    recorded["range_m"] += np.where(recorded["los"], 0.0, late_m)
    said = bench.diagnose(recorded, simulated).selection.names
    names = {name for one in said for name in one}
    assert {"blocked-path", "material-delay"} <= names
