"""What is read back from a result folder is what was written for that key, or is made again."""

from __future__ import annotations

import json
import os
from dataclasses import fields, replace
from pathlib import Path
from typing import get_type_hints

import numpy as np
import pytest
from runner_tables import tiny

import bench
from bench import results as written
from bench.errors import BenchError
from bench.plugins import Plugin
from bench.provenance import sealed
from bench.recordings import write_recordings
from bench.recordings.table import Recordings
from bench.results import RunRecord
from bench.runner import api, keys
from reports import load as read


class Heard(bench.runner.observer.Observer):
    def __init__(self) -> None:
        self.notes: list[str] = []

    def note(self, line: str) -> None:
        self.notes.append(line)


@pytest.fixture(autouse=True)
def _untimed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Timing takes seconds and is tested elsewhere."""
    monkeypatch.setattr(api, "time_artifacts", lambda *_: ([], []))


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "tiny.parquet"
    write_recordings(tiny(), path)
    return path


def run(table: Path | Recordings, out: Path, **changes: object) -> tuple[RunRecord, list[str]]:
    heard = Heard()
    ask = {"model": "none", "backend": "fp32", "split": "link-kfold:2"} | changes
    data = table if isinstance(table, Recordings) else str(table)
    done = bench.run(data=data, out=out, observer=heard, **ask)
    assert not done.failures, done.failures
    return done.runs[0], heard.notes


def _files(out: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in sorted(out.rglob("*")) if path.is_file()}


def _edit(out: Path, change, reseal: bool = False) -> Path:
    (path,) = (out / "runs").glob("*.json")
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(sealed(content) if reseal else content))
    return path


def _better(content: dict) -> None:
    content["nlos"]["mae_m"]["value"] /= 2


def _other_seed(content: dict) -> None:
    content["key"]["seed"] = 7


def _real(content: dict) -> None:
    content["simulated"] = False


def _text_for_number(content: dict) -> None:
    content["nlos"]["mae_m"]["value"] = "0.01"


@pytest.mark.parametrize(
    ("change", "reseal", "said"),
    [
        (_better, False, "it was edited or damaged"),
        (_other_seed, True, "it is of another run: seed is 7, expected 0"),
        (_real, True, "its mark for simulated data is not that of its key"),
        (_text_for_number, True, "Expected `float`"),
    ],
)
def test_an_edited_record_is_named_and_made_again(change, reseal, said, table, tmp_path) -> None:
    out = tmp_path / "out"
    first, _ = run(table, out)
    path = _edit(out, change, reseal)
    again, notes = run(table, out)
    assert again.nlos == first.nlos
    assert len(notes) == 1
    assert path.name in notes[0]
    assert said in notes[0]
    assert run(table, out)[1] == []


def _lose_predictions(out: Path) -> Path:
    (path,) = (out / "predictions").iterdir()
    path.unlink()
    return path


def _damage_second_fold(out: Path) -> Path:
    (path,) = (out / "artifacts").glob("*-1.onnx")
    path.write_bytes(b"damaged")
    return path


@pytest.mark.parametrize("harm", [_lose_predictions, _damage_second_fold])
def test_a_file_of_any_fold_that_is_gone_or_damaged_is_noticed(harm, table, tmp_path) -> None:
    out = tmp_path / "out"
    run(table, out)
    before = _files(out)
    path = harm(out)
    _, notes = run(table, out)
    assert path.name in notes[0]
    assert path.read_bytes() == before[path]


def test_the_mark_for_simulated_data_is_never_stale(tmp_path: Path) -> None:
    simulated = tiny()
    real = replace(simulated, simulator=None)
    assert run(simulated, tmp_path / "out")[0].simulated
    assert not run(real, tmp_path / "out")[0].simulated


def test_another_name_of_a_link_is_another_run(tmp_path: Path) -> None:
    first = tiny()
    second = replace(first, frame=first.frame.assign(link="x" + first.frame["link"]))
    digests = {run(one, tmp_path / "out")[0].digest() for one in (first, second)}
    assert len(digests) == 2


def test_a_leftover_of_a_killed_run_is_removed_by_the_next(table, tmp_path) -> None:
    part = tmp_path / "out" / "artifacts" / ".abc-0.onnx.0123456789ab.part.onnx"
    part.parent.mkdir(parents=True)
    part.write_bytes(b"half")
    run(table, tmp_path / "out")
    assert not part.exists()


def test_estimates_follow_the_profiles_and_never_the_run(table, tmp_path, monkeypatch) -> None:
    # a part with a core would be counted, and a count does not follow the profile
    ask = {"model": "none", "backend": "fp32", "split": "link-kfold:2", "data": str(table)}
    one = bench.run(**ask, out=tmp_path / "out", device="rtx-2080")
    every = bench.run(**ask, out=tmp_path / "out", device="all")
    assert [e.device for e in one.estimates(one.runs[0])] == ["rtx-2080"]
    names = {plugin.name for plugin in bench.plugins.plugins("devices")}
    assert {e.device for e in every.estimates(every.runs[0])} == names
    assert one.runs == every.runs
    slow = bench.plugins.load("devices", "rtx-2080")
    slow = replace(slow, coefficients={**slow.coefficients, "t0_us": replace(_t0(slow), value=1e6)})
    before = one.estimates(one.runs[0])[0].latency_us.value
    monkeypatch.setattr(Plugin, "load", lambda self: slow)
    assert one.estimates(one.runs[0])[0].latency_us.value > before + 9e5


def _t0(profile):
    some = next(iter(profile.coefficients.values()))
    return profile.coefficients.get("t0_us", some)


def test_an_opener_in_a_record_is_never_used(table, tmp_path, monkeypatch) -> None:
    out = tmp_path / "out"
    run(table, out)
    _edit(out, lambda content: content.update(opener="os:system"), reseal=True)
    monkeypatch.undo()
    asked = []

    def measure(targets, **_):
        asked.extend(target.opener for target in targets)
        return [BenchError("not timed here") for _ in targets]

    monkeypatch.setattr("bench.runner.timing.measure", measure)
    done = bench.run("none", "fp32", str(table), split="link-kfold:2", out=out)
    assert asked == ["backends.ort:open_plain"]
    assert not hasattr(done.runs[0], "opener")


def _key(material, monkeypatch, **says):
    from backends.fp32 import Fp32Backend

    made = type("Mine", (Fp32Backend,), says)
    monkeypatch.setattr(Plugin, "make", lambda self: made())
    pair = (Plugin("models", "m", "zoo.none:A", "o"), Plugin("backends", "b", "zoo.none:B", "o"))
    return keys.run_key(*pair, material, 0)


def test_the_key_holds_what_the_plug_ins_declare(table, monkeypatch) -> None:
    from bench.runner.material import load_material

    material = load_material(str(table), "link-kfold:2")
    plain = _key(material, monkeypatch)
    assert plain.threads is None
    rests = _key(material, monkeypatch, rests_on=("msgspec",))
    assert set(rests.versions) - set(plain.versions) == {"msgspec"}
    reads = _key(material, monkeypatch, cache_key=lambda self: os.environ.get("TABLE", ""))
    monkeypatch.setenv("TABLE", "other")
    other = _key(material, monkeypatch, cache_key=lambda self: os.environ.get("TABLE", ""))
    threads = _key(material, monkeypatch, bits_depend_on_threads=True)
    assert threads.threads >= 1
    renamed = replace(plain, model_target="zoo.none:Other")
    every = (plain, rests, other, threads, renamed)
    assert len({key.digest() for key in every}) == len(every)
    assert plain == reads
    for name in ("onnxscript", "pandas", "pyarrow", "uwb-bench"):
        assert name in plain.versions


PAIRS = {
    "RunRecord": "Run",
    "RunKey": "Key",
    "TimingRecord": "Timing",
    "Score": "Score",
    "Interval": "Interval",
    "Cost": "Cost",
    "Layer": "Layer",
    "Latency": "Latency",
    "Estimate": "Estimate",
}
OF_READER = {"Run": {"estimates", "file"}, "Estimate": {"how"}}  # over seeds: "a and b"


@pytest.mark.parametrize(("writer", "reader"), PAIRS.items())
def test_reader_and_writer_have_one_schema(writer: str, reader: str) -> None:
    """Every field read is one written, of the same type and default."""
    made, taken = getattr(written, writer), getattr(read, reader)
    hints = {name: _shape(hint) for name, hint in get_type_hints(made).items()}
    for name, hint in get_type_hints(taken).items():
        if name not in OF_READER.get(reader, set()):
            assert hints[name] == _shape(hint), name
    if reader not in ("Run", "Latency", "Timing"):  # what reports does not show is not read
        assert {f.name for f in fields(taken)} >= {f.name for f in fields(made)} - {
            "schema_version",
            "kind",
        }


def _shape(hint: object) -> str:
    """Return a type as text, with the two packages' names of the same thing made one."""
    text = str(hint).replace("bench.results.", "").replace("reports.load.", "")
    text = text.replace("collections.abc.Mapping", "dict").replace("typing.", "")
    for mine, theirs in PAIRS.items():
        text = text.replace(mine, theirs)
    return text


def test_a_long_list_of_the_users_own_is_seen_to_its_middle() -> None:
    table = tiny()
    long = np.zeros(3000)
    other = long.copy()
    other[1500] = 1.0
    marks = []
    for cell in (long, other):
        column = np.empty(len(table), dtype=object)
        column[1:] = [cell] * (len(table) - 1)
        marks.append(replace(table, frame=table.frame.assign(mine=column)).fingerprint)
    assert marks[0] != marks[1]
    assert table.fingerprint not in marks
