from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from recordings_factory import cells, make_recordings

from bench.errors import BenchError
from bench.recordings.table import Recordings
from bench.recordings.window import cir_window


def _ramps(lengths: list[int], first_paths: list[float]) -> Recordings:
    """Return CIRs whose samples are their own positions."""
    column = np.empty(len(lengths), dtype=object)
    column[:] = [np.arange(length, dtype=np.float32) for length in lengths]
    frame = pd.DataFrame({"error_m": 0.0, "cir": column, "first_path_index": first_paths})
    return Recordings(frame, "ramps")


def test_the_window_begins_five_samples_before_the_first_path() -> None:
    window = cir_window(_ramps([1016, 1016], [745.9, 745.0]))
    assert window.cirs.shape == (2, 157)
    assert window.cirs.dtype == np.float32
    np.testing.assert_array_equal(
        window.cirs, np.tile(np.arange(740, 897, dtype=np.float32), (2, 1))
    )
    assert window.dropped == {}


def test_rows_whose_cir_does_not_reach_are_dropped_and_counted() -> None:
    recordings = _ramps([20] * 8, [5.0, 5.9, 4.99, 13.0, 14.0, np.nan, 6.0, 7.0])
    window = cir_window(recordings, before=5, after=7)
    assert window.rows.tolist() == [0, 1, 3, 6, 7]
    assert window.cirs[:, 5].tolist() == [5, 5, 13, 6, 7]
    assert window.dropped == {
        "first path not known": 1,
        "fewer than 5 CIR samples before the first path": 1,
        "fewer than 7 CIR samples from the first path on": 1,
    }
    assert len(recordings.select(window.rows)) == len(window.cirs)


@given(st.lists(st.tuples(st.integers(30, 60), st.floats(0, 29.9)), min_size=1, max_size=20))
def test_every_kept_row_is_its_own_slice_whatever_the_lengths(rows) -> None:
    lengths, first = map(list, zip(*rows, strict=True))
    fits = [int(f) >= 3 and int(f) + 9 <= n for n, f in zip(lengths, first, strict=True)]
    if 2 * sum(fits) < len(fits):
        return
    window = cir_window(_ramps(lengths, first), before=3, after=9)
    assert window.rows.tolist() == np.flatnonzero(fits).tolist()
    for row, cir in zip(window.rows, window.cirs, strict=True):
        np.testing.assert_array_equal(cir, np.arange(int(first[row]) - 3, int(first[row]) + 9))


def test_a_table_cut_already_needs_no_first_path_index() -> None:
    recordings = make_recordings(rows=10, width=157)
    del recordings.frame["first_path_index"]
    window = cir_window(recordings)
    np.testing.assert_array_equal(window.cirs, np.stack(recordings.frame["cir"]))
    assert window.rows.tolist() == list(range(10))


def test_without_first_path_index_any_other_length_is_refused() -> None:
    recordings = make_recordings(width=160)
    del recordings.frame["first_path_index"]
    with pytest.raises(BenchError, match=r"160 samples .* CIRs of exactly 157 samples"):
        cir_window(recordings)


def test_no_cir_at_all_is_refused() -> None:
    recordings = make_recordings()
    del recordings.frame["cir"]
    with pytest.raises(BenchError, match="no column 'cir'"):
        cir_window(recordings)


def test_cirs_too_short_for_most_rows_are_refused() -> None:
    with pytest.raises(
        BenchError, match=r"60 of 60 rows are unusable .*fewer than 152 CIR samples"
    ):
        cir_window(make_recordings(width=100))


def test_more_rows_than_one_chunk(monkeypatch) -> None:
    monkeypatch.setattr("bench.recordings.window.CHUNK_ROWS", 7)
    recordings = make_recordings(rows=60, width=200, first_path=20.5)
    expected = np.stack(recordings.frame["cir"])[:, 15:172]
    np.testing.assert_array_equal(cir_window(recordings).cirs, expected)
    assert cells(expected)[3].dtype == np.float32
