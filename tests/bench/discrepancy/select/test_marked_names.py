"""Names that bear their mark are kept where all names together remove too little."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.select.conclude import _marked
from bench.discrepancy.select.essentials import unused
from bench.discrepancy.select.verdict import Ambiguous, Control, LeftOut, Unknown
from bench.physics.effect import Effect
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.propagation.fading import SmallScaleFading
from bench.physics.effects.propagation.specular import SpecularReflections
from bench.physics.effects.receiver.noise_floor import NoiseFloor


def _named(effect: Effect) -> LeftOut:
    return LeftOut(effect, (), Estimate(1, 0, 2), 0.1, Control("", None))


def test_only_what_bears_its_mark_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    bears = classmethod(lambda _, frame: frame)
    monkeypatch.setattr(SpecularReflections, "by_mark", bears)
    seen, other = _named(SpecularReflections()), _named(NoiseFloor())
    both = Ambiguous((seen, other), "")
    said = (seen, other, both, Unknown((), Estimate(1, 0, 2)))
    for frame, kept in (((SpecularReflections(),), (seen, both)), ((), ())):
        search = SimpleNamespace(fit=SimpleNamespace(frame=frame), logged=())
        assert _marked(search, said) == kept  # type: ignore[arg-type]


def test_what_leaves_the_straight_path_as_it_is_blocks_and_fades_nothing() -> None:
    assert "detour_m" in unused(BlockedPath(share=0.6, detour_m=0.05))
    assert unused(BlockedPath(share=0.3, detour_m=0.6)) == ""
    assert "direct_m" in unused(SmallScaleFading(direct_m=1000, path_m=0.5))
    assert unused(SmallScaleFading(direct_m=1.2)) == ""
