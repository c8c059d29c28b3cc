"""The ways to learn a correction that are compared."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.plugins import load
from bench.runner.further import train_further
from bench.runner.worth.settings import PRIOR_LINKS, STEPS
from bench.runner.worth.site import Examples, Site

if TYPE_CHECKING:
    from zoo.base import MitigationModel

Floats = NDArray[np.float64]
Predict = Callable[[Examples], Floats]
NETWORK, BOOSTING = "npn", "gbm"
REGISTERS = 9  # columns behind the CIR: eight levels and the range


def network(examples: Examples, seed: int) -> MitigationModel:
    """Return the network fitted on examples."""
    made: MitigationModel = load("models", NETWORK)(most_steps=STEPS, random_state=seed)
    return made.fit(examples.rows, examples.errors_m, groups=examples.links)


def predicted(model: MitigationModel, examples: Examples) -> Floats:
    """Return what a model predicts, in metres [n]."""
    return np.asarray(model.predict(examples.rows), np.float64)


def constant(known: Examples) -> float:
    """Return the median over links of their median errors, in metres."""
    return float(np.median([np.median(known.of(one).errors_m) for one in _each(known)]))


def boosting(known: Examples, seed: int, left_m: Floats | None = None) -> Predict:
    """Return gradient boosting on the registers, of the errors or of what is `left_m` of them."""
    wanted = known.errors_m if left_m is None else left_m.astype(np.float32)
    model = load("models", BOOSTING)(random_state=seed)
    model.fit(known.rows[:, -REGISTERS:], wanted)
    return lambda some: np.asarray(model.predict(some.rows[:, -REGISTERS:]), np.float64)


def tuned(trained: MitigationModel, known: Examples) -> MitigationModel:
    """Return a network trained further on surveyed links."""
    model = deepcopy(trained)
    train_further(model, known.rows, known.errors_m)
    return model


def offset(trained: MitigationModel, known: Examples) -> float:
    """Return the constant that surveyed links add to a network, shrunken towards none."""
    left = known.errors_m - predicted(trained, known)
    per_link = [np.median(left[known.links == name]) for name in known.names]
    return float(np.sum(per_link) / (len(per_link) + PRIOR_LINKS))


def _each(known: Examples) -> list[NDArray[np.str_]]:
    return [np.array([name]) for name in known.names]


def simulated(site: Site) -> dict[str, MitigationModel]:
    """Return the networks trained on simulated rows alone."""
    return {
        "before": network(site.before, site.seed),
        "after": network(site.after, site.seed),
    }
