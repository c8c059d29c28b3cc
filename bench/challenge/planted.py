"""Is the shift that a clean verdict says it would have seen, seen: exactly that shift is planted.

The search is the diagnosis' own; of the library only a constant is offered, which changes what is
named and not what is seen.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.challenge.cases import Case
from bench.discrepancy import Diagnosis, Options, diagnose
from bench.discrepancy.select.verdict import NoMismatch
from bench.plugins import load
from bench.recordings.table import Recordings

WITHIN = 1.5  # the stated shift is to be true within this factor
SMALLER, LARGER = f"1/{WITHIN:g}", f"{WITHIN:g}"


def detected(case: Case, found: Diagnosis, seed: int) -> dict[str, bool]:
    """Return whether a shift smaller or larger by `WITHIN` than the stated one is seen.

    Cases take one of both in turn. Empty where something was found, or no shift is stated. To be
    true to its word, "every second time", the smaller must be seen in less than half of many
    cases, the larger in more.
    """
    first = found.selection.verdicts[0]
    stated = first.detectable.get("error_m", np.nan) if isinstance(first, NoMismatch) else np.nan
    if not np.isfinite(stated):
        return {}
    larger = bool(case.turn.number // 4 % 2)
    size = stated * WITHIN if larger else stated / WITHIN
    return {LARGER if larger else SMALLER: _seen(case, size, seed)}


def _seen(case: Case, shift_m: float, seed: int) -> bool:
    """Return whether a shift of all ranges is seen."""
    frame = case.recorded.frame
    columns = {name: frame[name] + shift_m for name in ("range_m", "error_m")}
    shifted: Recordings = replace(case.recorded, frame=frame.assign(**columns))
    kinds = {"antenna-delay": load("effects", "antenna-delay")}
    found = diagnose(shifted, case.simulated, Options(seed), kinds=kinds)
    return not isinstance(found.selection.verdicts[0], NoMismatch)
