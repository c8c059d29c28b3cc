"""Figures over seeds: the mean, and how far the mean can be trusted."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from statistics import fmean, stdev

from reports.load import Estimate, Interval, Run, Score, Size


@dataclass(frozen=True)
class SeedMean:
    """The mean over seeds of one figure, with both of its uncertainties.

    `low`..`high` is the 95 % interval over links (the seeds' intervals, ends averaged);
    `seed_half` half the width of the 95 % interval of the mean over seeds (Student's t), None
    for one seed.
    """

    value: float
    low: float | None = None
    high: float | None = None
    seed_half: float | None = None


@dataclass(frozen=True)
class Accuracy:
    """A `Score` over seeds. `raw_` is before mitigation; metres."""

    rows: int
    links: int
    mae_m: SeedMean
    r2: SeedMean
    sigma_m: SeedMean
    bias_m: float
    raw_mae_m: float
    raw_sigma_m: float


def over_seeds(figures: Sequence[Interval]) -> SeedMean:
    """Return the mean of one figure over seeds. `figures` holds at least one."""
    values = [figure.value for figure in figures]
    return SeedMean(
        fmean(values),
        _mean_if_all(figure.low for figure in figures),
        _mean_if_all(figure.high for figure in figures),
        _half_width(values),
    )


def accuracy_over_seeds(scores: Sequence[Score | None]) -> Accuracy | None:
    """Return the accuracy over seeds, None where no seed was scored on such rows."""
    known = [score for score in scores if score is not None]
    if not known:
        return None
    return Accuracy(
        rows=known[0].rows,
        links=known[0].links,
        mae_m=over_seeds([score.mae_m for score in known]),
        r2=over_seeds([score.r2 for score in known]),
        sigma_m=over_seeds([score.sigma_m for score in known]),
        bias_m=fmean(score.bias_m for score in known),
        raw_mae_m=fmean(score.raw_mae_m for score in known),
        raw_sigma_m=fmean(score.raw_sigma_m for score in known),
    )


def size_over_seeds(runs: Sequence[Run]) -> Size | None:
    """Return the mean size (an SVM's varies with the seed), None where no run has one."""
    sizes = [run.size for run in runs if run.size is not None]
    if not sizes:
        return None
    return Size(
        fmean(size.file_bytes for size in sizes),
        fmean(size.weight_bytes for size in sizes),
        fmean(size.parameters for size in sizes),
        fmean(size.macs for size in sizes),
    )


def estimates_over_seeds(runs: Sequence[Run]) -> list[Estimate]:
    """Return the mean estimate of every device, in the order the devices first appear."""
    found: dict[str, list[Estimate]] = {}
    for run in runs:
        for estimate in run.estimates:
            found.setdefault(estimate.device, []).append(estimate)
    return [_mean_estimate(device, some) for device, some in found.items()]


def _mean_estimate(device: str, some: Sequence[Estimate]) -> Estimate:
    reasons = [one.reason for one in some if one.reason]
    return Estimate(
        device,
        _mean_interval(some, lambda one: one.latency_us),
        _mean_interval(some, lambda one: one.energy_mj),
        reasons[0] if reasons else None,
        how=" and ".join(dict.fromkeys(one.how for one in some)),
        fits=next((one.fits for one in some if one.fits), None),
    )


def _mean_interval(
    some: Sequence[Estimate], pick: Callable[[Estimate], Interval | None]
) -> Interval | None:
    known = [figure for one in some if (figure := pick(one)) is not None]
    if not known:
        return None
    mean = over_seeds(known)
    return Interval(mean.value, mean.low, mean.high)


def _mean_if_all(values: Iterable[float | None]) -> float | None:
    """Return the mean, None where any value is missing."""
    some = list(values)
    known = [value for value in some if value is not None]
    return fmean(known) if len(known) == len(some) else None


def _half_width(values: Sequence[float]) -> float | None:
    """Return half the 95 % Student-t interval of the mean of independent values."""
    count = len(values)
    if count < 2 or not all(map(math.isfinite, values)):
        return None
    from scipy.special import stdtrit

    return float(stdtrit(count - 1, 0.975)) * stdev(values) / math.sqrt(count)
