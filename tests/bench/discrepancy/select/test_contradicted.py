"""Scatter is taken out where links keep offsets beyond doubt, not where one in twenty would."""

from __future__ import annotations

import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.locate.permutation_test import Finding, Located
from bench.discrepancy.select.stepwise import contradicted
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter


@pytest.mark.parametrize(("p", "taken_out"), [(0.002, True), (0.03, False)])
def test_only_offsets_beyond_doubt_contradict_scatter(p: float, taken_out: bool) -> None:
    jitter = TimestampJitter()
    found = Finding(
        Cell("error_m", "link", Place("pair=t1->a2")), Estimate(0.02, 0.01, 0.03), 4.0, p, 9, 3
    )
    located = Located((found,), p, 4.0, 3.0, 1, {})
    assert (contradicted((RangeScale(), jitter), located) is jitter) is taken_out
