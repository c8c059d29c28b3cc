"""Parameters in words: the ones that matter first, long lists of a device's or level's values cut.

Every value stands in the report's last table and in diagnosis.json.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import groupby

from bench.discrepancy.data.observables import unit_of
from bench.discrepancy.fit.estimate import PURE, ParameterEstimate
from bench.discrepancy.select.verdict import Ambiguous, LeftOut, NoMismatch, Verdict
from bench.discrepancy.settings import SHOWN_VALUES
from bench.physics.effect import Effect

KNOT = re.compile(r"\[-?[\d.]+(e[-+]?\d+)? \w+\]$")  # a value of a curve, at -80 dBm or 30 deg

PER_OBSTACLE, OF_THICKNESS = "excess_m[", ("thickness_scale", "delay_scale")


def parameter_lines(
    parameters: Sequence[ParameterEstimate], kind: type[Effect] | None = None
) -> list[str]:
    """Return the parameters with their intervals; of a long list those farthest from zero.

    Each with what it means, as the `kind` of effect says. Those that may be zero are counted, those
    that are not determined share the last line. Factors of a thickness that no table has stand in
    the last table alone where metres per obstacle say the same.
    """
    out, open_ones = [], []
    told = any(one.name.startswith(PER_OBSTACLE) for one in parameters)
    parameters = [one for one in parameters if not (told and one.name in OF_THICKNESS)]
    for name, group in groupby(parameters, lambda one: one.name.partition("[")[0]):
        values = list(group)
        long = len(values) > SHOWN_VALUES + 1
        first = sorted(values, key=_distance, reverse=True)[:SHOWN_VALUES] if long else values
        first = _told(first) if long else first
        first = [one for one in values if one in first]  # levels and angles stay in order
        out += [f"  - {one} (90 %){_meaning(one, kind)}" for one in first if one.determined]
        open_ones += [_unknown(one, kind) for one in first if not one.determined]
        out += [f"  - {_rest(name, values, first)}"] if long else []
    named = ", ".join(open_ones)
    return out + ([f"  - not determined by these recordings: {named}"] if open_ones else [])


def _meaning(one: ParameterEstimate, kind: type[Effect] | None) -> str:
    """Return what a parameter means, after a colon; "" for values per device and along curves."""
    known = () if kind is None else kind.parameters()
    return next((f": {item.meaning}" for item in known if item.name == one.name), "")


def _unknown(one: ParameterEstimate, kind: type[Effect] | None) -> str:
    """Return the name of a parameter that is not determined, and what it means."""
    meaning = _meaning(one, kind).removeprefix(": ")
    return f"{one.name} ({meaning})" if meaning else one.name


def _told(first: list[ParameterEstimate]) -> list[ParameterEstimate]:
    """Return those of a long list that are told from zero, all where none is or it is a curve."""
    if all(KNOT.search(one.name) for one in first):
        return first
    return [one for one in first if _distance(one) > 1] or first


def _distance(one: ParameterEstimate) -> float:
    """Return how many half widths of its interval a value is from zero."""
    half = (one.high - one.low) / 2
    return abs(one.value) / half if one.determined and half > 0 else 0.0


def _rest(
    name: str, values: Sequence[ParameterEstimate], first: Sequence[ParameterEstimate]
) -> str:
    left = [one for one in values if one not in first]
    if all(KNOT.search(one.name) for one in values):  # of a curve: that it crosses zero is no news
        return f"and {len(left)} more values of {name} along the curve"
    none = sum(not one.determined or one.low <= 0 <= one.high for one in left)
    told = f"of which {none} may be zero" if none else "none of them zero"
    return f"and {len(left)} more values of {name}, {told}"


AS_WRITTEN = (
    "`simulator.toml` holds the values of the last fit of all effects together; those above were "
    "fitted once more for their intervals, with other random draws, so their last digits differ."
)


def value_table(verdicts: Sequence[Verdict], written: bool = False) -> list[str]:
    """Return every parameter of everything named, for the end of the report.

    `written`: a new simulator has them, too.
    """
    named = [one for one in verdicts if isinstance(one, LeftOut)]
    named += [option for one in verdicts if isinstance(one, Ambiguous) for option in one.options]
    lines = [
        f"- {one.names[0]}: {parameter}{_meaning(parameter, type(one.effect))}"
        for one in named
        for parameter in one.parameters
    ]
    seen = [line for one in verdicts if isinstance(one, NoMismatch) for line in _shifts(one)]
    more = [AS_WRITTEN, ""] if written else []
    out = ["## Every value (90 % intervals)", "", *lines, "", *more] if lines else []
    return out + (["## Smallest shifts of all rows that would show", "", *seen, ""] if seen else [])


def detectable_line(verdict: NoMismatch) -> str:
    """Return the smallest shifts that would show, of the observables a person asks for first."""
    every = _shifts(verdict)
    first = [line for line in every if "[" not in line][:SHOWN_VALUES]
    rest = f", and {len(every) - len(first)} more in the report" if len(every) > len(first) else ""
    shown = ", ".join(line.removeprefix("- ") for line in first)
    return f"Smallest shift of all rows that would show: {shown}{rest}"


def _shifts(verdict: NoMismatch) -> list[str]:
    """Return a line per observable that varies."""
    sizes = verdict.detectable.items()
    units = {name: "" if unit_of(name) in PURE else f" {unit_of(name)}" for name, _ in sizes}
    return [f"- {name} {size:.3g}{units[name]}" for name, size in sizes if size > 0]


def skipped_line(skipped: Mapping[str, str]) -> str:
    """Return which effects took no part, in one line without reasons; "" where none."""
    return f"skipped (the report says why): {', '.join(sorted(skipped))}" if skipped else ""


def skipped_lines(skipped: Mapping[str, str]) -> list[str]:
    """Return which effects took no part, those of one reason in one line."""
    reasons: dict[str, list[str]] = {}
    for name, reason in skipped.items():
        reasons.setdefault(reason, []).append(name)
    return [f"skipped {', '.join(names)}: {reason}" for reason, names in reasons.items()]
