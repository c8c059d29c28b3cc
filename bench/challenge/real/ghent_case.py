"""`ghent` IIoT_20 with ranges recomputed single-sided: the crystals, and by how much.

The double-sided exchange of the same rows gives the true clock offset, for the checks alone.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.real.case import (
    Check,
    Progress,
    RealCase,
    every_named,
    markdown_table,
    names_it,
)
from bench.discrepancy import Options, diagnose
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.clocks import device_clock
from bench.physics.base import Base
from bench.physics.effects.fitted.device_clock import DeviceClock
from bench.physics.simulator import Simulator
from bench.physics.units import C_M_PER_NS
from bench.recordings.table import Recordings

Floats = NDArray[np.float64]
Rows = NDArray[np.intp]
SEEN = (
    "environment", "link", "tx", "rx", "los", "true_range_m", "rx_power_dbm",
    "first_path_power_dbm", "noise_std", "preamble_count", "time_s", "reply_time_s",
    "temperature_c",
)  # fmt: skip
BIN_S = 30.0
STRETCH = 20  # rows
PPM_BAR, RANGE_BAR_M = 0.05, 0.5


def ghent(table: Recordings, seed: int, progress: Progress) -> RealCase:
    """IIoT_20 with ranges recomputed single-sided and every clock column hidden."""
    shown, truth = prepared(table)
    recorded = Recordings(shown, "ghent IIoT_20, single-sided", table.licence)
    options = Options(seed, observables=("error_m",), waveform=False)
    found = diagnose(recorded, Simulator(Base(channel=3), name="base"), options, progress)
    curves = clock_curves(shown, truth)
    links = leave_link_out(shown, truth)
    checks = (
        Check("says crystal offset", every_named(found), names_it(found, "clock-offset")),
        *_clock_checks(shown, truth, curves, links),
    )
    lines = (*markdown_table(curves), "", *markdown_table(links), "", *_limit(shown, truth))
    return RealCase("ghent IIoT_20, single-sided ranging", found, checks, lines)


def prepared(table: Recordings) -> tuple[pd.DataFrame, Floats]:
    """Return the rows as the diagnosis sees them, and the true offset of each [n] in ppm."""
    from bench.recordings.twr import intervals

    whole = table.frame[table.frame["environment"] == "IIoT_20"].reset_index(drop=True)
    exchange = intervals(whole)
    shown = whole[[c for c in SEEN if c in whole]].assign(range_m=exchange.single_sided_m())
    shown["error_m"] = shown["range_m"] - shown["true_range_m"]
    return shown, exchange.clock_offset_ppm()


def _clock_checks(
    shown: pd.DataFrame, truth: Floats, curves: pd.DataFrame, links: pd.DataFrame
) -> tuple[Check, ...]:
    """Return the checks of offsets and ranges, the stricter ones too."""
    before = float(shown["error_m"].abs().mean())
    worst = float((curves["diagnosed_ppm"] - curves["double_sided_ppm"]).abs().max())
    inside, ahead = stretches_out(shown, truth), second_halves(shown, truth)
    every = float(links["range_mae_m"].mean())
    return (
        Check(f"ppm per pair over time within {PPM_BAR} ppm of the double-sided exchange",
              f"worst {worst:.4f} ppm", worst < PPM_BAR),
        Check(f"range error under {RANGE_BAR_M} m, stretches held out ({STRETCH} rows each)",
              f"{before:.1f} m -> {inside[0]:.3f} m, worst offset {inside[1]:.4f} ppm",
              inside[0] < RANGE_BAR_M),
        Check(f"range error under {RANGE_BAR_M} m, second half of every recording forecast",
              f"{before:.1f} m -> {ahead[0]:.3f} m, worst offset {ahead[1]:.4f} ppm",
              ahead[0] < RANGE_BAR_M),
        Check(f"offsets of pairs never heard together within {PPM_BAR} ppm",
              f"worst {links['mean_abs_ppm'].max():.4f} ppm (each pair from the other three)",
              bool(links["mean_abs_ppm"].max() < PPM_BAR)),
        Check(f"range error under {RANGE_BAR_M} m, pairs never heard together (stricter)",
              f"{before:.1f} m -> mean {every:.2f} m, worst {links['range_mae_m'].max():.2f} m",
              every < RANGE_BAR_M),
    )  # fmt: skip


def _view(frame: pd.DataFrame, rows: Rows) -> View:
    """Return some rows as a diagnosis sees them: the range error alone."""
    return view(frame, link_codes(frame), rows, Window(), ("error_m",), False)


def _fitted(frame: pd.DataFrame, rows: Rows) -> DeviceClock:
    """Return the clocks that the diagnosis' own fit finds in some rows."""
    seen = _view(frame, rows)
    return device_clock(seen, seen.recorded.column("error_m"))


