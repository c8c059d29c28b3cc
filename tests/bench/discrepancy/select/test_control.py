"""A negative control refuses a name where something is left beyond chance, and only there."""

from __future__ import annotations

import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.select.conclude import control_passed


@pytest.mark.parametrize(
    ("quiet", "loud", "passed"),
    [
        (Estimate(0.01, -0.005, 0.025, "m"), 0.03, True),  # holds zero
        (Estimate(0.01, 0.008, 0.012, "m"), 0.1, True),  # little beside what is elsewhere
        (Estimate(-0.011, -0.019, -0.001, "m"), 0.03, None),  # one interval in twenty is such
        (Estimate(0.03, 0.02, 0.04, "m"), 0.03, False),
        (Estimate(-0.03, -0.04, -0.02, "m"), 0.03, False),
    ],
)
def test_chance_alone_refuses_no_name(quiet: Estimate, loud: float, passed: bool | None) -> None:
    assert control_passed(quiet, loud) is passed
