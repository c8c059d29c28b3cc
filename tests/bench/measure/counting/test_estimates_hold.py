"""Estimates beside counts: every part's range contains what was counted for every network.

`counted.json` is what tests/benchmarks/fit_core_profiles.py keeps of the counts it fits to.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from bench import plugins
from bench.measure.counting import figure_of
from bench.measure.estimate import estimate
from bench.results import Cost, Cycles, Layer

CONTENT = json.loads((Path(__file__).parent / "counted.json").read_text())
PARTS = {"nrf52832", "nrf52840", "nrf5340", "stm32l4", "stm32u5", "stm32h7", "rp2040", "esp32-c3"}


@dataclass(frozen=True)
class Taken:
    core: str
    cycles: Cycles
    flash_reads: int
    flash_bytes: int
    ram_bytes: int


def _cost(name: str) -> Cost:
    network = CONTENT["networks"][name]
    layers = tuple(Layer(*one) for one in network["layers"])
    return Cost(layers, network["weight_bytes"], network["inputs"])


def _pairs():
    for name in sorted(PARTS):
        profile = plugins.load("devices", name)
        for row in CONTENT["counts"]:
            if row["core"] == profile.core:
                yield pytest.param(profile, row, id=f"{name}-{row['network']}")


@pytest.mark.parametrize(("profile", "row"), list(_pairs()))
def test_the_estimate_contains_the_count(profile, row):
    taken = Taken(
        *(row["core"], Cycles(*row["cycles"]), row["flash_reads"], row["flash_bytes"]),
        row["ram_bytes"],
    )
    counted = figure_of(taken, profile).latency_us
    told = estimate(profile, _cost(row["network"]), row["precision"]).latency_us
    assert told.low <= counted.low <= counted.high <= told.high
    assert told.value == pytest.approx(counted.value, rel=0.35)  # the middle is a fit


def test_every_part_and_network_is_there():
    assert len({row["network"] for row in CONTENT["counts"]}) >= 7
    cores = {row["core"] for row in CONTENT["counts"]}
    assert {plugins.load("devices", name).core for name in PARTS} <= cores


def test_half_precision_is_estimated_as_the_floats_it_becomes():
    profile = plugins.load("devices", "nrf52832")
    whole = _cost("remnet/fp32")
    halves = tuple(replace(one, dtype="fp16") for one in whole.layers)
    half = Cost(halves, 12_000, whole.inputs)
    a, b = (estimate(profile, c, p).latency_us.value for c, p in ((whole, "fp32"), (half, "fp16")))
    assert a / 2 < b <= a * 1.01


def test_estimates_name_the_generator_they_stand_for():
    for name in PARTS:
        assert "bench export" in plugins.load("devices", name).generator
