"""What two tables both know before a range is measured, as points: near points are alike.

Numbers count in standard deviations of the recorded rows; a category (room, sight, obstacles,
device) that differs counts as so many of them. What is measured takes no part: matched on, it
could not differ any more.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bench.discrepancy.compare.settings import (
    CATEGORY_STD,
    DEVICE_STD,
    FAR_STD,
    LEAST_OVERLAP,
    LEAST_STD,
    LINKS_BEHIND,
    SAME_HEIGHT_M,
    UNSEEN_NAMED,
)
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.settings import MOST_CATEGORIES

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]
DISTANCE = "true_range_m"
DECADES = "decades of true_range_m"
NUMBERS = (
    DISTANCE, "reply_time_s", "temperature_c", "azimuth_deg", "tx_z_m", "rx_z_m",
    "room_x_m", "room_y_m", "room_z_m", "preamble_symbols", "channel", "prf_mhz", "tx_power_dbm",
)  # fmt: skip
CATEGORIES = ("environment", "los", "tx", "rx")
DEVICES = ("tx", "rx")
ROOMS = ("environment",)
HEIGHTS = ("tx_z_m", "rx_z_m")


@dataclass(frozen=True)
class Shared:
    """Points of recorded rows `left` [n, q] and simulated rows `right` [k, q]; `names` of columns.

    `unknown` [n]: recorded rows of a category that no simulated row has.
    """

    left: Floats
    right: Floats
    names: tuple[str, ...]
    unknown: NDArray[np.bool_]


def shared(
    recorded: pd.DataFrame,
    simulated: pd.DataFrame,
    numbers: tuple[str, ...],
    widths: Mapping[str, float] | None = None,
) -> Shared:
    """Return both tables' rows as points in some `numbers` alone, as far as both know them.

    `widths`: the least standard deviation that a number counts in, by its name.
    """
    names = _known_numbers(recorded, simulated, numbers)
    least = np.array([0.0, *((widths or {}).get(name, 0.0) for name in names)])
    left, right = _standardised(recorded, simulated, names, least)
    return Shared(left, right, names, np.zeros(len(recorded), bool))


def in_reach(recorded: pd.DataFrame, simulated: pd.DataFrame) -> Shared:
    """Return both tables' rows as points in all numbers, and in decades of their distance.

    Levels and edges walk over its logarithm: between 1 m and 5 m they change by as much as between
    5 m and 25 m, and what a table without links there would do is not known. Where all devices hang
    about as high, a little higher is no other place (see `SAME_HEIGHT_M`).
    """
    names, widths = (*NUMBERS, DECADES), dict.fromkeys(HEIGHTS, SAME_HEIGHT_M / FAR_STD)
    return shared(_with_decades(recorded), _with_decades(simulated), names, widths)


def _with_decades(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the numbers of a table with the logarithm of its distances, where it has these."""
    known = frame[[name for name in NUMBERS if name in frame]]
    if DISTANCE not in known:
        return known
    far = numeric(known, DISTANCE)
    return known.assign(**{DECADES: np.log10(np.where(far > 0, far, np.nan))})


def shared_with_categories(recorded: pd.DataFrame, simulated: pd.DataFrame) -> Shared:
    """Return both tables' rows as points in every number and category that both know."""
    plain = shared(recorded, simulated, NUMBERS)
    left, right, names = [plain.left], [plain.right], plain.names
    unknown = plain.unknown.copy()
    for name, (ours, theirs) in _categories(recorded, simulated).items():
        values = sorted(set(ours) & set(theirs))
        if not values:  # other rooms, other devices: nothing to match on
            continue
        size = DEVICE_STD if name in DEVICES else CATEGORY_STD
        left.append(_coded(ours, values) * size)
        right.append(_coded(theirs, values) * size)
        names = (*names, name)
        if name not in DEVICES:
            unknown |= ~np.isin(ours, values)
    unknown |= behind_more(recorded, simulated)
    ours, theirs = _more_of_a_kind(recorded, simulated)
    left, right = [*left, ours * CATEGORY_STD], [*right, theirs * CATEGORY_STD]
    return Shared(np.hstack(left), np.hstack(right), names, unknown)


def alike(recorded: pd.DataFrame, simulated: pd.DataFrame) -> list[tuple[Codes, Codes]]:
    """Return codes [n] and [k] of rows: of one sight and obstacles, then those of one room, too.

    As both tables know these; obstacles of one kind are alike where they are as many.
    """
    every = {k: v for k, v in _categories(recorded, simulated).items() if k not in DEVICES}
    more = np.concatenate([*_more_of_a_kind(recorded, simulated)])
    barred = [np.concatenate([*v]) for k, v in every.items() if k not in ROOMS]
    barred += [column.astype(np.str_) for column in more.T]
    rooms = [np.concatenate([*v]) for k, v in every.items() if k in ROOMS]
    start = np.zeros(len(recorded) + len(simulated), np.str_)
    layers = [[start, *barred], [start, *barred, *rooms]]
    return [_codes(words, len(recorded)) for words in layers]


