"""A name gives way to a law that predicts as well; a name that is the truth does not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.sets.choose import chosen
from tests.bench.discrepancy.numpy_tables import Hidden, warmth
from tests.bench.discrepancy.sets.test_sets import search_of


def stepped(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Return 8 cm from 24 degrees on: warming radios follow no step."""
    return 0.08 * (frame["temperature_c"].to_numpy() > 24)


def settling(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Return what levels off with the distance: an error of the level would too."""
    return 0.15 * (1 - np.exp(-frame["true_range_m"].to_numpy() / 4))


@pytest.mark.parametrize(
    ("hidden", "names", "form"),
    [(stepped, (), "step"), (settling, (), ""), (warmth, ("temperature-drift",), "")],
)
def test_a_name_holds_only_where_no_law_predicts_as_well(
    hidden: Hidden, names: tuple[str, ...], form: str
) -> None:
    found = chosen(search_of(hidden, 11), ())
    assert found.names == names
    assert any(one.startswith(form) for one in (*found.others, ""))


def set_aside(hidden: Hidden | None, load: Callable[[pd.DataFrame], np.ndarray]) -> tuple[str, ...]:
    """Return the columns that are known before, of one that was set aside as measured."""
    search = search_of(hidden, 12)
    assert search.work is not None
    doubtful = pd.DataFrame({"load": load(search.work.frame)})
    return chosen(replace(search, doubtful=doubtful), ()).mistaken


def busy(frame: pd.DataFrame) -> np.ndarray:
    """Return a load that scatters from row to row."""
    return np.random.default_rng(5).lognormal(3, 0.8, len(frame))


def test_a_column_that_explains_what_is_missing_was_known_before() -> None:
    def delayed(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
        return 0.2 * busy(frame) / (busy(frame) + 20)

    assert set_aside(delayed, busy) == ("load",)
    assert set_aside(None, busy) == ()


def test_a_column_that_follows_the_noise_stays_measured() -> None:
    rng = np.random.default_rng(6)
    assert set_aside(None, lambda f: f["error_m"] + rng.normal(0, 0.02, len(f))) == ()
