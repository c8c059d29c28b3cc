"""Two rays from residual ranges and levels: what a reflection of the ground does without a CIR."""

from __future__ import annotations

from bench.discrepancy.compare.residual_range import residual_range
from bench.discrepancy.compare.view import Added, Comparison, View, common
from bench.discrepancy.data.observables import LEVEL
from bench.discrepancy.settings import RESIDUAL_MEMBERS
from bench.physics.effects.fitted.ground_ray import GroundRay


def ground_ray(comparison: Comparison, view: View, added: Added) -> GroundRay | None:
    """Return the reflection that residual ranges and levels of the rows follow, None without one.

    With waveforms the reflection is a path of its own, the library's.
    """
    if view.waveform or GroundRay.lacking(view.frame.columns):
        return None
    made = residual_range(comparison, view, common(added, view), RESIDUAL_MEMBERS)
    found = made and GroundRay.fit_values(view.frame, made[1])
    if not isinstance(found, GroundRay):
        return None
    whole = comparison.ensemble(view, added, RESIDUAL_MEMBERS)
    if LEVEL not in whole.names:
        return found
    return found.with_level(view.frame, whole.residual_of(LEVEL))
