"""Faults of what recorded the samples, seen by marks that nothing on the air can leave.

Clipped peaks share one largest value; a pulse of 500 MHz is wider than a sample, so no signal
stands out of both neighbours of a sample at one place of the accumulator in all rows; and what
rounds samples rounds noise before a first path, too. Effects of
the library fit what such faults do to levels and profiles, and would be named for it.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.observables import LEVEL
from bench.discrepancy.select.settings import (
    CLIPPED_ROWS,
    CLIPPED_SAME,
    GAIN_DB,
    HELD_DB,
    LEAST_OF_MEDIAN,
    LOGARITHMS_DB,
    MOST_ROWS_FAR,
    PULSE_SAMPLES,
    STUCK_DB,
    STUCK_PLACES,
    STUCK_QUIET,
    STUCK_Z,
    UNITS_DB,
    VARIED_DB,
)
from bench.discrepancy.select.state import Round, Search, Selection, State
from bench.discrepancy.select.verdict import Unknown
from bench.physics.effects.receiver.quantisation import EQUAL_SURE, equal_share, late_alone
from bench.physics.units import Floats

AMPLITUDE, PEAK = "max_amplitude_db", "peak_counts_db"  # by accumulated symbol, and as recorded


def recorder_fault(search: Search) -> str:
    """Return in words what a recorder did to the samples, "" where nothing is seen.

    What the simulated table shows as well is no difference.
    """
    if not search.fit.waveform or "cir" not in search.fit.frame:
        return ""
    if words := other_scale(search):
        return words
    table = search.comparison
    other = table.frame if isinstance(table, TableComparison) else None
    frame = pd.concat([search.fit.frame, search.discover.frame], ignore_index=True)
    for fault in (clipped, stuck, repeated):
        words = fault(frame)
        if words and not (other is not None and fault(other)):
            return words
    return ""


def other_scale(search: Search) -> str:
    """Return in words that samples of both sides are not scaled alike, "" where they are.

    By so much that it is no physics: another unit, or one side alone scaled to one peak.
    """
    made = search.comparison.ensemble(search.fit, (), 1)
    if not {AMPLITUDE, PEAK} <= set(made.names):
        return ""
    recorded, simulated = np.nanmedian(made.versions[:2, :, made.place(AMPLITUDE)], axis=1)
    apart_db = float(recorded - simulated)
    apart = f"recorded peaks lie {abs(apart_db):.0f} dB {'above' if apart_db > 0 else 'below'}"
    if abs(apart_db) > UNITS_DB:
        return f"samples are in other units: {apart} simulated ones"
    levels_db = _levels_apart(made)
    if abs(apart_db - levels_db) > GAIN_DB:
        beside = f"though receive levels differ by {levels_db:+.0f} dB"
        return f"samples are in other units, or of another gain: {apart} simulated ones, {beside}"
    if abs(apart_db) > LOGARITHMS_DB and (who := _logarithms(search)):
        return (
            f"{who} samples look like decibels: nothing in them is near zero, where magnitudes of "
            "noise are; expected counts"
        )
    wide_db = np.nanstd(made.versions[:2, :, made.place(PEAK)], axis=1)
    for one, two, who in (*wide_db, "recorded"), (*wide_db[::-1], "simulated"):
        if one < HELD_DB and two > VARIED_DB:
            return f"all {who} samples were scaled to one peak, or clipped, and the others were not"
    return ""


def _levels_apart(made: Ensemble) -> float:
    """Return recorded less simulated receive levels in the median, in dB; NaN where not known."""
    known = LEVEL in made.names
    return float(np.nanmedian(made.residual_of(LEVEL))) if known else float("nan")


def _logarithms(search: Search) -> str:
    """Return on which side alone samples keep far from zero, "" where on both or neither."""
    table = search.comparison
    other = table.frame if isinstance(table, TableComparison) else None
    far = [one is not None and _far_from_zero(one) for one in (search.fit.frame, other)]
    return "" if far[0] == far[1] else "recorded" if far[0] else "simulated"


def _far_from_zero(frame: pd.DataFrame) -> bool:
    """Return whether the least samples of most rows are nearly as large as the median ones.

    Of Rayleigh magnitudes one in a hundred is below an eighth of the median.
    """
    magnitude = _magnitudes(frame)
    if not magnitude.size:
        return False
    least, middle = np.percentile(magnitude, [1, 50], axis=1)
    return bool(np.mean(least > LEAST_OF_MEDIAN * middle) > MOST_ROWS_FAR)


def clipped(frame: pd.DataFrame) -> str:
    """Return in words that the largest samples of many rows are one value, "" where not."""
    tops = np.array([np.max(np.abs(row)) if len(row) else np.nan for row in frame["cir"]])
    tops = tops[np.isfinite(tops)]
    if not len(tops):
        return ""
    same = float(np.mean(tops > tops.max() * (1 - CLIPPED_SAME)))
    if same < CLIPPED_ROWS or same * len(tops) < 2 * STUCK_PLACES:
        return ""
    return f"samples are clipped at {_counts(tops.max())} counts, in {same:.0%} of the rows"


def _counts(size: float) -> str:
    """Return counts in words: a whole number with all its digits, as 16383 is of 14 bits."""
    return f"{size:.0f}" if size >= 1 and size == round(size) else f"{size:.4g}"


def stuck(frame: pd.DataFrame) -> str:
    """Return in words which places of the accumulator read another level, "" where none does."""
    magnitude = _magnitudes(frame)
    if magnitude.shape[1] < 3 * PULSE_SAMPLES or len(magnitude) < STUCK_PLACES:
        return ""
    size = float(np.median(magnitude) or magnitude.mean())  # rounded ones are mostly zero
    if size == 0:
        return ""
    level = 20 * np.log10(np.maximum(magnitude, np.maximum(_half_steps(magnitude), 1e-3 * size)))
    apart, error = _standing_out(level)
    middle = float(np.nan_to_num(np.nanmedian(numeric(frame, "first_path_index"))))
    far = np.abs(np.arange(level.shape[1]) - middle) > PULSE_SAMPLES
    seen = np.flatnonzero((apart > STUCK_DB) & (apart > STUCK_Z * error) & far)
    if len(seen) < STUCK_PLACES:
        return ""
    places = ", ".join(map(str, seen[:STUCK_PLACES]))
    return f"samples {places} ... of every row read a level of their own, whatever arrives"


def repeated(frame: pd.DataFrame) -> str:
    """Return in words that samples repeat each other behind first paths alone, "" where not.

    In many of them: nothing that arrives is as large as another to the last bit, and a converter
    takes noise before first paths, too.
    """
    share = equal_share(frame["cir"])
    if share < EQUAL_SURE or not late_alone(frame):
        return ""
    return (
        f"{share:.0%} of the samples equal others of their row, all behind first paths: something "
        "replaced them after they were received"
    )


def _half_steps(magnitude: Floats) -> Floats:
    """Return half of the least sample that is not zero, of rows [n, K], as [n, 1].

    Rounded samples of zero may have been as large as half a step: taken as 60 dB below the others,
    a place that is rounded to zero a little more often than its neighbours would stand out.
    """
    least = np.where(magnitude > 0, magnitude, np.inf).min(axis=1, keepdims=True)
    return np.where(np.isfinite(least), least / 2, 0.0)


def _standing_out(level: Floats) -> tuple[Floats, Floats]:
    """Return by how many dB each place of levels [n, K] stands out of both neighbours, its error.

    Above both, or below both; the ends never do. Below both as far as it is below the noise:
    between two pulses, such as those of a ringing, the field is zero, but noise stays there.
    """
    left, right = (level[:, 1:-1] - level[:, at : level.shape[1] - 2 + at] for at in (0, 2))
    means = np.stack([left.mean(axis=0), right.mean(axis=0)])
    errors = np.stack([left.std(axis=0), right.std(axis=0)]) / np.sqrt(len(level))
    usual = level.mean(axis=0)
    under = np.percentile(usual, STUCK_QUIET) - usual[1:-1]
    apart = np.maximum(means.min(axis=0), np.minimum(-means.max(axis=0), under))
    return np.pad(apart, 1), np.pad(errors.max(axis=0), 1, constant_values=1.0)


def _magnitudes(frame: pd.DataFrame) -> Floats:
    """Return the magnitudes of rows [n, K] whose CIRs have the usual length."""
    rows = [np.abs(np.asarray(row)) for row in frame["cir"]]
    lengths: NDArray[np.intp] = np.array([len(row) for row in rows], np.intp)
    usual = int(np.bincount(lengths).argmax()) if len(lengths) else 0
    kept = [row for row in rows if len(row) == usual and np.isfinite(row).all()]
    return np.stack(kept).astype(np.float64) if kept else np.zeros((0, 0))


def spoilt(state: State, fault: str) -> Selection:
    """Return what can be said where the recorder spoilt the samples: that, and no name."""
    first = state.rounds[0]
    made = first.explanation
    tried = {c.name: c.gain.value for c in made.contenders} if made else {}
    removable = made.removable if made else Estimate(0, 0, 0)
    unknown = Unknown(first.located.findings, removable, tried, fault, cause=fault)
    rounds = (Round(first.located, made, None),)
    return Selection((unknown,), (), rounds, {**state.skipped, **state.guard.failed})
