"""Effects 7 to 10 where nobody listed the obstacles: some links' straight path is obstructed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.units import C_M_PER_NS, Floats


@dataclass(frozen=True)
class ObstructedPath(Effect):
    """In a share of the links something unlisted weakens and delays the straight path.

    An obstructed link's loss is normal over links around `loss_db`, never negative; all its other
    paths have `common` of it too. Its straight path is later by `delay_m` (`delay_spread` of it
    exponential over links: materials differ in delay per dB), and no other path arrives before its
    detour, exponential over links with mean `detour_m`: where the straight path is lost under the
    threshold, the detour is what is ranged. Where sight is not known, any link may be obstructed.
    """

    name = "obstructed-path"
    stage = "propagation"
    stackable = True
    source = "losses and delays of walls (ITU-R P.2040-3), bodies (ITU-R P.526-15) and missed "
    source += "straight paths (Zenodo 10.5281/zenodo.4742391), drawn per link"
    signature = "in some links a weak first path, less power, a positive error of 0.1 m to metres"
    needs = (("cir",),)
    control = "rows with line of sight"
    per_link = True
    strikes = ("share", "detour_m")
    last = True
    without_cir = False

    share: float = parameter(0.5, "ratio", 0, 1, "of the links not known to be in sight", null=0)
    loss_db: float = parameter(15, "dB", 0, 60, "mean loss of the straight path")
    loss_spread_db: float = parameter(8, "dB", 0, 20, "its std over obstructed links")
    common: float = parameter(0.3, "ratio", 0, 1, "of that loss that every other path has too")
    delay_m: float = parameter(0.1, "m", 0, 1, "of the straight path behind the obstacle")
    delay_spread: float = parameter(
        0, "ratio", 0, 1, "share of the delay that is exponential over links", fitted=False
    )
    detour_m: float = parameter(0.5, "m", 0, 10, "mean extra length of the first other path")

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Weaken, delay and thin out the paths of the struck links."""
        struck = self.struck(batch, draws)
        links = batch.rows.group("link")
        loss = self.loss_db + self.loss_spread_db * draws.group_normal(links, 1)
        loss = np.where(struck, np.clip(loss, 0, 90), 0)
        detour = -np.log(draws.group_uniform(links, 2)) * self.detour_m / C_M_PER_NS
        behind = np.where(struck, self._delay_m(batch, draws) / C_M_PER_NS, 0)
        batch = batch.louder(-self.common * loss)
        batch = batch.direct_changed((1 - self.common) * loss, behind)
        return batch.silenced(np.where(struck, detour, -np.inf), direct=False)

    def _delay_m(self, batch: Batch, draws: Draws) -> Floats:
        """Return the straight path's delay [n] in metres: the same, or drawn per link."""
        drawn = -np.log(draws.group_uniform(batch.rows.group("link"), 3))
        return np.asarray(self.delay_m * (1 - self.delay_spread + self.delay_spread * drawn))

    def struck(self, batch: Batch, draws: Draws) -> NDArray[np.bool_]:
        """Return which rows [n] are of an obstructed link."""
        drawn: Floats = draws.group_uniform(batch.rows.group("link"))
        return np.asarray((drawn < self.share) & ~self.inert(batch))

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Return the rows known to have line of sight."""
        return np.asarray(batch.rows.number("los", 0.0) == 1)
