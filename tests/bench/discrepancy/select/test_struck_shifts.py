"""A blocked path is told where a user's own simulator makes ranges that follow no path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
import pytest

import bench
from bench.discrepancy.select.verdict import Ambiguous, LeftOut
from bench.physics import Base, Batch, Draws, Effect, Simulator


@dataclass(frozen=True)
class OwnRanges(Effect):
    """Ranges of a simulator of the user's own, in the place of the base's."""

    name = "own-ranges"
    stage = "ranging"
    source = "a test"
    first = True
    fitted = False

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Overrule what the paths give."""
        made = batch.rows.true_range_m + 0.04 + 0.02 * draws.normal(len(batch))
        return batch.longer(made - batch.range_m)


def church(seed: int) -> pd.DataFrame:
    """Return ranges of 120 links, a third of them 0.7 m long; SIMULATED."""
    rng = np.random.default_rng(seed)
    places = rng.uniform([1, 1, 1.0], [24, 14, 6], (120, 2, 3))
    true_m = np.linalg.norm(places[:, 0] - places[:, 1], axis=1)
    late_m = np.where(np.arange(120) % 3 == 0, np.abs(rng.normal(0.7, 0.2, 120)), 0)
    links = np.repeat(np.arange(120), 3)
    ends = {"tx": places[links, 0], "rx": places[links, 1]}
    at = {f"{end}_{axis}_m": ends[end][:, i] for end in ends for i, axis in enumerate("xyz")}
    range_m = (true_m + late_m)[links] + 0.04 + rng.normal(0, 0.02, len(links))
    return pd.DataFrame(
        {"link": [f"L{n}" for n in links], "true_range_m": true_m[links], "range_m": range_m, **at}
    )


@pytest.mark.filterwarnings("ignore")
def test_links_that_are_late_are_blocked_though_the_simulator_cannot_say_so() -> None:
    own = Simulator(Base(), (OwnRanges(),), name="own")
    found = bench.diagnose(church(1), own)
    assert "blocked-path" in found.headline
    (said,) = [one for one in found.selection.verdicts if "blocked-path" in one.names]
    first = said.options[0] if isinstance(said, Ambiguous) else said
    assert isinstance(first, LeftOut)
    sizes = {one.name: one for one in first.parameters}
    assert sizes["share"].value == pytest.approx(1 / 3, abs=0.12)
    assert 0.4 < sizes["detour_m"].value < 1.2
