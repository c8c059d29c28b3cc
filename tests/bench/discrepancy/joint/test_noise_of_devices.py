"""Noise floors: of every device another, and beside what is louder but does nothing to them."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import Added, View, view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.joint import remains
from bench.discrepancy.joint import sets as module
from bench.discrepancy.joint.apart import brought_alone, logged, unlogged, untouched
from bench.discrepancy.joint.likelihood import left_free, misfits
from bench.discrepancy.joint.polish import Fit, fitted, polished
from bench.discrepancy.joint.row_likelihood import come_and_gone
from bench.discrepancy.joint.sets import Sets
from bench.discrepancy.joint.settings import LEFT_NATS, NAME_NATS, SCATTERED_SHARE
from bench.discrepancy.joint.statistics import Statistics
from bench.discrepancy.joint.tone_or_noise import counterparts
from bench.physics.base import Base
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS = 60
STEEPER = PathLoss(exponent=2.3, offset_db=-0.5)
TWINS = NarrowbandInterference(level_db=0.0), NoiseFloor(level_db=3.0)
WHITE = {"lag_1": 0.0, "lag_2": 0.0, "lag_3": 0.0}


def statistics(hidden: Added) -> Statistics:
    """Return the statistics of 60 links with CIRs of five receivers; SIMULATED."""
    return Statistics(*compared(made_with(hidden)))


def made_with(hidden: Added) -> pd.DataFrame:
    """Return 60 links with CIRs of five receivers; SIMULATED."""
    rng = np.random.default_rng(3)
    frame = pd.DataFrame(
        {
            "link": [f"l{i}" for i in range(LINKS)],
            "true_range_m": rng.uniform(2, 15, LINKS),
            "tx": [f"t{i % 3}" for i in range(LINKS)],
            "rx": [f"r{i % 5}" for i in range(LINKS)],
        }
    )
    return Simulator(Base(), hidden, 5, "test").observe(scene(frame), 5, 77).table(frame)


def compared(frame: pd.DataFrame) -> tuple[Resimulation, View]:
    """Return rows beside a simulator that hides nothing."""
    window = window_of(frame)
    rows = view(frame, link_codes(frame), np.arange(len(frame)), window)
    return Resimulation(Simulator(Base(), (), 11, "test"), window), rows


def fit_of(given: Statistics, effects: Added) -> Fit:
    """Return a set as fitted from where it is."""
    made = polished(given, effects)
    assert made is not None
    return made


def test_a_noise_floor_of_every_device_leaves_nothing_without_a_name():
    """Receivers have noise figures of their own: no uniform level is right for any of them."""
    given = statistics((NoiseFloor(level_db=4.0, device_spread_db=2.0, **WHITE),))
    fit = fit_of(given, (NoiseFloor(level_db=4.0, **WHITE),))
    uniform = replace(fit.moments, own=None, uneven=None)
    assert given.devices.shape == (LINKS, 8)
    of_one = left_free(given, uniform, fit.responses, fit.parameters)
    of_each = left_free(given, fit.moments, fit.responses, fit.parameters)
    assert max(of_one) > LEFT_NATS > max(of_each)
    at_one, at_each = (misfits(given, each, fit.responses) for each in (uniform, fit.moments))
    assert (at_each**2).mean() < 1 < (at_one**2).mean()


def test_a_noise_floor_of_every_device_is_no_tone_that_fades():
    """Though a tone of one level that scatters fits as well as one level for all receivers."""
    given = statistics((NoiseFloor(level_db=2.0, device_spread_db=2.0, **WHITE),))
    sets = Sets(given.comparison, given.rows, given.rows, (NoiseFloor, NarrowbandInterference))
    found = sets.chosen()
    assert [effect.name for effect in found.added] == ["noise-floor"]


def test_what_every_device_has_of_its_own_is_none_of_an_effect_of_the_way():
    given = statistics((STEEPER,))
    made = fitted(given, (STEEPER,))
    assert made is not None
    assert made.moments.own is None
    assert made.moments.uneven is None


def test_a_noise_that_comes_and_goes_is_no_tone():
    """Lamps blink: of every link another noise, so it scatters as a tone does that fades."""
    frames = [made_with((NoiseFloor(level_db=level, **WHITE),)) for level in (0.5, 3.0, 7.0)]
    lit = np.random.default_rng(1).integers(0, len(frames), LINKS)
    given = Statistics(*compared(pd.concat([frames[k].iloc[[i]] for i, k in enumerate(lit)])))
    floor = fit_of(given, (NoiseFloor(level_db=4.0, **WHITE),))
    tone = fit_of(given, counterparts(floor.effects[0]))
    assert floor.moments.uneven is not None
    assert floor.nats > tone.nats + NAME_NATS
    even = replace(floor.moments, uneven=None)
    left, of_even = (misfits(given, one, floor.responses) for one in (floor.moments, even))
    assert (left**2).mean() < 1 < (of_even**2).mean()


def test_noise_may_come_and_go_from_row_to_row():
    """Lamps blink within a link, too: no second cause that draws every row anew makes noise so."""
    frames = [made_with((NoiseFloor(level_db=level, **WHITE),)) for level in (1.0, 6.0)]
    every = pd.concat([frames[i // LINKS].iloc[[i % LINKS]] for i in range(2 * LINKS)])
    given = Statistics(*compared(every))
    assert given.told_within
    floor = fit_of(given, (NoiseFloor(level_db=4.0, **WHITE),))
    tone = fit_of(given, counterparts(floor.effects[0]))
    assert floor.moments.uneven_rows is not None
    assert floor.nats > tone.nats + NAME_NATS
    steady = come_and_gone(given, floor.moments, floor.moments.uneven, None)
    assert floor.moments.within > steady.within + NAME_NATS


@pytest.mark.parametrize(("level_db", "needed"), [(0.8, True), (0.0, False)])
def test_noise_counts_beside_a_louder_path_loss_by_what_is_logged_of_it(
    level_db: float, needed: bool
) -> None:
    """Samples after the pulse are weaker for either reason, the noise that is logged for one."""
    noise = NoiseFloor(level_db=level_db, **WHITE)
    given = statistics((STEEPER, noise))
    both, rest = fit_of(given, (STEEPER, replace(noise, level_db=0.8))), fit_of(given, (STEEPER,))
    names = [given.names[i] for i in untouched(given, both, "noise-floor")]
    assert "noise_std" in names
    assert "rx_power_dbm" not in names
    assert (brought_alone(given, both, rest, "noise-floor") > NAME_NATS) is needed


def test_noise_that_is_logged_as_noise_is_named_though_what_has_no_form_would_do_as_well(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given = statistics((NoiseFloor(level_db=5.0, **WHITE),))
    kinds = (NoiseFloor, PathLoss)
    monkeypatch.setattr(module, "beside_unformed", lambda *_: 0.0)
    sets = Sets(given.comparison, given.rows, given.rows, kinds)
    assert [effect.name for effect in sets.chosen().named] == ["noise-floor"]
    monkeypatch.setattr(module, "logged", lambda *_: False)
    assert sets.chosen().doubted == ("noise-floor",)


def test_only_noise_is_logged_as_noise_and_only_where_nothing_else_moves_the_log():
    given = statistics((STEEPER, NoiseFloor(level_db=3.0, **WHITE)))
    both = fit_of(given, (STEEPER, NoiseFloor(level_db=3.0, **WHITE)))
    rest = fit_of(given, (STEEPER,))
    assert logged(given, both, rest, "noise-floor")
    assert not logged(given, both, rest, "path-loss")
    twice = fit_of(given, (NoiseFloor(level_db=3.0, **WHITE), NarrowbandInterference(level_db=1.0)))
    assert not logged(given, twice, twice, "noise-floor")


def test_noise_of_another_size_than_its_log_says_is_not_what_is_logged() -> None:
    noise = NoiseFloor(level_db=12.0, **WHITE)
    given = statistics((noise,))
    rest = fit_of(given, ())
    right, low = (fitted(given, (replace(noise, level_db=level),)) for level in (12.0, 1.0))
    assert right is not None
    assert low is not None
    assert logged(given, right, rest, "noise-floor")
    assert not logged(given, low, rest, "noise-floor")


def test_noise_that_is_lower_in_the_profile_but_not_in_its_log_is_none() -> None:
    """A mean that is taken off lowers weak samples; the receiver logs its noise before."""
    quieter = NoiseFloor(level_db=-3.0, **WHITE)
    frame, plain = made_with((quieter,)), made_with(())
    for log, is_noise in ((plain["noise_std"], False), (frame["noise_std"], True)):
        given = Statistics(*compared(frame.assign(noise_std=log.to_numpy())))
        sets = Sets(given.comparison, given.rows, given.rows, (NoiseFloor, PathLoss))
        found = [effect.name for effect in sets.chosen().added]
        assert ("noise-floor" in found) is is_noise
        fit, rest = fit_of(given, (quieter,)), fit_of(given, ())
        assert unlogged(given, fit, rest, "noise-floor") is not is_noise


@pytest.mark.parametrize(("share", "sure"), [(0.9, True), (1.1, False)])
def test_what_scatters_may_leave_a_hundredth_over_what_is_known(
    share: float, sure: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Shadowing hides what goes with a covariate; but of what explains much, a little is left."""
    shadowed = PathLoss(exponent=2.3, offset_db=-12.0, shadowing_db=6.0)
    given = statistics((shadowed,))
    sets = Sets(given.comparison, given.rows, given.rows, (PathLoss,))
    monkeypatch.setattr(remains, "off", lambda *_: False)
    explained = sets.chosen().explained
    most = max(LEFT_NATS, SCATTERED_SHARE * explained)
    monkeypatch.setattr(remains, "left_free", lambda *_: (0.0, share * most))
    assert sets.chosen().unexplained is not sure


