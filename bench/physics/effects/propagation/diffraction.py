"""Effect 10: waves bend around the edges of what blocks the straight line."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.physics.batch import DIFFRACTED, Batch
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.slabs import opaque, slabs, unlisted
from bench.physics.units import C_M_PER_NS, Complexes, Floats, amplitude, wavelength_m

TYPICAL_M = 0.1  # longer around an edge
NEAREST = 4.0  # times as near as the median row behind one: nearer ones stand beside it


@dataclass(frozen=True)
class Bent:
    """Paths around edges [n, Q]: which are `none`, excess in metres, the edge's loss in dB.

    `others_db` is the loss of the obstacles beside it, `turn` the carrier's.
    """

    none: NDArray[np.bool_]
    excess_m: Floats
    loss_db: Floats
    others_db: Floats
    turn: NDArray[np.complex128]


@dataclass(frozen=True)
class Diffraction(Effect):
    """Adds a path around the two edges of every obstacle; bodies and metal block the straight one.

    Knife edge at `obstacle_clearance_m` (near edge) and `obstacle_far_clearance_m` from the
    straight line, at the fraction `obstacle_at` of it. Rows without line of sight whose obstacles
    are not listed, and rows behind what is opaque whose edges are not, get a blocking body of
    `body_half_width_m` at `body_at`.
    """

    name = "diffraction"
    number = 10
    stage = "propagation"
    stackable = True
    source = "ITU-R P.526-15, section 4.1, equations (26) and (31)"
    signature = "large loss with a small delay: mid-link body 13-19 dB, 2-4 cm"
    needs = (("obstacles",),)
    control = "rows with nothing in the straight line"

    strength_db: float = parameter(0, "dB", -20, 10, "of the bent paths over the knife edge's")
    clearance_scale: float = parameter(1, "ratio", 0.1, 4, "of the listed distances to the edges")
    body_half_width_m: float = parameter(0.2, "m", 0.02, 2, "of a blocker that is not listed")
    body_at: float = parameter(0.5, "ratio", 0.01, 0.99, "where it stands on the straight line")
    blocking_db: float = parameter(40, "dB", 0, 60, "loss of the straight path where blocked")

    @classmethod
    def ways(cls, rows: Scene) -> tuple[Floats, ...] | None:
        """Return a step where metal or a body stands in the way; None where none does.

        Only there is it certain that what arrives came around an edge. The way around one that lies
        so far off the straight line is longer by the less, the longer that is: by
        h^2 / (2 d a (1 - a)) of an edge at a part a of it.
        """
        shut = np.any(opaque(rows), axis=1)
        if not shut.any():
            return None
        usual_m = float(np.median(rows.true_range_m[shut]))
        nearer = usual_m / np.maximum(rows.true_range_m, usual_m / NEAREST)
        return (TYPICAL_M * np.stack([shut, shut * (nearer - nearer[shut].mean())], axis=1),)

    @classmethod
    def possible(cls, rows: Scene, shift_m: Floats) -> bool:
        """Return whether the ways around what is opaque are longer."""
        return float(np.mean(shift_m[opaque(rows).any(axis=1)])) > 0

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Block the straight path behind metal and bodies, and add the paths around."""
        reference = _direct_gain(batch)
        shut = opaque(batch.rows).any(axis=1) | unlisted(batch.rows)
        blocked = batch.direct_changed(np.where(shut, self.blocking_db, 0.0), np.zeros(len(batch)))
        bent = self._bent(batch)
        level_db = self.strength_db - bent.loss_db - bent.others_db
        gain = reference[:, None] * amplitude(np.where(bent.none, -300, level_db)) * bent.turn
        return blocked.with_paths(bent.excess_m / C_M_PER_NS, _cleaned(gain), DIFFRACTED)

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Return the rows with nothing in the straight line."""
        return batch.rows.clear()

    def _bent(self, batch: Batch) -> Bent:
        """Return the paths around all edges, remembered with the rows."""
        key = ("bent", self.clearance_scale, self.body_half_width_m, self.body_at, batch.centre_ghz)

        def made() -> Bent:
            edges, at, others_db, others_m = self._edges(batch)
            excess, loss = knife_edge(batch.rows.true_range_m[:, None], edges, at, batch.centre_ghz)
            turns = (excess + others_m) / wavelength_m(batch.centre_ghz)
            turn = np.exp(-2j * np.pi * (turns + 0.125))
            return Bent(np.isnan(edges), excess + others_m, loss, others_db, turn)

        found: Bent = batch.rows.known.get(key, made)
        return found

    def _edges(self, batch: Batch) -> tuple[Floats, Floats, Floats, Floats]:
        """Return the edges [n, 2M + 2]: distance (m, NaN = none), fraction, others' dB and m."""
        rows = batch.rows
        near = np.where(rows.kinds >= 0, rows.obstacle("obstacle_clearance_m", np.nan), np.nan)
        far = np.where(rows.kinds >= 0, rows.obstacle("obstacle_far_clearance_m", np.nan), np.nan)
        at = rows.obstacle("obstacle_at", 0.5)
        delay, loss = slabs(rows, batch.centre_ghz)
        others_db = loss.sum(axis=1, keepdims=True) - loss
        others_m = delay.sum(axis=1, keepdims=True) - delay
        body = np.where(_without_edges(rows), self.body_half_width_m / self.clearance_scale, np.nan)
        body_at, none = np.full((len(rows), 2), self.body_at), np.zeros((len(rows), 2))
        edges = np.column_stack([near, far, body, body]) * self.clearance_scale
        return (
            edges,
            np.column_stack([at, at, body_at]),
            np.column_stack([others_db, others_db, none]),
            np.column_stack([others_m, others_m, none]),
        )


def knife_edge(
    range_m: Floats, edge_m: Floats, at: Floats, centre_ghz: float
) -> tuple[Floats, Floats]:
    """Return excess path in metres and loss in dB around a knife edge.

    `edge_m` is how far the straight line of length `range_m` passes inside the edge, at the
    fraction `at` of its length. v = h sqrt(2 (d1 + d2) / (lambda d1 d2)),
    J = 6.9 + 20 log10(sqrt((v - 0.1)^2 + 1) + v - 0.1) dB.
    """
    first = range_m * np.clip(at, 0.01, 0.99)
    second = range_m - first
    spread = 2 * range_m / (wavelength_m(centre_ghz) * first * second)
    bend = edge_m * np.sqrt(spread) - 0.1
    loss = 6.9 + 20 * np.log10(np.sqrt(bend**2 + 1) + bend)
    excess = np.hypot(first, edge_m) + np.hypot(second, edge_m) - range_m
    return np.asarray(excess), np.asarray(np.maximum(loss, 0))


def _without_edges(rows: Scene) -> NDArray[np.bool_]:
    """Return the rows [n] behind something opaque of which nobody says where its edges are."""
    listed = rows.obstacle("obstacle_clearance_m", np.nan)
    far = rows.obstacle("obstacle_far_clearance_m", np.nan)
    unknown = opaque(rows) & np.isnan(listed) & np.isnan(far)
    return np.asarray(unlisted(rows) | unknown.any(axis=1))


def _direct_gain(batch: Batch) -> Complexes:
    """Return the free-space gain of the straight path [n], nothing in its way."""
    gain: Complexes = np.sum(np.where(batch.direct, batch.gain, 0), axis=1)
    return gain if batch.free_gain is None else batch.free_gain


def _cleaned(gain: NDArray[np.complex128]) -> Complexes:
    return np.where(np.isfinite(gain) & (np.abs(gain) > 1e-12), gain, 0).astype(np.complex64)
