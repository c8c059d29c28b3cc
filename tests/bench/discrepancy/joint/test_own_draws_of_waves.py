"""A table that repeats what a link has drawn is no sign that waveforms differ; SIMULATED."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Added, View, view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.joint import chance
from bench.discrepancy.joint.chance import by_chance, highest, near, off
from bench.discrepancy.joint.polish import Fit, fitted
from bench.discrepancy.joint.sets import Sets
from bench.discrepancy.joint.settings import NAME_NATS
from bench.discrepancy.joint.statistics import Statistics
from bench.physics.base import Base
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.effects.receiver.pulse_ringing import PulseRinging
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS, REPEATED = 60, 4
KINDS = (PulseRinging, NoiseFloor, PathLoss)


def echoed(hidden: Added, places: pd.DataFrame, rows: int, seed: int) -> pd.DataFrame:
    """Return rows of every place, all with the echo and the level that their link has drawn."""
    rng = np.random.default_rng(seed)
    late, size = rng.integers(8, 40, LINKS), rng.uniform(0.1, 0.5, LINKS)
    frame = pd.concat([places] * rows, ignore_index=True)
    made = Simulator(Base(), hidden, seed, "test").observe(scene(frame), seed, seed).table(frame)
    level_db = np.tile(rng.normal(0, 1.5, LINKS), rows)
    echo = zip(made["cir"], np.tile(late, rows), np.tile(size, rows), level_db, strict=True)
    cirs = [10 ** (db / 20) * (cir + a * np.roll(cir, by)) for cir, by, a, db in echo]
    levels = {name: made[name] + level_db for name in ("rx_power_dbm", "first_path_power_dbm")}
    return made.assign(cir=cirs, **levels)


def compared(hidden: Added) -> tuple[TableComparison, View]:
    """Return recorded rows of links beside a table that has each link several times alike."""
    rng = np.random.default_rng(4)
    places = pd.DataFrame(
        {
            "link": [f"l{i}" for i in range(LINKS)],
            "true_range_m": rng.uniform(2, 15, LINKS),
            "tx": "t",
            "rx": "r",
        }
    )
    recorded, table = echoed(hidden, places, 1, 5), echoed((), places, REPEATED, 6)
    window = window_of(recorded)
    rows = view(recorded, link_codes(recorded), np.arange(LINKS), window)
    return TableComparison(table, window), rows


@pytest.mark.parametrize("hidden", [(), (PulseRinging(ring_db=-8.0, ring_delay_ns=5.0),)])
def test_what_links_draw_by_themselves_is_no_effect(hidden: Added) -> None:
    comparison, rows = compared(hidden)
    found = Sets(comparison, rows, rows, KINDS).chosen()
    assert [effect.name for effect in found.named] == [one.name for one in hidden]
    assert not found.unexplained


def test_versions_of_one_link_do_not_tell_what_links_draw() -> None:
    comparison, rows = compared(())
    given = Statistics(comparison, rows)
    wide = given.needed(()).covariances[1]
    place = given.names.index("rx_power_dbm")
    assert wide[place, place] == pytest.approx(2 * 1.5**2, rel=0.5)  # both sides have drawn
    assert given.crowding == 1.0  # no simulated link stands for two


def test_where_similar_links_lack_a_statistic_there_are_no_others() -> None:
    comparison, rows = compared(())
    given = Statistics(comparison, rows)
    given.names = (*given.names, "not_simulated_db")
    assert len(given.others((NoiseFloor(),))) == 0


def test_what_an_effect_brings_on_simulated_links_does_not_count() -> None:
    comparison, rows = compared(())
    given = Statistics(comparison, rows)
    bare, ringing = fitted(given, ()), fitted(given, (PulseRinging(ring_db=-30.0),))
    assert bare is not None
    assert ringing is not None
    assert ringing.nats - bare.nats - by_chance(given, ringing, bare) < NAME_NATS


def test_simulated_links_that_lack_nothing_have_the_rest_of_a_set(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Links without the noise of the rest scatter less: beside the rest that would bring much."""
    comparison, rows = compared(())
    given, noise = Statistics(comparison, rows), NoiseFloor(level_db=10.0)
    rest, whole = fitted(given, (noise,)), fitted(given, (noise, PulseRinging(ring_db=-30.0)))
    assert rest is not None
    assert whole is not None
    asked: list[Added] = []
    plain = given.others_rows

    def seen(added: Added) -> NDArray[np.float64]:
        asked.append(added)
        return plain(added)

    monkeypatch.setattr(given, "others_rows", seen)
    by_chance(given, whole, rest)
    assert asked == [(noise,)]


def test_a_bound_for_one_more_holds_that_often() -> None:
    draws = np.random.default_rng(0).normal(size=(4000, 9))
    over = [one[8] > highest(list(one[:8])) for one in draws]
    assert np.mean(over) == pytest.approx(0.01, abs=0.005)
    assert highest([5.0]) == 0.0  # one says nothing of scatter


def test_simulated_links_may_be_as_far_off_as_recorded_ones() -> None:
    """First paths found too early in some rows, on both sides alike: no normal statistic."""
    rng = np.random.default_rng(2)
    frame = pd.DataFrame(
        {"link": [f"l{i}" for i in range(LINKS)], "true_range_m": rng.uniform(2, 15, LINKS)}
    )
    made = Simulator(Base(), (), 5, "test").observe(scene(frame), 5, 77).table(frame)
    window = window_of(made)
    rows = view(made, link_codes(made), np.arange(LINKS), window)
    given = Statistics(Resimulation(Simulator(Base(), (), 11, "test"), window), rows)
    fit = fitted(given, ())
    assert fit is not None
    assert len(given.others(())) >= 3
    assert not off(given, fit, fit)


def test_a_set_may_leave_a_small_share_of_what_was_there() -> None:
    comparison, rows = compared((PulseRinging(ring_db=-8.0, ring_delay_ns=5.0),))
    given = Statistics(comparison, rows)
    bare = fitted(given, ())
    assert bare is not None
    far = replace(bare, moments=replace(bare.moments, left=bare.moments.left * 10))
    assert off(given, bare, bare)
    assert not off(given, bare, far)


def test_what_simulated_links_are_off_by_is_no_part_of_that_share(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of mean squares of 38 and, left, 1.4, where chance makes 0.9: the set left 0.5 of 37."""
    comparison, rows = compared(())
    given, rng = Statistics(comparison, rows), np.random.default_rng(0)
    bare = fitted(given, ())
    assert bare is not None
    shape = bare.moments.left.shape
    draws = [rng.normal(0, np.sqrt(0.9), shape) for _ in range(8)]
    monkeypatch.setattr(given, "others", lambda _: np.stack(draws))
    monkeypatch.setattr(chance, "misfits", lambda _, moments, __: moments.left)

    def leaving(square: float) -> Fit:
        left = rng.normal(0, np.sqrt(square), shape)
        return replace(bare, moments=replace(bare.moments, left=left))

    assert not off(given, leaving(1.4), leaving(38.0))
    assert off(given, leaving(1.4), leaving(10.0))
    assert off(given, leaving(2.4), leaving(38.0))


def test_a_few_links_that_are_far_off_in_one_figure_refuse_no_set() -> None:
    """First paths are found early or late in a few rows: how many, a detector decides."""
    left = np.random.default_rng(1).normal(size=(80, 20))
    struck = left.copy()
    struck[:3, 5] = 40.0
    assert near(struck) == pytest.approx(near(left), abs=0.02)
    assert near(2 * left) > 3 * near(left)  # what all links are off by counts
