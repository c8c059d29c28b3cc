"""Short filters along the samples of a waveform."""

from __future__ import annotations

import numpy as np

from bench.physics.units import Complexes, Floats, Reals


def convolved(waveform: Complexes, taps: Floats) -> Complexes:
    """Return `waveform` [n, S] filtered with 2R + 1 real taps, the middle one at lag zero."""
    reach = len(taps) // 2
    padded = np.pad(waveform, ((0, 0), (reach, reach))).view(np.float32)
    return _weighted(padded, taps[::-1].astype(np.float32), waveform.shape)


def delayed(waveform: Complexes, by_samples: float) -> Complexes:
    """Return `waveform` [n, S] later by a positive number of samples (cubic Lagrange between)."""
    whole = int(np.floor(by_samples))
    taps = lagrange(np.asarray(by_samples - whole))
    padded = np.pad(waveform, ((0, 0), (whole + 2, 1))).view(np.float32)
    return _weighted(padded, taps[::-1], waveform.shape)


def _weighted(padded: Reals, weights: Reals, shape: tuple[int, ...]) -> Complexes:
    """Return sum_k weights[k] x the columns from k on; `padded` holds parts side by side."""
    made = np.zeros((shape[0], 2 * shape[1]), np.float32)
    part = np.empty_like(made)
    for lag, weight in enumerate(weights):
        made += np.multiply(padded[:, 2 * lag : 2 * lag + made.shape[1]], weight, out=part)
    return made.view(np.complex64)


def lagrange(fraction: Floats) -> Reals:
    """Return cubic Lagrange weights [4, ..] of lags -1, 0, 1, 2 for delays of 0 to 1 sample."""
    f = np.asarray(fraction, np.float64)
    weights = [
        -f * (f - 1) * (f - 2) / 6,
        (f + 1) * (f - 1) * (f - 2) / 2,
        -(f + 1) * f * (f - 2) / 2,
        (f + 1) * f * (f - 1) / 6,
    ]
    return np.array(weights, np.float32)


def filtered(noise: Complexes, taps: Floats) -> Complexes:
    """Return `noise` [n, S] through a causal filter, circular along the samples."""
    wrapped = np.concatenate([noise[:, len(noise[0]) - len(taps) + 1 :], noise], axis=1)
    return _weighted(wrapped.view(np.float32), taps[::-1].astype(np.float32), noise.shape)


def moving_average(lags: Floats, passes: int = 4096) -> Floats:
    """Return the minimum-phase taps whose autocorrelation at lags 0, 1, .. is 1, `lags`.

    By the cepstrum of the spectrum 1 + 2 sum r_k cos(k w), floored at 1e-3 of its mean.
    """
    angle = 2 * np.pi * np.arange(passes) / passes
    spectrum = 1 + 2 * sum(r * np.cos((k + 1) * angle) for k, r in enumerate(lags))
    cepstrum = np.fft.ifft(np.log(np.maximum(spectrum, 1e-3)) / 2).real
    fold = np.zeros(passes)
    fold[0], fold[1 : passes // 2] = cepstrum[0], 2 * cepstrum[1 : passes // 2]
    fold[passes // 2] = cepstrum[passes // 2]
    taps = np.fft.ifft(np.exp(np.fft.fft(fold))).real[: len(lags) + 1]
    return np.asarray(taps / np.sqrt(np.sum(taps**2)))
