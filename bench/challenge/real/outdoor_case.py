"""`outdoor`, line of sight: the power-dependent bias, told from distance."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.real.case import Check, Progress, RealCase, first_named, markdown_table
from bench.challenge.real.two_ray import (
    PERMITTIVITY,
    excess_m,
    gain_of_sum,
    reflected,
    shift_m,
)
from bench.discrepancy import Diagnosis, Options, diagnose
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.per_device import power_curve
from bench.discrepancy.settings import UNCOMPRESSED_DBM
from bench.physics.base import Base
from bench.physics.effects.fitted.power_curve import LOGGED_DBM, TRUE_DBM, PowerCurve
from bench.physics.effects.ranging.power_bias import published_bias_m
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings

Floats = NDArray[np.float64]
SEEN = (
    "environment", "tx", "rx", "range_m", "true_range_m", "rx_power_dbm", "first_path_power_dbm",
    "noise_std", "preamble_count", "reply_time_s", "tx_x_m", "tx_y_m", "tx_z_m", "rx_x_m",
    "rx_y_m", "rx_z_m",
)  # fmt: skip
PERMUTATIONS = 999
WILD_M = 0.5  # a range farther off than this is a gross error, not a bias


def outdoor(table: Recordings, seed: int, progress: Progress) -> RealCase:
    """Line of sight outdoors, split by height: is it the power-dependent bias, or distance."""
    shown = prepared(table)
    recorded = Recordings(shown, "outdoor, line of sight", table.licence)
    options = Options(seed, observables=("error_m",), waveform=False)
    found = diagnose(recorded, Simulator(Base(channel=5), name="base"), options, progress)
    curve = next((e for e in found.added if isinstance(e, PowerCurve)), None)
    named = first_named(found)
    places = positions(shown)
    checks = (
        Check("names the power-dependent bias, not distance", named, named == "power-bias"),
        _fixed_distance_check(places),
        *_spread_checks(shown, found),
        Check(
            "fitted curve compared with the published one, point by point",
            "see the table" if curve else "no curve was fitted",
            curve is not None,
        ),
    )
    lines = (*_curve_lines(curve), "", *_slope_lines(places))
    return RealCase("outdoor, line of sight", found, checks, lines)


def prepared(table: Recordings) -> pd.DataFrame:
    """Return the rows in line of sight as the diagnosis sees them, a height as a link."""
    sight = table.frame[table.frame["los"].astype(bool)].reset_index(drop=True)
    shown = sight[[c for c in SEEN if c in sight]]
    return shown.assign(link="height " + sight["tx_z_m"].map("{:.3f} m".format))


def _fixed_distance_check(places: pd.DataFrame) -> Check:
    """Return whether error falls with level among heights at one distance, the bounce modelled."""
    slope, p = slope_at_fixed_distance(places, bounce_m(places, PERMITTIVITY, vertical=True))
    return Check(
        "at one and the same distance, error falls as the level rises (no position left out, the "
        "ground's reflection modelled from geometry)",
        f"{100 * slope:+.2f} cm per dB, p = {p:.3g} (permutation over heights)",
        slope < 0 and p < 0.05,
    )


def _spread_checks(shown: pd.DataFrame, found: Diagnosis) -> tuple[Check, ...]:
    """Return how far the spread falls on held-out heights: all in turn, and the sealed ones."""
    error, by_level, by_distance = heights_out(shown)
    each = error.std(), by_level.std()
    before, after = confirm_residuals(found)
    sealed, middle = (before.std(), after.std()), (_middle_std(before), _middle_std(after))
    wild = int(np.sum(np.abs(after - np.median(after)) > WILD_M))
    return (
        Check(
            "spread at least halved on held-out heights, each height in turn",
            f"{_cm(each)} (standard deviation); a curve over distance instead: "
            f"{100 * by_distance.std():.1f} cm",
            bool(each[1] <= each[0] / 2),
        ),
        Check(
            "spread at least halved on the sealed heights, central 90 % of rows",
            f"{_cm(middle)} (as a normal's standard deviation)",
            middle[1] <= middle[0] / 2,
        ),
        Check(
            "the same over all rows (stricter)",
            f"{_cm(sealed)}; {wild} of {len(after)} rows are more than {WILD_M:g} m off",
            bool(sealed[1] <= sealed[0] / 2),
        ),
    )


def _cm(pair: tuple[float, float]) -> str:
    """Return before and after in centimetres."""
    return f"{100 * pair[0]:.1f} cm -> {100 * pair[1]:.1f} cm"


def _middle_std(values: Floats) -> float:
    """Return the distance of the 5 and 95 % points over that of a standard normal."""
    low, high = np.percentile(values, [5, 95])
    return float((high - low) / (2 * 1.6449))


def heights_out(frame: pd.DataFrame) -> tuple[Floats, Floats, Floats]:
    """Return the error of every row [n], and what is left of it in metres.

    First by the bias curve over level, then by a curve over distance; both of each height are
    fitted on all other heights.
    """
    links = link_codes(frame)
    error = (frame["range_m"] - frame["true_range_m"]).to_numpy(np.float64)
    by_level, by_distance = np.empty(len(frame)), np.empty(len(frame))
    comparison = Resimulation(Simulator(Base(channel=5)), Window())
    for height in np.unique(links):
        kept, held = np.flatnonzero(links != height)[::4], np.flatnonzero(links == height)
        curve = power_curve(comparison, view(frame, links, kept, Window(), ("error_m",), False), ())
        assert curve is not None
        aside = view(frame, links, held, Window(), ("error_m",), False)
        guess = np.interp(curve.level_dbm(aside.scene), curve.levels_dbm, curve.bias_m)
        by_level[held] = error[held] - guess
        means = pd.Series(error[kept]).groupby(frame["tx_x_m"].to_numpy()[kept]).mean()
        far = frame["tx_x_m"].to_numpy()[held]
        by_distance[held] = error[held] - np.interp(far, means.index, means)
    return error, by_level, by_distance


def confirm_residuals(found: Diagnosis) -> tuple[Floats, Floats]:
    """Return the residual range error on the confirm heights before and after, in metres."""
    seen = found.confirmed
    which = seen.before.names.index("error_m")
    pair = [e.residual[:, which] for e in (seen.before, seen.after)]
    return pair[0][np.isfinite(pair[0])], pair[1][np.isfinite(pair[1])]


def positions(frame: pd.DataFrame) -> pd.DataFrame:
    """Return one row per position: mean error (m), logged level (dBm) and geometry (m)."""
    columns = {
        "error": frame["range_m"] - frame["true_range_m"],
        "level": frame["rx_power_dbm"],
        "distance": frame["true_range_m"],
        "height": frame["tx_z_m"],
        "other": frame["rx_z_m"],
    }
    return pd.DataFrame(columns).groupby([frame["link"], frame["tx_x_m"]]).mean().reset_index()


def bounce_m(places: pd.DataFrame, permittivity: float, *, vertical: bool) -> Floats:
    """Return the range shift by the ground's reflection [n]; 0 where the level is compressed."""
    distance, height, other = _geometry(places)
    amplitude = reflected(distance, height, other, permittivity, vertical)
    gain = gain_of_sum(_true_level_dbm(places), distance, amplitude)
    shift = shift_m(excess_m(distance, height, other), amplitude, gain)
    return np.nan_to_num(shift)


