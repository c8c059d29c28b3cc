"""A count in a part's units, what fits, and a board's own cycles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bench import plugins
from bench.errors import BenchError
from bench.measure.counting import Count, figure_of
from bench.measure.counting.measured import read_measured, recalibrated, write_profile
from bench.measure.profile import load_profile
from bench.results import Cycles

COUNT = Count(
    core="cortex-m4f", compiler="gcc 12 -O2", rows=1, counted_rows=1, instructions=800_000,
    fewest=800_000, most=800_000, cycles=Cycles(900_000, 1_000_000, 1_100_000), kinds={},
    layers=(), flash_reads=50_000, code_bytes=5000, constant_bytes=8312, flash_bytes=13_312,
    static_ram_bytes=4000, stack_bytes=96, outputs_m=np.zeros(1, np.float32),
    statuses=np.zeros(1, np.int64),
)  # fmt: skip


@pytest.fixture
def part():
    return plugins.load("devices", "nrf52832")


def test_cycles_become_time_and_energy_by_hand(part):
    # 64 MHz; 0, 1 or 2 cycles for each of 50 000 reads of flash; 155, 174, 360 pJ a cycle
    figure = figure_of(COUNT, part)
    assert figure.cycles.value == 1_050_000
    assert (figure.cycles.low, figure.cycles.high) == (900_000, 1_200_000)
    assert figure.latency_us.value == pytest.approx(1_050_000 / 64)
    assert figure.energy_mj.value == pytest.approx(1_050_000 * 174e-9)
    assert figure.energy_mj.high == pytest.approx(1_200_000 * 360e-9)
    assert figure.fits == "fits: 13 of 512 KB flash, 4 of 64 KB RAM"
    assert figure.problem is None


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"static_ram_bytes": 80_000}, "does not fit: needs 78.2 KB of RAM, the part has 64"),
        ({"flash_bytes": 600_000}, "does not fit: needs 585.9 KB of flash, the part has 512"),
    ],
)
def test_a_part_too_small_is_named(part, change, said):
    figure = figure_of(replace(COUNT, **change), part)
    assert figure.problem == figure.fits == said


def test_a_count_of_another_core_is_refused(part):
    with pytest.raises(BenchError, match="has core cortex-m4f, counted cortex-m7"):
        figure_of(replace(COUNT, core="cortex-m7"), part)


def test_power_stands_in_where_a_cycles_energy_is_not_known():
    figure = figure_of(replace(COUNT, core="cortex-a53"), plugins.load("devices", "cortex-a53"))
    assert figure.latency_us.value == pytest.approx(1_000_000 / 1200)
    assert figure.energy_mj.value == pytest.approx(1_000_000 / 1200 * 1e-3)
    assert figure.fits.startswith("takes 13 KB")


def test_a_boards_cycles_recalibrate_its_profile(part, tmp_path):
    log = tmp_path / "board.txt"
    log.write_text("self-test\nrow 0: 1100000 cycles, 0.1 m\nrow 1: cycles = 1200000\nok\n")
    board = read_measured(log)
    assert board.cycles == (1_100_000, 1_200_000)
    changed = recalibrated(part, COUNT, board)
    write_profile(changed, tmp_path / "mine.toml")
    read = load_profile(tmp_path / "mine.toml")
    assert read.coefficients["cycle_factor"].kind == "measured"
    assert "board.txt" in read.coefficients["cycle_factor"].source
    figure = figure_of(COUNT, read)
    assert figure.cycles.value == pytest.approx(1_150_000)
    assert figure.cycles.low == pytest.approx(1_100_000)
    assert figure.cycles.high == pytest.approx(1_200_000)
    assert read.modes == part.modes
    assert {k: v for k, v in read.coefficients.items() if k != "cycle_factor"} == dict(
        part.coefficients
    )


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(BenchError, match="cannot read"):
        read_measured(tmp_path / "none.txt")


@pytest.mark.parametrize(
    "line",
    [
        "-5 cycles",
        "cycles -5",
        "1,012,345 cycles",
        "cycles: 1'012'345",
        "1e6 cycles",
        "12.5 cycles",
        "0 cycles",
    ],
)
def test_cycles_that_are_no_whole_number_are_refused_not_misread(line, tmp_path):
    (tmp_path / "board.txt").write_text(f"row 0: 1000 cycles, 1 um\n{line}\n")
    with pytest.raises(BenchError, match="expected a whole number above 0"):
        read_measured(tmp_path / "board.txt")


@pytest.mark.parametrize(
    "text", ["", "row 0: fast", "12 ms", "1.5 Mcycles", "7" * 300_000, "9 " * 300_000]
)
def test_a_file_without_cycles_is_soon_refused(text, tmp_path):
    (tmp_path / "board.txt").write_text(text)
    with pytest.raises(BenchError, match="no line like"):
        read_measured(tmp_path / "board.txt")
