"""UWB channel impulse responses registered in a furnished apartment (Kolakowski 2021).

Zenodo 10.5281/zenodo.4742391, CC BY 4.0. Two EVK1000 boards, channel 2, PRF 64 MHz, preamble 1024,
110 kb/s; anchor and tag stand still during a log, so a log is a link. Files: `N.log` (DecaRanging
text, see `decaranging`), `anchors.csv` and `tags.csv` (positions in metres in one plane),
`pairs.csv` (log -> anchor, tag), `labels.csv` (LOS, NLOS, NDP NLOS = no direct path detected).

How frames and ranges are matched. In each double-sided exchange the anchor receives the tag's poll
and final, each with the accumulator, and then prints `Dist`. One row is one printed range with the
final's accumulator and levels: the last frame before the range. The poll's first path and levels
stand beside it (`poll_*`), its accumulator is left out, since one row is one measurement. (The
range depends on both arrivals, with weights 0.29 for the poll and 0.21 for the final.) Frames that
led to no range give no row; a range without a frame is dropped and counted.

Columns: `range_m` = `Dist`, which includes the program's power-dependent correction (`range_m` =
`range_raw_m` - `bias_correction_m`); `true_range_m` = distance in the plane; `first_path_index` =
HLP; `preamble_count` = PSC; `rx_power_dbm` = RSL; `first_path_power_dbm` = FSL; `noise_std` =
standard deviation of the CIR magnitude up to 64 samples before the first path; `los_class` = the
label as published; `clock_offset_ppm` as printed: positive where the tag's clock, the initiator's,
runs fast, so that single-sided ranging would read long by c/2 x reply time x offset (agrees with
the four intervals to 0.0005 ppm); `reply_time_s` = Db, the anchor's; `time_s` = reception of the
final since the log's first one, unwrapped from the 17.2 s counter (a gap without any range of more
than 17.2 s loses whole turns); `Ra_ticks`, `Db_ticks`, `Rb_ticks`, `Da_ticks` = the intervals, in
ticks of 1/(128 x 499.2 MHz).
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bench.errors import BenchError
from bench.recordings.clean import Cleaned, add_counts, clean
from bench.recordings.noise import noise_std
from bench.recordings.readers.decaranging import Log, Range, accumulator, parse_log
from bench.recordings.table import SAMPLE_PERIOD_NS
from bench.recordings.twr import COUNTER_TURN_S, TICK_S

TABLES = {
    "anchors.csv": ("location", "x", "y"),
    "tags.csv": ("location", "x", "y"),
    "pairs.csv": ("file_number", "anchor_location", "tag_location"),
    "labels.csv": ("file_id", "label"),
}
_LABELS = {"LOS": True, "NLOS": False, "NDP NLOS": False}
MODULES = (
    __name__,
    "bench.recordings.readers.decaranging",
    "bench.recordings.clean",
    "bench.recordings.noise",
    "bench.recordings.twr",
)


def read_apartment(logs: list[Path], tables: Mapping[str, Path]) -> Cleaned:
    """Return the ranges of some logs (environment: apartment).

    `tables` gives the paths of anchors, tags, pairs and labels.csv by name. Raises BenchError
    where a log has no row in them, or a file is not as published.
    """
    sites = _links({name: _read_table(path) for name, path in tables.items()})
    dropped: dict[str, int] = {}
    frames = []
    for path in logs:
        if path.stem not in sites:
            raise BenchError(f"{path}: no row for log {path.stem} in pairs.csv and labels.csv")
        log = parse_log(path)
        if log.without_frame:
            dropped = add_counts(dropped, {"range without a frame": log.without_frame})
        frames.append(_log_frame(log, sites[path.stem]))
    cleaned = clean(pd.concat(frames, ignore_index=True), "apartment")
    return Cleaned(cleaned.frame, add_counts(dropped, cleaned.dropped))


def _read_table(path: Path) -> pd.DataFrame:
    """Return one of the small tables. Raises BenchError where a column is missing."""
    try:
        table = pd.read_csv(path)
    except (OSError, ValueError) as problem:
        raise BenchError(f"{path}: cannot be read: {problem}") from problem
    for column in TABLES[path.name]:
        if column not in table:
            have = ", ".join(map(str, table.columns))
            raise BenchError(f"{path}: no column {column!r} (it has: {have})")
    return table


def _links(tables: dict[str, pd.DataFrame]) -> dict[str, dict[str, Any]]:
    """Return what is known of each log's link, by the log's number."""
    pairs = tables["pairs.csv"].merge(
        tables["anchors.csv"], left_on="anchor_location", right_on="location"
    )
    pairs = pairs.merge(
        tables["tags.csv"], left_on="tag_location", right_on="location", suffixes=("_rx", "_tx")
    )
    pairs = pairs.merge(tables["labels.csv"], left_on="file_number", right_on="file_id")
    return {str(row["file_number"]): _link(row) for row in pairs.to_dict("records")}


def _link(row: dict[Any, Any]) -> dict[str, Any]:
    """Return the columns that are the same in every row of a link."""
    if row["label"] not in _LABELS:
        expected = ", ".join(_LABELS)
        raise BenchError(f"labels.csv: unknown label {row['label']!r}; expected {expected}")
    anchor, tag = row["anchor_location"], row["tag_location"]
    return {
        "environment": "apartment",
        "link": f"anchor {anchor} - tag {tag}",
        "tx": "tag",
        "rx": "anchor",
        "los": _LABELS[row["label"]],
        "los_class": row["label"],
        "true_range_m": float(np.hypot(row["x_rx"] - row["x_tx"], row["y_rx"] - row["y_tx"])),
        "tx_x_m": row["x_tx"],
        "tx_y_m": row["y_tx"],
        "rx_x_m": row["x_rx"],
        "rx_y_m": row["y_rx"],
        "sample_period_ns": SAMPLE_PERIOD_NS,
    }


def _log_frame(log: Log, link: dict[str, Any]) -> pd.DataFrame:
    """Return the rows of one log."""
    frame = pd.DataFrame([_row(found) for found in log.ranges])
    times = np.unwrap(frame["time_s"].to_numpy(), period=COUNTER_TURN_S)
    return frame.assign(time_s=times - times[0], session=log.started, **link)


def _row(found: Range) -> dict[str, Any]:
    """Return one range with its final frame's accumulator."""
    parts = accumulator(found.final)
    cir = np.hypot(parts[0], parts[1])
    final, poll = found.final, found.poll
    row = {
        "range_m": found.range_m,
        "range_raw_m": found.raw_m,
        "bias_correction_m": found.bias_m,
        "clock_offset_ppm": found.clock_offset_ppm,
        "reply_time_s": found.ticks.get("db", np.nan) * TICK_S,
        "time_s": final.rx_time_s,
        "cir": cir,
        "cir_i": parts[0].copy(),
        "cir_q": parts[1].copy(),
        "first_path_index": final.first_path_index,
        "preamble_count": final.preamble_count,
        "rx_power_dbm": final.rx_power_dbm,
        "first_path_power_dbm": final.first_path_power_dbm,
        "noise_std": noise_std(cir, final.first_path_index),
        "noise_threshold": final.noise_threshold,
    }
    if poll:
        row["poll_first_path_index"] = poll.first_path_index
        row["poll_preamble_count"] = poll.preamble_count
        row["poll_rx_power_dbm"] = poll.rx_power_dbm
        row["poll_first_path_power_dbm"] = poll.first_path_power_dbm
    return row | {f"{name.title()}_ticks": float(n) for name, n in found.ticks.items()}
