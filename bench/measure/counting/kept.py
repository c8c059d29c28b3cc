"""Counts kept in the cache: the same image, rows and table give the same count, so it is read.

A long `bench count` that was stopped goes on from here when it is given again.
"""

from __future__ import annotations

import hashlib
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.measure.counting.compile import Image
from bench.measure.counting.core import Core
from bench.measure.counting.count import Count, count_image
from bench.measure.counting.elf import read_elf
from bench.provenance import keep, kept, package_version, packages_code_hash

TOOLS = ("unicorn", "capstone", "pyelftools")
Floats = NDArray[np.float32]


def count_kept(image: Image, core: Core, rows: Floats) -> Count:
    """Return the count of CIRs [n, samples] through an image, kept or new.

    Raises BenchError like `count_image`; what could not be counted is tried again.
    """
    question = _question(image, core, rows)
    if (found := kept("count", question)) is not None:
        return _from_plain(found)
    count = count_image(image, core, rows)
    keep("count", question, _to_plain(count))
    return count


def _question(image: Image, core: Core, rows: Floats) -> list[Any]:
    """Return all that decides a count: image, inputs, the counter with its tables, its tools."""
    inputs = np.ascontiguousarray(rows, "<f4")
    return [
        _digest(image),
        image.compiler,
        core.name,
        repr(core),
        [list(inputs.shape), hashlib.sha256(inputs.tobytes()).hexdigest()],
        packages_code_hash(_package()),
        [package_version(name) for name in TOOLS],
    ]


def _digest(image: Image) -> str:
    """Hash what an image holds, but not its notes for debuggers: those name a folder of the day."""
    contents = repr(read_elf(image.path))
    return hashlib.sha256(contents.encode()).hexdigest()


def _package() -> str:
    return str(Path(*__name__.split(".")[:-1]))


def _to_plain(count: Count) -> dict[str, Any]:
    arrays = {"outputs_m": count.outputs_m.tolist(), "statuses": count.statuses.tolist()}
    return {**asdict(count), **arrays}


def _from_plain(content: dict[str, Any]) -> Count:
    """Return the count: lists made the arrays they were."""
    from msgspec import convert

    count = convert(content, Count, dec_hook=lambda _, numbers: np.array(numbers))
    return replace(
        count,
        outputs_m=count.outputs_m.astype(np.float32),
        statuses=count.statuses.astype(np.int64),
    )
