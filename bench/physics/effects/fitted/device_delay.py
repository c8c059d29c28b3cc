"""Antenna delays of the devices of the recordings; the library's `antenna-delay` draws them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from bench.errors import BenchError
from bench.physics.batch import Batch
from bench.physics.effect import Effect
from bench.physics.effects.fitted.device_values import as_tuples, at_end
from bench.physics.randomness import Draws


@dataclass(frozen=True)
class DeviceDelay(Effect):
    """Antenna delay error of every device: error = c x (delay of tx + delay of rx) / 2."""

    name = "device-delay"
    explains: ClassVar[str] = "antenna-delay"
    values_unit: ClassVar[str] = "ns"
    fitted: ClassVar[bool] = False
    stage = "ranging"
    stackable = True
    source = "Decawave application note APS014; delays fitted to recordings"
    signature = (
        "constant in distance, power and line of sight; of each pair only the sum is seen, 0.15 m "
        "of range per ns, so the values are those of which most are near zero"
    )
    needs = (("tx", "rx"),)

    devices: tuple[str, ...] = ()
    delays_ns: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        as_tuples(self, devices=None, delays_ns=len(self.devices))
        if any(abs(delay) > 20 for delay in self.delays_ns):
            raise BenchError("effect 'device-delay': delays_ns expected within -20 to 20 ns")

    def values(self) -> dict[str, float]:
        """Return the delay of every device in ns."""
        pairs = zip(self.devices, self.delays_ns, strict=True)
        return {f"delay_ns[{device}]": delay for device, delay in pairs}

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by half the sum of both delays."""
        ends = [at_end(batch.rows, end, self.devices, self.delays_ns) for end in ("tx", "rx")]
        return batch.later((ends[0] + ends[1]) / 2)
