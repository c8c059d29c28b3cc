"""`miluv`: ranges recomputed single-sided from raw timestamps, the clock columns hidden.

The third message of every exchange gives the true clock offset, the receivers' carrier recovery
(published as `skew`) another; both are used for the checks alone. Then the double-sided ranges
with their CIRs. Both by the diagnosis' defaults against the base simulator.
"""

from __future__ import annotations

from dataclasses import dataclass

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
from bench.discrepancy import Diagnosis, Options, diagnose
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.report.found_lines import describe
from bench.discrepancy.select.verdict import Ambiguous
from bench.physics.base import Base
from bench.physics.effects.fitted.device_clock import DeviceClock
from bench.physics.simulator import Simulator
from bench.physics.units import C_M_PER_NS
from bench.recordings.open import open_recordings
from bench.recordings.table import Recordings

Floats = NDArray[np.float64]
HIDDEN = ("clock_offset_ppm", "range_calibrated_m", "far_first_path_power_dbm", "initiator")
WAVEFORM = ("cir", "first_path_index", "noise_std", "sample_period_ns")
ENDS = ("tx", "rx")
PPM_BAR = 0.5  # 0.02 m at these reply times: the scatter of a range
LEFT_BAR = 0.5  # share of the single-sided error that may be left


@dataclass(frozen=True)
class Exchange:
    """Single-sided rows as shown, and what is hidden: the offset of each row in ppm, twice."""

    shown: pd.DataFrame
    double_sided_ppm: Floats
    skew_ppm: Floats


def miluv(table: Recordings, seed: int, progress: Progress) -> RealCase:
    """Diagnose single-sided ranges without clock columns, then double-sided ones with CIRs.

    `table` (the calibrated ranges) says by how much the publisher's own calibration is better.
    """
    single, double = (open_recordings(f"miluv:{name}")[0] for name in ("ss", "ds"))
    made = exchange(single.frame, double.frame)
    base = Simulator(Base(), name="base")
    progress("miluv, single-sided ranges")
    recorded = Recordings(made.shown, "miluv, single-sided ranges", table.licence)
    found = diagnose(recorded, base, Options(seed), progress)
    progress("miluv, double-sided ranges with CIRs")
    shown = double.frame.drop(columns=[c for c in HIDDEN if c in double.frame])
    with_cir = Recordings(shown, "miluv, double-sided ranges with CIRs", table.licence)
    second = diagnose(with_cir, base, Options(seed), progress)
    pairs = by_pair(made, _clock(found))
    checks = (*_clock_checks(found, made, pairs), *_second_checks(second))
    lines = (*_pair_lines(pairs), "", *_second_lines(second, table, double))
    return RealCase("miluv, single-sided ranges, then double-sided with CIRs", found, checks, lines)


def exchange(single: pd.DataFrame, double: pd.DataFrame) -> Exchange:
    """Return single-sided rows as an initiator's, without waveforms; their offsets apart.

    `tx` becomes the initiator, whose clock the round trip is counted in.
    """
    frame = single.reset_index(drop=True)
    turned = (frame["initiator"] == frame["rx"]).to_numpy()
    shown = frame.drop(columns=[c for c in (*HIDDEN, *WAVEFORM) if c in frame]).copy()
    for suffix in ("", "_x_m", "_y_m", "_z_m"):
        tx, rx = (frame[f"{end}{suffix}"] for end in ENDS)
        shown[f"tx{suffix}"], shown[f"rx{suffix}"] = tx.where(~turned, rx), rx.where(~turned, tx)
    shown["error_m"] = shown["range_m"] - shown["true_range_m"]
    beyond = frame["range_m"] - double["range_m"].reset_index(drop=True)
    ppm = beyond.to_numpy(np.float64) / _metres_per_ppm(frame)
    return Exchange(shown, ppm, frame["clock_offset_ppm"].to_numpy(np.float64))


def _metres_per_ppm(frame: pd.DataFrame) -> Floats:
    """Return c/2 x reply time x 1 ppm [n] in metres."""
    return np.asarray(frame["reply_time_s"].to_numpy(np.float64) * C_M_PER_NS / 2 * 1e3)


