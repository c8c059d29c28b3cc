"""What is measured: mitigation models, from a channel impulse response to a range error in metres.

Names are imported on first use, so that `import zoo` stays free of torch and scikit-learn.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

_HOMES = {
    "MitigationModel": "zoo.base",
    "TrainingRecipe": "zoo.base",
    "NoMitigation": "zoo.none",
    "REMnet": "zoo.remnet",
    "CNN1D": "zoo.cnn1d",
    "FeatureSVM": "zoo.svm",
    "FeatureMLP": "zoo.mlp",
    "Constant": "zoo.constant",
    "ConstantByLevel": "zoo.constant_by_level",
    "GradientBoosting": "zoo.gbm",
    "REMnetLevels": "zoo.remnet_levels",
    "GaussianProcess": "zoo.gp",
    "NPN": "zoo.npn",
    "Bregar2023": "zoo.bregar2023",
    "ECANet": "zoo.ecanet",
    "SmallCNN": "zoo.small",
    "SmallLevels": "zoo.small_levels",
    "BaggedMLP": "zoo.bagged_mlp",
    "Guarded": "zoo.guard",
}
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'zoo' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
