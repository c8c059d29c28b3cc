"""Running tests in a fork that sees one mutated module."""

from __future__ import annotations

import ast
import importlib
import os
import signal
import sys
import time
from contextlib import suppress
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Literal

Outcome = Literal["passed", "failed", "hung"]
NEVER_LOADED = 96
LIBRARIES = ("hypothesis", "numba", "onnxruntime", "onnxruntime.quantization", "pandas", "psutil")
LIBRARIES += ("pyarrow.parquet", "pytest", "scipy.optimize", "scipy.signal", "scipy.stats")
LIBRARIES += ("sklearn.model_selection", "sklearn.svm", "torch", "torch.onnx", "onnxscript")


def preload() -> None:
    """Import the libraries once, so that no fork has to."""
    for name in LIBRARIES:
        importlib.import_module(name)


class _Mutated(MetaPathFinder, Loader):
    """Gives one module from a changed tree, everything else as it is."""

    def __init__(self, name: str, path: Path, tree: ast.Module) -> None:
        self.name, self.path, self.tree = name, path, tree
        self.loaded = False

    def find_spec(self, name: str, path: object, target: object = None) -> ModuleSpec | None:
        return spec_from_file_location(name, self.path, loader=self) if name == self.name else None

    def exec_module(self, module: ModuleType) -> None:
        self.loaded = True
        exec(compile(self.tree, str(self.path), "exec"), module.__dict__)


def run_tests(
    tests: list[str], path: Path, tree: ast.Module, limit_s: float
) -> tuple[Outcome, float, str]:
    """Return how the tests end with the module at `path` changed to `tree`, seconds and output."""
    start = time.monotonic()
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        _in_child(tests, path, tree, writer)
    os.close(writer)
    status = _wait(child, start + limit_s)
    with os.fdopen(reader, "rb") as stream, suppress(OSError):
        os.set_blocking(stream.fileno(), False)
        said = (stream.read() or b"").decode(errors="replace")
    seconds = time.monotonic() - start
    if status is None:
        return "hung", seconds, said
    code = os.waitstatus_to_exitcode(status)
    if code == NEVER_LOADED:
        raise SystemExit(f"{path}: its tests never import it")
    return "passed" if code == 0 else "failed", seconds, said


def _in_child(tests: list[str], path: Path, tree: ast.Module, writer: int) -> None:
    """Run pytest and end the process with its exit code; the last of its output goes back."""
    code = 3
    try:
        os.setsid()
        scratch = os.memfd_create("output")
        for stream in (1, 2):
            os.dup2(scratch, stream)
        name = ".".join(path.with_suffix("").parts)
        mutated = _Mutated(name, path, tree)
        sys.meta_path.insert(0, mutated)
        import pytest

        # Plain asserts: pytest would load modules named *_test itself, to rewrite theirs.
        code = int(pytest.main(["-q", "-x", "-p", "no:xdist", "--assert=plain", *tests]))
        code = code if mutated.loaded else NEVER_LOADED
        sys.stdout.flush()
        os.write(writer, os.pread(scratch, 4000, max(0, os.fstat(scratch).st_size - 4000)))
    finally:
        os._exit(code)


def _wait(child: int, deadline: float) -> int | None:
    """Return the exit status, or None after killing the child and all it started."""
    while time.monotonic() < deadline:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return status
        time.sleep(0.02)
    with suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return None
