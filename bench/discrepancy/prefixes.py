"""A chain of steps whose beginning is often the same: what comes out of it is remembered.

Fitting one effect changes one step; everything before it gives what it gave. Steps must not write
into what they are given, which effects promise.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Sequence
from threading import Lock

from bench.physics.batch import Batch

Step = tuple[Hashable, Callable[[Batch], Batch]]


class Prefixes:
    """Remembers the batches after every step, the latest `most` of them."""

    def __init__(self, most: int) -> None:
        self.most = most
        self._kept: OrderedDict[Hashable, Batch] = OrderedDict()
        self._lock = Lock()

    def run(self, key: Hashable, start: Callable[[], Batch], steps: Sequence[Step]) -> Batch:
        """Return the batch after all steps; `key` says what `start` gives, as a step's key does."""
        keys: list[Hashable] = [key]
        for name, _ in steps:
            keys.append((keys[-1], name))
        done, batch = self._latest(keys)
        if batch is None:
            batch = self._keep(key, start())
        for number in range(done, len(steps)):
            batch = self._keep(keys[number + 1], steps[number][1](batch))
        return batch

    def _latest(self, keys: list[Hashable]) -> tuple[int, Batch | None]:
        """Return how many steps are done already, and their batch."""
        with self._lock:
            for number in range(len(keys) - 1, -1, -1):
                found = self._kept.get(keys[number])
                if found is not None:
                    self._kept.move_to_end(keys[number])
                    return number, found
        return 0, None

    def _keep(self, key: Hashable, batch: Batch) -> Batch:
        """Remember a batch and return it."""
        with self._lock:
            self._kept[key] = batch
            while len(self._kept) > self.most:
                self._kept.popitem(last=False)
        return batch
