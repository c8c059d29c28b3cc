from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest
from recordings_factory import make_recordings

from bench.errors import BenchError
from bench.recordings.sources.base import Source
from bench.recordings.splits import default_split, labelled_los, make_split
from bench.recordings.table import Recordings

ROOMS = ("big", "medium", "small", "outdoor", "through-the-wall")


class _Source(Source):
    name = "noise"
    title = "noise"
    licence = "CC0-1.0"
    test_environment: ClassVar[str | None] = "medium"

    def available(self) -> str | None:
        return None

    def load(self) -> Recordings:
        return make_recordings()


def _rooms() -> Recordings:
    return make_recordings(rows=200, links=20, environments=ROOMS)


def _links(recordings: Recordings, rows) -> set[str]:
    return set(recordings.frame["link"].iloc[rows])


def test_leaving_an_environment_out_is_the_papers_protocol() -> None:
    recordings = _rooms()
    where, los = recordings.frame["environment"].to_numpy(), labelled_los(recordings)
    (fold,) = make_split(recordings, "leave-environment-out:medium").folds
    assert set(where[fold.train]) == {"big", "small"}
    assert not los[fold.train].any()
    assert set(where[fold.test_nlos]) == {"medium"}
    assert not los[fold.test_nlos].any()
    indoor = np.isin(where, ["big", "medium", "small"])
    np.testing.assert_array_equal(fold.test_los, np.flatnonzero(los & indoor))


def test_los_rows_labelled_only_outdoors_are_scored_all_the_same() -> None:
    recordings = _rooms()
    where = recordings.frame["environment"].to_numpy()
    recordings.frame["los"] &= where == "outdoor"
    (fold,) = make_split(recordings, "leave-environment-out:medium").folds
    assert set(where[fold.test_los]) == {"outdoor"}


def test_every_room_is_scored_on_the_same_los_rows() -> None:
    split = make_split(_rooms(), "leave-environment-out")
    assert [fold.name for fold in split.folds] == ["big", "medium", "small"]
    assert split.name == "leave-environment-out"
    for fold in split.folds[1:]:
        np.testing.assert_array_equal(fold.test_los, split.folds[0].test_los)


def test_the_source_names_the_environment_to_leave_out() -> None:
    split = make_split(_rooms(), "leave-environment-out", source=_Source())
    assert (split.name, len(split.folds)) == ("leave-environment-out:medium", 1)


def test_an_environment_kept_aside_can_be_tested_by_name() -> None:
    recordings = _rooms()
    (fold,) = make_split(recordings, "leave-environment-out:outdoor").folds
    where = recordings.frame["environment"].to_numpy()
    assert set(where[fold.train]) == {"big", "medium", "small"}
    assert set(where[fold.test_nlos]) == {"outdoor"}


def test_los_rows_of_a_link_that_was_trained_on_are_not_scored() -> None:
    recordings = make_recordings(rows=60, links=6)
    recordings.frame["los"] = np.arange(60) < 30  # every link has rows of both kinds
    (fold,) = make_split(recordings, "leave-environment-out:medium").folds
    assert set(recordings.frame["environment"].iloc[fold.test_los]) == {"medium"}
    assert not _links(recordings, fold.train) & _links(recordings, fold.test_los)


@pytest.mark.parametrize("labels", ["all", "none", "some"])
def test_link_kfold_tests_every_row_once_and_no_link_twice(labels: str) -> None:
    recordings = make_recordings(rows=203, links=23)
    if labels == "none":
        del recordings.frame["los"]
    if labels == "some":
        recordings.frame["los"] = (
            recordings.frame["los"].astype("boolean").mask(np.arange(203) < 50)
        )
    split = make_split(recordings, "link-kfold:4", seed=3)
    tested = np.concatenate([np.r_[fold.test_nlos, fold.test_los] for fold in split.folds])
    assert sorted(tested) == list(range(203))
    for fold in split.folds:
        test = np.r_[fold.test_nlos, fold.test_los]
        assert not _links(recordings, fold.train) & _links(recordings, test)
        assert len(fold.train) + len(test) == 203
        if labels == "none":
            assert len(fold.test_los) == 0


