"""A screen holds what was found: long lists of values are cut to those that matter."""

from __future__ import annotations

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.report.parameters import (
    detectable_line,
    parameter_lines,
    skipped_line,
    skipped_lines,
    value_table,
)
from bench.discrepancy.select.verdict import Control, LeftOut, NoMismatch
from bench.discrepancy.settings import SHOWN_VALUES
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.ranging.range_scale import RangeScale


def delay(device: str, value_ns: float, half_ns: float = 0.1) -> ParameterEstimate:
    name = f"delay_ns[{device}]"
    return ParameterEstimate(name, value_ns, value_ns - half_ns, value_ns + half_ns, "ns")


def test_of_a_long_list_the_values_farthest_from_zero_come_first() -> None:
    values = [delay(f"t{k}", 0.05) for k in range(8)]
    values += [delay("a0", 1.2), delay("a1", -0.6), delay("wide", 3.0, half_ns=9.0)]
    lines = parameter_lines(values)
    assert len(lines) == 3
    assert "delay_ns[a0] = 1.2 [1.1, 1.3] ns" in lines[0]
    assert "delay_ns[a1]" in lines[1]
    assert "and 9 more values of delay_ns, of which 9 may be zero" in lines[-1]


def test_where_all_of_a_long_list_may_be_zero_some_are_shown() -> None:
    assert len(parameter_lines([delay(f"t{k}", 0.05) for k in range(9)])) == SHOWN_VALUES + 1


def test_a_short_list_stays_in_its_order_and_other_parameters_beside_it() -> None:
    scale = ParameterEstimate("scale", 0.3, 0.2, 0.4, "1")
    values = [scale, *(delay(f"t{k}", 0.1 * k) for k in range(SHOWN_VALUES))]
    assert [line.split()[1] for line in parameter_lines(values)] == [one.name for one in values]


def test_what_is_not_determined_shares_the_last_line() -> None:
    scale = ParameterEstimate("scale", 0.3, 0.2, 0.4, "1")
    unsure = [ParameterEstimate(name, 0, 0, 1, "dB", determined=False) for name in ("a", "b")]
    assert parameter_lines([*unsure, scale])[-1] == "  - not determined by these recordings: a, b"
    assert len(parameter_lines([*unsure, scale])) == 2


def test_a_value_says_what_it_means_where_its_effect_does() -> None:
    kept = ParameterEstimate("static", 0.3, 0.2, 0.4, "ratio")
    lines = parameter_lines([kept, delay("a0", 1.2)], DiffuseTail)
    assert lines[0].endswith("(90 %): of a tap's power that a link keeps")
    assert lines[1].endswith("(90 %)")
    said = LeftOut(DiffuseTail(), (kept,), Estimate(1, 0.5, 2), 1.0, Control("", None))
    assert any(one.endswith(": of a tap's power that a link keeps") for one in value_table([said]))


def test_effects_skipped_for_one_reason_share_a_line() -> None:
    lines = skipped_lines({"a": "needs cir", "b": "needs los", "c": "needs cir"})
    assert lines == ["skipped a, c: needs cir", "skipped b: needs los"]


def test_shifts_that_would_show_name_what_varies_and_leave_the_rest_to_the_report() -> None:
    bins = {f"profile_db[{k}..{k + 1}ns]": 1.5 for k in range(5)}
    nothing = NoMismatch({"error_m": 0.017, "preamble_count": 0.0, **bins}, 0.4)
    line = detectable_line(nothing)
    assert "error_m 0.017 m" in line
    assert "preamble_count" not in line
    assert "5 more in the report" in line
    assert len(value_table([nothing])) == 6 + 3


def test_the_values_shown_stay_in_the_order_of_their_levels() -> None:
    sizes = [0.3, 0.5, 0.2, 0.9, 0.7, 1.1, 0.4, 0.6]
    lines = parameter_lines([delay(f"{-80 + k}", size) for k, size in enumerate(sizes)])
    assert [line.split()[1] for line in lines[:-1]] == sorted(
        (line.split()[1] for line in lines[:-1]), reverse=True
    )


def test_a_screen_beside_a_report_names_what_was_skipped_in_one_line() -> None:
    assert skipped_line({}) == ""
    assert skipped_line({"b": "needs los", "a": "needs cir"}).endswith("says why): a, b")


def test_of_a_curve_that_crosses_zero_nobody_asks_how_many_values_may_be_zero() -> None:
    knots = [ParameterEstimate(f"bias_m[{30 * i} deg]", 0.1 * i, 0.0, 1.0, "m") for i in range(9)]
    assert parameter_lines(knots)[-1].endswith("more values of bias_m along the curve")


def test_a_report_says_why_the_last_digits_of_a_simulator_are_others() -> None:
    one = LeftOut(
        RangeScale(), (ParameterEstimate("scale", 0.1, 0.0, 0.2, "m/m"),), Estimate(1, 1, 1), 1.0,
        Control("", None),
    )  # fmt: skip
    assert "other random draws" in " ".join(value_table((one,), written=True))
    assert "other random draws" not in " ".join(value_table((one,)))


def test_factors_of_a_thickness_are_left_out_where_metres_per_obstacle_are_known() -> None:
    scale = ParameterEstimate("thickness_scale", 2.5, 2.0, 3.0, "1")
    step = ParameterEstimate("excess_m[shelf]", 0.05, 0.04, 0.06, "m")
    assert any("thickness_scale" in line for line in parameter_lines([scale]))
    lines = parameter_lines([step, scale])
    assert len(lines) == 1
    assert "excess_m[shelf]" in lines[0]
