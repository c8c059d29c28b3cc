"""Links are split once: discover, fit, confirm. Confirm is sealed and opened once, at the end."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.settings import (
    DISCOVER_SHARE,
    FEWEST_LINKS,
    FIT_SHARE,
    RARE_DEVICE,
    SHARED_BELOW,
    STRETCH_ROWS,
)
from bench.errors import BenchError

T = TypeVar("T")
Rows = NDArray[np.intp]
Marks = frozenset[tuple[str, str]]


class Sealed(Generic[T]):
    """Holds something that may be looked at once.

    Nothing before `open()` can see the content (it is in neither repr nor equality); a second
    `open()` raises RuntimeError, so a search cannot be tuned on what confirms it.
    """

    def __init__(self, content: T) -> None:
        self.__content: T | None = content

    @property
    def opened(self) -> bool:
        """True once it has been opened."""
        return self.__content is None

    def open(self) -> T:
        """Return the content, once. Raises RuntimeError the second time."""
        if self.__content is None:
            raise RuntimeError("already opened: the confirm links are looked at once")
        content, self.__content = self.__content, None
        return content

    def __repr__(self) -> str:
        return f"Sealed({'opened' if self.opened else 'closed'})"


@dataclass(frozen=True)
class LinkSplit:
    """Row positions of the discover and fit links; those of the confirm links are sealed.

    `shared` is True where links are so few that discover and fit are alternate stretches of rows
    of the same links; confirm links are always apart.
    """

    discover: Rows
    fit: Rows
    confirm: Sealed[Rows]
    links: int
    shared: bool = False

    @property
    def work(self) -> Rows:
        """Discover and fit rows together, in table order."""
        return np.sort(np.concatenate([self.discover, self.fit]))


def link_codes(frame: pd.DataFrame) -> NDArray[np.intp]:
    """Return link numbers 0..L-1 per row [n]; rows whose link is null are one link each."""
    if "link" not in frame:
        raise BenchError("no column 'link': the unit of splitting is expected in every table")
    names = frame["link"].astype(object)
    alone = names.isna().to_numpy()
    labels = np.where(alone, [f"\0row{i}" for i in range(len(frame))], names.astype(str))
    return np.unique(labels, return_inverse=True)[1]


def split_links(
    frame: pd.DataFrame, seed: int, shares: tuple[float, float] = (DISCOVER_SHARE, FIT_SHARE)
) -> LinkSplit:
    """Split the links once into discover / fit / confirm, by seed.

    `shares` are those of discover and fit; confirm is the rest. Confirm takes only links whose
    devices stay known from other links while that is possible, because a device never seen has
    no parameters. Raises BenchError where there are fewer than four links.
    """
    codes = link_codes(frame)
    count = int(codes.max()) + 1 if len(codes) else 0
    if count < FEWEST_LINKS:
        raise BenchError(
            f"{count} link(s): a diagnosis holds links out, so at least {FEWEST_LINKS} are expected"
        )
    order = np.random.default_rng(seed).permutation(count)
    wanted = max(1, round(count * (1 - sum(shares))))
    devices = _devices(frame, codes, count)
    marks = _marks(frame, codes, devices)
    held = _held_out(order, wanted, devices, marks)
    if count < SHARED_BELOW:
        return _shared(codes, held, count)
    rest = [link for link in order.tolist() if link not in held]
    part = np.full(count, 1)
    part[_discover(rest, shares[0] / sum(shares), devices, marks)] = 0
    part[list(held)] = 2
    rows = [np.flatnonzero(part[codes] == which) for which in range(3)]
    return LinkSplit(rows[0], rows[1], Sealed(rows[2]), count)


def check_rows(split: LinkSplit) -> None:
    """Raise BenchError where links are so few and short that no row is left to fit."""
    if not len(split.fit):
        raise BenchError(
            f"{split.links} links of at most {STRETCH_ROWS} rows: too few to search and to fit "
            f"apart; expected {SHARED_BELOW} links, or more than {STRETCH_ROWS} rows in some"
        )


def _discover(
    rest: list[int], share: float, devices: list[tuple[str, str]], marks: list[Marks]
) -> list[int]:
    """Return the links, of `rest` in random order, that are searched.

    A device of few links has `share` of them here and the others among those that are fitted:
    what is fitted on the one side has to be there on the other.
    """
    seen = Counter(name for link in rest for name in set(devices[link]))
    few = {name for name, links in seen.items() if name and links < RARE_DEVICE}
    first = {link: min(few & set(devices[link]), default="") for link in rest}
    rare = sorted((link for link in rest if first[link]), key=first.__getitem__)
    chosen = [link for i, link in enumerate(rare) if int((i + 1) * share) > int(i * share)]
    plain = [link for link in rest if not first[link]]
    plain = _in_proportion(plain, share, marks)
    return chosen + plain[: max(1, round(len(rest) * share) - len(chosen))]


def _shared(codes: NDArray[np.intp], held: set[int], count: int) -> LinkSplit:
    """Return a split whose discover and fit rows are alternate stretches of the same links."""
    aside = np.isin(codes, list(held))
    place = np.zeros(len(codes), np.intp)
    for link in range(count):
        rows = np.flatnonzero(codes == link)
        place[rows] = np.arange(len(rows)) // STRETCH_ROWS
    parts = [np.flatnonzero(~aside & (place % 2 == which)) for which in (0, 1)]
    return LinkSplit(parts[0], parts[1], Sealed(np.flatnonzero(aside)), count, shared=True)


def _devices(frame: pd.DataFrame, codes: NDArray[np.intp], count: int) -> list[tuple[str, str]]:
    """Return the pair of devices of each link, empty names where not known."""
    if "tx" not in frame or "rx" not in frame:
        return [("", "")] * count
    first = np.unique(codes, return_index=True)[1]
    tx, rx = frame["tx"].astype(str), frame["rx"].astype(str)
    return [(tx.iloc[i], rx.iloc[i]) for i in first]


def _held_out(
    order: NDArray[np.intp], wanted: int, devices: list[tuple[str, str]], marks: list[Marks]
) -> set[int]:
    """Return the links of the confirm part: those first whose devices stay connected elsewhere.

    Of everything that marks links about its share: what is the matter with one device is confirmed
    by links of its own.
    """
    fair = _in_proportion(order.tolist(), wanted / max(len(order), 1), marks)
    held: set[int] = set()
    for link in fair:
        if len(held) < wanted and _still_known(link, held | {link}, devices):
            held.add(link)
    for link in order.tolist():  # not enough of them: take any
        if len(held) < wanted:
            held.add(link)
    return held


def _in_proportion(order: list[int], share: float, marks: list[Marks]) -> list[int]:
    """Return the links in an order in which everything has its share of them among the first.

    First those that nothing has more of than its share, rounded down; then up; then the others.
    """
    every = Counter(name for link in order for name in marks[link])
    first: dict[int, None] = {}
    for rounded in (np.floor, np.ceil):
        left = Counter({name: int(rounded(share * count)) for name, count in every.items()})
        left.subtract(name for link in first for name in marks[link])
        for link in order:
            if link not in first and all(left[name] > 0 for name in marks[link]):
                first[link] = None
                left.subtract(marks[link])
    return list(dict.fromkeys([*first, *order]))


def _marks(
    frame: pd.DataFrame, codes: NDArray[np.intp], devices: list[tuple[str, str]]
) -> list[Marks]:
    """Return what marks each link: its devices, its place and what stands in its way."""
    rows = frame.iloc[np.unique(codes, return_index=True)[1]]
    places = rows["environment"].astype(str) if "environment" in rows else [""] * len(devices)
    cells = rows["obstacles"] if "obstacles" in rows else [()] * len(devices)
    listed = [
        map(str, cell) if isinstance(cell, list | tuple | np.ndarray) else () for cell in cells
    ]
    every = zip(devices, places, listed, strict=True)
    return [
        frozenset({("device", name) for name in ends if name})
        | {("place", place)}
        | {("obstacle", kind) for kind in kinds}
        for ends, place, kinds in every
    ]


def _still_known(link: int, held: set[int], devices: list[tuple[str, str]]) -> bool:
    """Return whether both devices of a link are joined by a path of links not held out."""
    start, goal = devices[link]
    if start == goal:
        return True
    reached, front = {start}, [start]
    edges = [pair for i, pair in enumerate(devices) if i not in held]
    while front:
        here = front.pop()
        for a, b in edges:
            for far in (b,) if a == here else (a,) if b == here else ():
                if far not in reached:
                    reached.add(far)
                    front.append(far)
    return goal in reached


def thinned(rows: Rows, links: NDArray[np.intp], most: int) -> Rows:
    """Return at most about `most` rows, evenly from every link."""
    if len(rows) <= most:
        return rows
    place = pd.Series(links[rows])
    order = place.groupby(place).cumcount().to_numpy()
    size = place.map(place.value_counts()).to_numpy()
    quota = np.maximum(1, most // len(np.unique(links[rows])))
    wide = np.maximum(size, quota)
    keep = (order * quota) // wide != ((order - 1) * quota) // wide
    return np.asarray(rows[keep])
