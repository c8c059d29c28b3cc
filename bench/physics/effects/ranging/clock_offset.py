"""Effect 3: the crystals of the two devices differ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.physics.batch import Batch, altered
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.units import C_M_PER_NS, Floats
from bench.physics.ways import device_columns, known_mostly

TYPICAL_PPM = 1.0  # of one crystal beside the others
ROOM_C, WARMER_C, WARMER_PPM = 25.0, 20.0, 1.0  # AT-cut quartz: within some ppm of its frequency
# at room temperature over tens of degrees (Vig, Introduction to Quartz Frequency Standards, 1992)


@dataclass(frozen=True)
class ClockOffset(Effect):
    """Single-sided ranging reads c/2 x reply time x crystal offset long: 0.15 m per ppm and ms.

    Offset of a row = `clock_offset_ppm` where `use_column` is 1 and the column is known, plus
    `offset_ppm`, plus a constant of each device (`device_spread_ppm`, tx minus rx, so swapping
    the roles flips the sign), plus `drift_ppm_per_hour` x time. `double_sided` 1 leaves only
    offset x time of flight, as the asymmetric double-sided exchange does.
    """

    name = "clock-offset"
    number = 3
    stage = "ranging"
    stackable = True
    source = "Neirynck, Luk and McLaughlin, WPNC 2016; Decawave APS011, section 2"
    signature = "error proportional to reply time and ppm; sign flips with the roles; CIR unchanged"
    everywhere = True
    needs = (("reply_time_s",), ("clock_offset_ppm",))
    control = "rows with zero reply time"

    offset_ppm: float = parameter(0, "ppm", -100, 100, "common offset", null=0)
    device_spread_ppm: float = parameter(0, "ppm", 0, 40, "std over devices", null=0, fitted=False)
    drift_ppm_per_hour: float = parameter(0, "ppm/h", -20, 20, "drift of the offset", null=0)
    reply_time_s: float = parameter(3e-4, "s", 0, 1, "where the rows do not tell")
    double_sided: int = parameter(
        0, "0 or 1", 0, 1, "asymmetric double-sided exchange", fitted=False
    )
    use_column: int = parameter(
        0, "0 or 1", 0, 1, "add the recorded clock_offset_ppm", fitted=False
    )

    @classmethod
    def ways(cls, rows: Scene) -> tuple[Floats, ...] | None:
        """Return the reply time x what crystals are typically off; None without any.

        Of all transmitters beside all receivers, of each device, and what temperature takes from
        all of them, where it is known: a slope and a bow.
        """
        reply_s = rows.number("reply_time_s", 0.0)
        if not reply_s.any():
            return None
        tx, rx = device_columns(rows)
        per_ppm = (C_M_PER_NS * 1e3 * reply_s / 2)[:, None]
        every, own = TYPICAL_PPM * per_ppm, TYPICAL_PPM * per_ppm * (tx - rx)
        warm = known_mostly(rows.number("temperature_c", np.nan))
        if warm is None:
            return every, own
        warm = (warm - ROOM_C) / WARMER_C
        return every, own, WARMER_PPM * per_ppm * np.stack([warm, warm**2], axis=1)

    @classmethod
    def logged_ways(cls, rows: Scene) -> tuple[Floats, ...]:
        """Return what `clock_offset_ppm` makes of the reply times (see `use_column`)."""
        ppm, reply_s = (rows.number(name, 0.0) for name in ("clock_offset_ppm", "reply_time_s"))
        made = (C_M_PER_NS * 1e3 * ppm * reply_s / 2)[:, None]
        return (np.nan_to_num(made),) if made.any() else ()

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by the clock error of the exchange."""
        offset = self._offset_ppm(batch, draws)
        flight_s = batch.rows.true_range_m / C_M_PER_NS * 1e-9
        reply = batch.rows.number("reply_time_s", self.reply_time_s)
        time_s = flight_s if self.double_sided else reply / 2
        return altered(batch.later(offset * 1e-6 * time_s * 1e9), clock_offset_ppm=offset)

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Rows with zero reply time."""
        return np.asarray(batch.rows.number("reply_time_s", self.reply_time_s) == 0)

    def _offset_ppm(self, batch: Batch, draws: Draws) -> Floats:
        """Return the crystals' relative offset of each row [n]."""
        hours = batch.rows.number("time_s", 0.0) / 3600
        offset = self.offset_ppm + self.drift_ppm_per_hour * hours
        if self.use_column:
            offset = offset + batch.rows.number("clock_offset_ppm", 0.0)
        ends = [draws.group_normal(batch.rows.group(end)) for end in ("tx", "rx")]
        return np.asarray(offset + self.device_spread_ppm * (ends[0] - ends[1]), np.float64)
