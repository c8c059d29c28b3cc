"""Links behind something are long by themselves: a name that only acts there must beat that."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

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


def contest(left_m: np.ndarray, acts: np.ndarray, drawn_m: np.ndarray) -> SimpleNamespace:
    """Return as much of a contest as is asked, with a wall that acts on some rows [n]."""
    made = Evidence(left_m, LINKS, {"wall": (0.05 * acts[:, None],)})
    made.lie_behind(BEHIND)
    return SimpleNamespace(
        library={"wall"}, evidence=made, crowding=1.0, drawn_m=drawn_m,
        bare=lambda _: 0.05 * acts[:, None], seen=lambda columns: columns,
    )  # fmt: skip


FEW = np.isin(LINKS, (0, 3)).astype(float)
MANY = BEHIND.astype(float)
THEIRS_M = np.where(BEHIND, RNG.exponential(0.3, 60)[LINKS], 0.0) + NOISE_M[::-1]  # simulated
LONG_M = 0.5 * (LINKS == 0) + 0.16 * (LINKS == 3)


@pytest.mark.parametrize(
    ("left_m", "acts", "stays"),
    [
        (0.2 * MANY + NOISE_M, MANY, True),  # a wall that is as thick in every link
        (LONG_M + NOISE_M, FEW, False),  # two links that happen to be long
        (DETOURS_M + NOISE_M, MANY, True),  # twenty are not all long by chance
        (0.05 * np.where(LINKS % 6 == 0, 1, -1) * MANY + NOISE_M, MANY, False),
        (LONG_M + NOISE_M, FEW + (LINKS == 1), True),  # acts in sight, too: no detour's
    ],
)
def test_a_name_behind_obstacles_must_beat_offsets_of_its_links(
    left_m: np.ndarray, acts: np.ndarray, stays: bool
) -> None:
    given = contest(left_m, acts, THEIRS_M)
    assert beyond_detours(given, ("wall",)) == (("wall",) if stays else ())  # type: ignore[arg-type]


def test_where_simulated_links_have_no_detours_recorded_ones_have_a_cause() -> None:
    for drawn_m, stays in ((THEIRS_M, False), (NOISE_M[::-1], True)):
        left_m = 0.05 * np.where(LINKS % 6 == 0, 1, -1) * MANY + NOISE_M
        given = contest(left_m, MANY, drawn_m)
        assert beyond_detours(given, ("wall",)) == (("wall",) if stays else ())  # type: ignore[arg-type]
