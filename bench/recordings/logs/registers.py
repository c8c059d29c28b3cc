"""Raw DW1000 registers among a log's columns, by their names in the user manual.

Case, blanks and underscores do not matter: `FP_INDEX`, `fpindex` and `Fp Index` are one.

- FP_INDEX is a 10.6 fixed-point number: first path = FP_INDEX / 64, where any value lies beyond
  the accumulator's 1016 samples; smaller ones are taken as samples.
- FP_AMPL1..3, CIR_PWR and RXPACC give the levels by the manual's formulas (`bench.recordings.
  dw1000`), with the constant of the pulse repetition frequency (`prf_mhz`, 64 unless given).
- STD_NOISE is `noise_std`, RXPACC is `preamble_count`.

A column of the exchange format that is there already is left as it is.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.recordings.dw1000 import POWER_CONSTANT_DB, first_path_power_dbm, receive_power_dbm

Floats = NDArray[np.float64]
Values = Mapping[str, Floats]
ACCUMULATOR_SAMPLES = 1016
DEFAULT_PRF_MHZ = 64
NAMES = {
    "fp_index": ("fpindex", "fpidx", "firstpathindex", "fpindexraw"),
    "fp_ampl1": ("fpampl1", "fpamp1", "firstpathamp1", "fppoint1"),
    "fp_ampl2": ("fpampl2", "fpamp2", "firstpathamp2", "fppoint2"),
    "fp_ampl3": ("fpampl3", "fpamp3", "firstpathamp3", "fppoint3"),
    "cir_power": ("cirpwr", "cirpower", "maxgrowthcir", "cirp"),
    "preamble_count": ("rxpacc", "pacc", "rxpreamcount", "paccnt", "rxpreamblecount"),
    "noise_std": ("stdnoise", "stdevnoise", "noisestd", "standardnoise"),
}


def add_registers(frame: pd.DataFrame, name: str) -> tuple[pd.DataFrame, list[str]]:
    """Return the table with what its registers imply, and a line on each thing derived.

    `name` is the file, for messages. Raises BenchError for a `prf_mhz` other than 16 or 64.
    """
    found = find_registers(frame)
    values = {register: _numbers(frame[column]) for register, column in found.items()}
    prf_mhz = _prf(frame, name) if found else DEFAULT_PRF_MHZ
    columns: dict[str, Floats] = {}
    notes: list[str] = []
    for column, registers, derive in _RULES:
        if column not in frame and set(registers) <= set(values):
            columns[column] = derive(values, prf_mhz)
            notes.append(f"{column} from {', '.join(found[one] for one in registers)}")
    kept = {name: values[name] for name in values if name not in frame and name != "fp_index"}
    used = [found[register] for register in found if register in kept or register == "fp_index"]
    rest = frame.drop(columns=used)
    # At once and as one block: a wide log, column by column, is slow and pandas says so each time.
    return pd.concat([rest, pd.DataFrame(kept | columns, index=rest.index)], axis=1).copy(), notes


def find_registers(frame: pd.DataFrame) -> dict[str, str]:
    """Return which column is which register."""
    plain = {re.sub(r"[\W_]", "", str(column)).lower(): str(column) for column in frame}
    return {
        register: plain[alias]
        for register, aliases in NAMES.items()
        for alias in (register.replace("_", ""), *aliases)
        if alias in plain and plain[alias] != "first_path_index"
    }


def _numbers(column: pd.Series) -> Floats:
    return pd.to_numeric(column, errors="coerce").to_numpy(np.float64)


def _first_path(values: Values, _prf_mhz: int) -> Floats:
    """Return the first path in samples: 10.6 fixed point where any value says so."""
    index = values["fp_index"]
    raw = np.nanmax(index, initial=0.0) >= ACCUMULATOR_SAMPLES
    return index / 64.0 if raw else index


def _receive_power(values: Values, prf_mhz: int) -> Floats:
    return receive_power_dbm(values["cir_power"], values["preamble_count"], prf_mhz)


def _first_path_power(values: Values, prf_mhz: int) -> Floats:
    amplitudes = (values["fp_ampl1"], values["fp_ampl2"], values["fp_ampl3"])
    return first_path_power_dbm(amplitudes, values["preamble_count"], prf_mhz)


def _prf(frame: pd.DataFrame, name: str) -> int:
    """Return the pulse repetition frequency in MHz. Raises BenchError where it is neither."""
    if "prf_mhz" not in frame:
        return DEFAULT_PRF_MHZ
    known = pd.to_numeric(frame["prf_mhz"], errors="coerce").dropna().unique()
    if len(known) != 1 or int(known[0]) not in POWER_CONSTANT_DB:
        raise BenchError(f"{name}: prf_mhz is {known.tolist()}; expected 16 or 64 throughout")
    return int(known[0])


_RULES: tuple[tuple[str, tuple[str, ...], Callable[[Values, int], Floats]], ...] = (
    ("first_path_index", ("fp_index",), _first_path),
    ("rx_power_dbm", ("cir_power", "preamble_count"), _receive_power),
    (
        "first_path_power_dbm",
        ("fp_ampl1", "fp_ampl2", "fp_ampl3", "preamble_count"),
        _first_path_power,
    ),
)
