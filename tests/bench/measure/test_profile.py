"""Device profiles: what is read, what is refused, and that every figure says where it is from."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench import plugins
from bench.errors import BenchError
from bench.measure import devices
from bench.measure.profile import UNITS, load_profile

BUILT_IN = [plugin.name for plugin in plugins.plugins("devices") if plugin.built_in]
GOOD = """
name = "mine"
title = "My device"
precisions = ["int8"]

[t0_us]
value = 10
low = 5
high = 20
unit = "us"
kind = "assumed"
source = "a guess"

[launch_cycles.int8]
value = 1000
low = 1000
high = 1000
unit = "cycles per kernel"
kind = "measured"
source = "my oscilloscope"

[modes.slow.t0_us]
value = 100
low = 100
high = 100
unit = "us"
kind = "datasheet"
source = "page 3"
"""


def _profile(folder: Path, text: str = GOOD):
    path = folder / "mine.toml"
    path.write_text(text)
    return load_profile(path)


def test_the_papers_devices_and_eight_microcontrollers_are_there() -> None:
    assert set(BUILT_IN) == {
        *("host", "cortex-a53", "cortex-a57", "maxwell-128", "rtx-2080", "edge-tpu"),
        *("nrf52832", "nrf52840", "nrf5340", "stm32l4", "stm32u5", "stm32h7"),
        *("rp2040", "esp32-c3"),
    }


@pytest.mark.parametrize("name", BUILT_IN)
def test_every_coefficient_has_a_range_a_unit_a_source_and_its_kind(name) -> None:
    profile = plugins.load("devices", name)
    assert profile.name == name
    assert profile.precisions
    every = [*profile.coefficients.items()]
    every += [entry for mode in profile.modes.values() for entry in mode.items()]
    for key, entry in every:
        assert entry.low <= entry.value <= entry.high, key
        assert entry.unit == UNITS[key.partition(".")[0]], key
        assert entry.kind in ("measured", "counted", "datasheet", "assumed"), key
        assert len(entry.source) > 5, key


@pytest.mark.parametrize("name", BUILT_IN)
def test_what_is_assumed_has_a_range(name) -> None:
    profile = plugins.load("devices", name)
    guesses = {k: c for k, c in profile.coefficients.items() if c.kind == "assumed" and c.value}
    assert all(entry.low < entry.high for entry in guesses.values()), guesses


def test_dotted_names_and_modes(tmp_path) -> None:
    profile = _profile(tmp_path)
    assert profile.values() == {"t0_us": 10, "launch_cycles.int8": 1000}
    assert profile.in_mode("slow").value("t0_us") == 100
    assert profile.in_mode("slow").value("launch_cycles.int8") == 1000
    assert profile.value("t0_us") == 10
    assert profile.value("power_w") is None
    with pytest.raises(BenchError, match="unknown mode of mine 'slwo'; did you mean 'slow'"):
        profile.in_mode("slwo")


def test_what_a_mode_gives_stands_for_all_that_is_more_specific(tmp_path) -> None:
    launch = GOOD.partition("[launch_cycles.int8]")[2].partition("[modes")[0]
    every = f"{GOOD}\n[modes.other.launch_cycles]{launch.replace('1000', '7')}"
    profile = _profile(tmp_path, every)
    assert profile.in_mode("other").values() == {"t0_us": 10, "launch_cycles": 7}
    narrow = _profile(tmp_path, every.replace("other.launch_cycles", "other.launch_cycles.fp32"))
    assert narrow.in_mode("other").value("launch_cycles.int8") == 1000


def test_fitted_values_move_their_range_along(tmp_path) -> None:
    fitted = _profile(tmp_path).with_values({"t0_us": 20.0})
    entry = fitted.coefficients["t0_us"]
    assert (entry.low, entry.value, entry.high) == (10, 20, 40)
    with pytest.raises(BenchError, match="unknown coefficient of mine 't1_us'"):
        fitted.with_values({"t1_us": 1.0})


def test_a_fit_may_leave_zero(tmp_path) -> None:
    profile = _profile(tmp_path).with_values({"t0_us": 0.0}).with_values({"t0_us": 3.0})
    entry = profile.coefficients["t0_us"]
    assert (entry.low, entry.value, entry.high) == (0, 3, 3)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (('name = "mine"', ""), "'name' is missing"),
        (("low = 5", "low = 15"), r"t0_us: 0 <= low <= value <= high was expected"),
        (("low = 5", "low = -5"), r"t0_us: 0 <= low"),
        (("high = 20", "high = inf"), r"t0_us: 0 <= low"),
        (("low = 5", ""), r"t0_us: exactly these entries were expected: value, low, high"),
        (("value = 10", 'value = "ten"'), "t0_us: exactly these entries"),
        (('unit = "us"', 'unit = "ms"'), "t0_us: unit 'ms', expected 'us'"),
        (('kind = "assumed"', 'kind = "sure"'), "t0_us: a source and one of measured, counted"),
        (('source = "a guess"', 'source = ""'), "t0_us: a source"),
        (("[t0_us]", "x = 3\n[t0_us]"), "'x' is no coefficient"),
        (("[t0_us]", "[t0_weeks]"), "t0_weeks: unit 'us', expected None"),
        (("[t0_us]", "[t0_us"), "cannot read device profile"),
    ],
)
def test_a_bad_profile_is_one_line_that_names_the_file(tmp_path, change, said) -> None:
    with pytest.raises(BenchError, match=said) as caught:
        _profile(tmp_path, GOOD.replace(*change, 1))
    assert "mine.toml" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_missing_profile_is_one_line(tmp_path) -> None:
    with pytest.raises(BenchError, match=r"cannot read device profile .*absent\.toml"):
        load_profile(tmp_path / "absent.toml")
    with pytest.raises(AttributeError, match="no profile 'pdp_11'"):
        devices.pdp_11  # noqa: B018


def test_the_host_has_its_own_clock_where_the_system_tells_it(monkeypatch) -> None:
    import psutil

    class Clock:
        current, max = 1234.0, 2345.0

    monkeypatch.setattr(psutil, "cpu_freq", lambda: Clock)
    entry = devices.host.coefficients["frequency_mhz"]
    assert (entry.low, entry.value, entry.kind) == (1234.0, 2345.0, "measured")
    monkeypatch.setattr(psutil, "cpu_freq", lambda: None)
    assert devices.host.coefficients["frequency_mhz"].kind == "assumed"
