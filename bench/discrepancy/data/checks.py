"""Bad input, found before anything is fitted: one clear line each."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.data.columns import WAVES, numeric
from bench.discrepancy.data.figures import check_figures, typical
from bench.discrepancy.data.observables import after_first, error_m, reach
from bench.discrepancy.data.settings import (
    FULL_TURN_DEG,
    LONGEST_MEDIAN_RANGE_M,
    SAME_PERIOD,
    SAME_RANGE_M,
    SAMPLE_PERIOD_NS,
    SHORTEST_MEDIAN_RANGE_M,
    SIGN_TURNED,
    STUCK_APART_M,
    STUCK_ROWS,
    TURNS,
    UNIT_MISTAKE,
)
from bench.discrepancy.data.truth import check_positive, check_truth
from bench.discrepancy.settings import WINDOW_AFTER
from bench.errors import BenchError
from bench.recordings.places import distance_m
from bench.recordings.table import Recordings


def check_tables(recorded: Recordings, simulated: object, waveforms: bool = True) -> None:
    """Raise BenchError where recordings cannot be diagnosed, or not beside this simulated table.

    Waveforms of another sample period have other edges, tails and noise: what differs by that
    alone would be called physics. Not so where no `waveforms` are compared.
    """
    check_recorded(recorded)
    tables = [one for one in (recorded, simulated) if isinstance(one, Recordings)]
    for table in tables if waveforms else ():
        _check_reach(table)
    if not isinstance(simulated, Recordings):
        return
    check_figures(simulated.frame, simulated.at)
    _check_copies(recorded, simulated)
    _check_headings(recorded, simulated)
    both = all({"cir", "sample_period_ns"} <= {*one.frame} for one in tables)
    if waveforms and both:
        _check_periods(recorded, simulated)


def _check_reach(table: Recordings) -> None:
    """Raise where waveforms end so soon after the first path that there is little to compare."""
    if not set(WAVES) <= {*table.frame}:
        return
    after, least = reach(table.frame)[1], WINDOW_AFTER[0]
    if after < least:
        raise BenchError(
            f"{table.at}: its CIRs hold {max(after, 0):.0f} samples from first_path_index on"
            f"{_short_rows(table.frame, least)}; expected {least} or more to compare waveforms: "
            "give longer ones, or --paths-only to compare ranges and levels"
        )


def _short_rows(frame: pd.DataFrame, least: int) -> str:
    """Return which rows hold fewer samples from their first path on, in words; "" where all do."""
    short = np.flatnonzero(after_first(frame) < least)
    if len(short) == len(frame):
        return ""
    return f" in {len(short)} of {len(frame)} rows (the first: row {short[0]}), mend or drop them"


def _check_copies(recorded: Recordings, simulated: Recordings) -> None:
    """Raise where the simulated ranges are the recorded ones, row by row."""
    mine, other = (error_m(table.frame) for table in (recorded, simulated))
    same = len(mine) == len(other) and np.allclose(mine, other, 0, SAME_RANGE_M, equal_nan=True)
    if np.isfinite(mine).any() and same:
        raise BenchError(
            f"{simulated.at}: its ranges are those of {recorded.at}, row by row: expected "
            "a table that was simulated, with noise of its own"
        )


def _check_headings(recorded: Recordings, simulated: Recordings) -> None:
    """Raise where one table's headings turn by radians and the other's by degrees."""
    seen = {t.at: _known(numeric(t.frame, "azimuth_deg")) for t in (recorded, simulated)}
    if len(seen) < 2 or not all(len(heading) for heading in seen.values()):
        return
    (less, few), (more, many) = sorted(seen.items(), key=lambda one: float(np.ptp(one[1])))
    turn = 2 * np.pi
    if (
        np.abs(few).max() <= turn
        and np.ptp(few) > TURNS * turn
        and np.ptp(many) > TURNS * FULL_TURN_DEG
    ):
        raise BenchError(
            f"{less}: azimuth_deg goes from {few.min():.3g} to {few.max():.3g}, in {more} from "
            f"{many.min():.4g} to {many.max():.4g}: radians; expected degrees in both"
        )


def _known(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the values that are known."""
    return values[np.isfinite(values)]


def _check_periods(recorded: Recordings, simulated: Recordings) -> None:
    """Raise where two tables sample waveforms at other periods."""
    mine, other = (typical(table.frame, "sample_period_ns") for table in (recorded, simulated))
    if abs(np.log(mine / other)) > SAME_PERIOD:
        raise BenchError(
            f"{simulated.at}: sample_period_ns is {other:.4g}, but {mine:.4g} in "
            f"{recorded.at}: waveforms are compared at one period only: resample the "
            "simulated ones, or leave their column 'cir' out to compare ranges"
        )


def check_recorded(recorded: Recordings) -> None:
    """Raise BenchError where a recorded table cannot be diagnosed, naming column and expectation.

    Looks for: no rows, no truth, no link column, units off by 1000, a range that never changes,
    figures beyond any instrument, time going backwards.
    """
    frame, source = recorded.frame, recorded.at
    if not len(frame):
        raise BenchError(f"{source}: the table has no rows")
    check_positive(recorded)
    if "link" not in frame:
        raise BenchError(
            f"{source}: no column 'link': expected a name for every pair of antenna positions, "
            "whose rows are held out together"
        )
    if not np.isfinite(error_m(frame)).any() and "cir" not in frame:
        raise BenchError(
            f"{source}: no truth: expected 'error_m', or 'range_m' and 'true_range_m', with values"
        )
    if "true_range_m" not in frame and "tx_x_m" not in frame:
        raise BenchError(f"{source}: no column 'true_range_m' and no antenna positions")
    _check_names(frame, source)
    _check_units(frame, source)
    _check_stuck(frame, source)
    check_figures(frame, source)
    _check_time(frame, source)


