"""The apartment case: small SIMULATED stand-ins, and the recordings themselves where they are."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from bench.challenge import apartment as case
from bench.challenge.api import REAL
from bench.challenge.mitigation import ROWS, Effort, Mitigated, mitigated, training_geometry
from bench.challenge.real.case import Check, RealCase
from bench.cli import challenge as cli
from bench.discrepancy import Options
from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.data.split import split_links
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.obstructed_path import ObstructedPath
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.plugins import load
from bench.recordings.table import Recordings

HIDDEN = (
    DiffuseTail(level_db=-8, distance_exponent=0.3),
    LevelControl(),
    ObstructedPath(share=0.5, loss_db=18, detour_m=0.6),
    AntennaDelay(delay_ns=1.6),
)
QUICK = Effort(seeds=(0,), links=150, epochs=8)
RUNNER = CliRunner()


def _flat(links: int = 12, rows: int = 6) -> Recordings:
    """Return a SIMULATED table that plays the apartment."""
    rng = np.random.default_rng(8)
    link = np.repeat(np.arange(links), rows)
    frame = pd.DataFrame(
        {
            "link": [f"anchor {i % 4} - tag {i}" for i in link],
            "tx": "tag",
            "rx": "anchor",
            "true_range_m": rng.uniform(1.5, 6, links)[link],
            "los": rng.uniform(size=links)[link] < 0.5,
        }
    )
    simulator = Simulator(replace(Base(keep_count=0), cir_samples=170, cir_lead=12), HIDDEN)
    made = simulator.observe(scene(frame), 31).table(frame)
    return Recordings(made, "stand-in")


def test_training_rows_hold_geometry_alone() -> None:
    known = _flat().frame
    made = training_geometry(known, 3, 20)
    assert len(made) == 20 * ROWS
    assert set(made.columns) == {"link", "true_range_m", "tx", "rx"}
    assert made["link"].nunique() == 20
    assert not set(made["link"]) & set(known["link"])
    assert made["true_range_m"].between(0.7 * 1.5, 1.3 * 6).all()
    assert made.equals(training_geometry(known, 3, 20))


def test_the_right_simulator_trains_the_better_network() -> None:
    table = _flat(16, 10)
    split = split_links(table.frame, 0)
    simulators = case.ORIGINAL, replace(case.ORIGINAL, effects=HIDDEN)
    found = mitigated(table, split.work, split.confirm.open(), simulators, 0, QUICK)
    assert found.after.value < found.before.value
    assert found.over_before.value == pytest.approx(found.before.value - found.after.value)
    assert found.over_raw.value == pytest.approx(found.raw.value - found.after.value)
    assert len(found.links) == 4
    assert found.simulated_rows == 150 * ROWS


def test_auc_of_perfect_and_of_no_separation() -> None:
    label = np.repeat(["line of sight", "obstructed"], 10)
    perfect = pd.DataFrame({"log_odds": np.arange(20.0), "label": label})
    assert case.auc_interval(perfect, 0).value == 1.0
    mixed = pd.DataFrame({"log_odds": np.tile(np.arange(10.0), 2), "label": label})
    nothing = case.auc_interval(mixed, 0)
    assert nothing.value == 0.5
    assert nothing.low < 0.4 < 0.6 < nothing.high


@pytest.fixture(scope="module")
def small() -> RealCase:
    """Return the case on a stand-in with two effects in the library, so that it is quick."""
    kinds = {"level-control": LevelControl, "antenna-delay": AntennaDelay}
    real = case.diagnose

    def short(*args: object, **known: object) -> object:
        return real(*args, kinds=kinds, **known)

    options = Options(0, search_rows=80, fit_rows=60, observables=("error_m", "preamble_count"))
    effort = Effort(seeds=(0,), links=10, epochs=1)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(case, "diagnose", short)
        return case.apartment(_flat(), 0, lambda _: None, options, effort)


def test_labels_are_hidden_and_every_bar_is_shown(small: RealCase) -> None:
    assert "los" not in small.diagnosis.confirmed.view.frame
    asked = {check.asked: check for check in small.checks}
    assert len(small.checks) == 8
    assert asked["finds the constant delay"].met
    assert not asked["finds the receiver's level control"].met  # 12 links of 6 rows are too few
    assert not asked["finds the diffuse tail"].met
    struck = next(check for check in small.checks if "which links" in check.asked)
    assert not struck.met
    assert "no obstruction was found" in struck.measured


def test_the_ladder_tells_gains_and_what_would_be_missed(small: RealCase) -> None:
    text = "\n".join(small.lines)
    assert "| 1 | " in text
    assert "gains most" in text
    assert "SIMULATED rows alone" in text
    assert "original - diagnosed, paired" in text


def test_mitigation_bars_need_intervals_above_zero() -> None:
    better, unsure = Estimate(0.3, 0.1, 0.5, "m"), Estimate(0.1, -0.1, 0.3, "m")
    mae = Estimate(0.5, 0.4, 0.6, "m")
    made = Mitigated(mae, mae, mae, better, unsure, pd.DataFrame({"link": ["a"]}), 10)
    assert [check.met for check in case._trained_checks(made)] == [True, False]


def _made(small: RealCase) -> object:
    return lambda table, seed, tell: small


def test_cli_writes_a_report_with_figures(small, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("bench.challenge.api.open_recordings", lambda name: (_flat(), None))
    monkeypatch.setitem(REAL, "apartment", _made(small))
    out = RUNNER.invoke(cli.command, ["--case", "apartment", "-o", str(tmp_path)])
    assert out.exit_code == 0, out.output
    text = (tmp_path / "apartment.md").read_text()
    assert "| asked | measured | met |" in text
    assert "**no**" in text
    assert (tmp_path / "apartment" / "ladder.png").exists()
    assert (tmp_path / "apartment" / "simulator.toml").exists()


def test_cli_json_and_a_data_set_that_is_not_here(small, tmp_path, monkeypatch) -> None:
    def opened(name: str) -> tuple[Recordings, None]:
        if name != "apartment":
            raise BenchError(f"{name} is not here")
        return _flat(), None

    monkeypatch.setattr("bench.challenge.api.open_recordings", opened)
    monkeypatch.setitem(REAL, "apartment", _made(small))
    out = RUNNER.invoke(cli.command, ["--real", "--json", "-o", str(tmp_path)])
    assert out.exit_code == 0, out.output
    scores = json.loads(out.stdout)
    assert {score["case"] for score in scores} == {"apartment, labels hidden"}
    assert "Not run: ghent is not here" in (tmp_path / "real.md").read_text()


def test_cli_blind_cases_seal_run_and_report(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("bench.challenge.api.run_blind", lambda *_: [])
    monkeypatch.setattr("bench.challenge.api.rates", lambda _: [SimpleNamespace(
        words="false alarms", hits=0, cases=2, bar="at most 5 %", met=True, interval=(0.0, 0.6),
        causes={})])  # fmt: skip
    monkeypatch.setattr("bench.challenge.api.blind_markdown", lambda *_: ["table"])
    out = RUNNER.invoke(cli.command, ["--cases", "2", "--json", "-o", str(tmp_path)])
    assert out.exit_code == 0, out.output
    assert json.loads(out.stdout)[0]["met"] is True
    assert "sha256" in out.stderr
    assert (tmp_path / "blind.md").read_text().endswith("table\n")


def test_cli_page_holds_blind_and_real_cases(small, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("bench.challenge.api.open_recordings", lambda _: (_flat(), None))
    for name in REAL:
        monkeypatch.setitem(REAL, name, _made(small))
    monkeypatch.setattr("bench.challenge.api.run_blind", lambda *_: [])
    monkeypatch.setattr("bench.challenge.api.rates", lambda _: [])
    monkeypatch.setattr("bench.challenge.api.blind_markdown", lambda *_: ["## Blind"])
    page = tmp_path / "challenge.md"
    asked = ["--cases", "2", "--page", str(page), "-o", str(tmp_path / "out")]
    out = RUNNER.invoke(cli.command, asked)
    assert out.exit_code == 0, out.output
    text = page.read_text()
    assert text.startswith("# Challenge\n")
    assert "## Blind" in text
    assert text.count("## apartment, labels hidden") == len(REAL)


def test_cli_help_has_examples_and_bad_input_is_one_line() -> None:
    text = RUNNER.invoke(cli.command, ["--help"]).output
    assert "bench challenge --case miluv" in text
    wrong = RUNNER.invoke(cli.command, ["--case", "nowhere"])
    assert wrong.exit_code == 2
    assert "nowhere" in wrong.output


def test_checks_say_what_they_measured(small: RealCase) -> None:
    assert all(isinstance(check, Check) and check.measured for check in small.checks)


@pytest.mark.skipif("BENCH_DATA" not in os.environ, reason="needs the public recordings")
def test_recorded_links_are_told_apart_and_mitigated() -> None:
    from bench.recordings.open import open_recordings

    table = open_recordings("apartment")[0]
    table = table.select(np.arange(0, len(table.frame), 12))
    shown = table.frame[[name for name in case.SEEN if name in table.frame]]
    stand_in = SimpleNamespace(added=HIDDEN)
    told = case.separation(stand_in, shown, table.frame["los"].to_numpy(bool), 0)
    assert told is not None
    assert told.auc.value > 0.75
    split = split_links(shown, 0)
    simulators = case.ORIGINAL, replace(case.ORIGINAL, effects=HIDDEN)
    found = mitigated(table, split.work, split.confirm.open(), simulators, 0, QUICK)
    assert found.over_raw.value > 0.1
    assert load("models", "remnet")().training_recipe().loss == "mae"
