"""Laws over counts that may be zero; a product with the speed is no time shift."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.law import forms, unexplained
from bench.discrepancy.law.forms import _periods
from bench.discrepancy.law.found import LawConstant
from bench.discrepancy.law.judge import setup_fault
from bench.discrepancy.law.material import Column, material
from bench.discrepancy.law.screen import promising
from bench.discrepancy.law.search import Proposal, propose


def crowded(seed: int) -> tuple[pd.DataFrame, np.ndarray, np.ndarray]:
    """Return rows with a count of people, their errors in metres and links."""
    rng = np.random.default_rng(seed)
    people = rng.integers(0, 40, 300)
    frame = pd.DataFrame({"true_range_m": rng.uniform(2, 20, 300), "people": people * 1.0})
    frame["error_m"] = 0.1 * np.log1p(people / 4) + rng.normal(0, 0.02, 300)
    return frame, frame["error_m"].to_numpy(), np.repeat(np.arange(50), 6)


def test_a_law_over_a_count_holds_where_it_is_zero() -> None:
    frame, error, links = crowded(3)
    found = propose(material(frame, error, links), 0)
    assert found is not None
    forms = {found.best.structure.form, *(one.structure.form for one in found.tied)}
    assert found.best.structure.columns == ("people",)
    assert "logarithm" in forms


def test_speed_times_the_reply_time_is_no_time_shift() -> None:
    speed = ("radial_speed_m_per_s",)
    alone = SimpleNamespace(form="linear", columns=speed, where="", fault="")
    product = SimpleNamespace(form="linear", columns=speed, where="reply time", fault="")
    constants = (SimpleNamespace(name="a", value=0.1),)
    for structure, kind in ((alone, "time shift"), (product, None)):
        best = SimpleNamespace(structure=structure)
        made = setup_fault(cast(Proposal, SimpleNamespace(best=best, constants=constants)))
        assert (made.kind if made else None) == kind


@pytest.mark.parametrize(
    ("lag_s", "said"), [(0.1, "later than their truth by 0.1"), (-0.1, "earlier than their truth")]
)
def test_a_negative_lateness_is_said_to_be_early(lag_s: float, said: str) -> None:
    speed = ("radial_speed_m_per_s",)
    alone = SimpleNamespace(form="linear", columns=speed, where="", fault="")
    lag = LawConstant("lag_s", lag_s, lag_s - 0.01, lag_s + 0.01, "s")
    best = SimpleNamespace(structure=alone)
    made = setup_fault(cast(Proposal, SimpleNamespace(best=best, constants=(lag,))))
    assert made is not None
    assert said in made.words
    assert "-" not in made.words


def test_places_a_metre_apart_show_no_period_of_a_metre() -> None:
    rng = np.random.default_rng(0)
    metres = np.repeat(np.arange(1.0, 41.0), 5)
    for values, shows in ((metres, False), (rng.uniform(1, 40, len(metres)), True)):
        grid = _periods(Column("true_range_m", "true range", "m", np.sqrt(values**2 + 0.1), 5.0))
        for period in (1.0, 2.0):
            assert bool((abs(grid / period - 1) < 0.02).any()) is shows
        assert grid.max() > 20


def test_batches_that_fall_into_step_by_chance_are_no_grid_of_places() -> None:
    starts = np.array([2092, 2422, 3075, 4607, 7900, 8291, 9558, 9731, 10820, 13183, 13196,
                       15587, 18956, 21836])  # fmt: skip  # no gap is like another
    rows = (starts[:, None] + np.arange(20) * 0.02).ravel()
    grid = _periods(Column("time_s", "time", "s", rows, 9700.0))
    assert (abs(grid / 410 - 1) < 0.01).any()


def test_places_that_lie_dense_show_short_periods() -> None:
    for seed in range(8):
        places = np.random.default_rng(seed).uniform(0, 60, 360)
        grid = _periods(Column("walked_m", "walked", "m", places, 30.0))
        assert (abs(grid / 1.2 - 1) < 0.02).any()


def test_what_an_effect_leaves_where_it_acts_is_no_law_beside_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    frame, error, links = crowded(3)
    law = propose(material(frame, error, links), 0)
    assert law is not None
    search = SimpleNamespace(work=None, comparison=None, seed=0)
    assert unexplained._beyond_names(search, None, law)  # type: ignore[arg-type]
    monkeypatch.setattr(unexplained, "without_others", lambda *_: [None])
    for left, holds in ((error, True), (error - 0.1 * np.log1p(frame["people"] / 4), False)):
        rest = material(frame, np.asarray(left, np.float64), links, law.given)
        monkeypatch.setattr(unexplained, "gathered", lambda *_, rest=rest: rest)
        search.work = object()
        found = SimpleNamespace(added=())
        assert unexplained._beyond_names(search, found, law) is holds  # type: ignore[arg-type]


def test_screening_asks_every_column_for_its_periods_once(monkeypatch: pytest.MonkeyPatch) -> None:
    frame, error, links = crowded(1)
    every = material(frame, error, links)
    asked: list[int] = []

    def spacing(values: np.ndarray, least: float) -> float:
        asked.append(len(values))
        return 0.0

    monkeypatch.setattr(forms, "spacing_of", spacing)
    laws = promising(every, float(len(error)))
    waved = [column for column in every.columns if column.unit in ("s", "m")]
    assert laws
    assert waved
    assert len(asked) <= len(waved)
    assert all(law.bounds[0] <= law.value <= law.bounds[1] for law in laws)
