"""All environments of the Ghent publisher, and their CIRs: IIoT, office, university.

github.com/JaronFontaine/UWB-dataset-from-an-office-industrial-and-university-environment, of
Fontaine et al. 2023 (see `ghent` for the two IIoT campaigns). Read is every `meta_NAME.csv`, and
every `features_NAME.csv` without such a file, as one environment NAME:

- a meta file in the form of IIoT_19 (`actual_range`, .. in millimetres) or of IIoT_20 (`T1`..`T6`)
  is read as these are, mirrored decimals of the levels included where they are mirrored there too;
- the university's meta file (`real_rng`, `rng` in metres, `condition`, `msid`): `range_m` = `rng`,
  a link = `msid` (and the true range, should one `msid` have several);
- otherwise the features: `estimated_range` and `distance_GT` in millimetres, or `real_rng` in
  metres, `label` 1 = NLOS. They name no positions: a link = one true range, to the millimetre.
  Fields are separated by commas, or by semicolons with decimal commas.

The CIRs are in CIRsV2.hdf5, one complex array [rows, samples] per environment (`IIoT19`, `IIoT20`,
`OfficeLab`, `University_full`, ..): row for row those of the published tables. With CIRs asked for,
only environments whose array is there are read, and another number of rows is an error.

UNTESTED on real files but for IIoT without CIRs: written by the publisher's description, and the
first lines of the university's files.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.recordings.clean import Cleaned, add_counts, clean
from bench.recordings.csv_table import read_text_table
from bench.recordings.dw1000 import first_path_power_dbm
from bench.recordings.logs.dialect import find_dialect
from bench.recordings.readers import ghent
from bench.recordings.table import SAMPLE_PERIOD_NS
from bench.recordings.twr import TIMESTAMPS

UNIVERSITY = (
    "real_rng", "rng", "rssi", "fp_idx", "fp_power", "fp_amp1", "fp_amp2", "fp_amp3", "std_noise",
    "pacc_cnt", "condition", "location_from", "location_to", "msid", "rng_wo_bias",
)  # fmt: skip
FEATURES = (
    "fp_ampl1", "fp_ampl2", "fp_ampl3", "std_noise", "CIRpower", "RXPACC", "fpindex", "RX_power",
    "FP_power", "estimated_range", "label",
)  # fmt: skip
_TRUTHS = {"distance_GT": 1000.0, "real_rng": 1.0}  # counts per metre
MIRROR_AGREES_DB = 0.01


def find_environments(files: list[Path]) -> dict[str, Path]:
    """Return the table of each environment: its meta file, or features no meta file goes with."""
    metas = {_named(path, "meta_"): path for path in files if path.name.startswith("meta_")}
    features = {_named(path, "features_"): p for p in files if (path := p).name[:9] == "features_"}
    known = [_plain(name) for name in metas]
    alone = {n: p for n, p in features.items() if not _plain(n).startswith(tuple(known) or "/")}
    return dict(sorted((metas | alone).items()))


def _named(path: Path, prefix: str) -> str:
    return path.stem.removeprefix(prefix).removesuffix("_processed")


def _plain(name: str) -> str:
    return re.sub("[^a-z0-9]", "", name.lower())


def read_family(files: list[Path], cirs: Path | None = None) -> Cleaned:
    """Return the rows of every environment; with their CIRs where `cirs` is the HDF5 file.

    Raises BenchError where no file is of a known form, or CIRs do not go with a table.
    """
    frames, dropped = [], dict[str, int]()
    environments = find_environments(files)
    arrays = open_cirs(cirs, environments) if cirs else None
    for name, path in environments.items():
        if arrays is None or name in arrays:
            frame, counts, rows = read_environment(path, name)
            if arrays is not None:
                frame = _with_cirs(frame, arrays[name], rows, path)
            frames.append(frame)
            dropped = add_counts(dropped, counts)
    if not frames:
        raise BenchError(f"{cirs or 'ghent'}: no environment with a table; expected meta_NAME.csv")
    cleaned = clean(pd.concat(frames, ignore_index=True), "ghent-family")
    return Cleaned(cleaned.frame, add_counts(dropped, cleaned.dropped))


def read_environment(path: Path, name: str) -> tuple[pd.DataFrame, dict[str, int], int]:
    """Return one environment (index: row in the file), what was dropped, and the file's rows.

    Raises BenchError, naming the file, for a form that is none of those known.
    """
    marks = find_dialect(path)
    table = read_text_table(path, marks.delimiter, marks.decimal, marks.encoding, marks.skip)
    if set(TIMESTAMPS) <= set(table):
        raw = ghent.as_numbers(table, ghent.COLUMNS_20, path)
        frame, repeated = ghent.like_2020(raw, name)
        return frame, {ghent.REPEATED: repeated} if repeated else {}, len(table)
    if "actual_range" in table:
        raw = ghent.as_numbers(table, ghent.COLUMNS_19, path)
        return _levels(ghent.like_2019(raw, name), raw), {}, len(table)
    if "rng" in table:
        return _university(_required(table, UNIVERSITY, path), name), {}, len(table)
    return _features(_required(table, FEATURES, path), name, path), {}, len(table)


def _required(table: pd.DataFrame, columns: tuple[str, ...], path: Path) -> pd.DataFrame:
    for column in columns:
        if column not in table:
            raise BenchError(f"{path}: no column {column!r}; expected the file as published")
    return table


def _levels(frame: pd.DataFrame, raw: pd.DataFrame) -> pd.DataFrame:
    """Return the levels as printed where, unlike IIoT's, their decimals are not mirrored."""
    off = (frame["first_path_power_dbm"] - raw["FP_power"]).abs().median()
    return frame if off > MIRROR_AGREES_DB else frame.assign(rx_power_dbm=raw["RX_power"])


