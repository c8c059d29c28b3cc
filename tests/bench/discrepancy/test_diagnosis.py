"""Diagnoses from end to end: hidden physics is named, sized, modelled and confirmed."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

from bench.cli.diagnose import command
from bench.discrepancy import Options, diagnose
from bench.discrepancy.report.document import write_report
from bench.discrepancy.select.verdict import LeftOut, NoMismatch, Unknown
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.effects.fitted.device_clock import DeviceClock
from bench.physics.effects.fitted.unnamed import Unnamed
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.ranging.clock_offset import ClockOffset
from bench.physics.effects.ranging.law import Law
from bench.physics.effects.ranging.temperature import TemperatureDrift
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.effects.receiver.pulse_ringing import PulseRinging
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.physics.toml_file import from_toml, to_toml
from bench.recordings.io import write_recordings
from bench.recordings.table import Recordings

QUICK = Options(search_rows=400, fit_rows=160, observables=("error_m",), waveform=False)
KINDS = {
    "clock-offset": ClockOffset,
    "temperature-drift": TemperatureDrift,
    "material-delay": MaterialDelay,
}
BASE = Simulator(Base(), (TimestampJitter(),), 3, "mine")


def _rows(seed: int = 0, links: int = 48) -> pd.DataFrame:
    rng = np.random.default_rng(seed)
    link = np.repeat(np.arange(links), 8)
    return pd.DataFrame(
        {
            "link": [f"l{i}" for i in link],
            "true_range_m": rng.uniform(2, 20, links)[link],
            "tx": [f"t{i % 3}" for i in link],
            "rx": [f"r{i % 4}" for i in link],
            "reply_time_s": rng.uniform(2e-4, 1e-3, len(link)),
            "temperature_c": rng.uniform(0, 50, links)[link],
        }
    )


def _recorded(*hidden: Effect, seed: int = 0) -> Recordings:
    frame = _rows(seed)
    simulator = BASE
    for effect in hidden:
        simulator = simulator.with_effect(effect)
    made = simulator.observe(scene(frame), 50 + seed, cir=False).table(frame)
    return Recordings(made.drop(columns="clock_offset_ppm", errors="ignore"), "test")


@pytest.fixture(scope="module")
def warm():
    return diagnose(_recorded(TemperatureDrift(slope_mm_per_c=4.0)), BASE, QUICK, kinds=KINDS)


def test_names_the_hidden_effect_and_its_interval_holds_the_truth(warm):
    verdict = warm.selection.verdicts[0]
    assert isinstance(verdict, LeftOut)
    assert verdict.names == ("temperature-drift",)
    slope = next(p for p in verdict.parameters if p.name == "slope_mm_per_c")
    assert slope.low < 4.0 < slope.high
    assert slope.high - slope.low < 2.0


def test_confirm_links_are_better_after_and_nothing_significant_is_left(warm):
    seen = warm.confirmed
    assert seen.mae_after_m.high < seen.mae_before_m.low
    assert seen.gain.above_zero
    assert not warm.selection.rounds[-1].located.significant
    assert warm.split.confirm.opened


def test_the_new_simulator_runs_and_round_trips(warm):
    again = from_toml(to_toml(warm.simulator))
    assert again == warm.simulator
    assert "temperature-drift" in [effect.name for effect in again.effects]


def test_same_seed_same_diagnosis(warm):
    again = diagnose(_recorded(TemperatureDrift(slope_mm_per_c=4.0)), BASE, QUICK, kinds=KINDS)
    assert again.selection.verdicts == warm.selection.verdicts


def test_report_is_complete(warm, tmp_path):
    path = write_report(warm, tmp_path / "out")
    text = path.read_text()
    assert "Left out: temperature-drift" in text
    assert "SIMULATED" in text
    names = {file.name for file in path.parent.iterdir()}
    assert {"report.md", "diagnosis.json", "simulator.toml", "residual.png", "ladder.png"} <= names
    assert json.loads((path.parent / "diagnosis.json").read_text())["verdicts"]


def test_nothing_hidden_nothing_found():
    found = diagnose(_recorded(seed=1), BASE, QUICK, kinds=KINDS)
    verdict = found.selection.verdicts[0]
    assert isinstance(verdict, NoMismatch)
    assert 0 < verdict.detectable["error_m"] < 0.05
    assert found.added == ()


def test_crystals_are_found_per_device():
    found = diagnose(_recorded(ClockOffset(device_spread_ppm=3.0)), BASE, QUICK, kinds=KINDS)
    assert found.selection.verdicts[0].names == ("clock-offset",)
    clock = next(effect for effect in found.added if isinstance(effect, DeviceClock))
    assert len(clock.devices) == 7
    assert found.confirmed.mae_after_m.value < 0.2 * found.confirmed.mae_before_m.value


def test_an_effect_no_known_one_explains_is_unknown_and_modelled():
    recorded = _recorded()
    frame = recorded.frame.assign(humidity=np.random.default_rng(2).uniform(0, 1, 384))
    shift = 0.3 * ((frame["humidity"] - 0.5) ** 2 - 1 / 12)
    frame["error_m"] += shift
    frame["range_m"] += shift
    found = diagnose(
        replace(recorded, frame=frame), BASE, QUICK, kinds={"clock-offset": ClockOffset}
    )
    assert isinstance(found.selection.verdicts[0], Unknown)
    assert found.selection.names == ()
    assert found.law.form == "parabola"
    assert found.law.columns == ("humidity",)
    assert found.law.constants[0].value == pytest.approx(0.3, rel=0.1)
    assert any(isinstance(effect, Law) for effect in found.added)


def test_a_shape_that_no_law_has_is_a_curve():
    recorded = _recorded()
    frame = recorded.frame.assign(humidity=np.random.default_rng(2).uniform(0, 1, 384))
    shift = np.interp(frame["humidity"], [0, 0.2, 0.4, 0.5, 0.8, 1], [0, 0.6, -0.3, 0.8, 0.1, 0.5])
    frame["error_m"] += shift
    frame["range_m"] += shift
    found = diagnose(
        replace(recorded, frame=frame), BASE, QUICK, kinds={"clock-offset": ClockOffset}
    )
    assert isinstance(found.selection.verdicts[0], Unknown)
    assert found.law is None
    assert any(isinstance(effect, Unnamed) for effect in found.added)


def test_a_failing_effect_is_skipped_and_named():
    @dataclass(frozen=True)
    class Broken(TemperatureDrift):
        name = "broken"

        def apply(self, batch, draws):
            raise RuntimeError("boom")

    @dataclass(frozen=True)
    class Nothing(TemperatureDrift):
        name = "nan"

        def apply(self, batch, draws):
            return batch.longer(np.nan)

    kinds = {"broken": Broken, "nan": Nothing, **KINDS}
    found = diagnose(_recorded(TemperatureDrift(slope_mm_per_c=4.0)), BASE, QUICK, kinds=kinds)
    assert "boom" in found.selection.skipped["broken"]
    assert "nan" in found.selection.skipped
    assert found.selection.verdicts[0].names == ("temperature-drift",)


@pytest.mark.parametrize("paired", [True, False])
def test_table_against_table(paired):
    recorded = _recorded(TemperatureDrift(slope_mm_per_c=4.0))
    rows = _rows(0 if paired else 9)
    rows["link"] = rows["link"] if paired else "x" + rows["link"]
    frames = [BASE.observe(scene(rows), 90 + i, cir=False).table(rows) for i in range(3)]
    other = Recordings(pd.concat(frames, ignore_index=True), "other", simulator="theirs")
    found = diagnose(recorded, other, QUICK, kinds=KINDS)
    assert found.selection.verdicts[0].names == ("temperature-drift",)
    assert found.simulator is None
    assert found.mix["true_range_m"][1] > 0.01


def test_table_with_cirs_takes_effects_on_the_waveform():
    rows = _rows(0, links=40)
    hidden = BASE.with_effect(PulseRinging(ring_db=-9.0, ring_delay_ns=8.0))
    recorded = Recordings(hidden.simulate(rows, 1).frame, "test")
    frames = [BASE.simulate(rows, seed).frame for seed in (2, 3)]
    other = Recordings(pd.concat(frames, ignore_index=True), "other", simulator="theirs")
    options = Options(search_rows=60, fit_rows=24)
    found = diagnose(recorded, other, options, kinds={"pulse-ringing": PulseRinging})
    assert "pulse-ringing" in {name for group in found.selection.names for name in group}
    assert found.confirmed.gain.above_zero


def test_tables_without_overlap_are_refused():
    rows = _rows(4).assign(link="far", true_range_m=300.0)
    made = BASE.observe(scene(rows), 1, cir=False).table(rows)
    with pytest.raises(BenchError, match="no overlap"):
        diagnose(_recorded(), Recordings(made, "far"), QUICK, kinds=KINDS)


def _bad(**changes) -> Recordings:
    recorded = _recorded()
    return replace(recorded, frame=recorded.frame.assign(**changes))


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (lambda: replace(_recorded(), frame=_recorded().frame.drop(columns="link")), "link"),
        (lambda: _bad(link="one", true_range_m=5.0, range_m=5.1, error_m=0.1), "at least 4"),
        (lambda: _bad(error_m=np.nan, range_m=np.nan), "no truth"),
        (lambda: _bad(true_range_m=5000.0), "expected metres"),
        (lambda: _bad(range_m=5e6), "expected metres"),
        (lambda: _bad(range_m=-_recorded().frame["true_range_m"]), "is its sign turned"),
        (lambda: _bad(time_s=np.arange(384)[::-1] * 1.0), "backwards"),
        (lambda: _bad(range_m=7.0, true_range_m=np.linspace(3, 9, 384)), "receiver that is stuck"),
        (lambda: replace(_recorded(), frame=_recorded().frame.iloc[:0]), "no rows"),
    ],
)
def test_bad_input_is_one_clear_line(table, words):
    with pytest.raises(BenchError, match=words) as caught:
        diagnose(table(), BASE, QUICK, kinds=KINDS)
    assert "\n" not in str(caught.value)


def test_command_line_writes_nothing_on_bad_input(tmp_path):
    path = tmp_path / "r.parquet"
    write_recordings(_bad(link="one", true_range_m=5.0, range_m=5.0, error_m=0.0), path)
    asked = ["--recorded", str(path), "-o", str(tmp_path / "out")]
    result = CliRunner().invoke(command, asked)
    assert isinstance(result.exception, BenchError)
    assert not (tmp_path / "out").exists()
    result = CliRunner().invoke(command, ["--recorded", str(path), "--hide", "nope"])
    assert "nope" in str(result.exception)


def test_unnamed_and_clock_terms_refuse_wrong_lengths():
    with pytest.raises(BenchError, match="2 values"):
        Unnamed("true_range_m", (1.0, 2.0), (0.1,))
    with pytest.raises(BenchError, match="1 values"):
        DeviceClock(("a",), (), (0.0,))
