"""The challenge: sealed, concealed as stated, resumable, and scored without favour."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.challenge import blind
from bench.challenge.blind import run_blind, seal
from bench.challenge.blind_report import rates
from bench.challenge.cases import LIMIT_Z, make_case
from bench.challenge.generator.conceal import IN_METRES, Hidden, conceal, draw_case
from bench.challenge.generator.geometry import geometry
from bench.challenge.generator.shapes import LIBRARY, SHAPES
from bench.challenge.scoring import Outcome
from bench.errors import BenchError
from bench.parallel import Spread


def _table(seed: int = 0) -> pd.DataFrame:
    frame = geometry(seed)
    error = np.random.default_rng(seed).normal(0, 0.03, len(frame))
    return frame.assign(error_m=error, range_m=frame["true_range_m"] + error)


def test_a_quarter_is_empty_and_a_tenth_is_outside_the_library():
    drawn = [draw_case(number, 1) for number in range(200)]
    assert sum(not case.names for case in drawn) == 50
    assert sum(bool(case.names) and case.names[0] not in LIBRARY for case in drawn) == 20
    assert {case.conceal for case in drawn if case.names} >= {"aggregate", "decoy", "sparse"}


def test_the_seal_holds_the_answers():
    assert seal(20, 1) == seal(20, 1)
    assert seal(20, 1) != seal(20, 2)


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_every_shape_has_the_strength_it_states(name):
    table = _table()
    made = conceal(table, Hidden((name,), (0.05,), "plain"), 3)
    out = made.table
    shift = out["error_m"] - table["error_m"]
    assert np.allclose(shift, made.shifts_m.sum(axis=0))
    touched = shift[np.abs(shift) > 1e-9]
    rms = float(np.sqrt(np.mean(touched**2)))
    assert rms == pytest.approx(0.05, rel=1e-6) or name in IN_METRES
    assert 0 < rms <= 0.0501
    assert np.allclose(out["range_m"] - out["true_range_m"], out["error_m"])


def test_aggregates_equal_the_simulators_and_decoys_correlate():
    table = _table()
    hidden = Hidden(("temperature-drift",), (0.1,), "aggregate")
    out = conceal(table, hidden, 3).table
    assert np.allclose(np.sort(out["error_m"]), np.sort(table["error_m"]))
    assert np.corrcoef(out["error_m"], out["temperature_c"])[0, 1] > 0.5
    decoyed = conceal(table, replace(hidden, conceal="decoy"), 3).table
    assert np.corrcoef(decoyed["sensor_0"], table["temperature_c"])[0, 1] == pytest.approx(
        0.8, abs=0.06
    )


@pytest.mark.parametrize("name", LIBRARY)
def test_a_sparse_effect_touches_three_to_ten_percent_of_the_rows(name):
    hidden = Hidden((name,), (0.05,), "sparse")
    frame = geometry(3, hidden.rare)
    frame = frame.assign(error_m=0.0, range_m=frame["true_range_m"])
    out = conceal(frame, hidden, 3)
    assert 0.02 < np.mean(np.abs(out.shifts_m[0]) > 1e-6) <= 0.1
    assert "_rare" not in out.table


def test_the_oracle_adds_what_was_hidden():
    table = _table()
    hidden = Hidden(("temperature-drift", "clock-offset"), (0.1, 0.05), "aggregate")
    made = conceal(table, hidden, 3)
    rows = np.arange(20)
    own = table["error_m"].to_numpy()[None, rows]
    assert np.allclose(made.truth(own, rows, 0)[0], made.table["error_m"].to_numpy()[rows])


def test_strength_counts_standard_deviations_of_a_matched_filter():
    case = next(c for c in (make_case(n, 4) for n in range(1, 20, 2)) if c.hidden.names)
    assert case.strength_z > 0
    assert case.above_limit == (case.strength_z >= LIMIT_Z)


def test_cases_do_not_show_their_answer():
    for number in (1, 2, 5, 6):
        table = make_case(number, 4).recorded
        assert not {"clock_offset_ppm", "_rare"} & set(table.frame)
        assert not table.simulated


def _outcome(number: int, names: tuple[str, ...], score: str) -> Outcome:
    hidden = Hidden(names, (0.1,) * len(names), "plain")
    z = 20.0 if names else 0.0
    return Outcome(
        number, "resimulated", hidden, "", [], score, z, z > 8, 0.5, 0.5, 0.8, 1.0, [], []
    )


def test_rates_count_every_case_once_against_its_bar():
    outcomes = [_outcome(i, (), "alarm" if i == 0 else "clean") for i in range(10)]
    outcomes += [_outcome(10, ("clock-offset",), "right"), _outcome(11, ("supply",), "wrong")]
    found = {rate.words: rate for rate in rates(outcomes)}
    assert found["false alarms on empty cases"].met is False
    assert found["wrong names on all others"].hits == 1
    assert found["outside the library, above the limit: reported unknown"].hits == 0
    assert found["right name, or a class that holds it, above the detection limit"].met is True


def test_finished_cases_are_kept_and_another_seed_is_refused(tmp_path, monkeypatch):
    ran: list[int] = []

    def quick(number: int, seed: int) -> Outcome:
        ran.append(number)
        return replace(_outcome(number, (), "clean"), hidden=draw_case(number, seed))

    monkeypatch.setattr(blind, "run_case", quick)
    first = run_blind(3, 5, tmp_path, lambda _: None)
    again = run_blind(4, 5, tmp_path, lambda _: None)
    assert ran == [0, 1, 2, 3]
    assert again[:3] == first
    with pytest.raises(BenchError, match="seed 5"):
        run_blind(2, 6, tmp_path, lambda _: None)


def test_cases_that_other_code_finished_are_run_again(tmp_path, monkeypatch):
    ran: list[int] = []

    def quick(number: int, seed: int) -> Outcome:
        ran.append(number)
        return replace(_outcome(number, (), "clean"), hidden=draw_case(number, seed))

    monkeypatch.setattr(blind, "run_case", quick)
    run_blind(2, 5, tmp_path, lambda _: None)
    monkeypatch.setattr(blind, "code", lambda: "other")
    run_blind(2, 5, tmp_path, lambda _: None)
    assert ran == [0, 1, 0, 1]


@pytest.mark.slow
def test_cases_do_not_depend_on_how_they_were_spread(tmp_path):
    """A cluster that is threads of this process: the workers of the test on fits are others."""
    distributed = pytest.importorskip("distributed")
    run_blind(1, 5, tmp_path / "alone", lambda _: None)
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None,
        protocol="tcp://", silence_logs=50,
    ) as local:  # fmt: skip
        spread = Spread(scheduler=local.scheduler_address)
        run_blind(1, 5, tmp_path / "dask", lambda _: None, spread)
    alone, dask = (tmp_path / one / "cases" / "0000.json" for one in ("alone", "dask"))
    assert dask.read_bytes() == alone.read_bytes()
