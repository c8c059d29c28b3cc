"""C for a core: finding a cross compiler, compiling without a shell, keeping the image."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Literal

from bench.errors import BenchError
from bench.files import atomic_path, cache_dir
from bench.measure.counting.core import Core

HERE = Path(__file__).parent / "image"
TIME_LIMIT_S = 300.0  # the first use of zig compiles its runtime: half a minute was seen
MAX_SOURCE_BYTES = 8_000_000
COMMON = (
    *("-std=c99", "-O2", "-DUWB_COUNT", "-ffp-contract=off", "-fno-math-errno"),
    *("-ffunction-sections", "-fdata-sections", "-w"),
)
LINK = ("-Wl,--gc-sections", "-Wl,-e,uwb_count_call", "-Wl,-u,uwb_count_stop")
Which = Literal["auto", "gcc", "zig"]
_SAFE_NAME = re.compile(r"[A-Za-z0-9_]+\.[ch]")


@dataclass(frozen=True)
class Compiler:
    """A cross compiler for one core: its kind ("gcc", "zig"), version, and how it is called."""

    kind: str
    version: str
    command: tuple[str, ...]

    @property
    def label(self) -> str:
        """Name and version, as reports print them."""
        return f"{self.kind} {self.version} -O2"


@dataclass(frozen=True)
class Image:
    """A linked ELF file for one core, and the compiler that made it."""

    path: Path
    compiler: str


def find_compiler(core: Core, which: Which = "auto") -> Compiler:
    """Return the compiler for a core: gcc where installed, else zig.

    Raises BenchError naming the extra and the Debian package where there is none.
    """
    found = [
        maker(core) for kind, maker in (("gcc", _gcc), ("zig", _zig)) if which in ("auto", kind)
    ]
    compilers = [one for one in found if one is not None]
    if not compilers:
        raise BenchError(_no_compiler(core, which))
    return compilers[0]


def build_image(files: Mapping[str, str], core: Core, which: Which = "auto") -> Image:
    """Compile and link C files (name -> text) for a core; kept in the cache folder.

    The files must define `uwb_predict` (see `image/mailbox.c`). Raises BenchError where there is
    no compiler, a name is not plain, or the compiler fails or takes too long.
    """
    compiler = find_compiler(core, which)
    _check_names(files)
    path = cache_dir() / "images" / f"{core.name}-{_digest(files, core, compiler)}.elf"
    if not path.is_file():
        with atomic_path(path) as scratch:
            _compile(files, compiler, scratch)
    return Image(path, compiler.label)


def _compile(files: Mapping[str, str], compiler: Compiler, target: Path) -> None:
    """Run the compiler in a private folder, without a shell, with a time limit."""
    with tempfile.TemporaryDirectory(prefix="uwb-count-") as name:
        folder = Path(name)
        for file, text in files.items():
            (folder / file).write_text(text, encoding="utf-8")
        shutil.copy(HERE / "mailbox.c", folder)
        sources = sorted(file for file in [*files, "mailbox.c"] if file.endswith(".c"))
        for source in sources:
            _run([*compiler.command, *_compiling(compiler), "-c", source], folder)
        objects = [f"{Path(source).stem}.o" for source in sources]
        _run([*compiler.command, *_linking(compiler), *objects, "-o", "image.elf"], folder)
        shutil.copyfile(folder / "image.elf", target)


def _compiling(compiler: Compiler) -> tuple[str, ...]:
    headers = ("-I", str(HERE / "include")) if compiler.kind == "zig" else ()
    return (*COMMON, *headers, *(("-fno-sanitize=all",) if compiler.kind == "zig" else ()))


def _linking(compiler: Compiler) -> tuple[str, ...]:
    start = () if compiler.kind == "zig" else ("-nostartfiles",)
    return (*LINK, *start, "-T", str(HERE / "image.ld"))


def _run(command: Sequence[str], folder: Path) -> None:
    try:
        done = subprocess.run(  # noqa: S603 - no shell, fixed programs, plain names
            command, cwd=folder, capture_output=True, timeout=TIME_LIMIT_S, check=False
        )
    except subprocess.TimeoutExpired:
        raise BenchError(
            f"{Path(command[0]).name} took longer than {TIME_LIMIT_S:g} s: stopped"
        ) from None
    if done.returncode:
        raise BenchError(f"{Path(command[0]).name} failed: {_first_error(done.stderr)}")


def _first_error(stderr: bytes) -> str:
    lines = stderr.decode(errors="replace").splitlines()
    errors = [line for line in lines if "error" in line]
    return (errors or lines or ["no message"])[0].strip()[:300]


def _check_names(files: Mapping[str, str]) -> None:
    for name in files:
        if not _SAFE_NAME.fullmatch(name) or name == "mailbox.c":
            raise BenchError(f"C file {name!r}: a plain name ending in .c or .h was expected")
    if sum(map(len, files.values())) > MAX_SOURCE_BYTES:
        raise BenchError(f"C files of more than {MAX_SOURCE_BYTES} bytes: too large to compile")


def _gcc(core: Core) -> Compiler | None:
    found = shutil.which(core.gcc_command) if core.gcc_command else None
    if found is None:
        return None
    return Compiler("gcc", _version((found, "-dumpfullversion")), (found, *core.gcc))


def _zig(core: Core) -> Compiler | None:
    start = _zig_command()
    if start is None:
        return None
    return Compiler("zig", _version((*start, "version")), (*start, "cc", *core.zig))


def _zig_command() -> tuple[str, ...] | None:
    if find_spec("ziglang") is not None:
        return (sys.executable, "-m", "ziglang")
    found = shutil.which("zig")
    return None if found is None else (found,)


@cache
def _version(command: tuple[str, ...]) -> str:
    try:
        done = subprocess.run(command, capture_output=True, timeout=60, check=False)  # noqa: S603
    except (OSError, subprocess.TimeoutExpired):
        return "of unknown version"
    return done.stdout.decode(errors="replace").strip()


def _no_compiler(core: Core, which: Which) -> str:
    ways = ["pip install 'uwb-bench[native]' (zig cc)"] if which != "gcc" else []
    if core.debian and which != "zig":
        ways.append(f"Debian's package {core.debian}")
    kind = "" if which == "auto" else f" ({which})"
    return f"no cross compiler{kind} for {core.name}: {' or '.join(ways) or 'only zig has one'}"


def _digest(files: Mapping[str, str], core: Core, compiler: Compiler) -> str:
    ours = [path.read_text(encoding="utf-8") for path in sorted(HERE.rglob("*.*"))]
    flags = [*compiler.command[1:], *_compiling(compiler), *_linking(compiler), compiler.label]
    named = [flag for flag in flags if not flag.startswith("/")]
    text = json.dumps([core.name, named, ours, sorted(files.items())])
    return hashlib.sha256(text.encode()).hexdigest()[:24]
