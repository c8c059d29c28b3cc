"""A detector that finds first paths later: its index lies later behind the edge of its own record.

Waveforms are compared from the detected index on, so they hardly show where that lies. But in every
record a first path can be found again, with one detector for both sides. Where the recorded index
lies later behind that edge than the simulated one, and the range is longer by as much on the same
links, the first path was found late: a delay, a clock or a bias moves the range and no index, and
what lengthens the way of a path moves both the edge and the index. What changes the first pulse, or
leaves a weak one in its place, moves indices too, by a detector that is no deafer than simulated:
so they must be late for the detector that simulated indices tell, too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.records import recorded_samples, simulated_samples
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Added, View, swapped, without
from bench.discrepancy.data.observables import NOISE, RANGE
from bench.discrepancy.joint.choice import WaveChoice
from bench.discrepancy.joint.detector import TIMED, USUAL, Detector, Heard, as_deaf, learned
from bench.discrepancy.joint.rows import compared_rows
from bench.discrepancy.joint.settings import (
    CLASS_NATS,
    LATE_ERRORS,
    LATE_FRACTIONS,
    LATE_LEAST_M,
    LATE_MEMBERS,
    LATE_OWN,
    LATE_P,
    LATE_RISES_DB,
    LATE_SHARES,
    LATE_SIZES_M,
    LATE_TIMES,
    NAME_NATS,
    PULSE_NS,
)
from bench.discrepancy.locate.rare import struck_above
from bench.discrepancy.select.state import Search
from bench.discrepancy.settings import MAD_TO_STD
from bench.physics.base import RAYLEIGH_STD
from bench.physics.effects.propagation.ground_bounce import GroundBounce
from bench.physics.effects.propagation.specular import SpecularReflections
from bench.physics.effects.receiver.late_detection import LateDetection
from bench.physics.units import C_M_PER_NS, Floats

MEET = (GroundBounce, SpecularReflections)
"""Effects whose rays meet the straight one within its pulse, at another phase in every link."""


@dataclass(frozen=True)
class Late:
    """Means of links, recorded beyond simulated, in metres [L each].

    `index_m`: how much later the index lies behind the edge; `range_m`: how much longer ranges are;
    `own_m`: the first of one simulated version beyond the others; `jumps_m`: the first of rows that
    were found on another path, 0 for others. `chance`: that of rows found on another, later path
    than in all simulated versions, if all of these were alike.
    """

    index_m: Floats
    range_m: Floats
    own_m: Floats
    jumps_m: Floats
    chance: float = 1.0

    @property
    def _told_m(self) -> Floats:
        """Of the index and its jumps alone that which ranges follow: few jumps drown in edges."""
        ways = (self.index_m, self.jumps_m)
        return max(ways, key=lambda one: likelihood(self.range_m - one))

    @property
    def nats(self) -> float:
        """What ranges say for following the index, against not doing so."""
        return likelihood(self.range_m - self._told_m) - likelihood(self.range_m)

    @property
    def follows(self) -> bool:
        """Whether ranges move about as far as the index, for all that is known (20 to 1)."""
        shares = np.asarray(LATE_SHARES)
        told_m = self._told_m
        fits = np.array([likelihood(self.range_m - share * told_m) for share in shares])
        near = (shares >= 1 / LATE_TIMES) & (shares <= LATE_TIMES)
        return bool(fits[near].max() >= fits.max() - CLASS_NATS)

    @property
    def later(self) -> float:
        """How much later the index lies, in standard errors of a simulated version's.

        Of a logarithm from the usual scatter on: few links far off and all links a little count.
        """
        usual = max(MAD_TO_STD * float(np.median(np.abs(self.own_m))), LATE_LEAST_M)
        seen, own = (np.sign(m) * np.log1p(np.abs(m) / usual) for m in (self.index_m, self.own_m))
        return float(seen.sum() / np.sqrt(np.sum(np.maximum(own**2, LATE_OWN))))

    @property
    def moved(self) -> bool:
        """Whether first paths were found at another place, later or sooner."""
        follow = self.follows and self.nats >= NAME_NATS
        return (self.rare or abs(self.later) >= LATE_ERRORS) and follow

    @property
    def rare(self) -> bool:
        """Whether single rows were found on a later path, which hardly move a sum over links."""
        return self.chance <= LATE_P

    @property
    def found(self) -> bool:
        """Whether first paths were found late."""
        return self.moved and (self.rare or self.later > 0)


def likelihood(left_m: Floats) -> float:
    """Return the log-likelihood of what is left of links [L], of their likeliest scatter.

    With Cauchy's tails: one link whose edge is another path must not decide.
    """
    sizes = np.asarray(LATE_SIZES_M)[:, None]
    return float(np.max(np.sum(-np.log(sizes) - np.log1p((left_m / sizes) ** 2), axis=1)))


@dataclass(frozen=True)
class Seen:
    """Rows of `links` [n] that two sides hold: recorded, simulated versions, and ranges.

    `left_m` [n]: recorded ranges beyond simulated ones, in metres. `crowding`: see `struck_rows`.
    """

    recorded: Heard
    versions: tuple[Heard, ...]
    left_m: Floats
    links: NDArray[np.intp]
    crowding: float = 1.0

    def late_by(self, detector: Detector = USUAL) -> Late | None:
        """Return by how much first paths are found later, None where no edge is seen."""
        every = np.stack([detector.edges_ns(one) for one in (self.recorded, *self.versions)])
        edges = every[1:]
        index = edges.mean(axis=0) - every[0]
        own = edges[1:].mean(axis=0) - edges[0] if len(edges) > 1 else np.zeros(len(index))
        able = np.isfinite(index) & np.isfinite(self.left_m)
        if not able.any():
            return None
        jumps = np.where(np.abs(index) > PULSE_NS, index, 0.0)
        values = (_m(index), self.left_m, _m(own), _m(jumps))
        index_m, range_m, own_m, jumps_m = (_means(one[able], self.links[able]) for one in values)
        chance = struck_above(
            _m(-every)[:, able], self.links[able], C_M_PER_NS * PULSE_NS, self.crowding
        )
        return Late(index_m, range_m, own_m, jumps_m, chance)


def seen_beside(search: Search, rows: View, added: Added) -> Seen | None:
    """Return what both sides hold beside some effects, None without samples or ranges."""
    recorded, known = _recorded(search, rows), _versions(search, rows, added)
    ensemble = search.comparison.ensemble(rows, added, LATE_MEMBERS)
    if recorded is None or not known or RANGE not in ensemble.names:
        return None
    crowding = search.comparison.crowding(rows)
    return Seen(recorded, tuple(known), ensemble.residual_of(RANGE), rows.links, crowding)


def _late(seen: Seen | None, detector: Detector = USUAL) -> bool:
    """Return whether first paths were found late, by one detector."""
    found = seen.late_by(detector) if seen else None
    return found is not None and found.found


def _versions(search: Search, rows: View, added: Added) -> list[Heard]:
    """Return what simulated versions of rows hold with effects, none without samples."""
    made = [_simulated(search, rows, added, number) for number in range(LATE_MEMBERS)]
    return [one for one in made if one is not None]


def _recorded(search: Search, rows: View) -> Heard | None:
    """Return what recorded rows hold, None without samples."""
    samples, seen = recorded_samples(search.comparison, rows), rows.recorded
    noise = seen.column(NOISE) if NOISE in seen.names else np.full(len(rows.rows), np.nan)
    return None if samples is None else Heard(samples, noise / RAYLEIGH_STD)


def _simulated(search: Search, rows: View, added: Added, number: int) -> Heard | None:
    """Return what one simulated version holds, None without samples."""
    comparison = search.comparison
    samples = simulated_samples(comparison, rows, added, number)
    if samples is None or not isinstance(comparison, Resimulation | TableComparison):
        return None
    outcome = comparison.outcome(rows, added, number)
    return Heard(samples, np.asarray(outcome.noise_std / RAYLEIGH_STD, np.float64))


def _m(delay_ns: Floats) -> Floats:
    return np.asarray(C_M_PER_NS * delay_ns)


def _means(values: Floats, links: NDArray[np.intp]) -> Floats:
    """Return the mean of every link of values [n]."""
    code = np.unique(links, return_inverse=True)[1]
    return np.asarray(np.bincount(code, values) / np.bincount(code))


def found_late(search: Search) -> LateDetection | None:
    """Return the late detection that indices and ranges of links show, None where they do not."""
    if LateDetection.name not in search.kinds or not search.fit.waveform:
        return None
    rows = compared_rows(search)
    return fitted_late(search, rows, ()) if _is_late(search, rows) else None


def _is_late(search: Search, rows: View) -> bool:
    """Return whether paths are found late, for detectors that simulated indices tell, too.

    A changed pulse has another edge and another centre, and a path that something weakened is
    passed over by a detector that always was as deaf.
    """
    seen = seen_beside(search, rows, ())
    if seen is None or not _late(seen):
        return False
    told = learned(seen.versions)
    return all(_late(seen, one) for one in (told, *as_deaf(told, seen.versions, seen.recorded)))


def fitted_late(search: Search, rows: View, beside: Added) -> LateDetection:
    """Return the late detection with which indices lie as they do in recordings.

    Of the noise or of the peak: one threshold decides in nearly all rows. Where few rows are late,
    and not those that are simulated so, what is right row by row leaves all as they are: then it is
    the one by which as many rows lie as late.
    """
    recorded = _recorded(search, rows)
    assert recorded is not None
    edges = USUAL.edges_ns(recorded)
    made = {one: _edges_of(search, rows, (*beside, one)) for one in _forms()}
    best = min(made, key=lambda one: _off(*made[one], edges))
    bare = _edges_of(search, rows, beside)
    if np.nanmax(np.abs(np.subtract(made[best], bare))) < PULSE_NS:
        best = min(made, key=lambda one: _off_together(*made[one], edges))
    return best


def _forms() -> tuple[LateDetection, ...]:
    """Return the thresholds that are tried, of noise and of the peak."""
    of_noise = (LateDetection(rise, 0.0) for rise in LATE_RISES_DB)
    return (*of_noise, *(LateDetection(0.0, part) for part in LATE_FRACTIONS))


def _edges_of(search: Search, rows: View, added: Added) -> tuple[Floats, Floats]:
    """Return where first edges of two simulated versions rise, in ns after their indices [n]."""
    made = [_simulated(search, rows, added, number) for number in range(2)]
    one, two = (USUAL.edges_ns(each) for each in made if each is not None)
    return one, two


def _off(one: Floats, two: Floats, edges: Floats) -> float:
    """Return the summed CRPS of two versions [n], in ns."""
    apart = (np.abs(one - edges) + np.abs(two - edges) - np.abs(one - two)) / 2
    return float(np.nansum(apart))


def _off_together(one: Floats, two: Floats, edges: Floats) -> float:
    """Return how far all edges of two versions are off, whichever rows have them, in ns."""
    levels = (np.arange(len(edges)) + 0.5) / len(edges)
    seen, made = np.nanquantile(edges, levels), np.nanquantile(np.r_[one, two], levels)
    return float(np.abs(seen - made).sum())


def with_late(search: Search, late: LateDetection, choice: WaveChoice) -> WaveChoice:
    """Return a set of waveform effects with the late detection in it, as indices have it.

    A set is fitted to what follows the index, which hardly tells how late that is.
    """
    beside = without(choice.added, late)
    made = fitted_late(search, compared_rows(search), beside)
    return replace(choice, added=swapped(choice.added, made))


def holds(search: Search, late: LateDetection, choice: WaveChoice) -> bool:
    """Return whether first paths are found late beside all other effects of a set, too.

    Not where waveforms hold what no effect explains: that may move edges. Rays of a set that meet
    the straight one reshape the pulse of every link otherwise, which moves an index by the part of
    a pulse that a receiver times. No index of a plain pulse tells that part, so beside these paths
    must be late however they are timed.
    """
    if choice.unlisted:
        return False
    rest = without(choice.added, late)
    seen = seen_beside(search, compared_rows(search), rest)
    ways = TIMED if any(isinstance(one, MEET) for one in rest) else ()
    return all(_late(seen, one) for one in (USUAL, *ways))


def moved(search: Search, choice: WaveChoice) -> bool:
    """Return whether first paths are found elsewhere than beside a set, and ranges follow.

    Then what is off in ranges lies in where a path is found, and is no delay, clock or scale.
    """
    seen = seen_beside(search, compared_rows(search), choice.added)
    found = seen.late_by() if seen else None
    return found is not None and found.moved
