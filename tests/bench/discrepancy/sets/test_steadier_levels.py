"""An error that follows what arrives is told over levels of links, not over their readings."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.beside_level import with_levels_of_links
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import LEVEL, Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.sets.blocks import of_library
from bench.discrepancy.sets.evidence import Evidence
from bench.discrepancy.sets.steadier_levels import over_steadier_levels
from bench.physics.effect import Effect
from bench.physics.effects.ranging.power_bias import PowerBias
from bench.physics.effects.ranging.range_scale import RangeScale

KINDS: dict[str, type[Effect]] = {"power-bias": PowerBias, "range-scale": RangeScale}
LINKS, EACH = 40, 10


def _rows(by_reading: bool) -> tuple[View, Evidence]:
    """Return rows whose errors follow the level of their link, or each its own reading."""
    rng = np.random.default_rng(4)
    true_m = np.repeat(rng.uniform(1.5, 20, LINKS), EACH)
    arrives = -62 - 20 * np.log10(true_m) + np.repeat(rng.normal(0, 1, LINKS), EACH)
    read = arrives + rng.normal(0, 2.0, len(arrives))
    error_m = 0.1 * np.tanh((-78 - (read if by_reading else arrives)) / 6)
    frame = pd.DataFrame(
        {
            "link": np.repeat([f"l{i}" for i in range(LINKS)], EACH), "true_range_m": true_m,
            "range_m": true_m + error_m + 0.02 * rng.normal(size=len(read)), "rx_power_dbm": read,
        }
    )  # fmt: skip
    frame["error_m"] = frame["range_m"] - frame["true_range_m"]
    rows = view(frame, link_codes(frame), np.arange(len(frame)), Window(), None, waveform=False)
    blocks = of_library(KINDS, rows)
    return rows, Evidence(frame["error_m"].to_numpy(), rows.links, blocks)


@pytest.mark.parametrize(("by_reading", "steadier"), [(False, {"power-bias"}), (True, set())])
def test_levels_of_links_tell_what_goes_by_what_arrives(
    by_reading: bool, steadier: set[str]
) -> None:
    rows, evidence = _rows(by_reading)
    every = np.arange(len(rows.rows))
    made = over_steadier_levels(evidence, KINDS, rows, every)
    assert set(made) == steadier
    assert not over_steadier_levels(evidence, {"range-scale": RangeScale}, rows, every)


def test_rows_of_a_link_have_one_level() -> None:
    rows, _ = _rows(False)
    level = with_levels_of_links(rows).frame[LEVEL].to_numpy()
    assert len(np.unique(np.round(level, 9))) == LINKS
    assert level.mean() == pytest.approx(rows.frame[LEVEL].mean())
