"""Random numbers that depend on the row and the effect, never on chunking or on other effects.

Rows are simulated in blocks of `BLOCK` by their position in the table. Every (seed, replicate,
effect, block) has its own stream, so adding an effect leaves the draws of all others unchanged:
a simulator with and without it can be compared on common random numbers.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from zlib import crc32

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from bench.physics.units import Complexes, Floats, Reals

BLOCK = 1024
CACHED = 64
"""Rows of complex draws that are made at once, so that they stay in a core's cache."""
_GOLDEN = np.uint64(0x9E3779B97F4A7C15)


@dataclass(frozen=True)
class Draws:
    """The random numbers of one effect on one block of rows."""

    seed: int
    replicate: int
    name: str
    block: int

    @cached_property
    def generator(self) -> np.random.Generator:
        """The block's own numpy Generator."""
        key = [self.seed, self.replicate, crc32(self.name.encode()), self.block]
        return np.random.Generator(np.random.SFC64(np.random.SeedSequence(key)))

    def normal(self, *shape: int) -> Reals:
        """Return standard normal draws, float32, independent for every element."""
        return self.generator.standard_normal(shape, np.float32)

    def uniform(self, *shape: int) -> Reals:
        """Return draws uniform on [0, 1), float32."""
        return self.generator.random(shape, np.float32)

    def complex_normal(self, *shape: int) -> Complexes:
        """Return circular complex normal draws of mean power one, complex64.

        A power that is exponential and a phase that is uniform (Box and Muller 1958), which numpy
        makes of vectors twice as fast as its ziggurat makes real draws.
        """
        made = np.empty(shape, np.complex64)
        for start in range(0, len(made), CACHED):
            part = made[start : start + CACHED]
            power, turn = self._pairs(len(part), *shape[1:])
            size = np.sqrt(-np.log(1 - power))
            turn *= np.float32(2 * np.pi)
            np.multiply(size, np.cos(turn), out=part.real)
            np.multiply(size, np.sin(turn), out=part.imag)
        return made

    def _pairs(self, rows: int, *columns: int) -> Reals:
        """Return `uniform` draws [2, rows, *columns], drawn row by row, at twice the speed.

        They are the same numbers: numpy makes one of every 32 bits, lower ones first, of which it
        may hold the higher half of the last 64 back.
        """
        shape, bits = (rows, 2, *columns), self.generator.bit_generator
        if sys.byteorder != "little" or bits.state["has_uint32"]:
            return self.uniform(*shape).swapaxes(0, 1)
        raw = np.asarray(bits.random_raw(math.prod(shape) // 2)).view(np.uint32)
        raw >>= np.uint32(8)
        drawn = raw.view(np.int32).astype(np.float32)
        drawn *= np.float32(2**-24)
        return drawn.reshape(shape).swapaxes(0, 1)

    def gamma(self, shape: float, *size: int) -> Reals:
        """Return draws of Gamma(`shape`, 1), float32, independent for every element."""
        return self.generator.standard_gamma(shape, size, np.float32)

    def groups(self, hashes: NDArray[np.uint64]) -> tuple[NDArray[np.uint64], NDArray[np.intp]]:
        """Return the hashes of groups, and which of them each row [n] belongs to."""
        groups, place = np.unique(hashes, return_inverse=True)
        return groups, np.asarray(place, np.intp)

    def group_uniform(self, hashes: NDArray[np.uint64], draw: int = 0) -> Floats:
        """Return draws on (0, 1), equal for rows of equal hash (a link, a device), in any block.

        `draw` numbers independent draws for the same groups.
        """
        return np.asarray(self.group_uniforms(hashes, (draw,))[0])

    def group_uniforms(self, hashes: NDArray[np.uint64], draws: Sequence[int]) -> Floats:
        """Return `group_uniform` of several draws, one after the other along the first axis."""
        keys = self.keys(draws).reshape(-1, *np.ones(hashes.ndim, np.intp))
        return uniforms(hashes, keys)

    def keys(self, draws: Sequence[int]) -> NDArray[np.uint64]:
        """Return what hashes of groups are mixed with, in each of several draws."""
        about = f"{self.seed}/{self.replicate}/{self.name}/"
        return _splitmix(np.array([crc32(f"{about}{draw}".encode()) for draw in draws], np.uint64))

    def group_normal(self, hashes: NDArray[np.uint64], draw: int = 0) -> Floats:
        """Return standard normal draws, equal for rows of equal hash (see `group_uniform`)."""
        return np.asarray(ndtri(self.group_uniform(hashes, draw)), np.float64)

    def group_complex(self, hashes: NDArray[np.uint64], columns: int) -> Complexes:
        """Return circular complex normal draws [n, columns], rows of equal hash the same."""
        groups, place = self.groups(hashes)
        counter = np.arange(2 * columns, dtype=np.uint64) * _GOLDEN
        parts = self.group_normal(groups[:, None] ^ _splitmix(counter)[None, :], -1)
        both = parts[:, :columns] + 1j * parts[:, columns:]
        whole: Complexes = (both * np.sqrt(0.5)).astype(np.complex64)
        return whole[place]


def uniforms(hashes: NDArray[np.uint64], keys: NDArray[np.uint64]) -> Floats:
    """Return numbers on (0, 1) that follow from hashes and keys alone."""
    mixed = _splitmix(hashes ^ keys)
    return (np.asarray(mixed >> np.uint64(11), np.float64) + 0.5) / 2.0**53


def _splitmix(value: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Return the SplitMix64 mix of `value` (Steele, Lea and Flood, OOPSLA 2014)."""
    mixed = value + _GOLDEN
    mixed = (mixed ^ (mixed >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    mixed = (mixed ^ (mixed >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return np.asarray(mixed ^ (mixed >> np.uint64(31)), np.uint64)
