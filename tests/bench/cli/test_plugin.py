from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner, Result

from bench.cli.plugin import command
from bench.errors import BenchError
from bench.recordings import Recordings, write_recordings

NAME = "ridge-cir"
LOGS = "office-logs"
KINDS = {
    NAME: "model",
    LOGS: "dataset",
    "narrow-weights": "backend",
    "humid-air": "effect",
    "long-corridor": "simulator",
    "my-board": "device",
}


def call(*arguments: str) -> Result:
    return CliRunner().invoke(command, arguments, catch_exceptions=False)


def everything(folder: Path) -> list[Path]:
    return sorted(folder.rglob("*"))


def test_writes_a_whole_package_and_says_what_to_do_next(tmp_path: Path) -> None:
    result = call("new", NAME, "-o", str(tmp_path / "deep"))
    package = tmp_path / "deep" / NAME
    assert {str(path.relative_to(package)) for path in everything(package) if path.is_file()} == {
        "README.md",
        "pyproject.toml",
        "src/ridge_cir/__init__.py",
        "src/ridge_cir/model.py",
        "src/ridge_cir/network.py",
        "src/ridge_cir/py.typed",
        "tests/test_ridge_cir.py",
    }
    assert everything(tmp_path / "deep")[0] == package  # no scratch folder beside it
    assert f'pip install -e "{package}[dev]"' in result.stdout
    assert f"bench run --model {NAME} --backend fp32" in result.stdout


def test_a_data_set_package_says_how_to_use_it(tmp_path: Path) -> None:
    result = call("new", LOGS, "--kind", "dataset", "-o", str(tmp_path))
    assert (tmp_path / LOGS / "src" / "office_logs" / "source.py").is_file()
    assert f"bench run --model all --data {LOGS} --backend fp32" in result.stdout


@pytest.mark.parametrize(
    ("kind", "module", "class_line"),
    [
        ("model", "model.py", "class MyOwn2Regressor(MitigationModel):"),
        ("dataset", "source.py", "class MyOwn2Recorded(Source):"),
        ("backend", "backend.py", "class MyOwn2Runtime(Backend):"),
        ("effect", "effect.py", "class MyOwn2Physics(Effect):"),
        ("simulator", "simulator.py", "class MyOwn2Simulated(SimulatorPlugin):"),
        ("device", "device.py", "MyOwn2Profile: Profile = load_profile("),
    ],
)
def test_no_placeholder_is_left_and_every_module_compiles(
    tmp_path: Path, kind: str, module: str, class_line: str
) -> None:
    call("new", "My_Own2", "--kind", kind, "-o", str(tmp_path))
    for path in everything(tmp_path):
        if path.is_file():
            text = path.read_text(encoding="utf-8")
            assert "$" not in text
            if path.suffix == ".py":
                compile(text, str(path), "exec")
    assert class_line in (tmp_path / "My_Own2" / "src" / "my_own2" / module).read_text()


def test_json_lists_what_was_written(tmp_path: Path) -> None:
    content = json.loads(call("new", NAME, "-o", str(tmp_path), "--json").stdout)
    assert content["folder"] == str(tmp_path / NAME)
    assert content["kind"] == "model"
    assert all((tmp_path / NAME / path).is_file() for path in content["files"])


def test_the_default_folder_is_the_current_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    call("new", NAME)
    assert (tmp_path / NAME / "pyproject.toml").is_file()


def test_an_empty_folder_is_filled_with_the_usual_permissions(tmp_path: Path) -> None:
    (tmp_path / NAME).mkdir()
    (tmp_path / "usual").mkdir()
    call("new", NAME, "-o", str(tmp_path))
    assert (tmp_path / NAME / "pyproject.toml").is_file()
    assert (tmp_path / NAME).stat().st_mode == (tmp_path / "usual").stat().st_mode


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("../evil", "expected letters and digits"),
        ("/tmp/evil", "expected letters and digits"),
        ("a b", "expected letters and digits"),
        ("1st", "expected letters and digits"),
        ("trailing-", "expected letters and digits"),
        ("double--dash", "expected letters and digits"),
        ("$module", "expected letters and digits"),
        ("ünicode", "expected letters and digits"),
        ("new\n", "expected letters and digits"),
        ("", "expected letters and digits"),
        ("x" * 51, "at most 50 characters"),
        ("lambda", "'lambda' is a Python keyword"),
        ("Class", "'class' is a Python keyword"),
        ("match", "'match' is a Python keyword"),
        ("remnet", "uwb-bench already registers it"),
        ("numpy", "a package of that name is already installed"),
        ("zoo", "a package of that name is already installed"),
        ("scikit-learn", "a package of that name is already installed"),
        ("uwb-bench", "a package of that name is already installed"),
    ],
)
def test_a_name_that_cannot_work_is_refused(tmp_path: Path, name: str, message: str) -> None:
    with pytest.raises(BenchError, match=message):
        call("new", "-o", str(tmp_path / "deep"), "--", name)
    assert everything(tmp_path) == []


