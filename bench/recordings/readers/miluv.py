"""MILUV: quadcopters ranging in a room with obstacles (Shalaby et al. 2025), moving pairs.

"MILUV: A Multi-UAV Indoor Localization dataset with UWB and Vision", IJRR 2025, figshare.plus
28386041. DWM1000 radios; each robot carries two tags (ifo001: 10 and 11, ...), six anchors 0 to 5
stand still. Read are the folders `EXPERIMENT/ifoNNN/` with `uwb_range.csv` and `uwb_cir.csv`.

- Both robots of a pair log a range between them: the copy (same sender's timestamp) is one row.
- A CIR comes some 0.1 to 0.3 s after its range. It belongs to the last range of the same directed
  pair before it, at most 0.4 s earlier, and only if one of the two recorded it. Most CIRs were
  recorded by a third tag that overheard the exchange: they are of another path and are left out.
  Where both ends recorded one, the initiator's is taken. What finds no partner is counted.
- `tx`, `rx`: `rx` recorded the CIR. `first_path_power_dbm` is that end's: fpp2 (the response, at
  the initiator) or fpp1 (the poll, at the responder); the level of the CIR's first path follows it.
- `range_m` is the publisher's calibrated double-sided range. Variant `ds` takes the double-sided
  range of the timestamps before calibration, `ss` the single-sided one, (R_a - D_b)/2: in both
  the antenna delays are still in it, in `ss` the clock offset too. The double-sided formula
  c/2 (R_a - D_b r/t), with r and t the times between second and third message at the two ends,
  gives the publisher's ranges to 0.003 mm, with c = 299 702 547 m/s (in air).
- `true_range_m`: motion capture, antenna to antenna. Antenna positions come from the robots' poses
  and the lever arms and anchor constellations the publisher's development kit lists; the
  constellation is the one that gives the true ranges (none within 5 mm: no positions).
- `clock_offset_ppm` = (skew2 - skew1)/2 of the carriers: positive where the initiator's clock runs
  fast, so that single-sided ranges read long. `reply_time_s` = tx2 - rx1, the responder's.
- `los`, `obstacles` (experiments named *Obstacles*): the kit's labels by anchor - foam in front of
  1, plastic in front of 3, wood in front of 4 - not a judgement of each moment.
- `link` = the two devices (either way round) and a stretch of 20 s: pairs move, in 20 s by metres,
  so a later stretch is another geometry; ranges of one pair come some 16 s apart.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError, unknown_name
from bench.recordings.clean import Cleaned, add_counts, clean
from bench.recordings.csv_table import parse_numbers
from bench.recordings.noise import noise_std
from bench.recordings.readers.miluv_poses import positions
from bench.recordings.table import SAMPLE_PERIOD_NS

VARIANTS = ("ds", "ss")
LATEST_S = 0.4
STRETCH_S = 20.0
TURN_NS = 2**32 * 1e9 / (128 * 499.2e6)
C_AIR_M_PER_NS = 0.299702547
OBSTACLES = {1: "foam", 3: "plastic", 4: "wood"}
NO_CIR = "range without a CIR of one of its ends"
OVERHEARD = "CIR overheard by a third tag"
NO_RANGE = "CIR without a range of its pair"
Floats = NDArray[np.float64]
_PAIR = ["from_id", "to_id"]
_TIMES = ("tx1_raw", "rx1_raw", "tx2_raw", "rx2_raw", "tx3_raw", "rx3_raw")
_RANGES = (*_PAIR, "range", "gt_range", *_TIMES, "fpp1", "fpp2", "skew1", "skew2", "timestamp")
_CIRS = ("timestamp", "my_id", *_PAIR, "idx", "cir")


def read_miluv(folders: list[Path], variant: str | None = None) -> Cleaned:
    """Return the ranges with a CIR of some experiments' folders (environment: the folder's name).

    `variant`: None for the calibrated ranges, `ds` or `ss` for those of the timestamps. Raises
    BenchError for an unknown variant, a missing file or column, or where nothing can be matched.
    """
    if variant is not None and variant not in VARIANTS:
        raise unknown_name("variant of miluv", variant, VARIANTS)
    frames, dropped = [], dict[str, int]()
    for folder in folders:
        ranges, cirs = _read(folder, "uwb_range.csv", _RANGES), _read(folder, "uwb_cir.csv", _CIRS)
        ranges = ranges.drop_duplicates([*_PAIR, "tx1_raw"], ignore_index=True)
        matched, counts = match(ranges, cirs)
        frames.append(_exchange_format(ranges, matched, folder.name, variant))
        dropped = add_counts(dropped, counts)
    cleaned = clean(pd.concat(frames, ignore_index=True), "miluv")
    return Cleaned(cleaned.frame, add_counts(dropped, cleaned.dropped))


def _read(folder: Path, name: str, columns: tuple[str, ...]) -> pd.DataFrame:
    """Return one table of every robot. Raises BenchError where a file or column is missing."""
    tables = []
    for path in sorted(folder.glob(f"*/{name}")):
        try:
            table = pd.read_csv(path)
        except (OSError, ValueError) as problem:
            raise BenchError(f"{path}: cannot be read: {problem}") from problem
        for column in columns:
            if column not in table:
                raise BenchError(f"{path}: no column {column!r}; expected the file as published")
        tables.append(table)
    if not tables:
        raise BenchError(f"{folder}: no ROBOT/{name}; expected an experiment as published")
    return pd.concat(tables, ignore_index=True)


def match(ranges: pd.DataFrame, cirs: pd.DataFrame) -> tuple[pd.DataFrame, dict[str, int]]:
    """Return a CIR per range that has one (column `row` = the range's row) and what is left over.

    See the module's rule. Both tables have `from_id`, `to_id`, `timestamp` (s).
    """
    initiator = (cirs["my_id"] == cirs["from_id"]).to_numpy()
    own = initiator | (cirs["my_id"] == cirs["to_id"]).to_numpy()
    cirs = cirs.assign(initiator=initiator)[own].sort_values("timestamp")
    times = ranges[[*_PAIR, "timestamp"]].assign(row=ranges.index).sort_values("timestamp")
    found = pd.merge_asof(cirs, times, on="timestamp", by=_PAIR, tolerance=LATEST_S)  # type: ignore[arg-type]
    partners = found.dropna(subset="row")
    chosen = partners.sort_values("initiator", ascending=False, kind="stable")
    chosen = chosen.drop_duplicates("row").astype({"row": np.int64}).sort_values("row")
    counts = {
        NO_CIR: len(ranges) - len(chosen),
        OVERHEARD: int((~own).sum()),
        NO_RANGE: len(found) - len(partners),
    }
    return chosen, {reason: count for reason, count in counts.items() if count}


def _exchange_format(
    ranges: pd.DataFrame, matched: pd.DataFrame, experiment: str, variant: str | None
) -> pd.DataFrame:
    """Return the matched ranges in the exchange format."""
    rows = ranges.loc[matched["row"]].reset_index(drop=True)
    starts = rows["from_id"].to_numpy(np.int64), rows["to_id"].to_numpy(np.int64)
    at_initiator = matched["initiator"].to_numpy(np.bool_)
    columns: dict[str, Any] = {
        "environment": experiment,
        "link": _links(experiment, *starts, rows["timestamp"].to_numpy(np.float64)),
        "tx": np.where(at_initiator, starts[1], starts[0]).astype("U"),
        "rx": np.where(at_initiator, starts[0], starts[1]).astype("U"),
        "range_m": rows["range"] if variant is None else from_timestamps_m(rows)[variant],
        "true_range_m": rows["gt_range"],
        "range_calibrated_m": rows["range"],
        "sample_period_ns": SAMPLE_PERIOD_NS,
        "first_path_power_dbm": np.where(at_initiator, rows["fpp2"], rows["fpp1"]),
        "far_first_path_power_dbm": np.where(at_initiator, rows["fpp1"], rows["fpp2"]),
        "clock_offset_ppm": (rows["skew2"] - rows["skew1"]) / 2,
        "reply_time_s": _elapsed_ns(rows, "rx1", "tx2") * 1e-9,
        "time_s": rows["timestamp"],
        "initiator": starts[0].astype("U"),
    }
    columns |= _waveforms(matched) | _obstacles(experiment, *starts)
    return pd.DataFrame(columns | positions(rows, at_initiator))


def _waveforms(matched: pd.DataFrame) -> dict[str, Any]:
    """Return the columns that come from the CIRs."""
    index = matched["idx"].to_numpy(np.float64)
    cells = np.empty(len(matched), dtype=object)
    cells[:] = [parse_numbers(text) for text in matched["cir"]]
    noise = [noise_std(cir, first) for cir, first in zip(cells, index, strict=True)]
    return {"cir": cells, "first_path_index": index, "noise_std": noise}


def _obstacles(
    experiment: str, first: NDArray[np.int64], second: NDArray[np.int64]
) -> dict[str, Any]:
    """Return `los` and `obstacles` of an experiment with obstacles, nothing of another."""
    if "obstacles" not in experiment.lower():
        return {}
    pairs = zip(first.tolist(), second.tolist(), strict=True)
    names = [[OBSTACLES[end] for end in pair if end in OBSTACLES] for pair in pairs]
    return {"obstacles": pd.Series(names, dtype=object), "los": [not found for found in names]}


def _links(
    experiment: str, first: NDArray[np.int64], second: NDArray[np.int64], time_s: Floats
) -> list[str]:
    """Return the link of every row: both devices, lower number first, and the stretch of time."""
    stretch = (time_s // STRETCH_S * STRETCH_S).astype(np.int64)
    ends = np.sort(np.stack([first, second], axis=1), axis=1)
    return [
        f"{experiment} {a}-{b} from {t} s" for (a, b), t in zip(ends.tolist(), stretch, strict=True)
    ]


def from_timestamps_m(rows: pd.DataFrame) -> dict[str, Floats]:
    """Return the ranges [n] in metres that the timestamps before calibration give.

    `ss` = c/2 (R_a - D_b); `ds` = c/2 (R_a - D_b r/t), which takes the clock offset out.
    """
    round_ns, reply_ns = _elapsed_ns(rows, "tx1", "rx2"), _elapsed_ns(rows, "rx1", "tx2")
    sent_ns, received_ns = _elapsed_ns(rows, "tx2", "tx3"), _elapsed_ns(rows, "rx2", "rx3")
    half = C_AIR_M_PER_NS / 2
    # Differences of nearly equal numbers first, so that no digit is lost.
    drift = (received_ns - sent_ns) / sent_ns
    single = half * (round_ns - reply_ns)
    return {"ss": single, "ds": single - half * reply_ns * drift}


def _elapsed_ns(rows: pd.DataFrame, start: str, end: str) -> Floats:
    """Return the time between two timestamps of one clock that turns over every 67.2 ms."""
    difference = rows[f"{end}_raw"].to_numpy(np.float64) - rows[f"{start}_raw"].to_numpy(np.float64)
    return np.asarray(np.mod(difference, TURN_NS), np.float64)
