"""A law in the place of what strikes links at random must say which links were struck."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.law import instead as module
from bench.discrepancy.select import link_mixture

STRUCK = SimpleNamespace(struck=np.array([1, 3, 5]))


@pytest.mark.parametrize(
    ("before", "after", "left", "calms"),
    [
        (STRUCK, None, 0.2, True),  # the law says which were struck
        (STRUCK, None, 0.6, False),  # it hits two of five, and others beside
        (STRUCK, STRUCK, 0.0, False),  # links are struck all the same
        (None, None, 1.0, True),  # none was
    ],
)
def test_a_law_that_hits_a_few_struck_links_alone_takes_no_name(
    monkeypatch: pytest.MonkeyPatch, before: object, after: object, left: float, calms: bool
) -> None:
    """What it leaves is such that nothing is made of it any more: that alone says nothing."""
    monkeypatch.setattr(module, "effect_of", lambda _: "law")
    monkeypatch.setattr(module, "strike", lambda *a: after if "law" in a[2] else before)
    monkeypatch.setattr(module, "left_far", lambda *_: left)
    search = SimpleNamespace(work=object(), comparison=None, kinds={})
    law = SimpleNamespace(best=SimpleNamespace(nats=40.0))
    assert module.calms(search, (), law) is calms  # type: ignore[arg-type]


def test_links_that_stay_where_they_were_are_left_far(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of three struck links one is brought near; a spared one that is moved does not count."""
    codes = np.arange(6)
    offset_m = {"": np.array([0, 2.0, 0, -3.0, 0, 1.0]), "law": np.array([2, 0.1, 0, -3.0, 0, 0.6])}
    monkeypatch.setattr(
        link_mixture,
        "offsets",
        lambda _c, _v, some, _k: SimpleNamespace(links=codes, offset_m=offset_m["".join(some)]),
    )
    left = link_mixture.left_far(None, None, (), ("law",), STRUCK.struck)  # type: ignore[arg-type]
    assert left == pytest.approx(2 / 3)
