"""The one interface every mitigation model has."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, RegressorMixin

from zoo.training.recipe import TrainingRecipe

if TYPE_CHECKING:
    from torch import nn

Floats = NDArray[np.float32]
Progress = Callable[[float], None]
"""Called now and then during a fit with the fraction done, 0 to 1."""
__all__ = ["Floats", "MitigationModel", "Progress", "TrainingRecipe"]


class MitigationModel(RegressorMixin, BaseEstimator, ABC):
    """A scikit-learn regressor from raw CIR magnitudes to the range error in metres.

    `X` is float32 [n, width]: CIR magnitudes in accumulator counts, one row per range
    measurement, `samples_before` (5) samples before the detected first path in front. `y` is
    float32 [n]: error = measured - true range in metres. Corrected range = measured - predict(X).

    A model that reads more than the CIR names it in `reads` (`cir`, `levels`, `features`,
    `range`, `settings`): `X` then holds these as blocks of columns, as `zoo.inputs` lays them
    out, NaN where a value is not known. What stands in `does_without` too may be missing from a
    table altogether; without any of the rest the model is skipped.

    Width rule: a model that wants `k` samples starting at `offset` crops wider rows to
    `X[:, offset:offset + k]` and refuses narrower ones with ValueError naming both widths.

    `gives_std` says that `predict(X, return_std=True)` and a second output `std_m` of the graph
    give a standard deviation per row. `floor` says that the model is there
    to be beaten: boards mark what does not beat it.

    The module from `to_module()` takes rows of exactly the width the model was fitted on, so
    cropping, normalisation and hand-crafted features are inside it and inside every latency.

    >>> from zoo import NoMitigation
    >>> model = NoMitigation().fit(np.zeros((4, 157)), np.zeros(4))
    >>> model.predict(np.ones((2, 157))).tolist()
    [0.0, 0.0]

    `rests_on` names the distributions whose versions decide its fits, beyond those of the harness
    itself. `bits_depend_on_threads` is False where a fit's bits are the same on any number of
    threads. These and `cache_key()` decide which earlier results are still good.
    """

    floor: ClassVar[bool] = False
    rests_on: ClassVar[tuple[str, ...]] = ()
    bits_depend_on_threads: ClassVar[bool] = True
    reads: ClassVar[tuple[str, ...]] = ("cir",)
    does_without: ClassVar[tuple[str, ...]] = ()
    gives_std: ClassVar[bool] = False

    @abstractmethod
    def fit(
        self,
        X: ArrayLike,
        y: ArrayLike,
        progress: Progress | None = None,
        groups: ArrayLike | None = None,
    ) -> Self:
        """Fit on rows [n, width] and errors [n] in metres; sets `n_features_in_`.

        `groups` [n] names each row's link: a model that holds rows out holds out whole links. A
        model that does not need them may leave the argument away.
        """

    @abstractmethod
    def predict(self, X: ArrayLike) -> Floats:
        """Return the predicted error [n] in metres for CIRs [n, n_features_in_]."""

    @abstractmethod
    def to_module(self) -> nn.Module:
        """Return a torch module in eval mode: float32 [n, n_features_in_] -> float32 [n] metres."""

    def training_recipe(self) -> TrainingRecipe | None:
        """Return how the module is trained by gradient descent, or None where it is not."""
        return None

    def teacher(self) -> MitigationModel | None:
        """Return the unfitted model that teaches this one, None where nothing does.

        Whoever fits it on the same rows, of what it `reads`, or has it fitted, gives what it
        predicts for them to `fit` as `said_m` [n] in metres; else `fit` fits one of its own.
        """
        return None

    def cache_key(self) -> str:
        """Return text that changes with whatever else decides a fit or a prediction.

        That is the content of files and the values of environment variables that it reads; source
        and versions are seen without it.
        """
        return ""

    def fitted_state(self) -> dict[str, NDArray[Any]] | None:
        """Return the fit as plain arrays for a cache, or None where the model keeps no such form.

        Arrays, not pickles: a cache file can then never run code.
        """
        return None

    def restore_state(self, state: Mapping[str, NDArray[Any]]) -> bool:
        """Become fitted from `fitted_state()`'s arrays; False where they do not suit."""
        return False
