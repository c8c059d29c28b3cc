"""Splits across data sets: train on some, test on another, and on few links of that one.

In the table of `bench.recordings.combine` every row has its `data_set`. With a number of links, a
draw deals the links of the tested data set: a share of 0.3 (at least one) is tested on, and the
first so many of the others are trained on. Draws come from their number alone, so every model,
every number of links and every pretraining sees the same links tested, and more links hold those
of fewer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.recordings.combine import DATA_SET
from bench.recordings.splits import Fold, Split, labelled_los
from bench.recordings.table import Recordings

TESTED_SHARE = 0.3
Rows = NDArray[np.intp]


@dataclass(frozen=True)
class Roles:
    """What each data set is for: trained on, pretrained on, tested on.

    `links` of the tested one are trained on too, in each of `draws` draws; None: none are, and
    all of it is tested.
    """

    test: str
    train: tuple[str, ...] = ()
    pretrain: tuple[str, ...] = ()
    links: int | None = None
    draws: int = 1

    def split(self, recordings: Recordings) -> Split:
        """Return the split of a combined table.

        Raises BenchError for more links than there are beside the tested ones, and where nothing
        is left to train on.
        """
        folds = tuple(self._fold(recordings, draw) for draw in range(self.draws))
        return Split(self.name, folds)

    @property
    def name(self) -> str:
        """What it is called: `trained-on:apartment + 4 links of miluv, 5 draws`."""
        trained = list(self.train)
        if self.links:
            trained.append(f"{self.links} link{'s' if self.links > 1 else ''} of {self.test}")
        before = f" after {', '.join(self.pretrain)}" if self.pretrain else ""
        drawn = "" if self.links is None else f", {self.draws} draw{'s' * (self.draws > 1)}"
        return f"trained-on:{' + '.join(trained) or 'nothing'}{before}{drawn}"

    def _fold(self, recordings: Recordings, draw: int) -> Fold:
        """Return one draw."""
        tested, added = self._dealt(recordings, draw)
        train = np.sort(np.concatenate([_rows(recordings, self.train), added]))
        pretrain = _rows(recordings, self.pretrain)
        if not len(train) + len(pretrain):
            raise BenchError(f"{self.test}: nothing to train on; expected data sets or links of it")
        los = labelled_los(recordings)
        return Fold(f"draw {draw}", train, tested[~los[tested]], tested[los[tested]], pretrain)

    def _dealt(self, recordings: Recordings, draw: int) -> tuple[Rows, Rows]:
        """Return the rows of the tested data set that are tested, and those trained on."""
        own = _rows(recordings, (self.test,))
        if self.links is None:
            return own, own[:0]
        links = recordings.frame["link"].to_numpy(object)[own]
        order = np.random.default_rng([draw, 17]).permutation(np.unique(links.astype(str)))
        tested, pool = _cut(order)
        if self.links > len(pool):
            raise BenchError(
                f"{self.test}: {self.links} links to train on, but it has {len(order)}, of which "
                f"{len(tested)} are tested; expected at most {len(pool)}"
            )
        return own[np.isin(links, tested)], own[np.isin(links, pool[: self.links])]


def _cut(order: NDArray[np.str_]) -> tuple[NDArray[np.str_], NDArray[np.str_]]:
    """Return the links tested and the others, of a dealt order."""
    count = max(1, round(TESTED_SHARE * len(order)))
    return order[:count], order[count:]


def _rows(recordings: Recordings, names: Sequence[str]) -> Rows:
    """Return the positions of the rows of some data sets."""
    return np.flatnonzero(recordings.frame[DATA_SET].isin(list(names)).to_numpy(np.bool_))
