"""Causes that a table's design cannot tell apart stand beside each other, the others do not."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.select.candidates import library, offered
from bench.discrepancy.select.state import Search
from bench.discrepancy.sets.choose import chosen
from bench.discrepancy.sets.evidence import Evidence
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern
from bench.physics.effects.ranging.power_bias import PowerBias
from bench.physics.scene import scene

LINKS, ROWS, PER_PPM_AND_S = 30, 4, 149.9


def rows_of(seed: int, **fixed: float) -> pd.DataFrame:
    """Return rows in which everything varies but for what is `fixed`."""
    rng, link = np.random.default_rng(seed), np.repeat(np.arange(LINKS), ROWS)
    varied = {
        "true_range_m": rng.uniform(3, 20, LINKS),
        "reply_time_s": rng.choice([3e-4, 1e-3, 2e-3], LINKS),
        "azimuth_deg": rng.uniform(-180, 180, LINKS),
    }
    columns = {name: np.full(LINKS, fixed.get(name, value)) for name, value in varied.items()}
    frame = pd.DataFrame({name: value[link] for name, value in columns.items()})
    ends = {"tx": [f"t{i % 3}" for i in link], "rx": [f"a{i % 4}" for i in link]}
    return frame.assign(link=[f"l{i}" for i in link], **ends)


def names_of(frame: pd.DataFrame, shift_m: np.ndarray | float) -> set[str]:
    """Return the names that are left open for a shift of the ranges."""
    rng = np.random.default_rng(9)
    links = link_codes(frame)

    def written(shift: np.ndarray | float) -> pd.DataFrame:
        error = shift + rng.normal(0, 0.02, len(frame)) + rng.normal(0, 0.01, LINKS)[links]
        return frame.assign(error_m=error, range_m=frame["true_range_m"] + error)

    recorded, simulated = written(shift_m), pd.concat([written(0.0) for _ in range(3)])
    rows = view(recorded, links, np.arange(len(frame)), Window(), None, False)
    kinds, _ = offered(library()[0], recorded, False, False)
    comparison = TableComparison(simulated.reset_index(drop=True), Window())
    found = chosen(Search(comparison, rows, rows, kinds, 0, work=rows), ())
    return {one for name in found.names for one in (name, *found.rivals[name])}


@pytest.mark.parametrize(
    ("fixed", "left_open"),
    [
        ({"reply_time_s": 1e-3}, {"antenna-delay", "clock-offset"}),
        ({"azimuth_deg": 30.0}, {"antenna-delay", "antenna-pattern"}),
        ({"true_range_m": 9.0}, {"antenna-delay", "range-scale"}),
        ({}, {"antenna-delay"}),
    ],
)
def test_what_never_varies_leaves_its_causes_open(fixed: dict[str, float], left_open: set) -> None:
    assert names_of(rows_of(1, **fixed), 0.11) == left_open


def test_a_clock_is_named_alone_where_reply_times_vary() -> None:
    frame = rows_of(2)
    shift = 0.75 * PER_PPM_AND_S * frame["reply_time_s"].to_numpy()
    assert names_of(frame, shift) == {"clock-offset"}


def test_one_value_must_do_it_and_be_of_a_usual_size() -> None:
    rng = np.random.default_rng(0)
    one, other = rng.normal(size=(2, 80, 1))
    blocks = {"same": (one,), "two": (one + other, one - other), "small": (1e-4 * one,)}
    evidence = Evidence(0.1 * one[:, 0] + rng.normal(0, 0.02, 80), np.arange(80), blocks)
    made = evidence.of(("same",))
    target = evidence.toward(evidence.response(made, "same"))
    far = {name: target.nearest(name, made)[0] for name in blocks}
    assert far["same"] < 0.1
    assert far["two"] > 10
    assert far["small"] > 10


def test_a_few_headings_all_around_are_enough_for_a_pattern() -> None:
    for headings, enough in (([30, 31], False), ([0, 90], False), ([0, 120, 240], True)):
        frame = pd.DataFrame({"true_range_m": 5.0, "azimuth_deg": headings})
        assert AntennaPattern.tellable(scene(frame)) == enough
        assert (AntennaPattern.unmarked(frame) == "") == enough


def test_levels_that_only_scatter_show_no_direction() -> None:
    level = -80 + 0.2 * np.random.default_rng(1).normal(size=60)
    rows = scene(pd.DataFrame({"true_range_m": np.ones(60), "rx_power_dbm": level}))
    assert PowerBias.possible(rows, 0.05 + 1e-3 * (level + 80))


@pytest.mark.parametrize(("mean_m", "beside"), [(0.04, set()), (0.3, {"antenna-delay"})])
def test_the_mean_of_a_pattern_is_no_delay_unless_it_is_large(mean_m: float, beside: set) -> None:
    frame = rows_of(4)
    turn = 0.2 * np.cos(np.radians(frame["azimuth_deg"].to_numpy()))
    assert names_of(frame, turn + mean_m) == {"antenna-pattern"} | beside
