"""The regression that says what could be removed, and rows that are too few for it."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.fit.reference_regression import corrected


def _part(links: np.ndarray) -> tuple[Ensemble, Covariates]:
    """Return rows whose recorded error grows with a number, and that number."""
    rng = np.random.default_rng(0)
    number = np.linspace(0, 1, len(links))
    versions = rng.normal(0, 0.01, (5, len(links), 1))
    versions[0, :, 0] += number
    return Ensemble(("error_m",), ("m",), versions, links), Covariates({"x": number}, {})


def test_a_trend_is_removed_from_other_rows():
    fit, known = _part(np.repeat(np.arange(10), 8))
    made = corrected(fit, known, fit, known, ("error_m",))
    assert np.abs(made.residual).mean() < 0.1 * np.abs(fit.residual).mean()


def test_links_of_one_row_beside_another_teach_a_constant():
    for links in (np.array([0, 1]), np.array([0, 1, 1, 1]), np.zeros(4, int)):
        fit, known = _part(links)
        made = corrected(fit, known, fit, known, ("error_m",))
        assert abs(made.residual.mean()) < 1e-9


def test_a_level_that_only_one_part_of_the_links_has_teaches_nothing():
    fit, known = _part(np.repeat(np.arange(10), 8))
    names, units = ("error_m", "rx_power_dbm"), ("m", "dB")
    more = Ensemble(names, units, np.repeat(fit.versions, 2, axis=2), fit.links)
    for taught, asked in ((fit, more), (more, fit)):
        made = corrected(taught, known, asked, known, ("error_m",))
        assert np.abs(made.residual_of("error_m")).mean() < 0.1 * np.abs(fit.residual).mean()