def _metres_per_ppm(frame: pd.DataFrame) -> Floats:
    """Return c/2 x reply time x 1 ppm [n] in metres."""
    return np.asarray(frame["reply_time_s"].to_numpy(np.float64) * C_M_PER_NS / 2 * 1e3)


def clock_curves(frame: pd.DataFrame, truth_ppm: Floats) -> pd.DataFrame:
    """Return ppm per device pair over time: as diagnosed from all rows, and double-sided."""
    every = np.arange(len(frame))
    found = _fitted(frame, every).offset_ppm(_view(frame, every).scene)
    rows = pd.DataFrame(
        {
            "pair": frame["tx"].astype(str) + " -> " + frame["rx"].astype(str),
            "time_s": (frame["time_s"] // BIN_S) * BIN_S + BIN_S / 2,
            "diagnosed_ppm": found,
            "double_sided_ppm": truth_ppm,
        }
    )
    return rows.groupby(["pair", "time_s"], as_index=False).median()


def held_out(frame: pd.DataFrame, kept: Rows, held: Rows) -> tuple[Floats, Floats, Floats]:
    """Return offset, its standard deviation (both ppm) and range left (m) of held-out rows."""
    clock, aside = _fitted(frame, kept), _view(frame, held)
    offset = clock.offset_ppm(aside.scene)
    left = frame["error_m"].to_numpy(np.float64)[held] - offset * _metres_per_ppm(aside.frame)
    return offset, clock.uncertainty_ppm(aside.scene), left


def leave_link_out(frame: pd.DataFrame, truth_ppm: Floats) -> pd.DataFrame:
    """Return, per link, its offset and range error predicted from all other links."""
    links = link_codes(frame)
    out = []
    for link in np.unique(links):
        kept, held = np.flatnonzero(links != link), np.flatnonzero(links == link)
        offset, spread, left = held_out(frame, kept, held)
        out.append(
            {
                "held-out link": frame["link"].iloc[held[0]],
                "mean_abs_ppm": float(np.abs(offset - truth_ppm[held]).mean()),
                "own_estimate_of_std_ppm": float(spread.mean()),
                "before_mae_m": float(frame["error_m"].iloc[held].abs().mean()),
                "range_mae_m": float(np.abs(left).mean()),
            }
        )
    return pd.DataFrame(out)


def _scored(frame: pd.DataFrame, truth_ppm: Floats, kept: Rows, held: Rows) -> tuple[float, float]:
    """Return the mean abs. range left (m) and the worst offset error of a row (ppm)."""
    offset, _, left = held_out(frame, kept, held)
    return float(np.abs(left).mean()), float(np.abs(offset - truth_ppm[held]).max())


def stretches_out(frame: pd.DataFrame, truth_ppm: Floats) -> tuple[float, float]:
    """Return range (m) and offset error (ppm) of every second stretch, from the others."""
    odd = (_place(frame) // STRETCH) % 2 == 1
    return _scored(frame, truth_ppm, np.flatnonzero(~odd), np.flatnonzero(odd))


def second_halves(frame: pd.DataFrame, truth_ppm: Floats) -> tuple[float, float]:
    """Return range (m) and offset error (ppm) of the second half of every pair's recording."""
    place = _place(frame)
    size = frame.groupby(["tx", "rx"])["time_s"].transform("size").to_numpy()
    late = place >= size // 2
    return _scored(frame, truth_ppm, np.flatnonzero(~late), np.flatnonzero(late))


def _place(frame: pd.DataFrame) -> Rows:
    """Return the number of each row in the recording of its pair [n], in time order."""
    return np.asarray(frame.groupby(["tx", "rx"])["time_s"].rank("first").to_numpy() - 1, np.intp)


def _limit(frame: pd.DataFrame, truth_ppm: Floats) -> list[str]:
    """Return why pairs never heard together cannot be ranged better, from the true offsets."""
    rows = frame[["link", "tx", "rx", "time_s"]].assign(
        ppm=np.where(frame["tx"] < frame["rx"], truth_ppm, -truth_ppm)
    )
    means = rows.groupby(["link", "tx"])[["time_s", "ppm"]].mean().groupby("link")
    step = (means.max() - means.min()).abs()
    hours, moved = step["time_s"] / 3600, step["ppm"]
    metres = float(np.median(_metres_per_ppm(frame)))
    return [
        f"The two recordings of a pair lie {hours.min():.1f} to {hours.max():.1f} h apart; "
        f"between them its true offset moved by {moved.min():.3f} to {moved.max():.3f} ppm, "
        f"which is {metres * moved.min():.2f} to {metres * moved.max():.2f} m of range at this "
        f"reply time ({metres:.1f} m per ppm). {RANGE_BAR_M} m would take the offset to "
        f"{RANGE_BAR_M / metres:.3f} ppm at a time when the pair was not recorded.",
    ]
