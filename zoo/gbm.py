"""Gradient boosting on everything a row holds: the obvious baseline."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike
from sklearn.ensemble import HistGradientBoostingRegressor
from torch import Tensor, nn

from zoo.base import Floats, Progress
from zoo.block_model import BlockModel
from zoo.modules.blocks import BlockError, Columns
from zoo.modules.preparation import apply_in_blocks
from zoo.modules.trees import TreeEnsemble, from_boosting


class GradientBoosting(BlockModel):
    """Histogram gradient boosting on levels, range, the six features and CIR bins.

    Source: Ke et al., "LightGBM: a highly efficient gradient boosting decision tree", NeurIPS
    2017, as scikit-learn has it (HistGradientBoostingRegressor), absolute-error loss: up to
    `trees` trees of `leaves` leaves, so at most 200 x 29 nodes. Each split looks at a third of
    the columns, since neighbouring CIR bins say the same. What a table lacks is left out or
    NaN, which the trees send to the side that suits. More than `max_train_rows` rows are thinned
    to that many, drawn with `random_state`: a fit takes time with their number.

    The graph ends in ONNX's own operator for trees, which has no 8- or 16-bit form.
    """

    reads: ClassVar[tuple[str, ...]] = ("cir", "levels", "features", "range")
    does_without: ClassVar[tuple[str, ...]] = ("cir", "levels", "features", "range")
    module_: BlockError

    def __init__(
        self,
        trees: int = 200,
        leaves: int = 15,
        learning_rate: float = 0.05,
        min_leaf_rows: int = 30,
        column_share: float = 0.3,
        cir_samples: int = 64,
        max_train_rows: int = 12_000,
        random_state: int = 0,
    ) -> None:
        self.trees = trees
        self.leaves = leaves
        self.learning_rate = learning_rate
        self.min_leaf_rows = min_leaf_rows
        self.column_share = column_share
        self.cir_samples = cir_samples
        self.max_train_rows = max_train_rows
        self.random_state = random_state

    def fit(
        self,
        X: ArrayLike,
        y: ArrayLike,
        progress: Progress | None = None,
        groups: ArrayLike | None = None,
    ) -> Self:
        """Fit on rows [n, width] and errors [n] in metres; sets `module_`, `n_features_in_`."""
        rows, errors = thinned(*self._training_rows(X, y), self.max_train_rows, self.random_state)
        columns = self._columns(rows.shape[1])
        values = apply_in_blocks(columns, rows).numpy()
        values[:, np.isnan(values).all(0)] = 0  # nothing to split on, which scikit-learn cannot bin
        machine = self._machine().fit(values, errors)
        self.module_ = BlockError(columns, from_boosting(machine)).eval()
        return self

    def _columns(self, width: int) -> Columns:
        return Columns(self._layout(width), cir_samples=self.cir_samples)

    def _machine(self) -> HistGradientBoostingRegressor:
        return HistGradientBoostingRegressor(
            loss="absolute_error",
            learning_rate=self.learning_rate,
            max_iter=self.trees,
            max_leaf_nodes=self.leaves,
            min_samples_leaf=self.min_leaf_rows,
            max_features=self.column_share,
            early_stopping=False,
            random_state=self.random_state,
        )

    def _skeleton(self, width: int, weights: Mapping[str, Tensor]) -> nn.Module:
        nodes, trees = len(weights["network.value"]), len(weights["network.roots"])
        return BlockError(self._columns(width), TreeEnsemble(nodes, trees))


def thinned(rows: Floats, errors: Floats, most: int, seed: int) -> tuple[Floats, Floats]:
    """Return at most `most` rows with their errors, drawn with `seed`."""
    if len(rows) <= most:
        return rows, errors
    kept = np.sort(np.random.default_rng(seed).choice(len(rows), most, replace=False))
    return rows[kept], errors[kept]
