"""Scatter is taken out where links keep offsets beyond doubt, not where one in twenty would."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.locate.finding import Finding, Located
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.select import stepwise
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.stepwise import contradicted
from bench.physics.effect import Effect
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter

LINK = np.repeat(np.arange(60), 5)
SEARCH = cast(Search, SimpleNamespace(comparison=None, searched=SimpleNamespace(links=LINK)))


@pytest.fixture(autouse=True)
def touching_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have other causes do nothing to any link."""
    monkeypatch.setattr(stepwise, "untouched", lambda *_: np.ones(len(LINK), bool))


@pytest.mark.parametrize(
    ("p", "share", "taken_out"), [(0.002, 0.0, True), (0.03, 0.0, False), (0.03, 0.5, True)]
)
def test_only_offsets_beyond_doubt_contradict_scatter(
    monkeypatch: pytest.MonkeyPatch, p: float, share: float, taken_out: bool
) -> None:
    every = SimpleNamespace(rows=lambda _: None)
    monkeypatch.setattr(stepwise, "versions", lambda *_: every)
    monkeypatch.setattr(stepwise, "_scatters_inside", lambda *_: False)
    monkeypatch.setattr(stepwise, "of_links", lambda *_: (share, 0.1))
    jitter = TimestampJitter()
    found = Finding(
        Cell("error_m", "link", Place("pair=t1->a2")), Estimate(0.02, 0.01, 0.03), 4.0, p, 9, 3
    )
    located = Located((found,), p, 4.0, 3.0, 1, {})
    assert (contradicted(SEARCH, (RangeScale(), jitter), located) is jitter) is taken_out


@pytest.mark.parametrize(("inside_m", "taken_out"), [(0.05, False), (0.0, True)])
def test_scatter_that_rows_of_a_link_show_stays_beside_offsets_of_links(
    monkeypatch: pytest.MonkeyPatch, inside_m: float, taken_out: bool
) -> None:
    rng, links = np.random.default_rng(3), LINK
    noise = rng.normal(0, 0.02, (5, 300, 1))
    noise[0, :, 0] += inside_m * rng.normal(size=300) + 0.05 * rng.normal(size=60)[links]
    jitter = TimestampJitter()

    def versions(_: object, __: object, added: tuple[Effect, ...]) -> Ensemble:
        made = noise.copy()
        made[1:] += 0.05 * (jitter in added) * rng.normal(size=(4, 300, 1))
        return Ensemble(("error_m",), ("m",), made, links)

    monkeypatch.setattr(stepwise, "versions", versions)
    cell = Cell("error_m", "link", Place())
    located = Located(
        (Finding(cell, Estimate(0.02, 0.01, 0.03), 9.0, 0.002, 300, 60),), 0.002, 9.0, 3.0, 1, {}
    )
    assert (contradicted(SEARCH, (RangeScale(), jitter), located) is jitter) is taken_out


@pytest.mark.filterwarnings("error")
def test_links_of_one_row_show_no_scatter_and_no_warning(monkeypatch: pytest.MonkeyPatch) -> None:
    noise = np.random.default_rng(3).normal(0, 0.02, (5, 60, 1))
    alone = Ensemble(("error_m",), ("m",), noise, np.arange(60))
    monkeypatch.setattr(stepwise, "versions", lambda *_: alone)
    jitter = TimestampJitter()
    assert not stepwise._scatters_inside(SEARCH, (RangeScale(), jitter), jitter)


@pytest.mark.parametrize("everywhere", [True, False])
def test_offsets_of_links_on_which_another_cause_acts_contradict_no_scatter(
    monkeypatch: pytest.MonkeyPatch, everywhere: bool
) -> None:
    rng, calm = np.random.default_rng(4), LINK >= 30
    noise = rng.normal(0, 0.02, (5, 300, 1))
    noise[0, :, 0] += (0.08 * rng.normal(size=60) * (everywhere | (np.arange(60) < 30)))[LINK]
    made = Ensemble(("error_m",), ("m",), noise, LINK)
    monkeypatch.setattr(stepwise, "versions", lambda *_: made)
    monkeypatch.setattr(stepwise, "_scatters_inside", lambda *_: False)
    monkeypatch.setattr(stepwise, "untouched", lambda *_: calm)
    jitter = TimestampJitter()
    cell = Cell("error_m", "link", Place("obstructed"))
    located = Located(
        (Finding(cell, Estimate(0.02, 0.01, 0.03), 9.0, 0.002, 150, 30),), 0.002, 9.0, 3.0, 1, {}
    )
    assert (contradicted(SEARCH, (RangeScale(), jitter), located) is jitter) is everywhere