def test_a_folder_with_something_in_it_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / NAME).mkdir()
    (tmp_path / NAME / "mine.txt").write_text("precious")
    with pytest.raises(BenchError, match="ridge-cir is not empty"):
        call("new", NAME, "-o", str(tmp_path))
    assert everything(tmp_path) == [tmp_path / NAME, tmp_path / NAME / "mine.txt"]


def test_a_file_or_a_link_in_the_way_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / NAME).write_text("precious")
    (tmp_path / "two").mkdir()
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "two" / NAME).symlink_to(tmp_path / "elsewhere")
    for folder in ("one", "two"):
        with pytest.raises(BenchError, match="ridge-cir is already there"):
            call("new", NAME, "-o", str(tmp_path / folder))
    assert everything(tmp_path / "elsewhere") == []


def test_a_folder_that_cannot_be_made_is_one_clear_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(
        BenchError, match=r"cannot write .*ridge-cir: (Not a directory|File exists)"
    ):
        call("new", NAME, "-o", str(tmp_path / "file"))


def test_a_full_disk_leaves_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written: list[Path] = []

    def write_text(path: Path, text: str, encoding: str) -> None:
        if written:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written.append(path)

    monkeypatch.setattr(Path, "write_text", write_text)
    with pytest.raises(BenchError, match=r"cannot write .*: No space left on device"):
        call("new", NAME, "-o", str(tmp_path))
    assert everything(tmp_path) == []


@dataclass(frozen=True)
class Site:
    """A temporary environment: this one, plus what is installed in `folder`."""

    folder: Path
    packages: Path

    def python(
        self, *arguments: str, cwd: Path | None = None, data: Path | None = None
    ) -> subprocess.CompletedProcess[str]:
        environment = {**os.environ, "PYTHONPATH": str(self.folder)}
        if data:
            environment["BENCH_DATA"] = str(data)
        return subprocess.run(
            [sys.executable, *arguments],
            env=environment,
            cwd=cwd,
            capture_output=True,
            text=True,
            check=False,
        )


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Site:
    """Install the example packages as a user would, without a network and outside our tree."""
    root = tmp_path_factory.mktemp("plugin")
    for name, kind in KINDS.items():
        call("new", name, "--kind", kind, "-o", str(root))
    made = Site(root / "site", root)
    offline = ("--no-deps", "--no-index", "--no-build-isolation", "--quiet")
    install = [sys.executable, "-m", "pip", "install", *offline, "--target", str(made.folder)]
    subprocess.run([*install, *(str(root / name) for name in KINDS)], check=True)
    return made


@pytest.fixture(scope="module")
def passed(site: Site) -> dict[str, int]:
    """Return how many of its own tests every package passes; one process imports for all."""
    tests = [str(site.packages / name / "tests") for name in KINDS]
    asked = ("-rp", "-q", "-p", "no:cacheprovider", f"--rootdir={site.packages}")
    run = site.python("-m", "pytest", *asked, *tests, cwd=site.packages)
    assert run.returncode == 0, run.stdout
    lines = [line for line in run.stdout.splitlines() if line.startswith("PASSED ")]
    return {name: sum(f" {name}/tests/" in line for line in lines) for name in KINDS}


BROKEN = {
    "absent": ("import a_library_nobody_has", "ModuleNotFoundError: No module named"),
    "raises": ("1 / 0", "ZeroDivisionError: division by zero"),
    "exits": ("raise SystemExit('stop')", "it tried to end the program"),
    "garbled": ("def (", "SyntaxError: invalid syntax"),
    "empty": ("", "AttributeError: module 'bad_empty' has no attribute 'Bad'"),
}


