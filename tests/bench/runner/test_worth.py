"""What a diagnosis is worth: the split, the ways, the table, going on where it was stopped."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import bench
from bench.cli.main import main
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.simulator import Simulator
from bench.physics.toml_file import to_toml
from bench.recordings.io import write_recordings
from bench.recordings.open import read
from bench.runner.diagnosis_inputs import write_inputs
from bench.runner.worth import learners
from bench.runner.worth.scores import Scored
from bench.runner.worth.site import site
from bench.runner.worth.table import ALL, Split, table

PLAIN = Simulator(Base(), name="base")
RIGHT = PLAIN.with_effect(AntennaDelay(delay_ns=2.0))  # 0.3 m


def recordings(links: int = 12, rows: int = 6) -> pd.DataFrame:
    link = np.repeat(np.arange(links), rows)
    frame = pd.DataFrame({"link": [f"l{i}" for i in link], "tx": "a", "rx": "b"})
    frame["true_range_m"] = np.linspace(2, 9, links)[link]
    return RIGHT.simulate(frame, 5).frame


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder as a diagnosis writes it, of a delay that the simulator leaves out."""
    folder = tmp_path_factory.mktemp("diagnosis")
    write_recordings(replace(read(recordings()), source="mine"), folder / "mine.parquet")
    table = read(folder / "mine.parquet")
    write_inputs(folder, folder / "mine.parquet", None, None, table, PLAIN, Base())
    (folder / "simulator.toml").write_text(to_toml(RIGHT))
    (folder / "diagnosis.json").write_text(json.dumps({"seed": 3}))
    return folder


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have little simulated and trained: what is learnt is a constant."""
    monkeypatch.setattr("bench.runner.worth.site.SIMULATED_LINKS", 40)
    monkeypatch.setattr("bench.runner.worth.learners.STEPS", 100)
    monkeypatch.setattr("bench.runner.further.STEPS", 60)


def test_sealed_links_are_no_others_and_simulated_rows_hold_nothing_measured(diagnosed: Path):
    here = site(diagnosed)
    assert not set(here.sealed.names) & set(here.survey.names)
    assert len(here.sealed.names) + len(here.survey.names) == 12
    assert abs(np.median(here.before.errors_m)) < 0.1
    assert np.median(here.after.errors_m) == pytest.approx(0.3, abs=0.1)
    assert here.after.rows.shape[1] == here.sealed.rows.shape[1]


def test_a_diagnosed_simulator_teaches_what_the_original_does_not(diagnosed: Path):
    made = bench.worth(diagnosed, links=[2], draws=1)
    assert made.done == made.planned == 3
    assert made.left["after", 2].value < 0.5 * made.left["before", 2].value
    assert made.left["none", ALL].value == pytest.approx(0.3, abs=0.1)
    assert made.left["constant", 2].value < 0.15
    assert made.paired["after+offset", 2].low <= made.paired["after+offset", 2].value


def test_what_remains_of_the_mismatch_is_shown(diagnosed: Path, capsys, monkeypatch):
    found = {one.figure: one for one in bench.worth(diagnosed, links=[2], draws=1).remains}
    middle = found["error, 50th percentile"]
    assert (middle.unit, middle.recorded) == ("m", pytest.approx(0.3, abs=0.05))
    assert middle.original == pytest.approx(0.0, abs=0.05)
    assert middle.diagnosed == pytest.approx(0.3, abs=0.05)
    assert all(abs(one.recorded) <= 1 for one in found.values() if one.unit == "1")
    words = ["bench", "worth", "--diagnosis", str(diagnosed), "--links", "2", "--draws", "1"]
    monkeypatch.setattr("sys.argv", words)
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 0
    assert "what remains" in capsys.readouterr().out


def test_what_is_done_is_not_done_again(diagnosed: Path, monkeypatch: pytest.MonkeyPatch):
    first = bench.worth(diagnosed, links=[2], draws=1)
    for trained in ("MLPRegressor", "HistGradientBoostingRegressor"):
        monkeypatch.setattr(learners, trained, None)
    monkeypatch.setattr("bench.runner.worth.api.simulated", lambda _: {})
    assert bench.worth(diagnosed, links=[2], draws=1) == first


def test_time_that_is_up_is_said(diagnosed: Path, capsys, monkeypatch: pytest.MonkeyPatch):
    (diagnosed / "worth.json").unlink(missing_ok=True)
    monkeypatch.setattr("sys.argv", ["bench", "worth", "--diagnosis", str(diagnosed), "--minutes",
                                     "1e-9"])  # fmt: skip
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 0
    assert "NOT FINISHED" in capsys.readouterr().out


def test_a_link_of_several_splits_is_one_link_of_the_interval():
    def scores(real: float, tuned: float) -> tuple[Scored, ...]:
        return (Scored("real", 2, 0, {"a": real, "b": real + 1}),
                Scored("after+tuned", 2, 0, {"a": tuned, "b": tuned + 1}))  # fmt: skip

    splits = [Split(seed, 9, scores(1.0, 0.4)) for seed in range(5)]
    made = table(splits, (2,), 5)
    assert made.sealed_links == 2
    assert made.left["real", 2].value == pytest.approx(1.5)
    assert made.left["real", 2].high > 1.9  # two links, not ten
    assert made.paired["after+tuned", 2].value == pytest.approx(0.6)


def test_bad_input_is_one_line(diagnosed: Path, tmp_path: Path):
    for given, message in (
        ({"diagnosis": tmp_path}, "no diagnosis there"),
        ({"diagnosis": diagnosed, "links": [0]}, "--links 0"),
        ({"diagnosis": diagnosed, "draws": 0}, "--draws 0"),
        ({"diagnosis": diagnosed, "minutes": 0}, "--minutes 0"),
        ({"diagnosis": []}, "no diagnosis named"),
        ({"diagnosis": [diagnosed, diagnosed]}, "twice"),
    ):
        with pytest.raises(BenchError, match=message) as told:
            bench.worth(**given)
        assert "\n" not in str(told.value)
    other = recordings().drop(columns="error_m").assign(noise_std=1.0)
    with pytest.raises(BenchError, match="other rows than were diagnosed"):
        bench.worth(diagnosed, recorded=other)
