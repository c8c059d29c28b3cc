"""Random numbers that are drawn again and again are drawn once.

A diagnosis simulates the same rows hundreds of times on the same random numbers. What a generator
gives depends on its state alone, so numbers are remembered by it, with the state they lead to:
they are those of `Draws` to the last bit, whatever was drawn before.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.physics.memory import Memory
from bench.physics.randomness import Draws
from bench.physics.units import Complexes

DrawMemory = Memory[Any]  # arrays, and for a stream the state that they lead to


@dataclass(frozen=True)
class RememberedDraws(Draws):
    """Draws whose large arrays come from a memory where they were drawn before."""

    memory: DrawMemory = field(default_factory=lambda: DrawMemory(0), compare=False)

    def complex_normal(self, *shape: int) -> Complexes:
        """Return what `Draws` returns, and leave the generator as it would."""
        return self.kept_complex_normal(*shape).copy()

    def group_complex(self, hashes: NDArray[np.uint64], columns: int) -> Complexes:
        """Return what `Draws` returns."""
        return self.kept_group_complex(hashes, columns).copy()

    def kept_complex_normal(self, *shape: int) -> Complexes:
        """Return `complex_normal`, not to be written into."""
        bits = self.generator.bit_generator
        state: Any = bits.state
        key = (state["state"]["state"].tobytes(), state["has_uint32"], state["uinteger"], shape)

        def made() -> tuple[Complexes, Any]:
            drawn = Draws.complex_normal(self, *shape)
            return drawn, bits.state

        drawn, after = self.memory.get(key, made)
        bits.state = after
        return np.asarray(drawn, np.complex64)

    def kept_group_complex(self, hashes: NDArray[np.uint64], columns: int) -> Complexes:
        """Return `group_complex`, not to be written into."""
        key = (self.seed, self.replicate, self.name, columns, hashes.tobytes())
        drawn = self.memory.get(key, lambda: Draws.group_complex(self, hashes, columns))
        return np.asarray(drawn, np.complex64)
