"""What a name does to the recorded ranges is said in metres."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pandas as pd

from bench.discrepancy.report.doing import beyond_published, doings, in_words, meanwhile
from bench.discrepancy.report.evidence import Evidence
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.effects.fitted.device_clock import DeviceClock
from bench.physics.effects.fitted.power_curve import PowerCurve
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.power_bias import PowerBias
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter

FRAME = pd.DataFrame({"link": list("aabb"), "true_range_m": [5.0, 5.0, 10.0, 10.0]})


def said(*effects: Effect, frame: pd.DataFrame = FRAME) -> dict[str, str]:
    """Return what effects do to four rows."""
    held = Evidence(frame, ("error_m",), np.zeros((4, 1)), np.zeros((4, 1)))
    found: Any = SimpleNamespace(evidence=held, base=Base(), added=effects)
    return doings(cast("Any", found))


def test_a_delay_and_a_scale_are_said_in_metres() -> None:
    made = said(AntennaDelay(delay_ns=1.0), RangeScale(scale=0.01))
    assert made["antenna-delay"] == "ranges +0.15 m in the median"
    assert made["range-scale"] == "ranges +0.075 m in the median, +0.05 to +0.1 m in nine of ten"


def test_a_bias_of_the_level_is_that_of_levels_that_are_recorded() -> None:
    loud = FRAME.assign(rx_power_dbm=[-61.0, -61.0, -77.0, np.nan])
    made = said(PowerBias(), frame=loud)
    assert made["power-bias"] == (
        "ranges -0.11 m in the median of the rows where it acts (67%); "
        "-0.041 m at -74 dBm, -0.110 m at -61 dBm, -0.110 m at -61 dBm"
    )


def test_a_rounding_moves_ranges_by_half_a_step_either_way_or_in_the_mean() -> None:
    grid = RangeRounding(step_m=0.02)
    assert said(grid)["range-rounding"] == "ranges off by up to 0.01 m either way"
    down = said(replace(grid, lean=-0.5))["range-rounding"]
    assert down == "ranges -0.01 m in the mean, by 0 to twice that"
    some = replace(grid, of="rx", devices=("a", "b", "c"), leans=(0.0, 0.5, 0.0))
    found = said(some, frame=FRAME.assign(rx=list("abca")))["range-rounding"]
    assert found == "ranges off by up to 0.01 m either way; 1 of 3 devices +0.01 m in the mean"


def test_what_draws_at_random_or_does_nothing_is_not_said() -> None:
    assert said(BlockedPath(), RangeScale(scale=0.0)) == {}


def test_jitter_in_samples_is_said_in_metres() -> None:
    made = said(TimestampJitter(jitter_samples=0.0605))
    assert made == {"timestamp-jitter": "ranges scatter by 0.0182 m (one standard deviation)"}


def test_where_it_acts_in_part_of_the_rows_alone_is_said() -> None:
    shift = np.where(np.arange(10) < 3, 0.16, 0.0)
    assert in_words(shift) == "ranges +0.16 m in the median of the rows where it acts (30%)"


def test_a_ripple_moves_no_range_in_the_median() -> None:
    shift = 0.05 * np.sin(np.linspace(0, 20 * np.pi, 1001))
    assert in_words(shift).startswith("ranges -0.04")
    assert in_words(shift).endswith(
        "m in nine of ten of the rows where it acts (98%), none in the median"
    )


def test_how_far_clocks_go_while_they_are_heard_is_said() -> None:
    times = pd.DataFrame({"tx": "T", "rx": ["A", "B"] * 2, "time_s": [0.0, 100.0, 1800.0, 3600.0]})
    none = (0.0, 0.0, 0.0)
    still = DeviceClock(
        devices=("A", "B", "T"), offsets_ppm=(0.0, 0.0, 1.0), drifts_ppm_per_hour=none
    )
    drifting = DeviceClock(
        devices=("A", "B", "T"), offsets_ppm=(0.0, 0.0, 1.0), drifts_ppm_per_hour=(0.0, 0.0, 2.0)
    )
    warming = DeviceClock(
        devices=("A", "T"),
        offsets_ppm=(0.0, 1.0),
        drifts_ppm_per_hour=(0.0, 0.0),
        knots_s=((), (0.0, 3600.0)),
        wander_ppm=((), (-0.5, 0.75)),
    )
    assert meanwhile(still, times) == ""
    assert "by +2 ppm at T" in meanwhile(drifting, times)
    assert "by +1.2 ppm at T" in meanwhile(warming, times)


def test_a_level_that_a_receiver_logs_too_low_is_stated_as_both() -> None:
    curve = PowerCurve(levels_dbm=(-91.0, -85.0), bias_m=(0.08, 0.05))
    assert list(curve.values()) == ["bias_m[-91 dBm]", "bias_m[-85 dBm, logged -86.2]"]


def test_a_bias_over_levels_far_beyond_the_published_one_is_remarked() -> None:
    assert beyond_published(np.linspace(-0.11, 0.08, 50)) == ""
    assert "late" in beyond_published(np.linspace(0.0, 0.45, 50))
