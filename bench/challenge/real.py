"""Real recordings with the revealing columns hidden, and those columns used only to check.

Each case returns what was said and a list of checks with the bar, the value and whether it is met.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.latent import device_clock, power_curve
from bench.discrepancy.observables import Window
from bench.discrepancy.split import link_codes
from bench.discrepancy.study import Options, Study, study
from bench.discrepancy.terms import PowerCurve
from bench.discrepancy.world import Resimulation, view
from bench.physics.base import Base
from bench.physics.effects.ranging.power_bias import published_bias_m
from bench.physics.simulator import Simulator
from bench.physics.units import C_M_PER_NS
from bench.recordings.table import Recordings

Floats = NDArray[np.float64]
Tell = Callable[[str], None]
BIN_S = 30.0
STRETCH = 20  # rows
GHENT_SEEN = (
    "environment", "link", "tx", "rx", "los", "true_range_m", "rx_power_dbm",
    "first_path_power_dbm", "noise_std", "preamble_count", "time_s", "reply_time_s",
    "temperature_c",
)  # fmt: skip
OUTDOOR_SEEN = (
    "environment", "tx", "rx", "range_m", "true_range_m", "rx_power_dbm", "first_path_power_dbm",
    "noise_std", "preamble_count", "reply_time_s", "tx_x_m", "tx_y_m", "tx_z_m", "rx_x_m",
    "rx_y_m", "rx_z_m",
)  # fmt: skip
FADE_DBM = -86.0  # below this the outdoor link is in a null of the ground reflection


@dataclass(frozen=True)
class Check:
    """One bar: what is asked, what was measured, whether it is met."""

    asked: str
    measured: str
    met: bool


@dataclass(frozen=True)
class RealCase:
    """A real case: its study, its checks, and tables for the report (Markdown lines)."""

    title: str
    study: Study
    checks: tuple[Check, ...]
    lines: tuple[str, ...]


def first_named(found: Study) -> str:
    """Return the names of the first verdict, or its kind."""
    first = found.diagnosis.verdicts[0]
    return " or ".join(first.names) or type(first).__name__


def ghent(table: Recordings, seed: int, tell: Tell) -> RealCase:
    """IIoT_20 with ranges recomputed single-sided and every clock column hidden.

    The double-sided exchange of the same rows gives the true offset, for the check alone.
    """
    from bench.recordings.twr import intervals

    whole = table.frame[table.frame["environment"] == "IIoT_20"].reset_index(drop=True)
    exchange = intervals(whole)
    truth_ppm = exchange.clock_offset_ppm()
    shown = whole[[c for c in GHENT_SEEN if c in whole]].assign(range_m=exchange.single_sided_m())
    shown["error_m"] = shown["range_m"] - shown["true_range_m"]
    recorded = Recordings(shown, "ghent IIoT_20, single-sided", table.licence)
    options = Options(seed, observables=("error_m",), waveform=False)
    found = study(recorded, Simulator(Base(channel=3), name="base"), options, tell)
    curves = clock_curves(shown, truth_ppm)
    left = leave_link_out(shown, truth_ppm)
    tracked = track_error_m(shown)
    before = float(shown["error_m"].abs().mean())
    worst = float((curves["single_sided_ppm"] - curves["double_sided_ppm"]).abs().max())
    named = first_named(found)
    every = float(left["range_mae_m"].mean())
    checks = (
        Check("says crystal offset", named, named == "clock-offset"),
        Check("ppm per pair over time within 0.05 ppm", f"worst {worst:.4f} ppm", worst < 0.05),
        Check(
            "offsets of held-out links within 0.05 ppm",
            f"worst {left['mean_abs_ppm'].max():.4f} ppm (each link predicted from the others)",
            bool(left["mean_abs_ppm"].max() < 0.05),
        ),
        Check(
            "range error under 0.5 m, held-out stretches of the same links",
            f"{before:.1f} m -> {tracked:.3f} m",
            tracked < 0.5,
        ),
        Check(
            "range error under 0.5 m, held-out LINKS (stricter)",
            f"{before:.1f} m -> mean {every:.2f} m, worst {left['range_mae_m'].max():.2f} m",
            every < 0.5,
        ),
    )
    lines = (*_table(curves), "", *_table(left))
    return RealCase("ghent IIoT_20, single-sided ranging", found, checks, lines)


def _ppm_per_metre(frame: pd.DataFrame) -> Floats:
    """Return 1 / (c/2 x reply time) [n]: ppm of clock offset per metre of error."""
    reply_ns = frame["reply_time_s"].to_numpy(np.float64) * 1e9
    return np.asarray(2e6 / (C_M_PER_NS * reply_ns))


def clock_curves(frame: pd.DataFrame, truth_ppm: Floats) -> pd.DataFrame:
    """Return ppm per device pair over time: from single-sided errors, and double-sided."""
    ppm = frame["error_m"].to_numpy(np.float64) * _ppm_per_metre(frame)
    rows = pd.DataFrame(
        {
            "pair": frame["tx"].astype(str) + " -> " + frame["rx"].astype(str),
            "time_s": (frame["time_s"] // BIN_S) * BIN_S + BIN_S / 2,
            "single_sided_ppm": ppm,
            "double_sided_ppm": truth_ppm,
        }
    )
    return rows.groupby(["pair", "time_s"], as_index=False).median()


def leave_link_out(frame: pd.DataFrame, truth_ppm: Floats) -> pd.DataFrame:
    """Return, per link, its offset and range error predicted from all other links."""
    links = link_codes(frame)
    out = []
    for link in np.unique(links):
        kept, held = np.flatnonzero(links != link), np.flatnonzero(links == link)
        learnt = view(frame, links, kept, Window(), ("error_m",), False)
        clock = device_clock(learnt, learnt.recorded.column("error_m"))
        aside = view(frame, links, held, Window(), ("error_m",), False)
        offset = clock.offset_ppm(aside.scene)
        error = frame["error_m"].to_numpy()[held]
        left = error - offset / _ppm_per_metre(aside.frame)
        out.append(
            {
                "held-out link": aside.frame["link"].iloc[0],
                "mean_abs_ppm": float(np.abs(offset - truth_ppm[held]).mean()),
                "before_mae_m": float(np.abs(error).mean()),
                "range_mae_m": float(np.abs(left).mean()),
            }
        )
    return pd.DataFrame(out)


def track_error_m(frame: pd.DataFrame) -> float:
    """Return the mean abs. error left on every second stretch, tracked from the others."""
    error, scale = frame["error_m"].to_numpy(np.float64), _ppm_per_metre(frame)
    time = frame["time_s"].to_numpy(np.float64)
    left = []
    for rows in frame.groupby(["tx", "rx"]).indices.values():
        odd = (np.arange(len(rows)) // STRETCH) % 2 == 1
        known, held = rows[~odd], rows[odd]
        order = np.argsort(time[known])
        smooth = pd.Series((error * scale)[known][order]).rolling(15, 1, center=True).median()
        offset = np.interp(time[held], time[known][order], smooth.to_numpy())
        left.append(np.abs(error[held] - offset / scale[held]))
    return float(np.concatenate(left).mean())


def outdoor(table: Recordings, seed: int, tell: Tell) -> RealCase:
    """Line of sight outdoors, split by height: is it the power-dependent bias, or distance."""
    frame = table.frame
    sight = frame[frame["los"].astype(bool)].reset_index(drop=True)
    shown = sight[[c for c in OUTDOOR_SEEN if c in sight]].assign(
        link="height " + sight["tx_z_m"].map("{:.3f} m".format)
    )
    recorded = Recordings(shown, "outdoor, line of sight", table.licence)
    options = Options(seed, observables=("error_m",), waveform=False)
    found = study(recorded, Simulator(Base(channel=5), name="base"), options, tell)
    spread = heights_out(shown)
    confirmed = confirm_spread(found)
    named = first_named(found)
    slope, p = slope_at_fixed_distance(shown)
    curve = next((e for e in found.added if isinstance(e, PowerCurve)), None)
    checks = (
        Check("names the power-dependent bias, not distance", named, named == "power-bias"),
        Check(
            "at one and the same distance, error falls as the level rises",
            f"{100 * slope:+.2f} cm per dB above {FADE_DBM:g} dBm, p = {p:.3g} "
            "(permutation over heights)",
            slope < 0 and p < 0.05,
        ),
        Check(
            "spread at least halved on heights held out (each in turn)",
            f"{100 * spread[0]:.1f} cm -> {100 * spread[1]:.1f} cm; on the confirm heights "
            f"{100 * confirmed[0]:.1f} cm -> {100 * confirmed[1]:.1f} cm",
            spread[1] <= spread[0] / 2,
        ),
        Check(
            "fitted curve compared with the published one, point by point",
            "see the table" if curve else "no curve was fitted",
            curve is not None,
        ),
    )
    return RealCase("outdoor, line of sight", found, checks, tuple(_curve_lines(curve)))


def heights_out(frame: pd.DataFrame) -> tuple[float, float]:
    """Return the standard deviation of the error, and of what the bias curve leaves, in metres.

    The curve of each height is fitted on all other heights.
    """
    links = link_codes(frame)
    error = (frame["range_m"] - frame["true_range_m"]).to_numpy(np.float64)
    left = np.empty(len(frame))
    world = Resimulation(Simulator(Base(channel=5)), Window())
    for height in np.unique(links):
        kept, held = np.flatnonzero(links != height), np.flatnonzero(links == height)
        learnt = view(frame, links, kept[::4], Window(), ("error_m",), False)
        curve = power_curve(world, learnt, ())
        assert curve is not None
        aside = view(frame, links, held, Window(), ("error_m",), False)
        guess = np.interp(curve.level_dbm(aside.scene), curve.levels_dbm, curve.bias_m)
        left[held] = error[held] - guess
    return float(error.std()), float(left.std())


def confirm_spread(found: Study) -> tuple[float, float]:
    """Return the standard deviation of the residual range error on confirm heights, in metres."""
    seen = found.confirmed
    which = seen.before.names.index("error_m")
    before = float(np.nanstd(seen.before.residual[:, which]))
    return before, float(np.nanstd(seen.after.residual[:, which]))


def slope_at_fixed_distance(frame: pd.DataFrame, permutations: int = 999) -> tuple[float, float]:
    """Return the slope of error over logged level (m/dB) within distances, and its p value.

    One value per position; every height's mean error is removed first. Levels in a null of the
    ground reflection are left out: there the bounce inside the pulse shortens ranges. Under the
    null the levels of different heights at one distance are exchangeable.
    """
    error = frame["range_m"] - frame["true_range_m"]
    place = [frame["link"], frame["tx_x_m"]]
    means = pd.DataFrame({"e": error, "p": frame["rx_power_dbm"]}).groupby(place).mean()
    means = means.reset_index()
    means["e"] -= means.groupby("link")["e"].transform("mean")
    means = means[means["p"] > FADE_DBM]
    level = means["p"] - means.groupby("tx_x_m")["p"].transform("mean")
    left = means["e"] - means.groupby("tx_x_m")["e"].transform("mean")
    x, y = level.to_numpy(np.float64), left.to_numpy(np.float64)
    seen = float(x @ y)
    rng = np.random.default_rng(0)
    groups = list(means.groupby("tx_x_m").indices.values())
    null = np.empty(permutations)
    for number in range(permutations):
        shuffled = x.copy()
        for rows in groups:
            shuffled[rows] = x[rng.permutation(rows)]
        null[number] = shuffled @ y
    p = (1 + np.sum(np.abs(null) >= abs(seen))) / (permutations + 1)
    return seen / float(x @ x), float(p)


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
    return [*_table(rows), "", note]


def _table(frame: pd.DataFrame) -> list[str]:
    """Return a frame as a Markdown table."""
    head = ["| " + " | ".join(map(str, frame.columns)) + " |", "|" + " --- |" * frame.shape[1]]
    body = [
        "| " + " | ".join(f"{v:.4g}" if isinstance(v, float) else str(v) for v in row) + " |"
        for row in frame.itertuples(index=False)
    ]
    return [*head, *body]
