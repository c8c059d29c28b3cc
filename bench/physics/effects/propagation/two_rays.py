"""Two rays that meet: geometry, fading and pull of a reflection of the ground, from heights.

A receiver finds an edge, a top, a middle or a part of the energy of two pulses that add up. By
Taylor's theorem each of these moves by the real and the imaginary part of the ray (louder edges are
crossed sooner, later pulses pull), by its square and its power, each times a smooth function of the
excess that pulse and receiver decide. The phase is of the geometry alone, and so common to all.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.physics.scene import Scene
from bench.physics.units import CENTRE_GHZ, Floats, wavelength_m

CARRIERS_GHZ = (3.4944, 3.9936, 4.4928, 6.4896)  # of IEEE 802.15.4 channels 1 to 5
LEAST_POWER = 0.02  # of two rays that cancel, of the straight one's: antennas are never points
FARTHEST_PULL = 2.0  # times the excess, at most
SIZES = (0.3, 0.6, 0.85)  # of the reflection, between which any lies
REACHES_M = (0.5, 1.0)  # of the pulse of a bandwidth of 500 MHz
USUAL = 0.5  # of what a reflection of such a size does: factors are around one
WITHIN_M = (0.25, 0.5, 1.0, 2.0)  # excesses within which a receiver may answer to both rays
STEEPNESSES = (0.0, 1.0)  # of the reflection, between which most lie
MOVED_M, MOVED_TWICE_M = 0.05, 0.03  # typical, by the ray and by its square
LOUDER_DB = 3.0  # typical
LEAST_SHARE = 1e-4  # of the largest direction's square: less is below the scatter of ranges


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


def moves_m(found: Rays, carrier_ghz: float) -> Floats:
    """Return what any receiver may make of two rays [n, k], in metres, with factors around one."""
    out = [
        USUAL * pulled_m(found.longer_m, found.ray(carrier_ghz, size, steepness), reach)
        for size in SIZES
        for reach in REACHES_M
        for steepness in STEEPNESSES
    ]
    for within in WITHIN_M:
        near = np.exp(-((found.longer_m / within) ** 2))
        for steepness in STEEPNESSES:
            ray = found.ray(carrier_ghz, 1.0, steepness)
            out += [MOVED_M * near * np.real(ray), MOVED_M * near * np.imag(ray)]
        ray = found.ray(carrier_ghz, 1.0, 0.0)
        squares = np.real(ray**2), np.imag(ray**2), np.abs(ray) ** 2
        out += [MOVED_TWICE_M * near * one for one in squares]
    return np.stack(out, axis=1)


def fades_db(found: Rays, carrier_ghz: float) -> Floats:
    """Return how any receiver may log the level of two rays [n, k], in dB, as `moves_m`.

    Energies add, whatever the phase, where pulses no longer overlap.
    """
    out = []
    for within in (*WITHIN_M[1:], np.inf):
        near = np.exp(-((found.longer_m / within) ** 2))
        for steepness in STEEPNESSES:
            ray = found.ray(carrier_ghz, 1.0, steepness)
            squares = np.real(ray**2) / 2, np.abs(ray) ** 2 / 2
            out += [LOUDER_DB * near * one for one in (np.real(ray), *squares)]
    return np.stack(out, axis=1)


def fading_ways(rows: Scene, named: bool = False) -> Floats:
    """Return how levels may go up and down as two rays meet: columns [n, k], none without heights.

    By a reflection of either sign and any phase, for every carrier that there may be; with what
    any receiver may make of one that is `named`.
    """
    found = rays(rows)
    if found is None:
        return np.zeros((len(rows), 0))
    out: list[Floats] = []
    for carrier in carriers_ghz(rows):
        for steepness in STEEPNESSES:
            ray = found.ray(carrier, 1.0, steepness)
            out += [np.real(ray)[:, None], np.imag(ray)[:, None], np.real(ray**2)[:, None]]
        out += [fades_db(found, carrier)] if named else []
    return np.hstack(out)


def pulling_ways(rows: Scene) -> tuple[Floats, ...] | None:
    """Return how two rays may move ranges: columns [n, k] for every carrier; None without heights.

    The main directions of all that a receiver may make of them.
    """
    found = rays(rows)
    if found is None or not np.ptp(found.longer_m) > 0:
        return None
    return tuple(_main(moves_m(found, carrier)) for carrier in carriers_ghz(rows))


def _main(columns: Floats) -> Floats:
    """Return fewer columns [n, k] of nearly the same random sums."""
    ways, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    large = sizes**2 > LEAST_SHARE * sizes[0] ** 2
    return np.asarray(ways[:, large] * sizes[large])


def goes_up_and_down(rows: Scene, shift_m: Floats) -> float:
    """Return the share of the variance of shifts [n] that is no smooth curve over the geometry.

    Two rays meet anew every few centimetres of their excess. 0 without heights.
    """
    smooth = smooth_over_geometry(rows)
    if smooth is None:
        return 0.0
    left = shift_m - smooth @ np.linalg.lstsq(smooth, shift_m, rcond=None)[0]
    return float(left.var() / max(float(shift_m.var()), 1e-18))


def smooth_over_geometry(rows: Scene) -> Floats | None:
    """Return smooth curves over the distance and both heights, of second order: columns [n, 10].

    Around one each; None without heights.
    """
    ends = [rows.number(f"{end}_z_m", np.nan) for end in ("tx", "rx")]
    if not all(np.isfinite(end).all() for end in ends):
        return None
    every = [np.log(np.maximum(rows.true_range_m, 1e-3)), *ends]
    every = [(one - one.mean()) / max(float(one.std()), 1e-9) for one in every]
    pairs = [one * other for i, one in enumerate(every) for other in every[i:]]
    return np.stack([np.ones(len(rows.true_range_m)), *every, *pairs], axis=1)
