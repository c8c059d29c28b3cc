"""Delays are constants: what all devices have in proportion to a number is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.sets.choice import Choice
from bench.discrepancy.sets.choose import chosen
from bench.discrepancy.sets.constant_in import FOLLOWING, in_words
from bench.recordings.table import Recordings
from tests.bench.discrepancy.sets.test_sets import search_of

LATE_M = {"d5": 0.25, "d7": 0.2, "d9": 0.3}
LABEL = f"antenna-delays{FOLLOWING}motor_a"


def motor_a(frame: pd.DataFrame) -> np.ndarray:
    """Return a current of 10 to 50 A in any order: by the golden part of a row's number."""
    turns = 0.618034 * np.arange(len(frame))
    return np.asarray(10 + 40 * (turns % 1))


def with_current(given: Recordings) -> Recordings:
    """Return a table that has the current in a column."""
    return replace(given, frame=given.frame.assign(motor_a=motor_a(given.frame)))


def constant(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Some receivers are late."""
    return np.asarray(frame["rx"].map(LATE_M).fillna(0.0), float)


def sagging(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """Some receivers are late by what a motor draws from their supply."""
    return constant(frame, rng) * motor_a(frame) / 30


@pytest.mark.parametrize(
    ("hidden", "names", "following"),
    [(constant, ("antenna-delay",), False), (sagging, (), True)],
)
def test_delays_that_follow_a_current_are_none(
    hidden: object, names: tuple[str, ...], following: bool
) -> None:
    found = chosen(search_of(hidden, 5, with_current), ())  # type: ignore[arg-type]
    assert found.names == names
    assert (LABEL in found.others) is following
    assert bool(in_words(found)) is following


def test_what_follows_is_said_in_words() -> None:
    said = in_words(Choice(others=("a law of motor_a", LABEL)))
    assert said == f"looks most like {LABEL}, and these would be constants"
    assert not in_words(Choice(others=("a law of motor_a",)))
