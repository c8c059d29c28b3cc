"""Noise beside a tone may be more tones: no library effect has several at once."""

from __future__ import annotations

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.joint.untried import with_tones
from bench.discrepancy.select.separate import one_of
from bench.discrepancy.select.verdict import Control, LeftOut
from bench.physics.effect import Effect
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.noise_floor import NoiseFloor

TONE, FLOOR = NarrowbandInterference(level_db=1.0), NoiseFloor(level_db=4.0)


def said(effect: Effect) -> LeftOut:
    return LeftOut(effect, (), Estimate(1, 0.5, 1.5, "nats"), 1.0, Control("", None))


def test_a_noise_floor_beside_a_tone_is_that_or_more_tones() -> None:
    found = with_tones(said(FLOOR), (TONE, FLOOR))
    assert found.names == ("noise-floor", "narrowband-interference")
    assert not found.options[1].tried
    assert "several tones at once" in found.options[1].note


def test_other_verdicts_stay() -> None:
    class_of_both = one_of((said(FLOOR), said(TONE)))
    for one, added in (
        (said(FLOOR), (FLOOR, PathLoss())),
        (said(TONE), (TONE, FLOOR)),
        (said(PathLoss()), (TONE, PathLoss())),
        (class_of_both, (TONE, FLOOR)),
    ):
        assert with_tones(one, added) == one
