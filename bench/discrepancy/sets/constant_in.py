"""Delays and clocks that are no constants: those of devices that follow something else.

A cable and a crystal know nothing of a motor's current. What a supply, a mounting or a load does to
the devices of one wall is of these devices, so that its mean passes for a delay of each; but all of
it grows and falls with one number. Where what a name does is a large share bigger and smaller with
a number that no delay or clock goes by, it is something of that number, and has no name.
"""

from __future__ import annotations

from math import log
from typing import TYPE_CHECKING

import numpy as np

from bench.discrepancy.sets.beside import weighed_with
from bench.discrepancy.sets.blocks import OF_CLOCKS, PER_DEVICE, standard
from bench.discrepancy.sets.choice import Choice, Set, but
from bench.discrepancy.sets.settings import FORM_NATS, LAW_NATS, LAW_SIZE, MOST_STD, OFF_BY
from bench.physics.units import Floats

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest

FOLLOWING = " of devices that follow "


def constant_in_all(contest: Contest, causes: Set) -> Set:
    """Return the set with delays or clocks that follow a number as a cause without a name."""
    for name in [kind.name for kind in PER_DEVICE if kind.name in causes]:
        leads = {one: _lead(contest, causes, name, one) for one in _numbers(contest)}
        best = max(leads, key=lambda one: leads[one], default=None)
        if best is not None and leads[best] > LAW_NATS + FORM_NATS + log(len(leads)):
            evidence, label = contest.evidence, f"{name}s{FOLLOWING}{best}"
            parts = evidence.blocks[name] + (_times(contest, causes, name, best),)
            contest.evidence = evidence.with_blocks({**evidence.blocks, label: parts})
            contest.evidence.widest[label] = LAW_SIZE
            causes = (*but(causes, name), label)
    return causes


def in_words(choice: Choice) -> str:
    """Return what would be delays or clocks if it were constant, "" where nothing is."""
    found = next((one for one in choice.others if FOLLOWING in one), None)
    return f"looks most like {found}, and these would be constants" if found else ""


def _numbers(contest: Contest) -> tuple[str, ...]:
    """Return the numbers that no delay or clock goes by, known in every row."""
    return tuple(
        one
        for one in contest.rows.covariates.numbers
        if one not in OF_CLOCKS and np.isfinite(_standard(contest, one)).all()
    )


def _standard(contest: Contest, one: str) -> Floats:
    """Return a number of the known rows [n] beside its mean, in standard deviations."""
    values = contest.rows.covariates.numbers[one][contest.known]
    return np.asarray(standard(values).clip(-MOST_STD, MOST_STD))


def _times(contest: Contest, causes: Set, name: str, one: str) -> Floats:
    """Return what a name does to the known rows [n, 1], times a number."""
    shift_m = contest.shifts(causes)[name][contest.known]
    return contest.seen((shift_m * _standard(contest, one))[:, None])


def _lead(contest: Contest, causes: Set, name: str, one: str) -> float:
    """Return the nats by which a name that follows a number leads it as it is.

    Nothing where it follows by no more than it may be off.
    """
    made = weighed_with(contest, causes, {FOLLOWING: (_times(contest, causes, name, one),)})
    lead = made.nats / contest.crowding - contest.nats(causes)
    return float(lead) if abs(made.factors[-1]) > OFF_BY else 0.0
