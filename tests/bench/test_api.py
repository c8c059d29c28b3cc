"""The public calls: frames and paths in, dataclasses out, the checks of the command line."""

from __future__ import annotations

import doctest
from importlib import import_module
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import bench
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.effects.ranging.temperature import TemperatureDrift
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.rooms import Rooms
from bench.physics.simulator import Simulator
from bench.physics.simulators import SimulatorPlugin, open_simulator, read_simulator
from bench.plugins import Plugin, plugins

MINE = Simulator(Base(), (TimestampJitter(),), 3, "mine")
DOCUMENTED = (
    *("bench", "bench.lazy", "bench.recordings.open", "bench.runner.simulation"),
    *("bench.runner.api", "bench.runner.diagnosis", "bench.challenge.api"),
)


OFFERING = (
    *("bench", "bench.checks", "bench.checkpoint", "bench.discrepancy", "bench.measure"),
    *("bench.physics", "bench.recordings", "bench.runner", "zoo", "backends"),
)


def geometry(links: int = 16) -> pd.DataFrame:
    link = np.repeat(np.arange(links), 8)
    columns = {
        "true_range_m": np.linspace(2, 20, links)[link],
        "temperature_c": np.random.default_rng(0).uniform(0, 50, links)[link],
    }
    return pd.DataFrame({"link": [f"l{one}" for one in link], **columns})


@pytest.fixture(scope="module")
def warm() -> pd.DataFrame:
    """Return recordings by a simulator with a drift that `MINE` does not have."""
    effects = (TimestampJitter(), TemperatureDrift(slope_mm_per_c=6.0))
    made = Simulator(Base(), effects, 4).simulate(geometry()).frame
    return made[["link", "true_range_m", "temperature_c", "range_m", "error_m"]]


