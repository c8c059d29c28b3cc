"""The diagnosis put to the proof: physics hidden from it, and a score of what it says.

The package can be called, as `bench.challenge(cases=40)`: that is `bench.challenge.api`'s
`run_challenge`, which a function beside the package could not be named after.
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any


class _Callable(ModuleType):
    """A package that runs the challenge when it is called."""

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        from bench.challenge.api import run_challenge

        return run_challenge(*arguments, **named)


sys.modules[__name__].__class__ = _Callable
