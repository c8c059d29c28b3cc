"""Two rays that meet: geometry, fading and pull of a reflection of the ground, from heights."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.physics.scene import Scene
from bench.physics.units import CENTRE_GHZ, Floats, wavelength_m

CARRIERS_GHZ = (3.4944, 3.9936, 4.4928, 6.4896)  # of IEEE 802.15.4 channels 1 to 5
LEAST_POWER = 0.02  # of two rays that cancel, of the straight one's: antennas are never points
FARTHEST_PULL = 2.0  # times the excess, at most


@dataclass(frozen=True)
class Rays:
    """Two rays per row [n]: the reflected one is `longer_m`, and of relative `size` by its length.

    `flat` is 1 - sine of its grazing angle.
    """

    longer_m: Floats
    size: Floats
    flat: Floats

    def ray(self, carrier_ghz: float, size: float, steepness: float) -> Floats:
        """Return the reflected ray [n], complex, over the straight one; it is turned around."""
        turn = np.exp(-2j * np.pi * self.longer_m / wavelength_m(carrier_ghz))
        return np.asarray(-size * self.size * self.flat**steepness * turn)


def rays(rows: Scene) -> Rays | None:
    """Return the two rays of every row, None where heights are not known in all of them."""
    high, low = (rows.number(f"{end}_z_m", np.nan) for end in ("tx", "rx"))
    if not (np.isfinite(high).all() and np.isfinite(low).all()):
        return None
    high, low = np.maximum(high, 0.0), np.maximum(low, 0.0)
    far = rows.true_range_m
    length = np.maximum(np.sqrt(far**2 + 4 * high * low), 1e-6)
    return Rays(length - far, far / length, 1 - np.minimum((high + low) / length, 1.0))


def carriers_ghz(rows: Scene) -> tuple[float, ...]:
    """Return the carriers that rows may have: of their channel, of all where it is not told."""
    told = np.unique(rows.number("channel", 0))
    known = [CENTRE_GHZ[int(one)] for one in told if int(one) in CENTRE_GHZ]
    return tuple(known) if len(known) == len(told) else CARRIERS_GHZ


def pulled_m(longer_m: Floats, ray: Floats, reach_m: float) -> Floats:
    """Return how far a leading edge [n] is pulled: the group delay of both rays within a pulse.

    A reflection that is later than `reach_m` no longer overlaps the edge.
    """
    near = np.exp(-((longer_m / reach_m) ** 2))
    power = np.maximum(np.abs(1 + ray) ** 2, LEAST_POWER)
    share = np.real(ray * np.conj(1 + ray)) / power
    return np.asarray(near * longer_m * np.clip(share, -FARTHEST_PULL, FARTHEST_PULL))


def fading_db(ray: Floats) -> Floats:
    """Return by how much two rays are stronger than the straight one alone [n]."""
    return np.asarray(10 * np.log10(np.maximum(np.abs(1 + ray) ** 2, LEAST_POWER)))


def fading_ways(rows: Scene) -> Floats:
    """Return how levels may go up and down as two rays meet: columns [n, k], none without heights.

    By a reflection of either sign and any phase, for every carrier that there may be.
    """
    found = rays(rows)
    if found is None:
        return np.zeros((len(rows), 0))
    out: list[Floats] = []
    for carrier in carriers_ghz(rows):
        for steepness in (0.0, 1.0):
            ray = found.ray(carrier, 1.0, steepness)
            out += [np.real(ray), np.imag(ray), np.real(ray**2)]
    return np.stack(out, axis=1)


SIZES = (0.3, 0.6, 0.85)  # of the reflection, between which any lies
REACHES_M = (0.5, 1.0)  # of the pulse of a bandwidth of 500 MHz
USUAL = 0.5  # of what a reflection of such a size does: factors are around one


def pulling_ways(rows: Scene) -> tuple[Floats, ...] | None:
    """Return how two rays may pull ranges: columns [n, k] for every carrier; None without heights.

    Several sizes and pulses: a pull is no linear function of them.
    """
    found = rays(rows)
    if found is None or not np.ptp(found.longer_m) > 0:
        return None
    return tuple(
        np.stack(
            [
                USUAL * pulled_m(found.longer_m, found.ray(carrier, size, steepness), reach)
                for size in SIZES
                for reach in REACHES_M
                for steepness in (0.0, 1.0)
            ],
            axis=1,
        )
        for carrier in carriers_ghz(rows)
    )
