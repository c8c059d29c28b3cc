"""`bench diagnose` from the command line: bad input, plug-ins that fail, interruption, JSON."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bench.cli.main import main
from bench.discrepancy.select import candidates as explain
from bench.discrepancy.settings import FEWEST_AUC_LINKS
from bench.physics.base import Base
from bench.physics.effects.ranging.temperature import TemperatureDrift
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.physics.toml_file import to_toml
from bench.plugins import Plugin
from bench.recordings.io import write_recordings
from bench.recordings.table import Recordings

MINE = Simulator(Base(), (TimestampJitter(),), 3, "mine")
PLUGINS = """
from dataclasses import dataclass
import numpy as np
from bench.physics.base import Base
from bench.physics.effect import Effect, parameter
from bench.physics.effects.ranging.temperature import TemperatureDrift
from bench.physics.simulator import Simulator

@dataclass(frozen=True)
class Broken(TemperatureDrift):
    name = "broken"
    def apply(self, batch, draws):
        raise RuntimeError("boom")

@dataclass(frozen=True)
class Nothing(TemperatureDrift):
    name = "nothing"
    def apply(self, batch, draws):
        return batch.longer(np.nan)

@dataclass(frozen=True)
class Short(TemperatureDrift):
    name = "short"
    def apply(self, batch, draws):
        if np.any(batch.rows.true_range_m > 19):
            raise ValueError("too far for me")
        return batch

