"""Multipliers as integers keep their ratio, tiny and mixed ones too."""

from __future__ import annotations

import pytest

from backends.c.kernels.fixed import fixed


@pytest.mark.parametrize("ratios", [[0.7], [0.9, 1e-3], [3e5], [1.2e-10]])
def test_the_largest_ratio_is_kept_to_a_millionth(ratios: list[float]) -> None:
    whole, shift = fixed(ratios)
    assert max(whole) < 1 << 31
    assert max(whole) / 2.0**shift == pytest.approx(max(ratios), rel=1e-6)


def test_a_ratio_that_leaves_nothing_of_any_sum_is_still_a_number() -> None:
    whole, shift = fixed([1e-18])
    assert shift == 62
    assert whole == [5]


@pytest.mark.parametrize("ratios", [[0.0], [-1.0, 0.5], [float("inf")], [1e12]])
def test_no_ratio_is_refused(ratios: list[float]) -> None:
    with pytest.raises(ValueError, match="scales in the ratio"):
        fixed(ratios)
