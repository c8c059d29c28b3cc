"""Result folders from elsewhere: records that are whole, model files that are hostile."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from onnx import TensorProto, helper, numpy_helper
from recordings_factory import make_recordings

from bench.cli.main import group
from bench.errors import BenchError
from bench.export.selftest import selftest
from bench.files import read_json
from bench.measure.counting import find_compiler, load_core
from bench.measure.counting.emulate import check_tools
from bench.provenance import file_sha256
from bench.recordings.io import write_recordings
from bench.results import RunRecord, from_json, to_json
from bench.runner.finished import finished_runs

NODE = helper.make_node


def _model(nodes: list[object], name: str = "cir", width: int = 157, **tensors: object) -> bytes:
    given = helper.make_tensor_value_info(name, TensorProto.FLOAT, [None, width])
    result = helper.make_tensor_value_info("y", TensorProto.FLOAT, None)
    stored = [numpy_helper.from_array(np.asarray(v), n) for n, v in tensors.items()]
    graph = helper.make_graph(nodes, "g", [given], [result], stored)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 20)], ir_version=10)
    if width == 0:
        del model.graph.input[0].type.tensor_type.shape.dim[:]
    return model.SerializeToString()


SUM = [NODE("ReduceSum", ["cir", "axes"], ["y"], keepdims=0)]
AXES = np.array([1], np.int64)
HUGE = np.array([1 << 30, 1 << 30], np.int64)
EVIL = 'x; system("rm")'
HOSTILE = {
    "cycle": (_model([NODE("Add", ["cir", "b"], ["a"]), NODE("Relu", ["a"], ["b"])]), "a cycle"),
    "huge": (_model([NODE("Expand", ["cir", "to"], ["y"])], to=HUGE), "Expand"),
    "wide": (_model(SUM, width=1 << 40, axes=AXES), "takes 1099511627776 values a row"),
    "narrow": (_model(SUM, width=11, axes=AXES), "takes 11 values a row, the recordings have 157"),
    "rank": (_model(SUM, width=0, axes=AXES), "an input is not"),
    "names": (_model([NODE("ReduceSum", [EVIL], ["y"])], EVIL), "no model of the bench"),
    "operator": (_model([NODE("Det", ["cir"], ["y"])]), "Det"),
    "garbage": (b"\x00\xff", "no readable ONNX model"),
}


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, RunRecord]:
    """Recordings, and the record of a run on them."""
    folder = tmp_path_factory.mktemp("finished")
    write_recordings(make_recordings(rows=80), folder / "mine.parquet")
    words = ["run", "--model", "constant", "--backend", "fp32", "--no-timing"]
    words += ["--data", str(folder / "mine.parquet"), "--out", str(folder / "results")]
    assert CliRunner().invoke(group, words).exit_code == 0
    [path] = (folder / "results" / "runs").glob("*.json")
    return folder / "mine.parquet", from_json(RunRecord, read_json(path))


def _folder(tmp_path: Path, record: RunRecord, content: bytes) -> Path:
    """Return a result folder whose record says that this is its file."""
    (tmp_path / "runs").mkdir()
    (tmp_path / "artifacts").mkdir()
    file = tmp_path / "artifacts" / f"{record.digest()}-0.onnx"
    file.write_bytes(content)
    sums = file_sha256(file)
    told = to_json(replace(record, artifact_sha256=sums, artifacts_sha256=(sums,)))
    (tmp_path / "runs" / f"{record.digest()}.json").write_text(told)
    return tmp_path


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_refused_and_nothing_is_written(name, finished, tmp_path) -> None:
    _, record = finished
    content, said = HOSTILE[name]
    results, out = _folder(tmp_path, record, content), tmp_path / "out"
    words = ["export", "--run", record.digest(), "--results", str(results), "-o", str(out)]
    done = CliRunner().invoke(group, words)
    assert isinstance(done.exception, BenchError)
    assert said in str(done.exception)
    assert not out.exists()


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_not_counted(name, finished, tmp_path) -> None:
    try:
        check_tools()
        find_compiler(load_core("cortex-m4f"))
    except BenchError as problem:
        pytest.skip(str(problem))
    data, record = finished
    content, said = HOSTILE[name]
    words = ["count", "--model", "constant", "--backend", "fp32", "--data", str(data), "--json"]
    words += ["--device", "nrf52832", "--results", str(_folder(tmp_path, record, content))]
    done = CliRunner().invoke(group, words)
    assert isinstance(done.exception, BenchError)
    assert said in json.loads(done.stdout)[0]["reason"]


def test_a_truncated_record_is_left_out_by_name(finished, tmp_path: Path) -> None:
    folder, record = finished
    good = folder.parent / "results" / "runs" / f"{record.digest()}.json"
    (tmp_path / "runs").mkdir()
    (tmp_path / "runs" / good.name).write_bytes(good.read_bytes())
    (tmp_path / "runs" / "cut.json").write_bytes(good.read_bytes()[:100])
    told: list[str] = []
    assert [one.digest() for one in finished_runs(tmp_path, told.append)] == [record.digest()]
    assert len(told) == 1
    assert "cut.json: left out, it cannot be read (not JSON" in told[0]


def test_the_board_unlocks_its_cycle_counter_before_starting_it() -> None:
    text = selftest(np.zeros((1, 3), np.float32), np.zeros(1, np.float32), 1e-5)
    assert 0 < text.index("DWT_LAR = 0xC5ACCE55ul;") < text.index("DWT_CYCCNT = 0;")
