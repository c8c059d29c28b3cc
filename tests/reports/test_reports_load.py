from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
import result_files as files

from bench.provenance import sealed
from reports import ReportError, read_results


def test_records_come_back_as_they_were_written(tmp_path: Path) -> None:
    record = files.run("remnet", "int8", seed=3, integer_kernels="14/14")
    timing = files.timing(record, 42.0)
    results = files.read(tmp_path, record, timing)
    (run,) = results.runs
    assert (run.key.model, run.key.backend, run.key.seed) == ("remnet", "int8", 3)
    assert run.nlos is not None
    assert run.nlos.mae_m.value == record.nlos.mae_m.value
    assert run.estimates[1].reason == "runs int8 only"
    assert run.integer_kernels == "14/14"
    (read,) = results.timings
    assert read.latency[0].median_us == 42.0
    assert read.machine == files.MACHINE
    assert results.unreadable == []


def _sealed(kind: str) -> str:
    return json.dumps(sealed({"schema_version": 2, "kind": kind}))


BAD = {
    "truncated": ('{"kind": "run", ', "not JSON"),
    "binary": (b"\xff\xfe\x00", "not JSON"),
    "a list": ("[1]", "not a JSON object"),
    "deep": ("[" * 200_000, "recursion"),
    "another version": ('{"schema_version": 1, "kind": "run"}', "schema_version 1, expected 2"),
    "no version": ('{"kind": "run"}', "schema_version None, expected 2"),
    "not hashed": ('{"schema_version": 2, "kind": "run"}', "edited or damaged"),
    "another kind": (_sealed("timing"), "kind 'timing', expected 'run'"),
    "no key": (_sealed("run"), "missing required field `key`"),
}


@pytest.mark.parametrize(("content", "reason"), BAD.values(), ids=BAD)
def test_a_bad_file_is_left_out_with_its_reason(
    tmp_path: Path, content: str | bytes, reason: str
) -> None:
    files.write(tmp_path, files.run())
    raw = content if isinstance(content, bytes) else content.encode()
    (tmp_path / "runs" / "bad.json").write_bytes(raw)
    results = read_results(tmp_path)
    assert len(results.runs) == 1
    (bad,) = results.unreadable
    assert bad.path == "runs/bad.json"
    assert reason in bad.reason


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("nlos", "mae_m", "value"), "0.07"),
        (("key", "seed"), "first"),
        (("status",), "maybe"),
        (("cost",), []),
        (("simulated",), None),
    ],
)
def test_a_value_of_the_wrong_type_is_named(
    tmp_path: Path, path: tuple[str, ...], value: object
) -> None:
    files.write(tmp_path, files.run())
    (good,) = (tmp_path / "runs").glob("*.json")
    content = json.loads(good.read_text())
    place = content
    for name in path[:-1]:
        place = place[name]
    place[path[-1]] = value
    (tmp_path / "runs" / "bad.json").write_text(json.dumps(sealed(content)))
    results = read_results(tmp_path)
    assert len(results.runs) == 1
    assert path[-1] in results.unreadable[0].reason


def test_figures_that_are_not_finite_are_read(tmp_path: Path) -> None:
    nan = files.Interval(float("nan"))
    results = files.read(tmp_path, files.run(nlos=files.score(r2=nan)))
    assert results.unreadable == []
    assert results.runs[0].nlos.r2.value != results.runs[0].nlos.r2.value


def test_a_file_still_being_written_is_ignored(tmp_path: Path) -> None:
    files.write(tmp_path, files.run())
    (tmp_path / "runs" / ".abc.json.x.part.json").write_text("{")
    assert read_results(tmp_path).unreadable == []


def test_an_oversized_file_is_not_read(tmp_path: Path) -> None:
    files.write(tmp_path, files.run())
    with (tmp_path / "runs" / "big.json").open("wb") as stream:
        os.truncate(stream.fileno(), 65_000_000)
    assert "larger than 64000000 bytes" in read_results(tmp_path).unreadable[0].reason


def test_no_folder_and_no_results_are_told_apart(tmp_path: Path) -> None:
    with pytest.raises(ReportError, match=r"no results folder .*absent"):
        read_results(tmp_path / "absent")
    with pytest.raises(ReportError, match=r"no results in .*expected runs/\*\.json"):
        read_results(tmp_path)


def test_only_bad_files_is_an_error_that_names_the_first(tmp_path: Path) -> None:
    (tmp_path / "runs").mkdir()
    (tmp_path / "runs" / "bad.json").write_text("{")
    with pytest.raises(ReportError, match=r"1 unreadable, the first runs/bad\.json: not JSON"):
        read_results(tmp_path)
