"""How the samples that hold nothing but noise scatter within a record: a tone makes them alike.

Before the first path there are some ten samples; behind the last one there may be a hundred. The
mean of the squared power of noise is twice the square of its mean power; a tone of K times its
power beside it takes K^2 / (1 + K)^2 off (Rice 1945), half as much where two tones of one size
beat, and a louder noise nothing. So a set with a tone is likelier, or less likely, than one with a
noise floor of the same power by how much the recorded samples have of that. The square of the mean
is of pairs of samples that are too far apart for the colour of noise to make them alike. Both are
summed over rows, so that the few samples before the path are enough. Where another tool logs by how
much they scatter, that log tells the same (see `quiet_moments`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.records import Record, Samples, recorded_samples, simulated_record
from bench.discrepancy.compare.view import Added
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.observables import NOISE
from bench.discrepancy.joint.carriers import carried
from bench.discrepancy.joint.own_log import logs_scatter
from bench.discrepancy.joint.quiet_moments import (
    early_samples,
    error_of,
    in_part,
    log_moments,
    loud_moments,
    mean_known,
    ratio_of,
)
from bench.discrepancy.joint.settings import (
    CLASS_NATS,
    KEPT,
    MODULATED,
    QUIET_EARLY,
    QUIET_ERROR,
    QUIET_FEWEST,
    QUIET_LOUDER,
    QUIET_MEMBERS,
    QUIET_MOST_NATS,
    QUIET_SMOOTH,
    QUIET_SURE,
    SCATTER_LOGGED,
    STEADY_PARTS,
)
from bench.discrepancy.joint.statistics import Floats, Statistics
from bench.discrepancy.joint.tone_or_noise import scatter_logged, with_floor
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.memory import Memory


@dataclass(frozen=True)
class Heard:
    """Recorded rows: which samples are `quiet` [K], and those before the path beside a log [K].

    None of the latter where no log tells how much noise scatters. `ratios` [m]: that of quiet
    samples, and that of what is logged where something is; `errors` [m]: their standard errors.
    `magnitude` [n, K] as recorded, and of simulated versions as they are (`simulated`).
    """

    quiet: NDArray[np.bool_]
    beside_log: NDArray[np.bool_]
    ratios: Floats
    errors: Floats
    magnitude: Floats
    simulated: Sequence[Floats]

    @cached_property
    def carried(self) -> bool:
        """Whether samples go together as those of many carriers do, which need not be steady."""
        return carried(self.magnitude, self.simulated, self.quiet)


Figures = Sequence[Floats]
"""Moments [n, 2] of the quiet samples of rows, and of what is logged of them where it is."""


class Quiet:
    """What quiet samples say of sets with a tone in them."""

    def __init__(self, given: Statistics) -> None:
        self.given = given
        self._ratios: Memory[Floats] = Memory(KEPT)
        self._heard = self._listened()

    def nats(self, effects: Added) -> float:
        """Return by how much likelier a set is than one with noise in place of its tone, in nats.

        0 where it has none, or where too few samples are quiet.
        """
        floor = with_floor(effects)
        if self._heard is None or floor == effects:
            return 0.0
        before, after = (self._ratio(one, self._heard) for one in (floor, scatter_logged(effects)))
        told = np.abs(before[1:] - 1) < SCATTER_LOGGED  # in simulated samples with effects, too
        some = slice(1 + np.count_nonzero(told))
        left, tone = self._heard.ratios - before, after - before
        nats = agreed(left[some], tone[some], self._heard.errors[some])
        if nats < 0 and self._heard.carried:
            return 0.0
        return min(nats, 0.0) if self._steady_without(effects, self._heard) else nats

    def _steady_without(self, effects: Added, heard: Heard) -> bool:
        """Return whether samples are as steady without a tone: an offset of them makes them so."""
        rest = tuple(one for one in effects if not isinstance(one, NarrowbandInterference))
        return bool(rest) and self._ratio(rest, heard)[0] <= heard.ratios[0] + heard.errors[0]

    def steadier(self, effects: Added) -> bool:
        """Return whether quiet samples are surely more alike than with effects, as of a tone.

        Not where too few samples are quiet.
        """
        heard = self._heard
        if heard is None:
            return False
        return bool(heard.ratios[0] + QUIET_SURE * heard.errors[0] < self._ratio(effects, heard)[0])

    def carries(self, name: str) -> bool:
        """Return whether samples that a noise floor was named for may be carriers'."""
        return name == NoiseFloor.name and self._heard is not None and self._heard.carried

    def _listened(self) -> Heard | None:
        """Return the recorded rows as heard, None where too few samples are quiet."""
        given = self.given
        recorded = recorded_samples(given.comparison, given.rows)
        bare = self._bare() if recorded is not None else []
        if recorded is None or not bare:
            return None
        (magnitude, delay), _ = bare[0]
        early = early_samples(recorded[1]) & early_samples(delay)
        quiet = quiet_samples(*recorded) & quiet_samples(magnitude, delay)
        quiet = quiet if quiet.sum() >= QUIET_FEWEST else early
        if quiet.sum() < QUIET_EARLY:
            return None
        return self._heard_by(quiet, early & logs_scatter(given, bare), recorded, bare)

    def _bare(self) -> list[Record]:
        """Return simulated versions as they are, with what is logged; none without samples."""
        made = (self._record((), number) for number in range(QUIET_MEMBERS))
        return [one for one in made if one is not None]

    def _record(self, added: Added, number: int) -> Record | None:
        given = self.given
        return simulated_record(given.comparison, given.rows, (*given.beside, *added), number)

    def _heard_by(
        self,
        quiet: NDArray[np.bool_],
        beside_log: NDArray[np.bool_],
        recorded: Samples,
        bare: Sequence[Record],
    ) -> Heard:
        """Return recorded rows as heard, with errors of theirs and of simulated rows."""
        logged = numeric(self.given.rows.frame, NOISE)
        ours = _figures((recorded, logged), quiet, beside_log)
        theirs = _figures_of(bare, quiet, beside_log)
        own = [error_of(np.unique(one, axis=0)) for one in theirs]
        links = [self.given.of_links(one) * self.given.count[:, None] for one in ours]  # sums
        square = [error_of(one) ** 2 + QUIET_ERROR**2 for one in links]
        errors = np.hypot(np.sqrt(square), own)
        versions = [magnitude for (magnitude, _), _ in bare]
        return Heard(quiet, beside_log, _ratios(ours), errors, recorded[0], versions)

    def _ratio(self, added: Added, heard: Heard) -> Floats:
        """Return the mean ratios [m] of simulated rows with effects."""
        return self._ratios.get(added, lambda: self._simulated(added, heard))

    def _simulated(self, added: Added, heard: Heard) -> Floats:
        made = [self._record(added, number) for number in range(QUIET_MEMBERS)]
        known = [one for one in made if one is not None]  # all: the bare rows have samples
        return _ratios(_figures_of(known, heard.quiet, heard.beside_log))


