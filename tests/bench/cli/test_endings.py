"""Every failure ends in one line and exit code 2; no file and no plug-in spoils the output."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import click
import numpy as np
import pytest
from click.testing import CliRunner
from recordings_factory import make_frame, make_recordings

from bench.cli import console, failing
from bench.cli.main import group
from bench.errors import BenchError, WriteError, foreign
from bench.export import check_folder
from bench.files import atomic_path, check_output, read_json, remove_leftovers, write_atomically
from bench.physics.toml_file import from_toml, read_toml
from bench.plugins import Plugin, plugins
from bench.recordings import read_recordings, write_recordings
from bench.recordings.clean import clean
from bench.text import plain, reason
from reports import plain as of_reports

ESCAPE = "\x1b]0;owned\x07\x1b[31m"


class UnspeakableError(Exception):
    def __str__(self) -> str:
        raise ValueError("no text")


def _raise(problem: BaseException):
    def work() -> None:
        raise problem

    return work


@pytest.mark.parametrize(
    ("problem", "said"),
    [
        (BenchError(f"{ESCAPE}x\nsecond"), r"bench: \x1b]0;owned\x07\x1b[31mx second"),
        (ValueError("deep\ninside"), "ValueError: deep; --traceback shows where"),
        (UnspeakableError(), "its message cannot be had: ValueError"),
        (SystemExit(0), "it tried to end the program (exit code 0)"),
        (MemoryError(), "not enough memory"),
        (RecursionError("too deep"), "RecursionError: too deep"),
        (OSError(36, "File name too long", "n" * 300), "File name too long"),
        (OSError(28, "No space left on device"), "standard output: No space left on device"),
    ],
)
def test_any_failure_is_one_plain_line(problem, said, capsys, monkeypatch) -> None:
    monkeypatch.setattr(failing, "_drop_output", lambda: None)
    assert failing.ended_with(_raise(problem)) == 2
    told = capsys.readouterr().err
    assert said in told
    assert told.count("\n") == 1
    assert "\x1b" not in told


def test_interrupts_and_readers_who_left_have_codes_of_their_own(capsys, monkeypatch) -> None:
    monkeypatch.setattr(failing, "_drop_output", lambda: None)
    assert failing.ended_with(_raise(KeyboardInterrupt())) == 130
    capsys.readouterr()
    assert failing.ended_with(_raise(BrokenPipeError(32, "Broken pipe"))) == 141
    assert capsys.readouterr().err == ""
    assert failing.ended_with(lambda: 1) == 1
    assert failing.ended_with(lambda: None) == 0


def test_the_traceback_is_shown_on_request_alone(capsys) -> None:
    assert failing.ended_with(_raise(ValueError("x")), traceback=True) == 2
    assert "Traceback" in capsys.readouterr().err


def _bench(*ask: str, **options) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "bench", *ask], text=True, **options)


def test_a_full_and_a_left_output_end_quietly() -> None:
    with Path("/dev/full").open("w") as full:
        done = _bench("devices", stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == 2
    assert done.stderr.splitlines() == [
        "bench: standard output: No space left on device; --traceback shows where"
    ]
    reading, writing = os.pipe()
    os.close(reading)
    done = _bench("devices", stdout=writing, stderr=subprocess.PIPE)
    os.close(writing)
    assert (done.returncode, done.stderr) == (141, "")


def test_a_command_is_one_line_and_takes_traceback_anywhere(tmp_path: Path) -> None:
    done = _bench("data", "info", str(tmp_path / ("n" * 300)) + ".parquet", capture_output=True)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    done = _bench("devices", "nobody", "--traceback", capture_output=True)
    assert "Traceback" in done.stderr
    assert done.stderr.splitlines()[-1].startswith("bench: unknown device 'nobody'")


def test_what_others_print_goes_to_the_error_stream(capfd) -> None:
    with console.foreign_prints_to_stderr():
        print("from a plug-in")
        os.write(1, b"from compiled code\n")
        console.say('{"ours": 1}')
    out, err = capfd.readouterr()
    assert "ours" in out
    assert "plug-in" not in out
    assert "from a plug-in" in err


def test_markup_and_escapes_in_names_are_shown_and_never_interpreted(capsys) -> None:
    name = f"[bold]m[/x]{ESCAPE}"
    console.print_table("t", ("name",), [(name,)])
    console.console().print(name)
    with console.busy(name) as tell:
        tell(name)
    told = capsys.readouterr()
    assert told.out.count("[bold]m[/x]\\x1b]0;owned") == 2
    assert "\x1b" not in told.out + told.err


def test_a_table_with_markup_in_its_name_is_described(tmp_path: Path) -> None:
    path = tmp_path / f"[bold]m[{ESCAPE}x].parquet"
    write_recordings(make_recordings(source=f"[/nothing]{ESCAPE}"), path)
    done = CliRunner().invoke(group, ["data", "info", str(path)])
    assert done.exception is None
    assert "\x1b" not in done.output
    assert "[/nothing]\\x1b" in done.output


def test_both_packages_make_text_plain_alike() -> None:
    every = "".join(map(chr, range(0x3000))) + "\ud800"
    assert plain(every) == of_reports.plain(every)
    assert plain("µ Grüße\n\t") == "µ Grüße\n\t"
    assert of_reports.tame("$a$") == r"\$a\$"


def test_reasons_and_foreign_code() -> None:
    assert reason(UnspeakableError()).startswith("UnspeakableError: (its message cannot be had")
    with (
        pytest.raises(BenchError, match="effect 'x': it tried to end the program"),
        foreign("effect 'x'"),
    ):
        sys.exit(0)


def _device(folder: Path) -> Path:
    path = folder / "device"
    path.symlink_to("/dev/null")
    return path


def _pipe(folder: Path) -> Path:
    os.mkfifo(folder / "pipe")
    return folder / "pipe"


def _nowhere(folder: Path) -> Path:
    (folder / "nowhere").symlink_to(folder / "absent")
    return folder / "nowhere"


def _loop(folder: Path) -> Path:
    (folder / "loop").symlink_to(folder / "loop")
    return folder / "loop"


@pytest.mark.parametrize("make", [_device, _pipe, _nowhere, _loop])
def test_only_regular_files_are_written_and_read(make, tmp_path: Path) -> None:
    path = make(tmp_path)
    before = os.lstat(path)[:3]  # mode, inode, device
    with pytest.raises(WriteError, match="expected a regular file"):
        write_atomically(path, "x")
    assert os.lstat(path)[:3] == before
    with pytest.raises(BenchError):
        read_json(path)
    assert Path("/dev/null").is_char_device()


def test_a_link_to_a_file_is_written_through(tmp_path: Path) -> None:
    (tmp_path / "real").write_text("old")
    (tmp_path / "link").symlink_to("real")
    write_atomically(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_text() == "new"


def test_leftovers_are_removed_unless_their_writer_lives(tmp_path: Path) -> None:
    left = tmp_path / ".x.json.0123456789ab.part.json"
    left.write_text("half")
    mine = tmp_path / ".mine.part"
    mine.write_text("not ours")
    with atomic_path(tmp_path / "x.json") as scratch:
        assert not left.exists()
        ask = f"from bench.files import *; remove_leftovers(Path({str(tmp_path)!r}))"
        subprocess.run([sys.executable, "-c", ask], check=True)
        assert scratch.exists()
    assert sorted(path.name for path in tmp_path.iterdir()) == [".mine.part", "x.json"]
    remove_leftovers(tmp_path / "absent")


@pytest.mark.parametrize(
    "text", ["seed = " + "9" * 5000, "a = " + "[" * 100_000, f"[base]\nsnr_db = {10**400}", "a ="]
)
def test_a_simulator_no_one_can_read_is_one_line(text: str, tmp_path: Path) -> None:
    with pytest.raises(BenchError, match=r"^here: ") as caught:
        from_toml(text, "here")
    assert len(str(caught.value)) < 400
    with pytest.raises(BenchError, match="expected a regular file"):
        read_toml(_pipe(tmp_path))


def test_an_infinite_count_in_the_metadata_is_no_count(tmp_path: Path) -> None:
    import pyarrow.parquet as pq

    path = tmp_path / "m.parquet"
    write_recordings(make_recordings(), path)
    table = pq.read_table(path)
    meta = {**table.schema.metadata, b"dropped": b'{"x": 1e400}', b"seed": b"9" * 5000}
    pq.write_table(table.replace_schema_metadata(meta), path)
    assert read_recordings(path).dropped == {}


def test_a_table_in_millimetres_is_refused() -> None:
    frame = make_frame()
    frame[["range_m", "true_range_m"]] *= 1000
    with pytest.raises(BenchError, match="are they millimetres"):
        clean(frame, "t")


def test_impossible_counts_and_infinities_of_own_columns_are_dropped() -> None:
    frame = make_frame().assign(preamble_count=100.0, mine=1.0)
    frame.loc[0, "preamble_count"], frame.loc[1, "mine"] = -3.0, np.inf
    found = clean(frame, "t")
    assert found.dropped == {"preamble_count is negative": 1, "mine is infinite": 1}
    assert np.isfinite(found.frame["mine"]).all()


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (["diagnose", "--recorded", "rooms", "--observe", ","], "names nothing"),
        (["simulate", "SIM", "--geometry", "LOOP", "-o", "o.parquet"], "."),
        (["run", "--model", "none", "--backend", "fp32", "--seeds", "10000000000000"], "1 to"),
        (["simulate", "SIM", "--rooms", "-o", "DEVICE.parquet"], "expected a regular file"),
        (["leaderboard", "--out", "/dev/null"], "expected a regular file"),
        (["run", "--model", "none", "--backend", "fp32", "--out", "n" * 300], "File name too long"),
    ],
)
def test_bad_arguments_are_one_error(ask, said, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    _loop(tmp_path)
    (tmp_path / "s.toml").write_text("seed = 1\n")
    (tmp_path / "DEVICE.parquet").symlink_to("/dev/null")
    names = {"SIM": "s.toml", "LOOP": "loop"}
    done = CliRunner().invoke(group, [names.get(word, word) for word in ask])
    assert isinstance(done.exception, BenchError)
    assert re.search(said, str(done.exception))


def test_an_explicit_split_without_links_says_what_is_missing() -> None:
    import bench

    table = make_recordings()
    bare = table.select(np.arange(len(table)))
    del bare.frame["link"]
    with pytest.raises(BenchError, match="no column 'link'"):
        bench.run("none", "fp32", bare, split="link-kfold:2", out="never-written")
    assert not Path("never-written").exists()


THEIRS = """
import sys
class Quits:
    def __init__(self): sys.exit(0)
