"""Where a wrong position does as well as a name, the name is not sure."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from bench.discrepancy.sets.beside import elsewhere, leading_faults, misplaced

MOVED = "the position of a2"


@pytest.mark.parametrize("own", ["antenna-delay", "clock-offset"])
@pytest.mark.parametrize(
    ("moved_nats", "kept"), [(99.0, True), (90.0, True), (101.0, True), (104.0, False)]
)
def test_a_device_that_stands_elsewhere_goes_before_its_delay_or_clock_where_it_leads(
    moved_nats: float, kept: bool, own: str
) -> None:
    """A place is three numbers, a delay one: what has no lead of that is said beside it."""
    nats = {
        frozenset({own, "time-lag"}): 100.0,
        frozenset({MOVED, "time-lag"}): moved_nats,
        frozenset({MOVED, own}): 40.0,
    }
    contest: Any = SimpleNamespace(
        evidence=SimpleNamespace(blocks={MOVED: (), own: (), "time-lag": ()}),
        library={own, "time-lag"},
        nats=lambda causes: nats[frozenset(causes)],
    )
    found = set(misplaced(cast("Any", contest), (own, "time-lag")))
    assert found == {own if kept else MOVED, "time-lag"}
    beside = elsewhere(cast("Any", contest), (own, "time-lag"))
    assert beside == (("a2",) if moved_nats > 97 else ())


@pytest.mark.parametrize(("brought", "leads"), [(90.0, True), (20.0, False)])
def test_a_fault_is_left_to_say_where_it_brings_more_than_any_name(
    brought: float, leads: bool
) -> None:
    nats = {MOVED: brought, "time-lag": 50.0, "a law of z": 99.0}
    contest: Any = SimpleNamespace(
        library={"time-lag"}, brings=lambda causes, one: nats[one] if one in causes else 0.0
    )
    found = leading_faults(cast("Any", contest), tuple(nats))
    assert found == ((MOVED,) if leads else ())
