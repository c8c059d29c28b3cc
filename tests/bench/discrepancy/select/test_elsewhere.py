"""Effects on levels are there, too, where the others do nothing; a name needs what makes it one."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.skill import Tally
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select.candidates import Contender, Explanation
from bench.discrepancy.select.elsewhere import (
    beyond_marks,
    elsewhere_too,
    mixed_m,
    own_grids_m,
    used_m,
)
from bench.discrepancy.select.refute import _adequate_rival, idle
from bench.discrepancy.select.state import Round
from bench.physics.base import Base
from bench.physics.effects.propagation.fading import SmallScaleFading
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

SIMULATOR = Simulator(Base(), (TimestampJitter(),), 3)
STEEPER = PathLoss(exponent=2.6)


def rows(steeper: bool) -> View:
    """Return levels, weaker behind walls by more than the library's walls, or everywhere."""
    link = np.repeat(np.arange(60), 3)
    rng = np.random.default_rng(1)
    frame = pd.DataFrame(
        {"link": [f"l{i}" for i in link], "true_range_m": rng.uniform(3, 20, 60)[link]}
    )
    walls = ["brick" if i % 2 else "" for i in link]
    frame["obstacles"] = pd.Series([[w] if w else [] for w in walls], dtype=object)
    made = SIMULATOR.observe(scene(frame), 1, 1, cir=False).table(frame)
    weaker = -6 * np.log10(made["true_range_m"]) * (steeper | (link % 2 > 0))
    made["rx_power_dbm"] = made["rx_power_dbm"] + weaker
    return view(made, link_codes(made), np.arange(len(made)), Window(), None, False)


def with_error(seen: View, error_m: object) -> View:
    """Return the rows with other errors of the range, in metres."""
    frame = seen.frame.assign(error_m=error_m)
    frame["range_m"] = frame["true_range_m"] + frame["error_m"]
    return view(frame, seen.links, np.arange(len(frame)), Window(), None, False)


@pytest.mark.parametrize("steeper", [True, False])
def test_an_effect_on_levels_acts_without_walls_too(steeper: bool) -> None:
    seen = rows(steeper)
    tally = Tally(("error_m",), np.ones((4, 1)), np.ones((4, 1)))
    gain = Estimate(1, 0.5, 1.5)
    made = Explanation((Contender(STEEPER, tally, gain),), tally, gain, tally, {}, {})
    comparison = Resimulation(SIMULATOR, Window())
    search = SimpleNamespace(comparison=comparison, work=seen, searched=seen, seed=0)
    found = elsewhere_too(search, (MaterialDelay(),), made)  # type: ignore[arg-type]
    assert bool(found.contenders) is steeper


@pytest.mark.parametrize(("samples", "stays"), [(0.1, False), (0.6, True)])
def test_scatter_beside_a_rounding_is_more_than_another_form_of_it(
    samples: float, stays: bool
) -> None:
    seen = rows(False)
    error = 0.2 * np.random.default_rng(8).standard_normal(len(seen.rows))
    seen = with_error(seen, seen.frame["error_m"] + stays * error)
    gain = Estimate(1, 0.5, 1.5)
    tally = Tally(("error_m",), np.ones((4, 1)), np.ones((4, 1)))
    jitter = Contender(TimestampJitter(jitter_samples=samples), tally, gain)
    made = Explanation((jitter,), tally, gain, tally, {}, {})
    search = SimpleNamespace(
        comparison=Resimulation(Simulator(Base(), (), 3), Window()),
        work=seen, searched=seen, seed=0,
    )  # fmt: skip
    added = (RangeRounding(step_m=0.15),)
    assert bool(elsewhere_too(search, added, made).contenders) is stays  # type: ignore[arg-type]


@pytest.mark.parametrize("steps", [(0.12, 0.18), (0.06, 0.06)])
def test_devices_round_to_steps_of_their_own(steps: tuple[float, float]) -> None:
    rng, device = np.random.default_rng(2), np.arange(240) % 6
    step = np.where(device % 2 > 0, *steps)
    ranges = step * np.rint(rng.uniform(2, 30, 240) / step)
    groups = {f"rx=a{i}": device == i for i in range(6)}
    seen = SimpleNamespace(
        frame=pd.DataFrame({"range_m": ranges}), covariates=SimpleNamespace(groups=groups)
    )
    error = own_grids_m(seen, RangeRounding(step_m=0.06))  # type: ignore[arg-type]
    assert error == pytest.approx(np.sqrt(np.mean(np.square(steps)) / 12))


def test_scatter_that_is_wider_than_rows_scatter_is_no_more_than_they_do() -> None:
    seen = rows(False)
    rounding = RangeRounding(step_m=0.3)
    error = np.random.default_rng(4).uniform(-0.15, 0.15, (2, len(seen.rows))).sum(axis=0)
    seen = with_error(seen, error)
    gain = Estimate(1, 0.5, 1.5)
    tally = Tally(("error_m",), np.ones((4, 1)), np.ones((4, 1)))
    jitter = Contender(TimestampJitter(jitter_samples=0.6), tally, gain)
    made = Explanation((jitter,), tally, gain, tally, {}, {})
    search = SimpleNamespace(
        comparison=Resimulation(Simulator(Base(), (), 3), Window()),
        work=seen, searched=seen, seed=0,
    )  # fmt: skip
    assert not elsewhere_too(search, (rounding,), made).contenders  # type: ignore[arg-type]


