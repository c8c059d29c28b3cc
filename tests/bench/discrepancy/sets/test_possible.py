"""A name that does too much beside others may be there, and what it stood beside may not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

from bench.discrepancy.sets import possible
from bench.discrepancy.sets.possible import best_possible

WORTH = {("bias", "scale"): 50.0, ("bias", "walls"): 30.0, ("walls",): 20.0, ("scale",): 10.0}


class _Contest:
    """Sets of known worth; a bias does too much beside a scale, and `always` anywhere."""

    kinds: Mapping[str, object] = {"bias": 0, "walls": 0, "scale": 0}

    def __init__(self, always: bool) -> None:
        self.always = always

    def worth(self, causes: tuple[str, ...]) -> float:
        return WORTH.get(causes, 0.0)

    def best(self, able: tuple[str, ...]) -> tuple[str, ...]:
        return max((one for one in [*WORTH, ()] if set(one) <= set(able)), key=self.worth)

    def possible(self, causes: tuple[str, ...], name: str) -> bool:
        return name != "bias" or not (self.always or "scale" in causes)


@pytest.mark.parametrize(("always", "best"), [(False, ("bias", "walls")), (True, ("walls",))])
def test_what_stood_beside_a_name_may_be_what_is_not_there(
    monkeypatch: pytest.MonkeyPatch, always: bool, best: tuple[str, ...]
) -> None:
    monkeypatch.setattr(possible, "without_constants", lambda *_: {})
    contest: Any = _Contest(always)
    assert best_possible(contest, ("bias", "scale", "walls")) == best
