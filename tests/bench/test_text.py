"""Numbers in sentences."""

from __future__ import annotations

import pytest

from bench.text import significant


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (2563.2, "2560"),
        (-12345.0, "-12300"),
        (0.01234, "0.0123"),
        (3.2e7, "3.2e+07"),
        (0.0, "0"),
    ],
)
def test_no_power_of_ten_below_a_million(value: float, text: str) -> None:
    assert significant(value, 3) == text
