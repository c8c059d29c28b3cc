"""A plan that would settle nothing is not recommended."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from bench.cli import plan


@pytest.mark.parametrize(("probability", "record"), [(0.96, True), (0.4, True), (0.0, False)])
def test_what_settles_nothing_is_not_to_be_recorded(
    capsys: pytest.CaptureFixture[str], probability: float, record: bool
) -> None:
    answer: Any = SimpleNamespace(
        note="", question="a or b", worth=[], links=[80], rows=4, nats={"a | b": 0.1},
        planned=list, sure=probability > 0.95, probability=probability,
    )  # fmt: skip
    plan._print(cast("Any", answer))
    out = capsys.readouterr().out
    assert ("Record these" in out) == record
    assert ("Not worth recording" in out) != record
