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
from bench.physics.materials import WATER, material, reflection, upright_reflection
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
    No two links see ground that is alike, nor by antennas that are as upright: `spread_db` makes
    what returns larger or smaller, and `rough` adds what is of chance in phase, too (Beckmann and
    Spizzichino 1963). Water reflects alike at all angles, dry ground hardly where it is steep.
    """

    name = "ground-bounce"
    number = 12
    stage = "propagation"
    stackable = True
    source = "two-ray model; Fresnel coefficient with the permittivity of ITU-R P.2040-3"
    signature = "ripple of power and a small signed bias over distance; excess falls as 1/d"
    needs = (("tx_z_m", "rx_z_m"),)
    control = "rows that have a room's reflections already"

    strength_db: float = parameter(0, "dB", -60, 6, "over the Fresnel coefficient", null=-60)
    height_m: float = parameter(1.0, "m", 0.02, 30, "of both antennas where z is not known")
    placed_m: float = parameter(0, "m", 0, 0.1, "std of heights about those of the positions")
    upright: float = parameter(0, "ratio", 0, 1, "of the field, that is upright")
    wet: float = parameter(0, "ratio", 0, 1, "of the ground, that water covers")
    spread_db: float = parameter(0, "dB", 0, 12, "std over the ground of links", null=0)
    rough: float = parameter(0, "ratio", 0, 2, "of chance, of each link, to what is not", null=0)
    ground: str = "concrete"

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in (self.ground,):
            material(name)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Add the bounced path of every row that has no floor already."""
        if self.strength_db <= -60:
            return batch
        heights = [batch.rows.number(f"{end}_z_m", self.height_m) for end in ("tx", "rx")]
        heights = [np.where(height > 0.01, height, self.height_m) for height in heights]
        truth = batch.rows.true_range_m
        length = np.sqrt(truth**2 + 4 * heights[0] * heights[1])
        sine = np.sqrt(np.maximum(1 - ((heights[0] + heights[1]) / length) ** 2, 0))
        factor = self._fresnel(batch.centre_ghz, np.arcsin(sine)) * amplitude(self.strength_db)
        extra = length - truth
        own = self._of_links(batch, extra, (heights[0] + heights[1]) / length, draws)
        reference = np.zeros(len(batch)) if batch.free_gain is None else batch.free_gain
        gain = np.where(self.inert(batch), 0, reference * factor * truth / length * own)
        paths = (extra / C_M_PER_NS)[:, None], gain.astype(np.complex64)[:, None]
        return batch.with_paths(*paths, SPECULAR)

    def _fresnel(self, centre_ghz: float, incidence_rad: Floats) -> Complexes:
        """Return what ground, some of it wet, returns [n] of a field, some of it upright."""
        out = np.zeros(len(incidence_rad), np.complex64)
        for part, kind in ((1 - self.wet, material(self.ground)), (self.wet, WATER)):
            for share, returns in (
                (part * (1 - self.upright), reflection),
                (part * self.upright, upright_reflection),
            ):
                if share:
                    out += share * returns(kind.permittivity(centre_ghz), incidence_rad)
        return np.asarray(out)

    def _of_links(self, batch: Batch, extra_m: Floats, sine: Floats, draws: Draws) -> Complexes:
        """Return what a way so much longer [n], so steep, has by chance: a size and a turn.

        An antenna higher by some centimetres than its position says makes the way longer.
        """
        size: Complexes | float = 1.0
        if self.placed_m or self.spread_db or self.rough:
            own, more = draws.group_complex(batch.rows.group("link"), 2).T.astype(np.complex128)
            extra_m = extra_m + np.sqrt(2) * self.placed_m * sine * own.real
            size = amplitude(np.sqrt(2) * self.spread_db * own.imag) * (1 + self.rough * more)
        return np.asarray(size * np.exp(-2j * np.pi * extra_m / wavelength_m(batch.centre_ghz)))

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
