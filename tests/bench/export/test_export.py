"""`bench export`: a folder that compiles, checks itself and says how well it agrees."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest
from click.testing import CliRunner
from recordings_factory import make_recordings

from backends.c.compile import missing_compiler
from bench.cli.main import group
from bench.errors import BenchError
from bench.export import Chosen, export, from_fit
from bench.export.report import Figures, report
from bench.measure.counting.measured import read_measured
from bench.recordings.io import write_recordings

needs_compiler = pytest.mark.skipif(missing_compiler() is not None, reason=str(missing_compiler()))
FILES = {"uwb_predict.c", "uwb_predict.h", "uwb_selftest.c", "Makefile", "LICENCE", "REPORT.md"}


Choose = Callable[[str], Chosen]


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("data") / "mine.parquet"
    write_recordings(make_recordings(rows=80), path)
    return path


@pytest.fixture(scope="module")
def chosen(recordings: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Choose]:
    """Return a function from a backend to the MLP on it, fitted once for all."""
    folder = tmp_path_factory.mktemp("chosen")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("BENCH_CACHE", str(folder))

        @cache
        def choose(backend: str) -> Chosen:
            (folder / backend).mkdir()
            words = (str(recordings), folder / "results", folder / backend)
            return from_fit("mlp", backend, *words, lambda _: None)

        yield choose


@pytest.fixture(scope="module")
def firmware(chosen: Choose, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The MLP as 8-bit C."""
    folder = tmp_path_factory.mktemp("firmware")
    export(chosen("int8"), "c", folder)
    return folder


def _export(*words: object) -> str:
    done = CliRunner().invoke(group, ["export", *map(str, words)], catch_exceptions=True)
    if done.exception is not None:
        raise done.exception
    return done.stdout


def _make(folder: Path) -> subprocess.CompletedProcess[str]:
    if shutil.which("make") is None:
        pytest.skip("no make (Debian: make)")
    words = ["make", "-C", str(folder), "CFLAGS=-O1"]
    return subprocess.run(words, capture_output=True, text=True, check=False)


@needs_compiler
@pytest.mark.parametrize("backend", ["int8", "fp16"])
def test_the_folder_compiles_and_its_self_test_passes(backend, chosen, tmp_path) -> None:
    done = export(chosen(backend), "c", tmp_path)
    assert {one.name for one in tmp_path.iterdir()} == FILES == set(done.files)
    assert done.agreement is not None
    assert done.agreement.equal > 0.99 or backend == "fp16"
    assert done.agreement.largest_m < 1e-5
    assert ("uint16_t uwb_weight" in (tmp_path / "uwb_predict.c").read_text()) == (
        backend == "fp16"
    )
    made = _make(tmp_path)
    assert made.returncode == 0, made.stderr
    assert "warning" not in made.stderr
    assert "0 of 10 rows failed" in made.stdout


def test_the_same_model_gives_the_same_bytes(chosen, firmware, tmp_path) -> None:
    export(chosen("int8"), "c", tmp_path)
    for name in FILES:
        assert (tmp_path / name).read_bytes() == (firmware / name).read_bytes()


@needs_compiler
def test_a_self_test_that_expects_something_else_fails(firmware, tmp_path) -> None:
    out = shutil.copytree(firmware, tmp_path / "firmware")
    text = (out / "uwb_selftest.c").read_text()
    table = re.search(r"expected_m\[10\] = \{\n(.*?)\};", text, re.S)
    assert table is not None
    (out / "uwb_selftest.c").write_text(text.replace(table[1], "    9.0f,\n" * 10))
    made = _make(out)
    assert made.returncode != 0
    assert "10 of 10 rows failed" in made.stdout


def test_report_says_where_figures_come_from_and_how_to_call(firmware) -> None:
    report = (firmware / "REPORT.md").read_text()
    for text in ("(SIMULATED)", "ACC_MEM (register 0x25)", "FP_INDEX", "157 samples", "counted"):
        assert text in report


def test_onnx_is_the_artifact(chosen, tmp_path) -> None:
    export(chosen("int8"), "onnx", tmp_path)
    assert {one.name for one in tmp_path.iterdir()} == {"model.onnx", "REPORT.md"}
    assert (tmp_path / "model.onnx").read_bytes() == chosen("int8").artifact.path.read_bytes()


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


