"""Rows of strangers are counted and shown."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from bench.discrepancy.data.own_link import far_off_their_link
from bench.recordings.table import Recordings


def ranges(seed: int, strangers: int = 0, of_link: int = 5) -> Recordings:
    """Return ranges of 40 links, some rows of which are another link's; SIMULATED."""
    rng, link = np.random.default_rng(seed), np.repeat(np.arange(40), of_link)
    true_m, kept = (5.0 + np.arange(40) / 2)[link], rng.normal(0, 0.3, 40)[link]
    measured = true_m + kept + 0.03 * rng.standard_t(4, len(link))
    rows = rng.choice(len(link), strangers, replace=False)
    measured[rows] = rng.permutation(measured)[rows] + 4
    frame = pd.DataFrame({"link": link.astype(str), "true_range_m": true_m, "range_m": measured})
    return Recordings(frame, "a test")


def test_answers_of_strangers_are_counted_and_shown() -> None:
    said = far_off_their_link(ranges(1, strangers=6), ranges(2))
    assert said.startswith("6 of 200 recorded rows lie more than 0.5 m off the median of their own")
    assert "(0.00% of the simulated ones do): rows " in said


def test_nothing_is_said_of_what_links_keep_of_few_rows_or_of_what_is_simulated_as_well() -> None:
    assert far_off_their_link(ranges(1), ranges(2)) == ""
    assert far_off_their_link(ranges(1, strangers=6, of_link=2), ranges(2)) == ""
    assert far_off_their_link(ranges(1, strangers=6), ranges(2, strangers=6)) == ""
    bare = ranges(1)
    assert far_off_their_link(replace(bare, frame=bare.frame[["link"]]), bare) == ""
