"""What is said beside an AUC where there are too few links for one."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.discrepancy.compare.calibration import auc_doubt, separability
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.settings import FEWEST_AUC_LINKS


def test_an_auc_of_so_few_links_that_none_could_tell_says_so() -> None:
    assert auc_doubt(3) == " (3 links: too few to tell, an AUC far from 0.5 is no finding)"
    assert auc_doubt(FEWEST_AUC_LINKS) == ""
    assert 0.5 ** (FEWEST_AUC_LINKS - 1) > 0.05 > 0.5**FEWEST_AUC_LINKS  # a sign test's least p


def test_an_observable_that_no_held_out_row_has_tells_nothing_apart() -> None:
    rng = np.random.default_rng(0)
    versions = rng.normal(size=(3, 40, 2))
    versions[0, :, 0] += 9.0
    links = np.repeat(np.arange(8), 5)
    whole = separability(Ensemble(("error_m",), ("m",), versions[..., :1], links), 0)
    versions[..., 1] = np.nan
    assert (
        separability(Ensemble(("error_m", "noise_std"), ("m", "dB"), versions, links), 0) == whole
    )
    versions[..., 0] = np.nan
    nothing = Ensemble(("error_m", "noise_std"), ("m", "dB"), versions, links)
    assert np.isnan(separability(nothing, 0))


def test_a_view_that_all_links_would_leave_keeps_them() -> None:
    frame = pd.DataFrame({"true_range_m": [3.0, 4.0, 5.0], "error_m": [0.1, 0.2, 0.3]})
    seen = view(frame, np.array([0, 1, 1]), np.arange(3), Window())
    assert len(seen.leaving(np.array([1])).rows) == 1
    assert seen.leaving(np.array([0, 1])) is seen


def test_a_figure_in_whole_samples_that_matching_moved_tells_no_row_apart() -> None:
    rng = np.random.default_rng(1)
    versions = rng.integers(0, 3, (3, 80, 1)) * 1.0016
    versions[1:] += rng.normal(0, 0.01, versions[1:].shape)
    made = Ensemble(("rise_time_ns",), ("ns",), versions, np.repeat(np.arange(16), 5))
    assert abs(separability(made, 0) - 0.5) < 0.15
    versions[0] += 2 * 1.0016  # a pulse that is longer is seen all the same
    assert separability(made, 0) > 0.9


def test_rows_that_stand_for_several_links_tell_no_recorded_row_apart() -> None:
    rng = np.random.default_rng(2)
    shared, links = np.repeat(np.arange(6), 20), np.repeat(np.arange(24), 5)
    versions = rng.normal(size=(2, 120, 3))
    versions[1] = rng.normal(size=(6, 3))[shared]  # of six simulated links, the same rows again
    made = Ensemble(("error_m", "rx_power_dbm", "noise_std"), ("m", "dB", "1"), versions, links)
    assert separability(made, 0) > 0.9  # known by heart
    assert separability(made, 0, shared) < 0.8


def test_gaps_in_a_log_tell_no_row_apart() -> None:
    rng = np.random.default_rng(3)
    versions = rng.normal(size=(2, 120, 2))
    versions[0, rng.random(120) < 0.3, 1] = np.nan
    links = np.repeat(np.arange(24), 5)
    made = Ensemble(("error_m", "rx_power_dbm"), ("m", "dB"), versions, links)
    assert abs(separability(made, 0) - 0.5) < 0.15
