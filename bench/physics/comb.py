"""A comb: measured ranges that lie on a grid, found by their phases.

Scatter leaves the phase of a range within a step anywhere; rounding leaves one phase. The length of
the mean phase is tested as Rayleigh (1919) tests directions; rows of a link that stands still count
once, and a grid that the simulated ranges have as well (places on a grid) is none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from bench.physics.units import Floats

STEPS_M = (0.01, 1.0)  # that are looked for: finer ones hide below any scatter
BINS = 8  # of the finest step, in which ranges are counted
FINE = 4  # frequencies per resolution
LONGEST = 1 << 20  # of the transform
NATS = 9.0  # beyond the search over steps: p = 1e-4
COHERENT = 0.3  # least length of the mean phase: else what scatters after the rounding is as large
CLEARER = 2.0  # times the simulated ranges' own
HARMONIC = 0.7  # of the length at the step that was found, that a multiple of it keeps
MULTIPLES = 100  # of the finest step, that the coarsest is
EXACT = (0.999, 6)  # a phase so long on so many links is no accident, however they stand still
ON_POINT = 1e-3  # of a step: how far a range may be from a point that it is
MAD_TO_STD = 1.4826


@dataclass(frozen=True)
class Comb:
    """A grid of ranges: its step, where one of its points lies, the length of the mean phase."""

    step_m: float
    origin_m: float
    coherence: float


def comb(measured_m: Floats, plain_m: Floats, links: NDArray[np.intp]) -> Comb | None:
    """Return the grid that measured ranges [n] lie on and plain ones [n] do not, None without one.

    `plain_m` are the ranges as they would be without it, `links` the codes 0.. of their links.
    """
    if len(measured_m) < 2 or not np.ptp(measured_m) > STEPS_M[0]:
        return None
    span = max(float(np.ptp(measured_m)), float(np.ptp(plain_m)))
    (frequency, length), (_, clear) = (_spectrum(v, span) for v in (measured_m, plain_m))
    found = _fundamental(measured_m, float(frequency[int(np.argmax(length - clear))]))
    own, other = _phase(measured_m, found), _phase(plain_m, found)
    several = links.max() + 1 >= EXACT[1]
    certain = several and abs(other) < EXACT[0] and on_points(measured_m, found, own)
    if abs(own) < max(COHERENT, CLEARER * abs(other)) and not certain:
        return None
    exact = abs(own) > EXACT[0] and several
    tried = np.ptp(measured_m) * (1 / STEPS_M[0] - 1 / STEPS_M[1])
    beyond = (abs(own) * len(measured_m)) ** 2 / _by_chance(measured_m, plain_m, links, found)
    if not exact and beyond - np.log(max(tried, 1.0)) < NATS:
        return None
    origin = float(np.angle(own)) / (2 * np.pi * found)
    return Comb(1 / found, origin, float(abs(own)))


def on_points(values: Floats, frequency: float, phase: complex) -> bool:
    """Return whether all of some values [n], six of them at least, are points of a grid.

    Places that are few and stand still have phases alike by chance, but not as exactly as this.
    """
    off = np.angle(np.exp(2j * np.pi * frequency * values) / phase) / (2 * np.pi)
    return len(np.unique(values)) >= EXACT[1] and bool(np.abs(off).max() < ON_POINT)


def _phase(values: Floats, frequency: float) -> complex:
    """Return the mean phase of values [n] within the period of a frequency."""
    return complex(np.exp(2j * np.pi * frequency * values).mean())


def _spectrum(values: Floats, span_m: float) -> tuple[Floats, Floats]:
    """Return the frequencies of all steps looked for, and the length of the mean phase at each."""
    width = STEPS_M[0] / BINS
    low, high = np.quantile(values, (0.005, 0.995))
    inside = values[(values >= low) & (values <= high)]
    place = np.asarray((inside - inside.min()) / width, np.intp)
    size = 1 << int(np.ceil(np.log2(max(FINE * (span_m / width + 1), 2))))
    size = min(max(size, 1 << 12), LONGEST)
    counted = np.bincount(place[place < size], minlength=size)[:size]
    length = np.abs(np.fft.rfft(counted)) / len(inside)
    every = np.fft.rfftfreq(size, width)
    looked_for = (every >= 1 / STEPS_M[1]) & (every <= 1 / STEPS_M[0])
    return np.asarray(every[looked_for]), np.asarray(length[looked_for], np.float64)


def _fundamental(values: Floats, frequency: float) -> float:
    """Return the lowest frequency that the one found is a multiple of, sharpened.

    Points of an exact grid are those of a coarser one only where they all lie on that.
    """
    best = _sharpened(values, frequency)
    length = abs(_phase(values, best))
    enough = EXACT[0] if length > EXACT[0] else HARMONIC * length
    for multiple in range(MULTIPLES, 1, -1):
        lower = best / multiple
        if lower > 1 / STEPS_M[1] - 1e-9 and abs(_phase(values, lower)) >= enough:
            return _sharpened(values, lower)
    return best


def _sharpened(values: Floats, frequency: float) -> float:
    """Return the frequency near one at which the mean phase is longest."""
    width = 0.5 / float(np.ptp(values))
    sides = (max(frequency - width, 1e-6), frequency + width)

    def shortness(frequency: float) -> float:
        return -abs(_phase(values, frequency))

    made = minimize_scalar(shortness, bounds=sides, options={"xatol": 1e-3 * width})
    return float(made.x)


def _by_chance(
    measured_m: Floats, plain_m: Floats, links: NDArray[np.intp], frequency: float
) -> float:
    """Return the mean squared length of the summed phases where nothing is rounded.

    Phases of one link go together as far as its rows stand still and hardly scatter, and those of
    its rows within one step of each other do: what drifts by less than a step shows no grid.
    """
    count = np.bincount(links).astype(np.float64)
    turned = np.exp(2j * np.pi * frequency * plain_m)
    whole = np.bincount(links, turned.real) ** 2 + np.bincount(links, turned.imag) ** 2
    calm = _within_links(measured_m - plain_m, links)
    kept = float(np.exp(-((2 * np.pi * frequency * calm) ** 2)))
    still = float(count.sum() + kept * np.maximum(whole - count, 0.0).sum())
    places = np.stack([links, np.floor(measured_m * frequency)], axis=1)
    together = np.unique(places, axis=0, return_counts=True)[1].astype(np.float64)
    return max(still, float((together**2).sum()))


def _within_links(left_m: Floats, links: NDArray[np.intp]) -> float:
    """Return the robust scatter of values [n] within links in metres, 0 with one row of each."""
    count = np.bincount(links)
    middle = np.array([np.median(left_m[links == link]) for link in range(len(count))])
    several = (count > 1)[links]
    if not several.any():
        return 0.0
    return MAD_TO_STD * float(np.median(np.abs(left_m - middle[links])[several]))
