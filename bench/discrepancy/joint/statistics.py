"""Statistics of every link, recorded minus simulated, with the covariance that replicates give.

All that waveforms show but the range: levels, noise, count, the delay-resolved profile, features.
They are correlated, within a row and within a link, so they are compared at once: by the likelihood
of normal statistics whose mean and covariance are those of simulated links (a synthetic likelihood:
Wood 2010), the covariance shrunk to its diagonal.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.grouped import means_by_group
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.fit.starts import free_parameters
from bench.discrepancy.joint.covariances import Covariances, beyond_rows, in_parts, of_means, shrunk
from bench.discrepancy.joint.decades import decades
from bench.discrepancy.joint.drawn import with_drawn
from bench.discrepancy.joint.row_likelihood import rows_nats
from bench.discrepancy.joint.settings import (
    DECIBELS,
    FEWEST_ALIKE,
    FLOOR,
    KEPT,
    KNOWN_SHARE,
    LEVELS,
    MEMBERS,
    NOISE_LEAST,
    OTHERS,
    OTHERS_KEPT,
)
from bench.discrepancy.joint.spared import Spared, among_touched, beside, of_touched
from bench.discrepancy.joint.unknown import filled, numbers_of
from bench.discrepancy.settings import FEW_VERSIONS
from bench.errors import BenchError
from bench.physics.effects.propagation.antenna_pattern import waves
from bench.physics.memory import Memory

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Moments:
    """Statistics of L links beside simulated ones, in the units of `Statistics.names`.

    `left` [L, p]: recorded minus simulated mean; `mean` [L, p]: the simulated mean; `covariances`
    maps numbers of rows of a link to the covariance of `left` [p, p]; `spread_left` [L, p]: how
    much larger the logarithm of squared deviations is; `rows_left` [L, p]: the same of rows about
    the mean of their link, 0 where that takes no part in the likelihood. `within`: the log
    likelihood of how rows of a link scatter about its mean, in nats. `own` [L, p, r]: what devices
    may have of their own of the effects, at normal factors of one; `uneven` [L, p, k]: by how much
    links have more or less of them, each by itself, in all statistics at once; None where that is
    nothing. `rows` [p, p]: the covariance of rows of a link about its mean; `of_rows` [n, p]: what
    rows leave, where that takes part in the likelihood; `uneven_rows` [L, p, k]: by how much rows
    of a link have more or less of what devices differ in, each by itself, None where by nothing.
    `spared`: links that some of the effects leave alone.
    """

    left: Floats
    mean: Floats
    covariances: Mapping[int, Floats]
    spread_left: Floats
    rows_left: Floats
    within: float = 0.0
    own: Floats | None = None
    uneven: Floats | None = None
    rows: Floats | None = None
    of_rows: Floats | None = None
    uneven_rows: Floats | None = None
    spared: Spared | None = None


class Statistics:
    """Statistics of the rows of a view beside those that a comparison simulates.

    `beside` are effects that are in place, `members` simulated versions of each link. Raises
    BenchError where waveforms show nothing.
    """

    def __init__(
        self, comparison: Comparison, rows: View, beside: Added = (), members: int = MEMBERS
    ) -> None:
        self.comparison, self.rows, self.beside = comparison, rows, beside
        self.by_rows = isinstance(comparison, Resimulation)
        own = comparison.distinct(rows)
        repeated = comparison.paired(rows) and own > 1 and not self.by_rows
        self.members = min(members, own) if repeated else members
        self.code = np.unique(rows.links, return_inverse=True)[1]
        self.count = np.bincount(self.code)
        bare = comparison.ensemble(rows, beside, self.members)
        known = np.isfinite(bare.versions[:2]).all(axis=0).mean(axis=0) >= KNOWN_SHARE
        self.names = tuple(
            name for name, often in zip(bare.names, known, strict=True) if often and name != RANGE
        )
        if not any(name.startswith("profile_db") for name in self.names):
            raise BenchError("no waveforms to compare")
        units = dict(zip(bare.names, bare.units, strict=True))
        self.floor = np.array([FLOOR.get(units[name], 0.1) for name in self.names]) ** 2
        self._others: Memory[Floats] = Memory(OTHERS_KEPT)
        self.apart = np.zeros((len(self.names),) * 2)
        if repeated:
            self.apart = self._apart()
        self.crowding = 1.0 if self.apart.any() else comparison.crowding(rows) ** 2
        self._kept: Memory[Moments | None] = Memory(KEPT)

    @property
    def links(self) -> int:
        """How many links there are."""
        return len(self.count)

    @cached_property
    def ways(self) -> Floats:
        """What forms may differ over: a constant and the distance, standardised, [L, 2]."""
        far = self.of_links(np.nan_to_num(self.rows.scene.true_range_m)[:, None])[:, 0]
        return np.stack([np.ones(self.links), (far - far.mean()) / max(far.std(), 1e-9)], axis=1)

    @cached_property
    def known(self) -> Floats:
        """All numbers, waves of headings and groups known before, standardised, [L, q]."""
        every = self.rows.covariates
        known = (*every.numbers.values(), *waves(self.rows.scene))
        numbers = [self.of_links(filled(one)[:, None])[:, 0] for one in known]
        groups = [
            self.of_links(one[:, None].astype(np.float64))[:, 0] for one in every.groups.values()
        ]
        least, most = FEWEST_ALIKE, self.links - FEWEST_ALIKE
        numbers += [one for one in groups if least <= one.sum() <= most]
        varied = [one for one in numbers if one.std() > 0]
        standard = [np.clip((one - one.mean()) / one.std(), -3, 3) for one in varied]
        return np.stack(standard, axis=1) if standard else np.zeros((self.links, 0))

    @cached_property
    def devices(self) -> Floats:
        """Whether a device is at an end of a link [L, r], of each that several links have."""
        own = self.rows.covariates.devices()
        shares = np.stack(own, axis=1) if own else np.zeros((len(self.code), 0))
        return self.of_links(shares.astype(np.float64))

    @cached_property
    def kinds(self) -> Floats:
        """How many obstacles of a kind stand in the way of a link [L, r], of every kind."""
        return self.of_links(self.rows.scene.count_by_kind())

    def moments(self, added: Added) -> Moments | None:
        """Return the statistics with effects `added`; None where one leaves an observable unknown.

        Or where it fails.
        """
        return self._kept.get(added, lambda: self._moments(added, self.members))

    def needed(self, added: Added) -> Moments:
        """Return the statistics as `moments` does; raises BenchError where there are none."""
        made = self.moments(added)
        if made is None:
            raise BenchError("nothing can be simulated at these rows")
        return made

    def knowing(self, added: Added) -> Statistics:
        """Return those of the statistics that effects `added` leave known."""
        have = self.comparison.ensemble(self.rows, (*self.beside, *added), self.members).names
        keep = [place for place, name in enumerate(self.names) if name in have]
        if len(keep) == len(self.names):
            return self
        less = copy(self)
        less.names, less.floor = tuple(self.names[i] for i in keep), self.floor[keep]
        less.apart = self.apart[np.ix_(keep, keep)]
        less._kept, less._others = Memory(KEPT), Memory(OTHERS_KEPT)
        less.__dict__.pop("_bare", None)
        return less

    def worth(self, nats: float, effects: Added) -> float:
        """Return nats less what the parameters of effects cost, as links count (BIC)."""
        count = sum(len(free_parameters(type(effect))) for effect in effects)
        return float(nats) / self.crowding - count / 2 * float(np.log(self.links))

    def mean(self, added: Added) -> Floats | None:
        """Return the statistics of one simulated version [L, p], None as for `moments`."""
        return self._first(self._made(added, 1))

    def means(self, many: Sequence[Added]) -> list[Floats | None]:
        """Return `mean` of each of many sets of effects, which differ in one effect."""
        if not isinstance(self.comparison, Resimulation) or self.rows.rich > 1:
            return [self.mean(added) for added in many]
        made = self.comparison.single(self.rows, [(*self.beside, *added) for added in many])
        return [self._first(one) for one in made]

    def _first(self, made: Ensemble | None) -> Floats | None:
        """Return the statistics of the first simulated version [L, p], None where not all are."""
        if made is None or not set(self.names) <= set(made.names):
            return None
        return self.of_links(np.nan_to_num(self._values(made)[1]))

    def others(self, added: Added) -> Floats:
        """Return what links of further simulated versions leave [v, L, p] (see `others_rows`)."""
        every = [self.of_links(one) for one in self.others_rows(added)]
        return np.stack(every) if every else np.zeros((0, self.links, len(self.names)))

    def others_rows(self, added: Added) -> Floats:
        """Return what further simulated versions leave [v, n, p], in the recorded ones' place.

        Of a table those of similar links, which draw what a link has by chance anew; none where
        there are too few, or where a statistic is not known of them. Not to be written into.
        """
        return self._others.get(added, lambda: self._left_by_others(added))

    def _left_by_others(self, added: Added) -> Floats:
        """Return `others_rows`, simulated."""
        paired = self.comparison.paired(self.rows) and not self.by_rows
        first = max(self.members, self.comparison.distinct(self.rows) if paired else 0)
        count = min(OTHERS, self.comparison.alike(self.rows) - first)
        made = self._made(added, first + count) if count >= FEW_VERSIONS else None
        if made is None:
            return np.zeros((0, len(self.code), len(self.names)))
        values = np.nan_to_num(self._values(made))
        return np.asarray(values[1 + first :] - values[1 : 1 + self.members].mean(axis=0))

    def _apart(self) -> Floats:
        """Return what similar links differ by beyond what versions of one link do [p, p]."""
        others, bare = self.others(()), self._made((), self.members)
        if not len(others) or bare is None:
            return self.apart
        plain = self._compared(self._values(bare)).covariances
        usual = np.mean([plain[int(n)] for n in self.count], axis=0) - np.diag(self.floor)
        sizes, ways = np.linalg.eigh(of_means(others) - usual)
        return np.asarray((ways * np.maximum(sizes, 0)) @ ways.T)

    def _made(self, added: Added, members: int) -> Ensemble | None:
        try:
            made = self.comparison.ensemble(self.rows, (*self.beside, *added), members)
        except BenchError:
            return None
        return made if set(self.names) <= set(made.names) else None

    def _moments(self, added: Added, members: int) -> Moments | None:
        if (made := self._made(added, members)) is None:
            return None
        found = self._compared(values := self._values(made))
        if not (added and (plain := self.moments(()))):
            return found
        few = beside(added)
        found = among_touched(found, self.moments(few) if few != added else None, self.count)
        change, code = of_touched(numbers_of(values[1:] - self._bare[1:]), self.code, found.spared)
        whole = with_drawn(plain.covariances, found.covariances, change, code, self._level)
        return replace(found, covariances=whole)

    @property
    def _level(self) -> int:
        """The place of a level among the statistics, the first where there is none."""
        return next((i for i, name in enumerate(self.names) if name in LEVELS), 0)

    @cached_property
    def _bare(self) -> Floats:
        """The versions [1 + m, n, p] without effects."""
        return self._values(self.comparison.ensemble(self.rows, self.beside, self.members))

    def _values(self, made: Ensemble) -> Floats:
        """Return the versions [1 + m, n, p] of the statistics of rows."""
        places = [made.place(name) for name in self.names]
        values = np.array(made.versions[:, :, places])
        for column, name in enumerate(self.names):
            if name in DECIBELS:
                values[..., column] = DECIBELS[name] * decades(values[..., column])
        return values

    def _compared(self, values: Floats) -> Moments:
        members = len(values) - 1
        mean = numbers_of(values[1:]).mean(axis=0)
        left = numbers_of(values[0] - mean)
        own = numbers_of(values[1:] - mean) * np.sqrt(members / max(members - 1, 1))
        between, rows, about = in_parts(own, self.code, self.count)
        scatter = np.maximum(np.diag(between + self.apart), 1e-9)
        wide = np.log(NOISE_LEAST + left**2 / scatter)
        alike = own**2 / np.maximum(np.diag(between), 1e-9)
        usual = np.log(NOISE_LEAST + alike * (1 + 1 / members)).mean(axis=0)
        return Moments(
            self.of_links(left),
            self.of_links(mean),
            self._covariances(rows, between, members),
            self.of_links(wide - usual),
            self._rows_left(left, about * np.sqrt(1 + 1 / members), rows),
            self.within(left, rows),
            rows=rows,
            of_rows=left if self.told_within else None,
        )

    def _rows_left(self, left: Floats, about: Floats, rows: Floats) -> Floats:
        """Return how much more rows scatter about their link's mean than simulated ones [L, p].

        Of what rows leave [n, p], beside simulated rows `about` the mean of theirs [m, n, p] with
        covariance `rows`, in logarithms of squares.
        """
        if not self.told_within:
            return np.zeros((self.links, len(self.names)))
        share = np.maximum(1 - 1 / self.count, 1e-9)[self.code][:, None]
        scale = share * (np.diag(rows) + self.floor)
        recorded = np.log(NOISE_LEAST + (left - self.of_links(left)[self.code]) ** 2 / scale)
        usual = np.log(NOISE_LEAST + about**2 / scale).mean(axis=0)
        return self.of_links(recorded - usual)

    @property
    def told_within(self) -> bool:
        """Whether how rows of a link scatter about its mean takes part in the likelihood.

        Not where links have one row each, or stand in a table.
        """
        return self.by_rows and len(self.code) > self.links

    def within(self, left: Floats, rows: Floats, uneven: Floats | None = None) -> float:
        """Return the log likelihood of how rows of a link scatter about its mean, in nats.

        Of what rows leave [n, p], by the covariance of simulated ones `rows` [p, p], and by what is
        `uneven` in them (see `Moments`); 0 where that takes no part. What draws every row anew is
        told by this from what links keep, which means alone hide.
        """
        if not self.told_within:
            return 0.0
        about = left - self.of_links(left)[self.code]
        few = min(len(self.names) / (self.members * (len(self.code) - self.links)), 1.0)
        wide = shrunk(rows, few) * (1 + 1 / self.members) + np.diag(self.floor)
        return rows_nats(about, self.code, wide, uneven)

    def _covariances(self, rows: Floats, between: Floats, members: int) -> Covariances:
        """Return the covariance of means over so many rows of a link, by their number."""
        link = beyond_rows(between, rows, self.count)
        share = min(len(self.names) / max(members * self.links, 1), 1.0)
        counts = tuple(int(n) for n in np.unique(self.count))
        wider = 1 + 1 / members
        return Covariances(counts, link, rows, share, wider, self.apart, np.diag(self.floor))

    def of_links(self, values: Floats) -> Floats:
        """Return the means of values [n, p] over the rows of each link [L, p]."""
        return means_by_group(values, self.code, self.count)
