"""Whether an effect on levels does more than another transmit power would."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added, Comparison, View, without
from bench.discrepancy.data.observables import LEVEL, RANGE
from bench.discrepancy.select.adequacy import Adequacy
from bench.discrepancy.select.settings import ALIKE_M, LEVEL_PRINTED_DB
from bench.discrepancy.select.within_links import link_medians
from bench.discrepancy.sets.settings import RIVAL_NATS
from bench.discrepancy.settings import FIT_MEMBERS, RESOLUTION
from bench.physics.effect import Effect
from bench.physics.units import Floats


def beyond_a_constant(comparison: Comparison, view: View, added: Added, effect: Effect) -> Adequacy:
    """Return whether levels say more for an effect than for so many dB in all rows.

    Transmit power, antennas and cables are no part of any table. Asked of what moves levels alone,
    without waveforms, which have other marks; adequate where it leads by what rules a rival out.
    """
    if view.waveform or not {LEVEL, RANGE} <= set(view.recorded.names):
        return Adequacy(True)
    whole, rest = (
        comparison.ensemble(view, one, FIT_MEMBERS) for one in (added, without(added, effect))
    )
    moved_m = whole.simulated_of(RANGE).mean(axis=0) - rest.simulated_of(RANGE).mean(axis=0)
    if float(np.nanmean(np.abs(moved_m))) > ALIKE_M:
        return Adequacy(True)
    left, bare = (_levels_left(view, one) for one in (whole, rest))
    known = np.isfinite(left) & np.isfinite(bare)
    nats, constant_db = lead_over_constant(left[known], bare[known])
    if not known.any() or nats >= RIVAL_NATS:
        return Adequacy(True)
    return Adequacy(False, 1.0, note=in_all_rows(constant_db))


def level_apart(comparison: Comparison, view: View, added: Added) -> str:
    """Return in words by how much levels differ in all rows, "" where they are not compared."""
    if LEVEL not in view.recorded.names:
        return ""
    left = _levels_left(view, comparison.ensemble(view, added, FIT_MEMBERS))
    known = left[np.isfinite(left)]
    return in_all_rows(float(np.median(known))) if len(known) else ""


def _levels_left(view: View, made: Ensemble) -> Floats:
    """Return recorded less simulated levels, the median of every link [L], in dB."""
    code = np.unique(view.links, return_inverse=True)[1]
    return np.asarray(link_medians(made.residual_of(LEVEL)[None], code)[0])


def in_all_rows(constant_db: float) -> str:
    """Return in words that a constant of levels does as well as an effect."""
    if abs(constant_db) < LEVEL_PRINTED_DB:
        return "receive levels are alike without it"
    return f"{constant_db:+.1f} dB in all rows does as well: transmit power, antennas, cables"


def lead_over_constant(left_db: Floats, bare_db: Floats) -> tuple[float, float]:
    """Return by how many nats `left_db` [L] beats `bare_db` [L] less a constant, and that constant.

    Both scatter as Laplace's law, so that a few links behind obstacles do not decide.
    """
    if not len(bare_db):
        return 0.0, 0.0
    constant = float(np.median(bare_db))
    mine, other = (
        max(float(np.mean(np.abs(one))), RESOLUTION["dB"]) for one in (left_db, bare_db - constant)
    )
    return len(left_db) * float(np.log(other / mine)), constant
