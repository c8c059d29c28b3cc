"""Industrial hall measurements of Ghent University (Fontaine et al. 2023), without CIRs.

"Transfer Learning for UWB Error Correction and (N)LOS Classification in Multiple Environments",
IEEE Internet of Things Journal 2023, doi 10.1109/JIOT.2023.3299319. Two campaigns, DW1000 radios at
110 kb/s and 64 MHz PRF; environments `IIoT_19` (channel 1, preamble 1536, LoS and NLoS) and
`IIoT_20` (channel 3, preamble 1024, LoS). Only the `meta_*.csv` files are read: they hold what the
`features_*.csv` hold, and more.

- Lengths are published in millimetres. `error_m` is not taken over: IIoT_19's features give it with
  the opposite sign; here it is measured - true, as everywhere.
- The published powers have mirrored decimals: -91.274 stands for -91.726. Both levels are given as
  the registers imply; the first-path level is computed from the amplitudes, the receive level by
  mirroring back (the two agree to 0.001 dB wherever both can be had). The published values are
  kept as `rx_power_printed_dbm` and `first_path_power_printed_dbm`.
- IIoT_20 repeats 748 of its 3925 exchanges word for word (links 1-3 and 1-4 stand in the file
  twice): the second copy is dropped and counted, since one row is one measurement.
- IIoT_20's four nodes are tag and anchor in turn, so its eight pairs are four links.
- `T1`..`T6`: the timestamps of the double-sided exchange in ticks (see `bench.recordings.twr`; the
  tag is the initiator). `reply_time_s` = T3 - T2. `clock_offset_ppm` comes from the tag's carrier
  integrator (17 bits of two's complement); its sign is that of the timestamps: positive where the
  tag runs fast and single-sided ranges read long. It agrees with the timestamps to 0.09 ppm at
  worst, 0.02 ppm low on average.
- `time_s` counts the tag's 128.9 Hz network clock from its first row; the four tags' clocks start
  within a minute of each other.
- Other register columns of IIoT_20 keep their published names (`rxtofs_tag`, `DRX_CAR_INT_tag`, ..,
  `*_anchor` where the anchor's report arrived).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.recordings.clean import Cleaned, add_counts, clean
from bench.recordings.dw1000 import carrier_offset_ppm, first_path_power_dbm, temperature_c
from bench.recordings.table import SAMPLE_PERIOD_NS
from bench.recordings.twr import TIMESTAMPS, intervals

NETWORK_TICK_S = 0.0077586  # measured against T1, the 63.9 GHz counter
REPEATED = "repeated exchange (the same six timestamps)"
_KEPT_20 = tuple(
    f"{name}_{end}"
    for end in ("tag", "anchor")
    for name in ("rxtofs", "DRX_CAR_INT", "sar_temp_l", "otp_temp_23", "sar_bat_l", "ppampl",
                 "rxpacc", "rxpacc_nosat", "fpindex", "rcphase", "rsmpdel", "ldethres")
)  # fmt: skip


COLUMNS_19 = (
    "x_tag", "y_tag", "z_tag", "x_anchor", "y_anchor", "z_anchor", "anchorNumber", "RXPACC",
    "fpindex", "fp_ampl1", "fp_ampl2", "fp_ampl3", "std_noise", "RX_power", "FP_power", "timestamp",
    "estimated_range", "actual_range", "newlabel", "loc_tag", "NLOS",
)  # fmt: skip
COLUMNS_20 = (
    *TIMESTAMPS, *_KEPT_20, "fp_ampl1_tag", "fp_ampl2_tag", "fp_ampl3_tag", "CIR_noise_tag",
    "rxpower_tag", "fppower_tag", "RMoteclk_tag", "tag_ID", "anchor_ID", "distance_UWB",
    "distance_GT", "NLOS",
)  # fmt: skip
_WORDS = ("newlabel", "loc_tag", "NLOS")


def read_ghent(meta_19: Path, meta_20: Path) -> Cleaned:
    """Return the rows of both years from their `meta_*.csv`.

    Raises BenchError where a file has another form.
    """
    first = like_2019(as_numbers(read_table(meta_19), COLUMNS_19, meta_19), "IIoT_19")
    second, repeated = like_2020(as_numbers(read_table(meta_20), COLUMNS_20, meta_20), "IIoT_20")
    cleaned = clean(pd.concat([first, second], ignore_index=True), "ghent")
    dropped = {REPEATED: repeated} if repeated else {}
    return Cleaned(cleaned.frame, add_counts(dropped, cleaned.dropped))


def read_table(path: Path) -> pd.DataFrame:
    """Return a file as it is. Raises BenchError where it is no table."""
    try:
        return pd.read_csv(path, low_memory=False)
    except (OSError, ValueError) as problem:
        raise BenchError(f"{path}: cannot be read: {problem}") from problem


def as_numbers(table: pd.DataFrame, columns: tuple[str, ...], path: Path) -> pd.DataFrame:
    """Return some columns, all but the words as numbers. Raises BenchError where one is missing."""
    for column in columns:
        if column not in table:
            raise BenchError(f"{path}: no column {column!r}; expected the file as published")
    numbers = {name: _number(table[name], path) for name in columns if name not in _WORDS}
    words = {name: table[name] for name in columns if name in _WORDS}
    return pd.DataFrame(numbers | words)


def _number(column: pd.Series, path: Path) -> pd.Series:
    """Return a column as float64; text in it (the files hold strings in places) becomes NaN."""
    numbers = pd.to_numeric(column, errors="coerce").astype(np.float64)
    if numbers.isna().all():
        raise BenchError(f"{path}: column {column.name!r} holds no number")
    return numbers


def like_2019(raw: pd.DataFrame, environment: str) -> pd.DataFrame:
    """Return rows in the form of 2019 in the exchange format, row by row."""
    amplitudes = (raw["fp_ampl1"], raw["fp_ampl2"], raw["fp_ampl3"])
    anchor = raw["anchorNumber"].astype("Int64").astype("str")
    positions = {
        f"{end}_{axis}_m": raw[f"{axis}_{device}"] / 1000
        for end, device in (("tx", "tag"), ("rx", "anchor"))
        for axis in "xyz"
    }
    columns = {
        "environment": environment,
        "link": f"{environment} " + raw["loc_tag"],
        "tx": "tag",
        "rx": "anchor " + anchor,
        "los": raw["NLOS"].map({"LOS": True, "NLOS": False}).astype("boolean"),
        "range_m": raw["estimated_range"] / 1000,
        "true_range_m": raw["actual_range"] / 1000,
        "first_path_index": raw["fpindex"] / 64,
        "sample_period_ns": SAMPLE_PERIOD_NS,
        "preamble_count": raw["RXPACC"],
        "noise_std": raw["std_noise"],
        **{f"fp_ampl{n}": raw[f"fp_ampl{n}"] for n in (1, 2, 3)},
        "rx_power_dbm": unmirrored(raw["RX_power"]),
        "first_path_power_dbm": first_path_power_dbm(amplitudes, raw["RXPACC"]),
        "rx_power_printed_dbm": raw["RX_power"],
        "first_path_power_printed_dbm": raw["FP_power"],
        "timestamp_counts": raw["timestamp"],
        "quality": raw["newlabel"],
    }
    return pd.DataFrame(columns | positions)


def like_2020(raw: pd.DataFrame, environment: str) -> tuple[pd.DataFrame, int]:
    """Return rows in the form of 2020 in the exchange format, and how many exchanges were repeats.

    Each exchange stands there once; the index says which row of `raw` it was.
    """
    repeats = raw.duplicated(list(TIMESTAMPS))
    raw = raw[~repeats]
    amplitudes = (raw["fp_ampl1_tag"], raw["fp_ampl2_tag"], raw["fp_ampl3_tag"])
    ends = np.sort(raw[["tag_ID", "anchor_ID"]].to_numpy(np.int64), axis=1).astype("U")
    clock = raw["RMoteclk_tag"]
    columns = {
        "environment": environment,
        "link": np.char.add(
            np.char.add(f"{environment} ", ends[:, 0]), np.char.add("-", ends[:, 1])
        ),
        "tx": "node " + raw["tag_ID"].astype("Int64").astype("str"),
        "rx": "node " + raw["anchor_ID"].astype("Int64").astype("str"),
        "los": raw["NLOS"].map({"LOS": True, "NLOS": False}).astype("boolean"),
        "range_m": raw["distance_UWB"] / 1000,
        "true_range_m": raw["distance_GT"] / 1000,
        "first_path_index": raw["fpindex_tag"],
        "sample_period_ns": SAMPLE_PERIOD_NS,
        "preamble_count": raw["rxpacc_tag"],
        "noise_std": raw["CIR_noise_tag"],
        **{f"fp_ampl{n}": raw[f"fp_ampl{n}_tag"] for n in (1, 2, 3)},
        "rx_power_dbm": unmirrored(raw["rxpower_tag"]),
        "first_path_power_dbm": first_path_power_dbm(amplitudes, raw["rxpacc_tag"]),
        "rx_power_printed_dbm": raw["rxpower_tag"],
        "first_path_power_printed_dbm": raw["fppower_tag"],
        "time_s": (clock - clock.min()) * NETWORK_TICK_S,
        "reply_time_s": intervals(raw).reply_time_s(),
        "clock_offset_ppm": carrier_offset_ppm(raw["DRX_CAR_INT_tag"], 3, 110, bits=17),
        "temperature_c": temperature_c(raw["sar_temp_l_tag"], raw["otp_temp_23_tag"]),
    }
    kept = {name: raw[name] for name in (*TIMESTAMPS, *_KEPT_20)}
    return pd.DataFrame(columns | kept), int(repeats.sum())


def unmirrored(printed: pd.Series) -> NDArray[np.float64]:
    """Return a level whose decimals were printed mirrored: -91.274 stands for -91.726 dBm.

    The files' author split a negative number into whole and decimal part as if it were positive.
    """
    size = np.abs(printed.to_numpy(np.float64))
    whole = np.floor(size)
    return np.asarray(-(whole + 1 - (size - whole)), np.float64)
