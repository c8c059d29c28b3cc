"""Parameters in words: the ones that matter first, long lists of a device's or level's values cut.

Every value stands in the report's last table and in diagnosis.json.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select.verdict import Ambiguous, LeftOut, Verdict
from bench.discrepancy.settings import SHOWN_VALUES


def parameter_lines(parameters: Sequence[ParameterEstimate]) -> list[str]:
    """Return the parameters with their intervals; of a long list those farthest from zero."""
    out = []
    for name, group in groupby(parameters, lambda one: one.name.partition("[")[0]):
        values = list(group)
        long = len(values) > SHOWN_VALUES + 1
        first = sorted(values, key=_distance, reverse=True)[:SHOWN_VALUES] if long else values
        out += [f"  - {one}{' (90 %)' if one.determined else ''}" for one in first]
        out += [f"  - {_rest(name, values, first)}"] if long else []
    return out


def _distance(one: ParameterEstimate) -> float:
    """Return how many half widths of its interval a value is from zero."""
    half = (one.high - one.low) / 2
    return abs(one.value) / half if one.determined and half > 0 else 0.0


def _rest(
    name: str, values: Sequence[ParameterEstimate], first: Sequence[ParameterEstimate]
) -> str:
    left = [one for one in values if one not in first]
    none = sum(not one.determined or one.low <= 0 <= one.high for one in left)
    return f"and {len(left)} more values of {name}, {none} of them not told from zero"


def value_table(verdicts: Sequence[Verdict]) -> list[str]:
    """Return every parameter of everything named, for the end of the report."""
    named = [one for one in verdicts if isinstance(one, LeftOut)]
    named += [option for one in verdicts if isinstance(one, Ambiguous) for option in one.options]
    lines = [f"- {one.names[0]}: {parameter}" for one in named for parameter in one.parameters]
    return ["## Every value (90 % intervals)", "", *lines, ""] if lines else []
