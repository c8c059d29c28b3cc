"""`bench export` of what is finished: nothing large is imported, counts and rows are kept."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result
from recordings_factory import make_recordings

from backends.base import Artifact
from bench import plugins
from bench.cli.main import group
from bench.errors import BenchError
from bench.export import Chosen, from_fit, from_run
from bench.export.counts import counted_before
from bench.recordings.io import write_recordings

LARGE = ("torch", "sklearn", "scipy", "pandas", "pyarrow", "numba", "matplotlib")
PROGRAM = f"""
import sys
from bench.cli.failing import ended_with
from backends.base import Artifact
from bench import plugins
from bench.cli.main import group
code = ended_with(lambda: group.main(sys.argv[1:], prog_name="bench", standalone_mode=False))
print(code, sorted(set(sys.modules) & set({LARGE!r})), file=sys.stderr)
"""
COUNTED = "| nrf52832: latency | 1.00 ms [0.9, 1.1] | counted: emulated cortex-m4f, gcc 12 |"


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, Path]]:
    """Recordings, and a folder with a finished run of `none` on them."""
    folder = tmp_path_factory.mktemp("finished")
    table = folder / "mine.parquet"
    write_recordings(make_recordings(rows=80), table)
    before = time.time() - 60
    os.utime(table, (before, before))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("BENCH_CACHE", str(folder / "cache"))
        _bench("run", "--model", "none", "--backend", "fp32", "--no-timing", *_of(table, folder))
        yield table, folder / "results"


@pytest.fixture(autouse=True)
def _its_cache(finished: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BENCH_CACHE", str(finished[0].parent / "cache"))


def _of(table: Path, folder: Path) -> tuple[object, ...]:
    return "--data", table, "--out", folder / "results"


def _bench(*words: object) -> Result:
    done = CliRunner().invoke(group, [str(word) for word in words])
    if done.exception is not None:
        raise done.exception
    return done


def _export(table: Path, results: Path, out: Path, *words: object) -> Result:
    asked = ("--model", "none", "--backend", "fp32", "--data", table, "--results", results)
    return _bench("export", *asked, "-o", out, *words)


def test_a_finished_fit_is_exported_without_what_trains_or_reads_tables(finished, tmp_path) -> None:
    table, results = finished
    [record] = (results / "runs").glob("*.json")
    fit = ("--model", "none", "--backend", "fp32", "--data", str(table))
    for number, which in enumerate((fit, ("--run", record.stem))):
        words = ("export", *which, "--results", str(results), "-o", str(tmp_path / str(number)))
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM, *words], capture_output=True, text=True, check=True
        )
        assert done.stderr.splitlines()[-1] == "0 []", done.stderr
    for file in (tmp_path / "0").iterdir():
        assert file.read_bytes() == (tmp_path / "1" / file.name).read_bytes()


def test_rows_that_were_kept_are_the_rows_of_the_recordings(finished, monkeypatch) -> None:
    table, results = finished
    [record] = (results / "runs").glob("*.json")
    kept = from_run(record.stem, results)
    read = from_run(record.stem, results, str(table))
    np.testing.assert_array_equal(kept.cirs, read.cirs)
    for file in (Path(os.environ["BENCH_CACHE"]) / "held-out").iterdir():
        file.write_bytes(file.read_bytes()[:-200])
    np.testing.assert_array_equal(from_run(record.stem, results).cirs, read.cirs)
    monkeypatch.setattr("bench.runner.material.load_material", None)
    np.testing.assert_array_equal(from_run(record.stem, results).cirs, read.cirs)


def test_a_file_that_was_built_is_built_once(finished, tmp_path, monkeypatch) -> None:
    table, _ = finished
    asked = ("none", "fp32", str(table), tmp_path / "no-results", tmp_path)
    told: list[str] = []
    first = from_fit(*asked, told.append)
    assert any(line.startswith("building") for line in told)
    content = first.artifact.path.read_bytes()
    monkeypatch.setattr("bench.export.making.fit_fold", None)
    again = from_fit(*asked, lambda _: None)
    assert again.artifact.path.read_bytes() == content
    np.testing.assert_array_equal(again.cirs, first.cirs)


def test_counts_are_kept_while_the_c_is_the_same_and_their_loss_is_told(finished, tmp_path) -> None:
    table, results = finished
    _export(table, results, tmp_path)
    report = tmp_path / "REPORT.md"
    text = report.read_text()
    pointer = next(line for line in text.splitlines() if "not counted" in line)
    report.write_text(text.replace(pointer, COUNTED))
    assert "keeps what was counted for nrf52832" in _export(table, results, tmp_path).stdout
    assert COUNTED in report.read_text()
    (tmp_path / "uwb_predict.c").write_text("/* other C */\n")
    shown = json.loads(_export(table, results, tmp_path, "--json").stdout)
    assert (shown["counts_kept"], shown["counts_dropped"]) == ([], ["nrf52832"])
    assert COUNTED not in report.read_text()
    assert counted_before(report, ()).parts == ()


def test_each_step_is_a_line_where_nobody_watches(finished, tmp_path) -> None:
    table, results = finished
    told = _export(table, results, tmp_path).stderr
    assert told == "writing C and comparing it with ONNX Runtime\n"
    assert _export(table, results, tmp_path, "--json").stderr == ""


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--model", "gbm", "--backend", "int8"), "made of trees"),
        (("--model", "gbm", "--backend", "c-int8"), "made of trees"),
        (("--model", "svm", "--backend", "qat"), "not trained by gradient descent"),
        (("--model", "mlp", "--backend", "int8", "--device", "cortex-m4"), "has it .nrf52832, "),
        (("--model", "mlp", "--backend", "int8", "--device", "cortex-m0+"), "has it .rp2040"),
        (("--model", "mlp", "--backend", "int8", "--device", "nrf5283"), "did you mean 'nrf52832'"),
        (("--model", "mlp", "--backend", "int8", "--device", "host"), "no core"),
        (("--model", "mlp", "--backend", "int8", "--to", "onnx", "--device", "rp2040"), "counts C"),
        (("--model", "mlp", "--backend", "int8", "--to", "onnx", "--requantise", "fixed"), "of C"),
    ],
)
def test_what_cannot_be_is_refused_before_the_fit(
    finished, tmp_path, monkeypatch, words, said
) -> None:
    def fit(*_: object) -> None:
        pytest.fail("fitted first")

    monkeypatch.setattr("bench.export.making.fit_fold", fit)
    with pytest.raises(BenchError, match=said) as told:
        _bench("export", *words, "--data", finished[0], "-o", tmp_path / "out")
    assert "\n" not in str(told.value)
    assert not (tmp_path / "out").exists()


def test_a_c_backend_is_exported_as_the_backend_it_runs(finished, tmp_path, monkeypatch) -> None:
    """Where there is no compiler, too."""
    table, results = finished
    monkeypatch.setattr("backends.c.compile.compiler", lambda: None)
    words = ("--data", table, "--results", results, "-o")
    for backend in ("c-fp32", "fp32"):
        shown = _bench(
            "export", "--model", "constant", "--backend", backend, *words, tmp_path / backend
        ).stdout
        assert "not checked: no C compiler on this machine" in shown
    code = [(tmp_path / one / "uwb_predict.c").read_bytes() for one in ("c-fp32", "fp32")]
    assert code[0] == code[1]


def test_a_folder_below_a_file_is_refused_at_once(tmp_path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(BenchError, match="file is a file, expected a folder"):
        _bench("export", "--run", "12", "-o", tmp_path / "file" / "below")


def test_a_run_across_data_is_exported_with_the_rows_that_were_kept(finished, tmp_path) -> None:
    table, _ = finished
    other = tmp_path / "other.parquet"
    write_recordings(make_recordings(rows=60, seed=5), other)
    words = (
        "--model",
        "constant",
        "--backend",
        "fp32",
        "--no-timing",
        "--out",
        tmp_path / "across",
    )
    _bench("run", "--train", table, "--test", other, *words)
    [record] = (tmp_path / "across" / "runs").glob("*.json")
    words = ("export", "--run", record.stem, "--results", tmp_path / "across", "-o", tmp_path / "c")
    assert f"trained on {table}" in _bench(*words).stdout
    report = (tmp_path / "c" / "REPORT.md").read_text()
    assert f"Trained on {table}" in report
    assert f"tested on {other}" in report
    for file in (Path(os.environ["BENCH_CACHE"]) / "held-out").iterdir():
        file.unlink()
    with pytest.raises(BenchError, match="run it again on this machine into an empty folder"):
        _bench(*words)


def test_parts_that_lack_a_floating_point_unit_are_named() -> None:
    from bench.export.write import _unitless

    parts = [plugins.load("devices", name) for name in ("nrf52832", "rp2040", "esp32-c3")]
    integer = Chosen(Artifact(Path("model.onnx"), "int8", ""), "m", "int8", "d", True, np.empty(0))
    assert _unitless(integer, "float", parts) == ("rp2040", "esp32-c3")
    assert _unitless(integer, "fixed", parts) == ()
    plain = replace(integer, artifact=replace(integer.artifact, precision="fp32"))
    assert _unitless(plain, "float", parts) == ()
