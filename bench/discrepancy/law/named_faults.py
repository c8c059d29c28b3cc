"""Faults of the set-up that an effect of the library is, and has its name."""

from __future__ import annotations

from bench.discrepancy.law.found import LawConstant, SetupFault
from bench.discrepancy.select.state import Selection
from bench.discrepancy.select.verdict import LeftOut, Unknown


def named_fault(found: Selection) -> SetupFault | None:
    """Return the fault of the set-up that a named effect of the library is, None without one."""
    for verdict in (one for one in found.verdicts if isinstance(one, LeftOut)):
        if kind := type(verdict.effect).setup_fault:
            sizes = [
                LawConstant(p.name, p.value, p.low, p.high, p.unit) for p in verdict.parameters
            ]
            said = ", ".join(f"{size.name} = {size}" for size in sizes)
            return SetupFault(kind, (), f"{kind} ({said})", tuple(sizes))
    return None


def without_a_name(fault: SetupFault | None, found: Selection) -> SetupFault | None:
    """Return the fault, None where it has a name and something else has none."""
    unknown = any(isinstance(verdict, Unknown) for verdict in found.verdicts)
    return None if unknown and fault == named_fault(found) else fault
