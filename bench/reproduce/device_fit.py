"""Predicting each row of the paper's device table by coefficients that never saw it.

The model of `bench.measure.estimate`: t0 + kernels x launch cycles / clock + arithmetic. Its
clocks, t0 and arithmetic are the profiles' and small beside the launches (but for t0 of the Edge
TPU); the launch cycles are fitted, and shared where they should be: by all rows of one runtime on
one kind of host, times one factor for half precision and one for 8 bits. Power is the mean of the
device's other rows. A row alone with its runtime is not predicted and says so.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from bench.measure.estimate import Call, latency_us
from bench.measure.profile import Profile

PRIOR_SPREAD = 0.3
"""Standard deviation of a precision's factor around 1, as a natural logarithm."""
ROW_SPREAD = 0.1
"""The same of a row around the model: runtimes are not alike from kernel to kernel."""
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Printed:
    """One row of the paper's table with what the model needs: profile in its mode, and the call."""

    device: str
    mode: str
    optimised: bool
    precision: str
    latency_ms: float
    power_w: float
    profile: Profile
    call: Call
    batch4: Call
    runtime: str

    @property
    def name(self) -> tuple[str, str, str]:
        """Device (with mode), graph, precision: the label of the row."""
        device = f"{self.device}, {self.mode}" if self.mode else self.device
        return device, "optimised" if self.optimised else "as trained", self.precision


@dataclass(frozen=True)
class Prediction:
    """What the other rows say of one row; None where no other row says anything."""

    latency_ms: float | None
    latency4_ms: float | None
    power_w: float | None
    reason: str = ""


def leave_one_out(rows: Sequence[Printed]) -> list[Prediction]:
    """Return the prediction of every row from all others."""
    return [_predict(row, [other for other in rows if other is not row]) for row in rows]


def _predict(row: Printed, others: Sequence[Printed]) -> Prediction:
    same = [other for other in others if other.runtime == row.runtime]
    if not same:
        reason = f"the only row of its runtime ({row.runtime}): nothing else in the table tells it"
        return Prediction(None, None, _power(row, others), reason)
    fitted = _fit(others)
    one, four = (_latency_ms(row, call, fitted) for call in (row.call, row.batch4))
    return Prediction(one, four, _power(row, others))


def _power(row: Printed, others: Sequence[Printed]) -> float | None:
    """Return the mean power of the device's other rows: those in its mode, else all of them."""
    device = [other for other in others if other.device == row.device]
    nearest = [other for other in device if other.mode == row.mode] or device
    return float(np.mean([other.power_w for other in nearest])) if nearest else None


def _fit(rows: Sequence[Printed]) -> Mapping[str, float]:
    """Return the logarithms of the launch cycles by runtime and of the factors by precision."""
    runtimes = sorted({row.runtime for row in rows})
    factors = sorted({_factor(row) for row in rows} - {""})
    names = [*runtimes, *factors]

    def residuals(logs: Floats) -> Floats:
        values = dict(zip(names, logs.tolist(), strict=True))
        off = [
            np.log(_latency_ms(row, row.call, values) / row.latency_ms) / ROW_SPREAD for row in rows
        ]
        return np.array([*off, *(values[name] / PRIOR_SPREAD for name in factors)])

    start = np.array([np.log(2e5)] * len(runtimes) + [0.0] * len(factors))
    found = least_squares(residuals, start)
    return dict(zip(names, found.x.tolist(), strict=True))


def _factor(row: Printed) -> str:
    """Return the name of the row's precision factor: processors widen half floats, GPUs do not."""
    if row.precision == "fp32":
        return ""
    return f"{row.precision} on {'processor' if 'Lite' in row.runtime else 'GPU'}"


def _latency_ms(row: Printed, call: Call, logs: Mapping[str, float]) -> float:
    """Return the model's latency with the fitted launch cycles in place of the profile's."""
    launch = float(np.exp(logs[row.runtime] + logs.get(_factor(row), 0.0)))
    values = {k: v for k, v in row.profile.values().items() if not k.startswith("launch_cycles")}
    return latency_us({**values, "launch_cycles": launch}, call) / 1000
