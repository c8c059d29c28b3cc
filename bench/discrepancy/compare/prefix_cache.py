"""A chain of steps whose beginning is often the same: what comes out of it is remembered.

Fitting one effect changes one step; everything before it gives what it gave. Steps must not write
into what they are given, which effects promise.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Sequence
from threading import Lock
from typing import Generic, TypeVar

from bench.physics.batch import Batch
from bench.physics.pipeline import Step

T = TypeVar("T")


class Memory(Generic[T]):
    """Values by key, the `most` lately used of them; threads may share it."""

    def __init__(self, most: int) -> None:
        self.most = most
        self._kept: OrderedDict[Hashable, T] = OrderedDict()
        self._lock = Lock()

    def __getstate__(self) -> int:
        """Return what another process needs: it remembers nothing yet."""
        return self.most

    def __setstate__(self, most: int) -> None:
        self.__init__(most)  # type: ignore[misc]

    def find(self, key: Hashable) -> T | None:
        """Return what is remembered, None where nothing is."""
        with self._lock:
            found = self._kept.get(key)
            if found is not None:
                self._kept.move_to_end(key)
            return found

    def keep(self, key: Hashable, value: T) -> T:
        """Remember a value and return it."""
        with self._lock:
            self._kept[key] = value
            while len(self._kept) > self.most:
                self._kept.popitem(last=False)
        return value

    def get(self, key: Hashable, make: Callable[[], T]) -> T:
        """Return what is remembered, else what `make` gives, remembered from now on."""
        found = self.find(key)
        return self.keep(key, make()) if found is None else found


class Prefixes:
    """Remembers the batches after every step, the latest `most` of them."""

    def __init__(self, most: int) -> None:
        self._kept: Memory[Batch] = Memory(most)

    def run(self, key: Hashable, start: Callable[[], Batch], steps: Sequence[Step]) -> Batch:
        """Return the batch after all steps; `key` says what `start` gives, as a step's key does."""
        keys: list[Hashable] = [key]
        for name, _ in steps:
            keys.append((keys[-1], name))
        done, batch = self._latest(keys)
        if batch is None:
            batch = self._kept.keep(key, start())
        for number in range(done, len(steps)):
            batch = self._kept.keep(keys[number + 1], steps[number][1](batch))
        return batch

    def _latest(self, keys: list[Hashable]) -> tuple[int, Batch | None]:
        """Return how many steps are done already, and their batch."""
        for number in range(len(keys) - 1, -1, -1):
            found = self._kept.find(keys[number])
            if found is not None:
                return number, found
        return 0, None
