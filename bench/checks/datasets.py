"""What every data set must keep to: it says what is missing, and gives rows that can be split."""

from __future__ import annotations

import numpy as np

from bench.checks.expect import expect
from bench.recordings.sources.base import Source
from bench.recordings.table import Recordings


def check_dataset(source: Source) -> None:
    """Check a data set; of one that is not here, that it says what is missing."""
    expect(isinstance(source, Source), f"got {type(source).__name__}, expected a Source")
    for what in ("name", "title", "licence"):
        expect(bool(getattr(source, what, "")), f"a data set needs a {what}")
    missing = source.available()
    if missing is None:
        check_rows(source, source.load())
    else:
        expect(len(missing) > 10, f"available() gave {missing!r}: expected what is missing, where")


def check_rows(source: Source, recordings: Recordings) -> None:
    """Check the rows of a data set: errors in metres, links, and simulated ones marked."""
    expect(len(recordings) > 0, "load() gave no rows")
    expect(bool(np.isfinite(recordings.errors_m()).all()), "an error is no number")
    expect("link" in recordings.frame, "no column 'link': rows could not be split by link")
    expect(recordings.simulated == source.simulated, "simulated rows must be marked, others not")
