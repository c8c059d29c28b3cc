"""A law over what is known goes before names that stand in for it, and not before true ones."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy import Diagnosis, Options, diagnose
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
