"""An error over the level and one over the distance part where levels leave what is usual."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.select.fixed_distance import following

RNG = np.random.default_rng(7)
LINKS = np.repeat(np.arange(120), 2)
FAR_M = RNG.uniform(4, 28, 120)[LINKS]
LEVEL = -62 - 20 * np.log10(FAR_M) + RNG.normal(0, 1.2, 120)[LINKS] + RNG.normal(0, 0.3, 240)
NOISE_M = RNG.normal(0, 0.025, 240)


def curve(level: np.ndarray) -> np.ndarray:
    return -0.07 * np.arctan((level + 84) / 3)


def share(cause_dbm: np.ndarray, response_m: np.ndarray) -> tuple[float, float, float]:
    left = curve(cause_dbm) + NOISE_M - response_m
    found = following(LEVEL, FAR_M, response_m, left, LINKS)
    assert found is not None
    return found


def test_an_error_of_the_level_follows_it_whatever_the_fitted_curve_is_over() -> None:
    usual = -62 - 20 * np.log10(FAR_M)
    for response in (curve(usual), curve(LEVEL)):
        assert share(LEVEL, response)[1] > 0.5


def test_an_error_of_the_distance_does_not_follow_the_level() -> None:
    usual = -62 - 20 * np.log10(FAR_M)
    for response in (curve(usual), curve(LEVEL)):
        assert share(usual, response)[2] < 0.5


def test_levels_that_are_as_usual_everywhere_tell_nothing() -> None:
    usual = -62 - 20 * np.log10(FAR_M)
    found = following(usual + RNG.normal(0, 0.01, 240), FAR_M, curve(usual), NOISE_M, LINKS)
    assert found is None or found[2] > 0.5


def test_few_places_tell_nothing() -> None:
    few = LINKS < 10
    response = curve(LEVEL)[few]
    assert following(LEVEL[few], FAR_M[few], response, NOISE_M[few], LINKS[few]) is None
