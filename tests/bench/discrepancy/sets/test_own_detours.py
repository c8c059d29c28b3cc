"""Links behind something are long by themselves: a name that only acts there must beat that."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.sets import own_detours
from bench.discrepancy.sets.evidence import Evidence
from bench.discrepancy.sets.own_detours import beyond_detours

LINKS = np.repeat(np.arange(60), 4)
BEHIND = LINKS % 3 == 0
RNG = np.random.default_rng(4)
NOISE_M = RNG.normal(0, 0.02, len(LINKS))
DETOURS_M = np.where(BEHIND, RNG.exponential(0.3, 60)[LINKS], 0.0)
DELAY = {"delay": (0.1 * (LINKS % 5 == 1)[:, None],)}


def evidence(left_m: np.ndarray, behind: np.ndarray = BEHIND) -> Evidence:
    made = Evidence(left_m, LINKS, DELAY)
    made.lie_behind(behind)
    made.reweigh(("delay",))
    return made


def test_offsets_behind_something_are_wider_and_hide_no_delay() -> None:
    late_m = 0.06 * (LINKS % 5 == 1)
    told, blind = (
        evidence(late_m + NOISE_M + DETOURS_M, some) for some in (BEHIND, np.zeros_like(BEHIND))
    )
    assert told.wider[0] > 20
    assert set(told.wider[1:3]) == {1.0}
    brought = [one.of(("delay",)).nats - one.of(()).nats for one in (told, blind)]
    assert brought[0] > brought[1] + 10
    assert told.response(told.of(("delay",)), "delay").max() == pytest.approx(0.06, abs=0.01)


def test_offsets_that_are_no_wider_or_of_few_links_stay_as_they_are() -> None:
    even = evidence(NOISE_M + RNG.normal(0, 0.05, 60)[LINKS])
    few = evidence(NOISE_M + DETOURS_M, LINKS < 6)
    for one in (even, few):
        assert (one.wider == 1.0).all()


@pytest.mark.parametrize(("lead", "stays"), [(-7.0, True), (-5.0, False), (2.0, False)])
@pytest.mark.parametrize("everywhere", [True, False])
def test_a_name_behind_obstacles_must_be_worth_twice_its_price(
    monkeypatch: pytest.MonkeyPatch, lead: float, stays: bool, everywhere: bool
) -> None:
    """One that acts in sight, too, is no detour's."""
    monkeypatch.setattr(
        own_detours, "Beside", lambda *_: SimpleNamespace(lead=lambda other: lead * (not other))
    )
    acts = np.ones(len(LINKS)) if everywhere else BEHIND.astype(float)
    contest = SimpleNamespace(
        library={"wall"}, evidence=evidence(NOISE_M), bare=lambda _: acts[:, None]
    )
    kept = beyond_detours(contest, ("wall",))  # type: ignore[arg-type]
    assert kept == (("wall",) if stays or everywhere else ())
