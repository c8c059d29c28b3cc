"""Another simulator's detector is learned from its own first paths, and used where effects act."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from physics_scenes import line

from bench.physics import ForeignTable, Simulator
from bench.physics.detection import first_path
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.own_detector import Crossing, crossing
from bench.physics.units import C_M_PER_NS

TIMES, PART = 9.0, 0.3
LOUD = 30.0


def timed(by: Crossing, weaker_db: float = 0.0) -> pd.DataFrame:
    """Return a table whose detector times edges where they cross a level; SIMULATED."""
    simulator = (
        Simulator() if not weaker_db else Simulator(effects=(PathLoss(offset_db=weaker_db),))
    )
    frame = simulator.simulate(line(400, far_m=30.0, los=True)).frame
    cir = np.stack(frame["cir"].to_list())
    index = by.found(cir, frame["noise_std"].to_numpy())
    moved_m = (index - frame["first_path_index"]) * frame["sample_period_ns"] * C_M_PER_NS
    return frame.assign(first_path_index=index, range_m=frame["range_m"] + moved_m)


@pytest.mark.parametrize("by", [Crossing(TIMES, 0.0), Crossing(3.0, PART)], ids=["noise", "peak"])
def test_where_a_detector_times_edges_is_learned(by: Crossing) -> None:
    found = ForeignTable(timed(by)).timing
    assert found is not None
    if by.of_peak:
        assert found.of_peak == pytest.approx(PART, abs=0.06)
    else:
        assert found.of_noise == pytest.approx(TIMES, rel=0.15)


def test_what_it_asks_for_beside_a_part_of_the_highest_is_learned_where_rows_tell() -> None:
    both = ForeignTable(timed(Crossing(LOUD, 0.12))).timing
    assert both is not None
    assert both.of_noise == pytest.approx(LOUD, rel=0.15)
    assert both.of_peak == pytest.approx(0.12, abs=0.01)


def test_a_table_tells_other_rows_of_its_simulator_how_edges_are_timed() -> None:
    whole = ForeignTable(timed(Crossing(TIMES, 0.0)))
    few = ForeignTable(whole.frame.iloc[:2], like=whole)
    assert few.timing == whole.timing


def test_a_detector_like_the_base_is_not_another_one() -> None:
    assert ForeignTable(Simulator().simulate(line(400, far_m=30.0)).frame).timing is None


def test_weaker_rows_are_later_where_edges_are_timed_by_the_noise() -> None:
    """Half of a peak knows nothing of that: late detection and an error of the level were named."""
    by = Crossing(TIMES, 0.0)
    frame, weaker = timed(by), timed(by, 12.0)
    found = ForeignTable(frame).observe((PathLoss(offset_db=12.0),))
    late_m = float(np.median(weaker["range_m"] - frame["range_m"]))
    assert late_m > 0.05
    assert np.median(found.range_m - frame["range_m"]) == pytest.approx(late_m, abs=0.02)


def test_an_index_that_tells_nothing_leaves_the_detector_of_the_base() -> None:
    rng = np.random.default_rng(3)
    magnitude = np.abs(rng.normal(0, 1, (300, 40))).astype(np.float32)
    magnitude[:, 20] += 30
    noise, index = np.ones(300), rng.uniform(5, 35, 300)
    assert crossing(magnitude, noise, index, first_path(magnitude, 10 * noise)) is None
    assert crossing(magnitude, noise, index * np.nan, index) is None
