"""Ranking: the family holds, ranks cover, ties are ties; by hand and by simulation."""

from __future__ import annotations

import numpy as np
import pytest

from reports.ranking import Paired, rank, separate
from reports.ranking.across import across
from reports.ranking.paired import by_link, difference_m
from reports.ranking.ranks import Ranked


def board(rng, models, links, gaps_m=0.0, spread_m=0.02):
    """Links of unequal size, errors that models share, and differences between them."""
    rows = rng.integers(5, 60, links).astype(float)
    shared = rng.gamma(2.0, 0.05, links)
    own = rng.normal(0, spread_m, (models, links)) * rng.gamma(2.0, 0.5, links)
    mean = 1 + shared + own + np.asarray(gaps_m)  # far from zero: sums of magnitudes
    return Paired(tuple(f"m{i}" for i in range(models)), mean * rows, rows)


def test_sums_by_link_are_those_of_a_plain_loop() -> None:
    links = np.array(["b", "a", "b", "a", "c"])
    residuals = [np.array([1.0, -2.0, 3.0, 4.0, -5.0]), np.zeros(5)]
    paired = by_link(["x", "y"], residuals, links)
    assert paired.sums_m.tolist() == [[6.0, 4.0, 5.0], [0.0, 0.0, 0.0]]
    assert paired.rows.tolist() == [2, 2, 1]
    assert paired.mae_m.tolist() == [3.0, 0.0]
    with pytest.raises(ValueError, match="one residual per row"):
        by_link(["x"], [np.zeros(4)], links)


def test_two_models_on_six_links_have_the_p_of_all_sign_patterns() -> None:
    gaps = np.array([0.3, 0.2, 0.25, 0.1, 0.4, 0.35])
    paired = Paired(("bad", "good"), np.array([gaps + 1, np.ones(6)]), np.ones(6))
    found = separate(paired)
    assert found.p.tolist() == [2 / 64]  # only all plus and all minus are as extreme
    assert found.apart.all()
    assert found.difference_m[0] == pytest.approx(gaps.mean())


def test_five_links_cannot_tell_anything_apart() -> None:
    paired = Paired(("bad", "good"), np.array([np.full(5, 9.0), np.ones(5)]), np.ones(5))
    assert not separate(paired).apart.any()
    assert rank(paired).find("good").ranks == "1-2"


def test_less_than_a_tenth_of_a_millimetre_is_never_a_difference() -> None:
    sums = np.array([np.ones(30), np.ones(30) + 9e-5])
    found = separate(Paired(("a", "b"), sums, np.ones(30)))
    assert found.p[0] < 0.05
    assert not found.apart.any()


def test_letters_are_shared_exactly_where_models_are_not_apart() -> None:
    rng = np.random.default_rng(3)
    paired = board(rng, 6, 60, np.linspace(0, 0.04, 6)[:, None])
    ranking = rank(paired)
    first, second = paired.pairs
    for i, j, apart in zip(first, second, ranking.family.apart, strict=True):
        shared = set(ranking.find(f"m{i}").letters) & set(ranking.find(f"m{j}").letters)
        assert bool(shared) != apart
    assert ranking.family.apart.any()
    assert not ranking.family.apart.all()


@pytest.mark.parametrize("links", [9, 40])
def test_with_no_true_difference_a_table_shows_one_in_at_most_five_per_cent(links: int) -> None:
    rng = np.random.default_rng(links)
    false = 0
    for _ in range(300):
        paired = board(rng, 5, links)
        false += separate(paired, seed=1).apart.any()
    assert false / 300 <= 0.05 + 1.645 * (0.05 * 0.95 / 300) ** 0.5


def test_ranks_cover_the_true_order_and_large_differences_are_seen() -> None:
    rng = np.random.default_rng(7)
    true = np.array([0.0, 0.0, 0.03, 0.06])
    held = seen = 0
    for _ in range(200):
        ranking = rank(board(rng, 4, 40, true[:, None], spread_m=0.015), seed=1)
        found = [ranking.find(f"m{i}") for i in range(4)]
        held += all(
            one.best_rank <= 1 + sum(true < value) and one.worst_rank >= 4 - sum(true > value)
            for one, value in zip(found, true, strict=True)
        )
        seen += found[3].best_rank == 4
    assert held / 200 >= 0.92
    assert seen / 200 >= 0.9


def test_the_detectable_difference_is_seen_in_about_four_fifths() -> None:
    rng = np.random.default_rng(11)
    asked = np.median([separate(board(rng, 3, 40), seed=1).detectable_m for _ in range(30)])
    gaps = np.array([0.0, 0.0, asked])[:, None]
    seen = [separate(board(rng, 3, 40, gaps), seed=1).apart[[1, 2]].mean() for _ in range(200)]
    assert 0.65 <= np.mean(seen) <= 0.95


def test_the_interval_of_a_difference_holds_its_truth_about_as_often_as_it_says() -> None:
    rng = np.random.default_rng(5)
    held = 0
    for number in range(120):
        paired = board(rng, 2, 60, np.array([[0.01], [0.0]]))
        found = difference_m(paired, "m0", "m1", seed=number)
        held += found.low <= 0.01 <= found.high
    assert held / 120 >= 0.88


def test_equal_models_have_no_interval() -> None:
    paired = Paired(("a", "b"), np.ones((2, 9)), np.ones(9))
    assert difference_m(paired, "a", "b").low is None
    assert separate(paired).p.tolist() == [1.0]


def test_one_model_is_no_comparison() -> None:
    with pytest.raises(ValueError, match="at least two"):
        separate(Paired(("a",), np.ones((1, 3)), np.ones(3)))


def test_over_data_sets_a_model_that_is_best_everywhere_is_best_and_one_set_says_nothing() -> None:
    rng = np.random.default_rng(2)
    gaps = np.array([0.0, 0.3, 0.6])[:, None]
    sets = {name: board(rng, 3, 40, gaps) for name in ("a", "b", "c")}
    found = across(sets)
    assert [one.name for one in found] == ["m0", "m1", "m2"]
    assert found[0].best > 0.99
    assert found[0].high < found[1].low
    assert found[2].ranks == (3, 3)
    assert across({"a": sets["a"]}) == ()


def test_over_data_sets_that_contradict_each_other_nothing_is_sure() -> None:
    rng = np.random.default_rng(4)
    up, down = np.array([[0.0], [0.5]]), np.array([[0.5], [0.0]])
    found = across({"a": board(rng, 2, 40, up), "b": board(rng, 2, 40, down)})
    assert all(0.2 < one.best < 0.8 for one in found)
    assert all(one.ranks == (1, 2) for one in found)


def test_groups_beyond_the_alphabet_are_told_from_each_other() -> None:
    assert Ranked("gp", 0.1, 1, 2, "ab1c").groups == ("a", "b1", "c")
    first, other = Ranked("gp", 0.1, 1, 2, "a1"), Ranked("q", 0.2, 3, 4, "l1")
    assert not set(first.groups) & set(other.groups)
