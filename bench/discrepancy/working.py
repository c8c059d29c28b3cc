"""The recorded rows that a diagnosis may look at, by link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import pandas as pd

from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import (
    LinkSplit,
    Rows,
    check_rows,
    link_codes,
    split_links,
    thinned,
)
from bench.errors import about
from bench.recordings.table import Recordings

if TYPE_CHECKING:
    from bench.discrepancy.diagnosis import Options


@dataclass(frozen=True)
class WorkingRows:
    """A recorded table, split by link into what is searched, fitted and, sealed, confirmed.

    `doubtful` are columns that were guessed to be measured (see `doubtful_columns`).
    """

    recorded: Recordings
    asked: Options
    split: LinkSplit
    window: Window
    doubtful: pd.DataFrame

    @classmethod
    def of(
        cls, recorded: Recordings, asked: Options, doubtful: pd.DataFrame, window: Window
    ) -> WorkingRows:
        """Return a recorded table, split by link; `doubtful` columns of its rows take no part."""
        with about(recorded.at):
            split = split_links(recorded.frame, asked.seed)
            check_rows(split)
        return cls(recorded, asked, split, window, doubtful)

    def view(self, rows: Rows, most: int) -> View:
        """Return at most about `most` of some rows, evenly from every link."""
        codes, asked = link_codes(self.recorded.frame), self.asked
        kept = thinned(rows, codes, most)
        frame = self.recorded.frame
        return view(frame, codes, kept, self.window, asked.observables, bool(asked.waveform))

    def confirm(self) -> View:
        """Open the sealed links. Raises RuntimeError the second time."""
        return self.view(self.split.confirm.open(), self.asked.confirm_rows)
