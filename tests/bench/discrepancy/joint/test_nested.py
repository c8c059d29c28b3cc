"""A set that fits worse than a part of it is fitted on from that part, once."""

from __future__ import annotations

from types import SimpleNamespace

from bench.discrepancy.compare.view import Added
from bench.discrepancy.joint.nested import Nested
from bench.discrepancy.joint.polish import key_of
from bench.discrepancy.joint.settings import NAME_NATS
from tests.bench.discrepancy.joint.test_growth import LOSS, NOISE, _fit, _known


def test_what_fits_worse_than_a_part_of_it_is_fitted_on_from_that() -> None:
    alone, both = _fit(100.0, NOISE), _fit(100.0 - 2 * NAME_NATS, NOISE, LOSS)
    fits, asked = _known(alone, both), []

    def fit(sets: list[Added]) -> None:
        asked.extend(sets)
        fits[key_of(sets[0])] = _fit(130.0, *sets[0])

    nested = Nested(SimpleNamespace(links=1), fits, fit)  # type: ignore[arg-type]
    found = nested.likeliest(lambda some: max(some, key=lambda one: one.nats))
    assert (found.nats, asked) == (130.0, [(NOISE, LOSS)])
    nested.on(alone, both)
    assert len(asked) == 1


def test_a_set_that_fits_better_or_has_no_part_stays() -> None:
    alone, both = _fit(100.0, NOISE), _fit(100.0 - NAME_NATS / 2, NOISE, LOSS)
    nested = Nested(SimpleNamespace(links=1), _known(alone, both), None)  # type: ignore[arg-type]
    assert nested.wider(alone) == []
    assert nested.on(_fit(200.0), both) is both
