"""The gain of a pattern in waveforms: over headings of links, whatever its lobe and its phase."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from test_joint_sets import compared, recordings

from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.joint.likelihood import evidence
from bench.discrepancy.joint.plainer import flat_gain, without_waves
from bench.discrepancy.joint.polish import Fit, fitted, polished
from bench.discrepancy.joint.sets import Sets
from bench.discrepancy.joint.statistics import Statistics
from bench.discrepancy.joint.strikes import told_of_both
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.effects.fitted.pattern_gain import PatternGain
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern, heading_rad
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS = 40
HEADINGS = (np.arange(LINKS) * 137.5) % 360


@pytest.mark.parametrize("phase_deg", [100.0, -80.0])
def test_a_gain_is_found_at_any_phase_and_is_no_shadowing(phase_deg: float) -> None:
    frame = recordings().assign(azimuth_deg=HEADINGS)
    hidden = AntennaPattern(delay_m=0.1, gain_db=2.0, phase_deg=phase_deg)
    made = Simulator(Base(), (hidden,), 5, "test").observe(scene(frame), 5, 77).table(frame)
    comparison, rows = compared(made.assign(azimuth_deg=HEADINGS))
    found = Sets(comparison, rows, rows, (PatternGain, PathLoss)).chosen()
    assert [effect.physics for effect in found.named] == ["antenna-pattern"]
    assert isinstance(found.added[0], PatternGain)
    turn = heading_rad(rows.scene)
    wanted = -2.0 * np.cos(turn - np.radians(phase_deg))
    np.testing.assert_allclose(found.added[0].gain_db(turn), wanted, atol=0.5)


@pytest.mark.parametrize(
    ("hidden", "flat"), [(PathLoss(offset_db=5.0), True), (AntennaPattern(gain_db=2.0), False)]
)
def test_a_mean_gain_without_waves_is_no_pattern(hidden: Effect, flat: bool) -> None:
    frame = recordings().assign(azimuth_deg=HEADINGS)
    made = Simulator(Base(), (hidden,), 5, "test").observe(scene(frame), 5, 77).table(frame)
    given = Statistics(*compared(made.assign(azimuth_deg=HEADINGS)))
    fit, none = polished(given, (PatternGain(),)), fitted(given, ())
    assert fit is not None
    assert none is not None

    def worth(of: Fit) -> float:
        return evidence(given, of.moments, of.responses, of.parameters)

    assert flat_gain(given, fit, none, worth) is flat
    assert not flat_gain(given, fit, fit, worth)


def test_waves_of_a_heading_are_known() -> None:
    plain, turned = recordings(), recordings().assign(azimuth_deg=HEADINGS)
    before, after = (Statistics(*compared(one)).known.shape[1] for one in (plain, turned))
    assert after == before + 5  # the number and two harmonics


def test_where_ranges_tell_no_links_those_that_waveforms_find_must_be_by_chance() -> None:
    struck = np.cos(np.radians(HEADINGS)) > 0.5
    known = np.cos(np.radians(HEADINGS))[:, None]
    given: Any = SimpleNamespace(known=known, devices=np.zeros((LINKS, 0)))
    none, every = np.zeros(LINKS, bool), np.ones(LINKS, bool)
    assert told_of_both(given, struck, none, every, False)
    assert not told_of_both(given, np.arange(LINKS) % 4 == 0, none, every, False)


@pytest.mark.parametrize(("wave", "said"), [((-2.0, 1.5), True), ((0.4, 2.1), False)])
def test_a_gain_of_which_no_wave_is_told_is_none_in_the_place_of_another(
    wave: tuple[float, float], said: bool
) -> None:
    """Its mean did as well as a path loss in two tables of a stranger's; SIMULATED."""
    level = ParameterEstimate("mean_db", -7.0, -8.6, -5.9, "dB")
    lobe = ParameterEstimate("cos_db", sum(wave) / 2, *wave, "dB")
    option: Any = SimpleNamespace(effect=PatternGain(), parameters=(lobe, level))
    assert bool(without_waves(option)) is said
    option.effect = PathLoss()
    assert not without_waves(option)
