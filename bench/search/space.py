"""The networks that a search may try."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from itertools import product
from math import prod

import numpy as np

from bench.errors import BenchError
from zoo.modules.small import Shape

CHOICES: dict[str, tuple[int | bool, ...]] = {
    "samples": (32, 48, 64, 96, 128),
    "filters": (4, 8, 12, 16, 24),
    "kernel": (5, 7, 9),
    "stride": (1, 2, 4),
    "blocks": (0, 1, 2, 3),
    "reduction": (0, 4),
    "hidden": (0, 16),
    "distilled": (False, True),
}
SIZE = prod(len(values) for values in CHOICES.values())


@dataclass(frozen=True)
class Candidate:
    """One network: sizes as in `zoo.modules.small.Shape`, and whether REMnet teaches it."""

    samples: int
    filters: int
    kernel: int
    stride: int
    blocks: int
    reduction: int
    hidden: int
    distilled: bool

    @property
    def shape(self) -> Shape:
        """The sizes of the network."""
        sizes = {name: value for name, value in asdict(self).items() if name != "distilled"}
        return Shape(**sizes)

    @property
    def name(self) -> str:
        """The sizes in short: k128 f12x7/2 b3 a4 h16 taught."""
        parts = [f"k{self.samples}", f"f{self.filters}x{self.kernel}/{self.stride}"]
        parts += [f"b{self.blocks}"]
        parts += [f"a{self.reduction}"] if self.reduction else []
        parts += [f"h{self.hidden}"] if self.hidden else []
        return " ".join([*parts, *(["taught"] if self.distilled else [])])


def drawn(count: int, seed: int, most_macs: int) -> list[Candidate]:
    """Return `count` different networks of at most `most_macs` multiplications, drawn with `seed`.

    Raises BenchError where there are not as many.
    """
    if not 2 <= count <= SIZE:
        raise BenchError(f"--candidates {count}: expected a whole number from 2 to {SIZE}")
    found: list[Candidate] = []
    for candidate in _shuffled(seed):
        if size_of(candidate).macs <= most_macs:
            found.append(candidate)
        if len(found) == count:
            return found
    raise BenchError(f"--candidates {count}: only {len(found)} are as small as asked")


def _shuffled(seed: int) -> Iterator[Candidate]:
    every = list(product(*CHOICES.values()))
    for at in np.random.default_rng(seed).permutation(len(every)):
        yield Candidate(**dict(zip(CHOICES, every[at], strict=True)))


@dataclass(frozen=True)
class Size:
    """What running a network takes, by its sizes alone.

    `macs` multiplications, `values` results of layers, `layers`, `weights` (bytes in 8 bits, with
    biases of four).
    """

    macs: int
    values: int
    layers: int
    weights: int


def size_of(candidate: Candidate) -> Size:
    """Return the size of a candidate's network."""
    shape = candidate.shape
    layers = list(_layers(shape))
    return Size(
        sum(steps * taps * outs for steps, taps, outs in layers),
        sum(steps * outs for steps, _, outs in layers),
        len(layers),
        sum((taps + 4) * outs for _, taps, outs in layers),
    )


def _layers(shape: Shape) -> Iterator[tuple[int, int, int]]:
    """Yield (steps, inputs to each result, results per step) of every layer with weights."""
    filters, steps = shape.filters, shape.steps
    yield steps[0], shape.kernel, filters
    for number in range(shape.blocks):
        yield steps[number + 1], 3 * filters, filters
        if shape.reduction:
            yield 1, filters, filters // shape.reduction
            yield 1, filters // shape.reduction, filters
    flat = steps[-1] * filters
    if shape.hidden:
        yield 1, flat, shape.hidden
    yield 1, shape.hidden or flat, 1
