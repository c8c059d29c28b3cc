"""A truth that was read off a floor plan is a fault of the set-up where heights tell so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.law.floor import floors
from bench.discrepancy.law.judge import judged, setup_fault
from bench.discrepancy.law.material import Material, material
from bench.discrepancy.law.search import propose

RNG = np.random.default_rng(3)
LINKS = np.repeat(np.arange(60), 4)


def rows(plan: bool, places: bool) -> tuple[pd.DataFrame, np.ndarray]:
    """Return rows with heights and what ranges are off by; `plan`: the truth has no heights."""
    at = {end: RNG.uniform(0, 15, (60, 3))[LINKS] for end in ("tx", "rx")}
    at["tx"][:, 2], at["rx"][:, 2] = RNG.uniform(0.5, 2, 60)[LINKS], 4.5
    gap = at["rx"] - at["tx"]
    slant, floor = np.linalg.norm(gap, axis=1), np.hypot(*gap[:, :2].T)
    kept = "xyz" if places else "z"
    frame = pd.DataFrame(
        {f"{e}_{a}_m": at[e][:, i] for e in at for i, a in enumerate("xyz") if a in kept}
    )
    truth = np.round(floor, 2) if plan else slant
    frame = frame.assign(true_range_m=truth, range_m=slant, link=LINKS, temperature_c=slant % 3)
    noise = RNG.normal(0, 0.02, len(slant))
    return frame, slant - truth + noise


def of(made: tuple[pd.DataFrame, np.ndarray], keep: np.ndarray) -> Material:
    return material(made[0][keep].reset_index(drop=True), made[1][keep], LINKS[keep])


@pytest.mark.parametrize("places", [True, False])
def test_a_truth_without_heights_is_said(places: bool) -> None:
    made = rows(True, places)
    proposal = propose(of(made, LINKS < 45), 0)
    assert proposal is not None
    law, fault = judged(proposal, of(made, LINKS >= 45), 0), setup_fault(proposal)
    assert law is not None
    assert fault is not None
    assert fault.kind == "floor"
    assert "true_range_m is the distance on the floor plan" in str(law)
    assert law.effect.formula.shown  # it can be simulated
    assert abs(law.nearer_m.value) > 0.2


def test_a_truth_with_heights_or_places_that_are_not_its_own_has_no_such_fault() -> None:
    made = rows(False, True)
    assert of(made, LINKS < 60).rise_m is None
    assert propose(of(made, LINKS < 60), 0) is None
    assert propose(of(rows(False, False), LINKS < 60), 0) is None


def test_heights_that_hardly_matter_are_no_fault() -> None:
    made = of(rows(True, True), LINKS < 60)
    assert made.rise_m is not None
    assert len(list(floors(made))) == 1
    assert not list(floors(replace(made, rise_m=made.rise_m / 20)))
