"""Where a step lies between two rows that it acts on, no row tells."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.discrepancy.law.material import material
from bench.discrepancy.law.search import propose


def test_the_place_of_a_step_is_as_open_as_the_gap_it_lies_in() -> None:
    rng = np.random.default_rng(1)
    time_s = np.r_[rng.uniform(0, 2000, 200), rng.uniform(3300, 5000, 200)]
    left_m = 0.2 * (time_s > 3000) + rng.normal(0, 0.02, len(time_s))
    given = material(pd.DataFrame({"time_s": time_s}), left_m, np.arange(len(time_s)) // 5)
    found = propose(given, 0)
    assert found is not None
    assert found.best.structure.form == "step"
    place = next(one for one in found.constants if one.name == "x0")
    before, after = time_s[time_s < 3000].max(), time_s[time_s > 3000].min()
    assert place.low <= before < 3000 < after <= place.high
    assert place.high - place.low < 1.2 * (after - before)
