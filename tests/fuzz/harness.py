"""Running one case in a fork, or as a Python of its own, and judging what it did."""

from __future__ import annotations

import hashlib
import json
import os
import re
import signal
import stat
import subprocess
import sys
import time
import traceback
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import psutil

from tests.fuzz.commands import Case

LIMIT_S = 60.0
STARVED_S = 10.0  # more, as long as it goes on and had less than that of a busy machine's processor
MEMORY_BYTES = 6 * 2**30
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
WARNING = re.compile(r"\b\w*Warning: ")
INTERRUPTED = 130


@dataclass(frozen=True)
class Ended:
    """How a command ended: exit code (None where it was killed), seconds, what it said."""

    code: int | None
    seconds: float
    out: str
    err: str


def execute(case: Case, folder: Path, own_process: bool) -> Ended:
    """Run a case and return how it ended. Standard output and error go to files beside `folder`."""
    said = folder.parent
    start = time.monotonic()
    child = _spawn(case, folder) if own_process else _fork(case, folder)
    code = _wait(child, start + LIMIT_S)
    out, err = (_read(said / name) for name in ("stdout", "stderr"))
    return Ended(code, time.monotonic() - start, out, err)


def _read(path: Path) -> str:
    return path.read_bytes()[:2_000_000].decode(errors="surrogateescape") if path.exists() else ""


def _environment(case: Case, folder: Path) -> dict[str, str]:
    root = str(Path(__file__).parents[2])
    own = {"BENCH_CACHE": str(folder.parent / "cache"), "HOME": str(folder.parent / "home")}
    own |= {
        "BENCH_WAIT_S": "0",
        "OMP_NUM_THREADS": "1",
        "BENCH_DATA": str(folder / "no-data"),
        "COLUMNS": "100",
    }
    path = os.pathsep.join([*([str(case.site)] if case.site else []), root])
    return {**os.environ, **own, "PYTHONPATH": path}


def _streams(case: Case, folder: Path) -> tuple[int, int]:
    """Return file descriptors for standard output and error."""
    flags = os.O_CREAT | os.O_WRONLY | os.O_TRUNC
    if case.stdout == "full" and Path("/dev/full").exists():
        out = os.open("/dev/full", os.O_WRONLY)
    elif case.stdout == "closed":
        reader, out = os.pipe()
        os.close(reader)
    else:
        out = os.open(folder.parent / "stdout", flags)
    return out, os.open(folder.parent / "stderr", flags)


def _spawn(case: Case, folder: Path) -> int:
    out, err = _streams(case, folder)
    process = subprocess.Popen(
        [sys.executable, "-m", "bench", *case.words],
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=out,
        stderr=err,
        env=_environment(case, folder),
        start_new_session=True,
    )
    process.returncode = 0  # waited for below, like a fork
    os.close(out)
    os.close(err)
    return process.pid


def _fork(case: Case, folder: Path) -> int:
    child = os.fork()
    if child:
        return child
    code = 97
    try:
        os.setsid()
        _become(case, folder)
        from bench.cli.main import main

        main()
        code = 0
    except SystemExit as ended:
        code = ended.code if isinstance(ended.code, int) else int(ended.code is not None)
    except BaseException:  # what the interpreter would print
        traceback.print_exc()
        code = 1
    finally:
        with suppress(Exception):
            sys.stderr.flush()
        try:
            sys.stdout.flush()
        except Exception:
            code = code or 120  # what the interpreter does at its end
        os._exit(code & 255)


def _become(case: Case, folder: Path) -> None:
    """Turn the fork into the command: streams, folder, environment, arguments."""
    import resource

    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    out, err = _streams(case, folder)
    os.dup2(out, 1)
    os.dup2(err, 2)
    sys.stdout, sys.stderr = (open(k, "w", encoding="utf-8", closefd=False) for k in (1, 2))  # noqa: SIM115
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    os.chdir(folder)
    os.environ.update(_environment(case, folder))
    sys.argv = ["bench", *case.words]
    if case.site:
        sys.path.insert(0, str(case.site))


def _wait(child: int, deadline: float) -> int | None:
    """Return the exit code, or None after killing the command and all it started."""
    seen_s = 0.0
    while time.monotonic() < deadline:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.005)
        if time.monotonic() > deadline - 1 and seen_s < (used_s := _processor_s(child)) < LIMIT_S:
            deadline, seen_s = deadline + STARVED_S, used_s
    with suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return None


def _processor_s(child: int) -> float:
    """Return the processor time that a command and its living children have used."""
    total = 0.0
    with suppress(psutil.Error):
        command = psutil.Process(child)
        for process in (command, *command.children(recursive=True)):
            used = process.cpu_times()
            total += used.user + used.system + used.children_user + used.children_system
    return total


