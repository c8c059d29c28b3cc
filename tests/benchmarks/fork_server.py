"""A process that has imported what a command needs, and forks a child per command.

    FORKS = ForkServer(); FORKS.learn(words, folder, cache); FORKS.run(words, folder, cache, 0.2)

A fork begins where `python -m bench` has ended its imports, which take longer than most commands,
so that a thousand kills fall on the work and are cheap. The server itself does no work and has no
threads: a command is run once in a child, which tells what it imported, and the server imports
that. As a program it reads requests, a JSON object a line, and answers each with one.
"""

from __future__ import annotations

import gc
import importlib
import json
import os
import select
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

OWN = {"BENCH_WAIT_S": "0", "OMP_NUM_THREADS": "1"}


@dataclass(frozen=True)
class Ended:
    """How a command ended: exit code (negative: killed by that signal), seconds, its errors."""

    code: int
    seconds: float
    said: str


class ForkServer:
    """The server seen from those who ask it."""

    def __init__(self) -> None:
        self._effects: list[str] = []
        self._process = subprocess.Popen(
            [sys.executable, __file__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, **OWN},
        )

    def close(self) -> None:
        """End it."""
        self._process.kill()
        self._process.wait()

    def knows(self, effects: Sequence[str]) -> None:
        """Have diagnoses know these effects of the library alone; all where none is named."""
        self._effects = list(effects)

    def learn(self, words: Sequence[str], out: Path, cache: Path) -> None:
        """Run a command once and import what it imported."""
        ended = self._ask(words, out, cache, learn=True)
        assert ended.code == 0, ended.said

    def run(
        self, words: Sequence[str], out: Path, cache: Path, kill_after_s: float | None = None
    ) -> Ended:
        """Run a command, `OUT` in its words standing for `out`; kill it after so many seconds."""
        return self._ask(words, out, cache, kill_after_s=kill_after_s)

    def _ask(self, words: Sequence[str], out: Path, cache: Path, **how: Any) -> Ended:
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None
        assert stdout is not None
        said = [word.replace("OUT", str(out)) for word in words]
        request = {"words": said, "cache": str(cache), "effects": self._effects, **how}
        stdin.write(json.dumps(request) + "\n")
        stdin.flush()
        return Ended(**json.loads(stdout.readline()))


def serve() -> None:
    """Answer requests until there are no more."""
    for line in sys.stdin:
        request = json.loads(line)
        with tempfile.TemporaryFile() as errors, tempfile.TemporaryFile() as modules:
            start = time.monotonic()
            child = os.fork()
            if child == 0:
                _command(request, errors.fileno(), modules.fileno())
            code = _ended(child, request.get("kill_after_s"))
            seconds = time.monotonic() - start
            if request.get("learn"):
                _import(_content(modules).split())
            said = _content(errors)[-2000:]
        print(json.dumps({"code": code, "seconds": seconds, "said": said}), flush=True)


def _ended(child: int, kill_after_s: float | None) -> int:
    """Wait for a child, or kill all it started after a time; return its exit code."""
    watched = os.pidfd_open(child)
    ended, _, _ = select.select([watched], [], [], kill_after_s)
    os.close(watched)
    if not ended:
        try:
            os.killpg(child, signal.SIGKILL)
        except ProcessLookupError:  # so early that it has no group of its own yet
            os.kill(child, signal.SIGKILL)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _content(file: Any) -> str:
    file.seek(0)
    return str(file.read().decode(errors="replace"))


def _import(names: Sequence[str]) -> None:
    for name in names:
        if name != "__main__":
            with suppress(Exception):  # what cannot be imported by its name is left to the command
                importlib.import_module(name)
    _read_translations_once()
    gc.collect()
    gc.freeze()  # children then copy fewer pages


def _read_translations_once() -> None:
    """Have torch keep its translations for ONNX, which no child then reads anew."""
    module = sys.modules.get("torch.onnx._internal.exporter._registration")
    if module is not None:
        read = cache(module.ONNXRegistry.from_torchlib)
        module.ONNXRegistry.from_torchlib = staticmethod(read)
        with suppress(Exception):
            from backends.export import OPSET

            read(opset_version=OPSET)


def _command(request: dict[str, Any], errors: int, modules: int) -> None:
    """Be the command, in a process group of its own."""
    code = 97
    try:
        os.setsid()
        _streams(errors)
        os.environ["BENCH_CACHE"] = request["cache"]
        sys.argv = ["bench", *request["words"]]
        from bench.cli.main import main

        if request["effects"]:
            _only(request["effects"])
        try:
            main()
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else int(end.code is not None)
        if request.get("learn"):
            os.write(modules, "\n".join(sys.modules).encode())
    except BaseException:
        traceback.print_exc()
    finally:
        with suppress(Exception):
            sys.stderr.flush()
        os._exit(code & 255)


def _only(effects: Sequence[str]) -> None:
    """Have the diagnosis know these effects of the library alone."""
    from bench.discrepancy.select import candidates
    from bench.plugins import find

    candidates.plugins = lambda group: [find(group, name) for name in effects]


def _streams(errors: int) -> None:
    null = os.open(os.devnull, os.O_RDWR)
    for stream, target in ((0, null), (1, null), (2, errors)):
        os.dup2(target, stream)
    sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stderr = open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115


if __name__ == "__main__":
    serve()
