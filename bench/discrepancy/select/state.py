"""The state of a search: what it looks at, which effects it has added, and how it went."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import pandas as pd

from bench.discrepancy.compare.view import Added, Comparison, View, joined
from bench.discrepancy.locate.finding import Finding, Located
from bench.discrepancy.select.candidates import Explanation
from bench.discrepancy.select.guard import Guard
from bench.discrepancy.select.link_mixture import Strike
from bench.discrepancy.select.verdict import Verdict
from bench.discrepancy.sets.choice import Choice
from bench.physics.effect import Effect

Progress = Callable[[str], None]


def silent(_: str) -> None:
    """Say nothing."""


@dataclass(frozen=True)
class Search:
    """What every step shares: the comparison, the two working views, the library, the seed.

    `work` are the rows of both views, on which the chosen effects are fitted at the end; None
    where that would cost too much: with waveforms. `choice`: the
    set of causes that ranges speak for. `doubtful`: columns of all recorded rows that were set
    aside as measured by their scatter alone. `untried`: effects that cannot be tried: no table can
    have them, or columns lack. `logged`: effects that logs of the receiver show beside ranges (see
    `bench.discrepancy.select.logged`). `whole`: working rows with struck links.
    """

    comparison: Comparison
    discover: View
    fit: View
    kinds: Mapping[str, type[Effect]]
    seed: int
    progress: Progress = silent
    work: View | None = None
    choice: Choice = field(default_factory=Choice)
    doubtful: pd.DataFrame = field(default_factory=pd.DataFrame)
    untried: Mapping[str, type[Effect]] = field(default_factory=dict)
    logged: Added = ()
    whole: View | None = None

    @property
    def both(self) -> View:
        """The rows of both working views."""
        return joined(self.fit, self.discover) if self.work is None else self.work

    @property
    def every(self) -> View:
        """The rows of both working views, with those of links that were struck."""
        return self.whole or self.both

    @property
    def sharpest(self) -> View:
        """The rows that the final parameters are fitted on."""
        return self.fit if self.work is None else self.work

    def fitted_on(self, effect: Effect) -> View:
        """Return the rows that an effect was fitted on: of a set of causes all that were weighed.

        Beside waveforms these are more than those of all other effects.
        """
        return self.both if effect.physics in self.choice.names else self.sharpest

    @property
    def searched(self) -> View:
        """The rows that are searched: both views where scores are those of both (see `explain`)."""
        return self.discover if self.work is None else self.work

    def spared(self, found: Strike) -> Search:
        """Return a search on the links that were not struck, by other effects."""
        calm = replace(
            self,
            discover=self.discover.leaving(found.struck),
            fit=self.fit.leaving(found.struck),
            work=self.work and self.work.leaving(found.struck),
            whole=self.every,
        )
        return calm.without(found.effect)

    def without(self, effect: Effect) -> Search:
        """Return a search that leaves this effect out of the library."""
        return replace(self, kinds={n: k for n, k in self.kinds.items() if n != effect.name})


@dataclass(frozen=True)
class Round:
    """One turn of the loop: what was located, who competed, what was added.

    `strike` is set where that strikes links at random (see `link_mixture`): what follows is judged
    on the links it did not strike.
    """

    located: Located
    explanation: Explanation | None
    added: Effect | None
    strike: Strike | None = None


@dataclass(frozen=True)
class State:
    """Where a search stands: the effects `added` so far, its rounds, whether it has `finished`.

    `guard` notes steps that failed.
    """

    search: Search
    added: Added = ()
    rounds: tuple[Round, ...] = ()
    skipped: Mapping[str, str] = field(default_factory=dict)
    finished: bool = False
    guard: Guard = field(default_factory=Guard)

    def after(self, turn: Round, finished: bool = False) -> State:
        """Return the state with one more round, its failed effects noted."""
        failed = dict(turn.explanation.skipped) if turn.explanation else {}
        return replace(
            self,
            rounds=(*self.rounds, turn),
            skipped={**self.skipped, **failed},
            finished=finished,
        )


@dataclass(frozen=True)
class Selection:
    """Verdicts with the effects to add (`added`), and how the search went.

    `together`: the names that were weighed as a set (see `bench.discrepancy.sets`). `mistaken`:
    columns that were set aside as measured, but are not. `withheld`: names that were not added, or
    not whole, and why; `untimed`: those that leave ranges as they are. `logged`: effects that logs
    of the receiver show. `tied`: names that do as well as a fault of the set-up that is said in
    their place; `elsewhere`: devices of which one may stand elsewhere instead of antenna delays.
    `mean`: what names leave that is the mean of what goes up and down. `sealed_choice`: names of a
    class of which sealed links told which is added. `left_note`: which links still are far off.
    """

    verdicts: tuple[Verdict, ...]
    added: Added
    rounds: tuple[Round, ...]
    skipped: Mapping[str, str] = field(default_factory=dict)
    together: tuple[str, ...] = ()
    mistaken: tuple[str, ...] = ()
    withheld: Mapping[str, str] = field(default_factory=dict)
    logged: Added = ()
    tied: tuple[str, ...] = ()
    untimed: tuple[str, ...] = ()
    elsewhere: tuple[str, ...] = ()
    mean: tuple[Finding, ...] = ()
    sealed_choice: tuple[str, ...] = ()
    left_note: str = ""

    @property
    def left(self) -> frozenset[str]:
        """Observables in which the last round found a difference and added nothing."""
        last = self.rounds[-1] if self.rounds else None
        found = () if last is None or last.added or last.strike else last.located.findings
        return frozenset(one.cell.observable for one in found)

    @property
    def names(self) -> tuple[tuple[str, ...], ...]:
        """Names of every verdict that names something."""
        return tuple(verdict.names for verdict in self.verdicts if verdict.names)
