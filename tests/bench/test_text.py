"""Numbers in sentences."""

from __future__ import annotations

import pytest

from bench.discrepancy.report.document import _safe
from bench.text import significant, unlinked


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (2563.2, "2560"),
        (-12345.0, "-12300"),
        (0.01234, "0.0123"),
        (3.2e7, "3.2e+07"),
        (0.0, "0"),
        (-0.0, "0"),
    ],
)
def test_no_power_of_ten_below_a_million(value: float, text: str) -> None:
    assert significant(value, 3) == text


def test_names_begin_no_tag_and_no_link() -> None:
    assert unlinked("a <img src=x> </b> <!-- <?php") == "a &lt;img src=x> &lt;/b> &lt;!-- &lt;?php"
    assert unlinked("[here](http://evil)") == r"[here]\(http://evil)"
    assert unlinked("p < 0.001, a <= b, **bold** [1, 2] (90 %)") == (
        "p < 0.001, a <= b, **bold** [1, 2] (90 %)"
    )


def test_a_device_begins_no_line_of_a_report() -> None:
    assert _safe(["delay of a1\n# <h1>"]) == [r"delay of a1\n# &lt;h1>"]
