"""The checks that plug-ins are held to: ours pass them, and each check can fail."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from backends.base import Artifact
from backends.fp32 import Fp32Backend
from bench import checks
from bench.checks.backends import sample_models
from bench.checks.effects import sample_rows
from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.effects.ranging.temperature import TemperatureDrift
from bench.physics.randomness import Draws
from bench.physics.simulator import Simulator
from bench.physics.simulators import SimulatorPlugin, open_simulator
from bench.plugins import Plugin, plugins
from zoo.mlp import FeatureMLP
from zoo.none import NoMitigation

EFFECTS = plugins("effects")


def ours(group: Any) -> list[Plugin]:
    return [plugin for plugin in plugins(group) if plugin.built_in]


@pytest.mark.parametrize("plugin", ours("effects"), ids=lambda plugin: plugin.name)
def test_our_effects_pass(plugin: Plugin) -> None:
    effect = plugin.load()()
    if plugin.name == "material-delay":  # its null is that of listed walls
        effect = replace(effect, unlisted_walls=0)
    checks.check_effect(effect, sample_rows(48))


@pytest.mark.parametrize("plugin", ours("devices"), ids=lambda plugin: plugin.name)
def test_our_devices_pass(plugin: Plugin) -> None:
    checks.check_device(plugin.load())


@pytest.mark.parametrize("name", ["fp32", "graph"])
def test_our_backends_pass(name: str) -> None:
    (plugin,) = [one for one in plugins("backends") if one.name == name]
    checks.check_backend(plugin.make(), sample_models()[:2])


@pytest.mark.parametrize("model", [NoMitigation(), FeatureMLP(epochs=1, random_state=0)])
def test_our_models_pass(model) -> None:
    checks.check_model(model)


def test_our_simulator_passes() -> None:
    checks.check_simulator(open_simulator("rooms"))


def test_data_sets_that_are_not_here_say_so(monkeypatch, tmp_path) -> None:
    monkeypatch.delenv("BENCH_DATA", raising=False)
    monkeypatch.setenv("BENCH_CACHE", str(tmp_path))
    for plugin in ours("datasets"):
        if plugin.name != "rooms":
            checks.check_dataset(plugin.make())


@dataclass(frozen=True)
class Warm(TemperatureDrift):
    """An effect to be spoilt."""

    name = "warm"


@dataclass(frozen=True)
class NullActs(Warm):
    """Moves the range at zero strength."""

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        return batch.longer(0.01)


@dataclass(frozen=True)
class ControlMoves(Warm):
    """Calls every row inert."""

    def inert(self, batch: Batch) -> Any:
        return np.ones(len(batch), bool)


@dataclass(frozen=True)
class NoUnit(Warm):
    """Has a parameter without a unit."""

    extra: float = parameter(0, "", -1, 1, "no unit")


@dataclass(frozen=True)
class NoNumber(Warm):
    """Gives no number at a bound."""

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        level = np.nan if self.slope_mm_per_c == 20 else 0.0
        return replace(batch, rx_power_dbm=batch.rx_power_dbm + level)


@pytest.mark.parametrize(
    ("effect", "words"),
    [
        (NullActs(), "changes range_m with"),
        (ControlMoves(), "moves rows it calls inert"),
        (NoUnit(), "extra has no unit"),
        (NoNumber(), "rx_power_dbm is no number"),
    ],
)
def test_a_wrong_effect_fails(effect: Effect, words: str) -> None:
    with pytest.raises(AssertionError, match=words):
        checks.check_effect(effect, sample_rows(24))


class Shifted(Fp32Backend):
    """Says a reason for nothing; answers a decimetre off."""

    def build(self, model, data, path, progress=None) -> Artifact:
        return Off(**vars(super().build(model, data, path)))


class Off(Artifact):
    """Answers a decimetre off."""

    def predict(self, cirs, batch_rows: int = 4096):
        return super().predict(cirs) + np.float32(0.1)


class Silent(Fp32Backend):
    """Skips everything and says nothing."""

    def supports(self, model):
        return ""


@pytest.mark.parametrize(
    ("backend", "words"), [(Shifted(), "0.1 m off"), (Silent(), "expected None or a reason")]
)
def test_a_wrong_backend_fails(backend, words: str) -> None:
    with pytest.raises(AssertionError, match=words):
        checks.check_backend(backend, [NoMitigation().fit(np.zeros((4, 157)), np.zeros(4))])


class OtherModule(NoMitigation):
    """Its module says something else."""

    def predict(self, X):
        return super().predict(X) + np.float32(0.01)


def test_a_wrong_model_fails() -> None:
    with pytest.raises(AssertionError, match="to_module and predict differ by"):
        checks.check_model(OtherModule())


def test_a_wrong_device_fails() -> None:
    (plugin,) = [one for one in plugins("devices") if one.name == "stm32h7"]
    profile = plugin.load()
    clock = replace(profile.coefficients["frequency_mhz"], low=1e6)
    spoilt = replace(profile, coefficients={**profile.coefficients, "frequency_mhz": clock})
    with pytest.raises(AssertionError, match="expected 0 <= low <= value <= high"):
        checks.check_device(spoilt)


class Unsteady(SimulatorPlugin):
    """Its rows differ from call to call."""

    simulator = Simulator()
    rows = 64
    calls = 0

    def geometry(self, rows: int, seed: int):
        self.calls += 1
        yield sample_rows(rows).assign(true_range_m=1.0 + self.calls)


def test_a_wrong_simulator_fails() -> None:
    with pytest.raises(AssertionError, match="true_range_m"):
        checks.check_simulator(Unsteady())
    check: Callable[..., None] = checks.check_simulator
    with pytest.raises(AssertionError, match="no Simulator"):
        check(type("Seven", (SimulatorPlugin,), {"simulator": 7})())
