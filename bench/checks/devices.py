"""What every device profile must keep to: figures with a source, and an estimate from them."""

from __future__ import annotations

from dataclasses import dataclass

from bench.checks.expect import expect
from bench.measure.estimate import estimate
from bench.measure.profile import UNITS, Profile

PRECISIONS = ("fp32", "fp16", "int8")


@dataclass(frozen=True)
class _Layer:
    """One convolution of a small network."""

    dtype: str
    kind: str = "conv"
    macs: int = 20_000
    outputs: int = 500
    reads: int = 500


@dataclass(frozen=True)
class _Cost:
    """What one call of a small network takes."""

    layers: tuple[_Layer, ...]
    weight_bytes: int = 6000
    inputs: int = 157


def check_device(profile: Profile) -> None:
    """Check a profile: every figure ordered, sourced and in its unit, and estimates from it."""
    expect(isinstance(profile, Profile), f"got {type(profile).__name__}, expected a Profile")
    expect(bool(profile.name and profile.title), "a profile needs a name and a title")
    known = set(profile.precisions) <= set(PRECISIONS) and bool(profile.precisions)
    expect(known, f"{profile.name}: precisions {profile.precisions}, expected some of {PRECISIONS}")
    for name in profile.coefficients:
        check_coefficient(profile, name)
    for precision in profile.precisions:
        check_estimate(profile, precision)


def check_coefficient(profile: Profile, name: str) -> None:
    """Check one figure of a profile."""
    one, where = profile.coefficients[name], f"{profile.name}: {name}"
    expect(0 <= one.low <= one.value <= one.high, f"{where}: expected 0 <= low <= value <= high")
    expect(one.unit == UNITS.get(name.partition(".")[0]), f"{where}: unit {one.unit!r}")
    expect(bool(one.source), f"{where} has no source")


def check_estimate(profile: Profile, precision: str) -> None:
    """Check that a profile gives a latency with an interval that is a number above zero."""
    cost = _Cost((_Layer(precision), _Layer(precision)))
    found = estimate(profile, cost, precision)
    where = f"{profile.name}, {precision}"
    if found.latency_us is None:
        raise AssertionError(f"{where}: no latency: {found.reason}")
    low, high = found.latency_us.low, found.latency_us.high
    expect(low is not None and high is not None, f"{where}: the latency has no interval")
    ordered = 0 <= (low or 0) <= found.latency_us.value <= (high or 0)
    expect(ordered and found.latency_us.value > 0, f"{where}: latency {found.latency_us}")
