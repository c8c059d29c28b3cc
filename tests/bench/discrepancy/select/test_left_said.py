"""What is left without a name is what differs beside the names that stand."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from bench.discrepancy.select import left_said
from bench.discrepancy.select.left_said import as_it_stands
from bench.discrepancy.select.verdict import Unknown
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from tests.bench.discrepancy.select.test_sealed import LAG, named, selection

FIRST, LEFT, WAS, CALM = (
    SimpleNamespace(told=told) for told in ("first", "left", "was", "on the others")
)
SEARCH: Any = SimpleNamespace(spared=lambda _: "calm")


def found_with(*verdicts: Any, added: tuple[Any, ...] = ()) -> Any:
    """Return a selection whose first round located FIRST."""
    found = selection()
    turn = replace(found.rounds[0], located=SimpleNamespace(findings=(FIRST,)))
    return replace(found, rounds=(turn,), verdicts=verdicts, added=added)


def left_beside(search: Any, held: tuple[Any, ...], __: int) -> Any:
    """Return what a search finds beside some effects, or on links that were spared."""
    if search == "calm":
        return SimpleNamespace(findings=(CALM,))
    return SimpleNamespace(findings=(LEFT,) if held == (LAG,) else ())


class Striking(AntennaDelay):
    """An effect that strikes links."""

    explains = "obstructed-path"


def struck(found: Any) -> Any:
    """Return a selection whose first round found links that are struck."""
    strike = SimpleNamespace(effect=Striking())
    return replace(found, rounds=(replace(found.rounds[0], strike=strike),))


@pytest.fixture(autouse=True)
def _beside(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(left_said, "with_struck_in_sight", lambda _, found: found)
    monkeypatch.setattr(left_said, "locate_left", left_beside)


def test_beside_a_name_that_stands_what_it_leaves_is_said() -> None:
    """Not what was there before it was added."""
    unknown = Unknown((WAS,), None)  # type: ignore[arg-type]
    made: Any = as_it_stands(None, found_with(named(LAG), unknown, added=(LAG,)))  # type: ignore[arg-type]
    assert made.verdicts[0] == named(LAG)
    assert made.verdicts[1].findings == (LEFT,)
    assert made.verdicts[1].told.endswith("left with time-lag in the simulator")


def test_without_a_name_what_was_there_at_first_is_said() -> None:
    """Not what was left beside something that was taken back."""
    unknown = Unknown((WAS,), None)  # type: ignore[arg-type]
    made: Any = as_it_stands(None, found_with(unknown, added=(LAG,)))  # type: ignore[arg-type]
    assert made.verdicts[0].findings == (FIRST,)
    assert "in the simulator" not in made.verdicts[0].told


def test_what_a_mark_says_stays() -> None:
    unknown = Unknown((WAS,), None, cause="samples are clipped")  # type: ignore[arg-type]
    made: Any = as_it_stands(None, found_with(unknown))  # type: ignore[arg-type]
    assert made.verdicts == (unknown,)


def test_beside_struck_links_that_have_a_name_the_others_are_said() -> None:
    unknown = Unknown((WAS,), None)  # type: ignore[arg-type]
    name = replace(named(LAG), effect=Striking())
    made: Any = as_it_stands(SEARCH, struck(found_with(name, unknown)))
    assert made.verdicts[1].findings == (CALM,)


def test_strikes_without_a_name_leave_all_links_to_be_said() -> None:
    """What was there at first is not left beside the names that stand (a tone, of one table)."""
    unknown = Unknown((WAS,), None)  # type: ignore[arg-type]
    found = found_with(named(LAG), unknown, added=(LAG,))
    made: Any = as_it_stands(SEARCH, struck(found))
    assert made.verdicts[1].findings == (LEFT,)
