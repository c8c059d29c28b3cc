"""Models that read more than the CIR: rows of several blocks, unknown values as NaN."""

from __future__ import annotations

from typing import Any, Literal, overload

import numpy as np
import torch
from numpy.typing import ArrayLike
from sklearn.utils.validation import check_is_fitted, validate_data
from torch import Tensor, nn

from zoo.base import Floats
from zoo.inputs import Input, layout
from zoo.module_model import ModuleModel, NeuralModel
from zoo.modules.blocks import BlockError, BlockModule
from zoo.modules.preparation import BLOCK_ROWS


class BlockModel(ModuleModel):
    """A model of several blocks; its fit is a `BlockModule` as `module_`."""

    def _layout(self, width: int) -> tuple[Input, ...]:
        """Return the inputs of rows of `width`; ValueError if they do not fit `reads`."""
        return layout(self.reads, width)

    def _training_rows(self, X: ArrayLike, y: ArrayLike) -> tuple[Floats, Floats]:
        rows, errors = validate_data(
            self, X, y, dtype=np.float32, y_numeric=True, ensure_all_finite="allow-nan"
        )
        self._check_cir(rows)
        return rows, np.asarray(errors, np.float32)

    def _known_rows(self, X: ArrayLike) -> Floats:
        rows: Floats = validate_data(
            self, X, dtype=np.float32, reset=False, ensure_all_finite="allow-nan"
        )
        self._check_cir(rows)
        return rows

    def _check_cir(self, rows: Floats) -> None:
        """Raise ValueError for a CIR with NaN: what is measured whole is known or it is not."""
        first = next(iter(self._layout(rows.shape[1])), None)
        if first and first.name == "cir" and np.isnan(rows[:, : first.width]).any():
            raise ValueError(
                "X contains NaN in the CIR; only levels, range and settings may be NaN"
            )

    @overload
    def predict(self, X: ArrayLike, return_std: Literal[False] = False) -> Floats: ...
    @overload
    def predict(self, X: ArrayLike, return_std: Literal[True]) -> tuple[Floats, Floats]: ...
    def predict(self, X: ArrayLike, return_std: bool = False) -> Floats | tuple[Floats, Floats]:
        """Return the predicted error [n] in metres, with its standard deviation [n] if asked.

        Raises ValueError for rows of another width, NaN in the CIR, infinities, or a standard
        deviation of a model that gives none.
        """
        check_is_fitted(self)
        if return_std and not self.gives_std:
            raise ValueError(f"{type(self).__name__} gives no standard deviation")
        errors, std = _results(self.module_, self._known_rows(X))
        return (errors, std) if return_std and std is not None else errors

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.allow_nan = True
        return tags


class NeuralBlockModel(BlockModel, NeuralModel):
    """A network on several blocks, trained by gradient descent: `_preparation` and `_network`."""

    def _whole(self, preparation: Any, network: nn.Module) -> BlockError:
        return BlockError(preparation, network, self.gives_std)

    def _preparation(self, width: int) -> Any:
        raise NotImplementedError


def _results(module: nn.Module, rows: Floats) -> tuple[Floats, Floats | None]:
    """Return errors [n] and standard deviations [n], if any, a block of rows at a time."""
    errors: list[Tensor] = []
    spreads: list[Tensor] = []
    with torch.inference_mode():
        for start in range(0, len(rows), BLOCK_ROWS):
            result: Tensor | tuple[Tensor, Tensor] = module(
                torch.tensor(rows[start : start + BLOCK_ROWS])
            )
            pair = result if isinstance(result, tuple) else (result,)
            errors.append(pair[0])
            spreads += pair[1:]
    std = torch.cat(spreads).numpy() if spreads else None
    return torch.cat(errors).numpy(), std


__all__ = ["BlockModel", "BlockModule", "NeuralBlockModel"]