def _geometry(places: pd.DataFrame) -> tuple[Floats, Floats, Floats]:
    """Return distance and both heights [n] in metres."""
    distance, height, other = (
        places[name].to_numpy(np.float64) for name in ("distance", "height", "other")
    )
    return distance, height, other


def _true_level_dbm(places: pd.DataFrame) -> Floats:
    """Return the true level [n], NaN where the logged one is compressed."""
    level = places["level"].to_numpy(np.float64)
    true = np.interp(level, LOGGED_DBM, TRUE_DBM)
    return np.where(level < UNCOMPRESSED_DBM, true, np.nan)


def nulls_db(places: pd.DataFrame, permittivity: float, *, vertical: bool) -> tuple[float, float]:
    """Return the depth of the deepest null in dB below the direct path: measured, possible."""
    distance, height, other = _geometry(places)
    amplitude = reflected(distance, height, other, permittivity, vertical)
    flat = 10 ** (_true_level_dbm(places) / 10) * distance**2
    seen = flat / np.nanmean(flat / (1 + amplitude**2))
    deepest = int(np.nanargmin(seen))
    return -10 * float(np.log10(seen[deepest])), -20 * float(np.log10(1 - amplitude[deepest]))


def slope_at_fixed_distance(places: pd.DataFrame, shift: Floats) -> tuple[float, float]:
    """Return the slope of error over logged level (m/dB) within distances, and its p value.

    `shift` [n] is taken off the errors, then every height's mean. Under the null the levels of
    different heights at one distance are exchangeable.
    """
    error = pd.Series(places["error"] - shift)
    error = error - error.groupby(places["link"]).transform("mean")
    x, y = (
        (column - column.groupby(places["tx_x_m"]).transform("mean")).to_numpy(np.float64)
        for column in (places["level"], error)
    )
    rng = np.random.default_rng(0)
    groups = list(places.groupby("tx_x_m").indices.values())
    null = np.empty(PERMUTATIONS)
    for number in range(PERMUTATIONS):
        shuffled = x.copy()
        for rows in groups:
            shuffled[rows] = x[rng.permutation(rows)]
        null[number] = shuffled @ y
    p = (1 + np.sum(np.abs(null) >= abs(x @ y))) / (PERMUTATIONS + 1)
    return float(x @ y / (x @ x)), float(p)


