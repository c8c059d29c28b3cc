"""A cause that is known by what it does to ranges is tried with all else switched off."""

from __future__ import annotations

from collections.abc import Iterable
from types import SimpleNamespace
from typing import Any, cast

from bench.discrepancy.fit.search import Objective, screen
from bench.physics.effect import Effect
from bench.physics.effects.propagation.material_delay import MaterialDelay


class Watched:
    """Stands for an objective with waveforms: keeps what was tried, likes walls without loss."""

    kind = MaterialDelay
    view = SimpleNamespace(waveform=True, recorded=SimpleNamespace(names=("error_m", "energy_db")))

    def __init__(self) -> None:
        self.best: tuple[float, Effect] | None = None
        self.evaluations = 0

    def __call__(self, values: dict[str, float]) -> float:
        self.evaluations += 1
        effect = MaterialDelay(**values)
        gain = 1.0 - effect.loss_scale - abs(effect.thickness_scale - 0.5)
        if self.best is None or gain > self.best[0]:
            self.best = gain, effect
        return gain

    def each(self, several: Iterable[dict[str, float]]) -> None:
        for values in several:
            self(values)


def test_a_wall_that_only_delays_is_where_the_search_begins():
    def found(on_ranges: bool) -> Any:
        return screen(cast("Objective", Watched()), on_ranges).effect

    assert found(on_ranges=True).loss_scale == 0
    assert found(on_ranges=False).loss_scale > 0


def test_a_range_part_asks_for_it(monkeypatch: Any):
    from bench.discrepancy.sets import install
    from bench.discrepancy.sets.choice import Choice

    asked: list[bool] = []
    monkeypatch.setattr(install, "screen", lambda _, on_ranges=False: asked.append(on_ranges))
    monkeypatch.setattr(install, "Objective", lambda *_: None)
    monkeypatch.setattr(
        install, "refine", lambda *_: SimpleNamespace(effect=MaterialDelay(), gain=0.0)
    )
    monkeypatch.setattr(install, "plainer", lambda _, found, __: found)
    monkeypatch.setattr(install, "named_kinds", lambda *_: {"material-delay": MaterialDelay})
    search = cast(
        "Any",
        SimpleNamespace(
            kinds={},
            sharpest=SimpleNamespace(rows=[0], waveform=False),
            comparison=None,
            choice=Choice(),
        ),
    )
    install._of_library(search, (), "material-delay", cast("Any", None))
    assert asked == [True]
