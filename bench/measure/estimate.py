"""Latency and energy of one call on a device that is not here: an ESTIMATE from its profile.

    cycles  = sum over layers of MACs / macs_per_cycle(kind, type)
              + outputs x cycles_per_output(kind, type) + reads x cycles_per_read(kind, type)
              + inputs x cycles_per_input
    latency = fit_factor x (t0 + kernels x launch_cycles / f_host
                            + (call_cycles + rows x cycles) / f)
    energy  = cycle_energy x latency x f      where the profile knows the energy of a cycle
            = power(precision) x latency      elsewhere (power above idle)

`f_host` is the clock of the processor that launches kernels: the device itself unless the profile
names another. A profile may leave out t0, fit_factor, call_cycles, cycles_per_input and
cycles_per_read. Layers that only move or convert values are no kernels: whether a runtime has them
is an accident of its graph format. The model is linear in batch and knows nothing of caches.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Protocol

from bench.errors import BenchError
from bench.measure.profile import Profile
from bench.results import Estimate, Interval

_BYTES = {"fp32": 4, "fp16": 4, "int8": 1}  # of a value between layers; half weights, full values
_NO_KERNELS = ("convert", "move")
_JOINED = ("activation", "elementwise", "function")
_LIVE_BUFFERS = 3  # a residual block holds its input, its output and the shortcut


class Layer(Protocol):
    """One kernel of a network for one row (`backends.cost.LayerCost`)."""

    @property
    def kind(self) -> str:
        """What it does, as `backends.cost.Kind` names it."""

    @property
    def macs(self) -> int:
        """Multiply-adds."""

    @property
    def outputs(self) -> int:
        """Values written."""

    @property
    def dtype(self) -> str:
        """Type it computes in: "fp32", "fp16" or "int8"."""

    @property
    def reads(self) -> int:
        """Values read that are no constants; of trees the nodes passed."""


class NetworkCost(Protocol):
    """What one call of a network takes (`backends.cost.GraphCost`)."""

    @property
    def layers(self) -> Sequence[Layer]:
        """Its kernels in order."""

    @property
    def weight_bytes(self) -> int:
        """Bytes of weights as stored."""

    @property
    def inputs(self) -> int:
        """Values a row holds."""


Work = Mapping[tuple[str, str], int]


@dataclass(frozen=True)
class Call:
    """What the model needs to know of one call.

    `work` [multiply-adds], `outputs` and `reads` [values] are by (kind, type) of layer.
    """

    precision: str
    rows: int
    kernels: int
    inputs: int = 0
    work: Work = field(default_factory=dict)
    outputs: Work = field(default_factory=dict)
    reads: Work = field(default_factory=dict)


Values = Mapping[str, float]


def estimate(profile: Profile, cost: NetworkCost, precision: str, rows: int = 1) -> Estimate:
    """Return latency (us) and energy (mJ) of one call with `rows` rows, with low and high.

    `precision` is the artifact's ("fp32", "fp16", "int8"). Low and high take every coefficient to
    the ends of its range, one at a time, and add what that changes in quadrature: the ranges are
    independent judgements, not all wrong the same way at once. Where the device cannot run the
    network the figures are None and `reason` says why. Raises BenchError where the profile lacks a
    coefficient.
    """
    if reason := unsuitable(profile, cost, precision):
        return Estimate(profile.name, None, None, reason)
    call = call_of(cost, precision, rows)
    return Estimate(
        device=profile.name,
        latency_us=_with_range(profile, lambda values: latency_us(values, call)),
        energy_mj=_with_range(profile, lambda values: energy_mj(values, call)),
    )


def energy_of(profile: Profile, precision: str, measured_us: float) -> Interval:
    """Return the energy (mJ) of a call whose latency was measured: still an estimate."""
    call = Call(precision, 1, 0)
    return _with_range(profile, lambda values: _energy(values, call, measured_us))


def call_of(cost: NetworkCost, precision: str, rows: int = 1) -> Call:
    """Return what one call with `rows` rows takes."""
    work, outputs, reads = (
        _sums(cost.layers, count)
        for count in (lambda one: one.macs, lambda one: one.outputs, lambda one: one.reads)
    )
    kernels = _kernels(cost.layers, precision)
    return Call(precision, rows, kernels, cost.inputs, work, outputs, reads)


def _sums(layers: Sequence[Layer], count: Callable[[Layer], int]) -> Work:
    """Return what layers of each kind and type have together, without those that have nothing."""
    found: dict[tuple[str, str], int] = {}
    for layer in layers:
        if number := count(layer):
            key = (layer.kind, layer.dtype)
            found[key] = found.get(key, 0) + number
    return found


def latency_us(values: Values, call: Call) -> float:
    """Return the model's latency in microseconds; a cycle at 1 MHz is a microsecond."""
    clock = _find(values, "frequency_mhz")
    launches = call.kernels * _find(values, "launch_cycles", call.precision)
    cycles = values.get("call_cycles", 0.0) + call.rows * _row_cycles(values, call)
    taken_us = values.get("t0_us", 0.0) + launches / values.get("host_mhz", clock) + cycles / clock
    return taken_us * values.get("fit_factor", 1.0)


