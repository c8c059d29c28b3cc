"""Laws over where devices stand, and wrong positions: whether they say more than delays do.

A device that stands still has one value of every coordinate, so any law over coordinates is some
constant per device, and with few devices some law fits any such constants. What of it differs
between devices alone is told from their own delays by nothing (Mundlak 1978); and where in a plan
the origin lies is no physics. So such a law counts as far as it holds within devices, and one that
goes with something else as far as devices have no constant of their own times that.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.law.faults import Position
from bench.discrepancy.law.likelihood import linear
from bench.discrepancy.law.material import Material
from bench.discrepancy.law.plan import Plan
from bench.discrepancy.law.structures import Fitted, GridLaw, Structure
from bench.physics.ways import spread_over

Floats = NDArray[np.float64]
COORDINATES = tuple(f"{end}_{axis}_m" for end in ("tx", "rx") for axis in "xyz")


def over_places(texts: tuple[str, ...]) -> bool:
    """Return whether any expression is about where a device stands."""
    return any(name in text for text in texts for name in COORDINATES)


def constants_of_devices(devices: Mapping[str, NDArray[np.object_]]) -> Floats:
    """Return one column per device and end [n, k], 1 where it takes part."""
    columns = [np.asarray(names == one) for names in devices.values() for one in np.unique(names)]
    return np.stack(columns, axis=1).astype(np.float64)


def times_of(given: Material, law: GridLaw, free: float) -> Floats:
    """Return what a law multiplies its function of places with [n, k]: 1 where that is nothing.

    `free` is its free constant. A factor, or, where that is about places, the form itself.
    """
    factor = given.factors[law.by]
    if not over_places((factor.text,)):
        return factor.weights[:, None]
    if over_places((law.names[0],)):
        return np.ones((len(factor.weights), 1))
    return replace(law, by=0).design(given, free)


def own_of_devices(constants: Floats, times: Floats | None = None) -> tuple[Floats, ...]:
    """Return what devices may have of their own [n, d]: constants, and as many of each `times`.

    `times` [n, k] that are the same in all rows make no others.
    """
    more = [] if times is None else [one for one in times.T if np.ptp(one) > 0]
    sizes = [max(float(np.sqrt(np.mean(one**2))), 1e-12) for one in more]
    scaled = (constants * (one / size)[:, None] for one, size in zip(more, sizes, strict=True))
    return (constants, *scaled)


def told_from_delays(given: Material, structure: Structure, found: Fitted) -> float:
    """Return the log-likelihood that a structure gains beside constants of every device.

    Beside constants times what it goes with, too. Infinite for what is not about places, and where
    devices are not known.
    """
    parts = _parts(given, structure, found)
    if parts is None or not given.devices:
        return np.inf
    law = structure if isinstance(structure, GridLaw) else None
    times = times_of(given, law, law.free_value(found)) if law else None
    own = own_of_devices(constants_of_devices(given.devices), times)
    return _gained(given, np.hstack(own), parts)


def told_from_detectors(given: Material, structure: Structure, found: Fitted) -> float:
    """Return the log-likelihood that a law gains beside what a changed waveform may do to ranges.

    Anything smooth over the distance, and more or less in every group but devices. Infinite for
    what is no law of a form.
    """
    if not isinstance(structure, GridLaw):
        return np.inf
    ours = ("(tx ", "(rx ")
    groups = [f.weights[:, None] for f in given.factors if f.group and not f.text.startswith(ours)]
    own = np.hstack([np.ones((len(given.links), 1)), spread_over(given.true_range_m), *groups])
    return _gained(given, own, structure.design(given, structure.free_value(found)))


def told_from_forms(given: Material, structure: Structure, found: Fitted, forms: Floats) -> float:
    """Return the log-likelihood that a structure gains beside other forms [n, k] of what is named.

    Infinite for a fault that no slope tells.
    """
    if isinstance(structure, Position | Plan):
        parts = structure.slopes(given, found.constants)
    elif isinstance(structure, GridLaw):
        parts = structure.design(given, structure.free_value(found))
    else:
        return np.inf
    return _gained(given, forms, parts)


def _gained(given: Material, own: Floats, parts: Floats) -> float:
    """Return the log-likelihood that `parts` [n, q] gain beside others, `own` [n, k]."""
    both = linear(np.hstack([own, parts]), given.residual_m).likelihood
    return both - linear(own, given.residual_m).likelihood


def _parts(given: Material, structure: Structure, found: Fitted) -> Floats | None:
    """Return what a structure about places may do to rows [n, q], to first order."""
    if isinstance(structure, Plan):
        return structure.slopes(given, found.constants)
    if isinstance(structure, Position):  # of one device: said as it does as well as its delay
        return None if structure.device else structure.slopes(given, found.constants)
    if isinstance(structure, GridLaw) and over_places((structure.names[0], structure.names[2])):
        return structure.design(given, structure.free_value(found))
    return None
