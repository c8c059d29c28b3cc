"""Short filters along the samples of a waveform."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bench.physics.loops import compiled, filter_rows, parts
from bench.physics.units import Complexes, Floats, Reals

FAINT = 0.02  # of its start, below which what rings on is nothing


def convolved(waveform: Complexes, taps: Floats) -> Complexes:
    """Return `waveform` [n, S] filtered with 2R + 1 real taps, the middle one at lag zero."""
    lags = np.arange(len(taps)) - len(taps) // 2
    return filtered(waveform, lags, np.asarray(taps))


def filtered(waveform: Complexes, lags: NDArray[np.intp], taps: Floats | Complexes) -> Complexes:
    """Return the sum over taps of tap x `waveform` [n, S] later by its lag in samples."""
    made = np.empty((len(waveform), 2 * waveform.shape[1]), np.float32)
    real, imag = (np.asarray(part, np.float32) for part in (np.real(taps), np.imag(taps)))
    compiled(filter_rows)(made, parts(waveform), np.asarray(lags, np.intp), real, imag)
    return made.view(np.complex64)


def echo_taps(
    delay_samples: float, factor: complex | NDArray[np.complex128], again: complex = 0.0
) -> tuple[NDArray[np.intp], Complexes]:
    """Return lags and taps of a waveform plus `factor` times itself later by some samples.

    Of some factors, each is a sample later than the one before. The echo comes again after as many
    samples, `again` times as large (below 1), as long as it is above a fiftieth of the first.
    """
    often = 1 + int(np.log(FAINT) / np.log(abs(again))) if abs(again) > FAINT else 1
    one = np.atleast_1d(factor)
    every = [_late(k * delay_samples, again ** (k - 1) * one) for k in range(1, often + 1)]
    lags = np.concatenate([[0], *(lags for lags, _ in every)])
    return lags, np.concatenate([[1.0], *(taps for _, taps in every)]).astype(np.complex64)


def _late(
    delay_samples: float, factors: NDArray[np.complex128]
) -> tuple[NDArray[np.intp], Complexes]:
    """Return lags and taps of `factors` times a waveform, later by some samples."""
    whole = int(np.floor(delay_samples))
    taps = np.convolve(lagrange(np.asarray(delay_samples - whole)), factors)
    return whole - 1 + np.arange(len(taps)), taps.astype(np.complex64)


def decaying(samples: float, turns: float) -> NDArray[np.complex128]:
    """Return an oscillation of energy 1 that falls to 1/e in `samples`, with `turns` in each [k].

    As far as it is above a fiftieth of its start; a single 1 where it falls at once.
    """
    count = int(np.ceil(-np.log(FAINT) * samples))
    rates = -1 / max(samples, 1e-9) + 2j * np.pi * turns
    rung = np.exp(rates * np.arange(max(count, 1)))
    return np.asarray(rung / np.sqrt((np.abs(rung) ** 2).sum()))


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


def coloured(noise: Complexes, lags: Floats) -> Complexes:
    """Return white `noise` [n, S] with the autocorrelation `lags` at lags 1, 2, ..; same power.

    The first samples take their past from the row's last ones.
    """
    taps = _moving_average(tuple(np.asarray(lags, np.float64).tolist()))
    made = filtered(noise, np.arange(len(taps)), taps)
    for lag in range(1, len(taps)):
        made[:, :lag] += np.float32(taps[lag]) * noise[:, -lag:]
    return made


@lru_cache(maxsize=64)
def _moving_average(lags: tuple[float, ...]) -> Floats:
    """Return `moving_average`, remembered: not to be written into."""
    return moving_average(np.array(lags))


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
