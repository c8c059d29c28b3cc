"""Fit many networks of one kind at once: the seeds, rooms or widths of a sweep."""

from __future__ import annotations

from collections.abc import Hashable, Sequence

from zoo.base import Floats, Progress, TrainingRecipe
from zoo.module_model import NeuralModel, Start
from zoo.training.stacked.fit import train_stacked


def fit_together(
    models: Sequence[NeuralModel],
    X: Sequence[Floats],
    y: Sequence[Floats],
    progress: Progress | None = None,
) -> None:
    """Fit models[m] on CIRs X[m] [n, width] and errors y[m] [n] in metres, all at once.

    Each ends as its own `fit` would leave it, within rounding. Pass the same array objects for
    models that share rows: these are then prepared and held once. Raises ValueError where the
    training recipes differ, or as `fit` does.

    >>> import numpy as np
    >>> from zoo import FeatureMLP
    >>> rng = np.random.default_rng(0)
    >>> X, y = rng.rayleigh(100, (40, 12)), rng.normal(0.1, 0.1, 40)
    >>> models = [FeatureMLP(cir_samples=10, epochs=1, random_state=seed) for seed in range(3)]
    >>> fit_together(models, [X] * 3, [y] * 3)
    >>> [model.predict(X[:2]).shape for model in models]
    [(2,), (2,), (2,)]
    """
    if not models:
        return
    recipe = _common_recipe(models)
    starts = _starts(models, X, y)
    logs = train_stacked(
        [start.module.network for start in starts],
        [start.rows for start in starts],
        [start.errors_m for start in starts],
        recipe,
        seeds=[model.random_state for model in models],
        progress=progress,
    )
    for model, start, log in zip(models, starts, logs, strict=True):
        model.trained(start, log)


def _common_recipe(models: Sequence[NeuralModel]) -> TrainingRecipe:
    recipes = {model.training_recipe() for model in models}
    if len(recipes) > 1:
        raise ValueError(f"models to be fitted together have {len(recipes)} training recipes")
    return recipes.pop()


def _starts(models: Sequence[NeuralModel], X: Sequence[Floats], y: Sequence[Floats]) -> list[Start]:
    known: dict[Hashable, Start] = {}
    starts = []
    for model, cirs, errors_m in zip(models, X, y, strict=True):
        key = (type(model), _settings(model), id(cirs), id(errors_m))
        like = known.get(key)
        start = model.prepare(cirs, errors_m) if like is None else model.prepare_like(like)
        known.setdefault(key, start)
        starts.append(start)
    return starts


def _settings(model: NeuralModel) -> str:
    """Return all that a preparation can depend on: every parameter but the seed."""
    parameters = model.get_params()
    del parameters["random_state"]
    return repr(parameters)