@pytest.fixture
def broken(site: Site) -> Iterator[None]:
    """Install plug-ins that cannot be loaded; remove them afterwards."""
    metadata = site.folder / "bad_plugin-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: bad-plugin\nVersion: 1.0\n")
    lines = [f"{name} = bad_{name}:Bad" for name in BROKEN]
    (metadata / "entry_points.txt").write_text("\n".join(["[bench.models]", *lines]))
    for name, (source, _) in BROKEN.items():
        (site.folder / f"bad_{name}.py").write_text(source)
    yield
    for path in (*site.folder.glob("bad_*.py"), *metadata.iterdir()):
        path.unlink()
    metadata.rmdir()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "least"),
    [(NAME, 50), (LOGS, 6), *((name, 3) for name in KINDS if name not in (NAME, LOGS))],
)
def test_a_package_passes_its_own_tests(passed: dict[str, int], name: str, least: int) -> None:
    assert passed[name] >= least


def test_a_data_set_is_found_and_read_by_its_name(site: Site, tmp_path: Path) -> None:
    (tmp_path / LOGS).mkdir()
    (tmp_path / LOGS / "hall.jsonl").write_text('{"range_m": 2.1, "true_range_m": 2.0}\n')
    code = f"from bench.recordings.open import *; print(open_recordings({LOGS!r})[0].errors_m())"
    run = site.python("-c", code, data=tmp_path)
    assert run.stdout == "[0.1]\n", run.stderr


def models(site: Site) -> dict[str, dict[str, Any]]:
    """Return what `bench models` says of every model."""
    run = site.python("-m", "bench", "models", "--json")
    assert run.returncode == 0, run.stderr
    return {model["name"]: model for model in json.loads(run.stdout)}


def test_the_harness_finds_it_without_a_line_of_ours(site: Site) -> None:
    found = models(site)[NAME]
    assert found["distribution"] == NAME
    assert found["summary"].startswith("Ridge regression on the CIR: one weight per sample")
    assert found["problem"] is None


def test_a_broken_plugin_changes_nothing_but_its_own_line(site: Site, broken: None) -> None:
    found = models(site)
    for name, (_, reason) in BROKEN.items():
        bad = found.pop(name)
        assert bad["distribution"] == "bad-plugin"
        assert bad["problem"].startswith(f"unavailable: {reason}")
    assert {"none", "remnet", "svm", NAME} < set(found)
    assert all(model["problem"] is None for model in found.values())


def tiny_table(path: Path) -> Path:
    """Write recordings whose error shows in one sample of the CIR."""
    rng = np.random.default_rng(0)
    rows, links = 240, 12
    error_m = rng.uniform(0.0, 0.5, rows)
    cirs = rng.rayleigh(50.0, (rows, 157))
    cirs[:, 7] += 4000.0 * error_m
    frame = pd.DataFrame(
        {
            "range_m": 3.0 + error_m,
            "true_range_m": 3.0,
            "cir": list(cirs.astype(np.float32)),
            "first_path_index": 5.0,
            "los": False,
            "link": [f"link-{i % links}" for i in range(rows)],
        }
    )
    write_recordings(Recordings(frame, source="tiny"), path)
    return path


UNTIMED = """
from bench.runner import api
api.time_artifacts = lambda *_: ([], [])
from bench.cli.main import main
main()
"""


@pytest.mark.slow
def test_the_harness_benchmarks_it_without_a_line_of_ours(site: Site, tmp_path: Path) -> None:
    table = tiny_table(tmp_path / "tiny.parquet")
    out = ("--out", str(tmp_path / "results"), "--split", "link-kfold:3", "--json")
    asked = ("--model", NAME, "--backend", "fp32", "--data", str(table))
    run = site.python("-c", UNTIMED, "run", *asked, *out)
    assert run.returncode == 0, run.stderr
    (record,) = json.loads(run.stdout)["runs"]
    assert record["status"] == "ok"
    assert record["nlos"]["mae_m"]["value"] < 0.2 * record["nlos"]["raw_mae_m"]
    board = site.python("-m", "bench", "leaderboard", "--results", str(tmp_path / "results"))
    assert f"| {NAME} | fp32 |" in board.stdout
