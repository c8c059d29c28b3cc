"""What is said where nothing is found does not contradict the level of 5 %."""

from __future__ import annotations

from bench.discrepancy.select.verdict import NoMismatch


def test_a_small_p_that_was_not_enough_is_said_to_be() -> None:
    shift = {"error_m": 0.012}
    assert str(NoMismatch(shift, 0.49)).startswith("no mismatch found (p = 0.49); a range shift")
    assert "(p = 0.024, not enough by itself)" in str(NoMismatch(shift, 0.024))
    assert str(NoMismatch({}, 0.02)) == "no mismatch found (p = 0.02, not enough by itself)"
