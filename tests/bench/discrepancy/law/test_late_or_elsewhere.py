"""A device that is late is no device that stands elsewhere: one number stands against three."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.law.delay import as_delay
from bench.discrepancy.law.found import FoundLaw, Rival
from bench.discrepancy.law.judge import tied_names
from bench.discrepancy.law.material import Material, material
from bench.discrepancy.law.screen import promising
from bench.discrepancy.law.search import propose

AXES = ("x", "y", "z")
LATE_M, MOVED_M = 0.12, np.array([0.3, -0.25, 0.1])


def _rows(late_m: float, moved_m: NDArray[np.float64], seed: int = 4) -> Material:
    """Return rows of 40 places and six anchors, of which one is late or stands elsewhere."""
    rng = np.random.default_rng(seed)
    anchors = np.array([[x, y, z] for x, z in ((0, 3), (15, 4), (30, 5)) for y in (0, 12)], float)
    tags = np.column_stack(
        [rng.uniform(1, 29, 40), rng.uniform(1, 11, 40), rng.uniform(0.5, 2, 40)]
    )
    tag, rx = np.repeat(np.arange(40), 3), rng.integers(0, 6, 120)
    tag, rx = np.repeat(tag, 3), np.repeat(rx, 3)
    true_m = np.linalg.norm(tags[tag] - anchors[rx], axis=1)
    really = np.linalg.norm(tags[tag] - anchors[rx] - moved_m, axis=1)
    error = np.where(rx == 2, late_m + really - true_m, 0.0) + rng.normal(0, 0.03, 360)
    places = {f"tx_{a}_m": tags[tag, i] for i, a in enumerate(AXES)}
    places |= {f"rx_{a}_m": anchors[rx, i] for i, a in enumerate(AXES)}
    names = {"tx": [f"t{i % 4}" for i in tag], "rx": [f"a{i}" for i in rx]}
    frame = pd.DataFrame({"true_range_m": true_m, **places, **names})
    return material(frame, error, tag * 6 + rx)


@pytest.mark.parametrize(
    ("late_m", "moved_m", "form"),
    [(LATE_M, np.zeros(3), "constant"), (0.0, MOVED_M, "position")],
)
def test_one_device_is_late_or_stands_elsewhere(
    late_m: float, moved_m: NDArray[np.float64], form: str
) -> None:
    found = propose(_rows(late_m, moved_m), 0)
    assert found is not None
    assert found.best.structure.form == form
    assert found.best.structure.where in ("rx is a2", "a2")


def test_a_delay_that_does_about_as_well_as_a_place_is_said_with_it() -> None:
    own = Rival("error = 0.15 m, where rx is a2", "constant", (), 2.0)
    other = Rival("error = 0.2 m, where rx is a3", "constant", (), 1.0)
    nothing = Estimate(0, 0, 0)
    law = FoundLaw(
        "position", (), "a2", "", "", "", (), 9.0, nothing, nothing, (other, own), "position"
    )
    said = [one.words for one in tied_names(law, ())]
    assert said == ["antenna-delay of a2 instead (error = 0.15 m)"]


def test_a_delay_of_one_device_pays_for_a_choice_among_devices() -> None:
    given = _rows(LATE_M, np.zeros(3))
    laws = promising(given, float(len(given.residual_m)))
    late = next(law for law in laws if law.form == "constant" and law.where == "rx is a2")
    assert as_delay(given, late).choices == 4 + 6 + 1 < late.choices
    others = [law for law in laws if law.form != "constant"]
    assert all(as_delay(given, law) is law for law in others)