def _codes(words: list[NDArray[Any]], recorded: int) -> tuple[Codes, Codes]:
    """Return a code of every row's words, of the first `recorded` rows and of the others."""
    table = pd.DataFrame(np.stack(words, axis=1))
    codes = np.asarray(table.groupby(list(table.columns)).ngroup(), np.intp)
    return codes[:recorded], codes[recorded:]


def unseen(recorded: pd.DataFrame, simulated: pd.DataFrame) -> str:
    """Return, in words, which categories of recorded rows no simulated row has; "" without any.

    Such rows have no counterpart. Devices and rooms that are all others are no categories.
    """
    words = []
    for name, (ours, theirs) in _categories(recorded, simulated).items():
        lone = sorted(set(ours) - set(theirs))
        if lone and name not in DEVICES and set(ours) & set(theirs):
            rows = int(np.isin(ours, lone).sum())
            what = ", ".join(value or "none" for value in lone[:UNSEEN_NAMED])
            words.append(f"{name} {what}{' ...' if lone[UNSEEN_NAMED:] else ''} ({rows} rows)")
    more = behind_more(recorded, simulated)
    if more.any():
        least = _obstacles(recorded)[more].min()
        words.append(f"{least:.0f} obstacles or more in two links ({more.sum()} rows)")
    return "; ".join(words)


def behind_more(recorded: pd.DataFrame, simulated: pd.DataFrame) -> NDArray[np.bool_]:
    """Return which recorded rows [n] are behind more obstacles than hardly a simulated link is.

    Of one link alone nobody knows how such links scatter, and what a wall does to those behind
    fewer says nothing of a third one behind two.
    """
    if not all("obstacles" in one and "link" in one for one in (recorded, simulated)):
        return np.zeros(len(recorded), np.bool_)
    ours = _obstacles(recorded)
    links = pd.Series(_obstacles(simulated)).groupby(simulated["link"].astype(str).to_numpy()).max()
    as_many = len(links) - np.searchsorted(np.sort(links.to_numpy()), ours)
    return np.asarray((ours > 1) & (as_many < LINKS_BEHIND), np.bool_)


def _obstacles(frame: pd.DataFrame) -> Floats:
    """Return how many obstacles rows [n] list."""
    return np.array([len(_listed(row)) for row in frame["obstacles"]], np.float64)


def kinds(recorded: pd.DataFrame, simulated: pd.DataFrame) -> NDArray[np.intp]:
    """Return the code [k] of simulated rows of one room, sight and obstacles, as both know these.

    Devices vary less than rooms, so that they make no kinds of their own.
    """
    words = {k: v[1] for k, v in _categories(recorded, simulated).items() if k not in DEVICES}
    if not words:
        return np.zeros(len(simulated), np.intp)
    return np.asarray(pd.DataFrame(words).groupby(list(words), sort=True).ngroup(), np.intp)


def _known_numbers(
    recorded: pd.DataFrame, simulated: pd.DataFrame, names: tuple[str, ...]
) -> tuple[str, ...]:
    """Return the numbers known in every row of both tables."""
    both = (recorded, simulated)
    return tuple(n for n in names if all(np.isfinite(numeric(f, n)).all() for f in both))


def _standardised(
    recorded: pd.DataFrame, simulated: pd.DataFrame, names: tuple[str, ...], least: Floats
) -> tuple[Floats, Floats]:
    """Return both tables' numbers in standard deviations of the recorded ones, `least` or more."""
    left, right = (
        np.stack([np.zeros(len(frame)), *(numeric(frame, n) for n in names)], axis=1)
        for frame in (recorded, simulated)
    )
    centre, scale = left.mean(axis=0), np.maximum(left.std(axis=0), LEAST_STD)
    # A number that is constant in the recordings but not in the table must not decide alone.
    scale = np.where(left.std(axis=0) > 0, scale, np.maximum(right.std(axis=0), LEAST_STD))
    scale = np.maximum(scale, least)
    return (left - centre) / scale, (right - centre) / scale


def _categories(
    recorded: pd.DataFrame, simulated: pd.DataFrame
) -> dict[str, tuple[NDArray[Any], NDArray[Any]]]:
    """Return the categories that are known in every row of both tables, as words.

    Rooms, sight, devices, kinds of obstacles.
    """
    out: dict[str, tuple[NDArray[Any], NDArray[Any]]] = {}
    for name in CATEGORIES:
        if (
            _known(recorded, name)
            and _known(simulated, name)
            and recorded[name].nunique() <= MOST_CATEGORIES
        ):
            out[name] = (
                recorded[name].astype(str).to_numpy(),
                simulated[name].astype(str).to_numpy(),
            )
    if "obstacles" in recorded and "obstacles" in simulated:
        out["obstacles"] = _kinds(recorded["obstacles"]), _kinds(simulated["obstacles"])
    return out


