"""Of members of which none is needed beside the others, that goes which brings least."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from bench.discrepancy.joint.sets import Sets

BROUGHT = {"pulse-ringing": 72.4, "diffuse-tail": 39.7}


def fit_of(*names: str) -> Any:
    """Return a set with these names."""
    return SimpleNamespace(names=names, effects=names)


@pytest.mark.parametrize("names", [tuple(BROUGHT), tuple(reversed(BROUGHT))])
def test_of_two_that_are_both_refused_the_lesser_goes(names: tuple[str, ...]) -> None:
    sets: Any = Sets.__new__(Sets)
    sets.start, sets.none, sets.idle = fit_of(), fit_of(), set()
    sets.nested = SimpleNamespace(on=lambda rest, fit: fit)
    sets.weighing = SimpleNamespace(weigh_plain=lambda fits: None, worth=lambda fit: 1000.0)
    sets._refit = lambda fit, names: None
    sets._without = lambda fit, name: fit_of(*(one for one in fit.names if one != name))
    sets._brings = lambda fit, name: BROUGHT[name]
    sets._asked = lambda fit, name, whole: float("inf") if len(fit.names) > 1 else 8.0
    sets._by_chance = lambda fit, name: 0.0
    sets._own = lambda fit, rest: True
    assert Sets._needed(sets, fit_of(*names)).names == ("pulse-ringing",)
