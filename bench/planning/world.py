"""What is simulated for a plan: rows with some effects added to what was diagnosed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.errors import BenchError
from bench.physics.effect import Effect
from bench.physics.scene import Scene
from bench.physics.simulator import Simulator
from bench.planning.scatter import Floats
from bench.planning.settings import SEED_FIRST

Added = tuple[Effect, ...]


@dataclass(frozen=True)
class World:
    """The simulator that was diagnosed (the bare base for a table), and what is read off it.

    `names` are observables; without `waveform` they come from paths alone.
    """

    simulator: Simulator
    names: tuple[str, ...]
    waveform: bool

    def values(self, rows: Scene, added: Added, members: int) -> Floats:
        """Return simulated observables [members, n, p] of rows with effects added.

        The same rows and members have the same random numbers, whatever is added. Raises
        BenchError where an effect leaves a value unknown.
        """
        simulator = self.simulator
        for effect in added:
            simulator = simulator.with_effect(effect)
        return np.stack([self._one(simulator, rows, number) for number in range(members)])

    def _one(self, simulator: Simulator, rows: Scene, number: int) -> Floats:
        made = simulator.observe(rows, replicate=SEED_FIRST + number, cir=self.waveform)
        values = np.stack([getattr(made, name) for name in self.names], axis=1)
        if not np.isfinite(values).all():
            raise BenchError("an explanation leaves simulated values unknown")
        return values