def _known(frame: pd.DataFrame, name: str) -> bool:
    """Return whether a table has a category in every row."""
    return name in frame and bool(frame[name].notna().all())


def _more_of_a_kind(recorded: pd.DataFrame, simulated: pd.DataFrame) -> tuple[Floats, Floats]:
    """Return how many obstacles beyond the first rows list of every kind, [n, c] and [k, c].

    Of kinds of which there are several anywhere: three shelves in a row are not one shelf.
    """
    if "obstacles" not in recorded or "obstacles" not in simulated:
        return np.zeros((len(recorded), 0)), np.zeros((len(simulated), 0))
    listed = [Counter(map(str, row)) for row in map(_listed, _both(recorded, simulated))]
    several = sorted({kind for row in listed for kind, many in row.items() if many > 1})
    more = np.array([[max(row[kind] - 1, 0) for kind in several] for row in listed], np.float64)
    more = more.reshape(len(listed), len(several))
    return more[: len(recorded)], more[len(recorded) :]


def _both(recorded: pd.DataFrame, simulated: pd.DataFrame) -> list[Any]:
    return [*recorded["obstacles"], *simulated["obstacles"]]


def _listed(cell: Any) -> Sequence[Any]:
    """Return the obstacles of a row, none where the cell holds no list."""
    return list(cell) if isinstance(cell, list | tuple | np.ndarray) else []


def _kinds(lists: pd.Series) -> NDArray[Any]:
    """Return the kinds of obstacles of every row as one word."""
    made = ["+".join(sorted({str(kind) for kind in _listed(row)})) for row in lists]
    return np.array(made, dtype=np.str_)


def _coded(values: NDArray[Any], known: list[str]) -> Floats:
    """Return 1 for the value of each row, 0 for others, [n, c], over root two: one apart."""
    return np.asarray((values[:, None] == np.array(known)) / np.sqrt(2), np.float64)


def far_apart(names: Sequence[str], ours: Floats, theirs: Floats) -> NDArray[np.bool_]:
    """Return by which covariates [1 + k] recorded links have no counterpart, [1 + k, L].

    `ours` [L, 1 + k] and `theirs` [K, 1 + k] are a constant and the means of covariates `names`.
    """
    # Each number by itself: in many at once every link is far from every other.
    pairs = list(zip(ours.T, theirs.T, strict=True))
    apart = np.stack([cKDTree(b[:, None]).query(a[:, None])[0] for a, b in pairs]) > FAR_STD
    # How far links scatter walks with the distance, too, and cannot be told where few are.
    if DISTANCE in names:
        at = 1 + list(names).index(DISTANCE)
        apart[at] |= _rare(*pairs[at])
    return np.asarray(apart, np.bool_)


def _rare(ours: Floats, theirs: Floats) -> NDArray[np.bool_]:
    """Return which of `ours` [L] are where `theirs` [K] are too rare to stand for them.

    The share of simulated links among those of both tables within FAR_STD, tables counting alike:
    the overlap rule of Crump, Hotz, Imbens and Mitnik (2009).
    """
    dense = [_within(ours, many) / len(many) for many in (ours, theirs)]
    return np.asarray(dense[1] < LEAST_OVERLAP * (dense[0] + dense[1]))


def _within(places: Floats, many: Floats) -> Floats:
    """Return how many of `many` [K] are within FAR_STD of each of `places` [L]."""
    ordered = np.sort(many)
    above = np.searchsorted(ordered, places + FAR_STD, "right")
    return np.asarray(above - np.searchsorted(ordered, places - FAR_STD), np.float64)


def no_overlap(names: Sequence[str], far: NDArray[np.bool_], unknown: NDArray[np.bool_]) -> str:
    """Return in words why most recorded links have no simulated one like them.

    `far` [k, L]: by which covariates `names` [k] links have none near; `unknown` [L]: which are of
    a category that no simulated link has.
    """
    share = {name: float(one.mean()) for name, one in zip(names, far, strict=True)}
    worst = sorted((name for name in share if share[name] > 0), key=lambda name: -share[name])
    parts = [f"{name} ({100 * share[name]:.0f} % of the links)" for name in worst]
    words = "no overlap of covariates: recorded links have no simulated link, or too few, "
    if parts:
        words += f"within {FAR_STD:g} standard deviations of {', '.join(parts)}"
    if unknown.any():
        words += f"{' or ' if parts else ''}of their category ({100 * unknown.mean():.0f} %)"
    return f"{words}; expected such links, or tables without columns that do not matter (--hide)"
