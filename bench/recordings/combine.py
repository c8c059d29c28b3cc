"""Several data sets as one table, to train on some and test on another.

Kept are the columns of the exchange format that every one of them has: what one lacks none has,
or a model could tell the data sets apart by what is missing. Each row gets `data_set`, the name
of where it comes from, and links are called NAME: LINK.
"""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from bench.recordings.table import FLOAT_COLUMNS, STRING_COLUMNS, Recordings

DATA_SET = "data_set"
_KEPT = (
    *FLOAT_COLUMNS, *STRING_COLUMNS, "cir", "los", "obstacles",
    "channel", "prf_mhz", "tx_power_dbm", "peak_ampl",
)  # fmt: skip
_TELLING = ("true_range_m", "first_path_index", "first_path_power_dbm", "rx_power_dbm", "fp_ampl1")


def combine(parts: Mapping[str, Recordings], name: str) -> Recordings:
    """Return the rows of every part, in order, as recordings called `name`.

    `simulated` where the part of that name is, or where there is none, where any is. Raises
    BenchError where a part has no link or no range error.
    """
    frames = [_with_errors(part).assign(**{DATA_SET: source}) for source, part in parts.items()]
    common = [column for column in _KEPT if all(column in frame for frame in frames)]
    frame = pd.concat([frame[[*common, DATA_SET]] for frame in frames], ignore_index=True)
    link = frame[DATA_SET] + ": " + frame["link"].astype("str")
    made = _simulator(parts, name)
    licences = ", ".join(dict.fromkeys(part.licence for part in parts.values()))
    dropped = {f"{n}: {why}": c for n, part in parts.items() for why, c in part.dropped.items()}
    return Recordings(frame.assign(link=link), name, licences, made, None, dropped)


def _with_errors(part: Recordings) -> pd.DataFrame:
    """Return a part's rows with `error_m`, columns without any value left out."""
    part.require("link")
    frame = part.frame.assign(error_m=part.errors_m())
    return frame[[column for column in frame if column == "cir" or frame[column].notna().any()]]


def _simulator(parts: Mapping[str, Recordings], name: str) -> str | None:
    """Return what simulated the rows, None for real ones."""
    asked = [parts[name]] if name in parts else list(parts.values())
    return next((part.simulator for part in asked if part.simulated), None)


def shared_rows(first: Recordings, second: Recordings) -> float:
    """Return the share of the rows of `second` that `first` holds too.

    Rows are the same where truth, first path and levels are, as far as both tables have these;
    0 where they have fewer than three of them, or rows repeat: nothing is told by them then.
    """
    common = [c for c in _TELLING if c in first.frame and c in second.frame]
    if len(common) < 3:
        return 0.0
    ours, theirs = (part.frame[common].round(6).dropna() for part in (first, second))
    if not len(theirs) or theirs.duplicated().mean() > 0.5:
        return 0.0
    found = theirs.merge(ours.drop_duplicates(), on=common)
    return len(found) / len(second.frame)
