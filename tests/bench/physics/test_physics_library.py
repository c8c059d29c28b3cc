"""What every effect of the library must keep to."""

from dataclasses import replace

import numpy as np
import pytest
from physics_scenes import room, seen

from bench.errors import BenchError
from bench.physics import Base, Effect
from bench.physics.effect import STAGES
from bench.plugins import plugins

OURS = {
    "antenna-delay": 1, "power-bias": 2, "clock-offset": 3, "temperature-drift": 4,
    "antenna-pattern": 5, "timestamp-jitter": 6, "material-delay": 7, "late-detection": 8,
    "blocked-path": 9, "diffraction": 10, "specular-reflections": 11, "ground-bounce": 12,
    "diffuse-tail": 13, "path-loss": 14, "small-scale-fading": 15, "pulse-ringing": 16,
    "noise-floor": 17, "level-control": 18, "narrowband-interference": 19, "quantisation": 20,
    "time-lag": 21, "exchange-motion": 21, "range-scale": 22, "range-rounding": 23,
}  # fmt: skip
LIBRARY = [plugin.load()() for plugin in plugins("effects") if plugin.name in OURS]
FRAME = room(128).assign(
    tx="a", rx="b", obstacles=[["wall"] if row % 2 else [] for row in range(len(room(128)))]
)


def test_all_are_registered_under_their_names() -> None:
    assert {effect.name: effect.number for effect in LIBRARY} == OURS


@pytest.mark.parametrize("effect", LIBRARY, ids=lambda effect: effect.name)
def test_says_what_it_is(effect: Effect) -> None:
    assert effect.stage in STAGES
    assert f".{effect.stage}." in type(effect).__module__
    assert len(effect.source) > 10
    assert len(effect.signature) > 10
    assert len((type(effect).__doc__ or "").split()) > 15
    for item in effect.parameters():
        assert item.low <= item.default <= item.high
        assert item.unit
        assert item.meaning
        assert item.null is None or item.low <= item.null <= item.high


@pytest.mark.parametrize("effect", LIBRARY, ids=lambda effect: effect.name)
def test_out_of_bounds_names_effect_parameter_and_bounds(effect: Effect) -> None:
    for item in effect.parameters():
        with pytest.raises(BenchError, match=f"{effect.name}.*{item.name}.*outside"):
            replace(effect, **{item.name: type(item.default)(item.high + 1)})


def null_values(effect: Effect) -> dict[str, float]:
    """Return the values at which an effect does nothing; none for those that just add paths."""
    return {item.name: item.null for item in effect.parameters() if item.null is not None}


@pytest.mark.parametrize(
    "effect", list(filter(null_values, LIBRARY)), ids=lambda effect: effect.name
)
def test_does_nothing_at_its_null_values(effect: Effect) -> None:
    null = null_values(effect)
    made, base = seen(FRAME, replace(effect, **null)), seen(FRAME)
    if effect.name == "material-delay":  # the first path's level still sees an unlisted wall's
        made = seen(FRAME, replace(effect, **null, unlisted_walls=0))
    np.testing.assert_allclose(made.range_m, base.range_m, atol=1e-9)
    np.testing.assert_allclose(made.cir, base.cir, rtol=1e-4, atol=1.0)
    np.testing.assert_allclose(made.preamble_count, base.preamble_count)


@pytest.mark.parametrize("effect", LIBRARY, ids=lambda effect: effect.name)
def test_is_finite_over_all_its_bounds_and_leaves_its_inputs_alone(effect: Effect) -> None:
    for item in effect.parameters():
        for value in (item.low, item.high):
            whole = int(value) if item.whole else value
            made = seen(FRAME, replace(effect, **{item.name: whole}))
            for name in ("range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std", "cir"):
                assert np.isfinite(getattr(made, name)).all(), (item.name, value, name)
            seen(FRAME, effect, cir=False)


def test_the_whole_library_at_once_is_finite() -> None:
    base = Base(cir_samples=64)
    made = seen(FRAME, *LIBRARY, base=base)
    assert made.cir.shape == (len(FRAME), 64)
    assert np.isfinite(made.cir).all()
    assert np.isfinite(seen(FRAME, *LIBRARY, cir=False).range_m).all()
