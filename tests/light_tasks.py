"""Work to send to other processes, which import nothing that takes long for it."""

from __future__ import annotations

from dataclasses import dataclass

from bench.errors import BenchError


@dataclass(frozen=True)
class Nothing:
    """Shared by tasks that need no data."""


@dataclass(frozen=True)
class Number:
    value: int


def square(_: Nothing, task: Number) -> int:
    return task.value**2


def fail_on_three(_: Nothing, task: Number) -> int:
    if task.value == 3:
        raise BenchError("three is not possible")
    return task.value


def power(exponent: int, number: int) -> int:
    return number**exponent
