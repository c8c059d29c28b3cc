"""Rows of a link that follow each other differ as any two do, where every row draws its own."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.select import own_scatter
from bench.discrepancy.select.in_turn import apart_in_turn
from bench.discrepancy.select.own_scatter import beyond_causes
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.units import Floats

LINKS, ROWS = 80, 5


def recorded(of_chance: Floats, seed: int = 1) -> tuple[Ensemble, Floats]:
    """Return ranges beside eight simulated versions, and times: rows of a link within 3 s.

    A deck heels every 14 s and a little of the rows' scatter is their own; `of_chance` comes on top
    [n].
    """
    rng = np.random.default_rng(seed)
    links = np.repeat(np.arange(LINKS), ROWS)
    time_s = 100.0 * links + np.tile(np.linspace(0, 3, ROWS), LINKS)
    versions = rng.normal(0, 0.02, (9, LINKS * ROWS, 1))
    versions[0, :, 0] += of_chance
    return Ensemble(("error_m",), ("m",), versions, links), time_s


def heels(size_m: float) -> Floats:
    """Return what a heeling deck moves ranges by."""
    _, time_s = recorded(np.zeros(LINKS * ROWS))
    return size_m * np.sin(2 * np.pi * time_s / 14.0 + 1.3 * (time_s // 100))


def jitter(size_m: float, seed: int = 2) -> Floats:
    """Return what clocks move ranges by."""
    return size_m * np.random.default_rng(seed).normal(size=LINKS * ROWS)


@pytest.mark.parametrize(
    ("moved", "named"),
    [(heels(0.08), False), (jitter(0.04), True), (jitter(0.04) + heels(0.03), True)],
)
def test_what_changes_row_by_row_is_no_jitter(moved: Floats, named: bool) -> None:
    assert apart_in_turn(*recorded(moved)).adequate is named


def test_jitter_is_seldom_taken_for_it() -> None:
    held = [apart_in_turn(*recorded(jitter(0.02, k), k)).adequate for k in range(40)]
    assert sum(held) >= 39


def test_rows_go_by_their_times_and_two_of_a_link_tell_nothing() -> None:
    made, time_s = recorded(heels(0.08))
    turned = np.random.default_rng(3).permutation(len(time_s))
    other = Ensemble(made.names, made.units, made.versions[:, turned], made.links[turned])
    assert not apart_in_turn(other, time_s[turned]).adequate
    assert apart_in_turn(other, np.full(len(time_s), np.nan)).adequate
    pairs = Ensemble(made.names, made.units, made.versions, np.arange(len(time_s)) // 2)
    assert apart_in_turn(pairs, time_s).adequate


@pytest.mark.parametrize(("moved", "named"), [(heels(0.08), False), (jitter(0.04), True)])
def test_independent_scatter_is_asked(
    monkeypatch: pytest.MonkeyPatch, moved: Floats, named: bool
) -> None:
    made, time_s = recorded(moved)
    monkeypatch.setattr(own_scatter, "versions", lambda *_: made)
    at = SimpleNamespace(true_range_m=np.full(len(time_s), 5.0))
    work = SimpleNamespace(frame=pd.DataFrame({"time_s": time_s}), scene=at)
    search = SimpleNamespace(logged=(), work=work, comparison=None, seed=0)
    effect = TimestampJitter()
    assert beyond_causes(search, (effect,), effect).adequate is named  # type: ignore[arg-type]
