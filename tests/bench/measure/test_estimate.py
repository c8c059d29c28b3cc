"""The device model: its arithmetic by hand, its ranges, and the paper's own measurements."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import pytest

from bench import plugins
from bench.errors import BenchError
from bench.measure.estimate import call_of, energy_of, estimate, latency_us
from bench.measure.profile import Coefficient, Profile


@dataclass(frozen=True)
class Layer:
    kind: str
    macs: int
    outputs: int
    dtype: str
    reads: int = 0


@dataclass(frozen=True)
class Cost:
    layers: tuple[Layer, ...]
    weight_bytes: int = 1000
    inputs: int = 0


def _exactly(value: float) -> Coefficient:
    return Coefficient(value, value, value, "", "test", "measured")


def _profile(**values: float) -> Profile:
    given = {
        "t0_us": 10.0,
        "frequency_mhz": 100.0,
        "launch_cycles": 50.0,
        "macs_per_cycle": 2.0,
        "cycles_per_output": 1.0,
        "power_w": 3.0,
        **{name.replace("__", "."): value for name, value in values.items()},
    }
    entries = {name: _exactly(value) for name, value in given.items()}
    return Profile("toy", "Toy", ("fp32", "int8"), entries)


NETWORK = Cost(
    (
        Layer("move", 0, 100, "fp32"),
        Layer("conv", 4000, 200, "fp32"),
        Layer("elementwise", 0, 200, "fp32"),
        Layer("dense", 600, 1, "fp32"),
    )
)


def test_the_formula_by_hand() -> None:
    found = estimate(_profile(), NETWORK, "fp32")
    # t0 + 3 kernels x 50 / 100 MHz + (4600 / 2 + 501) cycles / 100 MHz
    assert found.latency_us.value == pytest.approx(10 + 1.5 + 28.01)
    assert found.energy_mj.value == pytest.approx(3.0 * 39.51e-3)
    assert (found.device, found.reason) == ("toy", None)


def test_half_precision_files_have_their_activations_joined_on_loading() -> None:
    assert call_of(NETWORK, "fp32").kernels == 3
    assert call_of(NETWORK, "fp16").kernels == 2


def test_what_is_read_checked_and_called_costs_where_the_profile_says_so() -> None:
    sums = Layer("reduce", 0, 1, "fp32", reads=300)
    network = Cost((*NETWORK.layers, sums), inputs=157)
    plain = _profile()
    terms = {
        **{"cycles_per_read__reduce__fp32": 2.0, "cycles_per_input": 10.0},
        **{"call_cycles": 40.0, "fit_factor": 1.5, "cycles_per_output__move__fp32": 0.0},
    }
    without = estimate(plain, network, "fp32").latency_us.value
    found = estimate(_profile(**terms), network, "fp32").latency_us.value
    # 300 reads x 2 + 157 inputs x 10 + 40 of the call - 100 values moved x 1, at 100 MHz
    assert found == pytest.approx(1.5 * (without + (600 + 1570 + 40 - 100) / 100))
    quick = estimate(_profile(t0_us=0.0), NETWORK, "fp32").latency_us.value
    assert quick == pytest.approx(estimate(plain, NETWORK, "fp32").latency_us.value - 10)


def test_rows_multiply_arithmetic_alone() -> None:
    found = estimate(_profile(), NETWORK, "fp32", rows=4)
    assert found.latency_us.value == pytest.approx(10 + 1.5 + 4 * 28.01)


def test_kernels_are_launched_at_the_clock_of_whoever_launches() -> None:
    found = estimate(_profile(host_mhz=1000.0), NETWORK, "fp32")
    assert found.latency_us.value == pytest.approx(10 + 0.15 + 28.01)


def test_a_microcontrollers_energy_is_per_cycle() -> None:
    found = estimate(_profile(cycle_energy_pj=200.0), NETWORK, "fp32")
    assert found.energy_mj.value == pytest.approx(200e-9 * 39.51 * 100)


def test_the_most_specific_coefficient_counts() -> None:
    profile = _profile(
        macs_per_cycle__conv__fp32=4.0, macs_per_cycle__fp32=1.0, launch_cycles__int8=1e9
    )
    found = estimate(profile, NETWORK, "fp32")
    assert found.latency_us.value == pytest.approx(10 + 1.5 + (1000 + 600 + 501) / 100)


def test_ranges_add_in_quadrature_and_point_the_right_way() -> None:
    profile = _profile()
    wide = {
        **profile.coefficients,
        "t0_us": Coefficient(10, 7, 14, "us", "test", "assumed"),
        "macs_per_cycle": Coefficient(2, 1, 2, "", "test", "assumed"),
        "power_w": Coefficient(3, 1, 3, "W", "test", "assumed"),
    }
    found = estimate(replace(profile, coefficients=wide), NETWORK, "fp32")
    assert found.latency_us.low == pytest.approx(39.51 - 3)
    assert found.latency_us.high == pytest.approx(39.51 + (4**2 + 23**2) ** 0.5)
    assert found.energy_mj.low < found.energy_mj.value < found.energy_mj.high
    sure = estimate(profile, NETWORK, "fp32").latency_us
    assert sure.low == sure.value == sure.high


def test_a_precision_the_device_has_not_is_a_reason() -> None:
    found = estimate(_profile(), NETWORK, "fp16")
    assert (found.latency_us, found.energy_mj) == (None, None)
    assert found.reason == "runs fp32, int8 only"


def test_an_integer_device_refuses_a_network_with_float_layers() -> None:
    edge = plugins.load("devices", "edge-tpu")
    mixed = Cost((Layer("conv", 10, 10, "int8"), Layer("dense", 10, 1, "fp32")))
    whole = Cost((Layer("conv", 10, 10, "int8"), Layer("move", 0, 1, "fp32")))
    assert estimate(edge, mixed, "int8").reason == "1 of 2 layers with weights are not 8-bit"
    assert estimate(edge, NETWORK, "fp32").reason == "runs int8 only"
    assert estimate(edge, whole, "int8").reason is None


@pytest.mark.parametrize(
    ("network", "said"),
    [
        (Cost(NETWORK.layers, 600 * 1024), r"needs about 60\d KiB of flash, has 512"),
        (Cost((Layer("conv", 1, 20_000, "fp32"),) * 2), r"needs about 156 KiB of RAM, has 64"),
    ],
)
def test_a_network_too_big_for_a_microcontroller_is_a_reason(network, said) -> None:
    reason = estimate(plugins.load("devices", "nrf52832"), network, "fp32").reason
    assert re.fullmatch(said, reason or "")


def test_a_profile_that_lacks_a_coefficient_says_which() -> None:
    profile = _profile()
    entries = {k: v for k, v in profile.coefficients.items() if k != "macs_per_cycle"}
    with pytest.raises(BenchError, match=r"has no 'macs_per_cycle\.conv\.fp32'"):
        estimate(replace(profile, coefficients=entries), NETWORK, "fp32")


def test_energy_of_a_measured_latency() -> None:
    assert energy_of(_profile(), "fp32", 1000.0).value == pytest.approx(3.0)


# REMnet as counted from its exported graphs: kernels (no moves), outputs, multiply-adds.
def _remnet(kernels: int, dtype: str) -> Cost:
    layers = [Layer("conv", 301_056, 9216, dtype), Layer("dense", 448, 55, dtype)]
    layers += [Layer("elementwise", 0, 300, dtype)] * (kernels - 2)
    return Cost(tuple(layers), 24_604)


PLAIN, FUSED, EIGHT_BIT = _remnet(46, "fp32"), _remnet(30, "fp32"), _remnet(32, "int8")
HALF = _remnet(31, "fp16")  # of which one activation is joined


@pytest.mark.parametrize(
    ("device", "mode", "network", "precision", "measured_ms"),
    [
        ("cortex-a53", None, PLAIN, "fp32", 16.9),
        ("cortex-a53", None, FUSED, "fp32", 12.2),
        ("cortex-a53", None, HALF, "fp16", 11.2),
        ("cortex-a53", None, EIGHT_BIT, "int8", 6.23),
        ("cortex-a57", None, EIGHT_BIT, "int8", 4.71),
        ("cortex-a57", "5w", EIGHT_BIT, "int8", 7.63),
        ("maxwell-128", None, FUSED, "fp32", 5.36),
        ("maxwell-128", None, HALF, "fp16", 5.18),
        ("maxwell-128", "5w", FUSED, "fp32", 8.78),
        ("maxwell-128", "5w", HALF, "fp16", 7.22),
        ("rtx-2080", None, FUSED, "fp32", 0.69),
        ("rtx-2080", None, HALF, "fp16", 0.54),
        ("rtx-2080", "tensorflow", PLAIN, "fp32", 19.7),
        ("edge-tpu", None, EIGHT_BIT, "int8", 0.51),
    ],
)
def test_profiles_agree_with_the_papers_device_table(
    device, mode, network, precision, measured_ms
) -> None:
    # The rows the profiles were anchored on: they must still be told within 15 %.
    profile = plugins.load("devices", device)
    profile = profile.in_mode(mode) if mode else profile
    found = estimate(profile, network, precision).latency_us
    assert found.value / 1000 == pytest.approx(measured_ms, rel=0.15)
    assert found.low / 1000 < measured_ms < found.high / 1000


@pytest.mark.parametrize(
    ("device", "clock_mhz", "macs", "measured_ms"),
    [
        # Published: STM32 model zoo. nRF52832 and STM32F401 have the same core, 64 and 84 MHz.
        ("stm32u5", 160, 13_008, 2.25),
        ("stm32u5", 160, 47_568, 8.17),
        ("nrf52832", 84, 7_744, 1.54),
    ],
)
def test_microcontrollers_agree_with_published_float_networks(
    device, clock_mhz, macs, measured_ms
) -> None:
    profile = plugins.load("devices", device).in_mode("cube-ai")
    profile = profile.with_values({"frequency_mhz": float(clock_mhz)})
    network = Cost((Layer("conv", macs, 500, "fp32"), *[Layer("elementwise", 0, 200, "fp32")] * 4))
    found = latency_us(profile.values(), call_of(network, "fp32"))
    assert found / 1000 == pytest.approx(measured_ms, rel=0.3)


def test_eight_bits_are_estimated_faster_where_the_paper_measured_so() -> None:
    for device in ("cortex-a53", "cortex-a57", "nrf52832", "stm32u5", "stm32h7"):
        profile = plugins.load("devices", device)
        eight = estimate(profile, EIGHT_BIT, "int8").latency_us.value
        assert eight < estimate(profile, FUSED, "fp32").latency_us.value, device
