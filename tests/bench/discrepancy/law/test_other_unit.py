"""Ranges of one device that are off in proportion are in another unit, whatever its name."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from numpy.typing import NDArray

from bench.discrepancy.law.found import LawConstant
from bench.discrepancy.law.judge import setup_fault
from bench.discrepancy.law.likelihood import Fit
from bench.discrepancy.law.material import Material
from bench.discrepancy.law.search import Candidate, Proposal, Ranking, _preferred
from bench.discrepancy.law.structures import Fitted

Floats = NDArray[np.float64]
BESIDE = LawConstant("b", 0.1, 0.09, 0.11, "m")


@pytest.mark.parametrize(
    ("rate", "where", "beside", "devices"),
    [
        (-0.453, "rx is crane3", (), ("rx is crane3",)),
        (-0.025, "tx is tag1", (), ("tx is tag1",)),
        (2e-5, "rx is crane3", (), None),  # a crystal may be
        (-0.453, "rx is crane3", (BESIDE,), None),
        (0.2, "room is hall", (), None),
        (0.3, "", (), ()),
        (0.02, "", (), None),  # the library's range-scale
        (1e-3, "tx is tag1", (), None),  # known to a fifth of itself only
    ],
)
def test_what_is_in_proportion_and_no_clock_is_a_unit(
    rate: float, where: str, beside: tuple[LawConstant, ...], devices: tuple[str, ...] | None
) -> None:
    structure = SimpleNamespace(form="linear", columns=("true_range_m",), where=where, fault="")
    constants = (LawConstant("a", rate, rate - 2e-4, rate + 2e-4, "1"), *beside)
    best = SimpleNamespace(structure=structure)
    made = setup_fault(cast(Proposal, SimpleNamespace(best=best, constants=constants)))
    assert (made and made.devices) == devices
    if made is not None:
        assert made.kind == "unit"
        assert made.size[0].value == pytest.approx(1 + rate)


FAR_M = np.linspace(5.0, 40.0, 60)
THEIRS = np.arange(60) % 3 == 0  # the rows of one device


def bent(form: str, where: str, nats: float, shift_m: Floats, *values: float) -> Candidate:
    """Return a law over the true range that is worth some nats in all rows."""
    structure = SimpleNamespace(
        form=form, columns=("true_range_m",), where=where, fault="", free=len(values), choices=1
    )
    constants = tuple(("a", value, "1") for value in values)
    fitted = Fitted(constants, Fit(np.array(values), np.where(THEIRS, shift_m, 0.0), 0.1, 0.0))
    return Candidate(structure, fitted, nats)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("where", "rate", "off_m", "first"),
    [
        ("rx is stake4", 2.08, 0.05, "linear"),
        ("rx is stake4", 2.08, 0.5, "power"),  # that bends after all
        ("rx is stake5", 2.08, 0.05, "power"),
        ("rx is stake4", 2e-5, 0.05, "power"),
    ],
)
def test_a_power_of_one_does_not_hide_a_unit(
    where: str, rate: float, off_m: float, first: str
) -> None:
    """The scatter of the device is 0.2 m: a bend of 0.05 m of scatter 0.01 m elsewhere is none."""
    rng, best_m = np.random.default_rng(1), rate * FAR_M
    own_m = np.where(THEIRS, best_m + rng.normal(0, 0.2, 60), rng.normal(0, 0.01, 60))
    given = cast(Material, SimpleNamespace(residual_m=own_m))
    line_m = best_m + off_m * np.cos(FAR_M)
    power = bent("power", "rx is stake4", 400.0, best_m, 54.2, 0.996, -0.2)
    made = Ranking((power, bent("linear", where, 380.0, line_m, rate)), 0.0, 1.0)
    assert _preferred(made, given).structure.form == first
