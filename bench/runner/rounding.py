"""Whether a model is of any use once it is rounded: asked of training rows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from backends.base import Artifact, TrainingData
    from zoo.base import MitigationModel

ROWS = 256  # asked of both
LEAST_M = 1e-3  # an error that nobody's ranges show


def why_useless(model: MitigationModel, artifact: Artifact, data: TrainingData) -> str | None:
    """Return why a rounded artifact is of no use, None where it is, or where nothing is rounded.

    It is none where rounding costs more than there was to correct: where the artifact leaves more
    error than the model itself by more than the errors spread about their median (mean absolute
    values, training rows).
    """
    if getattr(artifact, "precision", "fp32") == "fp32":
        return None
    evenly = np.linspace(0, len(data.cirs) - 1, min(len(data.cirs), ROWS)).astype(int)
    rows, errors_m = data.cirs[evenly], data.errors_m[evenly]
    spread_m = _mean(errors_m - np.median(errors_m))
    try:
        own_m = _mean(errors_m - np.asarray(model.predict(rows)))
    except Exception:  # a plug-in's; its graph is what counts
        return None
    left_m = _mean(errors_m - artifact.predict(rows))
    if left_m - own_m <= max(spread_m, LEAST_M):
        return None
    return (
        f"useless in {artifact.precision}: {left_m:.3g} m of error on training rows, "
        f"the model itself {own_m:.3g} m"
    )


def _mean(left_m: NDArray[np.float32]) -> float:
    return float(np.abs(left_m).mean())
