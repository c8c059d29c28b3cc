"""Effect 7: obstacles in the straight line delay and weaken it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.effects.fitted.device_values import as_tuples
from bench.physics.materials import excess_m, loss_db, material, obstacle
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.slabs import UNLISTED, crossed, of_kind, opaque, slabs, unlisted
from bench.physics.units import C_M_PER_NS, Floats

TYPICAL_M = 0.1  # of one wall
WALL = "wall"


@dataclass(frozen=True)
class MaterialDelay(Effect):
    """Every slab in the straight line delays it by a fixed step and lowers its power.

    Excess path t (sqrt(eps_r - sin^2 theta) - cos theta) and the loss of the complex
    permittivity; kinds and thicknesses from `obstacles` and `obstacle_thickness_m`. Rows without
    line of sight whose obstacles are not listed get `unlisted_walls` brick walls. A wall stands
    between other paths too: they lose `spill` of its loss in dB. Nothing goes through metal and
    bodies: these block, and what goes around is `Diffraction`'s. Where `delays_m` say what one
    obstacle of each of `kinds` delays that is as thick as usual and hit at a right angle, in
    metres, it delays so, and where `losses_db` say what it takes, in dB, it takes that: tables
    name kinds, and neither make nor thickness.
    """

    name = "material-delay"
    number = 7
    stage = "propagation"
    stackable = True
    source = "ITU-R P.2040-3 (2023), section 2.2.2 and table 3"
    signature = "a positive step per wall, the same at all distances; the first path weaker"
    needs = (("obstacles",), ("los",))
    control = "rows with nothing in the straight line"
    by_kind = True
    of_levels = ("loss_scale", "spill")

    thickness_scale: float = parameter(1, "ratio", 0, 4, "of the listed thickness", null=0)
    delay_scale: float = parameter(1, "ratio", 0, 4, "of the slab's excess delay")
    loss_scale: float = parameter(1, "ratio", 0, 4, "of the slab's loss in dB")
    unlisted_walls: float = parameter(1, "walls", 0, 10, "0.14 m of brick each, where unlisted")
    spill: float = parameter(0, "ratio", 0, 1, "of a wall's loss that every other path has too")
    kinds: tuple[str, ...] = ()
    delays_m: tuple[float, ...] = ()
    losses_db: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        losses = len(self.kinds) if self.losses_db else 0
        as_tuples(self, kinds=None, delays_m=len(self.kinds), losses_db=losses)

    @classmethod
    def ways(cls, rows: Scene) -> tuple[Floats, ...] | None:
        """Return a step per kind of obstacle, and one for any; None where none is listed.

        None of what is opaque: what arrives behind it went around, not through.
        """
        through = (rows.kinds >= 0) & ~opaque(rows)
        kinds = np.unique(rows.kinds[through])
        counts = [(rows.kinds == kind).sum(axis=1) for kind in kinds]
        parts = [*counts, through.any(axis=1), unlisted(rows)]
        steps = TYPICAL_M * np.stack(parts, axis=1).astype(np.float64)
        return (steps,) if steps.any() else None

    @classmethod
    def possible(cls, rows: Scene, shift_m: Floats) -> bool:
        """Return whether walls delay."""
        return float(np.mean(shift_m[~rows.clear()])) > 0

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Delay and weaken the straight path of every row with an obstacle."""
        through = ~opaque(batch.rows)
        whole = slabs(batch.rows, batch.centre_ghz, self.thickness_scale)
        delay_m, loss = (np.where(through, each, 0) for each in whole)
        wall_m, wall_loss = self._unlisted(batch)
        of_walls = np.where(of_kind(batch.rows, WALL), loss, 0).sum(axis=1) + wall_loss
        every, of_walls = self._losses_db(batch.rows, loss.sum(axis=1) + wall_loss, of_walls)
        alone = np.minimum(every * self.loss_scale, 90.0)
        delay = self._delay_m(batch.rows, delay_m.sum(axis=1) + wall_m) / C_M_PER_NS
        common = np.minimum(self.spill * of_walls * self.loss_scale, alone)
        return batch.louder(-common).direct_changed(alone - common, delay)

    def _losses_db(self, rows: Scene, listed: Floats, of_walls: Floats) -> tuple[Floats, Floats]:
        """Return what all obstacles take of each row [n], in dB, and what walls take of it."""
        if not self.losses_db:
            return listed, of_walls
        each = crossed(rows, self.kinds) * np.array(self.losses_db)
        walls = np.isin(self.kinds, (WALL, UNLISTED))
        return each.sum(axis=1), each[:, walls].sum(axis=1)

    def _delay_m(self, rows: Scene, listed_m: Floats) -> Floats:
        """Return what obstacles delay each row [n]: `listed_m` by the tables if kinds are not."""
        if not self.kinds:
            return listed_m * self.delay_scale
        return np.asarray(crossed(rows, self.kinds) @ np.array(self.delays_m))

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Return the rows with nothing in the straight line."""
        return batch.rows.clear()

    def _unlisted(self, batch: Batch) -> tuple[Floats, Floats]:
        """Return excess path (m) and loss (dB) [n] of walls that no list names."""
        wall = obstacle("wall")
        permittivity = material(wall.material).permittivity(batch.centre_ghz)
        thick, normal = np.array([wall.thickness_m * self.thickness_scale]), np.zeros(1)
        walls = self.unlisted_walls * unlisted(batch.rows)
        loss = loss_db(thick, permittivity, normal, batch.centre_ghz)
        return walls * excess_m(thick, permittivity, normal), walls * loss
