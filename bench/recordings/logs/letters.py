"""Columns whose names differ from the exchange format's in case alone: `CIR`, `Range_m`, `LOS`."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator

import pandas as pd

from bench.recordings.logs.registers import find_registers
from bench.recordings.logs.units import EXTRA_COLUMNS
from bench.recordings.table import CIR_COLUMNS, FLOAT_COLUMNS, STRING_COLUMNS

_KNOWN = {*FLOAT_COLUMNS, *STRING_COLUMNS, *EXTRA_COLUMNS, *CIR_COLUMNS, "los", "obstacles"}
_NUMBERED = re.compile(r"(.+)_\d+")


def in_our_letters(frame: pd.DataFrame, kept: Collection[str]) -> tuple[pd.DataFrame, list[str]]:
    """Return the table with known columns in our lower case, and a line on each renamed.

    Left as they are: columns of `kept` (named by the user), registers (see `registers`), names that
    the table has in our letters already, and two that would become one.
    """
    own = {*kept, *find_registers(frame).values()}
    wanted = {c: c.lower() for c in map(str, frame) if c not in own and _known(c.lower())}
    often = Counter(wanted.values())
    renames = {old: new for old, new in wanted.items() if old != new and often[new] == 1}
    return frame.rename(columns=renames), list(_lines(renames))


def _known(name: str) -> bool:
    numbered = _NUMBERED.fullmatch(name)
    return name in _KNOWN or (numbered is not None and numbered[1] in CIR_COLUMNS)


def _lines(renames: dict[str, str]) -> Iterator[str]:
    """Yield a line per name, one for all the samples of a CIR."""
    said = {}
    for old, new in renames.items():
        whole = _NUMBERED.fullmatch(new)
        short = whole is not None and new not in _KNOWN
        said[new.rpartition("_")[0] if short else new] = old.rpartition("_")[0] if short else old
    for new, old in said.items():
        yield f"{new} from {old!r}, whose name differs in case alone"
