"""Splitting recordings into training and test rows: by environment or by link, never by row.

- `leave-environment-out[:ENV]` is the protocol of Angarano et al. (2021): test on the room ENV,
  train on the NLoS rows of the other indoor rooms. Outdoor and through-the-wall rows are kept
  aside unless named. Rows labelled LoS are never trained on: those of every indoor room are scored
  separately, so each room is given the same LoS rows, as in the paper. (Where no indoor row is
  labelled LoS, those labelled elsewhere are scored: the paper's 4691 LoS rows are all there are in
  the published table, and which rooms they carry is not said.)
- `link-kfold[:K]` deals the links into K (5) folds and tests each once; training takes all other
  rows, LoS included.

A link - one pair of antenna positions - never has rows on both sides of a fold; that is checked.
Rows without a LoS label count as NLoS.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError, unknown_name
from bench.recordings.sources.base import Source
from bench.recordings.table import Recordings

KEPT_ASIDE = ("outdoor", "through-the-wall")
DEFAULT_FOLDS = 5
KINDS = ("leave-environment-out", "link-kfold")
Rows = NDArray[np.intp]


@dataclass(frozen=True)
class Fold:
    """Row positions, ascending: to train on, and to test on without and with line of sight.

    Where there are rows to `pretrain` on, a model is fitted on these and trained further on
    `train`.
    """

    name: str
    train: Rows
    test_nlos: Rows
    test_los: Rows
    pretrain: Rows = field(default_factory=lambda: np.empty(0, np.intp))


@dataclass(frozen=True)
class Split:
    """A way to split, with its full name (`link-kfold:5`) and its folds."""

    name: str
    folds: tuple[Fold, ...]


def default_split(recordings: Recordings, source: Source | None = None) -> str:
    """Return the split a data set is used with unless told otherwise.

    The paper's, where the source names a test environment that the table has; else `link-kfold`,
    with as many folds as there are links where these are fewer than five.
    """
    named = source.test_environment if source else None
    if named and named in environments(recordings):
        return f"leave-environment-out:{named}"
    recordings.require("link")
    return f"link-kfold:{min(DEFAULT_FOLDS, max(2, recordings.frame['link'].nunique()))}"


def make_split(
    recordings: Recordings, spec: str, seed: int = 0, source: Source | None = None
) -> Split:
    """Return the split that `spec` names; `seed` deals the links of `link-kfold` into folds.

    `leave-environment-out` without ENV takes the source's test environment, or without one every
    indoor environment in turn. Raises BenchError for an unknown split or environment, no link
    column, fewer links than folds, a link on both sides, and an empty training or test set.
    """
    kind, _, argument = spec.partition(":")
    if kind not in KINDS:
        raise unknown_name("split", kind, KINDS)
    recordings.require("link")
    if kind == "link-kfold":
        split = _link_kfold(recordings, argument, seed)
    else:
        split = _leave_environment_out(recordings, argument, source)
    for fold in split.folds:
        _check(recordings, fold)
    return split


def environments(recordings: Recordings) -> list[str]:
    """Return the names of the environments, sorted; none where the column is absent."""
    if "environment" not in recordings.frame:
        return []
    return sorted(map(str, recordings.frame["environment"].dropna().unique()))


def labelled_los(recordings: Recordings) -> NDArray[np.bool_]:
    """Return where a row is labelled LoS [n]; rows without a label are False."""
    if "los" not in recordings.frame:
        return np.zeros(len(recordings), np.bool_)
    labels = recordings.frame["los"].astype("boolean").fillna(False)
    return labels.to_numpy(np.bool_)


def _leave_environment_out(recordings: Recordings, named: str, source: Source | None) -> Split:
    """Return one fold per environment tested."""
    recordings.require("environment")
    known = environments(recordings)
    if named and named not in known:
        raise unknown_name(f"environment of {recordings.source}", named, known)
    indoor = [name for name in known if name not in KEPT_ASIDE]
    default = source.test_environment if source else None
    tested = [named] if named else [default] if default in known else indoor
    folds = tuple(_without(recordings, str(test), indoor) for test in tested)
    suffix = f":{tested[0]}" if len(tested) == 1 else ""
    return Split(f"leave-environment-out{suffix}", folds)


def _without(recordings: Recordings, test: str, indoor: list[str]) -> Fold:
    """Return the fold that tests on one environment and trains on the other indoor ones."""
    where = recordings.frame["environment"].astype("str").to_numpy()
    los = labelled_los(recordings)
    others = np.isin(where, [name for name in indoor if name != test])
    train = np.flatnonzero(others & ~los)
    indoor_los = los & np.isin(where, [*indoor, test])
    test_los = np.flatnonzero(indoor_los if indoor_los.any() else los)
    # A LoS row whose link was trained on (with an obstacle put in between) is not scored.
    test_los = test_los[~_shares_link(recordings, test_los, train)]
    return Fold(test, train, np.flatnonzero((where == test) & ~los), test_los)


def _link_kfold(recordings: Recordings, argument: str, seed: int) -> Split:
    """Return K folds of links, with the share of LoS rows kept alike where it is known."""
    count = _fold_count(argument)
    links = pd.factorize(recordings.frame["link"])[0]
    if links.max() + 1 < count:
        raise BenchError(
            f"{recordings.source}: {links.max() + 1} link(s) cannot be dealt into {count} folds; "
            f"expected at least {count} different values in column 'link'"
        )
    los = labelled_los(recordings)
    folds = tuple(
        Fold(str(number), train, test[~los[test]], test[los[test]])
        for number, (train, test) in enumerate(_deal(links, los, count, seed))
    )
    return Split(f"link-kfold:{count}", folds)


def _fold_count(argument: str) -> int:
    """Return K. Raises BenchError where it is no whole number of at least two."""
    if not argument:
        return DEFAULT_FOLDS
    if not argument.isdecimal() or int(argument) < 2:
        raise BenchError(f"split link-kfold:{argument}: expected a number of folds of at least 2")
    return int(argument)


def _deal(
    links: NDArray[np.intp], los: NDArray[np.bool_], count: int, seed: int
) -> Iterator[tuple[Rows, Rows]]:
    """Return (train, test) rows per fold, stratified by LoS where both kinds have enough rows."""
    from sklearn.model_selection import GroupKFold, StratifiedGroupKFold

    blank = np.zeros(len(links))
    if min(los.sum(), (~los).sum()) >= count:
        stratified = StratifiedGroupKFold(count, shuffle=True, random_state=seed)
        folds = list(stratified.split(blank, los, links))
        if all(len(test) for _, test in folds):
            return iter(folds)
    grouped = GroupKFold(count, shuffle=True, random_state=seed)
    return iter(grouped.split(blank, groups=links))


def _shares_link(recordings: Recordings, rows: Rows, others: Rows) -> NDArray[np.bool_]:
    """Return which of `rows` have a link that some of `others` have too."""
    links = recordings.frame["link"]
    return links.iloc[rows].isin(links.iloc[others].unique()).to_numpy(np.bool_)


def _check(recordings: Recordings, fold: Fold) -> None:
    """Raise BenchError where a fold is empty or a link stands on both sides of it."""
    if not len(fold.train):
        raise BenchError(f"{recordings.source}: fold {fold.name!r} leaves no rows to train on")
    if not len(fold.test_nlos) + len(fold.test_los):
        raise BenchError(f"{recordings.source}: fold {fold.name!r} has no rows to test on")
    test = np.concatenate([fold.test_nlos, fold.test_los])
    shared = _shares_link(recordings, test, fold.train)
    if shared.any():
        link = recordings.frame["link"].iloc[test[shared][0]]
        raise BenchError(
            f"{recordings.source}: link {link!r} has rows both in {fold.name!r} and outside it; "
            "expected one name per pair of antenna positions"
        )
