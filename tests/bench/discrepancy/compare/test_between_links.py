"""Errors of links that go with their levels by multipath; SIMULATED numbers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray

from bench.discrepancy.compare.beside_level import beside_level
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.sets.evidence import Evidence
from bench.discrepancy.sets.settings import LARGE_OFFSETS

Floats = NDArray[np.float64]
LINKS, ROWS = 80, 3
SLOPE = 0.012  # metres per decibel, that multipath moves errors by
DISTANCE = np.random.default_rng(1).uniform(3, 40, LINKS)
OF_ROW = np.repeat(np.arange(LINKS), ROWS)


def rows() -> View:
    """Return rows of 80 links with levels."""
    frame = pd.DataFrame(
        {
            "link": [f"l{i}" for i in OF_ROW],
            "true_range_m": DISTANCE[OF_ROW],
            "range_m": DISTANCE[OF_ROW],
            "rx_power_dbm": -80.0,
        }
    )
    return view(frame, link_codes(frame), np.arange(len(frame)), Window(), None, False)


def versions(seed: int, shift_db: Callable[[Floats], Floats], slope: float = SLOPE) -> Ensemble:
    """Return a recorded and four simulated versions, each link of a multipath of its own.

    `shift_db`: what a hidden effect does to recorded levels over the distance.
    """
    rng, made = np.random.default_rng(seed), []
    for number in range(5):
        own = rng.normal(0, 2.0, LINKS)[OF_ROW]
        level = -60 - 20 * np.log10(DISTANCE[OF_ROW]) + own + rng.normal(0, 0.3, len(OF_ROW))
        level += 0.0 if number else shift_db(DISTANCE[OF_ROW])
        error = slope * own + rng.normal(0, 0.01, len(OF_ROW))
        made.append(np.stack([error, level], axis=1))
    return Ensemble(("error_m", "rx_power_dbm"), ("m", "dB"), np.stack(made), OF_ROW)


def scatter(left: Floats) -> float:
    """Return how link means scatter, in metres."""
    return float(np.std(left.reshape(LINKS, ROWS).mean(axis=1)))


@pytest.mark.parametrize("shift_db", [lambda far: 0 * far, lambda far: -6 * np.log10(far)])
def test_what_links_differ_by_in_both_is_taken_off(shift_db: Callable[[Floats], Floats]) -> None:
    made = versions(2, shift_db)
    left = beside_level(rows(), made, made.residual_of("error_m"))
    assert scatter(made.residual_of("error_m")) > 2 * scatter(left)
    assert abs(np.polyfit(np.log(DISTANCE[OF_ROW]), left, 1)[0]) < 0.01  # a path loss is no part


def test_errors_that_go_with_no_level_stay() -> None:
    made = versions(3, lambda far: 0 * far, 0.0)
    left = made.residual_of("error_m")
    assert beside_level(rows(), made, left) == pytest.approx(left)


def test_offsets_that_simulated_links_have_too_have_a_mean_that_is_known() -> None:
    rng, code = np.random.default_rng(4), np.repeat(np.arange(22), 20)
    left = 0.055 + rng.normal(0, 0.02, 22)[code] + rng.normal(0, 0.006, len(code))
    parts = {"antenna-delay": (np.ones((len(code), 1)),)}

    def brings(links_m: float) -> float:
        """Return the nats of a constant, where simulated links differ by so much."""
        evidence = Evidence(left, code, parts)
        evidence.scatter_m2, evidence.links_m2 = 0.006**2, links_m**2
        evidence.reweigh(())
        return evidence.of(["antenna-delay"]).nats - evidence.of([]).nats

    assert LARGE_OFFSETS * 0.006**2 < 0.02**2
    assert brings(0.0) < 4 < 8 < brings(0.02)


def test_how_simulated_links_scatter_is_said_beside_a_line() -> None:
    made = versions(5, lambda far: 0 * far)
    found = made.links_scatter_of("error_m", DISTANCE[OF_ROW])
    assert found == pytest.approx(SLOPE * 2.0 / 2, rel=0.35)  # of the mean of four versions
    few = Ensemble(made.names, made.units, made.versions[:, :6], OF_ROW[:6])
    assert few.links_scatter_of("error_m", DISTANCE[OF_ROW[:6]]) == 0.0
