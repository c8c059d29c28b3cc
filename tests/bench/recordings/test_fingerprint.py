"""The fingerprint of recordings changes with whatever is changed in them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from recordings_factory import make_recordings

from bench.recordings import read_recordings, write_recordings
from bench.recordings.table import Recordings

OTHER = {
    "range_m": 1.234,
    "link": "link-other",
    "environment": "elsewhere",
    "obstacles": ["door"],
    "los": None,  # the opposite, see below
}


def changed(table: Recordings, column: str) -> Recordings:
    """Return the table with one cell of one column changed."""
    frame = table.frame.copy()
    frame.at[3, column] = not frame.at[3, column] if column == "los" else OTHER[column]
    return replace(table, frame=frame)


@pytest.mark.parametrize("column", list(OTHER))
@pytest.mark.parametrize("from_disk", [False, True])
def test_one_cell_changes_it(column: str, from_disk: bool, tmp_path: Path) -> None:
    table = make_recordings()
    if from_disk:
        write_recordings(table, tmp_path / "table.parquet")
        table = read_recordings(tmp_path / "table.parquet")
    assert changed(table, column).fingerprint != table.fingerprint


def test_one_sample_of_one_cir_changes_it() -> None:
    table = make_recordings()
    frame = table.frame.copy()
    cir = frame.at[5, "cir"].copy()
    cir[100] = np.nextafter(cir[100], np.float32(np.inf))
    frame.at[5, "cir"] = cir
    assert replace(table, frame=frame).fingerprint != table.fingerprint


def test_names_and_the_order_of_rows_change_it_and_the_same_table_does_not() -> None:
    table = make_recordings()
    renamed = replace(table, frame=table.frame.rename(columns={"obstacles": "what"}))
    turned = replace(table, frame=table.frame.iloc[::-1].reset_index(drop=True))
    assert len({table.fingerprint, renamed.fingerprint, turned.fingerprint}) == 3
    assert make_recordings().fingerprint == table.fingerprint
