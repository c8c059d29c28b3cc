"""Effect 11: reflections from walls, floor and ceiling."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.physics.batch import SPECULAR, Batch
from bench.physics.effect import Effect, parameter
from bench.physics.effects.propagation.mirrored import HINT_DB, HINT_Z, mirrored
from bench.physics.images import image_paths
from bench.physics.materials import material, reflection
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.units import C_M_PER_NS, Complexes, Floats, amplitude, phasor, wavelength_m

MARKED_DB = (-18.0, -12.0, -6.0, 0.0, 6.0)  # tried where reflections are seen
MARKED_WALLS = ("plasterboard", "metal")
# the same: a conductor reflects alike at all angles, a thin board hardly but at grazing ones; what
# walls are of is in no table


@dataclass(frozen=True)
class Images:
    """Image paths [n, Q]: `factor` of the walls, how much longer than the straight line in metres.

    `spread` is the free-space field over that of the straight line, `turn` the carrier's.
    """

    factor: Complexes
    extra_m: Floats
    spread: Floats
    turn: Complexes

    @classmethod
    def of(cls, batch: Batch, length: Floats, factor: Complexes) -> Images:
        """Return images by their `length` [n, Q] in metres."""
        truth = batch.rows.true_range_m[:, None]
        extra = np.maximum(length - truth, 0)
        turns = ((extra / wavelength_m(batch.centre_ghz)) % 1.0).astype(np.float32)
        return cls(factor, extra, truth / np.maximum(length, 1e-3), phasor(-turns))


@dataclass(frozen=True)
class SpecularReflections(Effect):
    """Adds the mirror images of the transmitter, each with its Fresnel coefficient.

    Rooms given by `room_x_m`, `room_y_m`, `room_z_m` (a corner at the origin of the positions)
    get all images of up to `highest_order` reflections. Other rows get two walls of the same
    material parallel to the link, `wall_m` and 1.7 x `wall_m` away (0 = none). Positions are known
    to a centimetre or two, of a wavelength of three to nine: `placed_m` turns the carrier of every
    path of a link by chance.
    """

    name = "specular-reflections"
    number = 11
    stage = "propagation"
    stackable = True
    source = "Allen and Berkley 1979; Fresnel coefficients with ITU-R P.2040-3 permittivities"
    signature = "separate paths whose delay moves with the geometry"
    needs = (("room_x_m", "room_y_m", "tx_x_m", "rx_x_m"),)
    own_form = True
    without_cir = False  # a range alone does not show a second path

    strength_db: float = parameter(0, "dB", -40, 10, "over the Fresnel coefficient")
    wall_m: float = parameter(1.5, "m", 0, 50, "distance of the walls where no room is given")
    highest_order: int = parameter(2, "reflections", 1, 3, "per path")
    spread_db: float = parameter(3, "dB", 0, 12, "std over the surfaces that a link sees")
    moved_m: float = parameter(0.01, "m", 0, 0.03, "std of path lengths between rows of a link")
    placed_m: float = parameter(
        0.02, "m", 0, 0.5, "std of path lengths about those of the positions", fitted=False
    )
    walls: str = "plasterboard"
    floor: str = "concrete"
    ceiling: str = "plasterboard"

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in (self.walls, self.floor, self.ceiling):
            material(name)

    @classmethod
    def by_mark(cls, frame: pd.DataFrame) -> tuple[Effect, ...]:
        """Return several forms where rows have power at the delays of their own walls.

        Of several strengths, once and twice reflected, by walls and a ceiling of either kind.
        """
        if not mirrored(frame):
            return ()
        every = product(MARKED_DB, (1, 2), MARKED_WALLS)
        return tuple(cls(db, highest_order=n, walls=of, ceiling=of) for db, n, of in every)

    @classmethod
    def hinted(cls, frame: pd.DataFrame) -> bool:
        """Return whether rows may have power at the delays of their own walls."""
        return mirrored(frame, HINT_DB, HINT_Z)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Add the reflected paths of every row."""
        inside = in_room(batch.rows)
        if inside.any():
            batch = self._added(batch, self._images(batch, inside), draws)
        if self.wall_m > 0 and not inside.all():
            batch = self._added(batch, self._side_walls(batch, ~inside), draws)
        return batch

    def _added(self, batch: Batch, seen: Images, draws: Draws) -> Batch:
        """Add image paths, each `factor` times the free-space field as it would arrive."""
        reference = np.zeros(len(batch)) if batch.free_gain is None else batch.free_gain
        spread = seen.spread * amplitude(self.strength_db)
        gain = reference[:, None] * seen.factor * spread * seen.turn
        gain = gain * self._of_links(batch, draws, gain.shape[1])
        return batch.with_paths(seen.extra_m / C_M_PER_NS, gain.astype(np.complex64), SPECULAR)

    def _of_links(self, batch: Batch, draws: Draws, count: int) -> Complexes | float:
        """Return what `count` paths have by chance [n, Q]: a loss of a link's own, and phases."""
        if not (self.placed_m or self.moved_m or self.spread_db):
            return 1.0
        own = draws.group_complex(batch.rows.group("link"), count) * np.sqrt(2)
        extra_m = self.placed_m * own.real
        if self.moved_m:
            extra_m = extra_m + self.moved_m * draws.normal(len(batch), count)
        turn = phasor(-extra_m / wavelength_m(batch.centre_ghz))
        return np.asarray(amplitude(self.spread_db * own.imag) * turn)

    def _images(self, batch: Batch, inside: NDArray[np.bool_]) -> Images:
        """Return a room's images; factor 0 outside of rooms. Remembered with the rows."""
        walls = (self.walls, self.floor, self.ceiling)
        order = int(self.highest_order)

        def made() -> Images:
            ends = [positions(batch.rows, end) for end in ("tx", "rx", "room")]
            tx, rx, room = (np.where(inside[:, None], end, 1.0) for end in ends)
            length, factor = image_paths(tx, rx, room, order, walls, batch.centre_ghz)
            shown = np.where(inside[:, None], factor, 0).astype(np.complex64)
            return Images.of(batch, length, shown)

        key = ("images", order, walls, batch.centre_ghz)
        found: Images = batch.rows.known.get(key, made)
        return found

    def _side_walls(self, batch: Batch, outside: NDArray[np.bool_]) -> Images:
        """Return the images in two walls parallel to the link [n, 2]."""
        truth = batch.rows.true_range_m[:, None]
        length = np.hypot(truth, 2 * self.wall_m * np.array([1.0, 1.7]))
        permittivity = material(self.walls).permittivity(batch.centre_ghz)
        factor = reflection(permittivity, np.arcsin(np.clip(truth / length, 0, 1)))
        shown = np.where(outside[:, None], factor, 0).astype(np.complex64)
        return Images.of(batch, length, shown)


def positions(rows: Scene, what: str) -> Floats:
    """Return the position (or room size) columns of `tx`, `rx` or `room` as [n, 3] metres."""
    return np.stack([rows.number(f"{what}_{axis}_m", np.nan) for axis in "xyz"], axis=1)


def in_room(rows: Scene) -> NDArray[np.bool_]:
    """Return the rows [n] whose room and antenna positions are all known.

    Remembered: not to be written into.
    """

    def made() -> NDArray[np.bool_]:
        known = [np.isfinite(positions(rows, what)).all(axis=1) for what in ("tx", "rx", "room")]
        return np.asarray(known[0] & known[1] & known[2])

    found: NDArray[np.bool_] = rows.known.get("in room", made)
    return found
