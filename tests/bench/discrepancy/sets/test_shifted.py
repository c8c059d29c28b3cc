"""What a set holds without a name is in the simulator that its names are judged beside."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from bench.discrepancy.compare.view import View
from bench.discrepancy.select.state import Search
from bench.discrepancy.sets.calibrated import TAKEN_OFF
from bench.discrepancy.sets.choice import MERE, Choice
from bench.discrepancy.sets.shifted import Shifted, beside_constants, beside_faults

ROWS = cast(View, SimpleNamespace(rows=np.arange(4), number=7))


def search_with(**shifts_m: list[float]) -> Search:
    """Return a search whose set of causes, of the rows above, does so much to ranges."""
    choice = Choice(shifts_m={o: np.array(m) for o, m in shifts_m.items()}, view=7)
    return cast(Search, SimpleNamespace(choice=choice, comparison="plain"))


@pytest.mark.parametrize("constant", [MERE, TAKEN_OFF])
def test_names_are_judged_beside_the_constant_of_their_set(constant: str) -> None:
    """A clock in ranges that were all 3 cm short made ranges "worse", and had no name."""
    search = search_with(**{"clock-offset": [0.1, 0.2, 0.3, 0.4], constant: [0, -0.03, -0.03, 0]})
    held_out = beside_constants(search, ROWS)
    assert isinstance(held_out, Shifted)
    assert held_out.shift_m.tolist() == [-0.03] * 4
    fitted = beside_faults(search, ROWS)
    assert isinstance(fitted, Shifted)
    assert fitted.shift_m.tolist() == [0, -0.03, -0.03, 0]


def test_names_alone_are_judged_as_they_are() -> None:
    search = search_with(**{"clock-offset": [0.1, 0.2, 0.3, 0.4]})
    assert beside_constants(search, ROWS) == "plain"
    assert beside_faults(search, ROWS) == "plain"
