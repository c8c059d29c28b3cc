"""A search that is back where it was, with others between, ends; one that stays may draw anew."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from bench.discrepancy.select.circle import Circle
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter

ONE, TWO = (RangeScale(),), (TimestampJitter(),)


def at(added: tuple[Any, ...], kinds: str = "ab", links: int = 9) -> Any:
    """Return a state of a search with some effects in place."""
    choice = SimpleNamespace(names=())
    searched = SimpleNamespace(links=np.arange(links))
    search = SimpleNamespace(searched=searched, kinds=dict.fromkeys(kinds), choice=choice)
    return SimpleNamespace(search=search, added=added)


def closes(*states: Any) -> list[bool]:
    circle = Circle()
    return [circle.closed_by(state) for state in states]


def test_it_ends_where_the_same_effects_are_back() -> None:
    assert closes(at(ONE), at(TWO), at(ONE)) == [False, False, True]
    assert closes(at(ONE), at((*ONE, *TWO)), at(TWO)) == [False] * 3


def test_it_goes_on_where_nothing_changed_or_the_choice_is_another() -> None:
    assert closes(at(ONE), at(ONE), at(ONE)) == [False] * 3
    assert closes(at(ONE), at(TWO), at(ONE, kinds="a")) == [False] * 3
    assert closes(at(ONE), at(TWO), at(ONE, links=5)) == [False] * 3
