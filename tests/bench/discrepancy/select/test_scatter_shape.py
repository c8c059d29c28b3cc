"""Independent scatter has one hump; a detour strikes links, not rows."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.select.scatter_shape import bounded, overdone, scatters_alike, shape, steady
from bench.discrepancy.select.within_links import coarsest_m, rows_off
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter

LINKS = np.repeat(np.arange(60), 5)


def ensemble(error_m: np.ndarray, scatter_m: float) -> Ensemble:
    """Recorded errors beside twelve versions of normal scatter."""
    rng = np.random.default_rng(1)
    simulated = rng.normal(0, scatter_m, (12, len(error_m)))
    versions = np.concatenate([error_m[None], simulated])[..., None]
    return Ensemble(("error_m",), ("m",), versions, LINKS)


@pytest.mark.parametrize("seed", range(5))
def test_scatter_of_the_same_kind_is_taken_as_such(seed: int) -> None:
    rng = np.random.default_rng(seed)
    assert shape(ensemble(rng.normal(0, 0.07, 300), 0.07)).adequate
    assert shape(ensemble(rng.laplace(0, 0.05, 300), 0.07)).adequate


def test_a_constant_beside_scatter_is_no_other_shape() -> None:
    rng = np.random.default_rng(7)
    assert shape(ensemble(rng.normal(-0.02, 0.07, 300), 0.07)).adequate
    struck = 0.4 * (rng.random(60) < 0.3)[LINKS]  # what strikes some links is no constant
    assert not shape(ensemble(rng.normal(0.02, 0.022, 300) + struck, 0.18)).adequate


def test_rows_that_jump_are_no_scatter() -> None:
    rng = np.random.default_rng(2)
    jumped = rng.normal(0, 0.022, 300) + 0.4 * (rng.random(300) < 0.3) - 0.12
    assert not shape(ensemble(jumped, float(jumped.std()))).adequate


@pytest.mark.parametrize("form", ["arcsine", "two humps", "uniform"])
def test_bounded_jitter_is_scatter_where_links_are_alike(form: str) -> None:
    rng = np.random.default_rng(5)
    made = {
        "arcsine": 0.14 * np.sin(rng.uniform(0, 2 * np.pi, 300)),
        "two humps": 0.1 * rng.choice([-1.0, 1.0], 300),
        "uniform": rng.uniform(-0.17, 0.17, 300),
    }[form]
    jittered = made + rng.normal(0, 0.015, 300)
    assert shape(ensemble(jittered, 0.1)).adequate
    wide = jittered * rng.uniform(0.2, 1.8, 60)[LINKS]  # a second path differs from link to link
    assert not bounded(wide, LINKS)
    assert not bounded(jittered[:30], LINKS[:30])  # too few for a shape
    rare = rng.normal(0, 0.03, 300) + 0.4 * (rng.random(300) < 0.2)
    assert not bounded(rare, LINKS)


def test_detours_strike_links_and_jumps_strike_rows() -> None:
    rng = np.random.default_rng(3)
    noise = rng.normal(0, 0.022, 300)
    links, rows = rng.random(60) < 0.2, rng.random(300) < 0.3
    assert rows_off(ensemble(noise + 0.8 * links[LINKS], 0.022)) == 0
    assert rows_off(ensemble(noise + 0.4 * rows, 0.022)) > 0.15
    moving = 6.0 * links[LINKS] * rng.uniform(0.8, 1.2, 300)  # detours change while devices move
    assert rows_off(ensemble(noise + moving, 0.022)) == 0
    assert rows_off(ensemble(rng.normal(0, 0.1, 300), 0.022)) < 0.02


def test_rows_that_jump_by_a_step_as_simulated_ones_do_are_not_off() -> None:
    rng = np.random.default_rng(4)
    true = rng.uniform(3, 20, 60)[LINKS]
    errors = 0.5 * np.rint((true + rng.normal(0, 0.04, (13, 300))) / 0.5) - true
    both = Ensemble(("error_m",), ("m",), errors[..., None], LINKS)
    assert rows_off(both) < 0.01
    alone = np.concatenate([errors[:1], rng.normal(0, 0.04, (12, 300))])
    assert rows_off(Ensemble(("error_m",), ("m",), alone[..., None], LINKS)) > 0.02


def test_one_step_of_a_rounding_is_no_jump_however_often_rows_take_it() -> None:
    """Recorded links may lie between two points of a grid more often than simulated ones."""
    rng = np.random.default_rng(4)
    error_m = 0.27 * np.rint(rng.normal(0.13, 0.05, 300) / 0.27)
    between = ensemble(error_m + 0.8 * (rng.random(60) < 0.2)[LINKS], 0.001)
    assert rows_off(between) > 0.1
    assert coarsest_m((RangeRounding(step_m=0.27), AntennaDelay())) == 0.27
    assert rows_off(between, 0.27) == 0
    assert rows_off(ensemble(error_m + 2.0 * (rng.random(300) < 0.3), 0.001), 0.27) > 0.15
    assert coarsest_m(()) == 0


def test_where_rows_of_a_link_scatter_as_simulated_nothing_scatters_them() -> None:
    rng = np.random.default_rng(4)
    steady_rows = rng.normal(0, 0.03, 300) + rng.normal(0, 0.1, 60)[LINKS]  # links differ alone
    jittered = rng.normal(0, 0.07, 300) + rng.normal(0, 0.1, 60)[LINKS]
    for error_m, told in ((steady_rows, True), (jittered, False)):
        rest, whole = (ensemble(error_m, scatter) for scatter in (0.03, 0.1))
        assert steady(whole, rest) == told
    assert not steady(rest, rest)  # what draws nothing for rows is not asked


def test_a_jitter_as_wide_as_offsets_that_links_keep_is_overdone() -> None:
    rng = np.random.default_rng(6)
    for jitter_m, told in ((0.0, True), (0.1, False)):
        error_m = rng.normal(0, np.hypot(0.03, jitter_m), 300) + rng.normal(0, 0.1, 60)[LINKS]
        rest, whole = (ensemble(error_m, scatter) for scatter in (0.03, 0.1))
        assert overdone(whole, rest) == told
    assert not overdone(rest, rest)  # nor is what draws nothing for rows


@pytest.mark.parametrize("waveform", [True, False])
@pytest.mark.parametrize(("jitter_m", "named"), [(0.05, False), (0.2, True)])
def test_what_links_keep_is_no_jitter_beside_waveforms_either(
    waveform: bool, jitter_m: float, named: bool
) -> None:
    """Rows of a link scatter more than simulated, but by far less than the jitter that was fitted.

    A score of single rows takes for jitter what links keep, too.
    """
    rng = np.random.default_rng(8)
    kept_m = np.sqrt(0.2**2 - jitter_m**2) * rng.normal(0, 1, 60)[LINKS]
    error_m = rng.normal(0, np.hypot(0.03, jitter_m), 300) + kept_m
    rest, whole = (ensemble(error_m, scatter) for scatter in (0.03, 0.2))
    view = SimpleNamespace(waveform=waveform, recorded=SimpleNamespace(names=("error_m",)))
    comparison = SimpleNamespace(ensemble=lambda _rows, added, *_: whole if added else rest)
    jitter = TimestampJitter()
    found = scatters_alike(cast(Any, comparison), cast(Any, view), (jitter,), jitter)
    assert found.adequate is named
    assert named or found.note == "rows of one link scatter far less than with it"


def test_a_few_simulated_ranges_far_off_hide_no_wider_rows() -> None:
    """Their variance is as large as that of a jitter which every recorded row has."""
    rng = np.random.default_rng(4)
    jittered, plain = rng.normal(0, 0.04, 300), rng.normal(0, 0.01, 300)
    far = np.where(rng.random((12, 300)) < 0.01, 0.8, 0.0)
    for recorded, told in ((jittered, False), (plain, True)):
        rest = ensemble(recorded, 0.01)
        rest.versions[1:, :, 0] += far
        more = rng.normal(0, 0.04, (12, 300))
        whole = ensemble(recorded, 0.01)
        whole.versions[1:, :, 0] = rest.versions[1:, :, 0] + more
        assert steady(whole, rest) == told
