"""The torch building blocks of models: cropping, features, scalings, and REMnet itself.

Names are imported on first use, so that `import zoo.modules` stays free of torch.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

_HOMES = {
    "FEATURES": "zoo.modules.features",
    "MaranoFeatures": "zoo.modules.features",
    "marano_features": "zoo.modules.features",
    "Crop": "zoo.modules.preparation",
    "Preparation": "zoo.modules.preparation",
    "RemnetModule": "zoo.modules.remnet",
    "GlobalScale": "zoo.modules.scaling",
    "PeakScale": "zoo.modules.scaling",
    "Standardise": "zoo.modules.scaling",
}
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'zoo.modules' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
