"""Effects on levels must predict better than what levels do for other reasons."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.select import refute, second_level
from bench.discrepancy.select.second_level import calmed, predicts
from bench.discrepancy.select.state import Search
from bench.physics.base import Base
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.propagation.two_rays import fading_db, fading_ways, pulling_ways, rays
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS, ROWS = 40, 10


def _made():
    rng = np.random.default_rng(4)
    far = rng.uniform(5, 60, LINKS * ROWS)
    heading = rng.uniform(-np.pi, np.pi, LINKS * ROWS)
    return rng, far, heading, np.repeat(np.arange(LINKS), ROWS)


def test_as_many_decibel_in_all_rows_are_no_path_loss() -> None:
    rng, far, _, links = _made()
    others = np.column_stack([np.ones(len(far)), rng.normal(size=len(far))])
    slope = 6 * np.log10(far)
    left = 1.2 + rng.normal(size=LINKS)[links]
    assert not predicts(left, slope, others, links)
    assert predicts(left + slope, slope, others, links)


def test_a_gain_over_headings_is_no_path_loss_and_a_slope_is_one() -> None:
    rng, far, heading, links = _made()
    gain = 2 * np.cos(heading) + rng.normal(size=len(far))
    slope = -10 * np.log10(far / 20)
    waves = np.stack([np.ones(len(far)), np.cos(heading), np.sin(heading)], axis=1)
    assert not predicts(gain, slope, waves, links)
    assert predicts(gain + 0.5 * slope, slope, waves, links)


def test_reasons_that_explain_nothing_are_no_rivals() -> None:
    rng, far, heading, links = _made()
    slope = -10 * np.log10(far / 20)
    level = 0.3 * slope + rng.normal(size=LINKS)[links] * 3
    waves = np.stack([np.ones(len(far)), np.cos(heading), np.sin(heading)], axis=1)
    assert predicts(level, slope, waves, links)


@pytest.mark.parametrize(("slope", "told"), [(0.65, True), (0.0, False)])
def test_levels_of_few_links_that_surely_go_with_a_slope_are_no_constant(
    monkeypatch: pytest.MonkeyPatch, slope: float, told: bool
) -> None:
    """Thirty links left out in turn hardly tell a gain; 4 standard errors do. SIMULATED."""
    rng = np.random.default_rng(11)
    links = np.repeat(np.arange(30), 12)
    far = np.exp(rng.uniform(np.log(2.5), np.log(22), 30))[links]
    change = -10 * np.log10(far / 8)
    level = -1 + slope * change + rng.normal(0, 1.8, 30)[links] + rng.normal(0, 1, len(links))
    many = np.column_stack([np.ones(len(far)), rng.normal(size=(30, 10))[links]])
    monkeypatch.setattr(second_level, "_better", lambda *_: False)
    assert predicts(level, change, many, links) is told


def _heights(far, channel=None) -> pd.DataFrame:
    frame = pd.DataFrame({"true_range_m": far, "tx_z_m": 1.8, "rx_z_m": 2.4})
    return frame if channel is None else frame.assign(channel=channel)


def test_two_ray_fading_is_a_sum_of_its_ways() -> None:
    _, far, _, _ = _made()
    rows = scene(_heights(far, 5), "recorded")
    found = rays(rows)
    assert found is not None
    fading = fading_db(found.ray(6.4896, 0.3, 0.0))
    ways = np.column_stack([fading_ways(rows), np.ones(len(far))])
    left = fading - ways @ np.linalg.lstsq(ways, fading, rcond=None)[0]
    assert np.std(left) < 0.25 * np.std(fading)


def test_without_heights_nothing_is_reflected() -> None:
    _, far, _, _ = _made()
    rows = scene(_heights(far).drop(columns="tx_z_m"), "recorded")
    assert rays(rows) is None
    assert fading_ways(rows).shape[1] == 0
    assert pulling_ways(rows) is None


def test_carriers_are_those_of_the_channel_or_all() -> None:
    _, far, _, _ = _made()
    told, untold = (scene(_heights(far, channel), "recorded") for channel in (5, None))
    assert len(pulling_ways(told) or ()) == 1
    assert len(pulling_ways(untold) or ()) == 4


def _level_search(slope_db: float, seen: tuple[str, ...] = ("rx_power_dbm",)):
    """Return a search whose levels follow the heading beside a pattern, and what was located."""
    rng = np.random.default_rng(7)
    frame = pd.DataFrame(
        {
            "link": np.repeat([f"l{i}" for i in range(LINKS)], ROWS),
            "true_range_m": rng.uniform(5, 60, LINKS * ROWS),
            "azimuth_deg": rng.uniform(-180, 180, LINKS * ROWS),
            "temperature_c": rng.uniform(0, 40, LINKS * ROWS),
        }
    )
    world = Resimulation(Simulator(Base(), (TimestampJitter(jitter_samples=0.08),), 3), Window())
    level = world.simulator.observe(scene(frame, "recorded"), 900, cir=False).rx_power_dbm
    turn = np.radians(frame["azimuth_deg"])
    warm = slope_db * (frame["temperature_c"] - 20) / 20
    frame["rx_power_dbm"] = level + 3 * np.cos(turn) + warm + 0.3 * rng.normal(size=len(frame))
    rows = view(frame, link_codes(frame), np.arange(len(frame)), Window(), ("rx_power_dbm",), False)
    search = Search(world, rows, rows, {}, 0, work=rows)
    findings = tuple(SimpleNamespace(cell=SimpleNamespace(observable=one)) for one in seen)
    return search, SimpleNamespace(findings=findings, significant=True)


def _stepped_search(slope_db: float):
    """Return a search whose levels are turned down in steps of 5 dB, and what was located."""
    search, located = _level_search(slope_db)
    assert search.work is not None
    frame = search.work.frame
    warm = slope_db * (frame["temperature_c"] - 20) / 20
    level = search.comparison.ensemble(search.work, (), 1).simulated_of("rx_power_dbm")[0]
    frame = frame.assign(rx_power_dbm=level - 1.6 * np.floor((level + 97) / 5) + warm)
    rows = view(frame, link_codes(frame), np.arange(len(frame)), Window(), ("rx_power_dbm",), False)
    return Search(search.comparison, rows, rows, {}, 0, work=rows), located


def test_what_a_named_pattern_does_to_levels_is_nothing_left() -> None:
    pattern = (AntennaPattern(delay_m=0.1),)
    search, located = _level_search(0.0)
    assert not calmed(search, pattern, located, 1).significant  # type: ignore[arg-type]
    search, located = _level_search(3.0)
    assert calmed(search, pattern, located, 1) is located  # type: ignore[arg-type]
    search, located = _level_search(0.0, ("rx_power_dbm", "error_m"))
    assert calmed(search, pattern, located, 1) is located  # type: ignore[arg-type]


def test_a_refused_name_was_not_needed_where_names_have_another_form(monkeypatch) -> None:
    pattern = (AntennaPattern(delay_m=0.1),)
    for slope_db, left in ((0.0, False), (3.0, True)):
        search, located = _level_search(slope_db)
        monkeypatch.setattr(refute, "locate_left", lambda *_, found=located: found)
        assert refute._left(search, (), pattern) is left  # type: ignore[arg-type]


def test_a_control_in_many_steps_is_a_form_of_one_and_a_warmth_is_none() -> None:
    control = (LevelControl(compression=0.4, shift_db=-10.0),)
    for slope_db, left in ((0.0, False), (3.0, True)):
        search, located = _stepped_search(slope_db)
        assert calmed(search, control, located, 1).significant is left  # type: ignore[arg-type]


def test_a_level_off_everywhere_is_left_beside_a_delay() -> None:
    search, located = _level_search(3.0)
    assert calmed(search, (AntennaDelay(delay_ns=1.0),), located, 1) is located  # type: ignore[arg-type]


def test_a_control_of_levels_may_have_any_curve_where_it_acts_and_none_below() -> None:
    level = np.linspace(-98.0, -70.0, 200)
    acts = level > -88
    design = second_level._over_levels(level, acts)
    for made in (np.where(level > -80.3, -2.1, 0.0), -0.02 * np.maximum(level + 86, 0) ** 2):
        found = design @ np.linalg.lstsq(design, made, rcond=None)[0]
        assert np.mean((made - found) ** 2) < 0.05 * np.mean(made**2)
    assert not design[~acts].any()


@pytest.mark.parametrize(("exponent", "named"), [(2.0, False), (1.7, False), (4.0, True)])
def test_a_slope_beside_a_control_is_one_that_no_curve_of_a_receiver_makes(
    exponent: float, named: bool
) -> None:
    """Levels that fall slower than in free space may be turned down; none is turned up."""
    search, _ = _level_search(0.0)
    assert search.work is not None
    arriving = search.comparison.ensemble(search.work, (), 1).simulated_of("rx_power_dbm")[0]
    far = search.work.frame["true_range_m"].to_numpy()
    arriving = arriving - 10 * (exponent - 2) * np.log10(far / 20)
    turned_down = arriving - 0.3 * np.maximum(arriving + 90, 0)
    turned_down = turned_down + 0.5 * np.random.default_rng(3).normal(size=len(far))
    frame = search.work.frame.assign(rx_power_dbm=turned_down)
    rows = view(frame, link_codes(frame), np.arange(len(frame)), Window(), ("rx_power_dbm",), False)
    control = (LevelControl(compression=0.5, shift_db=-10.0),)
    slope = PathLoss(exponent=3.0, offset_db=-13.0)
    assert second_level._beyond_control(search, rows, control, slope) is named
    assert second_level._beyond_control(search, rows, (), slope)
