"""Which simulated rows stand for which recorded rows when two tables are compared.

A permutation swaps the recorded version of a link with a simulated one, so no simulated row may
stand for two recorded rows of a link in the same or another version: rows are assigned one to one,
nearest covariates first (Hungarian algorithm), version after version, until they run out.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial import cKDTree

from bench.discrepancy.compare.settings import (
    CHOICES_PER_ROW,
    ROWS_ASSIGNED_AT_ONCE,
    SAME_PLACE_M,
    TIE,
)

Floats = NDArray[np.float64]
Rows = NDArray[np.intp]


def assigned(left: Floats, right: Floats, versions: int) -> list[Rows]:
    """Return for each version the row of `right` [k, q] that stands for each of `left` [n, q].

    At most k // n versions, each row of `right` used once; at least one (with repeats) where
    `right` is shorter than `left`.
    """
    if len(right) < len(left):
        return [np.atleast_1d(cKDTree(right).query(left)[1]).astype(np.intp)]
    free = np.arange(len(right))
    out: list[Rows] = []
    while len(out) < versions and len(free) >= len(left):
        pick = _one_to_one(left, right[free])
        out.append(free[pick])
        free = np.delete(free, pick)
    return out


def _one_to_one(left: Floats, right: Floats) -> Rows:
    """Return for each row of `left` a different row of `right`, near in squared distance."""
    if len(left) <= ROWS_ASSIGNED_AT_ONCE and len(right) <= CHOICES_PER_ROW * ROWS_ASSIGNED_AT_ONCE:
        cost = ((left[:, None, :] - right[None, :, :]) ** 2).sum(axis=2)
        # Of rows that are alike the earlier: a link simulated twice is one draw after the other,
        # and a mixture of two draws would scatter less than either.
        cost = cost + TIE * np.arange(len(right)) / max(len(right), 1)
        return np.asarray(linear_sum_assignment(cost)[1], np.intp)
    stretches = -(-len(left) // ROWS_ASSIGNED_AT_ONCE)
    ours = np.array_split(np.lexsort(left.T), stretches)
    theirs = np.array_split(np.lexsort(right.T), stretches)
    out = np.empty(len(left), np.intp)
    for a, b in zip(ours, theirs, strict=True):
        near = b[: CHOICES_PER_ROW * ROWS_ASSIGNED_AT_ONCE]
        out[a] = near[_one_to_one(left[a], right[near])]
    return out


def by_link(
    left: Floats, right: Floats, links: Rows, pools: Sequence[Rows], versions: int
) -> list[Rows]:
    """Return matched rows per version, each recorded link against its own pool of rows.

    `links` [n] are codes into `pools`. As many versions as the scarcest link has, at most
    `versions`.
    """
    picks: dict[int, list[Rows]] = {}
    for link in np.unique(links):
        pool = pools[link]
        made = assigned(left[links == link], right[pool], versions)
        picks[int(link)] = [pool[one] for one in made]
    count = min(len(made) for made in picks.values())
    return [_spread(links, {k: made[v] for k, made in picks.items()}) for v in range(count)]


def _spread(links: Rows, picks: dict[int, Rows]) -> Rows:
    """Return one row number per recorded row from those of each link."""
    out = np.empty(len(links), np.intp)
    for link, rows in picks.items():
        out[links == link] = rows
    return out


def by_neighbours(
    left: Floats, right: Floats, links: Rows, their_links: Rows, versions: int
) -> list[Rows]:
    """Return matched rows per version, version v from the v-th nearest simulated link.

    Links are near in the means of their covariates. A simulated link may stand for several
    recorded ones, but in different versions of each other.
    """
    count = int(their_links.max()) + 1
    pools = [np.flatnonzero(their_links == link) for link in range(count)]
    centres = np.stack([right[pool].mean(axis=0) for pool in pools])
    tree = cKDTree(centres)
    wanted = min(versions, count)
    out = np.empty((wanted, len(left)), np.intp)
    for link in np.unique(links):
        here = np.flatnonzero(links == link)
        near = np.atleast_1d(tree.query(left[here].mean(axis=0), k=wanted)[1])
        for version in range(wanted):
            pool = _stretch(pools[near[version]], len(here), version)
            out[version, here] = pool[assigned(left[here], right[pool], 1)[0]]
    return list(out)


def _stretch(pool: Rows, size: int, version: int) -> Rows:
    """Return so many rows of a link in a row, others for another version.

    A link that was simulated several times holds several draws of what it has of its own, one
    after the other; rows picked across them would scatter less than any of them.
    """
    stretches = max(len(pool) // max(size, 1), 1)
    start = (version % stretches) * size
    return pool[start : start + size] if len(pool) >= size else pool


def same_links(recorded: pd.DataFrame, simulated: pd.DataFrame) -> bool:
    """Return whether every recorded link is in the simulated table too, in the same place."""
    if "link" not in simulated:
        return False
    named = set(recorded["link"].astype(str)) <= set(simulated["link"].astype(str))
    return named and same_places(recorded, simulated)


def same_places(recorded: pd.DataFrame, simulated: pd.DataFrame) -> bool:
    """Return whether links of one name have one true range in both tables, as far as is known."""
    if "true_range_m" not in recorded or "true_range_m" not in simulated:
        return True
    ours, theirs = (
        frame["true_range_m"].groupby(frame["link"].astype(str)).median()
        for frame in (recorded, simulated)
    )
    apart = float((ours - theirs.reindex(ours.index)).abs().median())
    return not apart > SAME_PLACE_M


def link_means(values: Floats, links: NDArray[np.intp]) -> Floats:
    """Return the means of values [n] or [n, q] over the rows of each link, [L] or [L, q]."""
    code = np.unique(links, return_inverse=True)[1]
    if values.ndim == 1:
        return np.asarray(np.bincount(code, values) / np.bincount(code), np.float64)
    return np.stack([link_means(column, links) for column in values.T], axis=1)
