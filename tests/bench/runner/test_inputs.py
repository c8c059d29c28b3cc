"""What a model reads against what a table has: rows, reasons, and tables without a CIR."""

from __future__ import annotations

from pathlib import Path

import constant_graphs
import numpy as np
import pandas as pd
import pytest

import bench
from bench.recordings.table import Recordings
from bench.runner.folder import ResultFolder
from bench.runner.inputs import missing, rows_for
from bench.runner.intervals import intervals_of
from bench.runner.material import load_material
from zoo import Constant, ConstantByLevel, GradientBoosting, NoMitigation, REMnet


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Time nothing."""
    monkeypatch.setattr("bench.runner.api.time_artifacts", lambda *_, **__: ([], []))


@pytest.fixture
def by_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    """Write the graphs of constants by hand."""
    monkeypatch.setattr("backends.export.export_module", constant_graphs.export_module)


def table(rows: int = 120, levels: bool = True) -> Recordings:
    rng = np.random.default_rng(0)
    links = np.repeat(np.arange(rows // 10), 10)
    blocked = rng.random(rows // 10)[links]
    frame = pd.DataFrame({"true_range_m": rng.uniform(2, 9, rows), "link": links.astype(str)})
    frame["range_m"] = frame["true_range_m"] + 0.4 * blocked
    frame["los"] = blocked < 0.5
    if levels:
        frame["rx_power_dbm"] = -80 - 10 * blocked
        frame.loc[3, "rx_power_dbm"] = -np.inf
    return Recordings(frame, "made up")


def test_rows_hold_the_blocks_and_nan_where_nothing_is_known() -> None:
    material = load_material(table(), "link-kfold:3")
    rows = rows_for(material, ("levels", "range"))
    assert rows.dtype == np.float32
    assert rows.shape == (120, 9)
    assert np.isnan(rows[3]).sum() == 8
    assert np.isnan(rows[4]).sum() == 7
    np.testing.assert_allclose(rows[:, 8], material.recordings.frame["range_m"], rtol=1e-6)
    assert rows_for(material, ("cir",)).shape == (120, 1)  # a row to count, for the floors


def test_a_model_that_lacks_what_it_reads_says_what() -> None:
    bare = load_material(table(levels=False), "link-kfold:3")
    assert missing(bare, REMnet) == "made up has no CIR, which REMnet reads"
    reason = missing(bare, ConstantByLevel)
    assert reason is not None
    assert "no levels (rx_power_dbm," in reason
    for model in (NoMitigation, Constant, GradientBoosting):
        assert missing(bare, model) is None


def test_a_column_that_a_model_cannot_do_without_is_named() -> None:
    recordings = table(levels=False)
    recordings.frame["preamble_count"] = 100
    material = load_material(recordings, "link-kfold:3")
    assert missing(material, GradientBoosting) is None
    said = "made up has no rx_power_dbm, which ConstantByLevel reads"
    assert missing(material, ConstantByLevel) == said


@pytest.mark.slow
def test_a_table_without_a_cir_runs_every_model_that_needs_none(
    quick: None, tmp_path: Path
) -> None:
    done = bench.run(
        "none,constant,constant-by-level,gbm,remnet", "fp32", table(), split="link-kfold:3",
        out=tmp_path / "r",
    )  # fmt: skip
    assert not done.failures
    status = {run.key.model: run for run in done.runs}
    assert status["remnet"].reason == "made up has no CIR, which REMnet reads"
    maes = {name: run.nlos.mae_m.value for name, run in status.items() if run.nlos}
    assert set(maes) == {"none", "constant", "constant-by-level", "gbm"}
    assert maes["gbm"] < maes["constant"] < maes["none"]


@pytest.mark.slow
def test_a_deviation_goes_with_the_predictions_and_intervals_are_made_of_them(
    quick: None, by_hand: None, tmp_path: Path
) -> None:
    done = bench.run("gp,constant", "fp32", table(), split="link-kfold:2", out=tmp_path / "r")
    assert not done.failures
    found = {run.key.model: intervals_of(ResultFolder(done.folder), run, 0.8) for run in done.runs}
    assert found["constant"].crps_m is None
    assert found["gp"].crps_m is not None
    assert 0.5 < found["gp"].coverage <= 1
    assert found["gp"].half_width_m < found["constant"].half_width_m


@pytest.mark.slow
def test_a_guarded_model_has_a_name_of_its_own_and_floors_stay(quick: None, tmp_path: Path) -> None:
    done = bench.run(
        "gp,constant", "fp32", table(), split="link-kfold:2", out=tmp_path / "r", guard=True
    )
    assert not done.failures
    scores = {run.key.model: run.los for run in done.runs}
    assert set(scores) == {"gp+guard", "constant"}
    guarded = scores["gp+guard"]
    assert guarded is not None
    assert guarded.mae_m.value <= guarded.raw_mae_m + 0.02


def test_what_is_sent_to_another_process_has_the_same_rows_without_recorded_cirs() -> None:
    rng = np.random.default_rng(0)
    whole = table()
    cirs = list(rng.rayleigh(50.0, (len(whole), 157)).astype(np.float32))
    here = load_material(
        Recordings(whole.frame.assign(cir=cirs, first_path_index=5.0), "t"), "link-kfold:2"
    )
    there = here.sent()
    assert "cir" not in there.recordings.frame
    assert there.fingerprint == here.fingerprint
    for model in (REMnet, ConstantByLevel, GradientBoosting):
        assert missing(there, model) is None
        same = rows_for(there, model.reads), rows_for(here, model.reads)
        assert np.array_equal(*same, equal_nan=True)
