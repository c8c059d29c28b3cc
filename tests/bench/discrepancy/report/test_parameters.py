"""A screen holds what was found: long lists of values are cut to those that matter."""

from __future__ import annotations

from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.report.parameters import parameter_lines
from bench.discrepancy.settings import SHOWN_VALUES


def delay(device: str, value_ns: float, half_ns: float = 0.1) -> ParameterEstimate:
    name = f"delay_ns[{device}]"
    return ParameterEstimate(name, value_ns, value_ns - half_ns, value_ns + half_ns, "ns")


def test_of_a_long_list_the_values_farthest_from_zero_come_first() -> None:
    values = [delay(f"t{k}", 0.05) for k in range(8)]
    values += [delay("a0", 1.2), delay("a1", -0.6), delay("wide", 3.0, half_ns=9.0)]
    lines = parameter_lines(values)
    assert len(lines) == SHOWN_VALUES + 1
    assert "delay_ns[a0] = 1.2 [1.1, 1.3] ns" in lines[0]
    assert "delay_ns[a1]" in lines[1]
    assert "and 7 more values of delay_ns, 7 of them not told from zero" in lines[-1]


def test_a_short_list_stays_in_its_order_and_other_parameters_beside_it() -> None:
    scale = ParameterEstimate("scale", 0.3, 0.2, 0.4, "1")
    values = [scale, *(delay(f"t{k}", 0.1 * k) for k in range(SHOWN_VALUES))]
    assert [line.split()[1] for line in parameter_lines(values)] == [one.name for one in values]