def _clock(found: Diagnosis) -> DeviceClock | None:
    """Return the clocks that the diagnosis found, or that may be what it found; None where none."""
    classes = [v for v in found.selection.verdicts if isinstance(v, Ambiguous)]
    every = (*found.added, *(one.effect for each in classes for one in each.options))
    return next((e for e in every if isinstance(e, DeviceClock)), None)


def by_pair(made: Exchange, clock: DeviceClock | None) -> pd.DataFrame:
    """Return a row per pair of devices: rows, median offset diagnosed and by both truths (ppm)."""
    frame = made.shown
    every = np.arange(len(frame))
    scene = view(frame, link_codes(frame), every, Window(), ("error_m",), False).scene
    told = clock.offset_ppm(scene) if clock else np.full(len(frame), np.nan)
    pair = frame["tx"].astype(str) + " -> " + frame["rx"].astype(str)
    columns = {
        "diagnosed_ppm": told,
        "double_sided_ppm": made.double_sided_ppm,
        "skew_ppm": made.skew_ppm,
    }
    groups = pd.DataFrame({"pair": pair, **columns}).groupby("pair")
    return groups.median().assign(rows=groups.size()).reset_index()


def _clock_checks(found: Diagnosis, made: Exchange, pairs: pd.DataFrame) -> tuple[Check, ...]:
    """Return whether the crystals are named, and by how much their offsets are off."""
    out = [Check("says crystal offset", every_named(found), names_it(found, "clock-offset"))]
    both = (pairs["skew_ppm"] - pairs["double_sided_ppm"]).abs().median()
    differ = f"; the two truths differ by {both:.3f} ppm"
    truths = (("double_sided", "the double-sided exchange", ""), ("skew", "published skew", differ))
    for name, words, note in truths:
        off = (pairs["diagnosed_ppm"] - pairs[f"{name}_ppm"]).abs()
        size = pairs[f"{name}_ppm"].abs().median()
        measured = f"median {off.median():.3f} ppm, worst {off.max():.3f} ppm"
        asked = f"offset per pair within {PPM_BAR} ppm of {words} in the median"
        measured += f" ({len(pairs)} pairs, median offset {size:.2f} ppm){note}"
        out.append(Check(asked, measured, bool(off.median() < PPM_BAR)))
    seen = found.confirmed
    before, after = seen.mae_before_m.value, seen.mae_after_m.value
    return (
        *out,
        Check(
            f"mean abs. range error on sealed links at most {LEFT_BAR:g} of before",
            f"{before:.3f} m -> {after:.3f} m ({seen.links} sealed links, {len(made.shown)} rows "
            "in all)",
            after <= LEFT_BAR * before,
        ),
    )


def _second_checks(found: Diagnosis) -> tuple[Check, ...]:
    """Return whether the delays that calibration takes out are found, and the new fit is better."""
    seen = found.confirmed
    before, after = seen.mae_before_m.value, seen.mae_after_m.value
    return (
        Check(
            "double-sided with CIRs, uncalibrated: finds the antenna delays",
            every_named(found),
            names_it(found, "antenna-delay"),
        ),
        Check(
            "double-sided with CIRs: sealed links fit better",
            f"gain {seen.gain}; mean abs. range error {before:.3f} m -> {after:.3f} m",
            seen.gain.value > 0 and after <= before,
        ),
    )


def _pair_lines(pairs: pd.DataFrame) -> list[str]:
    """Return the offsets of all pairs as Markdown."""
    note = "Median clock offset of every pair of devices, initiator against responder."
    return [note, "", *markdown_table(pairs)]


def _second_lines(found: Diagnosis, table: Recordings, double: Recordings) -> list[str]:
    """Return what the second diagnosis said, and what the publisher's calibration reaches."""
    mean = [float(np.abs(one.errors_m()).mean()) for one in (double, table)]
    lines = [
        "Double-sided ranges with CIRs, what the diagnosis said:",
        "",
        f"{found.headline}",
        "",
    ]
    for verdict in found.selection.verdicts:
        lines += [*describe(verdict), ""]
    left = ", ".join(f"{count} x {why}" for why, count in table.dropped.items()) or "none"
    note = (
        f"Mean abs. range error of all rows: {mean[0]:.3f} m before the publisher's calibration, "
        f"{mean[1]:.3f} m after it. Rows left out by the reader: {left}."
    )
    return [*lines, note]
