"""Places, cells and their sums over links, against hand-made answers and loops."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.locate.hypotheses import (
    Cell,
    Place,
    _group,
    _intervals,
    link_sums,
    places,
    standardised,
)
from bench.discrepancy.settings import CLIP_STD

VALUE = np.array([0.0, 1.0, 2.0, 3.0, 4.0, np.nan])


def test_an_interval_holds_both_its_ends_and_nothing_unknown() -> None:
    assert Place("x", 1.0, 3.0).weight(VALUE).tolist() == [0, 1, 1, 1, 0, 0]


@pytest.mark.parametrize("place", [Place("x"), Place("x", low=1.0), Place("x", high=1.0)])
def test_a_place_without_both_ends_is_a_group(place) -> None:
    assert place.weight(np.array([True, False])).tolist() == [1, 0]
    assert place.where() == "where x"


def test_all_rows_weigh_one_and_a_trend_is_standardised() -> None:
    assert Place().weight(VALUE).tolist() == [1] * 6
    found = Place("x", trend=True).weight(np.array([1.0, 5.0, np.nan]))
    assert found.tolist() == [-1, 1, 0]
    assert Place("x", trend=True).weight(np.full(3, 2.0)).tolist() == [0, 0, 0]


def test_a_place_in_words() -> None:
    assert Place().where() == "in all rows"
    assert Place("x", 1.0, 2.5).where() == "where x is 1 to 2.5"
    assert Place("x", trend=True).where() == "as a trend over x"


def _ends(value: np.ndarray) -> list[tuple[float | None, float | None]]:
    return [(place.low, place.high) for place, _ in _intervals("x", value) if not place.trend]


def test_a_number_has_two_tails_quarters_twelfths_and_a_trend() -> None:
    value = np.r_[np.arange(101.0), np.nan]
    found = list(_intervals("x", value))
    quarters = [(0, 25), (25, 50), (50, 75), (75, 100)]
    twelfths = [(100 * i / 12, 100 * (i + 1) / 12) for i in range(12)]
    expected = [(0, 5), (95, 100), *quarters, *twelfths]
    assert np.array(_ends(value)) == pytest.approx(np.array(expected))
    assert found[-1][0] == Place("x", trend=True)
    assert len(found) == len(expected) + 1
    for place, weight in found:
        assert weight.tolist() == place.weight(value).tolist()


def test_intervals_of_all_known_rows_and_of_none_are_no_places() -> None:
    assert _ends(np.r_[np.nan, np.zeros(51), np.ones(49)]) == [(0, 0), (1, 1)]
    assert _ends(np.r_[0.0, np.ones(99)]) == [(1, 1)]
    assert all(place.weight(v).any() for v in (np.eye(4)[3],) for place, _ in _intervals("x", v))


@pytest.mark.parametrize("value", [np.full(4, 2.0), np.full(4, np.nan), np.r_[1.0, np.nan]])
def test_a_number_that_never_differs_has_no_place(value) -> None:
    assert list(_intervals("x", value)) == []


def _one(versions: list[list[float]]) -> Ensemble:
    rows = np.array(versions).T[..., None]  # given as rows of versions
    return Ensemble(("error_m",), ("m",), rows, np.arange(rows.shape[1]))


def test_versions_are_centred_per_row_and_scaled_by_the_mean_of_row_medians() -> None:
    # Squares about the mean: 4, 1, 9 (median 4) and 1, 1, 4 (median 1); their mean is 2.5.
    rows = [[0.1, 0.2, 0.6], [0.0, 0.0, 0.3], [np.nan] * 3]
    expected = np.array([[-2, -1, 3], [-1, -1, 2], [0, 0, 0]]) / np.sqrt(2.5)
    found = standardised(_one(rows))[..., 0].T
    assert found == pytest.approx(expected, rel=1e-6)


def test_where_most_versions_agree_the_scale_is_that_of_all_values() -> None:
    found = standardised(_one([[-2.0, 0.0, 0.0, 0.0, 2.0], [0.0] * 5]))[..., 0].T
    # Mean square of the ten values: 0.8.
    expected = np.array([[-2, 0, 0, 0, 2], [0] * 5]) / np.sqrt(0.8)
    assert found == pytest.approx(expected, rel=1e-6)


def test_wild_values_are_cut_on_either_side() -> None:
    rows = [[0.0, 0.0, 0.0, 0.0, 100.0], *[[0.0] * 5] * 99]  # the scale is 20 / sqrt(100) = 2
    assert standardised(_one(rows))[:, 0, 0].tolist() == [-CLIP_STD] * 4 + [CLIP_STD]


def _mixed() -> tuple[Ensemble, Covariates]:
    """Return three versions of two observables over three links whose rows are interleaved."""
    rng = np.random.default_rng(4)
    link = np.array([1, 0, 2, 0, 1, 1, 2, 0, 2])
    versions = rng.normal(size=(3, 9, 2))
    versions[:, 4, 0] = np.nan
    ensemble = Ensemble(("error_m", "rx_power_dbm"), ("m", "dB"), versions, link)
    return ensemble, Covariates({"x": rng.normal(size=9)}, {"wall": link > 0})


def _written_out(ensemble: Ensemble, cell: Cell, weight: np.ndarray) -> np.ndarray:
    """Return the centred statistic of one cell [1 + m, L]."""
    value = standardised(ensemble)[..., ensemble.place(cell.observable)].astype(float)
    whole = np.broadcast_to(weight, value.shape)
    out = np.zeros((len(value), 3))
    for version, link in np.ndindex(*out.shape):
        mine = ensemble.links == link
        v, w = value[version, mine], whole[version, mine]
        total = (w * v).sum()
        offset = abs(total) / np.sqrt(max(abs(w.sum()), 1))
        by = {"mean": total, "slope": total, "spread": (w * abs(v)).sum(), "link": offset}
        out[version, link] = by[cell.moment]
    return out - out.mean(axis=0)


def _expected_cells(found: list[tuple[Place, np.ndarray]]) -> list[tuple[Cell, np.ndarray]]:
    out = []
    for axes in (1, 2):
        group = [(place, weight) for place, weight in found if weight.ndim == axes]
        for moment in ("mean", "spread", "link"):
            for place, weight in group:
                for name in ("error_m", "rx_power_dbm"):
                    kind = "slope" if place.trend else moment
                    if name != place.covariate and (moment == "mean" or not place.trend):
                        out.append((Cell(name, kind, place), weight))
    return out


def test_cells_and_sums_are_their_definitions_written_out() -> None:
    ensemble, known = _mixed()
    found = list(places(known, ensemble))
    assert [place for place, _ in found[:2]] == [Place(), Place("wall")]
    assert {place.covariate for place, _ in found} == {None, "wall", "x", "rx_power_dbm"}
    expected = _expected_cells(found)
    cells, sums = link_sums(ensemble, known)
    assert cells == [cell for cell, _ in expected]
    for number, (cell, weight) in enumerate(expected):
        assert sums[..., number] == pytest.approx(_written_out(ensemble, cell, weight), abs=1e-5)


@pytest.mark.parametrize("links", [[1, 0, 1], [2, 1, 2]])
def test_links_begin_and_end_where_their_rows_do(links) -> None:
    versions = np.arange(6.0).reshape(2, 3, 1) ** 2
    ensemble = Ensemble(("error_m",), ("m",), versions, np.array(links))
    group = _group(ensemble, [(Place(), np.ones(3))])
    assert group.bounds.tolist() == [0, 1, 3]
    assert group.links == 2


def test_rows_of_a_link_keep_their_order() -> None:
    links = np.arange(600) % 3
    versions = np.random.default_rng(0).normal(size=(2, 600, 1))
    ensemble = Ensemble(("error_m",), ("m",), versions, links)
    group = _group(ensemble, [(Place("x"), np.arange(600.0))])
    expected = np.concatenate([np.arange(start, 600, 3) for start in range(3)])
    assert group.weight[:, 0].tolist() == expected.tolist()
    assert group.values.tolist() == standardised(ensemble)[:, expected].tolist()
