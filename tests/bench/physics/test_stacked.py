"""Replicates simulated as one batch are, to the last bit, those simulated one by one."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
import pandas as pd
import pytest
from physics_scenes import room

from bench.physics import Base, Effect
from bench.physics.batch import Batch, altered
from bench.physics.effects.fitted.device_clock import DeviceClock
from bench.physics.effects.fitted.device_delay import DeviceDelay
from bench.physics.effects.fitted.ground_ray import GroundRay
from bench.physics.effects.fitted.noise_of_devices import NoiseOfDevices
from bench.physics.effects.fitted.pattern_curve import PatternCurve
from bench.physics.effects.fitted.pattern_gain import PatternGain
from bench.physics.effects.fitted.power_curve import PowerCurve
from bench.physics.effects.fitted.unnamed import Unnamed
from bench.physics.effects.fitted.wall_delay import WallDelay
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.fading import SmallScaleFading
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.propagation.specular import SpecularReflections
from bench.physics.effects.ranging.law import Law
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.effects.receiver.quantisation import Quantisation
from bench.physics.pipeline import EffectError, Pipeline
from bench.physics.randomness import Draws
from bench.physics.remembered import DrawMemory
from bench.physics.scene import Scene, scene
from bench.physics.stacked import StackedDraws, is_stackable, split
from bench.plugins import plugins

NUMBERS = (4, 5, 9)
CHAIN = (MaterialDelay(), SpecularReflections(), DiffuseTail(), NoiseFloor(), Quantisation())
GIVEN: dict[str, Effect] = {
    "device-clock": DeviceClock(
        devices=("a", "b"),
        offsets_ppm=(3.0, -2.0),
        drifts_ppm_per_hour=(0.1, 0.2),
        knots_s=((0.0, 30.0), (10.0,)),
        wander_ppm=((0.5, -0.5), (0.2,)),
        spread_ppm=0.1,
    ),
    "device-delay": DeviceDelay(("a", "b"), (0.4, -0.3)),
    "power-curve": PowerCurve((-90.0, -70.0), (0.1, -0.1)),
    "pattern-curve": PatternCurve((0.0, 120.0, 240.0), (0.1, 0.0, -0.1), (1.0, -1.0, 0.0)),
    "pattern-gain": PatternGain(1.0, -0.5, 0.3, 0.2, -0.4),
    "noise-of-devices": NoiseOfDevices(
        devices=("a", "t1"), louder_db=(6.0, 3.0), doubts_db=(0.1, 0.1)
    ),
    "ground-ray": GroundRay(size=0.4, level_size=0.3),
    "wall-delay": WallDelay(("brick",), (0.2,), (3.0,)),
    "unnamed": Unnamed("temperature_c", (10.0, 30.0), (0.1, -0.2), 0.05),
    "law": Law(
        "a * temperature_c + b * sin(time_s / tau)",
        ("a = 0.01 m / degC", "b = 0.02 m", "tau = 3 s"),
    ),
}


def _rows() -> Scene:
    """Return rows of several links, devices, walls and rooms, some of them in the open."""
    frame, rng = room(57), np.random.default_rng(1)
    rows = np.arange(len(frame))
    frame.loc[rows % 5 == 0, ["room_x_m", "room_y_m", "room_z_m"]] = np.nan
    kinds = [[], ["wall"], ["wall", "metal"], ["person"]]
    return scene(
        frame.assign(
            tx=np.array(["a", "b", "c"])[rows // 4 % 3],
            rx=np.array(["b", "c", "a"])[rows // 4 % 3],
            obstacles=[kinds[row % 4] for row in rows],
            los=pd.array(np.where(rows % 7 == 0, np.nan, rows % 4 == 0), "Float64"),
            time_s=rows * 1.7,
            temperature_c=20 + rng.normal(0, 3, len(rows)),
            reply_time_s=np.where(rows % 6 == 0, 0.0, 3e-4),
            radial_speed_m_per_s=rng.normal(0, 1, len(rows)),
            azimuth_deg=np.where(rows % 3 == 0, np.nan, rng.uniform(-180, 180, len(rows))),
            preamble_count=np.where(rows % 8 == 0, np.nan, 400.0),
        )
    )


ROWS = _rows()


def _forms() -> list[Effect]:
    """Return every effect of the library, as it is and with its parameters anywhere."""
    rng, made = np.random.default_rng(2), []
    for plugin in plugins("effects"):
        first = GIVEN.get(plugin.name) or plugin.load()()
        made.append(first)
        for _ in range(3):
            values = {p.name: rng.uniform(p.low, p.high) for p in first.parameters() if not p.whole}
            made.append(replace(first, **values))
    return made


FORMS = _forms()


def _simulated(effects: tuple[Effect, ...], rows: Scene, draws: Draws, cir: bool) -> Batch:
    base = Base(cir_samples=40)
    received = (lambda batch: base.received(batch, draws)) if cir else base.counted
    return Pipeline(effects, received, base.detected).simulated(lambda: base.paths(rows), draws)


def _alone(effects: tuple[Effect, ...], cir: bool) -> list[Batch]:
    return [_simulated(effects, ROWS, Draws(3, number, "base", 0), cir) for number in NUMBERS]


def _together(effects: tuple[Effect, ...], cir: bool) -> list[Batch]:
    draws = StackedDraws(3, NUMBERS[0], "base", 0, NUMBERS, (ROWS,) * 3, DrawMemory(4))
    whole = _simulated(effects, ROWS.repeated(len(NUMBERS)), draws, cir)
    return split(whole, draws.scenes)


def _assert_same(effects: tuple[Effect, ...], cir: bool) -> None:
    for ours, theirs in zip(_together(effects, cir), _alone(effects, cir), strict=True):
        for item in fields(Batch):
            one, other = getattr(ours, item.name), getattr(theirs, item.name)
            if isinstance(other, np.ndarray):
                assert one.dtype == other.dtype, item.name
                np.testing.assert_array_equal(one, other, err_msg=item.name)
            else:
                assert one == other or one is other, item.name


@pytest.mark.parametrize("effect", FORMS, ids=lambda effect: effect.name)
@pytest.mark.parametrize("cir", [True, False], ids=["cir", "paths"])
def test_an_effect_on_stacked_replicates_is_that_on_each(effect: Effect, cir: bool) -> None:
    assert is_stackable(effect)
    _assert_same((effect,), cir)
    _assert_same((*(e for e in CHAIN if e.name != effect.name), effect), cir)


@dataclass(frozen=True)
class Centred(Effect):
    """Takes the mean of all rows off their ranges: no row stands for itself."""

    name = "centred"
    stage = "ranging"
    source = "a test"

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        own = draws.generator.normal(size=len(batch))  # an effect may draw as it likes
        return batch.longer(own - np.mean(batch.range_m))


@dataclass(frozen=True)
class Windy(SmallScaleFading):
    """Derived from what may be stacked, and cannot be stacked."""

    name = "windy"

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        return super().apply(batch.louder(np.cumsum(np.ones(len(batch)))), draws)


@dataclass(frozen=True)
class Uneven(Effect):
    """Gives every replicate paths in a number of its own."""

    name = "uneven"
    stage = "propagation"
    source = "a test"

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        more = np.zeros((len(batch), draws.replicate))
        return batch.with_paths(more, more.astype(np.complex64), 2)


@pytest.mark.parametrize("cir", [True, False], ids=["cir", "paths"])
@pytest.mark.parametrize("effect", [Centred(), Windy()], ids=lambda effect: effect.name)
def test_what_does_not_say_so_gets_one_replicate_at_a_time(effect: Effect, cir: bool) -> None:
    assert not is_stackable(effect)
    _assert_same((*CHAIN, effect), cir)


def test_replicates_of_other_shapes_cannot_be_stacked() -> None:
    with pytest.raises(EffectError, match="uneven"):
        _together((Uneven(),), False)


def test_stacked_replicates_have_no_generator_in_common() -> None:
    draws = StackedDraws(3, 4, "base", 0, NUMBERS, (ROWS,) * 3, DrawMemory(4))
    with pytest.raises(AttributeError, match="generator each"):
        _ = draws.generator


def test_a_batch_has_no_fields_but_its_own() -> None:
    batch = Base().paths(ROWS)
    assert altered(batch, tail_fwhm=2.0).tail_fwhm == 2.0
    assert batch.tail_fwhm == 0.0
    with pytest.raises(TypeError, match="a batch has no colour"):
        altered(batch, colour=1)
