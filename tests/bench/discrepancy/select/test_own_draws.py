"""A table that repeats each link in one environment is no sign that recorded links are off."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.locate.permutation_test import locate
from bench.discrepancy.select.own_draws import beyond_own_draws, common, copied
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.stepwise import locate_left
from bench.physics.units import Floats
from tests.bench.discrepancy.numpy_tables import tables

REPLICAS = 4


def search_of(
    seed: int,
    own_db: float,
    shift_db: float,
    row_db: float = 0.0,
    replicas: int = REPLICAS,
) -> Search:
    """Return a search where every link has a level of its own, simulated `replicas` times alike.

    Recorded links draw theirs anew, `own_db` wide, and are off by `shift_db` and, from row to row,
    by `row_db`.
    """
    recorded, simulated = (table.frame for table in tables(seed, replicas=replicas))
    rng = np.random.default_rng(seed)
    codes = link_codes(recorded)
    ours, theirs = rng.normal(0, (own_db, 2.0), (codes.max() + 1, 2)).T
    level = -60 - 20 * np.log10(recorded["true_range_m"].to_numpy())
    noise = rng.normal(0, 0.1, (1 + replicas, len(recorded)))
    more = shift_db + rng.normal(0, row_db, len(recorded))
    recorded = recorded.assign(rx_power_dbm=level + ours[codes] + noise[0] + more)
    alike = (level + theirs[codes] + noise[1:]).ravel()
    simulated = simulated.assign(rx_power_dbm=alike)
    rows = view(recorded, codes, np.arange(len(recorded)), Window(), ("rx_power_dbm",), False)
    return Search(TableComparison(simulated, Window()), rows, rows, {}, 0, work=rows)


@pytest.mark.parametrize(
    ("own_db", "shift_db", "row_db", "there"),
    [(2.0, 0, 0, False), (2.0, 1.5, 0, True), (8.0, 0, 0, True), (2.0, 0, 0.5, True)],
)
def test_draws_that_a_table_repeats_are_no_mismatch(
    own_db: float, shift_db: float, row_db: float, there: bool
) -> None:
    search = search_of(3, own_db, shift_db, row_db)
    made = search.comparison.ensemble(search.searched, (), 16)
    swapped = locate(made.first(REPLICAS), search.searched.covariates, 0)
    assert swapped.significant
    assert locate_left(search, (), 0).significant == there


def test_two_simulated_rows_of_a_link_that_share_its_draw_are_no_two_versions():
    """With three and more this was known; with two, scatter is borrowed, and it was not asked."""
    search = search_of(3, 2.0, 0, replicas=2)
    made = search.comparison.ensemble(search.searched, (), 16)
    assert search.comparison.distinct(search.searched) == 2
    assert locate(made.first(2), search.searched.covariates, 0).significant
    assert not locate_left(search, (), 0).significant


def test_what_a_link_has_drawn_of_the_scatter_of_its_rows_is_no_mismatch():
    """A channel that a link keeps decides how its rows scatter, too: on both sides by chance."""
    alarms = 0
    for seed in range(12):
        search = search_of(seed, 2.0, 0, replicas=2)
        frame, comparison = search.searched.frame, search.comparison
        rng = np.random.default_rng(seed)
        wide = np.exp(rng.normal(0, 1.0, (2, frame["link"].nunique())))
        ours = frame["rx_power_dbm"] + wide[0][link_codes(frame)] * rng.normal(size=len(frame))
        more = wide[1][comparison.links] * rng.normal(size=len(comparison.frame))
        theirs = comparison.frame.assign(rx_power_dbm=comparison.frame["rx_power_dbm"] + more)
        rows = view(
            frame.assign(rx_power_dbm=ours), link_codes(frame), np.arange(len(frame)),
            Window(), ("rx_power_dbm",), False,
        )  # fmt: skip
        found = Search(TableComparison(theirs, Window()), rows, rows, {}, 0, work=rows)
        alarms += locate_left(found, (), 0).significant
    assert alarms <= 2  # binomial(12, 0.05): more than 2 has probability 2 %


def test_averaged_levels_make_no_rows_of_rare_levels_scatter_more():
    """Recorded levels scatter more than means of simulated ones: more of them are extreme."""
    alarms = 0
    for seed in range(8):
        search = search_of(seed, 2.0, 0, row_db=0.5)
        frame, made = search.searched.frame, search.comparison.frame
        rng = np.random.default_rng(seed)
        ours = frame.assign(error_m=rng.normal(0, 0.02, len(frame)))
        theirs = made.assign(
            error_m=rng.normal(0, 0.02, len(made)),
            rx_power_dbm=made["rx_power_dbm"] + rng.normal(0, 0.5, len(made)),
        )
        some = ("error_m", "rx_power_dbm")
        rows = view(ours, link_codes(ours), np.arange(len(ours)), Window(), some, False)
        found = Search(TableComparison(theirs, Window()), rows, rows, {}, 0, work=rows)
        alarms += locate_left(found, (), 0).significant
    assert alarms <= 1


def test_the_level_two_versions_have_in_common_tells_nothing_of_how_they_differ():
    """A mean of three simulated rows scatters less within its link than the recorded row does."""
    rng = np.random.default_rng(5)
    links = np.repeat(np.arange(400), 4)
    versions = rng.normal(0, 0.5, (4, len(links)))
    both = np.stack([versions[0], versions[1:].mean(axis=0)]) + rng.normal(0, 6, 400)[links]

    def inside(level: Floats) -> Floats:
        return level - np.bincount(links, level)[links] / 4

    apart, mean, level = inside(both[0] - both[1]), both.mean(axis=0), common(both, links)
    assert np.corrcoef(inside(mean), apart)[0, 1] > 0.3
    assert abs(np.corrcoef(inside(level), apart)[0, 1]) < 1e-6
    assert np.allclose(level - inside(level), mean - inside(mean))


def test_what_goes_with_the_level_of_a_row_is_no_trend_over_it():
    """Two figures of one level, as waveforms have them: either scatters less where it is a mean."""
    alarms = 0
    for seed in range(8):
        search = search_of(seed, 2.0, 0, row_db=0.5, replicas=3)
        rng = np.random.default_rng(100 + seed)
        frame, made = search.searched.frame, search.comparison.frame
        level = made["rx_power_dbm"] + rng.normal(0, 0.5, len(made))
        ours, theirs = (
            one.assign(rx_power_dbm=db, first_path_power_dbm=db - 6 + rng.normal(0, 0.1, len(one)))
            for one, db in ((frame, frame["rx_power_dbm"]), (made, level))
        )
        some = ("first_path_power_dbm", "rx_power_dbm")
        rows = view(ours, link_codes(ours), np.arange(len(ours)), Window(), some)
        found = Search(TableComparison(theirs, Window()), rows, rows, {}, 0, work=rows)
        alarms += locate_left(found, (), 0).significant
    assert alarms <= 1  # binomial(8, 0.05): more than 1 has probability 6 %


@pytest.mark.parametrize(("family_wise", "there"), [(0.025, True), (1e-6, False)])
def test_what_is_asked_beside_another_search_has_its_share_of_the_error(
    family_wise: float, there: bool
) -> None:
    search = search_of(3, 2.0, 1.5)
    made = search.comparison.ensemble(search.searched, (), 16)
    first = locate(made.first(REPLICAS), search.searched.covariates, 0)
    found = beyond_own_draws(first, made, search.comparison, search.searched, 0, None, family_wise)
    assert found.significant == there


@pytest.mark.parametrize("replicas", [1, 2])
def test_levels_that_both_sides_share_make_no_place_of_their_own(replicas: int) -> None:
    """Beside similar links, most recorded levels differ from their own by next to nothing.

    Where they did, recorded rows stood closest, and their scatter was called wider.
    """
    alarms = 0
    for seed in range(6):
        search = search_of(seed, 2.0, 0, replicas=replicas)
        rng = np.random.default_rng(seed)
        frame, made = search.searched.frame, search.comparison.frame
        kept_db, kept_m = rng.normal(0, (2.0, 0.03), (frame["link"].nunique(), 2)).T
        ours, theirs = (
            one.assign(
                rx_power_dbm=-60 + kept_db[code] + rng.normal(0, 0.4, len(one)),
                error_m=kept_m[code] + rng.normal(0, 0.02, len(one)),
            )
            for one, code in ((frame, link_codes(frame)), (made, search.comparison.links))
        )
        some = ("error_m", "rx_power_dbm")
        rows = view(ours, link_codes(ours), np.arange(len(ours)), Window(), some, False)
        found = Search(TableComparison(theirs, Window()), rows, rows, {}, 0, work=rows)
        alarms += locate_left(found, (), 0).significant
    assert alarms <= 1


@pytest.mark.parametrize(("kept_db", "there"), [(0.0, False), (0.5, False), (3.0, True)])
def test_one_simulated_row_of_each_link_does_not_say_what_links_keep(
    kept_db: float, there: bool
) -> None:
    """It stands for all rows of a recorded link, which so seem to have less in common."""
    rng = np.random.default_rng(5)
    levels = np.repeat(rng.normal(0, kept_db, 40), 15) + rng.normal(0, 1.0, 600)
    recorded, simulated = placed(rng, 40, 15, levels), placed(rng, 600, 1, rng.normal(0, 1.0, 600))
    codes = link_codes(recorded)
    rows = view(recorded, codes, np.arange(600), Window(), ("rx_power_dbm",), False)
    comparison = TableComparison(simulated, Window())
    assert copied(comparison, rows)
    search = Search(comparison, rows, rows, {}, 0, work=rows)
    assert locate_left(search, (), 0).significant == there


def placed(rng: np.random.Generator, links: int, rows: int, level_db: Floats) -> pd.DataFrame:
    """Return rows of links between 4 and 9 m with levels [links x rows]."""
    range_m = np.repeat(rng.uniform(4.0, 9.0, links), rows)
    names = [f"{links}-{link}" for link in np.repeat(np.arange(links), rows)]
    known = {"link": names, "true_range_m": range_m, "range_m": range_m, "error_m": 0.0}
    return pd.DataFrame({**known, "rx_power_dbm": level_db - 60})
