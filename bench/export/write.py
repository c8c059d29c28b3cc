"""Writing an export: everything is made and checked first, then the files are put in place."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from backends.base import Floats
from bench.errors import BenchError
from bench.export.agreement import Agreement, check, compare
from bench.export.chosen import Chosen
from bench.export.makefile import licence, makefile
from bench.export.report import Figures, report
from bench.export.selftest import chosen_rows, selftest
from bench.files import write_atomically
from bench.measure.profile import Profile
from bench.runner.counting import Counted, count_artifact

if TYPE_CHECKING:
    from backends.c.emit import CSource, Requantise

Format = Literal["c", "onnx"]
LIMITS_M = {"fp32": 1e-5, "fp16": 1e-5, "int8": 2e-3}
_WIDTHS = {"float": 4, "int32_t": 4, "uint16_t": 2, "int8_t": 1, "uint8_t": 1}


@dataclass(frozen=True)
class Exported:
    """What was written where. `agreement` is None where nothing could be compiled.

    `counted` has an entry for every part that was asked for.
    """

    folder: Path
    files: tuple[str, ...]
    agreement: Agreement | None
    arena_bytes: int | None
    counted: tuple[Counted, ...] = ()


def export(
    chosen: Chosen,
    to: Format,
    folder: Path,
    requantise: Requantise = "float",
    parts: Sequence[Profile] = (),
) -> Exported:
    """Write a model as C or ONNX into a folder; count the C on `parts` for the report.

    Raises BenchError where C cannot be written for an operator, where it does not agree with ONNX
    Runtime, or where the folder cannot be written; nothing is written then.
    """
    check_folder(folder)
    if to == "onnx":
        return _put(folder, {"model.onnx": _bytes(chosen), "REPORT.md": report(chosen, None)})
    return _export_c(chosen, folder, requantise, parts)


def check_folder(folder: Path) -> None:
    """Raise BenchError where something that is no folder is in the way."""
    if folder.exists() and not folder.is_dir():
        raise BenchError(f"-o {folder}: a file, expected a folder")


def _bytes(chosen: Chosen) -> bytes:
    return chosen.artifact.path.read_bytes()


def _export_c(
    chosen: Chosen, folder: Path, requantise: Requantise, parts: Sequence[Profile]
) -> Exported:
    from backends.c.emit import generate
    from backends.c.run import inputs, samples

    artifact = chosen.artifact
    try:
        source = generate(artifact.path, artifact.precision, requantise)
    except ValueError as problem:
        told = str(problem).removeprefix(f"{artifact.path}: ")
        raise BenchError(f"{chosen.model} on {chosen.backend}: {told}") from problem
    limit_m = LIMITS_M[artifact.precision]
    with ThreadPoolExecutor(1) as aside:  # the compiler is a process of its own
        compiled = aside.submit(_predicted, source, chosen)
        expected = _runtime(chosen)
        agreement = _agreement(compiled.result(), expected, limit_m)
    rows = chosen_rows(expected)
    figures = Figures(
        artifact.precision == "int8",
        agreement,
        constant_bytes(source),
        source.arena_bytes,
        samples(source),
        inputs(source),
        count_artifact(chosen.artifact, parts, chosen.cirs[rows]) if parts else (),
    )
    files: dict[str, str | bytes] = {
        **source.files,
        "uwb_selftest.c": selftest(chosen.cirs[rows], expected[rows], limit_m),
        "Makefile": makefile(),
        "LICENCE": licence(),
        "REPORT.md": report(chosen, figures),
    }
    written = _put(folder, files, agreement, source.arena_bytes)
    return replace(written, counted=tuple(figures.counted))


def _runtime(chosen: Chosen) -> Floats:
    """Return what ONNX Runtime gives for the held-out rows, whatever opens the artifact."""
    from backends.ort import open_optimised

    run = open_optimised(chosen.artifact.path)
    blocks = [run(chosen.cirs[i : i + 512]) for i in range(0, len(chosen.cirs), 512)]
    return np.concatenate(blocks)


def _predicted(source: CSource, chosen: Chosen) -> Floats | None:
    """Return what the C gives for the held-out rows; None where nothing can be compiled."""
    from backends.c.compile import CompilerError, missing_compiler
    from backends.c.run import load

    if missing_compiler():
        return None
    try:
        return load(source)(chosen.cirs)
    except CompilerError as problem:
        raise BenchError(str(problem)) from problem


def _agreement(found: Floats | None, expected: Floats, limit_m: float) -> Agreement | None:
    if found is None:
        return None
    agreement = compare(found, expected)
    check(agreement, limit_m)
    return agreement


def constant_bytes(source: CSource) -> int:
    """Return the bytes of the tables in generated C."""
    tables = re.findall(r"^static const (\w+) \w+\[(\d+)\] =", source.files["uwb_predict.c"], re.M)
    return sum(_WIDTHS[kind] * int(count) for kind, count in tables)


def _put(
    folder: Path,
    files: Mapping[str, str | bytes],
    agreement: Agreement | None = None,
    arena_bytes: int | None = None,
) -> Exported:
    for name, content in files.items():
        write_atomically(folder / name, content)
    return Exported(folder, tuple(files), agreement, arena_bytes)