class Raises:
    def __init__(self): raise UnspeakableError
class UnspeakableError(Exception):
    def __str__(self): raise ValueError
class Loud:
    def __init__(self): print("LOUD")
"""
POINTS = """[bench.models]
quits = theirs:Quits
raises = theirs:Raises
loud = theirs:Loud
gone = no_such_module:Model
names = theirs_names:Model
odd target = not a target!
None = theirs:Loud
no equals sign
[bench.datasets]
quits-data = theirs:Quits
"""


@pytest.fixture
def theirs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Install a distribution of broken plug-ins, and one whose entry points are no text."""
    (tmp_path / "theirs.py").write_text(THEIRS)
    (tmp_path / "theirs_names").mkdir()
    for name, points in (("theirs", POINTS.encode()), ("binary", b"[bench.models]\n\xff\xfe = x")):
        info = tmp_path / f"{name}-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        (info / "entry_points.txt").write_bytes(points)
    monkeypatch.syspath_prepend(str(tmp_path))


@pytest.mark.usefixtures("theirs")
def test_broken_plug_ins_are_listed_with_their_reason_and_break_no_other() -> None:
    listed = CliRunner().invoke(group, ["models", "--json"])
    found = {one["name"]: one["problem"] for one in json.loads(listed.stdout)}
    assert {"none", "remnet", "svm"} <= {name for name, problem in found.items() if not problem}
    for name, said in {
        "quits": "tried to end the program",
        "raises": "UnspeakableError: (its message cannot be had",
        "gone": "ModuleNotFoundError",
        "names": "AttributeError",
        "odd target": "expected module:object",
        "no equals sign": "is no 'name = module:object'",
        "binary": "is not UTF-8",
        "None": "its name is 'none' of uwb-bench but for case",
    }.items():
        assert said in found[name], name
    assert found["loud"] is None
    assert "LOUD" in listed.stderr
    assert "LOUD" not in listed.stdout
    shown = CliRunner().invoke(group, ["data", "list"])
    assert shown.exception is None
    assert "quits-data" in shown.stdout
    assert "rooms" in shown.stdout


