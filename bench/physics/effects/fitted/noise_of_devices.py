"""A noise floor that is louder at some devices, by as much as their log of noise says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from bench.physics.batch import Batch
from bench.physics.effects.fitted.device_values import as_tuples, at_end
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.randomness import Draws
from bench.physics.units import Floats


@dataclass(frozen=True)
class NoiseOfDevices(NoiseFloor):
    """Scales the noise of rows with one of `devices` at either end, in two-way ranging both hear.

    `louder_db`: by how much, beside `level_db` of all; `doubts_db`: standard errors of these. Both
    are read off the noise that is logged, and not fitted.
    """

    name = "noise-of-devices"
    explains: ClassVar[str] = NoiseFloor.name
    contains = (NoiseFloor.name,)
    fitted: ClassVar[bool] = False
    stackable = True
    source = "read off the noise that receivers log"
    signature = (
        "noise of few devices louder in every bin, before the first path too, as they log it"
    )
    held = ("devices", "louder_db", "doubts_db")

    devices: tuple[str, ...] = ()
    louder_db: tuple[float, ...] = ()
    doubts_db: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        count = len(self.devices)
        as_tuples(self, devices=None, louder_db=count, doubts_db=count)

    def _spread(self, batch: Batch, draws: Draws) -> Floats:
        """Return how much louder the devices of each row are than others [n] in dB."""
        ends = (at_end(batch.rows, end, self.devices, self.louder_db) for end in ("tx", "rx"))
        return sum(ends, super()._spread(batch, draws))
