"""What is compared with what: rows of a recording, and anything that answers for a simulator.

Both ways to compare (a simulator run again, another simulator's table) answer one question: given
these effects on top of what the simulator has, what does it say about these recorded rows?
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import count
from typing import Protocol

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.covariates import Covariates, covariates
from bench.discrepancy.data.observables import Observables, Window, observe
from bench.discrepancy.data.split import Rows
from bench.discrepancy.settings import PATHS_ONLY_RICHER
from bench.errors import BenchError
from bench.physics.effect import Effect
from bench.physics.scene import Scene, scene

Added = tuple[Effect, ...]
_NUMBERS = count()


def without(added: Added, effect: Effect) -> Added:
    """Return the effects but one, by name."""
    return tuple(known for known in added if known.name != effect.name)


def swapped(added: Added, effect: Effect) -> Added:
    """Return the effects with this one in place of the one of its name."""
    return tuple(effect if known.name == effect.name else known for known in added)


@dataclass(frozen=True)
class View:
    """Some recorded rows: `frame` as known to the simulator, what was recorded, link codes [n].

    `waveform` False has them simulated from paths alone: faster, but powers are approximate and
    there is no noise, so only the range and the receive level are compared. `number` tells views
    apart without looking at their rows: no two have the same.
    """

    frame: pd.DataFrame
    recorded: Observables
    links: NDArray[np.intp]
    rows: Rows
    waveform: bool = True
    number: int = field(default_factory=lambda: next(_NUMBERS), init=False, compare=False)

    def leaving(self, links: NDArray[np.intp]) -> View:
        """Return the view without some links, by code; with all of them where none would stay."""
        keep = np.flatnonzero(~np.isin(self.links, links))
        if not len(keep):  # without rows nothing can be compared
            return self
        recorded = replace(self.recorded, values=self.recorded.values[keep])
        frame = self.frame.iloc[keep].reset_index(drop=True)
        return View(frame, recorded, self.links[keep], self.rows[keep], self.waveform)

    @property
    def rich(self) -> int:
        """How many times the members asked for are made: paths alone cost next to nothing."""
        return 1 if self.waveform else PATHS_ONLY_RICHER

    @cached_property
    def scene(self) -> Scene:
        """Geometry and settings of the rows for `bench.physics`."""
        return scene(self.frame, "recorded")

    @cached_property
    def covariates(self) -> Covariates:
        """What can be searched over."""
        return covariates(self.frame)


def common(added: Added, view: View) -> Added:
    """Return the effects whose ensemble values of devices and levels are estimated from.

    One that strikes links at random shifts the mean of all of them; struck links are better left
    to the robust fit as outliers. With waveforms, where power tells which are struck, all stay.
    """
    if view.waveform:
        return added
    return tuple(effect for effect in added if not type(effect).per_link)


class Comparison(Protocol):
    """A simulated counterpart of recorded rows."""

    def ensemble(self, view: View, added: Added, members: int, first: int = 0) -> Ensemble:
        """Return recorded rows beside `members` simulated versions with effects `added`.

        `first` numbers the replicates: the same numbers give the same random numbers.
        """

    def distinct(self, view: View) -> int:
        """Return how many members there are that repeat nothing of each other."""

    def alike(self, view: View) -> int:
        """Return how many members there are with those of similar links, that repeat nothing."""

    def paired(self, view: View) -> bool:
        """Return whether every recorded row has simulated rows of its own."""

    def crowding(self, view: View) -> float:
        """Return how much wider a mean scatters than permutations say: 1 where no row is shared."""


@dataclass(frozen=True)
class Changed:
    """Another comparison, of which only what is simulated is changed: rows stand for rows as there.

    What inherits it says how in `ensemble`.
    """

    comparison: Comparison

    def distinct(self, view: View) -> int:
        """Return how many members there are that repeat nothing of each other."""
        return self.comparison.distinct(view)

    def alike(self, view: View) -> int:
        """Return how many members there are with those of similar links."""
        return self.comparison.alike(view)

    def paired(self, view: View) -> bool:
        """Return whether every recorded row has simulated rows of its own."""
        return self.comparison.paired(view)

    def crowding(self, view: View) -> float:
        """Return how much wider a mean scatters than permutations say."""
        return self.comparison.crowding(view)


NEEDS_WAVEFORM = ("noise_std", "preamble_count", "first_path_power_dbm")


def view(
    frame: pd.DataFrame,
    links: NDArray[np.intp],
    rows: Rows,
    window: Window,
    names: tuple[str, ...] | None = None,
    waveform: bool = True,
) -> View:
    """Return a view of some rows of a recorded table; `links` are codes of the whole table.

    `names` restricts the comparison to some observables; without a simulated `waveform` those
    that belong to one take no part.
    """
    part = frame.iloc[rows].reset_index(drop=True)
    seen = observe(part, window)
    kept = [n for n in seen.names if waveform or n not in NEEDS_WAVEFORM]
    chosen = tuple(n for n in kept if names is None or n in names)
    if not chosen:
        have = ", ".join(kept) or "none"
        asked = "" if names is None else f" of that name ({', '.join(names)})"
        raise BenchError(f"recorded: no observable{asked} to compare (the table gives: {have})")
    return View(part, seen.keep(chosen), links[rows], rows, waveform)


def joined(one: View, two: View) -> View:
    """Return the rows of two views of one table."""
    names = tuple(name for name in one.recorded.names if name in two.recorded.names)
    parts = [each.recorded.keep(names) for each in (one, two)]
    recorded = replace(parts[0], values=np.concatenate([part.values for part in parts]))
    frame = pd.concat([one.frame, two.frame], ignore_index=True)
    links, rows = (np.concatenate([getattr(v, n) for v in (one, two)]) for n in ("links", "rows"))
    return View(frame, recorded, links, rows, one.waveform)