@pytest.mark.usefixtures("theirs")
def test_the_source_of_every_module_of_a_plug_in_is_hashed(tmp_path: Path) -> None:
    from bench.plugin_source import places_of

    (tmp_path / "theirs-1.0.dist-info" / "RECORD").write_text("theirs.py,,\ntheirs_more.py,,\n")
    (tmp_path / "theirs_more.py").write_text("X = 1\n")
    [quits] = [plugin for plugin in plugins("models") if plugin.name == "quits"]
    assert {place.name for place in places_of(quits)} == {"theirs.py", "theirs_more.py"}
    names = Plugin("models", "names", "theirs_names:Model", "theirs")
    assert tmp_path / "theirs_names" in places_of(names)


def test_an_output_folder_that_cannot_be_made_is_refused_at_once(tmp_path, monkeypatch) -> None:
    def refused(self: Path, *_: object, **__: object) -> None:
        raise FileNotFoundError(2, "No such file or directory", str(self))

    check_output(tmp_path / "new" / "page.md")
    check_folder(tmp_path / "new")
    assert list(tmp_path.iterdir()) == []
    monkeypatch.setattr(Path, "mkdir", refused)  # as /proc does, whatever its permissions say
    for check, target in ((check_output, tmp_path / "new" / "page.md"), (check_folder, "new")):
        with pytest.raises(BenchError, match=r"folder .*new cannot be created: No such file"):
            check(tmp_path / target)


def test_nobody_reading_is_quiet_also_where_click_ends_the_program(capsys, monkeypatch) -> None:
    monkeypatch.setattr(failing, "_drop_output", lambda: None)

    @click.command()
    def unread() -> None:
        raise BrokenPipeError(32, "Broken pipe")

    monkeypatch.setattr(sys, "stdout", sys.stdout)  # click puts its own in their place
    monkeypatch.setattr(sys, "stderr", sys.stderr)
    assert failing.ended_with(lambda: unread.main([], standalone_mode=False)) == 141
    assert capsys.readouterr() == ("", "")