@pytest.fixture
def one_effect(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have diagnoses know one effect: what others cost is not the point here."""
    home = f"{TemperatureDrift.__module__}:TemperatureDrift"
    known = [Plugin("effects", "temperature-drift", home, "uwb-bench")]
    monkeypatch.setattr("bench.discrepancy.select.candidates.plugins", lambda group: known)


@pytest.mark.parametrize("name", DOCUMENTED)
def test_examples_run(name: str) -> None:
    done = doctest.testmod(import_module(name), optionflags=doctest.ELLIPSIS)
    assert done.attempted > 0
    assert done.failed == 0


def test_everything_offered_is_there() -> None:
    for package in OFFERING:
        module = import_module(package)
        assert module.__all__
        for name in module.__all__:
            assert getattr(module, name) is not None
        with pytest.raises(AttributeError, match="no attribute 'nothing'"):
            _ = module.nothing


def test_a_frame_is_read_like_a_file(warm: pd.DataFrame, tmp_path: Path) -> None:
    spoilt = warm.assign(cir=[np.arange(5.0)] * len(warm))
    spoilt.loc[3, "range_m"] = spoilt.loc[3, "error_m"] = np.nan
    spoilt.to_parquet(tmp_path / "spoilt.parquet")
    frame, file = bench.read(spoilt), bench.read(tmp_path / "spoilt.parquet")
    assert dict(frame.dropped) == dict(file.dropped) == {"no range error": 1}
    assert frame.fingerprint == file.fingerprint
    assert bench.read(frame) is frame


def test_in_memory_and_in_a_file_it_simulates_the_same(tmp_path: Path) -> None:
    asked = {"geometry": geometry(), "seed": 9}
    kept = bench.simulate(MINE, **asked)
    filed = bench.simulate(MINE, **asked, out=tmp_path / "made.parquet")
    assert (kept.file, filed.file) == (None, tmp_path / "made.parquet")
    assert kept.rows == filed.rows == 128
    assert kept.mae_m == pytest.approx(filed.mae_m, abs=1e-12)
    for name in ("range_m", "rx_power_dbm"):
        left, right = (one.recordings.frame[name].to_numpy() for one in (kept, filed))
        np.testing.assert_array_equal(left, right)
    assert kept.recordings.seed == filed.recordings.seed == 9


def test_a_diagnosis_takes_frames_and_simulators(
    warm: pd.DataFrame, tmp_path: Path, one_effect: None, monkeypatch
) -> None:
    asked = {"paths_only": True, "observe": "error_m"}
    monkeypatch.chdir(tmp_path)
    found = bench.diagnose(warm, MINE, **asked)
    assert [effect.name for effect in found.added] == ["temperature-drift"]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda f: bench.read(f.assign(error_m=5000.0, range_m=5000.0)), "beyond 1 km"),
        (lambda f: bench.read("romos"), "did you mean 'rooms'"),
        (lambda f: bench.diagnose(f, hide="nope"), "no column 'nope'"),
        (lambda f: bench.diagnose(f, "roms"), "did you mean 'rooms'"),
        (lambda f: bench.diagnose(f, seed=-1), "0 or more"),
        (lambda f: bench.diagnose(f, environment="hall"), "no column 'environment'"),
        (lambda f: bench.simulate("rooms"), "say where to simulate"),
        (lambda f: bench.simulate("rooms", f, rows=3), "-n goes with"),
        (lambda f: bench.simulate("rooms", f, out="x.csv"), "expected a .parquet name"),
        (lambda f: bench.simulate("rooms", f.head(0)), "no rows to simulate"),
        (lambda f: bench.simulate("rooms", f, seed=-1), "0 or more"),
        (lambda f: bench.challenge(cases=0), "--cases 0: expected a whole number of at least 1"),
        (lambda f: bench.challenge(jobs=0), "--jobs 0"),
        (lambda f: bench.run(data=f, jobs=0), "--jobs 0"),
    ],
)
def test_bad_input_is_one_clear_line(call, words: str, warm: pd.DataFrame, tmp_path) -> None:
    with pytest.MonkeyPatch.context() as patched:
        patched.chdir(tmp_path)
        with pytest.raises(bench.BenchError, match=words) as caught:
            call(warm)
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


class Hall(SimulatorPlugin):
    """A simulator with rows of its own."""

    simulator = MINE
    rows = 24

    def geometry(self, rows: int, seed: int):
        yield geometry(rows // 8)


SIMULATORS = {"hall": "Hall", "plain": "MINE", "made": "made", "seven": "SEVEN", "bad": "bad"}
SEVEN = 7


def made() -> Simulator:
    return MINE


def bad() -> Simulator:
    raise OSError("no licence")


@pytest.fixture
def halls(monkeypatch: pytest.MonkeyPatch) -> None:
    """Register simulators as plug-ins may bring them."""
    here = [Plugin("simulators", n, f"{__name__}:{at}", "mine") for n, at in SIMULATORS.items()]
    real = plugins

    def known(group):
        return [*here, *real(group)] if group == "simulators" else real(group)

    for place in ("bench.plugins", "bench.runner.simulation"):
        monkeypatch.setattr(f"{place}.plugins", known)


@pytest.mark.parametrize("name", ["hall", "plain", "made", "rooms"])
def test_one_protocol_serves_diagnose_and_simulate(
    halls: None, one_effect: None, name: str, warm
) -> None:
    """`bench diagnose --simulated rooms`, our own simulator, was refused."""
    assert open_simulator(name).simulator in (MINE, Rooms().simulator)
    assert bench.simulate(name, warm).rows == len(warm)
    asked = {"paths_only": True, "observe": ("error_m",)}
    assert bench.diagnose(warm, name, **asked).simulated == name


def test_rows_of_a_simulators_own_are_simulated_at(halls: None) -> None:
    assert bench.simulate(MINE, "hall").rows == 24
    assert bench.simulate(MINE, "hall", rows=16).rows == 16
    with pytest.raises(bench.BenchError, match="'mine' has no rows of its own"):
        bench.simulate(MINE, "plain")


@pytest.mark.parametrize(
    ("name", "words"), [("seven", "expected a bench.physics Simulator"), ("bad", "no licence")]
)
def test_what_is_no_simulator_is_said_wherever_it_is_asked_for(
    halls: None, name: str, words: str, warm
) -> None:
    for call in (bench.simulate, lambda name, rows: bench.diagnose(rows, name)):
        with pytest.raises(bench.BenchError, match=words):
            call(name, warm)


def needy(frame: pd.DataFrame) -> Simulator:
    """Asks for what nobody gives a simulator."""
    return MINE


def test_what_asks_for_arguments_and_what_is_a_python_file_is_told_what_to_do() -> None:
    plugin = Plugin("simulators", "needy", f"{__name__}:needy", "mine")
    with pytest.raises(BenchError, match="needy asks for 'frame'; expected a simulator, or a cl"):
        plugin.make()
    with pytest.raises(BenchError, match=r"sim\.py: a Python file cannot be run .*kind simulator"):
        read_simulator("sim.py")
