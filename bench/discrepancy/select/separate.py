"""Which measurement would tell apart what these recordings cannot."""

from __future__ import annotations

from bench.discrepancy.select.verdict import NEEDS, Ambiguous, LeftOut


def separating(options: tuple[LeftOut, ...]) -> str:
    """Return which measurement would tell the options apart."""
    told = {type(option.effect).told_by for option in options}
    each = "; ".join(f"{one.names[0]}: {type(one.effect).signature}" for one in options)
    words = f"vary what only one of them follows: {each}"
    if len(told) == 1 and (measured := told.pop()):
        return measured
    return words + "".join(f"; or give {one}" for one in _missing(options))


def _missing(options: tuple[LeftOut, ...]) -> list[str]:
    """Return what effects need that could not be tried, in words."""
    return [
        f"{one.names[0]} what it needs to be tried: {one.note.removeprefix(NEEDS)}"
        for one in options
        if one.note.startswith(NEEDS)
    ]


def one_of(options: tuple[LeftOut, ...]) -> LeftOut | Ambiguous:
    """Return the verdict on one name, or on some of which each would do."""
    return options[0] if len(options) == 1 else Ambiguous(options, separating(options))
