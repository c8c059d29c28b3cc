"""The noise of another simulator's CIRs where signals grow stronger or weaker.

A table's samples hold signal and noise. What makes the signal weaker on its way leaves the noise
of the receiver as it is: as much as was scaled away is added. Where the signal grows, samples are
scaled by how much of them is signal (Wiener 1949). Where a first path is taken away or comes later
the noise of the samples it was in stays, too.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from bench.physics.batch import Batch
from bench.physics.units import Complexes, Floats, Reals, absolute

PULSE = 3  # samples that a pulse has at least
LOUD = 3.3  # times the noise's power, from where these are one: noise is so in 3 of 1000 cases
QUIET = 15  # samples over which a tail stays as it is: the mean of noise varies by a quarter there


def with_own_noise(
    waveform: Complexes,
    gain: Floats,
    noise_power: Floats,
    drawn: Complexes,
    first: Floats,
    left: Reals | None = None,
) -> Complexes:
    """Return waveforms [n, S] with the noise they had before `gain` [n] scaled it along.

    `noise_power` [n] is the mean |noise|^2 of a sample before, `drawn` [n, S] noise of power one,
    `first` [n] the sample of the first path, ahead of which there is no tail; `left` [n, S]: what
    effects left of the noise of every sample, in amplitude, None for all. Rows of gain one of which
    all is left stay as they are.
    """
    known = np.isfinite(gain) & (np.abs(gain - 1) > 1e-4)
    louder = known & (gain > 1)
    kept = np.where(known & (gain < 1), gain, 1.0)[:, None]
    kept = kept if left is None else kept * left
    less = (kept < 1).any(axis=1)
    if not (louder | less).any():
        return waveform
    out, size = waveform.copy(), absolute(waveform[louder])
    factor = _factor(size, gain[louder] ** 2, noise_power[louder], first[louder])
    out[louder] *= factor.astype(np.float32)
    away = np.sqrt((1 - kept[less] ** 2) * noise_power[less, None]).astype(np.float32)
    out[less] += drawn[less] * away
    return out


def louder_by(batch: Batch, edge: Complexes | None) -> Floats:
    """Return by how much effects scaled all of every row [n], from its `edge` before (0: one)."""
    if edge is None or batch.free_gain is None:
        return np.ones(len(batch))
    before, after = absolute(edge).astype(np.float64), absolute(batch.free_gain)
    return np.asarray(np.divide(after, before, out=np.ones(len(batch)), where=before > 0))


def unit_noise(peaks: Floats, samples: int) -> Complexes:
    """Return complex noise of power one [n, samples], of rows whose highest samples are `peaks`.

    Other rows get other noise, the same rows always the same.
    """
    finite = np.nan_to_num(peaks)
    seed = np.frombuffer(np.ascontiguousarray(finite).tobytes(), np.uint32)
    parts = np.random.default_rng(seed).normal(size=(len(peaks), samples, 2)) / np.sqrt(2)
    return np.asarray(parts[..., 0] + 1j * parts[..., 1], np.complex64)


def _factor(size: Reals, ratio: Floats, noise_power: Floats, first: Floats) -> Floats:
    """Return what gives samples of magnitude `size` [n, S] the noise again, by power ratio [n]."""
    scaled = (ratio * noise_power)[:, None]
    signal = _signal(size.astype(np.float64) ** 2, scaled, first)
    whole = signal + scaled
    return np.asarray(np.sqrt((signal + noise_power[:, None]) / np.maximum(whole, 1e-12)))


def _signal(power: Floats, noise_power: Floats, first: Floats) -> Floats:
    """Return the power of the signal in every sample [n, S], beside noise of a power [n, 1].

    What few samples have beyond the noise is the chance of noise in every second window: it counts
    where it is a pulse; at its feet, what a sample has. Of a tail counts what more samples have, as
    far as there may be one. Both are shrunk by what noise varies (James and Stein 1961).
    """
    near, loud = _beside(power, PULSE), LOUD * noise_power
    tail = _sure(_beside(power, QUIET) - noise_power, noise_power / np.sqrt(QUIET))
    tail *= ~(np.arange(power.shape[1]) < first[:, None])  # where unknown, anywhere
    foot = maximum_filter1d(near, 2 * PULSE - 1, axis=1) > loud
    beside = np.where(foot, np.maximum(_sure(power - noise_power, noise_power), tail), tail)
    return np.where(near > loud, near - noise_power, beside)


def _sure(more: Floats, varies: Floats) -> Floats:
    """Return what is more than by chance, which varies so much, shrunk by that."""
    return np.maximum(more - varies**2 / np.maximum(more, 1e-12), 0) * (more > 0)


def _beside(power: Floats, width: int) -> Floats:
    """Return the mean power [n, S] of the samples up to each, or from it on: of the quieter ones.

    What lies ahead of a pulse is none of it.
    """
    half = width // 2
    before, after = (
        uniform_filter1d(power, width, axis=1, mode="reflect", origin=at) for at in (half, -half)
    )
    return np.minimum(before, after)
