"""What every model must keep to: rows in, metres out, and one module that says the same."""

from __future__ import annotations

from typing import Any

import numpy as np

from bench.checks.expect import expect
from zoo.base import Floats, MitigationModel

WIDTH = 157
SAME_M = 1e-4  # between predict and the module, in metres


def check_model(model: MitigationModel, width: int = WIDTH) -> None:
    """Fit a copy of a model on made-up CIRs and check the interface the harness relies on.

    Predictions are float32 metres, the same again and of a fit made again; `to_module` says the
    same; a kept state gives the model back; nothing the constructor took has changed.
    """
    from sklearn.base import clone

    X, y = sample_rows(400, width)
    before = repr(sorted(model.get_params().items()))
    fitted, again = (clone(model).fit(X, y) for _ in range(2))
    expect(repr(sorted(fitted.get_params().items())) == before, "fit changes a parameter")
    expect(getattr(fitted, "n_features_in_", None) == width, "fit does not set n_features_in_")
    said = fitted.predict(X)
    check_answer(said, len(X))
    expect(bool(np.array_equal(said, again.predict(X))), "two fits of the same rows differ")
    check_module(fitted, X)
    check_state(fitted, clone(model), X)


def sample_rows(rows: int, width: int = WIDTH, seed: int = 1) -> tuple[Floats, Floats]:
    """Return CIRs [rows, width] in counts and errors [rows] in metres with something to learn."""
    rng = np.random.default_rng(seed)
    cirs = rng.rayleigh(300.0, (rows, width))
    errors_m = 0.2 + 0.0005 * (cirs[:, 7] - cirs[:, 4]) + rng.normal(0.0, 0.02, rows)
    return cirs.astype(np.float32), errors_m.astype(np.float32)


def check_answer(said: Any, rows: int) -> None:
    """Check that an answer is one finite float32 per row."""
    expect(isinstance(said, np.ndarray), f"predict gave {type(said).__name__}, expected an array")
    expect(said.shape == (rows,), f"predict gave shape {said.shape}, expected ({rows},)")
    expect(said.dtype == np.float32, f"predict gave {said.dtype}, expected float32")
    expect(bool(np.isfinite(said).all()), "predict gave what is no number")


def check_module(fitted: MitigationModel, X: Floats) -> None:
    """Check that the module that backends export says what the model says."""
    import torch

    module = fitted.to_module()
    expect(not module.training, "to_module gave a module in training mode, expected eval")
    with torch.inference_mode():
        told = module(torch.from_numpy(X)).numpy()
    apart_m = float(np.abs(told - fitted.predict(X)).max())
    expect(apart_m <= SAME_M, f"to_module and predict differ by {apart_m:g} m")


def check_state(fitted: MitigationModel, fresh: MitigationModel, X: Floats) -> None:
    """Check that a model is what it was after its state was kept; models may keep none."""
    state = fitted.fitted_state()
    if state is None:
        return
    plain = all(isinstance(value, np.ndarray | np.generic) for value in state.values())
    expect(plain, "fitted_state holds what is no array")
    expect(not fresh.restore_state({}), "restore_state took an empty state")
    expect(fresh.restore_state(state), "restore_state refuses what fitted_state gave")
    expect(bool(np.array_equal(fresh.predict(X), fitted.predict(X))), "a kept state differs")