def inputs(case: Case, folder: Path) -> dict[str, str]:
    """Return what every path of a case is before it runs, but for what it may write."""
    found = {}
    for path in sorted(folder.rglob("*")):
        if not any(path in (out, _led_to(out)) or out in path.parents for out in case.outputs):
            found[str(path)] = _what(path)
    for out in case.outputs:  # a link or FIFO stays one
        if out.is_symlink() or (out.exists() and not out.is_file() and not out.is_dir()):
            found[str(out)] = _what(out)
    return found


def _led_to(out: Path) -> Path | None:
    """Return the file that a link leads to: it is written through."""
    return out.parent / out.readlink() if out.is_symlink() else None


def _what(path: Path) -> str:
    mode = path.lstat().st_mode
    if stat.S_ISREG(mode):
        return hashlib.sha256(path.read_bytes()).hexdigest()
    return f"{stat.S_IFMT(mode):o}" + (str(path.readlink()) if stat.S_ISLNK(mode) else "")


def faults(case: Case, folder: Path, before: dict[str, str], ended: Ended) -> Iterator[str]:
    """Yield what a case did wrong, in a few words each."""
    if ended.code is None:
        yield f"hang: no end within {LIMIT_S:g} s"
        return
    if "Traceback (most recent call last)" in ended.out + ended.err:
        yield "traceback: " + _innermost(ended.out + ended.err)
    elif ended.code not in _allowed(case):
        yield f"exit code {ended.code}"
    yield from _said(case, ended)
    yield from _written(case, folder, before)


def _allowed(case: Case) -> tuple[int, ...]:
    """Return the exit codes that are right; closed pipes and interrupts have their own."""
    if case.words[:1] == ["doctor"]:  # 1: something is missing on this machine
        return (0, 1, 2, 120, 141) if case.stdout != "file" else (0, 1, 2)
    interrupted = (INTERRUPTED,) if case.site else ()  # by the plug-in
    return (0, 1, 2, 120, 141, *interrupted) if case.stdout != "file" else (0, 2, *interrupted)


def _said(case: Case, ended: Ended) -> Iterator[str]:
    """Yield what is wrong with the words of a command."""
    for name, words in (("stdout", ended.out), ("stderr", ended.err)):
        if found := CONTROL.search(words):
            yield f"control character {found[0]!r} on {name}"
        if found := WARNING.search(words):
            yield f"warning on {name}: {words[found.start() :].splitlines()[0][:80]}"
    lines = [line for line in ended.err.splitlines() if line.startswith(("bench: ", "Error: "))]
    asked_nothing = ended.err.startswith("Usage: ") and not lines
    if ended.code == 2 and len(lines) != 1 and case.stdout == "file" and not asked_nothing:
        yield f"{len(lines)} lines of error with exit code 2"
    if ended.code == 0 and "--json" in case.words and case.stdout == "file":
        try:
            json.loads(ended.out)
        except ValueError:
            yield "--json printed no JSON"


def _written(case: Case, folder: Path, before: dict[str, str]) -> Iterator[str]:
    """Yield what is half-written or changed."""
    after = {str(path): path for path in folder.rglob("*")}
    for path, what in before.items():
        if path not in after or _what(after[path]) != what:
            yield f"changed an input: {Path(path).suffix or 'no suffix'}"
    for path in (Path(one) for one in after if one not in before):
        if ".part" in path.name:
            yield "left a .part file"
        elif path.is_file() and not path.is_symlink() and (why := _broken(path)):
            yield f"half-written {path.suffix}: {why}"


def _broken(path: Path) -> str | None:
    """Return why a file that was written is not whole, None where it is."""
    import pyarrow.parquet as pq

    try:
        if path.suffix == ".json":
            json.loads(path.read_text(encoding="utf-8"))
        elif path.suffix == ".parquet":
            pq.read_table(path)
        elif path.suffix in (".png", ".svg", ".md", ".onnx") and path.stat().st_size == 0:
            return "empty"
    except Exception as problem:
        return type(problem).__name__
    return None


def _innermost(words: str) -> str:
    """Return the last line of the last traceback and the innermost frame of ours in it."""
    last = words[words.rindex("Traceback (most recent call last)") :]
    ours = re.findall(r'/((?:bench|backends|zoo|reports)/\S+\.py)", line (\d+)', last)
    raised = re.findall(
        r"^([A-Za-z_][\w.]*(?:Error|Exception|Interrupt|Exit|Worse|Warning))", last, re.M
    )
    where = ":".join(ours[-1]) if ours else "?"
    return f"{raised[-1] if raised else '?'} at {where}"
