"""What is left after every known effect, as a curve over one covariate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.effects.fitted.device_values import as_tuples
from bench.physics.randomness import Draws


@dataclass(frozen=True)
class Unnamed(Effect):
    """UNNAMED: a smooth discrepancy of the range over one covariate; no physics is claimed.

    `column` is a numeric column of the rows, `knots` its values and `shifts_m` the mean
    discrepancy there (linear between, constant beyond), `spread_m` the scatter around it.
    """

    name = "unnamed"
    fitted: ClassVar[bool] = False
    stage = "ranging"
    stackable = True
    source = "fitted to recordings by bench diagnose; no physics is claimed"
    signature = "whatever was left after every known effect"

    column: str = "true_range_m"
    knots: tuple[float, ...] = (0.0,)
    shifts_m: tuple[float, ...] = (0.0,)
    spread_m: float = parameter(0, "m", 0, 100, "std around the mean discrepancy", null=0)

    def __post_init__(self) -> None:
        super().__post_init__()
        as_tuples(self, knots=None, shifts_m=len(self.knots))

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by the discrepancy at each row's value of the covariate."""
        value = batch.rows.number(self.column, float(np.median(self.knots)))
        scatter = self.spread_m * draws.normal(len(batch.rows))
        return batch.longer(np.interp(value, self.knots, self.shifts_m) + scatter)
