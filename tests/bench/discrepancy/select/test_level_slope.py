"""The slope of levels is that of links, as wide as their shadowing leaves it."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.link_line import link_line
from bench.discrepancy.select.backfitting import polished
from bench.discrepancy.select.level_slope import (
    absorbed,
    told_by_links,
    with_absorption,
    with_slope,
)
from bench.discrepancy.select.refute import fits
from bench.discrepancy.select.state import Search
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.ranging.range_scale import RangeScale
from tests.bench.discrepancy.numpy_tables import tables


def search_of(
    seed: int, exponent: float, offset_db: float, paired: bool = True, per_metre_db: float = 0.0
) -> Search:
    """Return a search of SIMULATED tables whose recorded levels have this path loss."""
    recorded, simulated = tables(seed, paired=paired, replicas=1)
    frame = recorded.frame
    lost = (exponent - 2) * 10 * np.log10(frame["true_range_m"]) + offset_db
    lost += per_metre_db * frame["true_range_m"]
    frame = frame.assign(rx_power_dbm=frame["rx_power_dbm"] - lost)
    every = np.arange(len(frame))
    seen = view(frame, link_codes(frame), every, Window(), None, False)
    return Search(TableComparison(simulated.frame, Window()), seen, seen, {}, 0, work=seen)


@pytest.mark.parametrize("paired", [True, False])
def test_intervals_hold_an_exponent_as_often_as_they_say(paired: bool) -> None:
    effect, held = PathLoss(exponent=2.2), []
    for seed in range(16):
        told = told_by_links(search_of(seed, 2.3, 1.5, paired), (), effect)
        values = {one.name: one for one in told}
        held += [values["exponent"].low <= 2.3 <= values["exponent"].high]
        held += [values["offset_db"].low <= 1.5 <= values["offset_db"].high]
    assert np.mean(held) >= 0.7
    assert values["exponent"].high - values["exponent"].low < 0.4


def test_a_line_is_that_of_a_plain_regression_but_for_links_behind_metal() -> None:
    rng = np.random.default_rng(3)
    x = rng.uniform(5, 16, 300)
    y = 2.0 - 0.4 * x + rng.normal(0, 1.2, 300)
    found, spread = link_line(x, y)
    plain, errors = np.polyfit(x, y, 1, cov=True)
    assert found[::-1] == pytest.approx(plain, abs=0.5 * np.sqrt(errors[1, 1]))
    assert np.sqrt(spread[1, 1]) == pytest.approx(np.sqrt(errors[0, 0]), rel=0.2)
    assert link_line(x, y - 30.0 * (x > 15.8))[0] == pytest.approx(found, abs=0.6)


def test_a_path_loss_has_the_values_that_links_say_and_all_else_its_own() -> None:
    search, scale = search_of(1, 2.5, 0.0), RangeScale(scale=0.01)
    made = with_slope(search, (scale, PathLoss(exponent=1.7, offset_db=7.5, shadowing_db=0.3)))
    assert made[0] is scale
    assert isinstance(made[1], PathLoss)
    assert made[1].exponent == pytest.approx(2.5, abs=0.2)
    assert made[1].shadowing_db == 0.3
    assert told_by_links(search, (), scale) == ()


def test_so_many_db_everywhere_are_said_as_such() -> None:
    effect = PathLoss(exponent=1.95, offset_db=4.5)
    why = fits(search_of(2, 2.0, 4.0), (effect,), effect)
    assert not why.adequate
    assert "dB in all rows does as well" in why.note


def test_what_is_lost_in_every_metre_bends_a_path_loss() -> None:
    effect = PathLoss(exponent=3.0, offset_db=-5.0, shadowing_db=3.0)
    search = search_of(3, 2.0, 0.0, per_metre_db=0.8)
    (made,) = with_absorption(search, (effect,))
    assert isinstance(made, PathLoss)
    assert made.per_metre_db == pytest.approx(0.8, abs=0.2)
    assert made.exponent == pytest.approx(2.0, abs=0.4)
    assert made.shadowing_db < 3.0
    assert fits(search, (made,), made).adequate  # though its exponent may be that of free space
    (again,) = polished(search.comparison, search.fit, (made,), 1, False)
    assert isinstance(again, PathLoss)
    assert again.per_metre_db == made.per_metre_db  # no search fits it, none loses it


def test_a_loss_per_metre_has_an_interval_and_leaves_the_exponent_unsure() -> None:
    bent = PathLoss(exponent=2.0, per_metre_db=0.8)
    told = {one.name: one for one in told_by_links(search_of(3, 2.0, 0.0, True, 0.8), (), bent)}
    line = {one.name: one for one in told_by_links(search_of(3, 2.0, 0.0), (), PathLoss())}
    assert told["per_metre_db"].low <= 0.8 <= told["per_metre_db"].high
    assert told["per_metre_db"].determined
    wide, narrow = (each["exponent"].high - each["exponent"].low for each in (told, line))
    assert wide > 1.5 * narrow  # a line over the distance and its logarithm are much alike
    assert "per_metre_db" not in line


def test_a_line_over_the_logarithm_is_not_bent() -> None:
    effect, scale = PathLoss(exponent=2.6, shadowing_db=1.0), RangeScale(scale=0.01)
    assert with_absorption(search_of(3, 2.6, 1.0), (effect, scale)) == (effect, scale)
    rng = np.random.default_rng(5)
    far_m = rng.uniform(3, 60, 80)
    bends = [absorbed(far_m, rng.normal(0, 2, 80) - 0.1 * np.minimum(far_m, 20))[0] for _ in "abcd"]
    assert bends == [0.0] * 4  # nor is one that levels off
