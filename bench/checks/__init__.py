"""What the harness asks of a plug-in, as checks that its own tests call.

    from bench.checks import check_effect
    check_effect(Warmth())

Ours pass the same checks. Each raises AssertionError in one line: what is wrong and what was
expected. What a plug-in is for, its own tests must say.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.lazy import lazily

if TYPE_CHECKING:
    from bench.checks.backends import check_backend as check_backend
    from bench.checks.datasets import check_dataset as check_dataset
    from bench.checks.devices import check_device as check_device
    from bench.checks.effects import check_effect as check_effect
    from bench.checks.models import check_model as check_model
    from bench.checks.simulators import check_simulator as check_simulator

_HOMES = {
    "check_backend": "bench.checks.backends",
    "check_dataset": "bench.checks.datasets",
    "check_device": "bench.checks.devices",
    "check_effect": "bench.checks.effects",
    "check_model": "bench.checks.models",
    "check_simulator": "bench.checks.simulators",
}
__all__ = list(_HOMES)
__getattr__ = lazily(__name__, _HOMES)
