"""Asking the emulator's process: limits on instructions, memory and time, errors as one line."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.measure.counting.core import Core
from bench.measure.counting.elf import Contents, Function, missing_extra

MAX_INSTRUCTIONS = 200_000_000  # of one call: two hundred times REMnet
MAX_BLOCKS = 12_000_000  # entered over all rows: ten seconds and a hundred megabytes
MEMORY_BYTES = 8 << 30  # of address space: the emulator reserves its code buffer at once
TIME_LIMIT_S = 300
MAILBOX = ("uwb_count_call", "uwb_count_stop", "uwb_count_input", "uwb_count_output")
SYMBOLS = (*MAILBOX, "uwb_count_status")
Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Trace:
    """What the emulator saw: see `emulator.py` for the columns of `visits`.

    `outputs_m` float32 [rows] metres, `statuses` [rows] the function's return codes.
    """

    outputs_m: Floats
    statuses: NDArray[np.int64]
    visits: NDArray[np.int64]
    stack_bytes: int
    flash_reads: int


def check_tools() -> None:
    """Raise BenchError, naming the extra, where a package that counting needs is missing."""
    for package, module in (("unicorn",) * 2, ("capstone",) * 2, ("pyelftools", "elftools")):
        if find_spec(module) is None:
            raise BenchError(missing_extra(package))


def emulate(contents: Contents, core: Core, rows: Floats) -> Trace:
    """Run every row [n, samples] of CIRs through an image on an emulated core.

    Raises BenchError where the emulator is not installed, the image has no mailbox, or it runs
    past its limits.
    """
    check_tools()
    if missing := [name for name in SYMBOLS if name not in contents.symbols]:
        raise BenchError(f"the image has no symbol {missing[0]}: it was not linked by this program")
    with tempfile.TemporaryDirectory(prefix="uwb-count-") as name:
        request, answer = Path(name) / "request.npz", Path(name) / "answer.npz"
        _write(request, contents, core, rows)
        _run(request, answer)
        with np.load(answer, allow_pickle=False) as said:
            return Trace(
                outputs_m=said["outputs"],
                statuses=said["statuses"],
                visits=said["visits"],
                stack_bytes=int(said["stack_bytes"]),
                flash_reads=int(said["flash_reads"]),
            )


def layer_functions(contents: Contents) -> list[Function]:
    """Return the functions that stand for layers, in order of their numbers."""
    found = [one for one in contents.functions if one.layer is not None]
    return sorted(found, key=lambda one: one.layer or (0, ""))


def _write(path: Path, contents: Contents, core: Core, rows: Floats) -> None:
    settings = {
        "family": core.family,
        "model": core.emulator,
        "symbols": {name: contents.symbols[name] for name in SYMBOLS},
        "max_instructions": MAX_INSTRUCTIONS,
        "max_blocks": MAX_BLOCKS,
        "memory_bytes": MEMORY_BYTES,
        "seconds": TIME_LIMIT_S,
    }
    segments = {
        f"segment_{number}": np.frombuffer(data, np.uint8)
        for number, (_, data) in enumerate(contents.segments)
    }
    np.savez(
        path,
        allow_pickle=False,
        settings=np.array(json.dumps(settings)),
        addresses=np.array([address for address, _ in contents.segments], np.int64),
        inputs=np.ascontiguousarray(rows, np.float32),
        layers=_ranges(contents),
        **segments,
    )


def _ranges(contents: Contents) -> NDArray[np.int64]:
    """Return the address ranges of the network's own function and of every layer."""
    own = [one for one in contents.functions if one.name == "uwb_predict"]
    start, end = (own[0].start, own[0].end) if own else (0, 0)
    layers = [(one.start, one.end) for one in layer_functions(contents)]
    return np.array([(start, end), *layers], np.int64)


def _run(request: Path, answer: Path) -> None:
    command = [sys.executable, "-m", "bench.measure.counting.emulator", str(request), str(answer)]
    try:
        done = subprocess.run(  # noqa: S603 - our own module, no shell
            command, capture_output=True, timeout=TIME_LIMIT_S, check=False
        )
    except subprocess.TimeoutExpired:
        raise BenchError(f"the emulator took longer than {TIME_LIMIT_S} s: stopped") from None
    if done.returncode:
        lines = done.stderr.decode(errors="replace").strip().splitlines()
        said = lines[-1] if lines else f"exit code {done.returncode}"
        raise BenchError(f"the emulator stopped: {said}")
