"""What strikes links is said with the values it has, told by samples and by ranges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_wave_strikes import compared, found_in, recordings

from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.joint.climb import ascended, climbed, shares_of
from bench.discrepancy.joint.mixture import Mixture, worth
from bench.discrepancy.joint.ranged import by_ranges
from bench.discrepancy.joint.statistics import Statistics
from bench.discrepancy.settings import SCORE_FIRST, SCORE_MEMBERS
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.propagation.obstructed_path import ObstructedPath

WEAK = ObstructedPath(share=0.35, loss_db=10.0, loss_spread_db=1.0, common=0.0, delay_m=0.2)
LOST = BlockedPath(share=0.3, detour_m=1.5, reflection_db=-5.0)


def found_of(hidden, kind):
    """Return the coarse mixture of a kind in recordings of a hidden effect, and what is simulated
    without it."""
    comparison, rows = compared(recordings((hidden,), 4))
    mixture = Mixture(Statistics(comparison, rows), (), kind)
    found = worth(mixture, mixture.fitted())
    assert found is not None
    return found, comparison.ensemble(rows, (), SCORE_MEMBERS, SCORE_FIRST)


def test_values_from_many_starts_are_no_less_likely_and_nearer():
    coarse, _ = found_of(WEAK, ObstructedPath)
    fine = climbed(coarse)
    assert fine.best.best >= coarse.best.best
    assert fine.best.values["loss_db"] == pytest.approx(WEAK.loss_db, abs=2.5)
    assert fine.mixture is coarse.mixture


def test_a_search_that_begins_on_a_wrong_top_leaves_it():
    coarse, _ = found_of(WEAK, ObstructedPath)
    values = {**coarse.best.values, "loss_db": 1.8, "loss_spread_db": 9.0, "delay_m": 0.9}
    wrong = coarse.mixture.at(values)
    assert wrong is not None
    stuck = replace(coarse, best=wrong)
    assert climbed(stuck).best.best > wrong.best + 5
    assert climbed(stuck).best.values["loss_db"] == pytest.approx(WEAK.loss_db, abs=2.5)


def test_ranges_of_struck_links_tell_how_long_a_detour_is():
    coarse, made = found_of(LOST, BlockedPath)
    near = coarse.mixture.at({**coarse.best.values, "detour_m": 0.05})
    assert near is not None
    short = replace(coarse, best=near)
    told = by_ranges(short, made)
    assert told.best.values["detour_m"] > 0.5
    assert told.best.ranged > by_ranges_nats(short)


def by_ranges_nats(found):
    """Return what ranges say of a mixture as it is."""
    return found.mixture.ranges(found.best.values)


def test_ranges_that_nobody_knows_change_nothing():
    coarse, made = found_of(LOST, BlockedPath)
    blank = replace(made, versions=np.where(
        np.array(made.names) == RANGE, np.nan, made.versions))  # fmt: skip
    assert by_ranges(coarse, blank) is coarse


def test_shares_are_where_values_lie_within_their_bounds():
    coarse, _ = found_of(WEAK, ObstructedPath)
    made = coarse.mixture.at({**coarse.best.values, "loss_db": 15.0, "delay_m": 0.25})
    assert made is not None
    shares = shares_of(coarse.mixture, made)
    assert shares["loss_db"] == pytest.approx(0.25)
    assert shares["delay_m"] == pytest.approx(0.25)
    end = ascended(replace(coarse, best=made))
    assert end.best.whole >= made.whole


def test_intervals_hold_what_was_hidden():
    found = found_in(recordings((WEAK,), 4))
    assert found is not None
    assert found.effect.name == "obstructed-path"
    told = {one.name: one for one in found.parameters}
    assert told["loss_db"].low <= WEAK.loss_db <= told["loss_db"].high
    assert told["delay_m"].low <= WEAK.delay_m <= told["delay_m"].high
    assert told["loss_db"].high - told["loss_db"].low < 12
