"""Several replicates of some rows as one batch: to the last bit what each gives alone.

A few hundred rows cost more in calls than in arithmetic. So replicates stand one under the other,
and every number is drawn by the draws of its own replicate.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.physics.batch import Batch, altered
from bench.physics.effect import Effect
from bench.physics.randomness import Draws, uniforms
from bench.physics.remembered import DrawMemory, RememberedDraws
from bench.physics.scene import Scene
from bench.physics.units import Complexes, Floats, Reals

Hashes = NDArray[np.uint64]
Call = tuple[Any, ...]  # a method of draws by its name, and what it is given for one replicate


class OtherGroupsError(Exception):
    """Replicates have groups of rows that are not the same in each: take them one by one."""


@dataclass(frozen=True)
class StackedDraws(Draws):
    """Draws of `replicates`, each of rows of its own, as many: their batches stand stacked.

    First axes of shapes, and hashes, are those of all replicates together; `replicate` is the first
    of them. `scenes` are the rows of each.
    """

    replicates: tuple[int, ...] = ()
    scenes: tuple[Scene, ...] = ()
    memory: DrawMemory = field(default_factory=lambda: DrawMemory(0), compare=False)
    _asked: list[Call] = field(default_factory=list, init=False, repr=False, compare=False)
    _behind: list[Call] = field(default_factory=list, init=False, repr=False, compare=False)

    @cached_property
    def parts(self) -> tuple[RememberedDraws, ...]:
        """The draws of each replicate."""
        key = (self.name, self.block, self.memory)
        return tuple(RememberedDraws(self.seed, number, *key) for number in self.replicates)

    @cached_property
    def generator(self) -> np.random.Generator:
        """Raise AttributeError: every replicate has a generator of its own."""
        raise AttributeError("stacked replicates have a generator each")

    def normal(self, *shape: int) -> Reals:
        """Return what each replicate's draws return."""
        return self._each("normal", shape)

    def uniform(self, *shape: int) -> Reals:
        """Return what each replicate's draws return."""
        return self._each("uniform", shape)

    def complex_normal(self, *shape: int) -> Complexes:
        """Return what each replicate's draws return."""
        return self._each("complex_normal", shape)

    def gamma(self, shape: float, *size: int) -> Reals:
        """Return what each replicate's draws return."""
        return self._each("gamma", size, shape)

    def groups(self, hashes: Hashes) -> tuple[Hashes, NDArray[np.intp]]:
        """Return the groups of each replicate, one replicate's behind the other's.

        Raises OtherGroupsError where replicates have other groups each.
        """
        count = len(self.parts)
        each = hashes.reshape(count, -1)
        if not (each == each[0]).all():
            raise OtherGroupsError
        groups, place = Draws.groups(self, each[0])
        behind = len(groups) * np.arange(count)[:, None]
        return np.tile(groups, count), (behind + place).ravel()

    def group_uniforms(self, hashes: Hashes, draws: Sequence[int]) -> Floats:
        """Return what each replicate's draws return for its part of the hashes."""
        count, inner = len(self.parts), np.ones(hashes.ndim, np.intp)
        keys = np.stack([part.keys(draws) for part in self.parts], axis=1)
        each = hashes.reshape(count, -1, *hashes.shape[1:])
        made = uniforms(each, keys.reshape(len(draws), count, *inner))
        return made.reshape(len(draws), *hashes.shape)

    def group_complex(self, hashes: Hashes, columns: int) -> Complexes:
        """Return what each replicate's draws return for its part of the hashes."""
        parts = zip(self.parts, hashes.reshape(len(self.parts), -1), strict=True)
        return np.concatenate([part.kept_group_complex(own, columns) for part, own in parts])

    def _each(self, name: str, shape: tuple[int, ...], *first: float) -> NDArray[Any]:
        """Return what each replicate draws for its rows, of `shape` in all, under each other.

        What was drawn after the same calls before is remembered: the generators, which take longer
        to start than to draw, then fall behind.
        """
        call = (name, *first, shape[0] // len(self.parts), *shape[1:])
        self._asked.append(call)
        self._behind.append(call)
        key = (self.seed, self.replicates, self.name, self.block, tuple(self._asked))
        kept: NDArray[Any] = self.memory.get(key, self._drawn, len(self.parts))
        return kept.copy()  # who asks may write into it

    def _drawn(self) -> NDArray[Any]:
        """Return what the last call gives; the generators catch up with those before it."""
        for name, *given in self._behind:
            drawn = [getattr(Draws, name)(part, *given) for part in self.parts]
        self._behind.clear()
        return np.concatenate(drawn)


def applied(effect: Effect, batch: Batch, draws: Draws) -> Batch:
    """Return the batch with an effect: on stacked replicates at once where that is the same."""
    if not isinstance(draws, StackedDraws):
        return effect.apply(batch, draws)
    if is_stackable(effect):
        with suppress(OtherGroupsError):
            return effect.apply(batch, draws)
    parts = zip(split(batch, draws.scenes), draws.parts, strict=True)
    return joined([effect.apply(*part) for part in parts], batch.rows)


def is_stackable(effect: Effect) -> bool:
    """Return whether the class of an effect itself says so: one derived from it may do more."""
    return bool(vars(type(effect)).get("stackable", False))


def split(batch: Batch, scenes: Sequence[Scene]) -> list[Batch]:
    """Return the batches of replicates, each of as many rows: its scene."""
    arrays = {name: value for name, value in vars(batch).items() if isinstance(value, np.ndarray)}
    size = len(scenes[0])

    def part(number: int, rows: Scene) -> Batch:
        own: dict[str, Any] = {
            name: value[number * size : (number + 1) * size] for name, value in arrays.items()
        }
        return altered(batch, rows=rows, **own)

    return [part(number, rows) for number, rows in enumerate(scenes)]


def joined(batches: Sequence[Batch], rows: Scene) -> Batch:
    """Return the batches of replicates as one of all their rows.

    Raises ValueError where they differ in more than the values of arrays.
    """
    made: dict[str, Any] = {}
    for name in vars(batches[0]).keys() - {"rows"}:
        values = [getattr(batch, name) for batch in batches]
        if all(isinstance(value, np.ndarray) for value in values):
            made[name] = np.concatenate(values)
        elif any(value != values[0] for value in values):
            raise ValueError(f"replicates of which each has a {name} of its own")
    return altered(batches[0], rows=rows, **made)
