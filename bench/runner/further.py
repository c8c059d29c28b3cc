"""Training a fitted model further on other rows: pretrained here, fine-tuned there.

Only what a model shows of itself is used: its module, its recipe, and its fit as arrays. The
recipe is followed but for its pace and length: weights have to settle, not to be found.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError

if TYPE_CHECKING:
    from zoo.base import MitigationModel

STEPS = 600  # at least; few links make few batches, and a shift of a metre takes hundreds
PASSES = 10  # at least, over the rows
PACE = 0.3  # of the recipe's learning rate
Progress = Callable[[float], None]


def not_further(model: Any) -> str | None:
    """Return why an unfitted model cannot be trained further, None where it can."""
    if model.training_recipe() is None:
        return f"{type(model).__name__} is not trained by gradient descent: nothing to fine-tune"
    return None


def train_further(
    model: MitigationModel,
    rows: NDArray[np.float32],
    errors_m: NDArray[np.float32],
    progress: Progress | None = None,
) -> None:
    """Train a fitted model further on rows [n, width] and errors [n] in metres, in place.

    Raises BenchError where it has no recipe, or does not take its own fit back.
    """
    from zoo.training import train

    recipe, state = model.training_recipe(), model.fitted_state()
    if recipe is None or state is None:
        raise BenchError(not_further(model) or f"{type(model).__name__} keeps no fit to go on from")
    module, seed = model.to_module(), int(model.get_params().get("random_state") or 0)
    passes = max(PASSES, ceil(STEPS * recipe.batch_size / max(len(rows), recipe.batch_size)))
    pace = PACE * recipe.learning_rate
    shorter = replace(recipe, learning_rate=pace, epochs=passes, stopping=None, seed=seed)
    train(module, rows, errors_m, shorter, progress=progress)
    learnt = {name: value.detach().numpy() for name, value in module.state_dict().items()}
    if not set(learnt) <= set(state) or not model.restore_state({**state, **learnt}):
        raise BenchError(f"{type(model).__name__} does not take trained weights back")
