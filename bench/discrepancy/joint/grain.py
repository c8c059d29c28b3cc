"""How late samples scatter, within a record and from row to row, and whether what is added dies.

Profiles say how much arrives when, not how. A dense tail of waves in any phase makes powers scatter
as chance does, whatever it decays by; a ringing at fixed delays makes them alike in all rows; a
gain that grows over the delay, or a filter of what was sampled, leaves them as uneven as they were.
So where late samples scatter as they do without a name that would plainly change it, it is none (a
posterior predictive check: Gelman, Meng and Stern 1996). Neither colour nor pulse counts: pairs of
samples are too far apart, and rows are compared sample by sample. An echo at one delay must show at
that delay. And what comes by many detours, or rings, dies away: in no row does more of it come the
later it is, as of noise that grows.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from bench.discrepancy.compare.records import Samples, recorded_samples, simulated_samples
from bench.discrepancy.compare.view import Added
from bench.discrepancy.joint.quiet_moments import (
    error_of,
    in_part,
    mean_known,
    moments_of,
    ratio_of,
)
from bench.discrepancy.joint.settings import (
    CLASS_SHARE,
    GRAIN_ABOUT,
    GRAIN_ALIKE,
    GRAIN_CHANCE,
    GRAIN_CREST_NS,
    GRAIN_FEWEST,
    GRAIN_FINE_NS,
    GRAIN_FORM,
    GRAIN_LEAST,
    GRAIN_MEMBERS,
    GRAIN_WEAKEST,
    GRAIN_ZONES_NS,
    GROWN_ERRORS,
    GROWN_TIMES,
    GROWTH_NS,
    KEPT,
    NAME_NATS,
    OFF_SHARE,
    PULSE_NS,
)
from bench.discrepancy.joint.statistics import Floats, Statistics
from bench.discrepancy.settings import ONE_SIDED_95
from bench.physics.memory import Memory

Mask = NDArray[np.bool_]
Figures = tuple[Floats, Floats]
"""Figures of the grain [g], and their standard errors [g]."""


class Grain:
    """The grain of recorded late samples beside that of sets of effects."""

    def __init__(self, given: Statistics) -> None:
        self.given = given
        recorded = recorded_samples(given.comparison, given.rows)
        bare = simulated_samples(given.comparison, given.rows, given.beside, 0)
        self.recorded = None if bare is None else recorded
        self._seen: Memory[Figures] = Memory(KEPT)

    def refutes(self, effects: Added, name: str) -> bool:
        """Return whether late samples are surely not as one effect of a set would have them.

        They scatter as without it, within chance, though it would plainly change that; or nothing
        is at its delays, or what is there is no chance; or more comes the later it is.
        """
        if self.recorded is None:
            return False
        kind = next(type(effect) for effect in effects if effect.name == name)
        rest = tuple(effect for effect in effects if effect.name != name)
        after, before, foreseen = self.misfits(effects, rest)
        if foreseen > NAME_NATS and before < min(after, foreseen, self._chance):
            return True
        if kind.at_one_delay:
            if self._unseen(effects, rest):
                return True
        elif kind.dies_away and self._steadier(effects):
            return True
        return kind.dies_away and self.grows(rest)

    def slack(self, effects: Added, name: str) -> float:
        """Return by what share of all that a member brings another that does as well may be behind.

        By more where the member would plainly change how late samples scatter, and they surely do
        not scatter as the set has it: then its form is no better than another's.
        """
        if self.recorded is None:
            return 1 - CLASS_SHARE
        rest = tuple(effect for effect in effects if effect.name != name)
        after, _, foreseen = self.misfits(effects, rest)
        off = foreseen > NAME_NATS and after > self._chance
        return 1 - (OFF_SHARE if off else CLASS_SHARE)

    @cached_property
    def _of_recorded(self) -> Figures:
        """The grain of recorded samples."""
        assert self.recorded is not None
        return grain_of(self.recorded, self.given)

    @property
    def _chance(self) -> float:
        """Return how far from the right set late samples scatter by chance at most, in nats."""
        figures = len(self._of_recorded[0])
        return 0.5 * float(chi2.isf(GRAIN_CHANCE, figures)) if figures else 0.0

    def _unseen(self, whole: Added, rest: Added) -> bool:
        """Return whether nothing is surely recorded of what a set would plainly have sharply."""
        share, plain = self.shown(whole, rest)
        return plain > NAME_NATS and share < ONE_SIDED_95 / np.sqrt(2 * plain)

    def misfits(self, whole: Added, rest: Added) -> tuple[float, float, float]:
        """Return how far from a set, and from its rest, late samples scatter, each in nats.

        And how far from the rest they would, if they scattered as with the set. A share of what the
        set does is a matter of its form.
        """
        grain, error = self._of_recorded
        (after, sure), (before, other) = self._simulated(whole), self._simulated(rest)
        formed = (GRAIN_FORM * (after - before)) ** 2
        left = (grain - after) ** 2 / (error**2 + sure**2 + formed)
        plain = error**2 + other**2
        every = left, (grain - before) ** 2 / plain, (after - before) ** 2 / plain
        with_it, without, foreseen = (0.5 * float(one.sum()) for one in every)
        return with_it, without, foreseen

    def _steadier(self, whole: Added) -> bool:
        """Return whether late samples of a record are surely more alike than waves in any phase.

        However a dense tail dies away, its powers scatter as those of noise do, whose mean square
        is twice the square of the mean; fewer ways scatter by more.
        """
        assert self.recorded is not None
        zones = len(zones_of(mean_known(self.recorded[1], 0), GRAIN_ZONES_NS))
        (grain, error), (after, sure) = (
            (figures[:zones], errors[:zones])
            for figures, errors in (self._of_recorded, self._simulated(whole))
        )
        least = np.minimum(after, np.log(2.0))
        wide = error**2 + sure**2 + (GRAIN_FORM * least) ** 2
        square = float((np.maximum(least - grain, 0) ** 2 / wide).sum())
        return bool(zones) and square > chi2.isf(GRAIN_CHANCE, zones)

    def shown(self, whole: Added, rest: Added) -> tuple[float, float]:
        """Return how much of what a set has sharply over the delay, beside its rest, is recorded.

        As a share, and in how many nats all of it would show: an echo at one delay has its place.
        """
        assert self.recorded is not None
        levels = levels_of(self.recorded)
        scatter = self.given.of_links(levels).std(axis=0)
        weights = 1 / (scatter**2 / self.given.links + GRAIN_LEAST[1] ** 2)
        late = mean_known(self.recorded[1], 0) > PULSE_NS
        before = self._profile(rest)
        every = (self._profile(whole), levels.mean(axis=0))
        sharp, seen = (_sharp((one - before)[late]) for one in every)
        square = float((weights[late] * sharp**2).sum())
        share = float((weights[late] * sharp * seen).sum()) / max(square, np.finfo(float).tiny)
        return share, 0.5 * square / GRAIN_ALIKE

    def _profile(self, added: Added) -> Floats:
        """Return the mean decibels of samples of simulated versions, beside crests [K]."""
        every = [levels_of(one).mean(axis=0) for one in self.samples(added)]
        return np.asarray(np.mean(every, axis=0))

    def grows(self, rest: Added) -> bool:
        """Return whether more and more power is added to what a set has, the later it is."""
        assert self.recorded is not None
        power = np.mean([magnitude**2 for magnitude, _ in self.samples(rest)], axis=0)
        return growing(added_of(self.recorded, power, self.given))

    def steadies(self, effects: Added, rest: Added) -> bool:
        """Return whether late samples are surely as alike as a set with more at one delay has them.

        Not as in the `rest`, as fitted by itself: none of what that has is alike in all rows.
        """
        more = [effect for effect in effects if effect.name not in {one.name for one in rest}]
        if self.recorded is None or not any(type(one).at_one_delay for one in more):
            return False
        grain, error = self._of_recorded
        (after, sure), (before, other) = self._simulated(effects), self._simulated(rest)
        wide = np.sqrt(error**2 + sure**2 + other**2)
        return in_part(grain - before, after - before, wide) >= NAME_NATS

    def samples(self, added: Added, members: int = GRAIN_MEMBERS) -> list[Samples]:
        """Return the samples of simulated versions."""
        given, effects = self.given, (*self.given.beside, *added)
        numbers = range(members)
        made = (simulated_samples(given.comparison, given.rows, effects, n) for n in numbers)
        return [one for one in made if one is not None]

    def _simulated(self, added: Added) -> Figures:
        """Return the mean grain of simulated versions, and its standard errors; remembered."""

        def made() -> Figures:
            every = [grain_of(one, self.given)[0] for one in self.samples(added)]
            return np.mean(every, axis=0), np.std(every, axis=0, ddof=1) / np.sqrt(len(every))

        return self._seen.get(added, made)


def grain_of(samples: Samples, given: Statistics) -> Figures:
    """Return how samples scatter in zones of delay, and standard errors over links.

    The logarithm of mean squared powers over squared mean powers of a record (`moments_of`), and by
    how many decibels rows scatter, beside the crest of each.
    """
    magnitude, level, delay = samples[0], levels_of(samples), mean_known(samples[1], 0)
    inside = [within(magnitude[:, zone], given) for zone in zones_of(delay, GRAIN_ZONES_NS)]
    between = [_between(level[:, zone], given) for zone in zones_of(delay, GRAIN_FINE_NS, 1)]
    figures = np.array([*inside, *between]).reshape(-1, 2)
    least = np.repeat(GRAIN_LEAST, (len(inside), len(between)))
    return figures[:, 0], np.hypot(figures[:, 1], least)


def levels_of(samples: Samples) -> Floats:
    """Return the decibels of samples [n, K] beside the crest of each row, else at their mean."""
    magnitude, delay = samples[0], mean_known(samples[1], 0)
    crest = np.fmax.reduce(magnitude[:, np.abs(delay) < GRAIN_CREST_NS], axis=1, keepdims=True)
    levels = 20 * np.log10(np.maximum(magnitude / crest, GRAIN_WEAKEST))
    return np.where(np.isfinite(levels), levels, mean_known(levels, 0))


def zones_of(delay: Floats, edges: Sequence[float], fewest: int = GRAIN_FEWEST) -> list[Mask]:
    """Return which samples [K] at delays lie in zones between edges, of those that have enough."""
    every = [(delay >= start) & (delay < end) for start, end in pairwise(edges)]
    return [zone for zone in every if zone.sum() >= fewest]


def within(magnitude: Floats, given: Statistics) -> tuple[float, float]:
    """Return the logarithm of the ratio of moments within records [n, k], and its error."""
    known = np.isfinite(magnitude)
    level = np.sqrt(np.where(known, magnitude**2, 0).mean(axis=1, keepdims=True))
    moments = moments_of(np.where(known, magnitude, 0) / np.maximum(level, np.finfo(float).tiny))
    ratio = ratio_of(moments)
    return float(np.log(ratio)), error_of(given.of_links(moments)) / ratio


def _between(level: Floats, given: Statistics) -> tuple[float, float]:
    """Return how rows of decibels [n, k] scatter, sample by sample, and its error."""
    square = ((level - level.mean(axis=0)) ** 2).mean(axis=1, keepdims=True)
    of_links = given.of_links(square)
    scatter = float(np.sqrt(of_links.mean()))
    return scatter, float(of_links.std() / np.sqrt(len(of_links)) / 2 / scatter)


def _sharp(levels: Floats) -> Floats:
    """Return levels [k] less their mean about each: what a smooth profile has not."""
    return np.asarray(levels - mean_about(levels, GRAIN_ABOUT))


def mean_about(values: Floats, samples: int) -> Floats:
    """Return the means of values [K] over so many samples on both sides of each."""
    wide = np.pad(values, samples, mode="edge")
    count = 2 * samples + 1
    return np.asarray(np.convolve(wide, np.full(count, 1 / count), "valid"))


def added_of(recorded: Samples, power: Floats, given: Statistics) -> Floats:
    """Return what links have more than a simulated power [n, K] in stretches of delay [L, s].

    Over the row's own late power as simulated: so rows in which noise is most count like others.
    """
    delay = mean_known(recorded[1], 0)
    known = np.isfinite(recorded[0]) & np.isfinite(power)
    more, usual = (np.where(known, one, 0) for one in (recorded[0] ** 2 - power, power))
    late = usual[:, delay >= GROWTH_NS[0]].mean(axis=1, keepdims=True)
    parts = [more[:, zone].mean(axis=1) for zone in zones_of(delay, GROWTH_NS)]
    rows = np.stack(parts, axis=1) if parts else np.zeros((len(more), 0))
    return given.of_links(rows / np.maximum(late, np.finfo(float).tiny))


def growing(added: Floats) -> bool:
    """Return whether surely more is added in any later stretch than in an earlier one [L, s].

    Where less than nothing is added early, more than nothing must be added late; what is added
    early is as unsure as links differ in it, there too.
    """
    for early, late in combinations(added.T, 2):
        step = late - (GROWN_TIMES * early if early.mean() > 0 else 0.0)
        error = (late - GROWN_TIMES * early).std() / np.sqrt(len(late))
        if step.mean() > GROWN_ERRORS * error:
            return True
    return False
