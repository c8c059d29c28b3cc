"""A step that fails never ends a diagnosis: something simpler stands in for it, and it is said."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import ClassVar, ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


@dataclass
class Guard:
    """Notes the steps that failed: `failed` maps what was tried to the reason, one line each.

    `through` are problems that are not noted but raised: tests let assertions come through.
    """

    through: ClassVar[tuple[type[Exception], ...]] = ()
    failed: dict[str, str] = field(default_factory=dict)

    def safely(self, what: str, step: Callable[P, T], otherwise: T) -> Callable[P, T]:
        """Return the step; where it raises, it gives `otherwise` and is noted as `what`.

        Interruptions come through.
        """

        def tried(*args: P.args, **kwargs: P.kwargs) -> T:
            try:
                return step(*args, **kwargs)
            except Exception as problem:
                if isinstance(problem, self.through):
                    raise
                reason = f"{problem}".splitlines()[0] if f"{problem}" else ""
                self.failed[what] = f"failed: {type(problem).__name__}: {reason}"
                return otherwise

        return tried
