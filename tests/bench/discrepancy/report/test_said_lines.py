"""Lines that say what a user said as such, and nothing where nothing could be removed."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.report.document import describe, measured_lines
from bench.discrepancy.select.verdict import Unknown


def test_what_the_user_said_is_measured_is_not_put_down_to_the_rule() -> None:
    options = SimpleNamespace(measured=("supply_v",), known=())
    diagnosis = SimpleNamespace(
        links=(9, 9), measured=("supply_v", "lqi"), options=options
    )  # fmt: skip
    said, guessed = measured_lines(diagnosis)  # type: ignore[arg-type]
    assert said == "Measured, so not searched over: supply_v (you said so)."
    assert guessed.startswith("Measured, so not searched over: lqi (a column of your own")


@pytest.mark.parametrize(
    ("gain", "words"),
    [
        (Estimate(-0.7, -1.0, 0.1, "nats"), "removes nothing of held-out score"),
        (Estimate(0.7, 0.4, 1.1, "nats"), "removes 0.7 nats [0.4, 1.1] of held-out score"),
    ],
)
def test_a_regression_that_loses_removes_nothing(gain: Estimate, words: str) -> None:
    assert any(words in line for line in describe(Unknown((), gain, {}, "why")))
