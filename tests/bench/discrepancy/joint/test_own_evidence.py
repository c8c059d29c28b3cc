"""What counts for a name: no level of all links, no narrower scatter, no few links; SIMULATED."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from bench.discrepancy.joint.agreement import links_agree
from bench.discrepancy.joint.beyond_level import beyond_level
from bench.discrepancy.joint.likelihood import evidence, whitener
from bench.discrepancy.joint.polish import Fit
from bench.discrepancy.joint.settings import ALONE
from bench.discrepancy.joint.statistics import Moments
from bench.physics.effects.receiver.level_control import LevelControl

Floats = NDArray[np.float64]
LINKS = 60
NAMES = ("rx_power_dbm", "energy_db", "rise_time_ns")
NOISE = np.random.default_rng(0).normal(size=(LINKS, 3))
ONES = np.ones(LINKS)


def _given() -> Any:
    return SimpleNamespace(
        names=NAMES,
        count=np.ones(LINKS, int),
        ways=np.ones((LINKS, 1)),
        links=LINKS,
        crowding=1.0,
        told_within=False,
    )


def _fit(left: Floats, response: Floats | None = None, scatter: float = 1.0) -> Fit:
    """Return a set of one effect with such a response, or of none, that leaves so much."""
    covariances = {1: scatter**2 * np.eye(3)}
    moments = Moments(left, left, covariances, left, left)
    if response is None:
        return Fit((), moments, (), 0.0)
    return Fit((LevelControl(),), moments, (response,), 0.0)


def _of(response: Floats, scatter: float = 1.0, noise: Floats = NOISE) -> tuple[Fit, Fit]:
    """Return the set that does what is there, and none."""
    return _fit(noise, response, scatter), _fit(noise + response)


def test_a_level_of_all_links_is_no_evidence_but_what_differs_is() -> None:
    level = np.stack([2 * ONES, 2 * ONES, 0.1 * ONES], axis=1)
    slope = np.stack([np.linspace(-3, 3, LINKS)] * 2 + [0 * ONES], axis=1)
    given = _given()
    for response, named in ((level, False), (slope, True), (level[:, [2, 2, 0]], True)):
        fit, rest = _of(response)
        parts = [(one.moments, one.responses, one.parameters) for one in (fit, rest)]
        assert evidence(given, *parts[0]) - evidence(given, *parts[1]) > 50
        assert (beyond_level(given, fit, rest) > 8) == named


def test_links_that_a_set_makes_more_alike_are_no_evidence() -> None:
    little = np.full((LINKS, 3), 0.06)
    calm = 0.3 * NOISE
    given = _given()
    assert beyond_level(given, *_of(little, 0.3, calm)) < 0
    fit, rest = _of(np.zeros_like(little), 3.0, 3 * NOISE)
    assert beyond_level(given, fit, rest) > 50  # wider scatter is what some effects make


@pytest.mark.parametrize(
    ("of", "size", "scatter", "agree"),
    [(LINKS, 1.3, 1.0, True), (6, 6.0, 2.0, True), (1, 20.0, 1.0, False)],
)
def test_links_agree_where_something_is_done_but_one_odd_link_decides_nothing(
    of: int, size: float, scatter: float, agree: bool
) -> None:
    response = np.where(np.arange(LINKS)[:, None] < of, size, 0.0) * np.ones((1, 3))
    given, (fit, rest) = _given(), _of(response, scatter)
    parts = [(one.moments, one.responses, one.parameters) for one in (fit, rest)]
    assert evidence(given, *parts[0]) - evidence(given, *parts[1]) > 8
    assert links_agree(given, fit, rest) == agree
    assert links_agree(given, fit, rest, struck=True) == (agree and of == LINKS)
    assert links_agree(SimpleNamespace(told_within=True), fit, rest)  # type: ignore[arg-type]


@pytest.mark.parametrize("share", [0.0, 0.1])
def test_links_differ_from_a_response_by_the_share_that_is_likeliest(share: float) -> None:
    response = 8 * np.ones((LINKS, 3))
    left = 0.1 * NOISE + share * response * np.random.default_rng(1).normal(size=(LINKS, 3))
    seen = _fit(left, response, scatter=0.1).moments
    volumes = [2 * np.log(0.01 + (size * 8) ** 2) / 2 * 3 * LINKS / 2 for size in ALONE]
    _, volume = whitener(_given(), seen, (response,))
    assert np.argmin(np.abs(np.array(volumes) - volume)) == (2 if share else 0)