@pytest.mark.parametrize(
    ("logs", "heard", "shown"), [(5.0, 0.0, True), (0.0, 9.0, True), (0.0, 0.0, False)]
)
def test_a_tone_is_shown_by_samples_of_noise_or_by_a_noise_floor_that_is_logged(
    monkeypatch: pytest.MonkeyPatch, logs: int, heard: float, shown: bool
) -> None:
    """What is logged of a noise floor is a tone's or its own: one of them is there."""
    tone, floor = (SimpleNamespace(effects=(one,), names=(one.name,)) for one in TWINS)
    sets = Sets.__new__(Sets)
    sets.given, sets.none = SimpleNamespace(), SimpleNamespace()
    sets.fits = {frozenset(floor.names): floor, frozenset(tone.names): tone}
    sets.screen = SimpleNamespace(points={floor.names[0]: ()})
    sets.quiet = SimpleNamespace(nats=lambda effects: heard)
    monkeypatch.setattr(Sets, "_without", lambda *_: SimpleNamespace(effects=()))
    sets.weighing = SimpleNamespace(plain=lambda fit: fit)
    monkeypatch.setattr(module, "logged", lambda _, fit, rest, name: fit is floor and bool(logs))
    assert sets._shown(tone, tone.names[0]) is shown
    assert sets._logged(tone, tone.names[0]) is bool(logs)
