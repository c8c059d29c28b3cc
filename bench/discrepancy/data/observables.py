"""What can be compared: numbers per row that a simulator and a radio both give.

Works with whatever columns a table has: no CIR, no CIR observables. A value that is not known is
NaN and takes no part in any comparison.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from re import fullmatch
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.compiled import compiled
from bench.discrepancy.data.cir_features import cut, shape_figures
from bench.discrepancy.data.columns import WAVES
from bench.discrepancy.settings import (
    FARTHEST_SAMPLE,
    LEAD_LEVEL,
    NOISE_BEFORE_NS,
    PROFILE_EDGES_NS,
    RISE_HIGH,
    RISE_LOW,
    WINDOW_AFTER,
    WINDOW_BEFORE,
    WINDOW_FULL_SHARE,
)
from bench.recordings.table import SAMPLE_PERIOD_NS

Floats = NDArray[np.float64]

RANGE = "error_m"  # the observable every table has
NOISE = "noise_std"  # the noise of an accumulator, as the receiver reports it
COUNT = "preamble_count"  # how many symbols an accumulator summed up
LEVEL = "rx_power_dbm"  # the receive level, as the receiver reports it
REPORTED_LEVELS = (LEVEL, "first_path_power_dbm")
SCALARS = {
    RANGE: "m",
    "rx_power_dbm": "dB",
    "first_path_power_dbm": "dB",
    "noise_std": "counts",
    "preamble_count": "symbols",
}
FEATURES = {
    "energy_db": "dB",
    "max_amplitude_db": "dB",
    "peak_counts_db": "dB",
    "rise_time_ns": "ns",
    "mean_excess_delay_ns": "ns",
    "rms_delay_spread_ns": "ns",
    "kurtosis": "1",
    "first_path_lead_ns": "ns",
    "early_scatter": "1",
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


@cache
def profile_names() -> tuple[str, ...]:
    """Return the names of the delay-resolved profile bins, e.g. `profile_db[6.5..10.5ns]`."""
    edges = PROFILE_EDGES_NS
    return tuple(f"profile_db[{a:g}..{b:g}ns]" for a, b in pairwise(edges))


def observe(frame: pd.DataFrame, window: Window | None = None) -> Observables:
    """Return every observable the table's columns allow, as [n, p].

    `frame` is a recordings table; `error_m` is computed from the ranges where it is absent.
    """
    scalars = {name: _scalar(frame, name) for name in SCALARS}
    if "cir" not in frame or "first_path_index" not in frame or not len(frame):
        return collect(scalars)
    window = window or window_of(frame)
    magnitude, delay = aligned(frame, window)
    count = _counts(window, scalars[COUNT])
    return collect(scalars, shape_observables(magnitude, delay, count, scalars["noise_std"]))


def shape_of(
    cir: NDArray[Any], first: Floats, period_ns: float, window: Window, told: dict[str, Floats]
) -> dict[str, Floats]:
    """Return profile bins and features, each [n], of CIRs [n, K] of one sample period.

    `first` [n] are their first paths; `told` the counts and noises [n] that are logged.
    """
    magnitude, delay = around(cir, first, np.full(len(cir), period_ns), window)
    return shape_observables(magnitude, delay, _counts(window, told[COUNT]), told["noise_std"])


def _counts(window: Window, count: Floats) -> Floats:
    """Return the accumulated symbols [n] by which samples are compared, NaN where as they are."""
    return count if window.counted else np.full(len(count), np.nan)


def collect(scalars: dict[str, Floats], shape: dict[str, Floats] | None = None) -> Observables:
    """Return scalar columns and figures of the CIR, all [n], as one table of observables."""
    found = {name: value for name, value in scalars.items() if np.isfinite(value).any()}
    units = {name: SCALARS[name] for name in found}
    if shape:
        found |= shape
        units |= {name: FEATURES.get(name, "dB") for name in shape}
    rows = len(next(iter(scalars.values())))
    values = np.stack(list(found.values()), axis=1) if found else np.empty((rows, 0))
    return Observables(tuple(found), tuple(units[name] for name in found), values)


def profile_ns(name: str) -> tuple[float, float] | None:
    """Return from when to when a bin of the profile is, in ns, None of any other observable."""
    found = fullmatch(r"profile_db\[(\S+)\.\.(\S+)ns\]", name)
    return (float(found[1]), float(found[2])) if found else None


def unit_of(name: str) -> str:
    """Return the unit of an observable by its name."""
    return SCALARS.get(name) or FEATURES.get(name, "dB")


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


@dataclass(frozen=True)
class Window:
    """How much of a CIR is compared: samples before and after the detected first path.

    `counted`: samples are compared by accumulated symbol, not as they are.
    """

    before: int = 8
    after: int = 110
    counted: bool = True


def window_of(frame: pd.DataFrame) -> Window:
    """Return the widest window nearly every row of a table can fill, within bounds.

    By accumulated symbol where the table has counts.
    """
    if "cir" not in frame or "first_path_index" not in frame or not len(frame):
        return Window()
    before, after = reach(frame)
    before, after = int(np.clip(before, *WINDOW_BEFORE)), int(np.clip(after, *WINDOW_AFTER))
    return Window(before, after, bool(np.isfinite(_scalar(frame, COUNT)).any()))


def reach(frame: pd.DataFrame) -> tuple[float, float]:
    """Return how many samples before and after its first path nearly every row has."""
    few = 1 - WINDOW_FULL_SHARE
    return float(np.quantile(_first(frame), few)), float(np.quantile(after_first(frame), few))


def after_first(frame: pd.DataFrame) -> Floats:
    """Return how many samples every row has from its first path on [n]."""
    return np.array([len(cir) for cir in frame["cir"]]) - _first(frame)


def _first(frame: pd.DataFrame) -> Floats:
    """Return the whole sample in which first paths are [n]; 0 where that is not known."""
    return np.floor(np.nan_to_num(_numbers(frame["first_path_index"])))


def shared_window(frame: pd.DataFrame, other: pd.DataFrame | None) -> Window:
    """Return the window of a table that is compared with another, None: with a simulator.

    Both fill it: energies of a shorter one would be smaller by that alone. Samples are compared as
    they are where one of the tables does not tell the counts of its own.
    """
    window = window_of(frame)
    if other is None or not set(WAVES) <= {*other}:
        return window
    theirs = window_of(other)
    return Window(
        min(window.before, theirs.before),
        min(window.after, theirs.after),
        window.counted and theirs.counted,
    )


def aligned(frame: pd.DataFrame, window: Window) -> tuple[Floats, Floats]:
    """Return magnitudes around the first path and their delays.

    Gives [n, before + after] (NaN outside the CIR) and delays in ns after the first path, same
    shape. Rows may have CIRs of different lengths.
    """
    first = _numbers(frame["first_path_index"])
    cirs = frame["cir"].to_numpy()
    lengths = np.array([len(cir) for cir in cirs], np.intp)
    padded = np.full((len(frame), int(lengths.max(initial=1))), np.nan)
    for length in np.unique(lengths):
        rows = np.flatnonzero(lengths == length)
        padded[rows, :length] = np.stack([cirs[row] for row in rows])
    return around(padded, first, _period_ns(frame), window)


def around(
    cir: NDArray[Any], first: Floats, period_ns: Floats, window: Window
) -> tuple[Floats, Floats]:
    """Return `cir` [n, K] around `first` [n] and the delays in ns (see `aligned`)."""
    shape = len(cir), window.before + window.after
    magnitude, delay = np.empty(shape, cir.dtype), np.empty(shape)
    place = np.where(np.abs(first) < FARTHEST_SAMPLE, first, np.nan)
    compiled(cut)(cir, place, period_ns, window.before, magnitude, delay)
    return magnitude, delay


def _period_ns(frame: pd.DataFrame) -> Floats:
    """Return the sample period [n] in ns."""
    if "sample_period_ns" in frame:
        return np.nan_to_num(_numbers(frame["sample_period_ns"]), nan=SAMPLE_PERIOD_NS)
    return np.full(len(frame), SAMPLE_PERIOD_NS)


def shape_observables(
    magnitude: Floats, delay: Floats, count: Floats, noise_std: Floats
) -> dict[str, Floats]:
    """Return profile bins and features of aligned CIRs, each [n].

    `magnitude` and `delay` (ns after the first path) are [n, K] (see `around`); `count` are the
    accumulated symbols and `noise_std` the logged noise [n], NaN where unknown.
    """
    symbols = np.where(count > 0, count, 1.0 if np.isnan(count).all() else np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):  # rows that are all NaN stay NaN
        noise = _noise(noise_std, magnitude, delay) / symbols
        levels = (RISE_HIGH, RISE_LOW, LEAD_LEVEL)
        scaled = magnitude / symbols[:, None]
        figures, power = shape_figures(scaled, delay, noise, PROFILE_EDGES_NS, levels)
        bins = _profile_db(power, figures["total"])
        features = _features(figures)
        highest = np.nan_to_num(np.fmax.reduce(magnitude, axis=1, initial=0))
        peak = {"peak_counts_db": 20 * np.log10(highest)}
    every = bins | features | peak
    values = np.stack(list(every.values()))
    values[~np.isfinite(values)] = np.nan
    return dict(zip(every, values, strict=True))


def _noise(logged: Floats, magnitude: Floats, delay: Floats) -> Floats:
    """Return the noise std [n]: as logged, else from the samples well before the path."""
    if np.isfinite(logged).all():
        return logged
    before = (delay < NOISE_BEFORE_NS) & np.isfinite(magnitude)
    power = np.where(before, magnitude, 0.0) ** 2
    return np.where(np.isfinite(logged), logged, np.sqrt(power.sum(1) / before.sum(1) / 2))


def _profile_db(power: Floats, total: Floats) -> dict[str, Floats]:
    """Return mean power per delay bin [n, B] relative to the energy of the window, in dB."""
    return dict(zip(profile_names(), (10 * np.log10(power / total[:, None])).T, strict=True))


def _features(figures: dict[str, Floats]) -> dict[str, Floats]:
    """Return the six features of Marano et al. (2010) and what noise and first path show, [n].

    `early_scatter`: the standard deviation of the magnitudes before the path over their mean, 0.52
    of noise and less of a tone (Rice 1945).
    """
    return {
        "energy_db": 10 * np.log10(figures["total"]),
        "max_amplitude_db": 20 * np.log10(figures["peak"]),
        "rise_time_ns": figures["rise"],
        "mean_excess_delay_ns": figures["excess"],
        "rms_delay_spread_ns": figures["spread"],
        "kurtosis": figures["kurtosis"],
        "first_path_lead_ns": figures["lead"],
        "early_scatter": figures["early"],
    }
