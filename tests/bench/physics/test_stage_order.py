"""The order of the stages and its checks are the same wherever rows are simulated."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from physics_scenes import line

from bench.discrepancy.compare.staged_simulation import Stages
from bench.discrepancy.data.observables import Window
from bench.errors import BenchError
from bench.physics import Batch, Draws, Effect, ForeignTable, Simulator
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.scene import scene

FRAME = line(64, range_m=5.0)


@dataclass(frozen=True)
class Nothing(Effect):
    """Gives no batch."""

    name, stage, source = "nothing", "ranging", "a test"

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        return None  # type: ignore[return-value]


@dataclass(frozen=True)
class NoNumber(Effect):
    """Gives a range that is no number."""

    name, stage, source = "no-number", "ranging", "a test"

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        return batch.longer(np.full(len(batch), np.nan))


HEARD: list[str] = []


@dataclass(frozen=True)
class Early(Effect):
    """Says that it was here."""

    name, stage, source = "early", "propagation", "a test"

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        HEARD.append(self.name)
        return replace(batch)


@dataclass(frozen=True)
class Late(Early):
    """Acts on what the others made."""

    name, last = "late", True


def _simulated(*effects: Effect) -> None:
    Simulator(effects=effects).observe(scene(FRAME), cir=False)


def _staged(*effects: Effect) -> None:
    Stages(Window(8, 60)).observables(Simulator(effects=effects), scene(FRAME), 0, False)


def _on_a_table(*effects: Effect) -> None:
    ForeignTable(FRAME).observe(effects)


WAYS = pytest.mark.parametrize("way", [_simulated, _staged, _on_a_table])


@WAYS
@pytest.mark.parametrize(
    ("effect", "words"),
    [(Nothing(), "'nothing' gave NoneType"), (NoNumber(), "'no-number' gave a range that is no")],
)
def test_what_an_effect_gives_is_checked(way: Callable[..., None], effect, words) -> None:
    with pytest.raises(BenchError, match=words):
        way(effect)


@WAYS
def test_effects_marked_last_come_behind_the_others(way: Callable[..., None]) -> None:
    HEARD.clear()
    way(Late(), Early())
    assert HEARD[-2:] == ["early", "late"]


@WAYS
def test_no_effect_is_taken_twice(way: Callable[..., None]) -> None:
    with pytest.raises(BenchError, match="'antenna-delay' is listed twice"):
        way(AntennaDelay(), AntennaDelay(delay_ns=1.0))
