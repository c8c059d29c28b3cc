"""Comprehensive outdoor UWB data set, static part (ADIP laboratory, Hanyang University).

Zenodo 10.5281/zenodo.15226105, Apache-2.0. DW1000-class radios, channel 5, PRF 64 MHz, one anchor,
no CIR. Files `Static_measurements/<LOS|NLOS>/height_<h>cm/<d>m.csv`, one per position.

- True distance: sqrt(d^2 + ((h - 100)/100)^2), d in metres from the file's name and h in cm from
  its folder: the antennas stand h and 1 m above the ground, d apart. `tx` is the end at h.
- Files end in summary lines ("Distance Mean,..."): these are no rows and are not counted as
  dropped. Lines that are damaged, whose timestamps contradict the round-trip times printed beside
  them, or whose registers contradict the printed receive level, are dropped and counted.
- `rx_power_dbm` and `first_path_power_dbm` are computed from `Max Growth CIR` and the amplitudes by
  the user manual's formulas with 121.74 dB. The printed receive level agrees with its formula, the
  printed first-path level does not with its own (up to 3 dB); both are kept as `*_printed_dbm`.
- `reply_time_s` = `rtd_resp` in ticks of 15.65 ps; `time_s` = seconds since the data set's first
  row; the 32-bit timestamps keep their names.
- `link` = position pair: LoS and NLoS at the same height and distance are one link, so that the
  same true distance never stands on both sides of a split.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.recordings.clean import Cleaned, add_counts, clean
from bench.recordings.dw1000 import first_path_power_dbm, receive_power_dbm
from bench.recordings.table import SAMPLE_PERIOD_NS
from bench.recordings.twr import TICK_S, elapsed

COLUMNS = (
    "timestamp", "Transmission #", "Reception #", "maxNoise", "Distance", "Channel",
    "FirstPathAmp1", "FirstPathAmp2", "FirstPathAmp3", "Max Growth CIR", "Rx Preamble Count",
    "Standard Noise", "RSSI(dBm)", "RSSI_fp(dBm)", "rtd_init", "rtd_resp", "resp_rx_ts",
    "poll_tx_ts", "resp_tx_ts", "poll_rx_ts", "anchor_id",
)  # fmt: skip
TIMESTAMP_BITS = 32
LEVEL_ROUNDING_DB = 0.02
DAMAGED = "damaged line"
WRONG_TIMES = "timestamps contradict the round-trip times"
WRONG_LEVEL = "registers contradict the receive level"
_SUMMARY = ("Distance Mean", "Distance Std", "RSSI(dBm) ", "RSSI_fp(dBm) ")
_PLACE = re.compile(r"(N?LOS)/height_([\d.]+)cm/([\d.]+)m\.csv$")


def read_outdoor(folder: Path) -> Cleaned:
    """Return the rows of the static part, from its folder (environment: outdoor).

    Raises BenchError where there are no measurements or a file has another header.
    """
    table, damaged = _read_all(folder)
    times, level = _wrong_times(table), _wrong_level(table)
    counts = {
        DAMAGED: damaged,
        WRONG_TIMES: int(times.sum()),
        WRONG_LEVEL: int((level & ~times).sum()),
    }
    frame = _exchange_format(table[~(times | level)].reset_index(drop=True))
    cleaned = clean(frame, "outdoor")
    dropped = {reason: count for reason, count in counts.items() if count}
    return Cleaned(cleaned.frame, add_counts(dropped, cleaned.dropped))


def _read_all(folder: Path) -> tuple[pd.DataFrame, int]:
    """Return every good line of every file as numbers with its place, and how many are damaged."""
    lines = [line for path in sorted(folder.rglob("*m.csv")) for line in _lines(path)]
    if not lines:
        raise BenchError(f"{folder}: no measurements; expected LOS/height_50.0cm/2m.csv and so on")
    whole = [line for line in lines if len(line) == len(COLUMNS) + 3]
    table = pd.DataFrame(whole, columns=["place", "height_cm", "distance_m", *COLUMNS])
    numbers = table.drop(columns="place").apply(pd.to_numeric, errors="coerce")
    good = numbers.notna().all(axis=1)
    kept = numbers[good].assign(los=table.loc[good, "place"] == "LOS").reset_index(drop=True)
    return kept, len(lines) - len(kept)


def _lines(path: Path) -> Iterator[list[str]]:
    """Yield each line that is no summary as [LOS or NLOS, height, distance, *fields]."""
    place = _PLACE.search(path.as_posix())
    if not place:
        return
    header, *rest = path.read_text(errors="replace").splitlines() or [""]
    if header.split(",") != list(COLUMNS):
        raise BenchError(f"{path}: expected the header {','.join(COLUMNS)[:40]}..")
    for line in rest:
        if line and not line.startswith(_SUMMARY):
            yield [*place.groups(), *line.split(",")]


def _wrong_times(table: pd.DataFrame) -> NDArray[np.bool_]:
    """Return where the four timestamps do not give the two round-trip times printed."""
    init = elapsed(table["poll_tx_ts"], table["resp_rx_ts"], TIMESTAMP_BITS)
    resp = elapsed(table["poll_rx_ts"], table["resp_tx_ts"], TIMESTAMP_BITS)
    printed_init, printed_resp = table["rtd_init"].to_numpy(), table["rtd_resp"].to_numpy()
    return np.asarray((init != printed_init) | (resp != printed_resp))


def _wrong_level(table: pd.DataFrame) -> NDArray[np.bool_]:
    """Return where the receive level printed is not what its registers give."""
    level = receive_power_dbm(table["Max Growth CIR"], table["Rx Preamble Count"])
    with np.errstate(invalid="ignore"):
        return np.asarray(np.abs(level - table["RSSI(dBm)"].to_numpy()) > LEVEL_ROUNDING_DB)


def _exchange_format(table: pd.DataFrame) -> pd.DataFrame:
    """Return the lines in the exchange format."""
    height, distance = table["height_cm"] / 100, table["distance_m"]
    count = table["Rx Preamble Count"]
    amplitudes = (table["FirstPathAmp1"], table["FirstPathAmp2"], table["FirstPathAmp3"])
    columns = {
        "environment": "outdoor",
        "link": table["height_cm"].map("{:g} cm, ".format) + distance.map("{:g} m".format),
        "tx": "tag",
        "rx": table["anchor_id"].map("anchor {:.0f}".format),
        "los": table["los"],
        "range_m": table["Distance"],
        "true_range_m": np.hypot(distance, height - 1.0),
        "sample_period_ns": SAMPLE_PERIOD_NS,
        "preamble_count": count,
        "noise_std": table["Standard Noise"],
        "max_noise": table["maxNoise"],
        "cir_power": table["Max Growth CIR"],
        **{f"fp_ampl{n}": table[f"FirstPathAmp{n}"] for n in (1, 2, 3)},
        "rx_power_dbm": receive_power_dbm(table["Max Growth CIR"], count),
        "first_path_power_dbm": first_path_power_dbm(amplitudes, count),
        "rx_power_printed_dbm": table["RSSI(dBm)"],
        "first_path_power_printed_dbm": table["RSSI_fp(dBm)"],
        "reply_time_s": table["rtd_resp"] * TICK_S,
        "time_s": table["timestamp"] - table["timestamp"].min(),
        "tx_x_m": distance,
        "tx_y_m": 0.0,
        "tx_z_m": height,
        "rx_x_m": 0.0,
        "rx_y_m": 0.0,
        "rx_z_m": 1.0,
    }
    kept = ("rtd_init", "rtd_resp", "resp_rx_ts", "poll_tx_ts", "resp_tx_ts", "poll_rx_ts")
    return pd.DataFrame(columns | {name: table[name] for name in kept})
