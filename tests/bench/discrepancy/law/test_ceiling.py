"""Ranges that are cut off are said to be, with where."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.law.ceiling import ceilings
from bench.discrepancy.law.judge import judged, setup_fault
from bench.discrepancy.law.material import material
from bench.discrepancy.law.search import propose
from bench.physics.effects.ranging.law import Law

LINKS = np.repeat(np.arange(80), 6)
LATE_M = 0.12  # of simulated ranges, which is no fault


def rows(most_m: float) -> tuple[pd.DataFrame, np.ndarray]:
    """Return rows of which no range reads more than `most_m`, and recorded - simulated in m."""
    rng = np.random.default_rng(2)
    true = np.repeat(rng.uniform(2, 25, 80), 6)
    simulated = true + LATE_M
    measured = np.minimum(simulated + rng.normal(0, 0.03, len(true)), most_m)
    frame = pd.DataFrame({"true_range_m": true, "range_m": measured, "error_m": measured - true})
    return frame, measured - simulated


def test_a_ceiling_is_found_where_ranges_are_cut_off() -> None:
    frame, left = rows(19.8)
    proposal = propose(material(frame, left, LINKS), 0)
    assert proposal is not None
    law, fault = judged(proposal, proposal.given, 0), setup_fault(proposal)
    assert law is not None
    assert law.form == "ceiling"
    assert law.words.startswith("no range reads more than 19.8")
    assert fault is not None
    assert fault.size[0].value == pytest.approx(19.8, abs=0.05)
    assert law.effect.expression == "(range_m > most) * (most - range_m)"
    assert isinstance(law.effect, Law)


def test_ranges_that_are_not_cut_off_have_none() -> None:
    frame, left = rows(np.inf)
    assert not list(ceilings(material(frame, left, LINKS)))
