"""A tiny table whose errors can be learnt."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.recordings.table import Recordings


def tiny(rows_per_link: int = 12, links: int = 12, seed: int = 0) -> Recordings:
    """Noise CIRs whose first-path amplitude falls with the error, so that a model can learn."""
    rng = np.random.default_rng(seed)
    n = rows_per_link * links
    error_m = rng.gamma(2.0, 0.06, n)
    cirs = np.abs(rng.normal(0, 60, (n, 157)))
    pulse = np.exp(-(((np.arange(157) - 6) / 1.6) ** 2))
    cirs += 12000 * np.exp(-4 * error_m)[:, None] * pulse
    true_m = rng.uniform(1, 8, n)
    frame = pd.DataFrame(
        {
            "range_m": true_m + error_m,
            "true_range_m": true_m,
            "error_m": error_m,
            "cir": list(cirs.astype(np.float32)),
            "first_path_index": np.full(n, 5.2),
            "los": np.repeat(np.arange(links) % 3 == 0, rows_per_link),
            "environment": np.repeat(np.where(np.arange(links) % 2, "a", "b"), rows_per_link),
            "link": np.repeat([f"l{i}" for i in range(links)], rows_per_link),
        }
    )
    return Recordings(frame, source="tiny", simulator="noise, for tests", seed=seed)
