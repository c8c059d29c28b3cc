"""What one obstacle of a kind adds is stated in metres, though no parameter is known by itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select.per_obstacle import told_by_obstacles
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.undetermined import undetermined
from bench.discrepancy.select.verdict import Control, LeftOut
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.ranging.range_scale import RangeScale
from tests.bench.discrepancy.numpy_tables import tables

STEPS_M = {"brick": 0.14, "drywall": 0.03}


def searched(seed: int, together: bool = False) -> Search:
    """Return a search of SIMULATED tables whose recorded ranges have a step per wall."""
    recorded, simulated = tables(seed)
    rng, frame = np.random.default_rng(seed), recorded.frame
    codes = link_codes(frame)
    brick, drywall = rng.binomial(2, 0.3, codes.max() + 1), rng.binomial(2, 0.3, codes.max() + 1)
    drywall = brick if together else drywall
    walls: list[object] = [
        ["brick"] * b + ["drywall"] * d for b, d in zip(brick, drywall, strict=True)
    ]
    step = STEPS_M["brick"] * brick[codes] + STEPS_M["drywall"] * drywall[codes]
    frame = frame.assign(error_m=frame["error_m"] + step, obstacles=[walls[code] for code in codes])
    every = np.arange(len(frame))
    seen = view(frame, codes, every, Window(), None, False)
    return Search(TableComparison(simulated.frame, Window()), seen, seen, {}, 0, work=seen)


def test_metres_of_every_kind_are_stated_with_intervals() -> None:
    held = []
    for seed in range(12):
        told = told_by_obstacles(searched(seed), (), MaterialDelay(), ())
        values = {one.name: one for one in told}
        assert set(values) == {"excess_m[brick]", "excess_m[drywall]"}
        held += [values[f"excess_m[{k}]"].low <= s <= values[f"excess_m[{k}]"].high
                 for k, s in STEPS_M.items()]  # fmt: skip
        assert values["excess_m[brick]"].high - values["excess_m[brick]"].low < 0.05
    assert np.mean(held) >= 0.7


def test_ranges_beside_waveforms_say_it_too() -> None:
    search = searched(1)
    seen = replace(search.fit, waveform=True)
    waves = replace(search, fit=seen, discover=seen, work=None)
    told = {one.name: one for one in told_by_obstacles(waves, (), MaterialDelay(), ())}
    assert set(told) == {f"excess_m[{kind}]" for kind in STEPS_M}
    assert told["excess_m[brick]"].value == pytest.approx(STEPS_M["brick"], abs=0.03)


def test_kinds_that_come_together_and_other_effects_have_none() -> None:
    assert told_by_obstacles(searched(1, together=True), (), MaterialDelay(), ()) == ()
    assert told_by_obstacles(searched(1), (), RangeScale(scale=0.01), ()) == ()


def test_a_step_that_is_known_determines_walls_whose_thickness_is_not() -> None:
    open_one = ParameterEstimate("thickness_scale", 1, 0, 4, "ratio", determined=False)
    none = Estimate(0.0, 0.0, 0.0, "nats")
    option = LeftOut(MaterialDelay(), (open_one,), none, 0.0, Control("", None), ())
    step = ParameterEstimate("excess_m[brick]", 0.14, 0.1, 0.18, "m")
    assert undetermined(option)
    assert not undetermined(replace(option, parameters=(step, open_one)))
