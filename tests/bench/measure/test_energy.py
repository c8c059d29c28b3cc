"""Energy counters: a made-up powercap tree whose energies are known."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from bench.measure import energy
from bench.measure.energy import EnergyMeter, NoMeter, Rapl, energy_per_call, host_meter


def _zone(root: Path, folder: str, name: str, energy_uj: int, span: int = 10**9) -> Path:
    zone = root / folder
    zone.mkdir(parents=True)
    (zone / "name").write_text(f"{name}\n")
    (zone / "energy_uj").write_text(f"{energy_uj}\n")
    (zone / "max_energy_range_uj").write_text(f"{span}\n")
    return zone


def test_packages_are_summed_and_their_parts_not_counted_twice(tmp_path) -> None:
    first = _zone(tmp_path, "intel-rapl:0", "package-0", 1000)
    second = _zone(tmp_path, "intel-rapl:1", "package-1", 5000)
    core = _zone(tmp_path, "intel-rapl:0:0", "core", 700)
    mirror = _zone(tmp_path, "intel-rapl-mmio:0", "package-0", 1000)
    meter = host_meter(tmp_path)
    assert isinstance(meter, Rapl)
    for zone, energy_uj in ((first, 4000), (second, 7000), (core, 9000), (mirror, 4000)):
        (zone / "energy_uj").write_text(str(energy_uj))
    assert meter.read_mj() == pytest.approx(5.0)


def test_a_counter_that_wraps_goes_on(tmp_path) -> None:
    zone = _zone(tmp_path, "intel-rapl:0", "package-0", 9_000, span=9_999)
    meter = host_meter(tmp_path)
    for energy_uj in (9_900, 200, 5_000):
        (zone / "energy_uj").write_text(str(energy_uj))
        total = meter.read_mj()
    assert total == pytest.approx((1000 + 5_000) / 1000)


def test_no_counters_are_a_reason_not_a_number(tmp_path) -> None:
    meter = host_meter(tmp_path / "absent")
    assert isinstance(meter, NoMeter)
    assert meter.how == "not measured: no RAPL counters on this machine"
    assert energy_per_call(meter, lambda seconds: 1) is None


def test_counters_only_root_may_read_say_how_to_open_them(tmp_path, monkeypatch) -> None:
    _zone(tmp_path, "intel-rapl:0", "package-0", 0)
    monkeypatch.setattr(Rapl, "_raw", lambda self: (_ for _ in ()).throw(PermissionError("no")))
    assert "sudo chmod a+r" in host_meter(tmp_path).how


def test_broken_counters_are_a_reason(tmp_path) -> None:
    zone = _zone(tmp_path, "intel-rapl:0", "package-0", 0)
    (zone / "energy_uj").write_text("garbage")
    assert "cannot be read" in host_meter(tmp_path).how


class _Simulated(EnergyMeter):
    """10 W always, and 2 mJ for each call."""

    how = "simulated"

    def __init__(self) -> None:
        self.calls = 0
        self.now = 0.0

    def read_mj(self) -> float:
        return 10_000 * self.now + 2.0 * self.calls


def test_idle_power_is_taken_off(monkeypatch) -> None:
    meter = _Simulated()
    monkeypatch.setattr(time, "perf_counter", lambda: meter.now)

    def rest(seconds: float) -> None:
        meter.now += seconds

    def burst(seconds: float) -> int:
        meter.now += seconds
        meter.calls += 50
        return 50

    monkeypatch.setattr(energy.time, "sleep", rest)
    found = energy_per_call(meter, burst)
    assert (found.value, found.low, found.high) == pytest.approx((2.0, 2.0, 2.0))


def test_six_bursts_give_their_median_and_their_extremes(monkeypatch) -> None:
    meter, costs_mj, lasted = _Simulated(), iter([3.0, 1.0, 9.0, 2.0, 4.0, 2.5]), []
    monkeypatch.setattr(time, "perf_counter", lambda: meter.now)

    def rest(seconds: float) -> None:
        meter.now += seconds

    def burst(seconds: float) -> int:
        lasted.append(seconds)
        meter.now += seconds
        meter.calls += next(costs_mj) * 10 / 2.0  # each of ten calls takes that much
        return 10

    monkeypatch.setattr(energy.time, "sleep", rest)
    found = energy_per_call(meter, burst)
    assert (found.value, found.low, found.high) == pytest.approx((2.75, 1.0, 9.0))
    assert lasted == [0.2] * 6
