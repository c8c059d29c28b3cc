"""What did as well as a name that is refused is one only where it gains by itself."""

from __future__ import annotations

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.select.conclude import gaining
from bench.discrepancy.select.verdict import Control, LeftOut
from bench.physics.effect import Effect
from bench.physics.effects.ranging.power_bias import PowerBias
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.temperature import TemperatureDrift


def _option(effect: Effect, least_nats: float) -> LeftOut:
    gain = Estimate(0.03, least_nats, 0.06)
    return LeftOut(effect, (), gain, 1.0, Control("", None))


def test_rivals_of_a_refused_name_gain_by_themselves_or_are_none() -> None:
    first = _option(TemperatureDrift(), -0.02)
    unsure, sure = _option(PowerBias(), -0.02), _option(RangeScale(), 0.01)
    assert gaining((unsure, sure), first) == (sure,)
    assert gaining((unsure,), first) == ()
    assert gaining((first, unsure), first) == (first, unsure)
