"""Effect 12: the reflection from the ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.physics.batch import SPECULAR, Batch
from bench.physics.effect import Effect, parameter
from bench.physics.effects.propagation.specular import in_room
from bench.physics.effects.propagation.two_rays import pulling_ways
from bench.physics.materials import material, reflection
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.units import C_M_PER_NS, Floats, amplitude, wavelength_m


@dataclass(frozen=True)
class GroundBounce(Effect):
    """Adds the two-ray path: excess sqrt(d^2 + (h1 + h2)^2) - sqrt(d^2 + (h1 - h2)^2).

    Heights from `tx_z_m` and `rx_z_m`, else `height_m` for both. Rows inside a known room are
    left to the specular reflections, whose floor it would be again.
    """

    name = "ground-bounce"
    number = 12
    stage = "propagation"
    source = "two-ray model; Fresnel coefficient with the permittivity of ITU-R P.2040-3"
    signature = "ripple of power and a small signed bias over distance; excess falls as 1/d"
    needs = (("tx_z_m", "rx_z_m"),)
    control = "rows inside a known room"

    strength_db: float = parameter(0, "dB", -60, 6, "over the Fresnel coefficient")
    height_m: float = parameter(1.0, "m", 0.02, 30, "of both antennas where z is not known")
    ground: str = "concrete"

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in (self.ground,):
            material(name)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Add the bounced path of every row outside of rooms."""
        heights = [batch.rows.number(f"{end}_z_m", self.height_m) for end in ("tx", "rx")]
        heights = [np.where(height > 0.01, height, self.height_m) for height in heights]
        truth = batch.rows.true_range_m
        length = np.sqrt(truth**2 + 4 * heights[0] * heights[1])
        sine = np.sqrt(np.maximum(1 - ((heights[0] + heights[1]) / length) ** 2, 0))
        permittivity = material(self.ground).permittivity(batch.centre_ghz)
        factor = reflection(permittivity, np.arcsin(sine)) * amplitude(self.strength_db)
        extra = length - truth
        turn = np.exp(-2j * np.pi * extra / wavelength_m(batch.centre_ghz))
        reference = np.zeros(len(batch)) if batch.free_gain is None else batch.free_gain
        gain = np.where(self.inert(batch), 0, reference * factor * truth / length * turn)
        paths = (extra / C_M_PER_NS)[:, None], gain.astype(np.complex64)[:, None]
        return batch.with_paths(*paths, SPECULAR)

    @classmethod
    def ways(cls, rows: Scene) -> tuple[Floats, ...] | None:
        """Return how the reflection may pull the leading edge; None without heights."""
        return pulling_ways(rows)

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Return the rows inside a known room."""
        return in_room(batch.rows)
