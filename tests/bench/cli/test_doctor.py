"""`bench doctor`: what is missing, how to get it, and the exit code."""

from __future__ import annotations

import json
from importlib.metadata import PackageNotFoundError

import pytest
from click.testing import CliRunner

from bench.cli import doctor
from bench.cli.main import group
from bench.plugins import Plugin


def _findings(code: int = 0) -> dict[str, dict[str, str]]:
    done = CliRunner().invoke(group, ["doctor", "--json"])
    assert done.exit_code == code, done.output
    return {one["what"]: one for one in json.loads(done.output)}


@pytest.fixture(autouse=True)
def _no_data(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("BENCH_DATA", raising=False)


def test_a_healthy_machine_is_exit_0_and_everything_is_named() -> None:
    found = _findings()
    for what in ("Python", "torch", "onnxruntime", "processor", "memory", "instruction sets"):
        assert found[what]["found"]
    assert found["cache folder"]["verdict"] == "ok"
    assert {"emulator of microcontrollers", "cross compiler"} <= set(found)
    assert {"data set rooms", "data set apartment", "core pinning"} <= set(found)
    assert "RAPL" in found["energy counters (RAPL)"]["found"]


def test_what_it_prints_is_lines_with_remedies() -> None:
    shown = CliRunner().invoke(group, ["doctor"]).output
    assert "ok       Python: 3." in shown
    assert "-> set BENCH_DATA to a folder of recordings" in shown


def test_a_missing_package_is_exit_1_with_the_command_that_gets_it(monkeypatch) -> None:
    real = doctor.version

    def without_torch(name: str) -> str:
        if name == "torch":
            raise PackageNotFoundError(name)
        return real(name)

    monkeypatch.setattr(doctor, "version", without_torch)
    found = _findings(code=1)
    assert found["torch"]["remedy"] == "pip install -c constraints.txt torch"


def test_a_cache_that_cannot_be_written_is_exit_1(monkeypatch, tmp_path) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("BENCH_CACHE", str(tmp_path / "file" / "cache"))
    found = _findings(code=1)["cache folder"]
    assert "cannot write" in found["found"]
    assert "BENCH_CACHE" in found["remedy"]


def test_the_probe_of_the_cache_leaves_nothing(monkeypatch, tmp_path) -> None:
    monkeypatch.setenv("BENCH_CACHE", str(tmp_path / "cache"))
    _findings()
    assert not any(path.is_file() for path in (tmp_path / "cache").rglob("*"))


def test_data_that_is_not_there_is_a_note_and_a_wrong_folder_an_error(
    monkeypatch, tmp_path
) -> None:
    monkeypatch.setenv("BENCH_DATA", str(tmp_path))
    found = _findings()
    assert found["BENCH_DATA"]["verdict"] == "ok"
    assert found["data set apartment"]["verdict"] == "info"
    assert "bench data fetch apartment" in found["data set apartment"]["remedy"]
    monkeypatch.setenv("BENCH_DATA", str(tmp_path / "absent"))
    assert "is no folder" in _findings(code=1)["BENCH_DATA"]["found"]


def test_real_data_is_seen(monkeypatch, real_data) -> None:
    monkeypatch.setenv("BENCH_DATA", str(real_data))
    assert _findings()["data set apartment"]["verdict"] == "ok"


def test_a_broken_plug_in_is_named_with_its_distribution(monkeypatch) -> None:
    real = doctor.plugins

    def with_broken(name: str) -> list[Plugin]:
        more = [Plugin("models", "odd", "no_such_package:Model", "their-package")]
        return [*real(name), *(more if name == "models" else [])]

    monkeypatch.setattr(doctor, "plugins", with_broken)
    found = _findings(code=1)["models plug-in odd"]
    assert "ModuleNotFoundError" in found["found"]
    assert found["remedy"] == "update or uninstall their-package"


@pytest.mark.parametrize(
    ("sets", "advised"), [(["avx2"], True), (["avx2", "avx512_vnni"], False), ([], False)]
)
def test_a_processor_without_8_bit_dot_products_is_told(monkeypatch, sets, advised) -> None:
    described = {"cpu": "abacus", "cores": 1, "memory_gib": 1.0, "instruction_sets": sets}
    monkeypatch.setattr(doctor, "describe_machine", lambda: described)
    remedy = _findings()["instruction sets"]["remedy"]
    assert ("VNNI" in remedy) is advised
