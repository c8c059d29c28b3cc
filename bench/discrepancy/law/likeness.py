"""Whether a law has the form of an effect of the library: then it is no law without a name.

A law is looked for where names are not sure: beside waveforms that nothing explains, beside other
causes, or where a name was refused. What it says may then be just what such an effect does.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.view import View
from bench.discrepancy.data.regression import rest_of
from bench.discrepancy.law.found import UNNAMED
from bench.discrepancy.law.judge import setup_fault
from bench.discrepancy.law.material import material
from bench.discrepancy.law.search import Proposal
from bench.discrepancy.law.settings import LAW_OWN_FORM
from bench.discrepancy.select.state import Search, Selection
from bench.discrepancy.select.verdict import Unknown
from bench.physics.effect import Effect

OF_DETECTORS = "waveforms show what nothing explains, and a detector may make of that the same"
OF_LOG = "by what is logged: simulate it from that log"
OF_OTHER_CURVE = "which is named: its curve is another than the library's"
NOT_ALONE = "it is not borne out as a cause of its own"


def form_words(search: Search, found: Selection, law: Proposal, detectors: bool) -> str:
    """Return of which effects' form a law is, and why these have no name; "" of none.

    `detectors`: waveforms are not explained. Nothing of a fault of the set-up, which says it.
    """
    if setup_fault(law):  # it is said as that
        return ""
    kinds = search.kinds.items()
    logs = [name for name, kind in kinds if has_form(kind, search.discover, law, logged=True)]
    if logs:
        return f"{' or '.join(logs)}, {OF_LOG}"
    names = [name for name, kind in kinds if has_form(kind, search.discover, law)]
    if not names:
        return ""
    said = [name for name in names if any(name in verdict.names for verdict in found.verdicts)]
    if said:
        return f"{' or '.join(said)}, {OF_OTHER_CURVE}"
    notes = (one.note for one in found.verdicts if isinstance(one, Unknown))
    refused = [note for note in notes if any(name in note for name in names)]
    why = next(iter(refused), OF_DETECTORS if detectors else NOT_ALONE)
    return f"{' or '.join(names)}{UNNAMED}{why}"


def has_form(kind: type[Effect], rows: View, law: Proposal, logged: bool = False) -> bool:
    """Return whether an effect can do to rows what a law does, but for a constant beside it.

    Exactly: a law that nearly levels off is no constant, where recordings told it from one.
    Effects on the way of a pulse, and of its level, are free curves that can do anything smooth: of
    these nothing is said. Nor of faults of the set-up, which have names of their own. `logged`: by
    what a log says of it.
    """
    curve = kind.stage != "ranging" or kind.follows
    none = curve or law.best.structure.fault
    columns = None if none else (kind.logged_ways if logged else kind.ways)(rows.scene)
    if not columns:
        return False
    shift = shift_m(rows, law)
    ways = np.hstack(columns)
    left = rest_of(shift, ways)
    same = float((left**2).sum()) <= LAW_OWN_FORM * float((shift**2).sum())
    return bool(same and shift.any() and kind.possible(rows.scene, shift))


def shift_m(rows: View, law: Proposal) -> NDArray[np.float64]:
    """Return what a law says of rows [n], in metres, without a constant that stands beside it."""
    best, every = law.best, np.zeros(len(rows.rows))
    given = material(rows.frame, every, rows.links, law.given)
    found = best.fitted.constants
    constants = tuple((n, 0.0 if n == "b" else value, unit) for n, value, unit in found)
    return np.nan_to_num(best.structure.shift_m(given, constants))
