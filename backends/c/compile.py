"""Compiling C for this machine: the system's compiler, or `zig cc` from PyPI; never a shell."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.util import find_spec
from pathlib import Path

PATIENCE_S = 120.0  # zig builds its own libraries the first time
FLAGS = (
    *("-std=c99", "-O2", "-ffp-contract=off", "-fno-math-errno"),
    *("-ftree-vectorize", "-fvect-cost-model=dynamic"),  # -O3 takes twice as long for no more
)
NATIVE = "-march=native"
QUICK = ("-std=c99", "-O1", "-ffp-contract=off")  # the same answers, soon compiled
PLAIN = ("-std=c99", "-O2", "-ffp-contract=off", "-fno-math-errno")
"""As the exported Makefile compiles: the same answers, in a third of the time."""
MISSING = (
    "no C compiler: install one (Debian: apt install gcc) or `pip install 'uwb-bench[native]'`"
)


class CompilerError(ValueError):
    """There is no compiler, or it refused."""


@cache
def compiler() -> tuple[str, ...] | None:
    """Return the command of a C compiler: $CC, cc, gcc, clang, then zig's; None without any.

    Raises CompilerError where $CC is set and no program.
    """
    if named := os.environ.get("CC", "").strip():
        return _named(named)
    for name in ("cc", "gcc", "clang"):
        if found := shutil.which(name):
            return (found,)
    if find_spec("ziglang") is not None:
        return (sys.executable, "-m", "ziglang", "cc")
    return None


def _named(command: str) -> tuple[str, ...]:
    """Return what $CC says as a command, arguments and all."""
    try:
        program, *words = shlex.split(command)
    except ValueError:
        program, words = "", []
    found = shutil.which(program)
    if found is None:
        raise CompilerError(f"CC={command}: no such program; name a C compiler, or unset it")
    return (found, *words)


def missing_compiler() -> str | None:
    """Return, in words, what to install or set where there is no compiler, else None."""
    try:
        return None if compiler() else MISSING
    except CompilerError as problem:
        return str(problem)


def compile_shared(
    files: Mapping[str, str], folder: Path, flags: Sequence[str] = (*FLAGS, NATIVE)
) -> Path:
    """Write C files into a private folder and return the shared library made of them there.

    Raises CompilerError, its first complaint in it, where there is no compiler or it refuses.
    """
    library = folder / "uwb_predict.so"
    shared = ("-shared", "-fPIC", "-o", str(library))
    compile_files(files, folder, (*flags, *shared))
    if not library.is_file():
        raise CompilerError(f"{_called()} made no library: it is no C compiler")
    return library


def compile_files(files: Mapping[str, str], folder: Path, flags: Sequence[str]) -> None:
    """Write C files into a folder and compile them all with these flags; errors as above."""
    command = compiler()
    if command is None:
        raise CompilerError(MISSING)
    for name, text in files.items():
        (folder / name).write_text(text, encoding="ascii")
    sources = [str(folder / name) for name in files if name.endswith(".c")]
    _run([*command, *flags, *sources], folder)


def _called() -> str:
    """Return the compiler as messages name it."""
    return " ".join(Path(word).name for word in compiler() or ())


def _run(command: list[str], folder: Path) -> None:
    try:
        done = subprocess.run(  # noqa: S603 - no shell; the files are ours
            command, cwd=folder, capture_output=True, text=True, timeout=PATIENCE_S, check=False
        )
    except subprocess.TimeoutExpired as problem:
        raise CompilerError(f"{command[0]} took more than {PATIENCE_S:g} s") from problem
    except OSError as problem:
        raise CompilerError(f"{command[0]} cannot be run ({problem.strerror})") from problem
    if done.returncode:
        raise CompilerError(_complaint(done.stderr.replace(f"{folder}{os.sep}", "")))


def _complaint(text: str) -> str:
    """Return a compiler's first complaint; one that says nothing is likely none."""
    lines = [line for line in text.splitlines() if "error" in line] or text.splitlines()
    if lines:
        return f"{_called()}: {lines[0]}"
    named = os.environ.get("CC", "").strip()
    who, advice = (f"CC={named}", "name one, or unset CC") if named else (_called(), MISSING)
    return f"{who}: failed without a word; expected a C compiler: {advice}"
