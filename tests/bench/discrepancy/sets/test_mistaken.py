"""A column that was set aside as measured is known before where a law over it says what is left."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.sets.choice import Choice
from bench.discrepancy.sets.choose import Contest, chosen
from bench.discrepancy.sets.evidence import Evidence
from bench.discrepancy.sets.mistaken import mistaken
from bench.recordings.table import Recordings
from tests.bench.discrepancy.numpy_tables import Hidden, constant
from tests.bench.discrepancy.sets.test_sets import search_of


def set_aside(
    hidden: Hidden | None,
    load: Callable[[pd.DataFrame], np.ndarray],
    change: Callable[[Recordings], Recordings] = lambda one: one,
) -> Choice:
    """Return what is chosen where one column, `load`, was set aside as measured."""
    search = search_of(hidden, 12, change)
    assert search.work is not None
    doubtful = pd.DataFrame({"load": load(search.work.frame)})
    return chosen(replace(search, doubtful=doubtful), ())


def busy(frame: pd.DataFrame) -> np.ndarray:
    """Return a load that scatters from row to row."""
    return np.random.default_rng(5).lognormal(3, 0.8, len(frame))


def test_a_column_that_explains_what_is_missing_was_known_before() -> None:
    def delayed(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
        return 0.2 * busy(frame) / (busy(frame) + 20)

    assert set_aside(delayed, busy).mistaken == ("load",)
    assert set_aside(None, busy).mistaken == ()


def even(frame: pd.DataFrame, width: float = 0.37) -> np.ndarray:
    """Return a load that scatters about 20."""
    return 20 * np.exp(np.random.default_rng(5).normal(0, width, len(frame)))


def test_a_column_of_which_a_law_stands_in_for_a_name_was_known_before() -> None:
    """In proportion, without a constant: the delay that is named for it is one cause too many."""

    def late(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
        return 0.002 * even(frame)

    assert set_aside(late, even).mistaken == ("load",)


def quieter(one: Recordings) -> Recordings:
    """Return the recorded table with errors a seventh smaller; the simulated one as it is."""
    less = 0.86 if one.simulator is None else 1.0
    return replace(one, frame=one.frame.assign(error_m=less * one.frame["error_m"]))


def test_where_a_law_leaves_names_nothing_it_may_leave_less_than_simulated() -> None:
    """Recorded rows may scatter less than simulated ones by chance."""

    def late(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
        return 0.0026 * even(frame)

    assert set_aside(late, even, quieter).mistaken == ("load",)


def test_a_constant_that_a_set_lacks_says_nothing_of_a_column() -> None:
    search = search_of(constant, 12)
    rows = search.sharpest
    ensemble = search.comparison.ensemble(rows, (), 3)
    left, every = ensemble.residual_of(RANGE), np.arange(len(rows.rows))
    evidence = Evidence(left, rows.links, {})
    contest = Contest(evidence, {}, 1.0, rows, every, every >= 0)
    doubtful = pd.DataFrame({"load": even(rows.frame, 0.02)})
    assert mistaken(contest, (), doubtful, ensemble) == ()


def test_rows_that_share_simulated_ones_scatter_no_less() -> None:
    """One simulated row for each recorded one, and links near enough to take each other's."""
    rng, rows = np.random.default_rng(8), search_of(constant, 12).sharpest
    count, links = len(rows.rows), np.unique(rows.links, return_inverse=True)[1]
    versions = np.empty((5, count, 1))
    shared = 2 * links + rng.integers(0, 2, count)  # two simulated rows for all of a link
    versions[1:, :, 0] = rng.normal(0, 0.015, (4, shared.max() + 1))[:, shared]
    load = even(rows.frame)
    versions[0, :, 0] = 0.005 * load + rng.normal(0, 0.015, count)
    ensemble, every = Ensemble((RANGE,), ("m",), versions, rows.links), np.arange(count)
    evidence = Evidence(ensemble.residual_of(RANGE), links, {})
    contest = Contest(evidence, {}, 1.0, rows, every, every >= 0)
    assert mistaken(contest, (), pd.DataFrame({"load": load}), ensemble) == ("load",)


def test_rows_that_share_simulated_ones_may_be_far_off_together() -> None:
    """What is far off is a link's own on the simulated side, and one row's on the recorded."""
    rng, rows = np.random.default_rng(8), search_of(constant, 12).sharpest
    count, links = len(rows.rows), np.unique(rows.links, return_inverse=True)[1]
    wide = rng.uniform(0.4, 1.6, links.max() + 1)
    versions = np.empty((5, count, 1))
    shared = 2 * links + rng.integers(0, 2, count)  # two simulated rows for all of a link
    far = rng.laplace(0, 0.012, (4, shared.max() + 1))[:, shared]
    versions[1:, :, 0] = wide[links] * far
    load = even(rows.frame)
    versions[0, :, 0] = 0.02 * load + wide[links] * rng.laplace(0, 0.012, count)
    ensemble, every = Ensemble((RANGE,), ("m",), versions, rows.links), np.arange(count)
    evidence = Evidence(ensemble.residual_of(RANGE), links, {})
    contest = Contest(evidence, {}, 1.5, rows, every, every >= 0)
    assert mistaken(contest, (), pd.DataFrame({"load": load}), ensemble) == ("load",)


@pytest.mark.parametrize("hidden", [None, constant])
@pytest.mark.parametrize("own_m", [0.02, 0.05])
def test_a_column_that_follows_the_noise_stays_measured(
    hidden: Hidden | None, own_m: float
) -> None:
    """Of ranges that are late by 12 cm, too: a figure in proportion to them says that as well."""
    rng = np.random.default_rng(6)
    found = set_aside(hidden, lambda f: f["error_m"] + rng.normal(0, own_m, len(f)))
    assert found.mistaken == ()
    assert ("antenna-delay" in found.names) == (hidden is not None)
