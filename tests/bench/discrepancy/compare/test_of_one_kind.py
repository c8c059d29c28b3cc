"""Similar links stand for others only behind as many obstacles: three shelves are not one."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.corrected import moved, places, told_by
from bench.discrepancy.compare.over_distance import Walk
from bench.discrepancy.compare.over_kinds import OfKinds, OverKinds, over_kinds
from bench.discrepancy.compare.reuse import Reused
from bench.discrepancy.compare.shared import alike
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import RANGE, Floats, Observables, Window
from bench.discrepancy.data.split import Rows, link_codes

STEP_M = 0.05  # that a shelf delays, on both sides


def _table(seed: int, rows: int = 3) -> pd.DataFrame:
    """Return SIMULATED ranges of 60 links behind none to three shelves, the same for every seed."""
    link, rng = np.repeat(np.arange(60), rows), np.random.default_rng(seed)
    truth = 5.0 + 0.01 * link
    error = STEP_M * (link % 4) + 0.01 * rng.normal(size=len(link))
    shelves = [["shelf"] * (one % 4) for one in link]
    return pd.DataFrame(
        {"link": link.astype(str), "true_range_m": truth, "range_m": truth + error}
    ).assign(obstacles=shelves)


def _left(recorded: pd.DataFrame, simulated: pd.DataFrame) -> tuple[np.ndarray, np.ndarray]:
    """Return recorded minus simulated range of every row in metres, and how many shelves it has."""
    rows, comparison = np.arange(len(recorded)), TableComparison(simulated, Window())
    seen = view(recorded, link_codes(recorded), rows, Window(), None, False)
    many = np.array([len(one) for one in recorded["obstacles"]])
    return comparison.ensemble(seen, (), 8).residual_of(RANGE), many


def test_rows_are_alike_behind_as_many_obstacles_of_a_kind() -> None:
    rooms = np.repeat(["hall", "yard"], 90)
    layers = alike(_table(1).assign(environment=rooms), _table(2).assign(environment=rooms))
    assert [len(np.unique(ours)) for ours, _ in layers] == [4, 8]  # over rooms, and in each
    for ours, theirs in layers:
        np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("simulated", [3, 6])
def test_links_behind_more_obstacles_leave_no_error(simulated: int) -> None:
    left, many = _left(_table(1), _table(2, simulated))
    assert [left[many == one].mean() for one in range(4)] == pytest.approx([0] * 4, abs=0.01)


@pytest.mark.parametrize("late_m", [0.0, 0.1])
def test_what_only_recordings_have_behind_obstacles_stays(late_m: float) -> None:
    recorded, simulated = _table(1), _table(2)
    recorded["range_m"] += late_m * np.array([len(one) == 3 for one in recorded["obstacles"]])
    left, many = _left(recorded, simulated)
    assert [left[many == one].mean() for one in range(4)] == pytest.approx(
        [0, 0, 0, late_m], abs=0.01
    )


def test_a_kind_that_no_simulated_link_has_changes_nothing() -> None:
    names, theirs = (RANGE,), np.repeat([0, 1], 30)
    values = np.where(theirs == 1, 0.2, 0.0)[:, None] + 0.01 * np.arange(60)[:, None] % 0.02
    observed = Observables(names, ("m",), values)
    codes = [(np.array([0, 1, 2]), theirs)]
    made = over_kinds(observed, {}, np.full(60, 5.0), np.arange(60), codes)
    change = made.change((RANGE, "rx_power_dbm"), np.array([59, 0, 0]))
    np.testing.assert_allclose(change, [[-0.2, 0], [0.2, 0], [0, 0]], atol=0.01)


def _of_three(seed: int, metal_std: float) -> tuple[OverKinds, Rows]:
    """Return what kinds do of which the last, of ten links in fifty, scatters by so much in dB."""
    kinds = np.repeat([0, 1, 2], [20, 20, 10])
    values = np.random.default_rng(seed).normal(size=50) * np.where(kinds == 2, metal_std, 1.0)
    observed = Observables(("rx_power_dbm",), ("dB",), (values - 6.0 * (kinds == 2))[:, None])
    ours = np.full(40, 2)
    return over_kinds(observed, {}, np.full(50, 5.0), np.arange(50), [(ours, kinds)]), ours


def test_a_link_that_stands_for_one_behind_metal_scatters_as_these_do() -> None:
    """A link in sight is one dB off; behind metal that is three, and would all be findings."""
    wide, even = (
        np.mean([_stands(_of_three(seed, std)[0]).std() for seed in range(20)])
        for std in (3.0, 1.0)
    )
    assert even == pytest.approx(1.0, abs=0.15)
    assert 1.5 < wide < 3.0  # what is far off counts as far as is usual, and ten links are few


def _stands(made: OverKinds) -> np.ndarray:
    """Return by how much forty links in sight differ that stand for ones behind metal."""
    layer, pick = made.layers[0], np.arange(40)
    return layer.kinds[0].off[pick] + made.change(("rx_power_dbm",), pick)[:, 0]


def test_what_metal_does_is_told_over_all_rooms() -> None:
    """Two links of each of eight rooms are behind metal: none alone tells what that does."""
    kinds = np.repeat([0, 1], [64, 16])
    rooms = np.concatenate([np.arange(64) % 8, np.arange(16) % 8])
    values = np.random.default_rng(0).normal(size=80) - 1.5 * kinds
    observed = Observables(("rx_power_dbm",), ("dB",), values[:, None])
    ours = np.array([1])
    codes = [(ours, kinds), (8 * ours, 8 * kinds + rooms)]
    made = over_kinds(observed, {}, np.full(80, 5.0), np.arange(80), codes)
    assert made.layers[0].kinds[0].step[1] < -0.7
    narrow = over_kinds(observed, {}, np.full(80, 5.0), np.arange(80), codes[1:])
    both, one = (np.nanmean(x.change(("rx_power_dbm",), np.array([5]))) for x in (made, narrow))
    assert both < one


def test_what_corrects_a_link_is_shared_by_all_that_it_corrects() -> None:
    """Three links behind metal stand for ten: what these are off by chance is in all ten."""
    kinds = np.array([*np.zeros(20, np.intp), 1, 1, 1])
    ours, many = np.ones(10, np.intp), 2
    there = places(np.linspace(5, 20, 23), np.arange(23), [(kinds, many)], ())
    here = places(np.linspace(8, 12, 10), np.arange(10), [(ours, many)], ())
    shares = np.full((10, 23), 1 / 20) * (kinds == 0)
    none, one = np.ones(2), np.zeros(2)
    told, known = (OfKinds(one, part, none, np.zeros(23)) for part in (none, one))
    wide, flat = (_reused(shares, here, there, Walk(0.0), of) for of in (told, known))
    whole = shares + wide.moved @ wide.told_by[RANGE]
    assert whole[:, 20:].sum(axis=1) == pytest.approx(1.0)  # all is from those of their kind
    assert whole.sum(axis=1) == pytest.approx(1.0)
    assert wide.widening(np.ones(10))[RANGE] > 1.8
    assert flat.widening(np.ones(10))[RANGE] < 1.4
    assert wide.widening(np.array([1, -1] * 5))[RANGE] == 1  # cancels: none less


def _reused(
    shares: Floats, here: list[Floats], there: list[Floats], walk: Walk, of: OfKinds
) -> Reused:
    return Reused(shares, moved(shares, here, there), {RANGE: told_by(there, walk, [of], ())})


def test_a_walk_that_is_told_is_shared_by_links_that_are_nearer_than_all_that_tell_it() -> None:
    kinds, ours = np.zeros(20, np.intp), np.zeros(10, np.intp)
    there = places(np.geomspace(5, 20, 20), np.arange(20), [(kinds, 1)], ())
    here = places(np.full(10, 4.0), np.arange(10), [(ours, 1)], ())
    shares, nothing = np.full((10, 20), 1 / 20), OfKinds(*np.zeros((3, 1)), np.zeros(20))
    told, untold = (
        _reused(shares, here, there, Walk(-20.0, 0.0, part), nothing)
        for part in ((1.0, 0.0), (0.0, 0.0))
    )
    assert (shares + told.moved @ told.told_by[RANGE]).sum(axis=1) == pytest.approx(1.0)
    wider, as_wide = (one.widening(np.ones(10))[RANGE] for one in (told, untold))
    assert wider > 1.3 * as_wide
