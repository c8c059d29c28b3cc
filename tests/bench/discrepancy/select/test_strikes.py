"""Links struck at random: evidence by likelihood, and the search that goes on without them."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.method import select_effects
from bench.discrepancy.report.found_lines import describe
from bench.discrepancy.select.by_offsets import witnessed
from bench.discrepancy.select.link_mixture import (
    apart,
    link_medians,
    offsets,
    strikable,
    strike,
)
from bench.discrepancy.select.state import Search
from bench.physics.base import Base
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.propagation.diffraction import Diffraction
from bench.physics.effects.propagation.obstructed_path import ObstructedPath
from bench.physics.effects.ranging.temperature import TemperatureDrift
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.simulator import Simulator

BASE = Simulator(Base(), (TimestampJitter(jitter_samples=0.08),), 3)
WORLD = Resimulation(BASE, Window())
KINDS = {"blocked-path": BlockedPath, "temperature-drift": TemperatureDrift}
LINKS, ROWS = 90, 6


def _recorded(struck: int, metres: float, sighted: bool = False, drift_m: float = 0.0) -> View:
    """Return ranges with `metres` added on some links without sight (or with it)."""
    rng = np.random.default_rng(5)
    link = np.repeat(np.arange(LINKS), ROWS)
    dark = np.arange(LINKS) % 3 == 0
    frame = pd.DataFrame(
        {
            "link": [f"l{i}" for i in link],
            "true_range_m": rng.uniform(2, 20, LINKS)[link],
            "los": ~dark[link],
            "temperature_c": rng.uniform(0, 50, LINKS)[link],
        }
    )
    chosen = rng.permutation(np.flatnonzero(~dark if sighted else dark))[:struck]
    error = 0.024 * rng.normal(size=len(link))
    error += np.where(np.isin(link, chosen), metres * rng.uniform(0.5, 1.5, LINKS)[link], 0.0)
    error += drift_m * (frame["temperature_c"] - 25) / 25
    frame["error_m"], frame["range_m"] = error, frame["true_range_m"] + error
    return view(frame, link_codes(frame), np.arange(len(frame)), Window(), ("error_m",), False)


def test_a_few_struck_links_are_found_and_counted():
    found = strike(WORLD, _recorded(3, 0.8), (), (), KINDS)
    assert found is not None
    assert isinstance(found.effect, BlockedPath)
    assert 0.04 <= found.effect.share <= 0.25  # 3 of 30 without sight
    low, high = next((p.low, p.high) for p in found.parameters if p.name == "share")
    assert low <= 0.1 <= high
    assert len(found.struck) == 3


@pytest.mark.parametrize("struck", [0, 20])
def test_what_moves_all_links_strikes_none_of_them(struck: int) -> None:
    """A delay and a scale of 0.3 to 0.8 m leave no link calm; some are blocked beside it, or none.

    Which ways are clear is not told.
    """
    rows = _recorded(0, 0.0)
    rng, code = np.random.default_rng(2), np.unique(rows.links, return_inverse=True)[1]
    detours = np.where(rng.permutation(LINKS) < struck, 0.8 + rng.exponential(1.0, LINKS), 0.0)
    true = rows.frame["true_range_m"].to_numpy()
    error = rows.frame["error_m"].to_numpy() + 0.25 + 0.03 * true + detours[code]
    frame = rows.frame.assign(error_m=error, range_m=true + error).drop(columns="los")
    links, every = link_codes(frame), np.arange(len(frame))
    moved = view(frame, links, every, Window(), ("error_m",), False)
    found = strike(WORLD, moved, (), (), KINDS)
    assert (found is not None) is (struck > 0)
    if found is not None:
        assert set(found.struck) == set(links[detours[code] > 0])


@pytest.mark.parametrize("around_m", [0.0, 0.24])
def test_links_around_the_same_are_no_struck_ones(around_m: float) -> None:
    """Half of what is out of sight is behind metal, all of that a quarter of a metre late."""
    seen = _recorded(6, 2.0)
    frame = seen.frame.copy()
    late = frame["error_m"].to_numpy() > 0.5
    place = frame["link"].str[1:].astype(int).to_numpy()
    metal, wood = (~frame["los"]) & (place % 2 == 0), (~frame["los"]) & (place % 2 == 1)
    frame["obstacles"] = [
        ["metal"] if a else ["wood"] if b else [] for a, b in zip(metal, wood, strict=True)
    ]
    frame["error_m"] += np.where(metal, around_m, 0.0)
    frame["range_m"] = frame["true_range_m"] + frame["error_m"]
    codes = link_codes(frame)
    rows = view(frame, codes, np.arange(len(frame)), Window(), ("error_m",), False)
    found = strike(WORLD, rows, (), (), KINDS | {"diffraction": Diffraction})
    assert found is not None
    assert set(found.struck) == set(codes[late])


def test_no_evidence_where_nothing_struck():
    assert strike(WORLD, _recorded(0, 0.0), (), (), KINDS) is None


def test_links_with_sight_cannot_be_blocked():
    assert strike(WORLD, _recorded(4, 0.8, sighted=True), (), (), KINDS) is None


def test_no_evidence_for_shorter_ranges():
    assert strike(WORLD, _recorded(4, -0.8), (), (), KINDS) is None


@pytest.mark.parametrize(("lost_db", "found"), [(6.0, True), (0.0, False)])
def test_detours_longer_than_the_library_expects_are_told_by_their_level(
    lost_db: float, found: bool
) -> None:
    """Offsets of 5 to 15 m are as likely anything at all; but what is blocked is weaker."""
    seen = _recorded(5, 10.0)
    struck = seen.recorded.values[:, 0] > 1
    seen = _with_levels(seen, -lost_db * struck)
    made = strike(WORLD, seen, (), (), KINDS)
    assert (made is not None) is found
    assert made is None or len(made.struck) == 5


def _with_levels(seen: View, change_db: np.ndarray) -> View:
    """Return the rows with levels that differ from simulated ones by so much, sight not known."""
    names = ("error_m", "rx_power_dbm")
    frame = seen.frame.drop(columns="los").assign(rx_power_dbm=0.0)
    bare = view(frame, seen.links, seen.rows, Window(), names, False)
    level = WORLD.ensemble(bare, (), 4).simulated_of("rx_power_dbm").mean(axis=0)
    frame = frame.assign(rx_power_dbm=level + change_db)
    return view(frame, seen.links, seen.rows, Window(), names, False)


def test_a_rival_that_explains_the_links_goes_first():
    warm = _recorded(0, 0.0, drift_m=0.5)
    right = (TemperatureDrift(slope_mm_per_c=20.0),)
    assert strike(WORLD, warm, (), right, KINDS) is None


def test_what_else_is_there_is_found_on_the_links_that_were_spared():
    seen = _recorded(12, 0.8, drift_m=0.05)
    rows = np.arange(len(seen.rows))
    parts = [seen.leaving(np.flatnonzero(np.arange(LINKS) % 2 == side)) for side in (0, 1)]
    assert len(parts[0].rows) + len(parts[1].rows) == len(rows)
    found = select_effects(Search(WORLD, parts[0], parts[1], KINDS, 0, work=seen))
    assert {name for group in found.names for name in group} == {*KINDS}
    turn = next(turn for turn in found.rounds if turn.strike)
    assert turn.added is not None
    assert isinstance(turn.strike.evidence, Estimate)
    assert found.added[0].name == "blocked-path"
    words = "\n".join(describe(found.verdicts[0]))
    assert "offsets of links" in words
    assert "held-out" not in words


def test_offsets_are_per_link_and_know_who_is_spared():
    seen = offsets(WORLD, _recorded(3, 0.8), (), BlockedPath)
    assert seen.offset_m.shape == seen.scatter_m.shape == (LINKS,)
    assert seen.inert.sum() == 60
    assert np.median(seen.scatter_m) == pytest.approx(0.024 * 1.25 / np.sqrt(ROWS), rel=0.3)


def test_link_medians():
    values = np.array([[1.0, 5.0, 3.0, np.nan, 7.0]])
    assert link_medians(values, np.array([1, 0, 1, 0, 1])).tolist() == [[5.0, 3.0]]


def test_a_link_of_which_nothing_is_known_has_no_median_and_warns_of_nothing():
    values = np.array([[np.nan, 2.0, np.nan, 4.0, 5.0]])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = link_medians(values, np.array([0, 1, 0, 1, 1]))
    np.testing.assert_array_equal(found, [[np.nan, 4.0]])


def test_only_what_strikes_a_share_of_links_is_judged_so():
    seen = _recorded(0, 0.0)
    assert strikable(BlockedPath, seen)
    assert not strikable(TemperatureDrift, seen)
    assert not strikable(ObstructedPath, seen)  # acts on waveforms only


def test_offsets_of_links_are_evidence_though_nothing_predicts_them():
    calm, noisy = _recorded(0, 0.0), _recorded(0, 0.0)
    own = 0.02 * np.random.default_rng(8).normal(size=LINKS)[noisy.links]
    values = noisy.recorded.values + own[:, None]
    noisy = replace(noisy, recorded=replace(noisy.recorded, values=values))
    assert apart(WORLD, calm, ()) < 3.0
    assert apart(WORLD, noisy, ()) > 5.0


def test_a_rare_cause_is_witnessed_by_the_few_links_that_have_it():
    seen = _recorded(0, 0.0)
    rare = np.flatnonzero(np.isin(seen.links, [3, 9, 33]))  # the only ones that are warm
    frame = seen.frame.assign(temperature_c=25.0)
    frame.loc[rare, "temperature_c"] = 45.0
    values = seen.recorded.values.copy()
    values[rare] += 0.08
    warm = replace(seen, frame=frame, recorded=replace(seen.recorded, values=values))
    drift, idle = TemperatureDrift(slope_mm_per_c=4.0), BlockedPath(share=0.1)
    assert witnessed(WORLD, warm, (), (idle, drift)) is drift
    assert witnessed(WORLD, warm, (drift,), (idle,)) is None
    assert witnessed(WORLD, seen, (), (drift,)) is None
