"""Random numbers that are drawn again and again are drawn once.

A diagnosis simulates the same rows hundreds of times on the same random numbers. What a generator
gives depends on its state alone, so numbers are remembered by it, with the state they lead to:
they are those of `Draws` to the last bit, whatever was drawn before.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.physics.randomness import Draws
from bench.physics.units import Complexes


class DrawMemory:
    """The draws that were used last, at most `most`; threads may share it."""

    def __init__(self, most: int) -> None:
        self.most = most
        self._kept: OrderedDict[Hashable, Any] = OrderedDict()
        self._lock = Lock()

    def __getstate__(self) -> int:
        """Return what another process needs: it remembers nothing yet."""
        return self.most

    def __setstate__(self, most: int) -> None:
        self.__init__(most)  # type: ignore[misc]

    def get(self, key: Hashable, make: Callable[[], Any]) -> Any:
        """Return what is remembered, else what `make` gives, remembered from now on."""
        with self._lock:
            if key in self._kept:
                self._kept.move_to_end(key)
                return self._kept[key]
        made = make()
        with self._lock:
            self._kept[key] = made
            while len(self._kept) > self.most:
                self._kept.popitem(last=False)
        return made


@dataclass(frozen=True)
class RememberedDraws(Draws):
    """Draws whose large arrays come from a memory where they were drawn before."""

    memory: DrawMemory = field(default_factory=lambda: DrawMemory(0), compare=False)

    def complex_normal(self, *shape: int) -> Complexes:
        """Return what `Draws` returns, and leave the generator as it would."""
        bits = self.generator.bit_generator
        state: Any = bits.state
        key = (state["state"]["state"].tobytes(), state["has_uint32"], state["uinteger"], shape)

        def made() -> tuple[Complexes, Any]:
            drawn = Draws.complex_normal(self, *shape)
            return drawn, bits.state

        drawn, after = self.memory.get(key, made)
        bits.state = after
        return np.asarray(drawn.copy(), np.complex64)

    def group_complex(self, hashes: NDArray[np.uint64], columns: int) -> Complexes:
        """Return what `Draws` returns."""
        key = (self.seed, self.replicate, self.name, columns, hashes.tobytes())
        drawn = self.memory.get(key, lambda: Draws.group_complex(self, hashes, columns))
        return np.asarray(drawn.copy(), np.complex64)
