"""Energy against latency, and latency against accuracy: what is estimated, measured, compared."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from bench.errors import BenchError
from bench.plugins import load
from bench.reproduce import paper
from bench.reproduce.device_figures import chosen_devices, device_profiles, in_ms, point
from bench.reproduce.experiments import energy
from bench.reproduce.experiments import latency_vs_accuracy as pareto
from bench.reproduce.experiments.energy import Spot
from bench.reproduce.experiments.latency_vs_accuracy import Pair
from bench.reproduce.paper_devices import backend_of, profile_of
from bench.results import Estimate, Interval


def test_every_device_is_there_with_its_modes() -> None:
    names = [name for name, _ in device_profiles()]
    assert {"cortex-a53", "cortex-a57", "cortex-a57, 5w", "host", "nrf52832"} <= set(names)
    assert len(names) == len(set(names))


def test_every_row_of_the_paper_finds_a_profile_and_a_backend() -> None:
    names = {name for name, _ in device_profiles()}
    rows = paper.rows("devices")
    keys = {(profile_of(row, rows), backend_of(row)) for row in rows}
    assert {device for device, _ in keys} <= names
    assert len(keys) == len(rows) == 14


def test_the_papers_energy_is_its_power_times_its_latency() -> None:
    assert energy._paper(None) == (None, None)
    row = {"latency_ms": 19.7, "power_w": 32.0, "energy_mj": 617.6}
    assert energy._paper(row) == (19.7, pytest.approx(630.4))


def test_what_a_device_cannot_run_is_a_line_and_no_figure() -> None:
    refused = [
        Spot("edge-tpu", name, Estimate("edge-tpu", None, None, "runs int8 only"), None, None)
        for name in ("fp32", "fp16")
    ]
    assert energy._refusals(refused) == ["Not on edge-tpu: fp32, fp16 (runs int8 only)."]
    assert energy._rows(refused[0]) == []
    assert list(energy._points(refused[0])) == []


def test_the_papers_point_is_hollow_and_looks_like_ours() -> None:
    found = Estimate("a", Interval(2000.0, 1000.0, 3000.0), Interval(4.0, 3.0, 5.0))
    ours, theirs = energy._points(Spot("a", "int8", found, 2.5, 4.5))
    assert (ours.x, ours.x_low, ours.x_high) == ([2.0], [1.0], [3.0])
    assert (theirs.x, theirs.y, theirs.style) == ([2.5], [4.5], "hollow")
    assert (ours.colour, ours.marker) == (theirs.colour, theirs.marker) == ("a", "int8")


def test_microseconds_become_milliseconds() -> None:
    assert in_ms(Interval(1500.0, 1000.0, 2500.0)) == Interval(1.5, 1.0, 2.5)


def test_devices_are_resolved_once_each() -> None:
    assert chosen_devices("host, cortex-a53,host") == ["host", "cortex-a53"]
    with pytest.raises(BenchError, match="did you mean 'cortex-a57'"):
        chosen_devices("cortex-a52")
    with pytest.raises(BenchError, match="names no device"):
        chosen_devices(" , ")


def pair(latency_us: float, mae_m: float, unstable: bool = False) -> Pair:
    return Pair("m", f"{latency_us}", Interval(latency_us), Interval(mae_m), unstable)


def test_the_front_holds_what_nothing_stable_beats() -> None:
    pairs = [pair(1, 0.3), pair(2, 0.1), pair(3, 0.2), pair(0.5, 0.05, unstable=True)]
    front = pareto._front(pairs)
    assert front == [pairs[0], pairs[1]]
    table = pareto._table("host", pairs, front)
    standing = {row.label[1]: row.ours for row in table.rows if row.quantity == "on the front"}
    assert standing == {"0.5": "unstable", "1": "yes", "2": "yes", "3": "no"}
    assert "MEASURED" in table.title
    assert "ESTIMATES" in pareto._table("cortex-a53", pairs, front).title


def test_the_picture_has_a_front_a_floor_and_says_what_is_hollow() -> None:
    pairs = [pair(1, 0.3), pair(2, 0.1, unstable=True)]
    drawn = pareto._figure("host", pairs, pareto._front(pairs), 0.4)
    styles = {series.name: series.style for series in drawn.series}
    assert styles["Pareto front"] == "step"
    assert styles["no mitigation"] == "dashed"
    assert "hollow: unstable" in drawn.title
    assert "measured" in drawn.x_label
    floor = next(series for series in drawn.series if series.style == "dashed")
    assert (list(floor.x), list(floor.y)) == ([1, 2], [0.4, 0.4])


def test_a_pair_that_does_not_fit_the_device_is_left_out_with_its_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    layer = SimpleNamespace(kind="conv", macs=1000, outputs=100, dtype="fp32", reads=100)
    monkeypatch.setattr(
        pareto, "cost_of", lambda *_: SimpleNamespace(layers=[layer], weight_bytes=1000, inputs=157)
    )
    key = SimpleNamespace(model="remnet", backend="fp32")
    record: Any = SimpleNamespace(key=key, precision="fp32", nlos=None, los=score())
    context: Any = None
    assert pareto._on(context, "edge-tpu", [record])[1] == [
        "remnet on fp32 is not for edge-tpu: runs int8 only"
    ]
    (found,), why = pareto._on(context, "cortex-a53", [record])
    assert why == []
    assert found.mae_m == Interval(0.1)
    assert found.latency_us.value > load("devices", "cortex-a53").value("t0_us")


def score() -> Any:
    return SimpleNamespace(mae_m=Interval(0.1), raw_mae_m=0.2)


def test_a_point_without_intervals_has_arms_of_no_length() -> None:
    one = point(Interval(1.0), Interval(2.0), "a", "b")
    assert (one.low, one.high, one.x_low, one.x_high) == ([2.0], [2.0], [1.0], [1.0])
