"""Effects without intervals in words: every field with its unit, if it has one."""

from __future__ import annotations

from bench.discrepancy.report.found_lines import _short
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail


def test_fields_have_units_and_pure_numbers_none() -> None:
    words = _short(DiffuseTail(level_db=-3.0, distance_exponent=1.5, static=0.25)).split("; ")
    assert {"level_db = -3 dB", "distance_exponent = 1.5", "static = 0.25"} <= {*words}
