"""Columns of the user's own: known before a range is measured, or measured with it.

Only what is known before may be searched over or matched on: a receiver's quality figure that
follows the error would otherwise "explain" it. Nobody but the user knows for sure, so there are
options for it; where they are silent a rule guesses, and the guess is printed.
"""

from __future__ import annotations

import re

import numpy as np
import pandas as pd

from bench.discrepancy.compare.settings import LEAST_STD
from bench.discrepancy.compare.shared import CATEGORIES, NUMBERS
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.covariates import MEASURED
from bench.discrepancy.settings import MEASURED_SCATTER, MEASURED_VALUES
from bench.errors import BenchError
from bench.recordings.motion import SPEED
from bench.recordings.table import FLOAT_COLUMNS, STRING_COLUMNS

STANDARD = {
    *FLOAT_COLUMNS, *STRING_COLUMNS, *NUMBERS, *CATEGORIES, *MEASURED, SPEED
}  # fmt: skip
WORDS = {
    "amplitude", "ampl", "cir", "confidence", "energy", "error", "fp", "kurtosis", "level",
    "noise", "peak", "power", "quality", "rssi", "rsl", "rtd", "rtt", "snr", "residual", "spread",
    "std", "timestamp", "tof", "ts", "bias", "correction",
    "fpindex", "ldethres", "ppampl", "rcphase", "rsmpdel", "rxpacc", "rxtofs",
}  # fmt: skip  # in the name of what a receiver reports; the last row: registers of the DW1000
STAMPS = {"ts", "timestamp", "tick", "ticks"}  # of a counter, whichever condition it is named for
CONDITIONS = {
    "age", "angle", "azimuth", "battery", "channel", "heading", "humidity", "orientation", "pitch",
    "pressure", "rain", "reply", "roll", "speed", "supply", "temp", "temperature", "time", "tx",
    "velocity", "voltage", "warmup", "wind", "yaw",
}  # fmt: skip  # in the name of what is so whatever the receiver reports, however it scatters
RULE = (
    "a column of your own is taken as measured where its name has a word of what receivers report "
    "(level, peak, quality, snr, tof, timestamp, ...) or all words of a measured column of ours "
    "(poll_preamble_count), or where it scatters from row to row of a "
    "link about as widely as over the whole table, unless it is named for a condition "
    "(temperature, humidity, supply, time, speed, ...); --measured and --known say otherwise"
)


def measured_columns(
    frame: pd.DataFrame, measured: tuple[str, ...] = (), known: tuple[str, ...] = ()
) -> tuple[str, ...]:
    """Return the columns that are measured, not known before: as said, else by `RULE`.

    Raises BenchError where a column is said to be both, or is not there.
    """
    both = sorted(set(measured) & set(known))
    if both:
        raise BenchError(f"--measured and --known both name {', '.join(both)}")
    absent = sorted({*measured, *known} - set(map(str, frame.columns)))
    if absent:
        raise BenchError(f"--measured/--known: no column {absent[0]!r} in the recorded table")
    never = sorted(set(known) & MEASURED)
    if never:
        raise BenchError(f"--known {never[0]}: is never known before a range is measured")
    own = [n for n in map(str, frame.columns) if n not in STANDARD and not n.startswith("obstacle")]
    guessed = [name for name in own if name not in known and _looks_measured(frame, name)]
    return tuple(n for n in dict.fromkeys([*measured, *guessed]) if n not in MEASURED)


def _of_standard(words: set[str]) -> bool:
    """Return whether a name holds that of a measured column: poll_preamble_count, range_raw_m."""
    names = (_words(name) for name in MEASURED - {"link", "cir", "sample_period_ns"})
    return "true" not in words and any(name <= words for name in names)


def doubtful_columns(measured: tuple[str, ...], said: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Return those of the measured columns that only their scatter speaks for, no name.

    `said` are those that the user said are measured.
    """
    guessed = (name for name in measured if name not in said)
    return tuple(n for n in guessed if not (WORDS & _words(n) or _of_standard(_words(n))))


def _words(name: str) -> set[str]:
    return set(re.split(r"[^a-z]+", name.lower()))


def _looks_measured(frame: pd.DataFrame, name: str) -> bool:
    """Return whether the rule takes a column as measured."""
    if not pd.api.types.is_numeric_dtype(frame[name]):
        return False
    words = _words(name)
    if STAMPS & words or _of_standard(words):
        return True
    return not CONDITIONS & words and (bool(WORDS & words) or _scatters(frame, name))


def _scatters(frame: pd.DataFrame, name: str) -> bool:
    """Return whether rows of one link, one after the other, differ like rows of any."""
    value = numeric(frame, name)
    value = np.where(np.isfinite(value), value, np.nan)
    if len(np.unique(value[np.isfinite(value)])) < MEASURED_VALUES * len(value):
        return False
    steps = pd.Series(value).groupby(frame["link"].astype(str).to_numpy()).diff().to_numpy()
    whole = float(np.nanvar(value))
    known = steps[np.isfinite(steps)]
    return len(known) > 0 and float(np.mean(known**2)) / 2 > MEASURED_SCATTER * max(
        whole, LEAST_STD
    )
