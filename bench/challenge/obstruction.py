"""Which links are obstructed: the diagnosed simulator with and without the obstacle, link by link.

Every link is simulated at its own geometry, obstructed in one half of the replicates and clear in
the other. A logistic regression learns from these SIMULATED links alone what tells the two apart;
applied to the recorded links it gives each one's log odds of being obstructed. No label is used.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added, Comparison, View, swapped
from bench.physics.effect import Effect

Floats = NDArray[np.float64]
MEMBERS = 24
FIRST = 9000  # replicates of their own
FIGURES = (
    "error_m",
    "rx_power_dbm",
    "first_path_power_dbm",
    "first_path_lead_ns",
    "rise_time_ns",
    "mean_excess_delay_ns",
)
PENALTY = 0.1  # inverse strength of the ridge: few, overlapping figures


def obstructing(added: Added) -> Effect | None:
    """Return the effect among `added` that strikes a share of the links, None without one."""
    struck = [e for e in added if type(e).per_link and type(e).strikes is not None]
    return struck[0] if struck else None


def link_log_odds(comparison: Comparison, view: View, added: Added) -> pd.Series | None:
    """Return per link (index: its name) the log odds of being obstructed, prior odds even.

    None where `added` holds no effect that obstructs a share of the links. `view` are recorded
    rows; those of a link are averaged, so a few per link are enough.
    """
    effect = obstructing(added)
    if effect is None:
        return None
    clear, struck = (
        comparison.ensemble(view, _with_share(added, effect, share), MEMBERS, FIRST)
        for share in (0.0, 1.0)
    )
    recorded, X, y = _figures(clear, struck)
    model = _learnt(X, y)
    names = view.frame.groupby(view.links)["link"].first().to_numpy()
    return pd.Series(model.decision_function(recorded), index=names, name="log_odds")


def _with_share(added: Added, effect: Effect, share: float) -> Added:
    """Return the effects with the obstruction striking that share of the links."""
    named = type(effect).strikes
    assert named is not None
    changed: Any = replace(effect, **{named[0]: share})
    return swapped(added, changed)


def _figures(clear: Ensemble, struck: Ensemble) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Return link means of the recorded rows [L, q], of simulated ones [2 m L, q] and 0/1 [2 m L].

    All relative to the clear simulation of the same link, in units of its scatter, so what the
    geometry alone does is no sign of an obstacle.
    """
    names = [n for n in FIGURES if n in clear.names and n in struck.names]
    parts = [_link_means(part, names) for part in (clear, struck)]
    centre = np.nanmean(parts[0][1:], axis=0)
    scale = np.nanstd(np.concatenate([part[1:] for part in parts]) - centre, axis=(0, 1))
    standard = [np.nan_to_num((part - centre) / np.maximum(scale, 1e-9)) for part in parts]
    X = np.concatenate([part[1:].reshape(-1, len(names)) for part in standard])
    y = np.repeat([0, 1], len(X) // 2)
    return standard[0][0], X, y


def _link_means(ensemble: Ensemble, names: list[str]) -> Floats:
    """Return the means over the rows of each link [1 + m, L, q], NaN where none is known."""
    which = [ensemble.names.index(name) for name in names]
    values = ensemble.versions[..., which]
    code = np.unique(ensemble.links, return_inverse=True)[1]
    known = np.isfinite(values)
    sums = np.zeros((len(values), int(code.max()) + 1, len(which)))
    counts = np.zeros_like(sums)
    for version, row in enumerate(values):
        np.add.at(sums[version], code, np.nan_to_num(row))
        np.add.at(counts[version], code, known[version])
    return np.where(counts > 0, sums / np.maximum(counts, 1), np.nan)


def _learnt(X: Floats, y: NDArray[np.int64]) -> Any:
    """Return the classifier of simulated links."""
    from sklearn.linear_model import LogisticRegression

    return LogisticRegression(C=PENALTY).fit(X, y)
