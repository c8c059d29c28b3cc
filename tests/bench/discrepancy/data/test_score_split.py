"""Proper scores, intervals over links, and the seal on the confirm links."""

from __future__ import annotations

from itertools import product

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import cluster_bootstrap, crps, energy_score
from bench.discrepancy.data.split import Sealed, check_rows, split_links
from bench.errors import BenchError


def test_crps_of_a_normal_matches_the_closed_form():
    rng = np.random.default_rng(0)
    y = np.array([0.0, 0.7, -2.0])
    score = crps(rng.normal(size=(40000, 3)), y)
    phi = np.exp(-(y**2) / 2) / np.sqrt(2 * np.pi)
    cdf = np.array([0.5, 0.758036, 0.0227501])
    assert score == pytest.approx(y * (2 * cdf - 1) + 2 * phi - 1 / np.sqrt(np.pi), abs=0.02)


def test_scores_are_proper_the_truth_wins_even_with_few_members():
    rng = np.random.default_rng(1)
    y = rng.normal(size=4000)
    right = crps(rng.normal(size=(4, 4000)), y).mean()
    wrong = [(0.3, 1.0), (0.0, 0.6), (0.0, 1.5)]
    for shift, scale in wrong:
        assert right < crps(shift + scale * rng.normal(size=(4, 4000)), y).mean()
    both = rng.normal(size=(4000, 2))
    right = energy_score(rng.normal(size=(4, 4000, 2)), both).mean()
    assert right < energy_score(0.4 + rng.normal(size=(4, 4000, 2)), both).mean()


def test_interval_over_links_covers_and_is_wider_than_over_rows():
    covered = 0
    for seed in range(60):
        rng = np.random.default_rng(seed)
        links = np.repeat(np.arange(15), 20)
        values = 1.0 + rng.normal(size=15)[links] + 0.1 * rng.normal(size=300)
        found = cluster_bootstrap(values, links, seed)
        covered += found.low < 1.0 < found.high
    assert 50 <= covered <= 60


def test_seal_opens_once_and_shows_nothing_before():
    sealed = Sealed(np.arange(3))
    assert "0" not in repr(sealed)
    assert sealed.open().tolist() == [0, 1, 2]
    with pytest.raises(RuntimeError, match="once"):
        sealed.open()


def test_links_never_fall_on_both_sides_and_same_seed_same_split():
    frame = pd.DataFrame({"link": np.repeat([f"l{i}" for i in range(20)], 5)})
    first, second = split_links(frame, 1), split_links(frame, 1)
    confirm = first.confirm.open()
    parts = [set(frame["link"].iloc[rows]) for rows in (first.discover, first.fit, confirm)]
    assert not parts[0] & parts[1]
    assert not (parts[0] | parts[1]) & parts[2]
    assert sum(map(len, parts)) == 20
    assert second.confirm.open().tolist() == confirm.tolist()
    assert len(first.work) == len(first.discover) + len(first.fit)


def test_confirm_prefers_links_whose_devices_stay_known():
    pairs = [("1", "3"), ("1", "4"), ("2", "3"), ("2", "4"), ("3", "1"), ("3", "2"), ("9", "3")]
    frame = pd.DataFrame(pairs, columns=["tx", "rx"]).assign(link=[str(i) for i in range(7)])
    for seed in range(12):
        confirm = split_links(frame, seed).confirm.open()
        assert 6 not in confirm  # device 9 is in no other link


def test_too_few_links_is_one_line():
    with pytest.raises(BenchError, match="at least 4"):
        split_links(pd.DataFrame({"link": ["a", "a", "b"]}), 0)


def test_a_device_of_few_links_is_in_both_working_parts():
    for seed in range(8):
        tx = np.where(np.arange(40) % 8 == 0, "rare", "a")
        frame = pd.DataFrame({"link": [f"l{i}" for i in range(40)], "tx": tx, "rx": "b"})
        split = split_links(frame, seed)
        seen = [set(frame["tx"].iloc[rows]) for rows in (split.discover, split.fit)]
        assert seen == [{"rare", "a"}, {"rare", "a"}]
        assert 14 <= len(split.discover) <= 18  # 40 % of the links


def test_few_links_of_few_rows_are_one_line():
    few = pd.DataFrame({"link": np.repeat(list("abcde"), 6)})
    with pytest.raises(BenchError, match="5 links of at most 20 rows"):
        check_rows(split_links(few, 0))
    check_rows(split_links(pd.DataFrame({"link": np.repeat(list("abcde"), 30)}), 0))


def test_every_part_has_its_share_of_every_device_place_and_obstacle():
    rng, links = np.random.default_rng(3), 96
    frame = pd.DataFrame(
        {
            "link": [f"l{i}" for i in range(links)],
            "tx": rng.choice(["t1", "t2", "t3"], links),
            "rx": rng.choice([f"a{i}" for i in range(6)], links),
            "environment": rng.choice(["hall", "office"], links),
            "obstacles": [["wall"] if one else [] for one in rng.random(links) < 0.2],
        }
    )
    keys = {name: frame[name].astype(str) for name in frame if name != "link"}
    off = []
    for seed in range(8):
        split = split_links(frame, seed)
        parts = [(split.discover, 0.4), (split.fit, 0.35), (split.confirm.open(), 0.25)]
        for (rows, share), column in product(parts, keys.values()):
            there, every = column.iloc[rows].value_counts(), column.value_counts()
            off += (there.reindex(every.index, fill_value=0) - share * every).tolist()
    assert np.mean(np.square(off)) < 1.5  # links, squared; parts drawn by chance are off by 4.8