def _row_cycles(values: Values, call: Call) -> float:
    cycles = call.inputs * values.get("cycles_per_input", 0.0)
    for parts, macs in call.work.items():
        cycles += macs / _find(values, "macs_per_cycle", *parts)
    for parts, number in call.outputs.items():
        cycles += number * _find(values, "cycles_per_output", *parts)
    for parts, number in call.reads.items():
        cycles += number * (_found(values, "cycles_per_read", *parts) or 0.0)
    return cycles


def energy_mj(values: Values, call: Call) -> float:
    """Return the model's energy in millijoules."""
    return _energy(values, call, latency_us(values, call))


def unsuitable(profile: Profile, cost: NetworkCost, precision: str) -> str | None:
    """Return why the device cannot run the network at that precision, or None."""
    if precision not in profile.precisions:
        return f"runs {', '.join(profile.precisions)} only"
    weighted = [layer for layer in cost.layers if layer.macs]
    floats = sum(layer.dtype != "int8" for layer in weighted)
    if profile.integer_only and floats:
        return f"{floats} of {len(weighted)} layers with weights are not 8-bit"
    return _too_big(profile, "flash", _flash_kib(profile, cost)) or _too_big(
        profile, "RAM", _ram_kib(profile, cost, precision)
    )


def _kernels(layers: Sequence[Layer], precision: str) -> int:
    """Return how many kernels a runtime launches.

    A half-precision file still holds its activations apart, but every runtime joins them to the
    weighted layer before them on loading.
    """
    launched = [layer for layer in layers if layer.kind not in _NO_KERNELS]
    joined = 0
    if precision == "fp16":
        pairs = pairwise(launched)
        joined = sum(bool(a.macs) and b.kind in _JOINED for a, b in pairs)
    return len(launched) - joined


def _energy(values: Values, call: Call, taken_us: float) -> float:
    if "cycle_energy_pj" in values:
        return values["cycle_energy_pj"] * taken_us * values["frequency_mhz"] * 1e-9
    return _find(values, "power_w", call.precision) * taken_us * 1e-3


def _find(values: Values, name: str, *parts: str) -> float:
    """Return the most specific coefficient. Raises BenchError where the profile has none."""
    if (found := _found(values, name, *parts)) is None:
        raise BenchError(f"the device profile has no {'.'.join((name, *parts))!r} to estimate with")
    return found


def _found(values: Values, name: str, *parts: str) -> float | None:
    """Return the most specific coefficient: "name.conv.int8", then "name.int8", then "name"."""
    names = (".".join((name, *parts[start:])) for start in range(len(parts) + 1))
    return next((values[one] for one in names if one in values), None)


def _with_range(profile: Profile, model: Callable[[Values], float]) -> Interval:
    values = profile.values()
    middle = model(values)
    below = above = 0.0
    for name, entry in profile.coefficients.items():
        ends = [model({**values, name: end}) - middle for end in (entry.low, entry.high)]
        below += min(*ends, 0.0) ** 2
        above += max(*ends, 0.0) ** 2
    return Interval(middle, max(middle - math.sqrt(below), 0.0), middle + math.sqrt(above))


def _flash_kib(profile: Profile, cost: NetworkCost) -> float:
    return cost.weight_bytes / 1024 + (profile.value("code_kib") or 0.0)


def _ram_kib(profile: Profile, cost: NetworkCost, precision: str) -> float:
    largest = sorted((layer.outputs for layer in cost.layers), reverse=True)[:_LIVE_BUFFERS]
    return sum(largest) * _BYTES[precision] / 1024 + (profile.value("runtime_ram_kib") or 0.0)


def _too_big(profile: Profile, what: str, needed_kib: float) -> str | None:
    has_kib = profile.value(f"{what.lower()}_kib")
    if has_kib is None or needed_kib <= has_kib:
        return None
    return f"needs about {needed_kib:.0f} KiB of {what}, has {has_kib:.0f}"
