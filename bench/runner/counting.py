"""A built artifact on microcontrollers: its C, compiled, emulated, checked and counted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.measure.counting import Count, Figure, build_image, count_kept, figure_of, load_core
from bench.measure.counting.compile import Which
from bench.measure.profile import Profile
from bench.results import CountRecord, Estimate
from bench.runner.records import now_utc
from bench.text import one_line

if TYPE_CHECKING:
    from backends.base import Artifact
    from backends.c.emit import Requantise

Floats = NDArray[np.float32]
ROWS = 32
TOLERANCE_M = 0.001
"""How far an emulated answer may lie from this machine's: 31-bit fixed point rounds otherwise."""


@dataclass(frozen=True)
class Agreement:
    """Emulated answers beside this machine's.

    `equal` of `rows` are the same bits; `largest_m` is the most that any is off, in metres.
    """

    rows: int
    equal: int
    largest_m: float


@dataclass(frozen=True)
class Counted:
    """One artifact on one part: what was counted, what that is on the part, and the check."""

    count: Count
    figure: Figure
    agreement: Agreement


def recorded_rows(inputs: Floats, test: NDArray[np.intp], rows: int = ROWS) -> Floats:
    """Return evenly spaced test rows of inputs [n, width]; all of them where there are fewer."""
    chosen = np.linspace(0, len(test) - 1, min(rows, len(test))).round().astype(np.intp)
    return np.ascontiguousarray(inputs[test[chosen]], np.float32)


def count_artifact(
    artifact: Artifact,
    profiles: Sequence[Profile],
    rows: Floats,
    which: Which = "auto",
    files: Mapping[str, str] | None = None,
) -> list[Counted]:
    """Count an artifact on parts; those with the same core are counted once.

    `files`: C of the artifact as it is to be counted; None takes what suits each core.

    Raises BenchError where a part has no core, tools are missing, C cannot be written for the
    file, or an answer differs from this machine's by more than a millimetre.
    """
    expected_m = _answers(artifact, rows)
    counts: dict[str, tuple[Count, Agreement]] = {}
    found = []
    for profile in profiles:
        if profile.core not in counts:
            counts[profile.core] = _checked(artifact, profile, rows, expected_m, which, files)
        count, agreement = counts[profile.core]
        found.append(Counted(count, figure_of(count, profile), agreement))
    return found


def _answers(artifact: Artifact, rows: Floats) -> Floats:
    """Return what this machine gives. Raises BenchError where the file does not run."""
    try:
        return artifact.predict(rows)
    except ValueError as problem:
        raise BenchError(one_line(str(problem))) from problem


def count_record(counted: Counted, artifact_sha256: str) -> CountRecord:
    """Return what a result folder keeps of a count."""
    count, agreement = counted.count, counted.agreement
    return CountRecord(
        artifact_sha256,
        count.core,
        count.compiler,
        count.rows,
        agreement.equal,
        agreement.largest_m,
        count.instructions,
        count.cycles,
        count.flash_reads,
        count.flash_bytes,
        count.ram_bytes,
        now_utc(),
    )


def counted_estimate(count: CountRecord, profile: Profile) -> Estimate:
    """Return a count on a part; a part too small has a reason and no figures."""
    figure = figure_of(count, profile)
    name, fits = figure.device, figure.fits
    if figure.problem is not None:
        return Estimate(name, None, None, figure.problem, "counted", fits)
    return Estimate(name, figure.latency_us, figure.energy_mj, None, "counted", fits)


def c_files(artifact: Artifact, float_unit: bool) -> dict[str, str]:
    """Return the C of an artifact's file; 8-bit networks without floats where there is no unit.

    Raises BenchError naming the operator that C cannot be written for.
    """
    from backends.c.emit import generate

    how: Requantise = "float" if float_unit else "fixed"
    try:
        return dict(generate(artifact.path, artifact.precision, how).files)
    except ValueError as problem:
        said = str(problem).removeprefix(f"{artifact.path}: ")
        raise BenchError(f"no C for this file: {said}") from problem


def _checked(
    artifact: Artifact,
    profile: Profile,
    rows: Floats,
    expected_m: Floats,
    which: Which,
    files: Mapping[str, str] | None,
) -> tuple[Count, Agreement]:
    if not profile.core:
        raise BenchError(f"device {profile.name} has no core to count on: it is only estimated")
    core = load_core(profile.core)
    image = build_image(files or c_files(artifact, core.float_unit), core, which)
    count = count_kept(image, core, rows)
    return count, _agreement(count, expected_m, profile.core)


def _agreement(count: Count, expected_m: Floats, core: str) -> Agreement:
    """Compare answers. Raises BenchError where the network failed or is too far off."""
    failed = np.flatnonzero(count.statuses)
    if len(failed):
        raise BenchError(f"{core}: uwb_predict returned {count.statuses[failed[0]]}, expected 0")
    off_m = np.abs(count.outputs_m.astype(np.float64) - expected_m)
    if not (off_m <= TOLERANCE_M).all():
        row = int(np.argmax(np.where(np.isnan(off_m), np.inf, off_m)))
        raise BenchError(
            f"{core}: row {row} gave {count.outputs_m[row]:.6g} m, this machine "
            f"{expected_m[row]:.6g} m: expected within {TOLERANCE_M:g} m"
        )
    equal = int((count.outputs_m == expected_m).sum())
    return Agreement(len(expected_m), equal, float(off_m.max()))