def _slope_lines(places: pd.DataFrame) -> list[str]:
    """Return the slope at fixed distance under every assumption on the ground, as Markdown."""
    slope, p = slope_at_fixed_distance(places, np.zeros(len(places)))
    rows: list[tuple[object, ...]] = [("not modelled", 100 * slope, p, "-", "-")]
    for vertical, name in ((True, "vertical"), (False, "horizontal")):
        for eps in (3.0, PERMITTIVITY, 15.0):
            shift = bounce_m(places, eps, vertical=vertical)
            slope, p = slope_at_fixed_distance(places, shift)
            depth = nulls_db(places, eps, vertical=vertical)
            rows.append((f"{name}, permittivity {eps:g}", 100 * slope, p, *depth))
    columns = [
        "reflection off the ground", "slope (cm per dB)", "p",
        "deepest null measured (dB)", "deepest possible there (dB)",
    ]  # fmt: skip
    note = (
        "Error over level at one and the same distance, all positions. In a null of the reflection "
        "the level falls and the range shortens, against the bias. The data set does not state "
        "the polarisation; vertical is taken because nulls are as deep as it allows, not deeper."
    )
    return [note, "", *markdown_table(pd.DataFrame(rows, columns=columns))]


def _curve_lines(curve: PowerCurve | None) -> list[str]:
    """Return the fitted and the published bias, both zero at -77 dBm, as a Markdown table."""
    if curve is None:
        return []
    levels = np.arange(-61.0, -94.0, -2.0)
    fitted = np.interp(levels, curve.levels_dbm, curve.bias_m)
    zero = float(np.interp(-77.0, curve.levels_dbm, curve.bias_m))
    rows = pd.DataFrame(
        {
            "true level (dBm)": levels,
            "fitted (cm)": 100 * (fitted - zero),
            "published (cm)": 100 * published_bias_m(levels),
        }
    )
    rows["fitted - published (cm)"] = rows["fitted (cm)"] - rows["published (cm)"]
    note = f"Both curves are zero at -77 dBm; the fitted constant there is {100 * zero:.1f} cm."
    return [*markdown_table(rows), "", note]
