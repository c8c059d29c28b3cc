"""Laws of two devices at once: both are said, and both are in the simulator."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import bench
from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.law.found import FoundLaw, LawConstant, law_dict

ONE = Estimate(1, 1, 1)


def of_device(where: str, size: float, beside: FoundLaw | None = None) -> FoundLaw:
    """Return a law over the temperature at one device."""
    constant = LawConstant("a", size, size, size, "m/degC")
    device = where.split()[-1]
    return FoundLaw(
        "linear", ("temperature_c",), where, f"error = {constant} x warm, where {where}", "warmth",
        f'a * temperature_c * (rx == "{device}")', (constant,), 20.0, ONE, ONE, beside=beside,
    )  # fmt: skip


def test_both_are_one_effect_with_constants_of_their_own() -> None:
    law = of_device("rx is a2", 0.008, of_device("rx is a4", -0.007))
    assert law.whole.constants == ("a = 0.008 m/degC", "a_2 = -0.007 m/degC")
    assert law.whole.expression.count("a_2 * temperature_c") == 1
    assert "and another beside it" in str(law)
    told = law_dict(law)
    assert told is not None
    assert told["beside"]["where"] == "rx is a4"
    assert of_device("rx is a2", 0.008).whole == of_device("rx is a2", 0.008).effect


def yard(seed: int) -> pd.DataFrame:
    """Return ranges of 120 links between tags and four anchors, over a day; SIMULATED."""
    rng = np.random.default_rng(seed)
    links = np.repeat(np.arange(120), 5)
    frame = pd.DataFrame({"link": [f"{seed}-{n}" for n in links]})
    frame = frame.assign(tx=[f"t{n % 6}" for n in links], rx=[f"a{n % 4}" for n in links // 6])
    frame = frame.assign(
        true_range_m=rng.uniform(4, 18, 120)[links], warm_k=rng.uniform(-10, 10, len(links))
    )
    return frame.assign(range_m=frame["true_range_m"] + rng.normal(0, 0.02, len(links)))


@pytest.mark.filterwarnings("ignore")
def test_a_diagnosis_says_the_laws_of_two_devices() -> None:
    recorded = yard(1)
    sizes = recorded["rx"].map({"a1": 0.012, "a3": -0.01}).fillna(0.0)
    found = bench.diagnose(
        recorded.assign(range_m=recorded["range_m"] + sizes * recorded["warm_k"]),
        yard(2),
        known=("warm_k",),
    )
    assert found.law is not None
    assert found.law.beside is not None
    assert {found.law.where, found.law.beside.where} == {"rx is a1", "rx is a3"}
    assert found.confirmed.mae_after_m.value < 0.6 * found.confirmed.mae_before_m.value