def _university(table: pd.DataFrame, name: str) -> pd.DataFrame:
    """Return the university's rows in the exchange format."""
    amplitudes = [pd.to_numeric(table[f"fp_amp{n}"], errors="coerce") for n in (1, 2, 3)]
    count = pd.to_numeric(table["pacc_cnt"], errors="coerce")
    site = f"{name} " + table["msid"].astype("str") + ", " + table["real_rng"].astype("str") + " m"
    columns: dict[str, Any] = {
        "environment": name,
        "link": site,
        "tx": table["location_from"],
        "rx": table["location_to"],
        "los": table["condition"].str.strip().str.lower() == "los",
        "range_m": table["rng"],
        "true_range_m": table["real_rng"],
        "range_without_bias_m": table["rng_wo_bias"],
        "first_path_index": table["fp_idx"],
        "sample_period_ns": SAMPLE_PERIOD_NS,
        "preamble_count": count,
        "noise_std": table["std_noise"],
        "rx_power_dbm": table["rssi"],
        "first_path_power_dbm": first_path_power_dbm(tuple(amplitudes), count),  # type: ignore[arg-type]
    }
    return pd.DataFrame(columns | _amplitudes(amplitudes))


def _features(table: pd.DataFrame, name: str, path: Path) -> pd.DataFrame:
    """Return a features file's rows. Raises BenchError where no true range is there."""
    truth = next((column for column in _TRUTHS if column in table), None)
    if truth is None:
        raise BenchError(f"{path}: no column 'distance_GT' or 'real_rng'; expected a true range")
    numbers = {c: pd.to_numeric(table[c], errors="coerce") for c in (*FEATURES, truth)}
    amplitudes = [numbers[f"fp_ampl{n}"] for n in (1, 2, 3)]
    true_m = numbers[truth] / _TRUTHS[truth]
    index = numbers["fpindex"]
    columns: dict[str, Any] = {
        "environment": name,
        "link": f"{name} " + true_m.map("{:.3f} m".format).where(true_m.notna()),
        "los": numbers["label"] == 0,
        "range_m": numbers["estimated_range"] / _TRUTHS[truth],
        "true_range_m": true_m,
        "first_path_index": index / 64 if index.max() > 1016 else index,
        "sample_period_ns": SAMPLE_PERIOD_NS,
        "preamble_count": numbers["RXPACC"],
        "noise_std": numbers["std_noise"],
        "cir_power": numbers["CIRpower"],
        "rx_power_dbm": numbers["RX_power"],
        "first_path_power_dbm": first_path_power_dbm(tuple(amplitudes), numbers["RXPACC"]),  # type: ignore[arg-type]
    }
    frame = pd.DataFrame(columns | _amplitudes(amplitudes))
    off = (frame["first_path_power_dbm"] - numbers["FP_power"]).abs().median()
    mirrored = frame.assign(rx_power_dbm=ghent.unmirrored(numbers["RX_power"]))
    return mirrored if off > MIRROR_AGREES_DB else frame


def _amplitudes(columns: list[pd.Series]) -> dict[str, pd.Series]:
    return {f"fp_ampl{n}": column for n, column in enumerate(columns, 1)}


def open_cirs(path: Path, environments: Mapping[str, Path]) -> dict[str, NDArray[Any]]:
    """Return the complex CIRs [rows, samples] of the environments that have some.

    Raises BenchError without h5py, and where the file is no HDF5 or an array has another form.
    """
    try:
        import h5py
    except ImportError as problem:
        raise BenchError(f"{path}: needs h5py; pip install 'uwb-bench[hdf5]'") from problem
    try:
        with h5py.File(path, "r") as file:
            names = {_plain(key): key for key in file if isinstance(file[key], h5py.Dataset)}
            return {
                name: np.asarray(file[names[key]])
                for name in environments
                for key in _keys(name)
                if key in names and _is_cir(file[names[key]], path)
            }
    except OSError as problem:
        raise BenchError(f"{path}: no HDF5 file: {problem}") from problem


def _keys(name: str) -> Iterator[str]:
    """Yield how the array of an environment may be called, the first that is there counts."""
    yield _plain(name) + "full" if _plain(name) == "university" else _plain(name)


def _is_cir(array: Any, path: Path) -> bool:
    """Return True. Raises BenchError where an array is no table of numbers."""
    if array.ndim != 2 or array.dtype.kind not in "cfiu":
        raise BenchError(
            f"{path}: {array.name} is {array.dtype} of shape {array.shape}; expected complex "
            "numbers, one row per range"
        )
    return True


def _with_cirs(frame: pd.DataFrame, cirs: NDArray[Any], rows: int, path: Path) -> pd.DataFrame:
    """Return the rows with their CIRs. Raises BenchError where there is not one per row."""
    if len(cirs) != rows:
        raise BenchError(f"{path}: {rows} rows but {len(cirs)} CIRs; expected one per row")
    own = cirs[frame.index.to_numpy()]
    parts = {"cir_i": own.real, "cir_q": own.imag} if np.iscomplexobj(own) else {"cir": own}
    cells = {name: list(np.asarray(part, np.float32)) for name, part in parts.items()}
    return frame.assign(**{name: pd.Series(c, frame.index) for name, c in cells.items()})
