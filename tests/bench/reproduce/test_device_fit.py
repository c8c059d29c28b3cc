"""The device model fitted without a row: exact on its own rows, honest where a row is alone."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from bench.measure.estimate import Call, latency_us
from bench.plugins import load
from bench.reproduce import paper
from bench.reproduce.device_fit import Printed, leave_one_out
from bench.reproduce.experiments.devices import _errors, _rows

KERNELS = {"fp32": 46, "graph": 30, "fp16": 30, "int8": 32}


def costs() -> dict[str, Any]:
    """Return networks of so many kernels, 10 000 multiply-adds each."""
    made = {}
    for backend, kernels in KERNELS.items():
        kind = {"kind": "conv", "macs": 10_000, "outputs": 500, "reads": 500}
        dtype = "fp32" if backend == "graph" else backend
        layers = [SimpleNamespace(**kind, dtype=dtype)] * kernels
        made[backend] = SimpleNamespace(layers=layers, weight_bytes=24_604, inputs=157)
    return made


def made_row(precision: str, kernels: int, cycles: float, runtime: str = "Lite") -> Printed:
    """Return a row whose latency is the model's own for so many cycles per launch."""
    profile = load("devices", "cortex-a53")
    every = ("conv", precision)
    call = Call(precision, 1, kernels, 157, {every: 300_000}, {every: 1000})
    values = {k: v for k, v in profile.values().items() if not k.startswith("launch_cycles")}
    latency = latency_us({**values, "launch_cycles": cycles}, call) / 1000
    return Printed(
        "cortex-a53", "", True, precision, latency, 1.0, profile, call, replace(call, rows=4),
        runtime,
    )  # fmt: skip


def test_rows_that_follow_the_model_are_predicted_from_each_other() -> None:
    rows = [made_row("fp32", kernels, 4e5) for kernels in (20, 30, 46)]
    for row, guess in zip(rows, leave_one_out(rows), strict=True):
        assert guess.latency_ms == pytest.approx(row.latency_ms, rel=1e-3)
        assert guess.latency4_ms is not None
        assert guess.latency4_ms > row.latency_ms
        assert guess.power_w == 1.0


def test_a_row_never_sees_itself() -> None:
    rows = [made_row("fp32", kernels, 4e5) for kernels in (20, 30, 46)]
    odd = [replace(rows[0], latency_ms=100 * rows[0].latency_ms), *rows[1:]]
    before, after = leave_one_out(rows)[0], leave_one_out(odd)[0]
    assert after.latency_ms == before.latency_ms


def test_a_row_alone_with_its_runtime_is_not_predicted() -> None:
    rows = [made_row("fp32", 30, 4e5), made_row("fp32", 20, 4e5), made_row("int8", 32, 1e5, "TPU")]
    guess = leave_one_out(rows)[-1]
    assert guess.latency_ms is None
    assert "the only row of its runtime (TPU)" in guess.reason


def test_the_papers_rows_are_within_a_quarter_at_the_median() -> None:
    rows = _rows(paper.rows("devices"), costs())
    assert len(rows) == 14
    modes = [(row.device, row.precision) for row in rows if row.mode]
    assert modes == [("cortex-a57", "int8"), ("maxwell-128", "fp32"), ("maxwell-128", "fp16")]
    predictions = leave_one_out(rows)
    table = _errors(rows, predictions)
    medians = {row.quantity: row.ours for row in table.rows if row.label[0].startswith("median")}
    assert set(medians) == {"latency error", "energy error"}
    for figure in medians.values():
        assert isinstance(figure, float)
        assert 0 < figure <= 25
    alone = [row.device for row, guess in zip(rows, predictions, strict=True) if guess.reason]
    assert alone == ["rtx-2080", "edge-tpu"]
    assert math.isfinite(sum(guess.latency_ms or 0.0 for guess in predictions))
