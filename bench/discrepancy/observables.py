"""What can be compared: numbers per row that a simulator and a radio both give.

Works with whatever columns a table has: no CIR, no CIR observables. A value that is not known is
NaN and takes no part in any comparison.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.recordings.table import SAMPLE_PERIOD_NS

Floats = NDArray[np.float64]

# Delay bins of the power profile, ns after the detected first path (one sample is 1.0016 ns).
PROFILE_EDGES_NS = (-4.0, -1.5, 1.5, 3.5, 6.5, 10.5, 15.5, 22.5, 32.5, 45.5, 62.5, 82.5, 105.5)
BEFORE, AFTER = 8, 110  # samples kept around the first path
RISE_HIGH, RISE_LOW = 0.6, 6.0  # Marano et al. 2010: share of the maximum, multiples of noise std
LEAD_LEVEL = 5.0  # multiples of the noise standard deviation that count as energy before the path

SCALARS = {
    "error_m": "m",
    "rx_power_dbm": "dB",
    "first_path_power_dbm": "dB",
    "noise_std": "counts",
    "preamble_count": "symbols",
}
FEATURES = {
    "energy_db": "dB",
    "max_amplitude_db": "dB",
    "rise_time_ns": "ns",
    "mean_excess_delay_ns": "ns",
    "rms_delay_spread_ns": "ns",
    "kurtosis": "1",
    "first_path_lead_ns": "ns",
}


@dataclass(frozen=True)
class Observables:
    """Observables of n rows: `values` [n, p] float64 (NaN = unknown), `names` and `units` [p]."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Floats

    def column(self, name: str) -> Floats:
        """Return one observable [n]."""
        return self.values[:, self.names.index(name)]

    def keep(self, names: tuple[str, ...]) -> Observables:
        """Return only the named observables, in that order."""
        place = [self.names.index(name) for name in names]
        return Observables(names, tuple(self.units[i] for i in place), self.values[:, place])


def profile_names() -> tuple[str, ...]:
    """Return the names of the delay-resolved profile bins, e.g. `profile_db[6.5..10.5ns]`."""
    edges = PROFILE_EDGES_NS
    return tuple(f"profile_db[{a:g}..{b:g}ns]" for a, b in pairwise(edges))


def observe(frame: pd.DataFrame) -> Observables:
    """Return every observable the table's columns allow, as [n, p].

    `frame` is a recordings table; `error_m` is computed from the ranges where it is absent.
    """
    columns = {name: _scalar(frame, name) for name in SCALARS}
    found = {name: value for name, value in columns.items() if np.isfinite(value).any()}
    units = {name: SCALARS[name] for name in found}
    if "cir" in frame and "first_path_index" in frame and len(frame):
        shape = _shape_observables(frame)
        found |= shape
        units |= {name: FEATURES.get(name, "dB") for name in shape}
    values = np.stack(list(found.values()), axis=1) if found else np.empty((len(frame), 0))
    return Observables(tuple(found), tuple(units[name] for name in found), values)


def error_m(frame: pd.DataFrame) -> Floats:
    """Return measured - true range [n] in metres, NaN where it is not known."""
    if "error_m" in frame:
        return _numbers(frame["error_m"])
    if "range_m" in frame and "true_range_m" in frame:
        return _numbers(frame["range_m"]) - _numbers(frame["true_range_m"])
    return np.full(len(frame), np.nan)


def _scalar(frame: pd.DataFrame, name: str) -> Floats:
    """Return one scalar observable, infinities as NaN."""
    if name == "error_m":
        value = error_m(frame)
    elif name in frame:
        value = _numbers(frame[name])
    else:
        return np.full(len(frame), np.nan)
    return np.where(np.isfinite(value), value, np.nan)


def _numbers(column: pd.Series) -> Floats:
    """Return a column as float64, anything that is not a number as NaN."""
    return np.asarray(pd.to_numeric(column, errors="coerce"), np.float64)


