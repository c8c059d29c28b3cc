"""Remembered draws are those of `Draws`, to the last bit."""

from __future__ import annotations

import pickle

import numpy as np

from bench.physics.randomness import Draws
from bench.physics.remembered import DrawMemory, RememberedDraws


def _taken(draws: Draws) -> list[np.ndarray]:
    """Return numbers of every kind, drawn one after the other; what is large is written into."""
    hashes = np.array([7, 7, 9, 11], np.uint64)
    out = [draws.uniform(5), draws.complex_normal(4, 6), draws.complex_normal(4, 6)]
    out += [draws.group_complex(hashes, 3), draws.normal(3), draws.complex_normal(2, 2)]
    return out


def test_numbers_are_the_same_first_and_again() -> None:
    memory = DrawMemory(8)
    plain = _taken(Draws(1, 2, "tail", 3))
    for _ in range(3):
        again = _taken(RememberedDraws(1, 2, "tail", 3, memory))
        for ours, theirs in zip(again, plain, strict=True):
            np.testing.assert_array_equal(ours, theirs)
            ours *= 0  # a caller may write into what it was given


def test_other_keys_are_other_numbers() -> None:
    memory = DrawMemory(8)
    first = RememberedDraws(1, 2, "tail", 3, memory).complex_normal(4, 6)
    for key in ((2, 2, "tail", 3), (1, 3, "tail", 3), (1, 2, "fading", 3), (1, 2, "tail", 4)):
        assert not np.array_equal(first, RememberedDraws(*key, memory).complex_normal(4, 6))


def test_a_memory_is_small_and_travels_empty() -> None:
    memory = DrawMemory(2)
    for number in range(5):
        assert memory.get(number, lambda n=number: n) == number
    assert memory.get(4, lambda: -1) == 4
    assert memory.get(0, lambda: -1) == -1
    assert pickle.loads(pickle.dumps(memory)).get(0, lambda: 7) == 7
