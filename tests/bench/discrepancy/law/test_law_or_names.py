"""A law over what is known goes before names that stand in for it, and not before true ones."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.method import Diagnosis, Options, diagnose
from bench.discrepancy.select.candidates import library
from tests.bench.discrepancy.numpy_tables import tables, walls

KINDS = ("blocked-path", "antenna-delay", "timestamp-jitter")
Hidden = Callable[[pd.DataFrame, np.random.Generator], np.ndarray]


def found(hidden: Hidden, seed: int, per_link: int) -> Diagnosis:
    every = library()[0]
    recorded, simulated = tables(seed, hidden, links=90, per_link=per_link, replicas=1)
    kinds = {name: every[name] for name in KINDS}
    return diagnose(recorded, simulated, Options(seed=1), kinds=kinds)


def worn(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """One device's error grows with the square of the distance."""
    return 0.004 * (frame["tx"] == "d1") * frame["true_range_m"] ** 2


def test_what_a_law_predicts_was_not_struck_at_random() -> None:
    made = found(worn, 4, 1)
    assert made.selection.names == ()
    assert made.law is not None
    assert (made.law.form, made.law.columns) == ("power", ("true_range_m",))
    assert made.law.constants[2].value == pytest.approx(2, abs=0.2)


def test_links_that_are_struck_at_random_keep_their_name() -> None:
    made = found(walls, 5, 2)
    assert made.selection.names == (("blocked-path",),)
    assert made.law is None


def turning(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """Errors grow with the square of how far the temperature is from 18 degrees Celsius."""
    return 2.2e-4 * (frame["temperature_c"] - 18) ** 2


def drifting(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """Errors in proportion to the temperature."""
    return 0.004 * (frame["temperature_c"] - 18)


@pytest.mark.parametrize(
    ("hidden", "names", "form"),
    [(turning, (), "parabola"), (drifting, (("temperature-drift",),), "")],
)
def test_a_name_whose_free_curve_held_out_is_none_where_its_effect_does_not(
    hidden: Hidden, names: tuple[tuple[str, ...], ...], form: str
) -> None:
    """Nor is a parabola over the temperature half a drift in proportion to it."""
    every = library()[0]
    recorded, simulated = tables(7, hidden, links=120, per_link=4, replicas=1)
    kinds = {name: every[name] for name in ("antenna-delay", "range-scale", "temperature-drift")}
    made = diagnose(recorded, simulated, Options(seed=1), kinds=kinds)
    assert made.selection.names == names
    assert (made.law.form if made.law else "") == form
