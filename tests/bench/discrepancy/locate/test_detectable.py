"""The shift that is said to be seen is seen about every second time; rare links are seen too."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.locate.permutation_test import locate, rare_links
from bench.discrepancy.locate.rare import struck_above, struck_rows

LINKS, ROWS = 40, 5


def _ensemble(seed: int, versions: int, shift: float = 0.0, struck: int = 0) -> Ensemble:
    """Return an ensemble of one observable whose links have offsets of their own."""
    rng = np.random.default_rng(seed)
    link = np.repeat(np.arange(LINKS), ROWS)
    offsets = rng.normal(0, 0.03, (1 + versions, LINKS))
    offsets[0, :struck] += 0.8
    values = offsets[:, link] + rng.normal(0, 0.03, (1 + versions, len(link)))
    values[0] += shift
    return Ensemble(("error_m",), ("m",), values[..., None], link)


def _seen(versions: int, times: float) -> float:
    """Return how often a shift of so many times the stated one is seen."""
    seen = []
    for seed in range(24):
        stated = locate(_ensemble(seed, versions), Covariates({}, {}), seed, permutations=199)
        shift = times * stated.detectable["error_m"]
        again = _ensemble(seed + 100, versions, shift)
        seen.append(locate(again, Covariates({}, {}), seed, permutations=199).significant)
    return float(np.mean(seen))


@pytest.mark.parametrize("versions", [1, 3, 8])
def test_the_stated_shift_is_true_within_half(versions):
    assert _seen(versions, 1.5) > 0.6
    assert _seen(versions, 1 / 1.5) < 0.5


def test_two_links_among_forty_are_seen_with_three_simulated_versions():
    found = [rare_links(_ensemble(seed, 3, struck=2), seed) for seed in range(10)]
    assert sum(f is not None for f in found) >= 9
    located = locate(_ensemble(3, 3, struck=2), Covariates({}, {}), 3)
    assert located.significant
    assert located.p <= 0.05


def test_links_that_only_scatter_are_no_rare_cause():
    assert [rare_links(_ensemble(seed, 3), seed) for seed in range(40)].count(None) >= 39


def _late_rows(versions: int, late: int, simulated: int = 0) -> Ensemble:
    """Return an ensemble in which single rows of so many links read two metres long."""
    made = _ensemble(7, versions)
    values = made.versions.copy()
    values[0, ROWS * np.arange(late), 0] += 2.0
    values[1, ROWS * np.arange(simulated) + 1, 0] += 2.0
    return Ensemble(made.names, made.units, values, made.links)


def test_one_late_row_on_some_links_is_seen_though_their_medians_are_as_ever():
    assert rare_links(_late_rows(8, late=3), 0) is None
    p, times = struck_rows(_late_rows(8, late=3))
    assert p == pytest.approx(40 * 39 * 38 / (360 * 359 * 358))
    assert times > 10
    located = locate(_late_rows(8, late=3), Covariates({}, {}), 3, permutations=199)
    assert located.significant
    assert located.p <= 0.01


def test_late_rows_say_nothing_where_chance_or_the_simulator_makes_them():
    assert struck_rows(_late_rows(2, late=1))[0] == pytest.approx(1 / 3)
    assert struck_rows(_late_rows(8, late=3, simulated=1))[0] == 1.0
    assert struck_rows(_late_rows(1, late=5))[0] == 1.0  # of two versions, which one is off?
    crowded = struck_rows(_late_rows(8, late=3), crowding=2.0)[0]
    assert crowded > 20 * struck_rows(_late_rows(8, late=3))[0]


def test_late_rows_count_from_a_least_delay_on_and_sooner_ones_never():
    made = _late_rows(8, late=3)
    versions, p = made.versions[..., 0], struck_rows(made)[0]
    assert struck_above(versions, made.links, 0.6) == pytest.approx(p)
    assert struck_above(versions, made.links, 2.5) == 1.0
    assert struck_above(-versions, made.links, 0.6) == 1.0
    assert struck_above(versions, made.links, 0.6, crowding=2.0) > 20 * p


def test_rows_without_a_range_are_no_late_ones():
    made = _late_rows(8, late=3)
    made.versions[0, : 2 * ROWS, 0] = np.nan
    assert struck_rows(made)[0] == pytest.approx(38 / (38 * 9))
    made.versions[0, :, 0] = np.nan
    assert struck_rows(made) == (1.0, 0.0)
