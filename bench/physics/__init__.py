"""The simulator: a base channel plus an ordered list of effects, each with units and a source."""

from bench.physics.base import Base
from bench.physics.batch import Batch
from bench.physics.effect import Effect, Parameter, parameter
from bench.physics.foreign import ForeignTable
from bench.physics.outcome import Outcome
from bench.physics.randomness import Draws
from bench.physics.scene import Scene, scene
from bench.physics.simulator import Simulator
from bench.physics.toml_file import from_toml, read_toml, to_toml

__all__ = [
    "Base",
    "Batch",
    "Draws",
    "Effect",
    "ForeignTable",
    "Outcome",
    "Parameter",
    "Scene",
    "Simulator",
    "from_toml",
    "parameter",
    "read_toml",
    "scene",
    "to_toml",
]
