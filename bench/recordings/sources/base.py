"""What a named data set is."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from pathlib import Path
from typing import ClassVar

from bench.recordings.table import Recordings


class Source(ABC):
    """A named data set: `available()` says why it cannot be read, `load()` reads it.

    `test_environment` is the environment that leave-environment-out tests on by default.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    licence: ClassVar[str]
    simulated: ClassVar[bool] = False
    test_environment: ClassVar[str | None] = None

    @abstractmethod
    def available(self) -> str | None:
        """Return None where the data can be read now, else what is missing and how to get it."""

    @abstractmethod
    def load(self) -> Recordings:
        """Read (or make) the recordings. Raises BenchError where they cannot be had."""


def data_root() -> Path | None:
    """Return the folder of $BENCH_DATA, or None where it is not set."""
    named = os.environ.get("BENCH_DATA")
    return Path(named) if named else None