def test_an_operator_c_is_not_written_for_is_named(chosen, tmp_path, monkeypatch) -> None:
    import backends.c.read_integer as reader

    known = {name: one for name, one in reader.INTEGER.items() if name != "QGemm"}
    monkeypatch.setattr(reader, "INTEGER", known)
    with pytest.raises(BenchError, match="mlp on int8: operator 'QGemm'"):
        export(chosen("int8"), "c", tmp_path / "out")
    assert not (tmp_path / "out").exists()


@needs_compiler
def test_a_finished_run_is_exported_by_its_id(recordings, tmp_path, monkeypatch) -> None:
    from bench.runner import run

    monkeypatch.setattr("bench.runner.api.time_artifacts", lambda *_: ([], []))
    results = tmp_path / "results"
    done = run("none", "fp32", str(recordings), out=results, device="nrf52832")
    [record] = done.runs
    words = ("--run", record.digest()[:8], "--results", results, "-o", tmp_path / "out")
    assert "none on fp32" in _export(*words)
    told = json.loads(_export(*words, "--json"))
    assert told["agreement"]["largest_m"] == 0
    artifact = results / "artifacts" / f"{record.digest()}-0.onnx"
    artifact.write_bytes(artifact.read_bytes() + b"x")
    with pytest.raises(BenchError, match="missing or damaged"):
        _export(*words)


def test_a_report_names_every_input_in_the_order_of_the_call(tmp_path) -> None:
    figures = Figures(False, None, 0, 0, 157, {"cir": "A", "levels": "B", "range": "C"})
    told = report(Chosen(None, "m", "fp32", "d", True, None), figures)
    assert "float cir[A], levels[B], range[C], error_m;" in told
    assert "uwb_predict(cir, levels, range, &error_m)" in told
    assert "`levels`, in this order: rx_power_dbm (dBm: 10 log10(CIR_PWR 2^17 / RXPACC^2)" in told
    assert "`range`, in this order: range_m (as measured). NaN" in told


@needs_compiler
def test_counted_cycles_are_those_of_the_latency_and_are_printed(
    recordings, tmp_path, monkeypatch
) -> None:
    from bench.runner import run

    monkeypatch.setattr("bench.runner.api.time_artifacts", lambda *_: ([], []))
    results, out = tmp_path / "results", tmp_path / "out"
    [record] = run("mlp", "int8", str(recordings), out=results).runs
    words = ("--run", record.digest()[:8], "--results", results, "-o", out)
    told = json.loads(_export(*words, "--device", "nrf52832", "--json"))["counted"]
    clock_khz = 64_000
    assert told[0]["cycles"] == pytest.approx(told[0]["latency_ms"] * clock_khz, rel=1e-4)
    report_row = f"| nrf52832: cycles of a call | {told[0]['cycles']} ["
    assert report_row in (out / "REPORT.md").read_text()
    assert f"nrf52832, counted: {told[0]['cycles']:,} cycles" in _export(
        *words, "--device", "nrf52832"
    )


def test_without_a_compiler_c_is_written_and_says_that_nothing_was_compared(
    chosen, tmp_path, monkeypatch
) -> None:
    from backends.c import compile as compiling

    monkeypatch.setattr(compiling, "compiler", lambda: None)
    assert export(chosen("int8"), "c", tmp_path).agreement is None
    assert "not checked: no C compiler" in (tmp_path / "REPORT.md").read_text()


@needs_compiler
def test_cycles_that_the_self_test_prints_are_what_count_measured_reads(firmware, tmp_path) -> None:
    out = shutil.copytree(firmware, tmp_path / "firmware")
    text = (out / "uwb_selftest.c").read_text()
    ticking = "static unsigned long ticks;\n#define CYCLES() (ticks += 1000ul)"
    assert "#define CYCLES() 0ul" in text
    (out / "uwb_selftest.c").write_text(text.replace("#define CYCLES() 0ul", ticking))
    (out / "board.txt").write_text(_make(out).stdout)
    assert read_measured(out / "board.txt").cycles == (1000,) * 10
