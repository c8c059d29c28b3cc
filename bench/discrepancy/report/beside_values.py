"""What values leave unsaid: how crystals change, of which walls delays and losses are."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.settings import SHOWN_VALUES
from bench.physics.effect import Effect
from bench.physics.effects.fitted.device_clock import DeviceClock
from bench.physics.effects.fitted.device_values import beside_middle
from bench.physics.effects.fitted.wall_delay import WallDelay
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.materials import obstacle
from bench.physics.slabs import UNLISTED
from bench.text import significant


def beside_values(effect: Effect) -> list[str]:
    """Return lines about what an effect does beside the values that it lists, none of most."""
    return [*slope_lines(effect), *wall_lines(effect)]


def wall_lines(effect: Effect) -> list[str]:
    """Return of how thick an obstacle delays are, and what one loses; none of other effects."""
    if not isinstance(effect, WallDelay | MaterialDelay):
        return []
    listed = [kind for kind in effect.kinds if kind != UNLISTED]
    thick = ", ".join(f"{kind} {significant(obstacle(kind).thickness_m, 3)} m" for kind in listed)
    losses = zip(effect.kinds, effect.losses_db, strict=False)
    lost = ", ".join(f"{kind} {significant(loss, 3)} dB" for kind, loss in losses)
    return [
        *([f"  - delays are of one obstacle at a right angle, as thick as: {thick}"] * bool(thick)),
        *([f"  - one loses besides (fitted, without intervals): {lost}"] * bool(lost)),
    ]


def slope_lines(effect: Effect) -> list[str]:
    """Return how offsets of devices change, a line each over hours and over degrees, if at all.

    Beside middling devices, as offsets are: only differences act. They have no intervals.
    """
    if not isinstance(effect, DeviceClock):
        return []
    changes = (
        (effect.drifts_ppm_per_hour, "ppm per hour", f"time_s = {effect.reference_s:g}"),
        (effect.slopes_ppm_per_c, "ppm per degC", f"{effect.reference_c:g} degC"),
    )
    return [_line(effect.devices, *one) for one in changes if one[0] and np.ptp(one[0]) > 0]


def _line(devices: tuple[str, ...], values: tuple[float, ...], unit: str, where: str) -> str:
    """Return the largest changes of some devices, beside middling ones."""
    beside = beside_middle(values)
    first = np.argsort(-np.abs(beside), kind="stable")[:SHOWN_VALUES]
    shown = ", ".join(f"{devices[i]} {significant(float(beside[i]), 3)}" for i in first)
    more = len(devices) - len(first)
    rest = f" and {more} more in diagnosis.json" if more > 0 else ""
    return (
        f"  - offsets change, in {unit} beside middling devices (fitted, without intervals): "
        f"{shown}{rest}; offsets are those at {where}"
    )
