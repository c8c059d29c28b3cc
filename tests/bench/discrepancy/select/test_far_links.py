"""Links far off all others are said where what is there has no name."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

import bench
from bench.discrepancy.select.far_links import _advice, _device, far_links
from bench.discrepancy.select.verdict import Unknown

CALM_M = np.linspace(-0.05, 0.05, 21)


def test_links_behind_what_nobody_listed_read_long() -> None:
    found = far_links(np.append(CALM_M, [0.4, 0.5]))
    assert found.far.tolist() == [22, 21]
    assert found.long
    assert found.worst(np.array([f"L{n}" for n in range(23)])) == "L22 (+0.50 m), L21 (+0.40 m)"


def test_links_that_read_short_as_often_are_behind_nothing() -> None:
    assert not far_links(np.append(CALM_M, [0.5, -0.5])).long


def test_one_link_alone_is_no_sort_of_links() -> None:
    assert not far_links(np.append(CALM_M, 0.5)).long


def test_half_of_the_links_are_no_exceptions() -> None:
    assert not len(far_links(np.repeat([0.0, 0.5], [11, 10])).far)


def hall(seed: int, walls: bool) -> pd.DataFrame:
    """Return ranges of 80 links; 0.3 m longer on a quarter of them where asked; SIMULATED."""
    rng = np.random.default_rng(seed)
    true_m = np.random.default_rng(3).uniform(3, 18, 80)
    late_m = np.where(np.arange(80) % 4 == 0, rng.uniform(0.25, 0.35, 80), 0) * walls
    links = np.repeat(np.arange(80), 4)
    noise_m = rng.normal(0, 0.03, 80)[links] + rng.normal(0, 0.02, len(links))
    return pd.DataFrame(
        {"link": [f"L{n}" for n in links], "true_range_m": true_m[links],
         "range_m": (true_m + late_m)[links] + noise_m}
    )  # fmt: skip


@pytest.mark.parametrize(("sight", "said"), [(None, False), (True, True), (False, False)])
def test_a_column_that_says_sight_of_what_is_in_the_way_is_doubted(
    sight: bool | None, said: bool
) -> None:
    frame = hall(1, True).assign(**({} if sight is None else {"los": sight}))
    scene = SimpleNamespace(blocked=lambda: np.full(len(frame), sight is False))
    rows: Any = SimpleNamespace(frame=frame, scene=scene)
    words = _advice(rows, np.arange(len(frame)) % 8 == 0)
    assert ("leave that column out" in words) is said
    assert "list it" in words


@pytest.mark.filterwarnings("ignore")
def test_a_diagnosis_without_a_name_lists_them() -> None:
    found = bench.diagnose(hall(1, True), hall(2, False))
    notes = [one.note for one in found.selection.verdicts if isinstance(one, Unknown)]
    if not notes:
        pytest.fail(f"something had a name, or nothing was there: {found.headline}")
    assert "links read far longer than the others" in notes[0]
    assert "list it" in notes[0]


def test_far_links_of_one_device_are_said_to_be_its() -> None:
    """Six links, two of each anchor; those of one of them are far off, or one of two each."""
    codes = np.arange(6)
    rx = ["a0", "a0", "a1", "a1", "a2", "a2"]
    rows: Any = SimpleNamespace(frame=pd.DataFrame({"tx": [f"t{n % 2}" for n in codes], "rx": rx}))
    assert "all of them are links of a1, of 2" in _device(rows, codes, np.array([3, 2]))
    assert _device(rows, codes, np.array([3, 4])) == ""
