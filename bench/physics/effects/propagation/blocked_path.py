"""Effect 9: the straight path is blocked for good, and a reflection is ranged instead."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.physics.batch import SPECULAR, Batch
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.units import C_M_PER_NS, amplitude


@dataclass(frozen=True)
class BlockedPath(Effect):
    """In a share of the links without line of sight nothing arrives before the first reflection.

    There every path and tap earlier than the link's detour is suppressed and a path of
    `reflection_db` arrives at it. The detour is exponential over links, of mean `detour_m`.
    Where sight is not known, any link may be blocked.
    """

    name = "blocked-path"
    number = 9
    stage = "propagation"
    stackable = True
    source = "Kolakowski, Zenodo 10.5281/zenodo.4742391 (its NDP NLOS class)"
    signature = "errors of metres, one-sided, no energy before the detected path"
    control = "rows with line of sight"
    per_link = True
    strikes = ("share", "detour_m")
    struck_level = "reflection_db"
    silent_before = True
    essential_with_cir = ("detour_m",)  # a reflection at the path itself blocks nothing

    share: float = parameter(0.3, "ratio", 0, 1, "of the links not known to be in sight", null=0)
    detour_m: float = parameter(1.0, "m", 0, 5, "mean extra length of the first reflection")
    reflection_db: float = parameter(-12, "dB", -60, 0, "over the free straight path")

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Suppress what is early in blocked links and add the first reflection."""
        links = batch.rows.group("link")
        struck = (draws.group_uniform(links) < self.share) & ~self.inert(batch)
        detour_ns = -np.log(draws.group_uniform(links, 1)) * self.detour_m / C_M_PER_NS
        batch = batch.silenced(np.where(struck, detour_ns, -np.inf))
        turn = np.exp(2j * np.pi * draws.uniform(len(batch)))
        reference = np.zeros(len(batch)) if batch.free_gain is None else batch.free_gain
        gain = np.where(struck, reference * amplitude(self.reflection_db) * turn, 0)
        excess = np.asarray(detour_ns, np.float32)[:, None]
        return batch.with_paths(excess, gain.astype(np.complex64)[:, None], SPECULAR)

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Return the rows known to have line of sight."""
        return np.asarray(batch.rows.number("los", 0.0) == 1)
