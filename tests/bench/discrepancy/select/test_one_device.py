"""A fault of one device beside a named effect is said, though no regression foretells it."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.headline import headline
from bench.discrepancy.locate.finding import Finding, Located
from bench.discrepancy.locate.hypotheses import Cell, Moment, Place
from bench.discrepancy.select import conclude
from bench.discrepancy.select.one_device import all_at_device, left_at_device
from bench.discrepancy.select.state import Round
from bench.discrepancy.select.verdict import Control, LeftOut, Unknown
from bench.discrepancy.sets.choice import Choice
from bench.physics.effects.ranging.time_lag import TimeLag

GAIN = Estimate(0.3, 0.2, 0.4, "nats")
LAG = LeftOut(TimeLag(), (), GAIN, 1.0, Control("", None))


def seen(place: str, moment: Moment = "mean", value: float = 0.2, p: float = 0.002) -> Finding:
    """Return a finding of ranges at a place."""
    effect = Estimate(value, value - 0.05, value + 0.05, "m")
    return Finding(Cell("error_m", moment, Place(place)), effect, 9.0, p, 40, 9)


@pytest.mark.parametrize(
    ("one", "waveform", "said"),
    [(seen("rx=a1"), False, True), (seen("rx=a1"), True, False), (seen("rx_z_m"), False, False)],
)
def test_what_names_leave_at_one_device_is_said_though_no_regression_foretells_it(
    one: Finding, waveform: bool, said: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert said_beside_a_lag(one, waveform, (), monkeypatch) is said


@pytest.mark.parametrize(("waveform", "said"), [(False, True), (True, False)])
def test_a_fault_that_the_set_holds_is_left_to_say(
    waveform: bool, said: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    faults = ("the places of a1 and a2",)
    assert said_beside_a_lag(seen("obstacle=glass"), waveform, faults, monkeypatch) is said


def said_beside_a_lag(
    one: Finding, waveform: bool, faults: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> bool:
    """Return whether something is left beside a named lag where one finding is."""
    explained = SimpleNamespace(removable=Estimate(0.0, -0.1, 0.1, "nats"), contenders=())
    located = Located((one,), 0.002, 9.0, 3.0, 1, {})
    rounds = (Round(located, explained, None),)  # type: ignore[arg-type]
    for name, value in (("_share", 1.0), ("_form_leaves", 0.01), ("_named", (LAG,))):
        monkeypatch.setattr(conclude, name, lambda *_, value=value: value)
    search = SimpleNamespace(fit=SimpleNamespace(waveform=waveform), choice=Choice(faults=faults))
    made = conclude.verdicts(search, rounds, (TimeLag(),))  # type: ignore[arg-type]
    assert isinstance(made[0], LeftOut)
    return [type(verdict) for verdict in made[1:]] == [Unknown]


@pytest.mark.parametrize(
    ("one", "counts"),
    [
        (seen("rx=a1"), True),
        (seen("tx=t1", value=-0.2), True),
        (seen("rx=a1", "spread"), True),
        (seen("rx=a1", "link", -0.2), False),  # simulated ranges scatter more there
        (seen("rx=a1", p=0.02), False),
        (seen("obstacle=glass"), False),
    ],
)
def test_only_what_is_beyond_doubt_at_one_device_counts(one: Finding, counts: bool) -> None:
    assert bool(left_at_device((one,))) is counts


def test_what_is_as_large_elsewhere_is_of_no_device() -> None:
    """A cause of another form leaves something everywhere."""
    assert not left_at_device((seen("rx=a1", value=0.2), seen("rx_z_m", value=0.15)))
    assert left_at_device((seen("rx=a1", value=0.4), seen("rx_z_m", value=0.15)))


def test_the_headline_says_at_which_device_something_without_a_name_shows() -> None:
    left = Unknown((seen("rx_z_m"), seen("rx=a2", value=0.5)), GAIN)
    line = headline((LAG, left), False, None)  # type: ignore[arg-type]
    assert "time-lag - and something without a name (error_m where rx=a2)." in line
    assert line.endswith("added to the simulator: held-out links fit no better with it.")


def test_one_weak_device_is_in_the_first_line() -> None:
    weak = (seen("tx=t3", value=-7.6), seen("tx=t3", value=-7.5), seen("tx=t3", value=7.4))
    assert all_at_device(weak) == weak
    said = headline((Unknown(weak, GAIN),), False, None)  # type: ignore[arg-type]
    assert said.startswith("Something is there, without a name (error_m -7.6 m [")
    assert said.endswith("where tx=t3). Nothing was added to the simulator.")


@pytest.mark.parametrize("other", [seen("tx=t4"), seen("rx_z_m"), seen("tx=t3", p=0.02)])
def test_what_shows_elsewhere_too_is_of_no_device(other: Finding) -> None:
    assert not all_at_device((seen("tx=t3"), other, seen("tx=t3")))
    assert not all_at_device((seen("tx=t3"), seen("tx=t3")))