def test_scatter_does_not_come_in_the_place_of_what_bears_a_mark() -> None:
    tally, gain = Tally(("error_m",), np.ones((4, 1)), np.ones((4, 1))), Estimate(1, 0.5, 1.5)
    rounding = RangeRounding(step_m=0.15)
    jitter = Contender(TimestampJitter(), tally, gain)
    made = Explanation((Contender(rounding, tally, gain), jitter), tally, gain, tally, {}, {})
    turn = Round(Located((), 0.002, 9.0, 3.0, 1, {}), made, rounding)
    assert _adequate_rival(None, (turn,), (rounding,), rounding, set()) is None  # type: ignore[arg-type]


def test_a_fading_that_scatters_nothing_is_none() -> None:
    assert SmallScaleFading.essential_on_paths == ("direct_m",)
    item = next(p for p in SmallScaleFading.parameters() if p.name == "direct_m")
    assert idle(item, ParameterEstimate("direct_m", 4.0, 2.0, 9.0, "1")) == ""
    assert "do as well" in idle(item, ParameterEstimate("direct_m", 900.0, 300.0, 1000.0, "1"))
    unsure = ParameterEstimate("direct_m", 4.0, 2.0, 9.0, "1", determined=False)
    assert "do as well" in idle(item, unsure)
    assert "bound" in idle(item, ParameterEstimate("direct_m", 0.51, 0.5, 0.6, "1"))


def test_marks_that_are_some_points_of_a_grid_are_as_far_off_as_from_mark_to_mark() -> None:
    rng = np.random.default_rng(4)
    true_m, noise_m = rng.uniform(5, 40, 400), rng.normal(0, 0.02, (4, 400))
    grid = RangeRounding(step_m=0.03)
    simulated = 0.03 * np.rint((true_m + noise_m[1:]) / 0.03)
    marks = 0.03 * np.cumsum(rng.choice([5, 11], 250))
    nearest = np.searchsorted((marks[1:] + marks[:-1]) / 2, true_m + noise_m[0])
    few = used_m(grid, marks[nearest], simulated)
    off = float(np.std(marks[nearest] - true_m - noise_m[0]))
    assert 0.6 * off < few < 1.6 * off
    every = 0.03 * np.rint((true_m + noise_m[0]) / 0.03)
    assert used_m(grid, every, simulated) == 0


@pytest.mark.parametrize(("share", "moves_m"), [(0.6, 0.15 / np.sqrt(12)), (0.0, 0.0)])
def test_ranges_of_which_most_are_rounded_to_three_steps(share: float, moves_m: float) -> None:
    """The others to their thirds: rows scatter as the coarse steps do, and that is no jitter."""
    rng, links = np.random.default_rng(8), np.repeat(np.arange(100), 5)
    true = rng.uniform(2, 30, 100)[links] + rng.normal(0, 0.02, len(links))
    step = np.where(rng.random(len(links)) < share, 0.15, 0.05)
    rows = SimpleNamespace(
        frame=pd.DataFrame({"range_m": np.rint(true / step) * step}), links=links
    )
    assert mixed_m(rows, RangeRounding(0.05)) == pytest.approx(moves_m)  # type: ignore[arg-type]


@pytest.mark.parametrize(("more_m", "stays"), [(0.0, False), (0.12, True)])
def test_what_simulated_rows_scatter_by_is_no_scatter_beside_a_rounding(
    more_m: float, stays: bool
) -> None:
    rng = np.random.default_rng(12)
    noisy = Simulator(Base(), (TimestampJitter(jitter_samples=0.25),), 3)
    link = np.repeat(np.arange(60), 5)
    frame = pd.DataFrame(
        {"link": [f"l{i}" for i in link], "true_range_m": rng.uniform(3, 20, 60)[link]}
    )
    made = noisy.observe(scene(frame), 1, 1, cir=False).table(frame)
    by_chance = made["range_m"] + more_m * rng.standard_normal(300)
    made["range_m"] = 0.12 * np.floor(by_chance / 0.12 + rng.random(300))  # up or down by chance
    made["error_m"] = made["range_m"] - made["true_range_m"]
    seen = view(made, link_codes(made), np.arange(300), Window(), None, False)
    search = SimpleNamespace(
        comparison=Resimulation(noisy, Window()), work=seen, searched=seen, seed=0
    )
    rounding, jitter = RangeRounding(step_m=0.12), TimestampJitter(jitter_samples=0.6)
    assert beyond_marks(search, (rounding,), jitter) is stays  # type: ignore[arg-type]
