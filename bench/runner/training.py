"""How a model was trained, as far as it tells: for the record of its run."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Any

from bench.results import Training


def training_of(model: Any) -> Training:
    """Return what a fitted model's `training_log_` tells; nothing where it has none.

    The log is an object with any of `engine`, `epochs` and `rows_per_second`.
    """
    log = getattr(model, "training_log_", None)
    if isinstance(log, Training):
        return log
    names = ("engine", "epochs", "rows_per_second")
    engine, epochs, rate = (getattr(log, name, None) for name in names)
    return Training(
        None if engine is None else str(engine),
        None if epochs is None else int(epochs),
        None if rate is None else float(rate),
    )


def told(training: Training) -> str:
    """Return it as JSON, to be kept beside a fit."""
    return json.dumps(asdict(training))
