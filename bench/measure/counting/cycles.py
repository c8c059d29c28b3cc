"""Instructions to cycles by a core's table: neighbours that pipeline, results used at once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bench.measure.counting.core import Core
from bench.measure.counting.instructions import Instruction

Columns = NDArray[np.float64]
"""Cycles [3]: low, typical, high."""
_MEMORY = ("load", "store")
_BRANCHES = ("branch", "call", "return")


@dataclass(frozen=True)
class BlockCost:
    """One basic block: its instructions by kind, its cycles, and those a taken branch adds."""

    kinds: Counter[str]
    cycles: Columns
    taken: Columns

    @property
    def instructions(self) -> int:
        """How many instructions it holds."""
        return sum(self.kinds.values())


def block_cost(block: Sequence[Instruction], core: Core) -> BlockCost:
    """Return what a block costs each time it is entered, and more each time its branch is taken."""
    followed = [*pairwise(block), (block[-1], None)] if block else []
    total = sum((_cycles(one, then, core) for one, then in followed), np.zeros(3))
    factor = np.array(core.issue.columns())
    taken = _taken(block[-1], core) if block else np.zeros(3)
    return BlockCost(Counter(one.kind for one in block), total * factor, taken * factor)


def _cycles(one: Instruction, then: Instruction | None, core: Core) -> Columns:
    """Return the cycles of one instruction in front of the next; a branch as not taken."""
    used = then is not None and bool(one.writes & then.reads)
    cycles = _base(one, then, used, core)
    if used and one.kind == "load":
        cycles = cycles + _price(core, "load_use")
    if used and one.kind in ("float", "float_mac", "float_divide"):
        cycles = cycles + _price(core, "float_use")
    return cycles


def _base(one: Instruction, then: Instruction | None, used: bool, core: Core) -> Columns:
    if one.multiple:
        return _price(core, "multiple_base") + one.words * _price(core, "multiple_each")
    if one.kind == "load" and then is not None and then.kind in _MEMORY and not used:
        return _price(core, "load_then_access")
    return _price(core, "branch" if one.kind in _BRANCHES else one.kind)


def _taken(last: Instruction, core: Core) -> Columns:
    """Return what a taken branch takes beyond one not taken; nothing where there is no branch."""
    if last.kind not in _BRANCHES:
        return np.zeros(3)
    name = "branch_taken" if last.kind == "branch" else last.kind
    return _price(core, name) - _price(core, "branch")


def _price(core: Core, name: str) -> Columns:
    return np.array(core.price(name).columns())
