"""Which measurement would tell apart what these recordings cannot."""

from __future__ import annotations

from bench.discrepancy.select.verdict import LeftOut


def separating(options: tuple[LeftOut, ...]) -> str:
    """Return which measurement would tell the options apart."""
    told = {type(option.effect).told_by for option in options}
    each = "; ".join(f"{one.names[0]}: {type(one.effect).signature}" for one in options)
    words = f"vary what only one of them follows: {each}"
    return (told.pop() if len(told) == 1 else "") or words
