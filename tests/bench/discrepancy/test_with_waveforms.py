"""Where waveforms show nothing, ranges are looked at by themselves; names are not taken there."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, cast

import pytest

from bench.discrepancy import Options
from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.locate.finding import Finding, Located
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.select.state import Round, Selection
from bench.discrepancy.select.verdict import Unknown
from bench.discrepancy.with_waveforms import ALONE, or_without


@dataclass(frozen=True)
class Made:
    """What is asked of a diagnosis."""

    selection: Any
    options: Options = field(default_factory=lambda: Options(waveform=True))
    law: str = ""
    setup_fault: str = ""
    added: tuple[str, ...] = ()
    counted: tuple[str, ...] = ()


def _found(*observables: str) -> Selection:
    effect = Estimate(0.03, 0.02, 0.04, "m")
    findings = tuple(
        Finding(Cell(one, "mean", Place()), effect, 9.0, 0.002, 40, 9) for one in observables
    )
    return Selection((), (), (Round(Located(findings, 0.002, 9.0, 4.0, 9, {}), None, None),), {})


@dataclass(frozen=True)
class Named:
    """A selection with names."""

    names: tuple[tuple[str, ...], ...] = (("power-bias",),)


def _or_without(made: Made, other: Made) -> Made:
    return cast("Made", or_without(cast("Any", made), lambda: cast("Any", other)))


LAW = Made(_found("error_m"), law="error = 0.1")


def test_a_law_of_ranges_by_themselves_is_said_where_waveforms_show_nothing() -> None:
    said = _or_without(Made(_found("error_m")), LAW)
    assert said.law == LAW.law
    assert said.counted == (ALONE,)


def test_so_it_is_where_ranges_speak_for_something_that_no_place_shows() -> None:
    unknown = Unknown((), Estimate(0.0, 0.0, 0.0, "m"))
    asked = replace(_found(), verdicts=(unknown,))
    assert _or_without(Made(asked), LAW).counted == (ALONE,)


@pytest.mark.parametrize(
    ("made", "other"),
    [
        (Made(_found("error_m", "energy_db")), LAW),  # waveforms differ, too
        (Made(_found("error_m"), added=("a curve",)), LAW),
        (Made(_found("error_m"), Options(waveform=False)), LAW),
        (Made(_found()), LAW),
        (Made(_found("error_m")), Made(_found("error_m"))),  # no more is said
        (Made(_found("error_m")), Made(Named(), added=("power-bias",))),
    ],
)
def test_else_it_stays(made: Made, other: Made) -> None:
    assert _or_without(made, other) is made
