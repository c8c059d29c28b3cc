"""Scatter is taken out where links keep offsets beyond doubt, not where one in twenty would."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.locate.permutation_test import Finding, Located
from bench.discrepancy.select import stepwise
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.stepwise import contradicted
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter

SEARCH = cast(Search, SimpleNamespace(comparison=None, searched=None))


@pytest.mark.parametrize(
    ("p", "share", "taken_out"), [(0.002, 0.0, True), (0.03, 0.0, False), (0.03, 0.5, True)]
)
def test_only_offsets_beyond_doubt_contradict_scatter(
    monkeypatch: pytest.MonkeyPatch, p: float, share: float, taken_out: bool
) -> None:
    monkeypatch.setattr(stepwise, "versions", lambda *_: None)
    monkeypatch.setattr(stepwise, "of_links", lambda *_: (share, 0.1))
    jitter = TimestampJitter()
    found = Finding(
        Cell("error_m", "link", Place("pair=t1->a2")), Estimate(0.02, 0.01, 0.03), 4.0, p, 9, 3
    )
    located = Located((found,), p, 4.0, 3.0, 1, {})
    assert (contradicted(SEARCH, (RangeScale(), jitter), located) is jitter) is taken_out
