"""Sealed links tell of a class which of it they bear out, where they refuse the first."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.confirm import Served
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.report.document import _untouched
from bench.discrepancy.select import sealed
from bench.discrepancy.select.sealed import unrefused
from bench.discrepancy.select.sealed_class import named_once
from bench.discrepancy.select.state import Round, Selection
from bench.discrepancy.select.verdict import Ambiguous, Control, LeftOut, not_tried
from bench.physics.effect import Effect
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.temperature import TemperatureDrift
from bench.physics.effects.ranging.time_lag import TimeLag

DRIFT, DELAY, SCALE, LAG = TemperatureDrift(), AntennaDelay(), RangeScale(), TimeLag()
ROWS = SimpleNamespace(frame=pd.DataFrame({"error_m": [0.0]}), waveform=False)
Gains = dict[str, tuple[float, float, float]]


def named(effect: Effect) -> LeftOut:
    return LeftOut(effect, (), Estimate(1, 0.5, 1.5), 1.0, Control("", None))


def found(
    monkeypatch: pytest.MonkeyPatch, gains: Gains, farther: str = "", untried: str = ""
) -> Selection:
    """Return what stays of delay, scale or drift beside a lag, by what each gains beside it."""

    def judge(_: object, __: object, added: tuple[Effect, ...], ___: int) -> Served:
        each = [gains[one.name] for one in added if one.name in gains]
        gain = Estimate(*(sum(part) for part in zip((0.2, 0.1, 0.3), *each, strict=True)))
        return Served(gain, any(one.name == farther for one in added), 0.1, 0.2)

    monkeypatch.setattr(sealed, "served", judge)
    turn = Round(Located((), 0.002, 9.0, 3.0, 1, {}), None, None)
    turn = replace(turn, explanation=SimpleNamespace(contenders=(), removable=Estimate(1, 0, 2)))  # type: ignore[arg-type]
    options = tuple(map(named, (DELAY, SCALE, DRIFT)))
    options = tuple(replace(o, note="not tried") if o.names[0] == untried else o for o in options)
    said = Ambiguous(options, ""), named(LAG)
    return unrefused(None, ROWS, Selection(said, (DELAY, LAG), (turn,)), (), 0)[0]  # type: ignore[arg-type]


def test_the_one_that_sealed_links_bear_out_comes_in_the_place_of_the_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    gains = {"antenna-delay": (-1, -1.2, -0.8), "range-scale": (-0.3, -0.4, -0.2)}
    made = found(monkeypatch, gains | {"temperature-drift": (0.9, 0.5, 1.3)})
    assert made.names == (("temperature-drift",), ("time-lag",))
    assert set(made.added) == {DRIFT, LAG}
    assert made.sealed_choice == ("antenna-delay", "range-scale", "temperature-drift")
    assert made.withheld["antenna-delay"].startswith("was not added")
    assert "temperature-drift, which other links do not tell from it, is better" in str(
        made.withheld
    )


def test_what_chance_may_have_refused_stays_in_the_class(monkeypatch: pytest.MonkeyPatch) -> None:
    gains = {"antenna-delay": (-0.3, -2, 1.4), "range-scale": (-1, -1.2, -0.8)}
    made = found(monkeypatch, gains | {"temperature-drift": (0.9, 0.5, 1.3)})
    assert made.names == (("temperature-drift", "antenna-delay"), ("time-lag",))
    assert set(made.added) == {DRIFT, LAG}


def test_one_that_serves_takes_the_place_of_what_chance_may_have_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of offsets of 26 devices and one drift that do as well, sealed links bear out the drift."""
    gains = {"antenna-delay": (-0.3, -2, 1.4), "range-scale": (-1, -1.2, -0.8)}
    made = found(monkeypatch, gains | {"temperature-drift": (0.9, -0.5, 1.3)})
    assert made.names == (("temperature-drift", "antenna-delay"), ("time-lag",))
    assert set(made.added) == {DRIFT, LAG}


def test_what_could_not_be_tried_takes_no_place_and_stays_open(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    gains = {"antenna-delay": (-1, -1.2, -0.8), "range-scale": (9.0, 8.0, 10.0)}
    gains["temperature-drift"] = (0.9, 0.5, 1.3)
    made = found(monkeypatch, gains, untried="range-scale")
    assert made.names == (("temperature-drift", "range-scale"), ("time-lag",))
    assert set(made.added) == {DRIFT, LAG}


@pytest.mark.parametrize(
    ("drift", "farther"), [((0.9, -0.5, 1.3), ""), ((0.9, 0.5, 1.3), "temperature-drift")]
)
def test_what_is_in_doubt_there_or_makes_ranges_farther_takes_no_place(
    monkeypatch: pytest.MonkeyPatch, drift: tuple[float, float, float], farther: str
) -> None:
    gains = {"antenna-delay": (-1, -1.2, -0.8), "range-scale": (-1, -1.2, -0.8)}
    made = found(monkeypatch, gains | {"temperature-drift": drift}, farther)
    assert made.names == (("time-lag",),)
    assert not made.sealed_choice


def test_a_class_that_serves_is_left_as_working_links_have_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    gains = {"antenna-delay": (0.1, 0.05, 0.2), "temperature-drift": (5.0, 4.0, 6.0)}
    made = found(monkeypatch, gains | {"range-scale": (5.0, 4.0, 6.0)})
    assert made.names[0] == ("antenna-delay", "range-scale", "temperature-drift")
    assert set(made.added) == {DELAY, LAG}
    assert not made.withheld


def test_the_report_says_that_sealed_links_told_a_name() -> None:
    assert "or chosen on these links" in _untouched(())
    told = _untouched(("clock-offset", "temperature-drift"))
    assert "which of clock-offset or temperature-drift is added" in told
    assert "chosen" not in told


def test_a_class_has_no_name_that_is_given_for_sure() -> None:
    """The first line said "(A or B or C), B": what is there anyhow is no alternative to A."""
    several = Ambiguous(tuple(map(named, (DELAY, SCALE, DRIFT))), "")
    made = named_once((several, named(SCALE)))
    assert [one.names for one in made] == [("antenna-delay", "temperature-drift"), ("range-scale",)]
    assert named_once((several, named(LAG)))[0] is several
    of_two = Ambiguous((named(DELAY), named(SCALE)), "")
    assert isinstance(named_once((of_two, named(SCALE)))[0], LeftOut)


def test_what_could_not_be_tried_is_an_alternative_beside_its_own_name() -> None:
    """Walls of other makes strike links, beside a wall that all ways have in common."""
    others = not_tried(named(DELAY), SCALE, "it could not be tried: nobody listed it")
    several = Ambiguous((named(DELAY), others), "")
    assert named_once((several, named(SCALE)))[0] is several