moody = Simulator(Base(), (Short(),), 0, "moody")
number = 7
"""


def rows(links: int = 16) -> pd.DataFrame:
    rng = np.random.default_rng(0)
    link = np.repeat(np.arange(links), 8)
    return pd.DataFrame(
        {
            "link": [f"l{i}" for i in link],
            "true_range_m": np.linspace(2, 20, links)[link],
            "time_s": np.arange(len(link)) * 1.0,
            "temperature_c": rng.uniform(0, 50, links)[link],
        }
    )


def recorded() -> pd.DataFrame:
    warm = MINE.with_effect(TemperatureDrift(slope_mm_per_c=6.0))
    made = warm.observe(scene(rows()), 50, cir=False).table(rows())
    return made[[*rows().columns, "range_m", "error_m"]]


@pytest.fixture(autouse=True)
def no_figures(monkeypatch):
    """Draw no figures: they have tests of their own."""
    monkeypatch.setattr("bench.discrepancy.report.document.draw", lambda diagnosis, folder: [])


@pytest.fixture
def call(tmp_path, monkeypatch, capsys):
    """Return a function that runs `bench diagnose` on a table: code, stdout, stderr."""
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "my_plugins.py").write_text(PLUGINS)
    simulator = tmp_path / "mine.toml"
    simulator.write_text(to_toml(MINE))
    library = [
        Plugin("effects", name, f"my_plugins:{kind}", "mine")
        for name, kind in (("broken", "Broken"), ("nothing", "Nothing"), ("absent", "Absent"))
    ]
    library.append(
        Plugin(
            "effects",
            "temperature-drift",
            "bench.physics.effects.ranging.temperature:TemperatureDrift",
            "uwb-bench",
        )
    )
    monkeypatch.setattr(explain, "plugins", lambda group: library)

    def run(frame: pd.DataFrame, *words: str, simulated: str | None = None):
        path = tmp_path / "r.parquet"
        write_recordings(Recordings(frame, "test"), path)
        given = ["--recorded", str(path), "--simulated", simulated or str(simulator)]
        asked = ["bench", "diagnose", *given, "--paths-only", "--observe", "error_m", *words]
        monkeypatch.setattr(sys, "argv", asked)
        with pytest.raises(SystemExit) as ended:
            main()
        printed = capsys.readouterr()
        return ended.value.code or 0, printed.out, printed.err

    yield run
    sys.modules.pop("my_plugins", None)


def one_line(answer: tuple[int, str, str], *words: str) -> None:
    """Check that a command failed with one line on stderr that holds these words."""
    code, out, err = answer
    assert code == 2
    assert out == ""
    assert sum(line.startswith("bench:") for line in err.splitlines()) == 1
    assert err.splitlines()[-1].startswith("bench: ")
    for word in words:
        assert word in err


def _without_error(frame: pd.DataFrame, truth: float, measured: float) -> pd.DataFrame:
    """Return a table in wrong units, whose error follows from its ranges."""
    wrong = {
        "true_range_m": frame["true_range_m"] * truth,
        "range_m": frame["range_m"] * measured,
    }
    return frame.drop(columns="error_m").assign(**wrong)


def _at_one_place(frame: pd.DataFrame) -> pd.DataFrame:
    """Return a table as of antennas that stand still, under one link."""
    ends = [name for name in frame if str(name)[:3] in ("tx_", "rx_")]
    return frame.drop(columns=[*ends, "range_m"]).assign(link="one", true_range_m=5.0)


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda f: f.drop(columns=["error_m", "range_m"]), ("range_m", "error_m")),
        (lambda f: f.drop(columns="true_range_m"), ("true_range_m",)),
        (lambda f: _at_one_place(f), ("1 link", "at least 4")),
        (lambda f: _without_error(f, 1000, 1000), ("true_range_m", "expected metres")),
        (lambda f: _without_error(f, 1000, 1), ("beyond 1 km",)),
        (lambda f: _without_error(f, 1, 1000), ("beyond 1 km",)),
        (
            lambda f: f.assign(time_s=f.time_s.to_numpy()[::-1]),
            ("backwards", "sort by link and time_s"),
        ),
        (lambda f: f.iloc[:0], ("rows",)),
    ],
)
def test_a_table_that_cannot_be_diagnosed_is_one_line(call, tmp_path, spoil, words):
    out = tmp_path / "out"
    one_line(call(spoil(recorded()), "-o", str(out)), *words)
    assert not out.exists()


def test_tables_without_overlap_are_one_line(call, tmp_path):
    far = rows().assign(true_range_m=300.0, link="far")
    made = MINE.observe(scene(far), 1, cir=False).table(far)
    other = tmp_path / "far.parquet"
    write_recordings(Recordings(made, "far"), other)
    one_line(call(recorded(), simulated=str(other)), "no overlap", "true_range_m")


def test_a_simulator_that_fails_on_some_rows_is_named_with_the_row(call, monkeypatch):
    plugin = Plugin("simulators", "moody", "my_plugins:moody", "mine")
    monkeypatch.setattr("bench.plugins.plugins", lambda group: [plugin])
    one_line(call(recorded(), simulated="moody"), "moody", "too far for me", "row", "short")


def test_a_plugin_that_is_no_simulator_is_one_line(call, monkeypatch):
    plugin = Plugin("simulators", "seven", "my_plugins:number", "mine")
    monkeypatch.setattr("bench.plugins.plugins", lambda group: [plugin])
    one_line(call(recorded(), simulated="seven"), "seven", "expected")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--hide", "nope"), "nope"),
        (("--environment", "hall"), "environment"),
        (("--observe", "nope"), "(nope)"),
        (("-o", ""), "expected the name of a folder"),
        (("--measured", "nope"), "nope"),
        (("--known", "error_m"), "never known"),
        (("--known", "true_range_m", "--measured", "true_range_m"), "both"),
    ],
)
def test_wrong_options_are_one_line(call, words, said):
    one_line(call(recorded(), *words), said)


def test_a_report_that_could_not_be_written_fails_before_the_search(call, tmp_path):
    (tmp_path / "out" / "report.md").mkdir(parents=True)
    answer = call(recorded(), "-o", str(tmp_path / "out"))
    one_line(answer, "report.md: a folder; expected a regular file")
    assert "searching" not in answer[2]


def test_radio_settings_and_links_that_cannot_be_name_the_table(call):
    one_line(call(recorded().assign(channel=99)), "r.parquet: base: channel = 99")
    one_line(call(recorded().head(8)), "r.parquet: 1 link(s)")


def test_an_environment_that_is_not_there_names_those_that_are(call):
    frame = recorded().assign(environment="hall")
    one_line(call(frame, "--environment", "attic"), "attic", "hall")


def test_failing_effects_are_told_and_skipped_and_json_is_alone(call, tmp_path):
    out = tmp_path / "out"
    code, printed, err = call(recorded(), "-o", str(out), "--json")
    assert code == 0
    found = json.loads(printed)
    assert found["verdicts"][0]["names"] == ["temperature-drift"]
    assert "boom" in found["skipped_effects"]["broken"]
    assert "no number" in found["skipped_effects"]["nothing"]
    assert "unavailable" in found["skipped_effects"]["absent"]
    assert "report:" in err
    assert json.loads((out / "diagnosis.json").read_text()) == found


def test_printed_for_people_it_says_verdict_confirmation_and_what_was_skipped(call):
    frame = recorded()
    code, printed, _ = call(frame.assign(chip_snr_db=np.arange(len(frame)) % 9.0))
    assert code == 0
    assert "temperature-drift" in printed
    assert "Measured, so not searched over: chip_snr_db (a column of your own" in printed
    links = int(re.search(r"confirm links \((\d+)\)", printed)[1])
    assert ("too few to tell" in printed) == (links < FEWEST_AUC_LINKS)
    assert "skipped broken" in printed


def test_same_seed_same_bytes_however_many_threads(call, tmp_path, monkeypatch):
    texts = []
    for number, threads in enumerate(("1", "3")):
        monkeypatch.setenv("BENCH_THREADS", threads)
        out = tmp_path / f"out{number}"
        assert call(recorded(), "-o", str(out))[0] == 0
        texts.append((out / "diagnosis.json").read_bytes())
    assert texts[0] == texts[1]


def test_a_folder_that_cannot_be_is_refused_before_any_work(call, tmp_path):
    (tmp_path / "taken").write_text("a file")
    answer = call(recorded(), "-o", str(tmp_path / "taken"))
    one_line(answer, "cannot write", "taken is a file, expected a folder")
    assert "searching" not in answer[2]


def test_an_interrupted_run_leaves_whole_files_and_runs_again(call, tmp_path, monkeypatch):
    out = tmp_path / "out"
    with monkeypatch.context() as patched:
        patched.setattr("bench.discrepancy.report.document.markdown", _interrupt)
        code, _, err = call(recorded(), "-o", str(out))
        assert code == 130
        assert "interrupted" in err
        assert "the same command goes on" in err
    assert not (out / "report.md").exists()
    assert not list(out.glob("*.part*"))
    first = (out / "diagnosis.json").read_text()
    json.loads(first)
    assert call(recorded(), "-o", str(out))[0] == 0
    assert (out / "report.md").exists()
    assert (out / "diagnosis.json").read_text() == first


def test_a_stopped_run_says_after_which_round_it_resumes(call, tmp_path, monkeypatch):
    out, fresh = tmp_path / "out", tmp_path / "fresh"
    with monkeypatch.context() as patched:
        patched.setattr("bench.discrepancy.method.verdicts", _interrupt)
        assert call(recorded(), "-o", str(out))[0] == 130
    code, printed, err = call(recorded(), "-o", str(out), "--json")
    assert code == 0
    assert re.search(r"resuming: [1-9]\d* finished steps .* \(whole rounds: 1\)", err)
    assert not (out / ".unfinished").exists()
    _, same, err = call(recorded(), "-o", str(fresh), "--json")
    assert "resuming" not in err
    assert printed == same
    assert (out / "diagnosis.json").read_bytes() == (fresh / "diagnosis.json").read_bytes()


def test_a_stopped_run_of_another_seed_is_not_resumed(call, tmp_path, monkeypatch):
    out = tmp_path / "out"
    with monkeypatch.context() as patched:
        patched.setattr("bench.discrepancy.method.verdicts", _interrupt)
        assert call(recorded(), "-o", str(out), "--seed", "1")[0] == 130
    assert "resuming" not in call(recorded(), "-o", str(out))[2]
    assert not (out / ".unfinished").exists()


def _interrupt(*_: object) -> str:
    raise KeyboardInterrupt


def test_a_folder_that_cannot_be_written_is_one_line(call, tmp_path):
    (tmp_path / "file").write_text("")
    code, _, err = call(recorded(), "-o", str(tmp_path / "file" / "out"))
    assert code == 2
    assert "cannot write" in err


def test_a_path_is_a_path(tmp_path: Path, call):
    one_line(call(recorded(), simulated=str(tmp_path / "nope.toml")), "nope.toml")
