from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from bench.errors import BenchError
from bench.positioning import (
    DegenerateGeometryError,
    dilution_of_precision,
    gauss_newton,
    robust_least_squares,
)

ROOM_3D = np.array([[0, 0, 0.3], [5, 0, 2.5], [5, 5, 0.4], [0, 5, 2.2]], float)
SQUARE_2D = np.array([[0, 0], [5, 0], [5, 5], [0, 5]], float)


def ranges_to(anchors: np.ndarray, positions: np.ndarray) -> np.ndarray:
    return np.linalg.norm(positions[:, None] - anchors, axis=-1)


@pytest.mark.parametrize("anchors", [ROOM_3D, SQUARE_2D])
def test_noise_free_ranges_give_the_position(anchors: np.ndarray) -> None:
    truth = np.random.default_rng(0).uniform(0.2, 2.4, (200, anchors.shape[1]))
    fixes = gauss_newton(anchors, ranges_to(anchors, truth))
    assert fixes.converged.all()
    assert np.abs(fixes.positions_m - truth).max() < 1e-6
    assert fixes.residual_rms_m.max() < 1e-6


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000))
def test_any_well_spread_anchors_give_the_position(seed: int) -> None:
    rng = np.random.default_rng(seed)
    anchors, truth = rng.uniform(0, 10, (5, 3)), rng.uniform(2, 8, (1, 3))
    assume(dilution_of_precision(anchors, truth)[0] < 4)
    fixes = gauss_newton(anchors, ranges_to(anchors, truth))
    assert np.abs(fixes.positions_m - truth).max() < 1e-6


def test_dop_predicts_the_spread() -> None:
    rng = np.random.default_rng(1)
    truth = np.tile([1.0, 2.0, 1.0], (4000, 1))
    ranges = ranges_to(ROOM_3D, truth) + rng.normal(0, 0.01, (4000, 4))
    fixes = gauss_newton(ROOM_3D, ranges)
    spread = np.sqrt(fixes.positions_m.var(axis=0).sum())
    assert spread == pytest.approx(0.01 * dilution_of_precision(ROOM_3D, truth[:1])[0], rel=0.05)


def test_one_long_range_moves_the_robust_fix_less() -> None:
    truth = np.array([[2.0, 3.0]])
    anchors = np.array([[0, 0], [5, 0], [5, 5], [0, 5], [2.5, 7], [7, 2.5]], float)
    ranges = ranges_to(anchors, truth)
    ranges[0, 0] += 1.5
    plain = np.linalg.norm(gauss_newton(anchors, ranges).positions_m - truth)
    robust = np.linalg.norm(robust_least_squares(anchors, ranges).positions_m - truth)
    assert robust < plain / 2


@pytest.mark.parametrize(
    ("anchors", "expected"),
    [
        ([[0, 0], [1, 1], [2, 2]], "one line"),
        ([[0, 0], [1, 0], [1, 0]], "coincide"),
        ([[0, 0], [1, 0]], "at least 3"),
        ([[0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]], "one plane"),
        ([[0, 0, 1], [1, 0, 1], [0, 1, 2]], "at least 4"),
        ([[0, 0], [1, float("nan")], [2, 2]], "finite"),
    ],
)
def test_degenerate_geometry_says_which(anchors: list[list[float]], expected: str) -> None:
    with pytest.raises(DegenerateGeometryError, match=expected):
        gauss_newton(anchors, np.ones((1, len(anchors))))


def test_a_start_chooses_the_side_of_a_plane() -> None:
    anchors = np.array([[0, 0, 2.5], [5, 0, 2.5], [5, 5, 2.5], [0, 5, 2.5]], float)
    truth = np.array([[1.0, 2.0, 0.9]])
    below = gauss_newton(anchors, ranges_to(anchors, truth), start_m=[2.5, 2.5, 1.0])
    above = gauss_newton(anchors, ranges_to(anchors, truth), start_m=[2.5, 2.5, 4.0])
    assert below.positions_m[0] == pytest.approx(truth[0], abs=1e-6)
    assert above.positions_m[0] == pytest.approx([1.0, 2.0, 4.1], abs=1e-6)


def test_steps_are_damped_where_whole_ones_run_away() -> None:
    # Ranges read up to 3 m long: undamped, the iteration ends 15 km away.
    anchors, ranges = np.array([[3.8, 2.2], [4.9, 2.1], [4.2, 0.1]]), np.array([[1.2, 1.8, 4.7]])
    fixes = gauss_newton(anchors, ranges)
    assert fixes.converged.all()
    near = np.stack(np.meshgrid(np.linspace(0, 8, 81), np.linspace(0, 8, 81)), -1).reshape(-1, 2)
    rms = np.sqrt(((ranges_to(anchors, near) - ranges) ** 2).mean(axis=1))
    assert fixes.residual_rms_m[0] <= rms.min()


def test_wrong_ranges_are_refused() -> None:
    with pytest.raises(BenchError, match="expected \\[epochs, 4\\]"):
        gauss_newton(SQUARE_2D, np.ones((3, 3)))
    with pytest.raises(BenchError, match="not finite"):
        gauss_newton(SQUARE_2D, np.full((1, 4), np.nan))
