"""Training engines: plain, until held-out links say stop, many networks at once, and fused.

`train(module, X, y, recipe)` is the plain loop; `train_stacked(modules, X, y, recipe, seeds=..)`
trains many of one kind in one set of tensor calls, `train_fused` a REMnet in compiled kernels,
`fit_together` many models. Names are imported on first use, so that settings need no torch.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

_HOMES = {
    "Stopping": ("zoo.training.recipe", "Stopping"),
    "TrainingLog": ("zoo.training.recipe", "TrainingLog"),
    "TrainingRecipe": ("zoo.training.recipe", "TrainingRecipe"),
    "fit_together": ("zoo.training.together", "fit_together"),
    "train": ("zoo.training.eager", "train"),
    "train_fused": ("zoo.training.fused_remnet.fit", "train"),
    "train_stacked": ("zoo.training.stacked.fit", "train_stacked"),
}
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'zoo.training' has no attribute {name!r}")
    home, attribute = _HOMES[name]
    return getattr(import_module(home), attribute)
