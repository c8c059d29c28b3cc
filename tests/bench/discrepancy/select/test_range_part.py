"""Ranges beside waveform effects: a delay is found, what a receiver may make of them is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bench.checkpoint.journal import Journal
from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Added, joined, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.locate.finding import Finding, Located
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.select import range_part
from bench.discrepancy.select.candidates import library, offered
from bench.discrepancy.select.flattened import whitening
from bench.discrepancy.select.range_part import asked, chosen_beside, with_range_part
from bench.discrepancy.select.state import Round, Search, State
from bench.discrepancy.sets.choice import MERE, Choice
from bench.discrepancy.settings import PATHS_ONLY_RICHER, RESIDUAL_MEMBERS
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.ranging.temperature import TemperatureDrift
from tests.bench.discrepancy.numpy_tables import Hidden, tables
from tests.bench.discrepancy.sets.test_same_rows import rows_of


def search_of(
    constant_m: float, device: str | None = None, hidden: Hidden | None = None
) -> tuple[Search, Search]:
    """Return a search over two halves of tables, `constant_m` hidden, and one over all rows.

    In all rows, or in those of one transmitter.
    """
    recorded, simulated = tables(3, hidden)
    frame = recorded.frame
    more = constant_m * (frame["tx"] == device if device else 1.0)
    frame = frame.assign(**{n: frame[n] + more for n in ("error_m", "range_m") if n in frame})
    codes = link_codes(frame)
    odd = codes % 2 == 1
    halves = [
        view(frame, codes, np.flatnonzero(part), Window(), None, False) for part in (odd, ~odd)
    ]
    kinds, _ = offered(library()[0], frame, False, False)
    search = Search(TableComparison(simulated.frame, Window()), *halves, kinds, 0)
    return search, replace(search, work=joined(*halves))


@pytest.mark.parametrize(("constant_m", "names"), [(0.15, ("antenna-delay",)), (0.012, ())])
def test_a_delay_is_found_beside_an_effect_and_a_receivers_shift_is_not(
    constant_m: float, names: tuple[str, ...]
) -> None:
    beside: Added = (PathLoss(),)  # does nothing: receivers differ about it all the same
    search = search_of(constant_m)[1]
    assert chosen_beside(search, beside).names == names
    alone = chosen_beside(search, ())
    assert (alone.names, alone.others) == (names, () if names else (MERE,))


def test_what_a_delay_does_is_said_as_it_is_though_a_constant_is_hardly_seen() -> None:
    found = chosen_beside(search_of(0.15)[1], (PathLoss(),))
    assert np.median(found.shifts_m["antenna-delay"]) == pytest.approx(0.15, rel=0.2)


@pytest.mark.parametrize(("of_device", "names"), [(True, ("antenna-delay",)), (False, ())])
def test_beside_what_nobody_listed_a_delay_is_named_only_where_devices_differ(
    of_device: bool, names: tuple[str, ...]
) -> None:
    search = search_of(0.15, "d1" if of_device else None)[1]
    assert chosen_beside(search, (), unlisted=True).names == names


def test_rows_of_two_views_are_all_there() -> None:
    search, whole = search_of(0.0)
    assert whole.work is not None
    assert len(whole.work.rows) == len(search.fit.rows) + len(search.discover.rows)
    assert set(whole.work.links) == set(search.fit.links) | set(search.discover.links)


def test_forms_are_taken_out_as_far_as_they_are_expected() -> None:
    rng = np.random.default_rng(0)
    noise, form = rng.normal(0, 0.02, 100), rng.normal(size=(100, 1))
    kept = [np.linalg.norm(whitening(s * form, noise) @ form) for s in (1.0, 1e-5)]
    assert kept[0] < 0.05 * np.linalg.norm(form)
    assert kept[1] > 0.95 * np.linalg.norm(form)


def test_where_nothing_differed_nothing_is_asked() -> None:
    state = State(search_of(0.15)[0])
    assert with_range_part(state, Journal()) is state


def test_a_name_that_a_misplaced_device_took_the_place_of_is_kept_in_mind(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    search = search_of(0.15)[0]
    search = replace(search, fit=replace(search.fit, waveform=True))
    seen = Finding(Cell("error_m", "mean", Place()), Estimate(0.1, 0.1, 0.1), 9.0, 0.001, 9, 9)
    turn = Round(Located((seen,), 0.001, 9.0, 4.0, 1, {}), None, None)
    found = Choice((), ("the position of d1",), tied=("antenna-delay",))
    monkeypatch.setattr(range_part, "chosen_beside", lambda *_: found)
    made = with_range_part(State(search, (), (turn,)), Journal())
    assert made.search.choice.tied == ("antenna-delay",)


@pytest.mark.parametrize(("nats", "there"), [(17.0, True), (9.0, False)])
def test_where_no_place_stands_out_only_a_name_beyond_doubt_is_there(
    monkeypatch: pytest.MonkeyPatch, nats: float, there: bool
) -> None:
    search = search_of(0.15)[0]
    search = replace(search, fit=replace(search.fit, waveform=True))
    turn = Round(Located((), 0.5, 3.0, 4.0, 1, {}), None, None)
    state, more = State(search, (), (turn,)), (TemperatureDrift(0.0),)
    found = Choice(("temperature-drift",), nats={"temperature-drift": nats})
    monkeypatch.setattr(range_part, "chosen_beside", lambda *_: found)
    monkeypatch.setattr(range_part, "together", lambda *_: more)
    monkeypatch.setattr(range_part, "rounds_of", lambda *_: (turn,))
    monkeypatch.setattr(range_part, "loses", lambda *_: False)
    monkeypatch.setattr(range_part, "_installed", lambda state, *_: replace(state, added=more))
    assert with_range_part(state, Journal()).added == (more if there else ())


def test_of_a_table_ranges_have_as_many_versions_as_without_waveforms() -> None:
    search = search_of(0.15)[1]
    assert range_part._members(search, (PathLoss(),)) == RESIDUAL_MEMBERS
    assert range_part._members(search, ()) == RESIDUAL_MEMBERS * PATHS_ONLY_RICHER


@pytest.mark.parametrize("worse", [True, False])
def test_what_held_out_links_lose_by_is_not_taken(
    monkeypatch: pytest.MonkeyPatch, worse: bool
) -> None:
    search = search_of(0.15)[0]
    search = replace(search, fit=replace(search.fit, waveform=True))
    seen = Finding(Cell("error_m", "mean", Place()), Estimate(0.1, 0.1, 0.1), 9.0, 0.001, 9, 9)
    turn = Round(Located((seen,), 0.001, 9.0, 4.0, 1, {}), None, None)
    state, more = State(search, (), (turn,)), (TemperatureDrift(0.0),)
    monkeypatch.setattr(range_part, "chosen_beside", lambda *_: Choice(("temperature-drift",)))
    monkeypatch.setattr(range_part, "together", lambda *_: more)
    monkeypatch.setattr(range_part, "loses", lambda *_: worse)
    monkeypatch.setattr(range_part, "_installed", lambda state, *_: replace(state, added=more))
    contests: list[str] = []
    monkeypatch.setattr(range_part, "rounds_of", lambda *_: (contests.append("asked"), (turn,))[1])
    assert with_range_part(state, Journal()).added == (() if worse else more)
    assert contests == ([] if worse else ["asked"])


def test_no_detector_follows_a_temperature_unless_something_unlisted_does() -> None:
    _, search = search_of(0.0)
    assert search.fit.covariates.numbers
    every = range_part.known_columns_of(search.fit, ())
    name = next(iter(search.fit.covariates.numbers))
    assert range_part.known_columns_of(search.fit, (name,)).shape[1] == every.shape[1] - 1
    assert {"temperature_c", "time_s", "reply_time_s"} < set(range_part.OF_CLOCKS)


def test_the_floor_of_a_known_room_is_left_to_waveforms() -> None:
    search, _ = search_of(0.0)
    outdoors = search.fit
    room = {f"{what}_{axis}_m": 4.0 for what in ("tx", "rx", "room") for axis in "xyz"}
    inside = replace(outdoors, frame=outdoors.frame.assign(**room))
    assert range_part._of_waves_alone(outdoors) == {"diffraction"}
    assert range_part._of_waves_alone(inside) == {"diffraction", "ground-bounce"}


@pytest.mark.parametrize("constant_m", [0.15, 0.012])
def test_what_another_detector_may_make_of_waveforms_leaves_nothing(constant_m: float) -> None:
    found = chosen_beside(search_of(constant_m)[1], (PathLoss(),))
    assert found.forms_do  # the delay of 15 cm is named, the other is a detector's
    assert not chosen_beside(search_of(constant_m)[1], ()).forms_do  # no waveform differs


def test_what_nobody_listed_or_a_law_says_is_left_to_be_said() -> None:
    assert not chosen_beside(search_of(0.15)[1], (PathLoss(),), unlisted=True).forms_do
    search = search_of(0.0, hidden=lambda frame, _: 0.2 * np.sin(frame["true_range_m"]))[1]
    found = chosen_beside(search, (PathLoss(),))
    assert found.others
    assert not found.forms_do


def test_a_delay_is_asked_for_beside_a_pattern_that_ranges_do_not_show() -> None:
    whole = search_of(0.15)[1]
    assert whole.work is not None
    turn = np.linspace(0, 360, len(whole.work.rows), endpoint=False) * 7 % 360
    heading = whole.work.frame.assign(azimuth_deg=turn)
    ranged = replace(whole, work=replace(whole.work, frame=heading))
    kinds = dict(ranged.kinds) | {AntennaPattern.name: AntennaPattern}
    ranged = replace(ranged, kinds=kinds)
    loud, late = AntennaPattern(gain_db=6.0), AntennaPattern(delay_m=0.01)
    assert "antenna-pattern" in range_part.judged_by_sets(ranged)
    for pattern, stays in ((loud, True), (late, False)):
        found, beside = asked(ranged, (PathLoss(), pattern), False)
        assert found.names == ("antenna-delay",)
        assert (pattern in beside) is stays


def test_no_receiver_makes_what_one_device_has() -> None:
    """Groups of pairs of devices, taken together, had been those of a device."""
    frame = rows_of(3).assign(error_m=0.0, rx_power_dbm=-80.0)
    frame = frame.assign(range_m=frame["true_range_m"])
    rows = view(frame, link_codes(frame), np.arange(len(frame)), Window(), None, False)
    assert any(name.startswith("pair=") for name in rows.covariates.groups)
    own = (frame["rx"] == "a1").to_numpy(np.float64)
    forms = np.hstack([range_part.unlisted_forms(rows), range_part.known_columns_of(rows, ())])
    left = own - forms @ np.linalg.lstsq(forms, own, rcond=None)[0]
    assert left @ left > 0.3 * np.sum((own - own.mean()) ** 2)
