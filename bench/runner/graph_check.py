"""Whether a model's graph says what its `predict` says: boards show the graph."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from zoo.base import MitigationModel

ROWS = 64  # asked of both
NOTED_M = 1e-3  # below this, rounding; nobody's ranges are told apart by it


def graph_remark(name: str, model: MitigationModel, rows: NDArray[np.float32]) -> str | None:
    """Return in a line how far a fitted model's `to_module()` is from its `predict`, on some rows.

    None where they agree to a millimetre, or where either cannot be asked: that is said elsewhere.
    """
    apart_m = _apart_m(model, rows[:: max(1, len(rows) // ROWS)][:ROWS])
    if apart_m is None or apart_m <= NOTED_M:
        return None
    return (
        f"{name}: predict() and the graph of to_module() differ by up to {apart_m:.3g} m on "
        f"{min(len(rows), ROWS)} training rows; every figure is of the graph"
    )


def _apart_m(model: MitigationModel, rows: NDArray[np.float32]) -> float | None:
    import torch

    try:
        with torch.no_grad():
            said = model.to_module()(torch.from_numpy(np.ascontiguousarray(rows)))
        graph = said[0] if isinstance(said, tuple) else said
        apart = np.abs(graph.numpy() - np.asarray(model.predict(rows)))
        return float(np.nanmax(apart)) if apart.size else None
    except Exception:  # a plug-in's; its run fails, and says why
        return None
