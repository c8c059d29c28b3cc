"""Scores of what is said beside the library: a law without a name, a fault of the set-up."""

from __future__ import annotations

from typing import Any

import numpy as np

from bench.challenge.cases import Case
from bench.discrepancy.diagnosis import Diagnosis
from bench.discrepancy.law.found import LawConstant
from bench.discrepancy.law.named_faults import named_fault

WITHIN = 0.1


def law_score(case: Case, found: Diagnosis) -> dict[str, Any]:
    """Return what is stated, whether its form is right, and whether its size is within 10 %.

    The form of a law is right where the law, or one that the recordings do not exclude, has it. A
    fault needs its kind; its size is right where the devices are, and what it measures is. Where
    the library is the truth, a fault that a named effect of it is (`time-lag`) is that name, and
    no law beside it.
    """
    law, fault = found.law, found.setup_fault
    stated = str(fault or law or "")
    if not case.law.forms:
        return {
            "stated_law": "" if law is None and fault == named_fault(found.selection) else stated
        }
    told = {fault.kind} if fault else set()
    told |= {law.form, *(rival.form for rival in law.rivals)} if law else set()
    right = bool(told & set(case.law.forms))
    return {"stated_law": stated, "form_right": right, "value_right": _value_right(case, found)}


def _value_right(case: Case, found: Diagnosis) -> bool | None:
    """Return whether devices and size are those that are hidden, None where nothing is to say."""
    hidden, law, fault = case.law, found.law, found.setup_fault
    if not (hidden.value or hidden.devices):
        return None
    told = " ".join(fault.devices).split() if fault else []  # "rx is a4" where one is concerned
    if not set(hidden.devices) <= set(told):
        return False
    size = fault.size if fault else law.constants if law else ()
    if not hidden.value:
        return True
    wanted = hidden.value * (case.drawn.strength if hidden.grows else 1.0)
    return _near([c for c in size if c.unit == hidden.unit], wanted)


def _near(constants: list[LawConstant], wanted: float) -> bool:
    """Return whether a constant, or the length of all, is the wanted one within 10 %."""
    values = [abs(constant.value) for constant in constants]
    lengths = [*values, float(np.linalg.norm(values))] if values else []
    return any(abs(value / wanted - 1) < WITHIN for value in lengths)
