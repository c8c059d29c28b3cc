"""The simulator: a base channel plus an ordered list of effects, each with units and a source."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.lazy import lazily

if TYPE_CHECKING:
    from bench.physics.base import Base as Base
    from bench.physics.batch import Batch as Batch
    from bench.physics.effect import Effect as Effect
    from bench.physics.effect import Parameter as Parameter
    from bench.physics.effect import parameter as parameter
    from bench.physics.foreign import ForeignTable as ForeignTable
    from bench.physics.outcome import Outcome as Outcome
    from bench.physics.randomness import Draws as Draws
    from bench.physics.scene import Scene as Scene
    from bench.physics.simulator import Simulator as Simulator
    from bench.physics.simulators import SimulatorPlugin as SimulatorPlugin
    from bench.physics.toml_file import from_toml as from_toml
    from bench.physics.toml_file import read_toml as read_toml
    from bench.physics.toml_file import to_toml as to_toml

_HOMES = {
    "Base": "bench.physics.base",
    "Batch": "bench.physics.batch",
    "Draws": "bench.physics.randomness",
    "Effect": "bench.physics.effect",
    "ForeignTable": "bench.physics.foreign",
    "Outcome": "bench.physics.outcome",
    "Parameter": "bench.physics.effect",
    "Scene": "bench.physics.scene",
    "Simulator": "bench.physics.simulator",
    "SimulatorPlugin": "bench.physics.simulators",
    "from_toml": "bench.physics.toml_file",
    "parameter": "bench.physics.effect",
    "read_toml": "bench.physics.toml_file",
    "to_toml": "bench.physics.toml_file",
}
__all__ = list(_HOMES)
__getattr__ = lazily(__name__, _HOMES)
