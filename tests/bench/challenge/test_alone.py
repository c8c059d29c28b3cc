"""What one of several hidden effects adds to ranges that come with waveforms."""

from __future__ import annotations

import numpy as np
import pytest

from bench.challenge.alone import shift_of
from bench.challenge.cases import Case, drawn_of, make_case, recorded_with
from bench.challenge.families.ropewalk_wave_effects import OF_RANGES

FAMILY = ("ropewalk",)


@pytest.fixture(scope="module")
def both() -> Case:
    """The first case with waveforms that hides a clock's large offset beside a changed waveform."""
    for number in range(1, 1500, 2):
        turn, drawn = drawn_of(number, 5, FAMILY)
        wanted = "clock-offset" in drawn.hidden and len(drawn.hidden) == 2
        wanted = wanted and drawn.strength >= 1.0
        if turn.mode == "CIR" and wanted and {*drawn.hidden} - {*OF_RANGES}:
            return make_case(number, 5, FAMILY)
    raise AssertionError("no such case")


def test_a_clock_adds_the_same_alone_and_beside_others(both: Case):
    shift = shift_of(both, "clock-offset")
    assert shift is not None
    others = tuple(name for name in both.drawn.hidden if name != "clock-offset")
    left = both.recorded.frame["error_m"] - recorded_with(both, others)["error_m"]
    np.testing.assert_allclose(shift, left, atol=1e-3)
    assert np.abs(shift).max() > 0.05


def test_what_changes_waveforms_has_no_shift_of_its_own(both: Case):
    other = next(name for name in both.drawn.hidden if name != "clock-offset")
    assert shift_of(both, other) is None


def test_with_ranges_alone_the_family_says_it():
    case = next(
        case for number in range(0, 40, 4) if (case := make_case(number, 5)).drawn.hidden
        and case.turn.mode == "ranges" and case.shifts_m is not None
    )  # fmt: skip
    assert case.shifts_m is not None
    for place, name in enumerate(case.drawn.hidden):
        np.testing.assert_array_equal(shift_of(case, name), case.shifts_m[place])
