"""Six hand-crafted features of a CIR, in numpy and as a torch module that exports to ONNX.

Source: S. Marano, W. M. Gifford, H. Wymeersch, M. Z. Win, "NLOS identification and mitigation
for localization based on UWB experimental data", IEEE JSAC 28(7), 2010.

With r the CIR and t the time from the row's first sample:

- energy, sum |r|^2 (counts^2)
- maximum amplitude, max |r| (counts)
- rise time (ns) from the first |r| > 6 sigma_n to the first |r| >= 0.6 max |r|
- mean excess delay tau (ns), sum t |r|^2 / energy
- RMS delay spread (ns), sqrt(sum (t - tau)^2 |r|^2 / energy)
- kurtosis of |r| over the row (3 for a normal distribution)

Noise rule: sigma_n, the noise of one quadrature, is sqrt(mean |r|^2 / 2) over the first
`noise_samples` of the row. With five samples before the detected first path that is four, because
the pulse already rises in the one just before it (1.9 times the noise in the apartment recordings).
Where nothing exceeds 6 sigma_n before 0.6 of the maximum, the rise time is 0. An all-zero row
gives six zeros.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from torch import Tensor, nn

FEATURES = (
    "energy",
    "max_amplitude",
    "rise_time_ns",
    "mean_excess_delay_ns",
    "rms_delay_spread_ns",
    "kurtosis",
)
SAMPLE_PERIOD_NS = 1.0016  # DW1000 accumulator: 1 / (2 x 499.2 MHz)
NOISE_SAMPLES = 4
PEAK_FRACTION = 0.6
NOISE_MULTIPLE = 6.0
_TINY = 1e-20  # keeps divisions finite; CIRs are scaled to a maximum of 1 before it matters


def marano_features(
    cirs: ArrayLike,
    *,
    noise_samples: int = NOISE_SAMPLES,
    peak_fraction: float = PEAK_FRACTION,
    noise_multiple: float = NOISE_MULTIPLE,
    sample_period_ns: float = SAMPLE_PERIOD_NS,
) -> NDArray[np.float64]:
    """Return the six features [n, 6], in the order of FEATURES, of CIRs [n, samples] in counts.

    Raises ValueError unless rows are longer than `noise_samples` and that is at least 1.

    >>> marano_features([[1.0, 1.0, 4.5, 8.0, 4.0, 1.0]], noise_samples=2).round(2).tolist()
    [[103.25, 8.0, 1.0, 2.93, 0.72, 2.22]]
    """
    magnitude = np.abs(np.asarray(cirs, np.float64))
    check_samples(magnitude.shape[-1], noise_samples)
    peak = magnitude.max(1, keepdims=True)
    r = magnitude / np.where(peak > 0, peak, 1)
    time = np.arange(r.shape[1], dtype=np.float64) * sample_period_ns
    floor = noise_multiple * np.sqrt((r[:, :noise_samples] ** 2).mean(1, keepdims=True) / 2)
    delay, spread = _delays(r, time)
    energy = (magnitude**2).sum(1)
    rise = _rise_time(r, time, peak_fraction, floor)
    return np.column_stack([energy, peak[:, 0], rise, delay, spread, _kurtosis(r)])


def _rise_time(
    r: NDArray[np.float64], time: NDArray[np.float64], fraction: float, floor: NDArray[np.float64]
) -> NDArray[np.float64]:
    high = np.where(r >= fraction, time, time[-1]).min(1, keepdims=True)
    low = np.where(r > floor, time, high).min(1, keepdims=True)
    rise: NDArray[np.float64] = np.maximum(high - low, 0)[:, 0]
    return rise


def _delays(
    r: NDArray[np.float64], time: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    power = r**2
    weight = power / np.maximum(power.sum(1, keepdims=True), _TINY)
    delay = weight @ time
    return delay, np.sqrt((weight * (time - delay[:, None]) ** 2).sum(1))


def _kurtosis(r: NDArray[np.float64]) -> NDArray[np.float64]:
    square = (r - r.mean(1, keepdims=True)) ** 2
    variance = np.maximum(square.mean(1) ** 2, _TINY)
    kurtosis: NDArray[np.float64] = (square**2).mean(1) / variance
    return kurtosis


class MaranoFeatures(nn.Module):
    """The six features as a torch module: float32 [n, samples] -> float32 [n, 6].

    Same definitions and errors as `marano_features`; plain operators alone, any batch size.

    >>> MaranoFeatures(6, noise_samples=2)(torch.ones(3, 6)).shape
    torch.Size([3, 6])
    """

    time: Tensor

    def __init__(
        self,
        samples: int,
        *,
        noise_samples: int = NOISE_SAMPLES,
        peak_fraction: float = PEAK_FRACTION,
        noise_multiple: float = NOISE_MULTIPLE,
        sample_period_ns: float = SAMPLE_PERIOD_NS,
    ) -> None:
        super().__init__()
        check_samples(samples, noise_samples)
        self.noise_samples = noise_samples
        self.peak_fraction, self.noise_multiple = peak_fraction, noise_multiple
        time = torch.arange(samples, dtype=torch.float64) * sample_period_ns
        self.register_buffer("time", time.float(), persistent=False)

    def forward(self, x: Tensor) -> Tensor:
        """Return the features [n, 6] of CIRs [n, samples]."""
        magnitude = x.abs()
        peak = magnitude.amax(1, keepdim=True)
        r = magnitude / peak.clamp_min(_TINY)
        power = r * r
        total = power.sum(1, keepdim=True)
        delays = self._delays(power / total.clamp_min(_TINY))
        rise = self._rise_time(r, power)
        return torch.cat([total * peak * peak, peak, rise, *delays, self._kurtosis(r)], 1)

    def _rise_time(self, r: Tensor, power: Tensor) -> Tensor:
        noise = power[:, : self.noise_samples].mean(1, keepdim=True) / 2
        floor = self.noise_multiple * noise.sqrt()
        high = torch.where(r >= self.peak_fraction, self.time, self.time[-1]).amin(1, keepdim=True)
        low = torch.where(r > floor, self.time, high).amin(1, keepdim=True)
        return (high - low).clamp_min(0)

    def _delays(self, weight: Tensor) -> tuple[Tensor, Tensor]:
        delay = (weight * self.time).sum(1, keepdim=True)
        spread = (weight * (self.time - delay) ** 2).sum(1, keepdim=True).sqrt()
        return delay, spread

    @staticmethod
    def _kurtosis(r: Tensor) -> Tensor:
        square = (r - r.mean(1, keepdim=True)) ** 2
        fourth = (square * square).mean(1, keepdim=True)
        return fourth / square.mean(1, keepdim=True).square().clamp_min(_TINY)


def check_samples(samples: int, noise_samples: int) -> None:
    """Raise ValueError unless 1 <= noise_samples < samples."""
    if not 1 <= noise_samples < samples:
        raise ValueError(
            "features need at least one noise sample and more samples than that: "
            f"got n_features = {samples}, noise_samples = {noise_samples}"
        )
