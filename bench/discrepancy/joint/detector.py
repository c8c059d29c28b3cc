"""Which detector found the first paths of simulated rows: how loud a path it asks, how it times it.

Receivers time a leading edge at a part of its first maximum or of the highest one, where it rises
through their threshold, which goes with the noise, or the centre of weight of the pulse (Falsi et
al. 2006; Guvenc and Sahinoglu 2005). Which of these, simulated indices tell: with the right one
they lie at one place in all rows. Recorded records that are asked with it show what this detector
makes of them, whatever happened to the pulse.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.records import Samples
from bench.discrepancy.joint.settings import (
    CENTRE_SAMPLES,
    CROSSED_NOISE,
    DEAF_TIMES,
    EDGE_AT,
    EDGE_EARLY_NS,
    EDGE_OF_NOISE,
    EDGE_OF_PEAK,
    EDGE_PARTS,
    EDGE_SPARE_NS,
    EDGE_WRONG_NS,
)
from bench.physics.units import Floats


@dataclass(frozen=True)
class Heard:
    """Samples about detected paths, and the noise [n] of a component of them, NaN where unknown.

    In the same unit: what is logged, how magnitudes of noise scatter, is 0.66 of that.
    """

    samples: Samples
    noise: Floats


@dataclass(frozen=True)
class Detector:
    """Finds the first edge of every record, again.

    A sample `of_noise` times the noise and `of_peak` of the highest one is a path. It is timed `at`
    a part of its first maximum, or of the highest one (`of_highest`), and no lower than at what
    makes it a path where that is its threshold (`crossed`); with none, at the centre of its weight.
    """

    of_noise: float = EDGE_OF_NOISE
    of_peak: float = EDGE_OF_PEAK
    at: float | None = EDGE_AT
    of_highest: bool = False
    crossed: bool = False

    def edges_ns(self, heard: Heard) -> Floats:
        """Return where the first edge of every record rises, in ns after its index [n]."""
        magnitude, delay = np.nan_to_num(np.abs(heard.samples[0])), heard.samples[1]
        least = self._least(magnitude, heard.noise)
        top = _tops(magnitude, least)
        if self.at is None:
            return _centres_ns(magnitude, delay, top)
        first = magnitude[np.arange(len(top)), top]
        whole = magnitude.max(axis=1) if self.of_highest else first
        level = np.fmax(self.at * whole, least) if self.crossed else self.at * whole
        return _risen_ns(magnitude, delay, top, np.minimum(level, first))

    def _least(self, magnitude: Floats, noise: Floats) -> Floats:
        """Return from what magnitude [n] on a sample is a path."""
        peak = magnitude.max(axis=1)
        return np.asarray(np.minimum(np.fmax(self.of_noise * noise, self.of_peak * peak), peak))


def _tops(magnitude: Floats, least: Floats) -> NDArray[np.intp]:
    """Return the sample [n] of the first maximum of at least so much [n]."""
    above = np.argmax(magnitude >= least[:, None], axis=1)
    falls = np.hstack([magnitude[:, 1:] <= magnitude[:, :-1], np.ones((len(least), 1), bool)])
    after = np.arange(magnitude.shape[1]) >= above[:, None]
    return np.asarray(np.argmax(falls & after, axis=1))


USUAL = Detector()
TIMED = (
    *(Detector(at=part, of_highest=highest) for highest in (False, True) for part in EDGE_PARTS),
    Detector(at=None),
)
CROSSED = tuple(
    Detector(of_noise=times, of_peak=0.0, at=0.0, crossed=True) for times in CROSSED_NOISE
)


def learned(versions: Sequence[Heard]) -> Detector:
    """Return the detector by which indices of simulated rows lie most at one place."""
    return min((USUAL, *TIMED, *CROSSED), key=lambda one: _off_ns(one, versions))


def as_deaf(told: Detector, versions: Sequence[Heard], recorded: Heard) -> tuple[Detector, ...]:
    """Return the deafest detectors, by noise and by peak, that find the same in simulated rows.

    Among them one that times a path at a threshold which goes with the noise, where that is higher.

    How deaf one is shows only by what it passes over. But none is deafer than the one that made the
    recorded indices: where these lie before what it would find, it found that path.
    """
    by_noise = [replace(told, of_noise=told.of_noise * times) for times in DEAF_TIMES]
    by_peak = [replace(told, of_peak=told.of_peak * times) for times in DEAF_TIMES]
    by_peak = [one for one in by_peak if one.of_peak < 1]
    least = _off_ns(told, versions) + EDGE_SPARE_NS
    early = _passed_ns(told, recorded) + EDGE_EARLY_NS

    def able(one: Detector) -> bool:
        return _off_ns(one, versions) <= least and _passed_ns(one, recorded) <= early

    crossed = [replace(told, of_noise=times, crossed=True) for times in CROSSED_NOISE]
    ways = [list(filter(able, way)) for way in (by_noise, by_peak, crossed)]
    return tuple(way[-1] for way in ways if way)


def _passed_ns(detector: Detector, heard: Heard) -> float:
    """Return how long before the edges of a detector the indices of rows lie in the mean, in ns.

    Another path counts `EDGE_WRONG_NS`.
    """
    return float(np.nanmean(np.clip(detector.edges_ns(heard), 0.0, EDGE_WRONG_NS)))


def _off_ns(detector: Detector, versions: Sequence[Heard]) -> float:
    """Return how far edges of versions lie from their median place in the mean, in ns.

    Another path counts `EDGE_WRONG_NS`.
    """
    edges = np.concatenate([detector.edges_ns(one) for one in versions])
    apart = np.abs(edges - np.nanmedian(edges))
    return float(np.nanmean(np.minimum(apart, EDGE_WRONG_NS)))


def _risen_ns(magnitude: Floats, delay: Floats, top: NDArray[np.intp], level: Floats) -> Floats:
    """Return where magnitudes [n, K] last rise through a level [n] before their top, in ns."""
    rows, places = np.arange(len(top)), np.arange(magnitude.shape[1])
    below = (magnitude <= level[:, None]) & (places < top[:, None])
    low = np.where(below, places, 0).max(axis=1)
    high = np.minimum(low + 1, len(places) - 1)
    step = np.maximum(magnitude[rows, high] - magnitude[rows, low], 1e-12)
    part = np.clip((level - magnitude[rows, low]) / step, 0, 1)
    return np.asarray(delay[rows, low] + part * (delay[rows, high] - delay[rows, low]))


def _centres_ns(magnitude: Floats, delay: Floats, top: NDArray[np.intp]) -> Floats:
    """Return the centres of weight of the power about the tops, in ns."""
    about = top[:, None] + np.arange(-CENTRE_SAMPLES, CENTRE_SAMPLES + 1)
    about = np.clip(about, 0, magnitude.shape[1] - 1)
    power = np.take_along_axis(magnitude, about, axis=1) ** 2
    weight = power.sum(axis=1)
    centre = (power * np.take_along_axis(delay, about, axis=1)).sum(axis=1)
    return np.asarray(centre / np.where(weight > 0, weight, np.nan))