def _check_stuck(frame: pd.DataFrame, source: str) -> None:
    """Raise where the range is one value in many rows though antennas are not always as far."""
    if not {"range_m", "true_range_m"} <= set(frame):
        return
    range_m, true_m = (numeric(frame, name) for name in ("range_m", "true_range_m"))
    known = np.isfinite(range_m) & np.isfinite(true_m)
    if known.sum() < STUCK_ROWS or np.ptp(range_m[known]) > 0:
        return
    if (apart := float(np.ptp(true_m[known]))) > STUCK_APART_M:
        raise BenchError(
            f"{source}: range_m is {range_m[known][0]:g} m in every row while true ranges differ "
            f"by up to {apart:.3g} m: a receiver that is stuck; expected a measurement in each"
        )


def _check_names(frame: pd.DataFrame, source: str) -> None:
    """Raise where the devices of one end are named and those of the other in no row."""
    named = {end: bool(frame[end].notna().any()) for end in ("tx", "rx") if end in frame}
    if len(set(named.values())) > 1:
        empty = next(end for end, known in named.items() if not known)
        raise BenchError(
            f"{source}: column {empty!r} is empty in every row: expected the names of devices at "
            "both ends; leave the column out where they are not known"
        )


def _check_units(frame: pd.DataFrame, source: str) -> None:
    """Raise where lengths look like millimetres or kilometres, or the period like picoseconds."""
    truth = numeric(frame, "true_range_m")
    middle = float(np.nanmedian(truth)) if np.isfinite(truth).any() else 1.0
    if middle > LONGEST_MEDIAN_RANGE_M or middle < SHORTEST_MEDIAN_RANGE_M:
        raise BenchError(
            f"{source}: the median of true_range_m is {middle:.4g} m: expected metres "
            "(millimetres or kilometres?)"
        )
    measured_m = numeric(frame, "range_m")
    with np.errstate(divide="ignore", invalid="ignore"):  # antennas may touch
        ratio = float(np.nanmedian(measured_m / truth)) if np.isfinite(measured_m).any() else 1.0
    if ratio > UNIT_MISTAKE or 0 < ratio < 1 / UNIT_MISTAKE:
        raise BenchError(f"{source}: range_m is {ratio:.3g} times true_range_m: expected metres")
    if ratio < 0 and _falls(measured_m, truth):
        raise BenchError(
            f"{source}: range_m is below zero and falls where true_range_m grows: expected "
            "distances in metres (is its sign turned?)"
        )
    _check_positions(frame, source)
    check_truth(frame, source)
    period = typical(frame, "sample_period_ns")
    if not SAMPLE_PERIOD_NS[0] <= period <= SAMPLE_PERIOD_NS[1]:
        raise BenchError(f"{source}: sample_period_ns is {period:.4g}: expected nanoseconds")


def _falls(measured_m: NDArray[np.float64], truth_m: NDArray[np.float64]) -> bool:
    """Return whether measured ranges [n] go down as true ones go up; a long delay keeps them up."""
    known = np.isfinite(measured_m) & np.isfinite(truth_m)
    return bool(pd.Series(measured_m[known]).corr(pd.Series(truth_m[known])) < SIGN_TURNED)


def _check_positions(frame: pd.DataFrame, source: str) -> None:
    """Raise where antennas are a thousand times as far from each other as they truly are."""
    between_m = distance_m(frame)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = between_m / numeric(frame, "true_range_m")
    known = ratios[np.isfinite(ratios)]
    ratio = float(np.median(known)) if len(known) else 1.0
    if ratio > UNIT_MISTAKE or 0 < ratio < 1 / UNIT_MISTAKE:
        raise BenchError(
            f"{source}: the positions tx_x_m .. rx_z_m are {ratio:.3g} times true_range_m apart: "
            "expected metres (are they millimetres?)"
        )


def _check_time(frame: pd.DataFrame, source: str) -> None:
    """Raise where time runs backwards between rows of one link and pair of devices."""
    time = numeric(frame, "time_s")
    if not np.isfinite(time).any():
        return
    keys = [name for name in ("link", "tx", "rx", "los") if name in frame]
    of = [frame[name].astype(object).to_numpy() for name in keys]
    steps = pd.Series(time).groupby(of, dropna=False, sort=False).diff()
    back = np.flatnonzero(steps.to_numpy() < 0)
    if len(back):
        row = int(back[0])
        raise BenchError(
            f"{source}: time_s goes backwards at row {row} "
            f"({-float(steps.iloc[row]):.4g} s, link {frame['link'].iloc[row]!r}); "
            "expected rows of a link in the order they were recorded: sort by link and time_s; "
            "where a clock was reset, or two recordings share a link's name, give each part a "
            "link of its own; drop rows that are there twice"
        )
