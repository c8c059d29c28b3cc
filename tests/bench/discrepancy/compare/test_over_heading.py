"""What a simulated table does over headings is taken off, and no more than is plain."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import bench
from bench.discrepancy.compare.over_heading import over_heading
from bench.physics.units import Floats

LINKS = 60


def table(seed: int, links: int = LINKS, lobe_m: float = 0.1) -> pd.DataFrame:
    """Return ranges of tags on bodies, late by a lobe to one side; SIMULATED."""
    rng = np.random.default_rng(seed)
    true_m, heading_deg = rng.uniform(3, 18, links), rng.uniform(0, 360, links)
    late_m = lobe_m * (1 - np.cos(np.radians(heading_deg)))
    rows = np.repeat(np.arange(links), 4)
    return pd.DataFrame(
        {"link": [f"{seed}-{n}" for n in rows], "true_range_m": true_m[rows],
         "azimuth_deg": heading_deg[rows],
         "range_m": (true_m + late_m)[rows] + rng.normal(0, 0.03, len(rows))}
    )  # fmt: skip


def errors(frame: pd.DataFrame) -> Floats:
    return np.asarray(frame["range_m"] - frame["true_range_m"], np.float64)


def test_a_matched_row_is_turned_to_our_heading() -> None:
    ours, theirs = table(1), table(2)
    links = np.asarray(pd.factorize(theirs["link"])[0], np.intp)
    over = over_heading(ours, theirs, {"error_m": errors(theirs)}, links)
    pick = np.arange(len(theirs))[::-1].copy()
    turned = errors(theirs)[pick] + over.change(("error_m",), pick)[:, 0]
    assert np.std(turned - errors(ours)) < 0.06 < 0.09 < np.std(errors(theirs)[pick] - errors(ours))


def test_what_headings_do_not_plainly_do_is_left() -> None:
    theirs = table(2, lobe_m=0.0)
    links = np.asarray(pd.factorize(theirs["link"])[0], np.intp)
    assert not over_heading(table(1), theirs, {"error_m": errors(theirs)}, links).size


def test_a_heading_is_no_bearing() -> None:
    theirs = table(2)
    links = np.asarray(pd.factorize(theirs["link"])[0], np.intp)
    ours = table(1).drop(columns="azimuth_deg")
    assert not over_heading(ours, theirs, {"error_m": errors(theirs)}, links).size


@pytest.mark.filterwarnings("ignore")
def test_a_lobe_that_both_tables_have_is_nothing_left_out() -> None:
    assert not bench.diagnose(table(1), table(2)).selection.names
    found = bench.diagnose(table(1), table(2, lobe_m=0.0))
    assert "antenna-pattern" in found.headline
