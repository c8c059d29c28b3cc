"""Running generated C on this machine: compiled when opened, called through ctypes."""

from __future__ import annotations

import ctypes
import hashlib
import os
import re
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from backends import SCRATCH
from backends.base import Floats, Runner
from backends.c.compile import FLAGS, NATIVE, CompilerError, compile_shared, compiler
from backends.c.emit import CSource, generate

_ROWS = """#include "uwb_predict.h"

int uwb_predict_rows(const float *rows, int count, float *errors_m);

int uwb_predict_rows(const float *rows, int count, float *errors_m)
{
    int refused = 0;
    for (int i = 0; i < count; i++) {
        refused |= uwb_predict_row(rows + i * UWB_PREDICT_ROW_VALUES, errors_m + i);
    }
    return refused;
}
"""


def open_float(path: Path, threads: int = 1) -> Runner:
    """Return a runner of a float ONNX file as C. Raises ValueError as `generate` and `load`."""
    del threads
    return load(generate(path, "fp32"))


def open_integer(path: Path, threads: int = 1) -> Runner:
    """Return a runner of an 8-bit ONNX file as C. Raises ValueError as `generate` and `load`."""
    del threads
    return load(generate(path, "int8"))


def load(source: CSource, flags: Sequence[str] = (*FLAGS, NATIVE)) -> Runner:
    """Compile C and return it as a function: CIRs float32 [n, width] -> errors float32 [n].

    The function raises ValueError for rows of another width or type, or that are not finite.
    Raises CompilerError, a ValueError, where there is no compiler or it refuses.
    """
    kept = os.environ.get(SCRATCH)
    with tempfile.TemporaryDirectory(prefix="uwb-bench-", dir=kept) as folder:
        rows = _compiled({**source.files, "rows.c": _ROWS}, Path(folder), flags, kept)
    rows.argtypes = (ctypes.c_void_p, ctypes.c_int, ctypes.c_void_p)
    return _runner(rows, row_width(source))


def _loaded(library: Path) -> ctypes._NamedFuncPointer:
    """Return the function of a library; it stays mapped once it is loaded."""
    try:
        return ctypes.CDLL(str(library)).uwb_predict_rows
    except (OSError, AttributeError) as problem:
        raise CompilerError(f"what the compiler made cannot be loaded: {problem}") from problem


def _compiled(
    files: Mapping[str, str], folder: Path, flags: Sequence[str], kept: str | None
) -> ctypes._NamedFuncPointer:
    """Return the function of a library compiled in `folder`, or kept by this run before."""
    if kept is None:
        return _loaded(compile_shared(files, folder, flags))
    content = repr((sorted(files.items()), tuple(flags), compiler()))
    place = Path(kept) / f"{hashlib.sha256(content.encode()).hexdigest()}.so"
    if place.is_file():
        return _loaded(place)
    library = compile_shared(files, folder, flags)
    rows = _loaded(library)
    library.replace(place)
    return rows


def row_width(source: CSource) -> int:
    """Return how many values generated C takes in all."""
    return _size(source, "UWB_PREDICT_ROW_VALUES")


def samples(source: CSource) -> int:
    """Return how many values the first input of generated C has: the samples of the CIR."""
    return _size(source, "UWB_PREDICT_SAMPLES")


def inputs(source: CSource) -> dict[str, str]:
    """Return the inputs of generated C in order: the macro of each one's size by its C name."""
    header = source.files["uwb_predict.h"]
    prototype = header[header.index("int uwb_predict(") :].partition(";")[0]
    return dict(re.findall(r"const float (\w+)\[(\w+)\]", prototype))


def _size(source: CSource, name: str) -> int:
    lines = source.files["uwb_predict.h"].splitlines()
    [line] = [line for line in lines if line.startswith(f"#define {name} ")]
    return int(line.split()[-1])


def _runner(rows: ctypes._NamedFuncPointer, width: int) -> Runner:
    float32 = np.dtype(np.float32)

    def predict(cirs: Floats) -> Floats:
        if cirs.dtype != float32 or cirs.ndim != 2 or cirs.shape[1] != width:
            raise ValueError(
                f"expected rows float32 [n, {width}], got {cirs.dtype} {list(cirs.shape)}"
            )
        count = len(cirs)
        errors = (ctypes.c_float * count)()
        if rows(cirs.tobytes(), count, errors):  # copying is quicker than asking for the address
            raise ValueError("a row is not finite, or out of the range of C")
        held = memoryview(errors).cast("B")
        return np.frombuffer(held, float32) if count else np.empty(0, float32)

    return predict
