"""Laws over where devices stand, and wrong positions: whether they say more than delays do.

A device that stands still has one value of every coordinate, so any law over coordinates is some
constant per device, and with few devices some law fits any such constants. What of it differs
between devices alone is told from their own delays by nothing (Mundlak 1978); and where in a plan
the origin lies is no physics. So such a law counts as far as it holds within devices.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.law.faults import Position
from bench.discrepancy.law.likelihood import linear
from bench.discrepancy.law.material import Material
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


def told_from_delays(given: Material, structure: Structure, found: Fitted) -> float:
    """Return the log-likelihood that a structure gains beside constants of every device.

    Infinite for what is not about places, and where devices are not known.
    """
    parts = _parts(given, structure, found)
    if parts is None or not given.devices:
        return np.inf
    own = constants_of_devices(given.devices)
    return _gained(given, own, parts)


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


def _gained(given: Material, own: Floats, parts: Floats) -> float:
    """Return the log-likelihood that `parts` [n, q] gain beside others, `own` [n, k]."""
    both = linear(np.hstack([own, parts]), given.residual_m).likelihood
    return both - linear(own, given.residual_m).likelihood


def _parts(given: Material, structure: Structure, found: Fitted) -> Floats | None:
    """Return what a structure about places may do to rows [n, q], to first order."""
    if isinstance(structure, Position):  # of one device: said as it does as well as its delay
        return None if structure.device else structure.slopes(given, found.constants)
    if isinstance(structure, GridLaw) and over_places((structure.names[0], structure.names[2])):
        return structure.design(given, structure.free_value(found))
    return None
