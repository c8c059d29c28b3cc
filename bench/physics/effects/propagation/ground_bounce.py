"""Effect 12: the reflection from the ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.physics.batch import SPECULAR, Batch
from bench.physics.effect import Effect, parameter
from bench.physics.effects.propagation.specular import in_room
from bench.physics.effects.propagation.two_rays import (
    goes_up_and_down,
    pulling_ways,
    smooth_over_geometry,
)
from bench.physics.materials import material, reflection
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.units import C_M_PER_NS, Complexes, Floats, amplitude, wavelength_m

LEAST_RIPPLE = 0.5  # of the variance of what it does to ranges: the rest is a curve over geometry


@dataclass(frozen=True)
class GroundBounce(Effect):
    """Adds the two-ray path: excess sqrt(d^2 + (h1 + h2)^2) - sqrt(d^2 + (h1 - h2)^2).

    Heights from `tx_z_m` and `rx_z_m`, else `height_m` for both. Rows inside a known room that
    have the room's reflections already are left to these, whose floor it would be again. Heights
    are known to a few centimetres, of a wavelength of three to nine: `placed_m` turns the carrier.
    """

    name = "ground-bounce"
    number = 12
    stage = "propagation"
    stackable = True
    source = "two-ray model; Fresnel coefficient with the permittivity of ITU-R P.2040-3"
    signature = "ripple of power and a small signed bias over distance; excess falls as 1/d"
    needs = (("tx_z_m", "rx_z_m"),)
    control = "rows that have a room's reflections already"

    strength_db: float = parameter(0, "dB", -60, 6, "over the Fresnel coefficient")
    height_m: float = parameter(1.0, "m", 0.02, 30, "of both antennas where z is not known")
    placed_m: float = parameter(0, "m", 0, 0.1, "std of heights about those of the positions")
    ground: str = "concrete"

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in (self.ground,):
            material(name)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Add the bounced path of every row that has no floor already."""
        heights = [batch.rows.number(f"{end}_z_m", self.height_m) for end in ("tx", "rx")]
        heights = [np.where(height > 0.01, height, self.height_m) for height in heights]
        truth = batch.rows.true_range_m
        length = np.sqrt(truth**2 + 4 * heights[0] * heights[1])
        sine = np.sqrt(np.maximum(1 - ((heights[0] + heights[1]) / length) ** 2, 0))
        permittivity = material(self.ground).permittivity(batch.centre_ghz)
        factor = reflection(permittivity, np.arcsin(sine)) * amplitude(self.strength_db)
        extra = length - truth
        turn = self._turn(batch, extra, (heights[0] + heights[1]) / length, draws)
        reference = np.zeros(len(batch)) if batch.free_gain is None else batch.free_gain
        gain = np.where(self.inert(batch), 0, reference * factor * truth / length * turn)
        paths = (extra / C_M_PER_NS)[:, None], gain.astype(np.complex64)[:, None]
        return batch.with_paths(*paths, SPECULAR)

    def _turn(self, batch: Batch, extra_m: Floats, sine: Floats, draws: Draws) -> Complexes:
        """Return how the carrier of a way so much longer [n], so steep, is turned.

        An antenna higher by some centimetres than its position says makes the way longer.
        """
        if self.placed_m:
            extra_m = extra_m + self.placed_m * sine * draws.group_normal(batch.rows.group("link"))
        return np.asarray(np.exp(-2j * np.pi * extra_m / wavelength_m(batch.centre_ghz)))

    @classmethod
    def ways(cls, rows: Scene) -> tuple[Floats, ...] | None:
        """Return how the reflection may move what a receiver finds; None without heights."""
        return pulling_ways(rows)

    @classmethod
    def possible(cls, rows: Scene, shift_m: Floats) -> bool:
        """Return whether ranges go up and down as two rays do, and not by a curve alone."""
        return goes_up_and_down(rows, shift_m) >= LEAST_RIPPLE

    @classmethod
    def told_beyond(cls, rows: Scene) -> Floats | None:
        """Return what is smooth over distance and heights: a reflection goes up and down there."""
        return smooth_over_geometry(rows)

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Return the rows inside a known room that have reflections of it already."""
        return np.asarray(in_room(batch.rows) & (batch.kind == SPECULAR).any(axis=1))
