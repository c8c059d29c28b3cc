"""The ways to learn a correction that are compared."""

from __future__ import annotations

import warnings
from copy import deepcopy
from math import ceil

import numpy as np
from numpy.typing import NDArray
from sklearn.ensemble import HistGradientBoostingRegressor
from sklearn.exceptions import ConvergenceWarning
from sklearn.neural_network import MLPRegressor

from bench.runner.worth.settings import (
    BATCH,
    BEND_M,
    FARTHEST_STD,
    FURTHER_PACE,
    FURTHER_STEPS,
    HIDDEN,
    LEAF_ROWS,
    PACE,
    PENALTY,
    PRIOR_LINKS,
    STEPS,
    TREES,
)
from bench.runner.worth.site import REGISTERS, Examples, Site

Floats = NDArray[np.float64]


class Network:
    """A small network on registers and CIR features: rows [n, columns] to errors [n] in metres.

    One hidden layer, Adam, squared loss of errors bent by arcsinh (a metre more counts less the
    larger the error). Figures are standardised by the rows of the first training; unknown ones
    count as average; no prediction is beyond the errors trained on. Deterministic from `seed`.
    """

    def __init__(self, examples: Examples, seed: int) -> None:
        rows = examples.rows.astype(np.float64)
        self.mean, self.std = _known_moments(rows)
        self.span = float(examples.errors_m.min()), float(examples.errors_m.max())
        size = min(BATCH, len(rows))
        self.machine = MLPRegressor(
            hidden_layer_sizes=(HIDDEN,), alpha=PENALTY, batch_size=size, learning_rate_init=PACE,
            max_iter=ceil(STEPS * size / len(rows)), random_state=seed, tol=0.0,
        )  # fmt: skip
        with warnings.catch_warnings():  # so many steps were wanted, not convergence
            warnings.simplefilter("ignore", ConvergenceWarning)
            self.machine.fit(self._figures(examples), _bent(examples.errors_m))

    def predict(self, examples: Examples) -> Floats:
        """Return errors [n] in metres."""
        made = self.machine.predict(self._figures(examples))
        return np.asarray(np.clip(np.sinh(made) * BEND_M, *self.span), np.float64)

    def further(self, known: Examples) -> Network:
        """Return the network trained further on other rows, at a slower pace."""
        made, errors = deepcopy(self), known.errors_m
        made.span = min(self.span[0], float(errors.min())), max(self.span[1], float(errors.max()))
        size = min(BATCH, len(known.rows))
        made.machine.set_params(batch_size=size, learning_rate_init=PACE * FURTHER_PACE)
        made.machine._optimizer.learning_rate = PACE * FURTHER_PACE
        rows, wanted = self._figures(known), _bent(known.errors_m)
        for _ in range(ceil(FURTHER_STEPS * size / len(rows))):
            made.machine.partial_fit(rows, wanted)
        return made

    def _figures(self, examples: Examples) -> Floats:
        scaled = (examples.rows - self.mean) / self.std
        return np.asarray(np.clip(np.nan_to_num(scaled), -FARTHEST_STD, FARTHEST_STD), np.float64)


def _known_moments(rows: Floats) -> tuple[Floats, Floats]:
    """Return mean and std [columns] of what is known; a std of 1 where nothing varies."""
    known = np.isfinite(rows)
    count = np.maximum(known.sum(axis=0), 1)
    mean = np.where(known, rows, 0).sum(axis=0) / count
    std = np.sqrt((np.where(known, rows - mean, 0) ** 2).sum(axis=0) / count)
    return mean, np.where(std > 1e-9 * (1 + np.abs(mean)), std, 1.0)


def _bent(errors_m: NDArray[np.float32]) -> Floats:
    return np.asarray(np.arcsinh(errors_m / BEND_M), np.float64)


def constant(known: Examples) -> float:
    """Return the median over links of their median errors, in metres."""
    return float(np.median(_per_link(known, known.errors_m)))


def boosting(known: Examples, some: Examples, seed: int) -> Floats:
    """Return what gradient boosting on the registers of surveyed links predicts, in metres."""
    model = HistGradientBoostingRegressor(
        loss="absolute_error", max_iter=TREES, min_samples_leaf=LEAF_ROWS, early_stopping=False,
        random_state=seed,
    )  # fmt: skip
    able = np.flatnonzero(np.isfinite(known.rows[:, :REGISTERS]).sum(axis=0))
    model.fit(known.rows[:, able], known.errors_m)
    return np.asarray(model.predict(some.rows[:, able]), np.float64)


def offset(trained: Network, known: Examples) -> float:
    """Return the constant that surveyed links add to a network, shrunken towards none."""
    left = _per_link(known, known.errors_m - trained.predict(known))
    return float(np.sum(left) / (len(left) + PRIOR_LINKS))


def _per_link(known: Examples, values: NDArray[np.floating]) -> Floats:
    """Return the median of values [n] over the rows of each link."""
    return np.array([np.median(values[known.links == name]) for name in known.names])


def simulated(site: Site) -> dict[str, Network]:
    """Return the networks trained on simulated rows alone."""
    return {"before": Network(site.before, site.seed), "after": Network(site.after, site.seed)}
