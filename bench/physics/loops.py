"""The inner loops of the simulator, compiled by numba when first run.

Each makes one pass over arrays that numpy would walk a dozen times, making temporary arrays whose
fresh memory costs more than the arithmetic. Complex values stand as real and imaginary parts side
by side. They are plain Python functions too, which is how the tests check them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.compiled import compiled as machine_code
from bench.physics.units import Complexes, Floats, Reals

Parts = NDArray[np.float32]
Ints = NDArray[np.intp]


def compiled(loop: Callable[..., None]) -> Callable[..., None]:
    """Return a loop as machine code: what is simulated is finite."""
    return machine_code(loop, finite=True)


def parts(values: Complexes) -> Parts:
    """Return complex values [n, S] as float32 [n, 2 S]: real and imaginary parts side by side."""
    made: Any = np.ascontiguousarray(values, np.complex64).view(np.float32)
    return np.asarray(made)


def add_paths(made: Parts, place: Reals, gain: Parts, pulses: Reals) -> None:
    """Add to `made` [n, 2 S] each path's pulse at `place` [n, P] samples from sample 0."""
    steps, width, samples = pulses.shape[0] - 1, pulses.shape[1], made.shape[1] // 2
    for row in range(place.shape[0]):
        for path in range(place.shape[1]):
            real, imag = gain[row, 2 * path], gain[row, 2 * path + 1]
            at = int(np.floor(place[row, path]))
            first = at - width // 2 + 1
            if (real == 0 and imag == 0) or first < 0 or first + width > samples:
                continue
            step = int((place[row, path] - at) * steps + 0.5)
            for lag in range(width):
                made[row, 2 * (first + lag)] += real * pulses[step, lag]
                made[row, 2 * (first + lag) + 1] += imag * pulses[step, lag]


