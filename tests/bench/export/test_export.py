"""`bench export`: a folder that compiles, checks itself and says how well it agrees."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from recordings_factory import make_recordings

from backends.c.compile import missing_compiler
from bench.cli.main import group
from bench.errors import BenchError
from bench.recordings.io import write_recordings

needs_compiler = pytest.mark.skipif(missing_compiler() is not None, reason=str(missing_compiler()))
FILES = {"uwb_predict.c", "uwb_predict.h", "uwb_selftest.c", "Makefile", "LICENCE", "REPORT.md"}


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("data") / "mine.parquet"
    write_recordings(make_recordings(rows=80), path)
    return path


def _export(*words: object) -> str:
    done = CliRunner().invoke(group, ["export", *map(str, words)], catch_exceptions=True)
    if done.exception is not None:
        raise done.exception
    return done.stdout


@needs_compiler
@pytest.mark.parametrize("backend", ["int8", "fp16"])
def test_the_folder_compiles_and_its_self_test_passes(backend, recordings, tmp_path) -> None:
    out = tmp_path / "firmware"
    words = ("--model", "mlp", "--backend", backend, "--data", recordings, "-o", out, "--json")
    told = json.loads(_export(*words))
    assert {one.name for one in out.iterdir()} == FILES == set(told["files"])
    assert told["agreement"]["equal"] > 0.99 or backend == "fp16"
    assert told["agreement"]["largest_m"] < 1e-5
    if shutil.which("make") is None:
        pytest.skip("no make (Debian: make)")
    made = subprocess.run(["make", "-C", out], capture_output=True, text=True, check=False)
    assert made.returncode == 0, made.stderr
    assert "warning" not in made.stderr
    assert "0 of 10 rows failed" in made.stdout
    first = {one.name: one.read_bytes() for one in out.iterdir() if one.name in FILES}
    _export(*words)
    assert first == {name: (out / name).read_bytes() for name in first}


@needs_compiler
def test_a_self_test_that_expects_something_else_fails(recordings, tmp_path) -> None:
    out = tmp_path / "firmware"
    _export("--model", "mlp", "--backend", "fp32", "--data", recordings, "-o", out)
    text = (out / "uwb_selftest.c").read_text()
    table = re.search(r"expected_m\[10\] = \{\n(.*?)\};", text, re.S)
    assert table is not None
    (out / "uwb_selftest.c").write_text(text.replace(table[1], "    9.0f,\n" * 10))
    if shutil.which("make") is None:
        pytest.skip("no make (Debian: make)")
    made = subprocess.run(["make", "-C", out], capture_output=True, text=True, check=False)
    assert made.returncode != 0
    assert "10 of 10 rows failed" in made.stdout


def test_report_says_where_figures_come_from_and_how_to_call(recordings, tmp_path) -> None:
    out = tmp_path / "firmware"
    _export("--model", "none", "--backend", "fp32", "--data", recordings, "-o", out)
    report = (out / "REPORT.md").read_text()
    for text in ("(SIMULATED)", "ACC_MEM (register 0x25)", "FP_INDEX", "157 samples", "counted"):
        assert text in report


def test_onnx_is_the_artifact(recordings, tmp_path) -> None:
    from backends.ort import open_plain

    out = tmp_path / "onnx"
    words = ("--model", "mlp", "--backend", "fp32", "--data", recordings, "--to", "onnx", "-o", out)
    _export(*words)
    assert {one.name for one in out.iterdir()} == {"model.onnx", "REPORT.md"}
    assert np.isfinite(open_plain(out / "model.onnx")(np.ones((2, 157), np.float32))).all()


def test_bad_input_is_one_line_and_writes_nothing(recordings, tmp_path) -> None:
    out = tmp_path / "firmware"
    file = tmp_path / "file"
    file.write_text("")
    model = ("--model", "mlp", "--backend", "fp32", "--data", recordings)
    cases = [
        (("--model", "mlp", "-o", out), "--backend"),
        (("--model", "mpl", "--backend", "fp32", "-o", out), "did you mean 'mlp'"),
        (("--run", "0123", "-o", out), "0 runs"),
        (("--run", "../x", "-o", out), "expected the hexadecimal id"),
        (("--run", "01", "--model", "mlp", "-o", out), "leave --model"),
        (("--model", "none", "--backend", "int8", "--data", recordings, "-o", out), "no weights"),
        ((*model, "-o", file), "expected a folder"),
    ]
    for words, text in cases:
        with pytest.raises(BenchError, match=text) as told:
            _export(*words)
        assert "\n" not in str(told.value)
    assert not out.exists()


def test_an_operator_c_is_not_written_for_is_named(recordings, tmp_path, monkeypatch) -> None:
    import backends.c.read_float as reader

    known = {name: one for name, one in reader.FLOAT.items() if name != "Gemm"}
    monkeypatch.setattr(reader, "FLOAT", known)
    with pytest.raises(BenchError, match="mlp on fp32: operator 'Gemm'"):
        _export("--model", "mlp", "--backend", "fp32", "--data", recordings, "-o", tmp_path / "out")
    assert not (tmp_path / "out").exists()


@needs_compiler
def test_a_finished_run_is_exported_by_its_id(recordings, tmp_path) -> None:
    from bench.runner import run

    results = tmp_path / "results"
    done = run("mlp", "fp32", str(recordings), out=results, device="nrf52832")
    [record] = done.runs
    words = ("--run", record.digest()[:8], "--results", results, "-o", tmp_path / "out")
    shown = _export(*words)
    assert "mlp on fp32" in shown
    artifact = results / "artifacts" / f"{record.digest()}-0.onnx"
    artifact.write_bytes(artifact.read_bytes() + b"x")
    with pytest.raises(BenchError, match="missing or damaged"):
        _export(*words)