def aligned(frame: pd.DataFrame) -> tuple[Floats, Floats]:
    """Return magnitudes around the first path and their delays.

    Gives [n, BEFORE + AFTER] (NaN outside the CIR) and delays in ns after the first path, same
    shape. Rows may have CIRs of different lengths.
    """
    first = _numbers(frame["first_path_index"])
    start = np.floor(np.nan_to_num(first)).astype(np.int64) - BEFORE
    out = np.full((len(frame), BEFORE + AFTER), np.nan)
    for row, (cir, begin) in enumerate(zip(frame["cir"], start, strict=True)):
        low, high = max(begin, 0), min(begin + BEFORE + AFTER, len(cir))
        if high > low:
            out[row, low - begin : high - begin] = cir[low:high]
    out[~np.isfinite(first)] = np.nan
    index = start[:, None] + np.arange(BEFORE + AFTER)
    return out, (index - first[:, None]) * _period_ns(frame)[:, None]


def _period_ns(frame: pd.DataFrame) -> Floats:
    """Return the sample period [n] in ns."""
    if "sample_period_ns" in frame:
        return np.nan_to_num(_numbers(frame["sample_period_ns"]), nan=SAMPLE_PERIOD_NS)
    return np.full(len(frame), SAMPLE_PERIOD_NS)


def _shape_observables(frame: pd.DataFrame) -> dict[str, Floats]:
    """Return profile bins and features of the CIR, each [n]."""
    magnitude, delay = aligned(frame)
    per_symbol = magnitude / _symbols(frame)[:, None]
    power = per_symbol**2
    total = np.nansum(power, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        bins = _profile_db(power, delay, total)
        features = _features(per_symbol, power, delay, total, _noise(frame, magnitude))
    every = bins | features
    return {name: np.where(np.isfinite(value), value, np.nan) for name, value in every.items()}


def _symbols(frame: pd.DataFrame) -> Floats:
    """Return accumulated preamble symbols [n]: amplitudes are proportional to them."""
    if "preamble_count" not in frame:
        return np.ones(len(frame))
    count = _numbers(frame["preamble_count"])
    return np.where(count > 0, count, np.nan)


def _noise(frame: pd.DataFrame, magnitude: Floats) -> Floats:
    """Return the noise std per symbol [n]: as logged, else from the samples before the path."""
    logged = _scalar(frame, "noise_std")
    early = np.sqrt(np.nanmean(magnitude[:, : BEFORE - 3] ** 2, axis=1) / 2)
    return np.where(np.isfinite(logged), logged, early) / _symbols(frame)


def _profile_db(power: Floats, delay: Floats, total: Floats) -> dict[str, Floats]:
    """Return mean power per delay bin relative to the energy of the window, in dB."""
    edges = PROFILE_EDGES_NS
    out = {}
    for name, low, high in zip(profile_names(), edges, edges[1:], strict=False):
        inside = (delay >= low) & (delay < high) & np.isfinite(power)
        mean = np.where(inside, power, 0.0).sum(axis=1) / inside.sum(axis=1)
        out[name] = 10 * np.log10(mean / total)
    return out


def _features(
    magnitude: Floats, power: Floats, delay: Floats, total: Floats, noise: Floats
) -> dict[str, Floats]:
    """Return the six features of Marano et al. (2010) and the first-path lead, each [n]."""
    filled = np.nan_to_num(magnitude)
    peak = filled.max(axis=1)
    weight = np.nan_to_num(power) / total[:, None]
    excess = (weight * delay).sum(axis=1)
    spread = np.sqrt((weight * (delay - excess[:, None]) ** 2).sum(axis=1))
    mean = np.nanmean(magnitude, axis=1, keepdims=True)
    var = np.nanmean((magnitude - mean) ** 2, axis=1)
    reach = _first_delay(filled >= RISE_HIGH * peak[:, None], delay)
    rise = reach - _first_delay(filled >= RISE_LOW * noise[:, None], delay)
    lead = -_first_delay(filled >= LEAD_LEVEL * noise[:, None], delay)
    return {
        "energy_db": 10 * np.log10(total),
        "max_amplitude_db": 20 * np.log10(peak),
        "rise_time_ns": rise,
        "mean_excess_delay_ns": excess,
        "rms_delay_spread_ns": spread,
        "kurtosis": np.nanmean((magnitude - mean) ** 4, axis=1) / var**2,
        "first_path_lead_ns": lead,
    }


def _first_delay(above: NDArray[np.bool_], delay: Floats) -> Floats:
    """Return the delay of the first True per row [n] in ns, NaN where there is none."""
    first = above.argmax(axis=1)
    found = delay[np.arange(len(delay)), first]
    return np.where(above.any(axis=1), found, np.nan)
