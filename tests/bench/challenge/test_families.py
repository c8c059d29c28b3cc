"""The generator families: deterministic, of the stated mix, and really hiding what they say."""

from __future__ import annotations

import numpy as np
import pytest

from bench.challenge.families import box, hall, make
from bench.challenge.families.case import FAMILIES, Draw
from bench.recordings.clean import clean

WORLDS = {"hall": hall, "box": box}


def test_an_unknown_family_is_named() -> None:
    with pytest.raises(ValueError, match="unknown family 'x'; known: hall, box"):
        make("x", 0, 0)


@pytest.mark.parametrize("family", FAMILIES)
def test_the_same_seed_gives_the_same_case(family: str) -> None:
    one, other = make(family, 4, 3), make(family, 4, 3)
    assert one.draw == other.draw
    assert one.recorded["range_m"].equals(other.recorded["range_m"])
    assert not one.recorded["range_m"].equals(make(family, 4, 5).recorded["range_m"])


@pytest.mark.parametrize("family", FAMILIES)
def test_of_twenty_cases_five_are_empty_and_four_outside(family: str) -> None:
    cases = [make(family, number, 1) for number in range(20)]
    assert sum(not case.draw.hidden for case in cases) == 5
    assert sum(bool(case.outside) for case in cases) == 4
    assert sum(not case.draw.same_mix for case in cases) in (2, 3)
    assert {case.draw.ratio for case in cases} == {1, 3, 8}


@pytest.mark.parametrize("family", FAMILIES)
def test_tables_are_in_the_exchange_form(family: str) -> None:
    case = make(family, 1, 1)
    for table in (case.recorded, case.simulated):
        assert np.allclose(table["error_m"], table["range_m"] - table["true_range_m"])
        assert not clean(table, family).dropped


@pytest.mark.parametrize("family", FAMILIES)
def test_every_effect_changes_the_recordings_and_nothing_hidden_changes_none(family: str) -> None:
    world = WORLDS[family]
    plain, beside = world.tables(Draw(ratio=1), np.random.default_rng(5))
    assert abs(plain["error_m"].std() - beside["error_m"].std()) < 0.01
    seen = ["error_m", "rx_power_dbm", *(["noise_std"] if family == "box" else [])]
    for name in (*world.KNOWN, *world.OUTSIDE):
        hidden, _ = world.tables(Draw((name,), 2.0, 1), np.random.default_rng(5))
        cir = 0.0
        if family == "box":
            cir = np.abs(np.stack(list(hidden["cir"])) - np.stack(list(plain["cir"]))).mean()
        moved = max(np.abs(hidden[column] - plain[column]).mean() for column in seen)
        assert moved > 0.005 or cir > 20, name
