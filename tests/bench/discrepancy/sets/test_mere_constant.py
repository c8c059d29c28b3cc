"""A small constant of all ranges has no name; devices that differ, and large constants, have."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.sets.choice import MERE, Choice
from bench.discrepancy.sets.choose import chosen
from bench.discrepancy.sets.mere_constant import as_mere
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.temperature import TemperatureDrift
from tests.bench.discrepancy.sets.test_sets import search_of

LATE_M = 0.03


def alike(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Return the same few centimetres in all ranges."""
    return np.full(len(frame), LATE_M)


def large(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Return more than covers and detectors make."""
    return np.full(len(frame), 5 * LATE_M)


def apart(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """Return the same in the mean, of devices that differ."""
    own = dict(zip([f"d{i}" for i in range(11)], rng.normal(0.0, 0.03, 11), strict=True))
    return LATE_M + (frame["tx"].map(own) + frame["rx"].map(own)).to_numpy(float)


@pytest.mark.parametrize(
    ("hidden", "names", "others"),
    [
        (alike, (), (MERE,)),
        (large, ("antenna-delay",), ()),
        (apart, ("antenna-delay",), ()),
    ],
)
def test_a_small_constant_of_all_devices_has_no_name(
    hidden: object, names: tuple[str, ...], others: tuple[str, ...]
) -> None:
    found = chosen(search_of(hidden, 4), ())  # type: ignore[arg-type]
    assert (found.names, found.others) == (names, others)


def test_beside_a_constant_scatter_is_asked_beside_a_law_it_is_not() -> None:
    assert Choice(others=(MERE,)).scattering == ()
    assert Choice(others=("a law of time_s", MERE)).scattering == ("a law of time_s",)


@pytest.mark.parametrize(("delay_ns", "named"), [(0.1, False), (-0.1, False), (1.0, True)])
def test_a_delay_that_comes_out_small_is_a_constant_without_a_name(
    delay_ns: float, named: bool
) -> None:
    """Beside late detection ranges spoke for 6 cm, and 1.4 cm were left of it."""
    delay, drift = AntennaDelay(delay_ns), TemperatureDrift(0.003)
    shifts_m = {"antenna-delay": np.full(2, 0.06), "temperature-drift": np.zeros(2)}
    names = ("antenna-delay", "temperature-drift")
    choice, added = as_mere(Choice(names=names, shifts_m=shifts_m), (delay, drift))
    assert (choice.names, choice.others) == ((names, ()) if named else (names[1:], (MERE,)))
    assert added == ((delay, drift) if named else (drift,))
    assert set(choice.shifts_m) == {*choice.names, *choice.others}