def add_tail(made: Parts, first: Reals, taps: Parts, pulses: Reals) -> None:
    """Add to `made` [n, 2 S] the pulses of taps [n, 2 G]; tap 0's begins at `first` [n]."""
    steps, width, samples = pulses.shape[0] - 1, pulses.shape[1], made.shape[1] // 2
    for row in range(taps.shape[0]):
        at = int(np.floor(first[row]))
        step = int((first[row] - at) * steps + 0.5)
        for lag in range(width):
            weight = pulses[step, lag]
            low = max(0, -(at + lag))
            high = min(taps.shape[1] // 2, samples - at - lag)
            if high <= low:
                continue
            # Slices from zero on: an index that may be negative keeps the loop from vector code.
            source = taps[row, 2 * low : 2 * high]
            target = made[row, 2 * (low + at + lag) : 2 * (high + at + lag)]
            for part in range(source.shape[0]):
                target[part] += weight * source[part]


def decay_rows(made: Reals, starts: Floats, kept: Floats) -> None:
    """Write to `made` [n, G] the `starts` [n, G], each decaying by `kept` [n] from tap to tap."""
    for row in range(made.shape[0]):
        level = 0.0
        for tap in range(made.shape[1]):
            level = starts[row, tap] + kept[row] * level
            made[row, tap] = level


def filter_rows(made: Parts, values: Parts, lags: Ints, real: Reals, imag: Reals) -> None:
    """Write to `made` [n, 2 S] the sum over taps of (real + i imag) x `values` later by lag."""
    samples = values.shape[1] // 2
    for row in range(values.shape[0]):
        made[row] = 0
        for tap in range(lags.shape[0]):
            lag, a, b = lags[tap], real[tap], imag[tap]
            low, high = max(0, lag), min(samples, samples + lag)
            if high <= low:
                continue
            source, target = values[row, 2 * (low - lag) : 2 * (high - lag)], made[row, 2 * low :]
            if b == 0:
                for part in range(source.shape[0]):
                    target[part] += a * source[part]
                continue
            for at in range(high - low):
                x, y = source[2 * at], source[2 * at + 1]
                target[2 * at] += a * x - b * y
                target[2 * at + 1] += a * y + b * x


def quantise_rows(
    signal: Parts,
    noise: Parts,
    waveform: Parts,
    added: Parts,
    step: float,
    limit: float,
    dropped: float = 0.0,
    beside: float = 0.0,
) -> None:
    """Write to `noise` the rounded `added`, to `signal` what is left of the rounded sum.

    All [n, 2 S]; the sum is `waveform` and rounded noise, rounded and clipped to +-`limit`.
    `dropped`: 0 rounds to the nearest step, 1 towards zero; `beside` 1: to the middle of a step.
    """
    middle = 0.5 * beside
    half = (0.5 - 0.5 * dropped) * (1 - beside)
    for row in range(waveform.shape[0]):
        for part in range(waveform.shape[1]):
            low = added[row, part] / step
            low = step * np.copysign(np.floor(abs(low) + half) + middle, low)
            whole = (waveform[row, part] + low) / step
            whole = step * np.copysign(np.floor(abs(whole) + half) + middle, whole)
            noise[row, part] = low
            signal[row, part] = min(max(whole, -limit), limit) - low


def magnitude_rows(made: Reals, signal: Parts, noise: Parts, sums: Floats) -> None:
    """Write to `made` [n, S] the magnitude of signal + noise [n, 2 S], and what it sums up to.

    `sums` [n, 4]: energy and largest of the magnitude, sum and energy of the noise's magnitude.
    """
    for row in range(made.shape[0]):
        energy = top = total = power = np.float32(0)
        for at in range(made.shape[1]):
            x, y = noise[row, 2 * at], noise[row, 2 * at + 1]
            square = x * x + y * y
            power += square
            total += np.sqrt(square)
            x, y = x + signal[row, 2 * at], y + signal[row, 2 * at + 1]
            square = x * x + y * y
            energy += square
            top = max(top, square)
            made[row, at] = np.sqrt(square)
        sums[row, 0], sums[row, 1], sums[row, 2], sums[row, 3] = energy, np.sqrt(top), total, power


def edge_rows(
    found: Floats,
    magnitude: Reals,
    limit: Floats,
    timed: Floats,
    begin: Ints,
    climb: int,
    part: float,
) -> None:
    """Write to `found` [n] where the first edge of `magnitude` [n, S] above `limit` [n] rises.

    In samples: at a `part` of its peak, which lies at most `climb` samples behind the crossing; of
    the strongest sample where nothing is above. Not below `timed` [n], as far as its peak reaches.
    What lies before sample `begin` [n] is not looked at.
    """
    last = magnitude.shape[1] - 1
    for row in range(magnitude.shape[0]):
        size, top = magnitude[row], -1
        start = min(max(begin[row], 0), last)
        for at in range(start, last + 1):
            if size[at] > limit[row]:
                top = at
                break
        if top < 0:
            top = start + int(np.argmax(size[start:]))
        for _ in range(climb):
            ahead = min(top + 1, last)
            top = ahead if size[ahead] > size[top] else top
        half, upper = max(size[top] * np.float32(part), min(np.float32(timed[row]), size[top])), top
        for _ in range(climb):
            before = max(upper - 1, 0)
            upper = before if size[before] > half else upper
        lower = max(upper - 1, 0)
        rise = max(size[upper] - size[lower], np.float32(1e-20))
        found[row] = lower + min(max((half - size[lower]) / rise, np.float32(0)), np.float32(1))


def crop_rows(made: Reals, values: Reals, start: Ints) -> None:
    """Write to `made` [n, K] the samples of `values` [n, S] from `start` [n] on."""
    for row in range(made.shape[0]):
        made[row] = values[row, start[row] : start[row] + made.shape[1]]


def image_rows(
    length: Floats, factor: Parts, ends: Floats, image: Ints, low: Ints, tables: Parts
) -> None:
    """Write lengths [n, Q] and reflection coefficients [n, 2 Q] of image paths.

    `ends` [n, 9] holds positions of tx, rx and the room's size, `image` [Q, 3] the images, `low`
    [Q] how often each meets the floor, `tables` [3, 2 (T + 1)] the coefficients of side walls,
    floor and ceiling over the cosine of incidence.
    """
    steps, way = tables.shape[1] // 2 - 1, np.zeros(3)
    for row in range(ends.shape[0]):
        for q in range(image.shape[0]):
            total = 0.0
            for axis in range(3):
                m, room = image[q, axis], ends[row, 6 + axis]
                at = ends[row, axis] if m % 2 == 0 else -ends[row, axis]
                way[axis] = at + (m + m % 2) * room - ends[row, 3 + axis]
                total += way[axis] * way[axis]
            far = np.sqrt(total)
            length[row, q] = far
            a, b = 1.0, 0.0
            for axis in range(3):
                step = int(abs(way[axis]) / max(far, 1e-6) * steps + 0.5)
                for hit in range(abs(image[q, axis])):
                    which = 0 if axis < 2 else (1 if hit < low[q] else 2)
                    c, d = tables[which, 2 * step], tables[which, 2 * step + 1]
                    a, b = a * c - b * d, a * d + b * c
            factor[row, 2 * q], factor[row, 2 * q + 1] = a, b
