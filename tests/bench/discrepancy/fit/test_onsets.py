"""Where the search begins: between what does nothing and what does too much."""

import pytest

from bench.discrepancy.fit.starts import onsets, starts
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.late_detection import LateDetection


def test_a_threshold_is_tried_between_nothing_and_too_much() -> None:
    points = starts(LateDetection, False, True)
    much = [None if point["peak_fraction"] < 0.5 else True for point in points]
    found = onsets(LateDetection, points, much)
    assert len(found) == 4
    assert {point["rise_db"] for point in found} == {0.0}
    assert all(0.45 < point["peak_fraction"] < 0.9 for point in found)


@pytest.mark.parametrize("did", [None, True, False])
def test_nothing_is_tried_where_all_points_are_alike(did: bool | None) -> None:
    points = starts(LateDetection, False, True)
    assert onsets(LateDetection, points, [did] * len(points)) == []


def test_both_sides_of_nothing_are_tried_each_by_itself() -> None:
    points = starts(PathLoss, False, True)
    much = [None if abs(point["offset_db"]) < 3 else True for point in points]
    offsets = [point["offset_db"] for point in onsets(PathLoss, points, much)]
    assert min(offsets) < 0 < max(offsets)
