"""A chain of steps whose beginning is often the same: what comes out of it is remembered.

Fitting one effect changes one step; everything before it gives what it gave. Steps must not write
into what they are given, which effects promise.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence

from bench.physics.batch import Batch
from bench.physics.memory import Memory
from bench.physics.pipeline import Step


class Beginning:
    """A chain so far: the beginning before its last step, and that step.

    Hashed once: effects have many parameters, and a chain is asked for at every step of it.
    """

    __slots__ = ("_hash", "before", "step")

    def __init__(self, before: Hashable, step: Hashable) -> None:
        self.before, self.step = before, step
        self._hash = hash((before, step))

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Beginning)
            and self._hash == other._hash
            and self.step == other.step
            and self.before == other.before
        )


class Prefixes:
    """Remembers the batches after every step, the latest `most` of them."""

    def __init__(self, most: int) -> None:
        self._kept: Memory[Batch] = Memory(most)

    def run(
        self, key: Hashable, start: Callable[[], Batch], steps: Sequence[Step], many: int = 1
    ) -> Batch:
        """Return the batch after all steps; `key` says what `start` gives, as a step's key does.

        The batch is of `many` replicates, which counts.
        """
        keys = [Beginning(None, key)]
        for name, _ in steps:
            keys.append(Beginning(keys[-1], name))
        done, batch = self._latest(keys)
        if batch is None:
            batch = self._kept.keep(keys[0], start(), many)
        for number in range(done, len(steps)):
            batch = self._kept.keep(keys[number + 1], steps[number][1](batch), many)
        return batch

    def _latest(self, keys: Sequence[Beginning]) -> tuple[int, Batch | None]:
        """Return how many steps are done already, and their batch."""
        for number in range(len(keys) - 1, -1, -1):
            found = self._kept.find(keys[number])
            if found is not None:
                return number, found
        return 0, None
