"""`bench simulate`: chunks, files, and what a user gets wrong."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from physics_scenes import line

from bench.cli.main import main
from bench.errors import BenchError, WriteError
from bench.physics import Simulator, from_toml
from bench.physics import stream as streaming
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.ranging.time_lag import TimeLag
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.rooms import Rooms
from bench.recordings.io import read_recordings, write_recordings
from bench.recordings.motion import with_radial_speed
from bench.recordings.parquet import lists, to_arrow
from bench.recordings.table import Recordings

SIMULATOR = Simulator(effects=(DiffuseTail(), TimestampJitter()), seed=4, name="mine")


def bench(monkeypatch, *words: str | Path) -> int:
    """Run the command line; return its exit code."""
    monkeypatch.setattr("sys.argv", ["bench", *map(str, words)])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


def test_chunks_give_what_one_piece_gives(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(streaming, "CHUNK", 1024)
    frame = line(3000)
    pieces = [frame.iloc[:10], frame.iloc[10:1500], frame.iloc[1500:]]
    tally = streaming.simulate_to(SIMULATOR, pieces, tmp_path / "out.parquet")
    made = read_recordings(tmp_path / "out.parquet")
    whole = SIMULATOR.simulate(frame)
    np.testing.assert_array_equal(made.frame["range_m"], whole.frame["range_m"])
    np.testing.assert_array_equal(np.stack(made.frame["cir"]), np.stack(whole.frame["cir"]))
    assert made.simulated
    assert made.seed == 4
    assert from_toml(made.simulator or "") == SIMULATOR
    assert tally.rows == 3000
    assert abs(tally.mae_m - np.abs(whole.errors_m()).mean()) < 1e-12


@pytest.mark.parametrize("rows", [0, streaming.MANY_ROWS])
def test_processes_give_what_threads_give(rows: int, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(streaming, "CHUNK", 1024)
    monkeypatch.setenv("BENCH_THREADS", "2")
    frame = line(3000).assign(time_s=np.arange(3000) * 0.1)
    lagging = Simulator(effects=(DiffuseTail(), TimeLag(lag_s=0.1)), seed=4)
    streaming.simulate_to(lagging, [frame], tmp_path / "out.parquet", rows=rows)
    made = read_recordings(tmp_path / "out.parquet").frame
    parts = [frame.iloc[at : at + 1024] for at in (0, 1024, 2048)]  # speeds are of chunks
    speeds = pd.concat([with_radial_speed(part) for part in parts], ignore_index=True)
    whole = lagging.simulate(speeds).frame
    np.testing.assert_array_equal(made["range_m"], whole["range_m"])
    np.testing.assert_array_equal(np.stack(made["cir"]), np.stack(whole["cir"]))


def test_effects_of_the_users_own_stay_in_this_process(tmp_path: Path, monkeypatch) -> None:
    """Another might not find them."""

    class Own(TimestampJitter):
        pass

    monkeypatch.setattr(streaming, "in_processes", None)
    mine = Simulator(effects=(Own(),), seed=4)
    tally = streaming.simulate_to(mine, [line(50)], tmp_path / "o.parquet", rows=10**6)
    assert tally.rows == 50


def test_rechunked_keeps_every_row_in_order() -> None:
    frame = line(1000)
    parts = list(streaming.rechunked([frame.iloc[:7], frame.iloc[7:950], frame.iloc[950:]], 300))
    assert [len(part) for part in parts] == [300, 300, 300, 100]
    np.testing.assert_array_equal(pd.concat(parts)["true_range_m"], frame["true_range_m"])


def test_rooms_beyond_one_campaign_are_new_rooms(monkeypatch) -> None:
    monkeypatch.setattr(streaming, "ROW_TOTAL", 2000)
    frames = list(streaming.rooms(3000, seed=0))
    assert sum(map(len, frames)) == 3000
    links = [set(frame["link"]) for frame in frames]
    assert not links[0] & links[1]
    assert not np.array_equal(frames[0]["tx_x_m"][:900], frames[1]["tx_x_m"][:900])


def test_command_simulates_rooms(tmp_path: Path, monkeypatch, capsys) -> None:
    out = tmp_path / "rooms.parquet"
    assert bench(monkeypatch, "simulate", "rooms", "--rooms", "-n", 1500, "-o", out) == 0
    said = capsys.readouterr().out
    assert "1500 SIMULATED rows" in said
    made = read_recordings(out)
    expected = Rooms().generate(1500)
    np.testing.assert_array_equal(made.frame["range_m"], expected.frame["range_m"])
    assert made.label == "rooms (SIMULATED)"


def test_command_simulates_at_recorded_geometry(tmp_path: Path, monkeypatch, capsys) -> None:
    given, sim, out = (tmp_path / name for name in ("given.parquet", "sim.toml", "out.parquet"))
    write_recordings(Recordings(line(100, range_m=5.0, cir=[np.ones(9)] * 100), "mine"), given)
    sim.write_text("[[effects]]\neffect = 'diffuse-tail'\n")
    words = ("simulate", sim, "--geometry", given, "-o", out, "--seed", 3, "--json")
    assert bench(monkeypatch, *words) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["rows"] == 100
    assert facts["simulated"] is True
    assert facts["seed"] == 3
    assert facts["effects"] == ["diffuse-tail"]
    made = read_recordings(out)
    assert made.seed == 3
    assert made.frame["cir"].iloc[0].shape == (157,)
    np.testing.assert_allclose(made.frame["true_range_m"], line(100)["true_range_m"])


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["roms", "--rooms", "-o", "x.parquet"], "did you mean 'rooms'"),
        (["none.toml", "--rooms", "-o", "x.parquet"], "cannot read none.toml"),
        (["rooms", "-o", "x.parquet"], "either --geometry RECORDINGS.parquet or --rooms"),
        (["rooms", "--rooms", "--geometry", "g.parquet", "-o", "x.parquet"], "either --geometry"),
        (["rooms", "--geometry", "g.parquet", "-n", "3", "-o", "x.parquet"], "-n goes with"),
        (["rooms", "--rooms", "-n", "0", "-o", "x.parquet"], "expected 1 to 1000000000 rows"),
        (["rooms", "--rooms", "-o", "x.csv"], "expected a .parquet name"),
        (["rooms", "--rooms", "--seed", "-1", "-o", "x.parquet"], "0 or more"),
        (["rooms", "--geometry", "none.parquet", "-o", "x.parquet"], "none.parquet: cannot be"),
        (["rooms", "--geometry", "text.parquet", "-o", "x.parquet"], "text.parquet: cannot be"),
        (["rooms", "--geometry", "g.parquet", "-o", "g.parquet"], "would replace the geometry"),
        (["rooms", "--geometry", "bare.parquet", "-o", "x.parquet"], "no column 'true_range_m'"),
        (["rooms", "--geometry", "empty.parquet", "-o", "x.parquet"], "no rows"),
        (["bad.toml", "--rooms", "-o", "x.parquet"], "bad.toml: unknown effect 'x'"),
        (["rooms", "--rooms", "-o", "text.parquet/x.parquet"], "cannot write"),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(
    words: list[str], message: str, tmp_path: Path, monkeypatch, capsys
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("text.parquet").write_text("no Parquet at all")
    Path("bad.toml").write_text("[[effects]]\neffect = 'x'\n")
    line(10).to_parquet("g.parquet")
    line(10).head(0).to_parquet("empty.parquet")
    pd.DataFrame({"range_m": [1.0]}).to_parquet("bare.parquet")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert bench(monkeypatch, "simulate", *words) == 2
    said = capsys.readouterr().err
    assert message in said
    assert said.startswith("bench: ")
    assert said.count("\n") == 1
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_full_disk_leaves_nothing(tmp_path: Path, monkeypatch) -> None:
    import pyarrow.parquet as pq

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(pq.ParquetWriter, "write_table", full)
    with pytest.raises(WriteError, match="No space left"):
        streaming.simulate_to(SIMULATOR, [line(50)], tmp_path / "out.parquet")
    assert not list(tmp_path.iterdir())


def test_no_geometry_is_said(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match="no rows"):
        streaming.simulate_to(SIMULATOR, [], tmp_path / "out.parquet")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("samples", [0, 7])
def test_cirs_of_a_block_are_written_like_those_of_rows(samples: int) -> None:
    cir = np.arange(3 * samples, dtype=np.float32).reshape(3, samples)
    made = pd.DataFrame({"range_m": np.ones(3), "cir": list(cir)})
    assert to_arrow(Recordings(made, "mine"))["cir"].to_pylist() == lists(cir).to_pylist()
    assert to_arrow(Recordings(made, "mine"))["cir"].type == lists(cir).type