def test_the_seed_deals_the_links() -> None:
    recordings = make_recordings(rows=200, links=40)
    one, same, other = (make_split(recordings, "link-kfold", seed) for seed in (1, 1, 2))
    assert one.name == "link-kfold:5"
    np.testing.assert_array_equal(one.folds[0].train, same.folds[0].train)
    assert one.folds[0].train.tolist() != other.folds[0].train.tolist()


def test_both_kinds_of_rows_reach_every_fold() -> None:
    split = make_split(make_recordings(rows=400, links=40), "link-kfold")
    assert all(len(fold.test_los) and len(fold.test_nlos) for fold in split.folds)


def test_the_default_is_the_papers_where_the_source_names_a_room() -> None:
    assert default_split(_rooms(), _Source()) == "leave-environment-out:medium"
    assert default_split(_rooms()) == "link-kfold:5"
    assert default_split(make_recordings(environments=["flat"]), _Source()) == "link-kfold:5"
    assert default_split(make_recordings(links=3)) == "link-kfold:3"


@pytest.mark.parametrize(
    ("options", "spec", "expected"),
    [
        ({}, "leave-enviroment-out", "did you mean 'leave-environment-out'"),
        ({}, "leave-environment-out:medum", "did you mean 'medium'"),
        ({"environments": ["flat"]}, "leave-environment-out:flat", "no rows to train on"),
        ({"environments": ["flat"]}, "leave-environment-out", "no rows to train on"),
        ({"links": 4}, "link-kfold", "4 link(s) cannot be dealt into 5 folds"),
        ({}, "link-kfold:1", "expected a number of folds of at least 2"),
        ({}, "link-kfold:x", "expected a number of folds of at least 2"),
    ],
)
def test_a_split_that_cannot_be_made_gives_one_clear_line(options, spec, expected) -> None:
    with pytest.raises(BenchError) as caught:
        make_split(make_recordings(**options), spec)
    assert expected in str(caught.value)


@pytest.mark.parametrize("column", ["link", "environment"])
def test_a_missing_column_is_named(column: str) -> None:
    recordings = make_recordings()
    del recordings.frame[column]
    with pytest.raises(BenchError, match=f"no column '{column}'"):
        make_split(recordings, "leave-environment-out:medium")


def test_one_link_name_in_two_rooms_is_refused() -> None:
    recordings = make_recordings(rows=60, links=12)
    recordings.frame["link"] = np.where(recordings.frame["los"], "a", "b")
    with pytest.raises(BenchError, match=r"link 'b' has rows both in 'medium' and outside it"):
        make_split(recordings, "leave-environment-out:medium")


def test_as_many_folds_as_links_and_two_folds_are_allowed() -> None:
    recordings = make_recordings(rows=30, links=3)
    assert len(make_split(recordings, "link-kfold:3").folds) == 3
    assert len(make_split(recordings, "link-kfold:2").folds) == 2
    with pytest.raises(BenchError, match="3 link\\(s\\) cannot be dealt into 4 folds"):
        make_split(recordings, "link-kfold:4")


@pytest.mark.parametrize("los", [True, False])
def test_links_of_one_kind_are_dealt_without_regard_to_kind(los: bool) -> None:
    from sklearn.model_selection import GroupKFold

    recordings = make_recordings(rows=60, links=12)
    recordings.frame["los"] = los
    codes = np.unique(recordings.frame["link"], return_inverse=True)[1]
    codes = np.array([list(dict.fromkeys(codes)).index(code) for code in codes])
    plain = GroupKFold(3, shuffle=True, random_state=4).split(codes, groups=codes)
    for fold, (train, _) in zip(
        make_split(recordings, "link-kfold:3", 4).folds, plain, strict=True
    ):
        np.testing.assert_array_equal(fold.train, train)
