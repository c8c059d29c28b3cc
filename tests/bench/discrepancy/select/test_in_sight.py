"""Links that are struck where the table says line of sight: no name, but said."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import bench
from bench.discrepancy.select.verdict import Unknown


def hall(seed: int, struck: bool) -> pd.DataFrame:
    """Return ranges of 100 links in sight, a quarter of them blocked where asked; SIMULATED."""
    places = np.random.default_rng(3).uniform([1, 1, 1.0], [19, 11, 2.5], (100, 2, 3))
    rng = np.random.default_rng(seed)
    true_m = np.linalg.norm(places[:, 0] - places[:, 1], axis=1)
    late_m = np.where(np.arange(100) % 4 == 0, rng.exponential(1.0, 100), 0) * struck
    links = np.repeat(np.arange(100), 4)
    ends = {"tx": places[links, 0], "rx": places[links, 1]}
    at = {f"{end}_{axis}_m": ends[end][:, i] for end in ends for i, axis in enumerate("xyz")}
    return pd.DataFrame(
        {"link": [f"L{n}" for n in links], "true_range_m": true_m[links], "los": True,
         "range_m": (true_m + late_m)[links] + rng.normal(0, 0.03, len(links)), **at}
    )  # fmt: skip


@pytest.mark.filterwarnings("ignore")
def test_links_that_are_struck_in_sight_are_said() -> None:
    recorded, simulated = hall(1, True), hall(2, False)
    found = bench.diagnose(recorded, simulated)
    notes = [one.note for one in found.selection.verdicts if isinstance(one, Unknown)]
    assert notes
    assert "links are struck as by blocked-path" in notes[-1]
    assert "los says line of sight" in notes[-1]
    assert not found.selection.names
    blind = bench.diagnose(recorded.drop(columns="los"), simulated.drop(columns="los"))
    assert "blocked-path" in blind.headline
