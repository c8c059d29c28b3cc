"""Writing an export: everything is made and checked first, then the files are put in place."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from backends.base import Floats
from bench.errors import BenchError
from bench.export.agreement import Agreement, check, compare
from bench.export.chosen import Chosen
from bench.export.counts import Counts, counted_before
from bench.export.makefile import licence, makefile
from bench.export.report import Figures, report
from bench.export.selftest import chosen_rows, selftest
from bench.files import try_folder, write_atomically

if TYPE_CHECKING:
    from backends.c.emit import CSource, Requantise
    from bench.measure.profile import Profile
    from bench.runner.counting import Counted

Format = Literal["c", "onnx"]
LIMITS_M = {"fp32": 1e-5, "fp16": 1e-5, "int8": 2e-3}
REPORT = "REPORT.md"
_WIDTHS = {"float": 4, "int32_t": 4, "uint16_t": 2, "int8_t": 1, "uint8_t": 1}
_BLOCK_ROWS = 512


@dataclass(frozen=True)
class Exported:
    """What was written where. `agreement` is None where nothing could be compiled.

    `counted` has an entry for every part that was asked for; `kept` and `dropped` name the parts
    whose counts stood in the report before: kept where the C is the same, else gone. `unitless`
    names those counted that have to do this C's float arithmetic without a unit for it.
    """

    folder: Path
    files: tuple[str, ...]
    agreement: Agreement | None
    arena_bytes: int | None
    counted: tuple[Counted, ...] = ()
    kept: tuple[str, ...] = ()
    dropped: tuple[str, ...] = ()
    unitless: tuple[str, ...] = ()


@dataclass(frozen=True)
class Checked:
    """C that was compared: what ONNX Runtime predicts [n] in metres, and how the C agrees."""

    source: CSource
    expected_m: Floats
    agreement: Agreement | None

    @property
    def rows(self) -> NDArray[np.intp]:
        """Positions of the rows of the self-test."""
        return chosen_rows(self.expected_m)


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
        content = chosen.artifact.path.read_bytes()
        return _put(folder, {"model.onnx": content, REPORT: report(chosen, None)})
    return _export_c(chosen, folder, requantise, parts)


def check_folder(folder: Path) -> None:
    """Raise BenchError where files cannot be put: something else in the way, or read-only."""
    place = folder
    while not os.path.lexists(place) and place != place.parent:
        place = place.parent
    if not place.is_dir():
        raise BenchError(f"-o {folder}: {place} is a file, expected a folder")
    if not os.access(place, os.W_OK | os.X_OK):
        raise BenchError(f"-o {folder}: {place} is read-only, expected a writable folder")
    try:
        try_folder(place, folder)
    except ValueError as problem:
        raise BenchError(f"-o {folder}: {problem}; expected a writable folder") from problem


def _export_c(
    chosen: Chosen, folder: Path, requantise: Requantise, parts: Sequence[Profile]
) -> Exported:
    checked = _checked(chosen, _source(chosen, requantise))
    counted = _count(chosen, checked, parts)
    before = counted_before(folder / REPORT, {one.figure.device for one in counted})
    same = _is_there(folder, checked.source)
    kept = before if same else Counts()
    files = _files(chosen, checked, _figures(chosen, checked, counted, kept))
    written = _put(folder, files, checked.agreement, checked.source.arena_bytes)
    dropped = () if same else before.parts
    unitless = _unitless(chosen, requantise, parts)
    return replace(
        written, counted=tuple(counted), kept=kept.parts, dropped=dropped, unitless=unitless
    )


def _unitless(chosen: Chosen, requantise: Requantise, parts: Sequence[Profile]) -> tuple[str, ...]:
    """Return the parts without a floating-point unit, where 8-bit C could do without one."""
    if requantise == "fixed" or chosen.artifact.precision != "int8" or not parts:
        return ()
    from bench.measure.counting import load_core

    return tuple(part.name for part in parts if not load_core(part.core).float_unit)


def _source(chosen: Chosen, requantise: Requantise) -> CSource:
    from backends.c.emit import generate

    artifact = chosen.artifact
    try:
        return generate(artifact.path, artifact.precision, requantise)
    except ValueError as problem:
        told = str(problem).removeprefix(f"{artifact.path}: ")
        raise BenchError(f"{chosen.model} on {chosen.backend}: {told}") from problem


def _checked(chosen: Chosen, source: CSource) -> Checked:
    """Compile the C and compare it. Raises BenchError where it does not agree."""
    with ThreadPoolExecutor(1) as aside:  # the compiler is a process of its own
        compiled = aside.submit(_predicted, source, chosen)
        expected_m = _runtime(chosen)
        found = compiled.result()
    if found is None:
        return Checked(source, expected_m, None)
    agreement = compare(found, expected_m)
    check(agreement, _limit_m(chosen))
    return Checked(source, expected_m, agreement)


def _limit_m(chosen: Chosen) -> float:
    return LIMITS_M[chosen.artifact.precision]


def _runtime(chosen: Chosen) -> Floats:
    """Return what ONNX Runtime gives for the held-out rows, whatever opens the artifact."""
    from backends.ort import open_optimised

    run, rows = open_optimised(chosen.artifact.path), chosen.cirs
    return np.concatenate(
        [run(rows[i : i + _BLOCK_ROWS]) for i in range(0, len(rows), _BLOCK_ROWS)]
    )


def _predicted(source: CSource, chosen: Chosen) -> Floats | None:
    """Return what the C gives for the held-out rows; None where nothing can be compiled."""
    from backends.c.compile import PLAIN, CompilerError, compiler
    from backends.c.run import load

    try:
        return None if compiler() is None else load(source, PLAIN)(chosen.cirs)
    except CompilerError as problem:
        raise BenchError(str(problem)) from problem


def _count(chosen: Chosen, checked: Checked, parts: Sequence[Profile]) -> Sequence[Counted]:
    """Count this very C on every part."""
    if not parts:
        return ()
    from bench.runner.counting import count_artifact

    files = dict(checked.source.files)
    return count_artifact(chosen.artifact, parts, chosen.cirs[checked.rows], files=files)


def _figures(chosen: Chosen, checked: Checked, counted: Sequence[Counted], kept: Counts) -> Figures:
    from backends.c.run import inputs, samples

    source = checked.source
    return Figures(
        chosen.artifact.precision == "int8",
        checked.agreement,
        constant_bytes(source),
        source.arena_bytes,
        samples(source),
        inputs(source),
        counted,
        kept.lines,
    )


def _files(chosen: Chosen, checked: Checked, figures: Figures) -> dict[str, str]:
    rows, limit_m = checked.rows, _limit_m(chosen)
    return {
        **checked.source.files,
        "uwb_selftest.c": selftest(chosen.cirs[rows], checked.expected_m[rows], limit_m),
        "Makefile": makefile(),
        "LICENCE": licence(),
        REPORT: report(chosen, figures),
    }


def _is_there(folder: Path, source: CSource) -> bool:
    """Return whether a folder holds this very C."""
    try:
        return all(
            (folder / name).read_bytes() == text.encode() for name, text in source.files.items()
        )
    except OSError:
        return False


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
