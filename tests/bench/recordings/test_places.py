"""Drives under one link name are cut into places; what stands still is left alone."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import bench
from bench.recordings.motion import SPEED
from bench.recordings.places import PLENTY, cut_into_places, link_count

ANCHORS = np.array([[0, 0, 2.2], [12, 0, 2.4], [12, 8, 2.1], [0, 8, 2.3]])


def drive(seed: int, moved_m: float = 0.0) -> pd.DataFrame:
    """Return a tag's figure of eight among four anchors; anchor 2 stands elsewhere than said."""
    rng = np.random.default_rng(seed)
    time = np.arange(0, 150, 0.5)
    turn = 2 * np.pi * time / 75
    tag = np.column_stack([6 + 4 * np.sin(turn), 4 + 2.5 * np.sin(2 * turn), np.full(300, 0.4)])
    return pd.concat([_of_anchor(k, tag, time, rng, moved_m) for k in range(4)], ignore_index=True)


def _of_anchor(
    anchor: int, tag: np.ndarray, time: np.ndarray, rng: np.random.Generator, moved_m: float
) -> pd.DataFrame:
    said = ANCHORS[anchor]
    there = said + np.array([moved_m * (anchor == 2), 0, 0])
    true, real = (np.linalg.norm(tag - place, axis=1) for place in (said, there))
    frame = pd.DataFrame({"link": f"a{anchor}", "tx": f"a{anchor}", "rx": "tag", "time_s": time})
    for i, axis in enumerate("xyz"):
        frame[f"tx_{axis}_m"], frame[f"rx_{axis}_m"] = said[i], tag[:, i]
    measured = real + 0.025 * rng.standard_normal(len(tag))
    return frame.assign(true_range_m=true, range_m=measured)


def test_a_drive_becomes_places_and_keeps_its_speed() -> None:
    frame = drive(0)
    cut = cut_into_places(frame)
    assert 60 < link_count(cut) < 300
    spread = cut.groupby("link")[["rx_x_m", "rx_y_m"]].agg(np.ptp)
    assert (spread.to_numpy() <= 1.0).all()
    assert cut[SPEED].abs().max() > 0.1
    assert (cut["link"].str[:2] == frame["link"]).all()


def test_what_stands_still_or_has_many_links_stays_as_it_is() -> None:
    frame = drive(0)
    still = frame.assign(rx_x_m=5.0, rx_y_m=3.0)
    many = frame.assign(link=[f"l{i % PLENTY}" for i in range(len(frame))])
    for each in (still, many, frame.drop(columns="link")):
        assert cut_into_places(each) is each


def test_without_positions_the_true_range_says_where_a_row_is() -> None:
    frame = drive(0)[["link", "true_range_m", "range_m"]]
    cut = cut_into_places(frame)
    assert (cut.groupby("link")["true_range_m"].agg(np.ptp) <= 1.0).all()
    assert link_count(cut) > 4


@pytest.mark.filterwarnings("ignore")
def test_an_anchor_that_stands_elsewhere_is_found_on_a_drive() -> None:
    found = bench.diagnose(drive(1, moved_m=0.5), drive(2))
    assert found.links[0] == 4
    assert found.setup_fault is not None
    assert "a2 stands elsewhere" in str(found.setup_fault)
    assert found.confirmed.mae_after_m.value < 0.03