def agreed(left: Floats, tone: Floats, errors: Floats) -> float:
    """Return the nats by which ratios [m] that are `left` are a `tone`'s, as `speaks`.

    A tone that is modulated is steady over the few samples of a record, and need not be over the
    many that a log is of: so the second ratio speaks against one only as far as few are. None where
    it surely is one by its log, and surely is none by its samples: neither a steady tone nor noise.
    """
    alone = speaks(left[:1], tone[:1], errors[:1])
    if len(left) == 1:
        return alone
    if alone <= -CLASS_NATS and speaks(left[1:], tone[1:], errors[1:]) >= CLASS_NATS:
        return 0.0
    both = speaks(left, tone, errors)
    return float(np.logaddexp(np.log1p(-MODULATED) + both, np.log(MODULATED) + alone))


def speaks(left: Floats, tone: Floats, errors: Floats) -> float:
    """Return the nats by which ratios [m] that are `left` are a `tone`'s rather than noise's.

    Both as differences from the ratios of noise, `tone` those of a steady tone: of one whose size
    changes within a record a part is seen, any as likely. What is farther on the other side than
    the error says that the error is larger.
    """
    errors, steady = np.maximum(errors, left), np.minimum(tone, 0.0)
    nats = in_part(left, steady, errors, STEADY_PARTS)
    return float(np.clip(nats, -QUIET_MOST_NATS, QUIET_MOST_NATS))


def quiet_samples(magnitude: Floats, delay: Floats) -> NDArray[np.bool_]:
    """Return which samples [K] of rows [n, K] hold noise alone, as those before the path do.

    Those before it, and those from where on the mean power is that of these.
    """
    power, early = mean_known(magnitude**2, 0), early_samples(delay)
    if not early.any():
        return early
    smooth = np.convolve(power, np.full(QUIET_SMOOTH, 1 / QUIET_SMOOTH), "same")
    loud = np.flatnonzero(~early & ~(smooth <= QUIET_LOUDER * power[early].mean()))
    return np.asarray(early | (np.arange(len(power)) > loud.max(initial=early.sum())))


def _figures(record: Record, quiet: NDArray[np.bool_], beside_log: NDArray[np.bool_]) -> Figures:
    """Return what is told of rows: moments of quiet samples, and of what is logged if anything."""
    (magnitude, _), logged = record
    moments = loud_moments(magnitude[:, quiet])
    if not beside_log.any():
        return (moments,)
    return moments, log_moments(magnitude[:, beside_log], logged)


def _figures_of(
    records: Sequence[Record], quiet: NDArray[np.bool_], beside_log: NDArray[np.bool_]
) -> Figures:
    """Return the figures of several versions, one under the other."""
    every = [_figures(one, quiet, beside_log) for one in records]
    return [np.concatenate(one) for one in zip(*every, strict=True)]


def _ratios(figures: Figures) -> Floats:
    return np.array([ratio_of(one) for one in figures])
