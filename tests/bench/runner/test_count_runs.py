"""Counts beside runs: kept by artifact and core, replacing estimates, believed only whole."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from bench.cli.estimates import estimator
from bench.plugins import find
from bench.results import Cost, CountRecord, Cycles, Layer
from bench.runner.count_runs import devices_of
from bench.runner.folder import ResultFolder

COUNT = CountRecord(
    artifact_sha256="a" * 64, core="cortex-m4f", compiler="gcc 12 -O2", rows=32,
    outputs_equal=32, largest_m=0.0, instructions=800_000.0,
    cycles=Cycles(900_000.0, 1_000_000.0, 1_100_000.0), flash_reads=0, flash_bytes=13_312,
    ram_bytes=4096,
)  # fmt: skip


class Built:
    cost = Cost((Layer("conv", 300_000, 1000, "fp32"),), 24_000)
    precision = "fp32"
    artifact_sha256 = COUNT.artifact_sha256


def _figures(folder, *names):
    return list(devices_of(Built(), [find("devices", name) for name in names], folder))


def test_a_count_replaces_the_estimate_of_every_part_with_its_core(tmp_path):
    folder = ResultFolder(tmp_path)
    before = _figures(folder, "nrf52832", "stm32l4", "stm32h7")
    assert [one.how for one in before] == ["estimated"] * 3
    folder.write_count(COUNT)
    after = _figures(folder, "nrf52832", "stm32l4", "stm32h7")
    assert [one.how for one in after] == ["counted", "counted", "estimated"]
    assert after[0].latency_us.value == pytest.approx(1_000_000 / 64)
    assert after[1].latency_us.value == pytest.approx(1_000_000 / 120)
    assert after[0].fits == "fits: 13 of 512 KB flash, 4 of 64 KB RAM"
    assert after[2] == before[2]
    reported = estimator(tmp_path)(Built())
    assert {one.device for one in reported if one.how == "counted"} == {
        *("nrf52832", "nrf52840", "stm32l4")
    }


def test_a_part_too_small_has_a_reason_and_no_figures(tmp_path):
    folder = ResultFolder(tmp_path)
    folder.write_count(replace(COUNT, ram_bytes=100_000))
    figure = _figures(folder, "nrf52832")[0]
    assert figure.latency_us is None
    assert figure.reason == "does not fit: needs 97.7 KB of RAM, the part has 64"


def test_an_edited_or_misplaced_count_is_not_believed(tmp_path):
    folder = ResultFolder(tmp_path)
    folder.write_count(COUNT)
    path = next((tmp_path / "counts").glob("*.json"))
    whole = path.read_text()
    content = json.loads(whole)
    content["instructions"] = 1.0
    path.write_text(json.dumps(content))
    told: list[str] = []
    assert folder.find_count(COUNT.artifact_sha256, COUNT.core, told.append) is None
    assert "edited or damaged" in told[0]
    folder.write_count(COUNT)
    folder.write_count(replace(COUNT, core="cortex-m7"))
    two = sorted((tmp_path / "counts").glob("*.json"))
    texts = [one.read_text() for one in two]
    for one, text in zip(two, reversed(texts), strict=True):
        one.write_text(text)
    assert folder.find_count(COUNT.artifact_sha256, COUNT.core, told.append) is None
    assert "the count of something else" in told[-1]
