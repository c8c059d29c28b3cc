"""Constants of laws in words: digits that tell, and what a unit that nobody knows stands for."""

from __future__ import annotations

import pytest

from bench.discrepancy.law.forms import FORMS
from bench.discrepancy.law.found import LawConstant
from bench.discrepancy.law.structures import GridLaw


@pytest.mark.parametrize(
    ("constant", "words"),
    [
        (LawConstant("ratio", 1.004, 1.0038, 1.0042, "1"), "1.004 (1.0038..1.0042)"),
        (LawConstant("a", 0.00268, 0.00246, 0.00285, "m"), "0.00268 (0.00246..0.00285) m"),
        (LawConstant("a", 0.5, 0.5, 0.5 + 1e-12, "m"), "0.5 (0.5..0.5) m"),
    ],
)
def test_an_interval_has_digits_that_tell_its_ends(constant: LawConstant, words: str) -> None:
    assert str(constant) == words


@pytest.mark.parametrize(
    ("name", "shown", "words"),
    [
        (
            "humidity percent",
            "0.003 (0.002..0.004) m",
            "0.003 (0.002..0.004) m per unit of humidity",
        ),
        ("true range", "0.004 (0.003..0.005) m per m", "m per m of true range"),
    ],
)
def test_a_slope_over_what_has_no_unit_is_per_unit_of_it(name: str, shown: str, words: str) -> None:
    linear = next(form for form in FORMS if form.name == "linear")
    names = (name.replace(" ", "_"), name, "", "", "")
    law = GridLaw(linear, 0, 0, False, 0.0, (0.0, 1.0), 1, names)
    assert words in law.words({"a": shown})
