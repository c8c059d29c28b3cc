"""Crystal offsets of the devices of the recordings; the library's `clock-offset` draws them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from bench.physics.batch import Batch, altered
from bench.physics.effect import Effect, parameter
from bench.physics.effects.fitted.device_values import (
    Curves,
    as_curves,
    as_tuples,
    at_end,
    beside_middle,
    name_hash,
)
from bench.physics.effects.fitted.wander import bridge, nearest
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.units import Floats

SESSION_S = 600.0  # rows of two devices within it share what is not known of their clocks


@dataclass(frozen=True)
class DeviceClock(Effect):
    """Crystal offset of every device: error = c/2 x reply time x (offset of tx - offset of rx).

    `devices` are ids as in the columns `tx` and `rx`, `offsets_ppm` theirs (their mean is
    arbitrary: only differences act), `drifts_ppm_per_hour` their change with `time_s` from
    `reference_s` on, `slopes_ppm_per_c`, if any, that with `temperature_c` from `reference_c` on.
    A crystal that wanders has knots besides: `wander_ppm[i]` is added to device i at the times
    `knots_s[i]`. Between and beyond them stands what is expected of a process of Ornstein and
    Uhlenbeck, with standard deviation `spread_ppm` about the offset and time constant `settle_s`;
    what is not known farther from a knot than knots are from each other scatters every pair of
    devices anew every ten minutes.
    """

    name = "device-clock"
    explains: ClassVar[str] = "clock-offset"
    values_unit: ClassVar[str] = "ppm"
    fitted: ClassVar[bool] = False
    stage = "ranging"
    stackable = True
    source = "Neirynck, Luk and McLaughlin, WPNC 2016, equation (4); offsets fitted to recordings"
    signature = (
        "error proportional to reply time and ppm; sign flips with the roles; CIR unchanged; only "
        "differences between devices are seen: values are beside the mean of the middle third "
        "of devices, and one above zero makes ranges longer where the device is at tx"
    )
    needs = (("tx", "rx", "reply_time_s"),)
    control = "rows with zero reply time"

    devices: tuple[str, ...] = ()
    offsets_ppm: tuple[float, ...] = ()
    drifts_ppm_per_hour: tuple[float, ...] = ()
    reference_s: float = parameter(0, "s", -1e12, 1e12, "when the offsets hold")
    slopes_ppm_per_c: tuple[float, ...] = ()
    reference_c: float = parameter(25, "C", -100, 200, "at what temperature they hold")
    reply_time_s: float = parameter(3e-4, "s", 0, 1, "where the rows do not tell")
    knots_s: Curves = ()
    wander_ppm: Curves = ()
    spread_ppm: float = parameter(0, "ppm", 0, 100, "std of the wander", null=0)
    settle_s: float = parameter(3600, "s", 1, 1e9, "time constant of the wander")

    def __post_init__(self) -> None:
        super().__post_init__()
        count = len(self.devices)
        as_tuples(self, devices=None, offsets_ppm=count, drifts_ppm_per_hour=count)
        as_tuples(self, slopes_ppm_per_c=count if len(tuple(self.slopes_ppm_per_c)) else 0)
        as_curves(self, "knots_s", "wander_ppm", count)

    def values(self) -> dict[str, float]:
        """Return the offset of every device in ppm beside middling ones: only differences act."""
        pairs = zip(self.devices, beside_middle(self.offsets_ppm).tolist(), strict=True)
        return {f"offset_ppm[{device}]": offset for device, offset in pairs}

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by the clock error of each row's two devices."""
        offset = self.offset_ppm(batch.rows) + self._scatter_ppm(batch.rows, draws)
        reply = batch.rows.number("reply_time_s", self.reply_time_s)
        return altered(batch.later(offset * 1e-6 * reply / 2 * 1e9), clock_offset_ppm=offset)

    def offset_ppm(self, rows: Scene) -> Floats:
        """Return offset of tx minus offset of rx at each row's time and temperature [n]."""
        hours = (rows.number("time_s", self.reference_s) - self.reference_s) / 3600
        warmer = rows.number("temperature_c", self.reference_c) - self.reference_c
        slopes = self.slopes_ppm_per_c or (0.0,) * len(self.devices)
        ends = []
        for end in ("tx", "rx"):
            base = at_end(rows, end, self.devices, self.offsets_ppm)
            slope = at_end(rows, end, self.devices, self.drifts_ppm_per_hour)
            warm = at_end(rows, end, self.devices, slopes)
            ends.append(base + hours * slope + warmer * warm + self._wander(rows, end))
        return np.asarray(ends[0] - ends[1])

    def at(self, device: str, time_s: float) -> float:
        """Return the offset of a device at a time in ppm, with its drift and its wander."""
        number = self.devices.index(device)
        hours = (time_s - self.reference_s) / 3600
        steady = self.offsets_ppm[number] + hours * self.drifts_ppm_per_hour[number]
        if not self.knots_s or not self.knots_s[number]:
            return steady
        curve = np.array(self.knots_s[number]), np.array(self.wander_ppm[number])
        return steady + float(bridge(np.array([time_s]), *curve, self.settle_s)[0][0])

    def uncertainty_ppm(self, rows: Scene) -> Floats:
        """Return the standard deviation of the offset [n]: what the wander leaves open.

        Zero where knots are dense: there rows fixed the curve, not the knots alone.
        """
        variance = np.zeros(len(rows))
        for number, mine, time in self._members(rows, "tx", "rx"):
            knots = np.array(self.knots_s[number])
            gap = np.abs(knots[nearest(knots, time)] - time)
            far = gap > (np.median(np.diff(knots)) if len(knots) > 1 else 0.0)
            variance[mine] += far * bridge(time, knots, np.zeros_like(knots), self.settle_s)[1]
        return np.asarray(self.spread_ppm * np.sqrt(variance))

    def _wander(self, rows: Scene, end: str) -> Floats:
        """Return the wander of each row's device at one end [n] in ppm."""
        out = np.zeros(len(rows))
        for number, mine, time in self._members(rows, end):
            knots, values = np.array(self.knots_s[number]), np.array(self.wander_ppm[number])
            out[mine] = bridge(time, knots, values, self.settle_s)[0]
        return out

    def _members(self, rows: Scene, *ends: str) -> Iterator[tuple[int, NDArray[np.intp], Floats]]:
        """Yield per end and device with knots: the device's number, its rows, their times."""
        time = rows.number("time_s", self.reference_s)
        codes = name_hash(self.devices).tolist()
        for devices in map(rows.group, ends):
            for number, knots in enumerate(self.knots_s):
                mine = np.flatnonzero(devices == codes[number])
                if len(mine) and knots:
                    yield number, mine, time[mine]

    def _scatter_ppm(self, rows: Scene, draws: Draws) -> Floats:
        """Return one draw of what is not known [n]: equal for a pair of devices in ten minutes."""
        if not self.spread_ppm or not any(self.knots_s):
            return np.zeros(len(rows))
        tx, rx = rows.group("tx"), rows.group("rx")
        time = rows.number("time_s", self.reference_s) // SESSION_S
        session = np.asarray(time.astype(np.int64), np.int64).view(np.uint64)
        sign = np.where(tx > rx, 1.0, -1.0)  # the roles swapped, the same error of other sign
        normal = draws.group_normal((tx ^ rx) + session * np.uint64(0x9E3779B97F4A7C15))
        return np.asarray(sign * normal * self.uncertainty_ppm(rows))

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Rows with zero reply time."""
        return np.asarray(batch.rows.number("reply_time_s", self.reply_time_s) == 0)
