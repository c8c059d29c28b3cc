"""Effects with a value per device, and the unnamed one: what a diagnosis adds beyond the library.

They are ordinary effects, so a simulator written by a diagnosis runs anywhere `bench simulate`
does. The library's `clock-offset` and `antenna-delay` draw devices at random; these hold the
devices of the recordings.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.effects.propagation.antenna_pattern import heading_rad
from bench.physics.randomness import Draws
from bench.physics.scene import Scene

Floats = NDArray[np.float64]
Curves = tuple[tuple[float, ...], ...]
SESSION_S = 600.0  # rows of two devices within it share what is not known of their clocks


@lru_cache(maxsize=256)
def name_hash(names: tuple[str, ...]) -> NDArray[np.uint64]:
    """Return the hashes that `Scene.hashes` uses for these names."""
    return np.asarray(pd.util.hash_array(np.array(names, dtype=object)), np.uint64)


def _lookup(rows: Scene, end: str, devices: tuple[str, ...], values: tuple[float, ...]) -> Floats:
    """Return each row's value for its device at one end [n]; 0 for a device not listed."""
    if not devices:
        return np.zeros(len(rows))
    known, wanted = name_hash(devices), rows.group(end)
    order = np.argsort(known)
    place = order[np.minimum(np.searchsorted(known[order], wanted), len(known) - 1)]
    return np.where(known[place] == wanted, np.asarray(values, np.float64)[place], 0.0)


def _as_tuples(effect: Any, **lengths: int | None) -> None:
    """Turn list fields (as TOML gives them) into tuples and check their lengths."""
    for name, length in lengths.items():
        value = tuple(getattr(effect, name))
        if length is not None and len(value) != length:
            raise BenchError(f"effect {effect.name!r}: expected {length} values in {name}")
        object.__setattr__(effect, name, value)


def _as_curves(effect: Any, knots: str, values: str, count: int) -> None:
    """Turn lists of lists into tuples of tuples and check that they are `count` curves, or none."""
    for name in (knots, values):
        object.__setattr__(effect, name, tuple(tuple(map(float, c)) for c in getattr(effect, name)))
    at, given = getattr(effect, knots), getattr(effect, values)
    if len(at) not in (0, count) or list(map(len, at)) != list(map(len, given)):
        raise BenchError(
            f"effect {effect.name!r}: expected as many {values} as {knots}, for each of "
            f"{count} devices"
        )
    if any(b <= a for curve in at for a, b in pairwise(curve)):
        raise BenchError(f"effect {effect.name!r}: {knots} must increase")


def bridge(time: Floats, knots: Floats, values: Floats, settle: float) -> tuple[Floats, Floats]:
    """Return mean and variance [n] of an Ornstein-Uhlenbeck process given its `values` at `knots`.

    Unit stationary variance, time constant `settle`, all times in one unit. Only the two knots
    around a time count (it is a Markov process): the normal distribution given both.
    """
    after = np.searchsorted(knots, time)
    left, right = (np.clip(after + move, 0, len(knots) - 1) for move in (-1, 0))
    a = np.where(after > 0, np.exp(-np.abs(time - knots[left]) / settle), 0.0)
    b = np.where(after < len(knots), np.exp(-np.abs(time - knots[right]) / settle), 0.0)
    both = np.where((a > 0) & (b > 0), np.exp(-(knots[right] - knots[left]) / settle), 0.0)
    room = np.maximum(1 - both**2, 1e-12)
    weights = (a - b * both) / room, (b - a * both) / room
    mean = weights[0] * values[left] + weights[1] * values[right]
    return mean, np.clip(1 - weights[0] * a - weights[1] * b, 0.0, 1.0)


def nearest(knots: Floats, time: Floats) -> NDArray[np.intp]:
    """Return the position of the knot nearest to each time [n]."""
    middles = (knots[1:] + knots[:-1]) / 2
    return np.searchsorted(middles, time)


@dataclass(frozen=True)
class DeviceClock(Effect):
    """Crystal offset of every device: error = c/2 x reply time x (offset of tx - offset of rx).

    `devices` are ids as in the columns `tx` and `rx`, `offsets_ppm` theirs (their mean is
    arbitrary: only differences act), `drifts_ppm_per_hour` their change with `time_s` from
    `reference_s` on. A crystal that wanders has knots besides: `wander_ppm[i]` is added to device
    i at the times `knots_s[i]`. Between and beyond them stands what is expected of a process of
    Ornstein and Uhlenbeck, with standard deviation `spread_ppm` about the offset and time constant
    `settle_s`; what is not known farther from a knot than knots are from each other scatters every
    pair of devices anew every ten minutes.
    """

    name = "device-clock"
    explains: ClassVar[str] = "clock-offset"
    fitted: ClassVar[bool] = False
    stage = "ranging"
    source = "Neirynck, Luk and McLaughlin, WPNC 2016, equation (4); offsets fitted to recordings"
    signature = "error proportional to reply time and ppm; sign flips with the roles; CIR unchanged"
    control = "rows with zero reply time"

    devices: tuple[str, ...] = ()
    offsets_ppm: tuple[float, ...] = ()
    drifts_ppm_per_hour: tuple[float, ...] = ()
    reference_s: float = parameter(0, "s", -1e12, 1e12, "when the offsets hold")
    reply_time_s: float = parameter(3e-4, "s", 0, 1, "where the rows do not tell")
    knots_s: Curves = ()
    wander_ppm: Curves = ()
    spread_ppm: float = parameter(0, "ppm", 0, 100, "std of the wander", null=0)
    settle_s: float = parameter(3600, "s", 1, 1e9, "time constant of the wander")

    def __post_init__(self) -> None:
        super().__post_init__()
        count = len(self.devices)
        _as_tuples(self, devices=None, offsets_ppm=count, drifts_ppm_per_hour=count)
        _as_curves(self, "knots_s", "wander_ppm", count)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by the clock error of each row's two devices."""
        offset = self.offset_ppm(batch.rows) + self._scatter_ppm(batch.rows, draws)
        reply = batch.rows.number("reply_time_s", self.reply_time_s)
        return replace(batch.later(offset * 1e-6 * reply / 2 * 1e9), clock_offset_ppm=offset)

    def offset_ppm(self, rows: Scene) -> Floats:
        """Return offset of tx minus offset of rx at each row's time [n]."""
        hours = (rows.number("time_s", self.reference_s) - self.reference_s) / 3600
        ends = []
        for end in ("tx", "rx"):
            base = _lookup(rows, end, self.devices, self.offsets_ppm)
            slope = _lookup(rows, end, self.devices, self.drifts_ppm_per_hour)
            ends.append(base + hours * slope + self._wander(rows, end))
        return np.asarray(ends[0] - ends[1])

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


@dataclass(frozen=True)
class DeviceDelay(Effect):
    """Antenna delay error of every device: error = c x (delay of tx + delay of rx) / 2."""

    name = "device-delay"
    explains: ClassVar[str] = "antenna-delay"
    fitted: ClassVar[bool] = False
    stage = "ranging"
    source = "Decawave application note APS014; delays fitted to recordings"
    signature = "constant in distance, power and line of sight; separable per pair of devices"

    devices: tuple[str, ...] = ()
    delays_ns: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        _as_tuples(self, devices=None, delays_ns=len(self.devices))
        if any(abs(delay) > 20 for delay in self.delays_ns):
            raise BenchError("effect 'device-delay': delays_ns expected within -20 to 20 ns")

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by half the sum of both delays."""
        ends = [_lookup(batch.rows, end, self.devices, self.delays_ns) for end in ("tx", "rx")]
        return batch.later((ends[0] + ends[1]) / 2)


# DW1000 at 64 MHz PRF: logged receive level and the true one it stands for (APS011, figure 5).
LOGGED_DBM = (-120.0, -90.0, -87.5, -85.0, -82.5, -80.0, -77.5)
TRUE_DBM = (-120.0, -90.0, -86.5, -83.5, -80.0, -72.5, -60.0)
_GRID_DBM = np.arange(-115.0, -40.0, 0.5)
_LOGGED_AT_GRID = np.interp(_GRID_DBM, TRUE_DBM, LOGGED_DBM)
LOGGED_STD_DB = 0.4  # scatter of the logged level


def true_level_dbm(logged: Floats, budget: Floats, spread_db: float) -> Floats:
    """Return the expected true receive level [n] in dBm.

    Combines the `logged` level, which compresses above -80 dBm, with the link `budget` level
    known to `spread_db` (posterior mean over a grid); where none was logged, the budget's.
    """
    misfit = ((logged[:, None] - _LOGGED_AT_GRID) / LOGGED_STD_DB) ** 2
    weight = np.nan_to_num(misfit) + ((_GRID_DBM - budget[:, None]) / spread_db) ** 2
    weight = np.exp((weight.min(axis=1, keepdims=True) - weight) / 2)
    return np.asarray((weight * _GRID_DBM).sum(axis=1) / weight.sum(axis=1))


@dataclass(frozen=True)
class PowerCurve(Effect):
    """Received-power-dependent bias as a curve: `bias_m` at the true receive `levels_dbm`.

    The level of a row comes from its logged `rx_power_dbm` (decompressed) and a free-space budget
    of `level_at_1m_dbm`, known to `spread_db`. Rows without a logged level use the simulated one.
    """

    name = "power-curve"
    explains: ClassVar[str] = "power-bias"
    contains = ("antenna-delay",)  # a curve that is level
    fitted: ClassVar[bool] = False
    stage = "ranging"
    source = "Decawave application note APS011, version 1.0; curve fitted to recordings"
    signature = "an S-curve of error over receive level at fixed distance, in line of sight too"

    levels_dbm: tuple[float, ...] = (-77.0,)
    bias_m: tuple[float, ...] = (0.0,)
    level_at_1m_dbm: float = parameter(-58, "dBm", -80, -30, "budget at 1 m")
    spread_db: float = parameter(3, "dB", 0.2, 15, "how well the budget is known")

    def __post_init__(self) -> None:
        super().__post_init__()
        _as_tuples(self, levels_dbm=None, bias_m=len(self.levels_dbm))

    def level_dbm(self, rows: Scene) -> Floats:
        """Return the true receive level of each row [n]."""
        logged = rows.numbers.get("rx_power_dbm", np.full(len(rows), np.nan))
        budget = self.level_at_1m_dbm - 20 * np.log10(rows.true_range_m)
        return true_level_dbm(np.asarray(logged, np.float64), budget, self.spread_db)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by the curve at each row's level."""
        level = self.level_dbm(batch.rows) if batch.rows.has("rx_power_dbm") else batch.level()
        return batch.longer(np.interp(level, self.levels_dbm, self.bias_m))


@dataclass(frozen=True)
class PatternCurve(Effect):
    """Range error over the heading as a curve: `bias_m` at `headings_deg`, linear between, closed.

    For patterns that two harmonics do not follow, such as a narrow lobe. The heading is that of
    the library's `antenna-pattern`.
    """

    name = "pattern-curve"
    explains: ClassVar[str] = "antenna-pattern"
    contains = ("antenna-pattern",)  # the library's two harmonics
    fitted: ClassVar[bool] = False
    stage = "ranging"
    source = "Ledergerber and D'Andrea, IEEE Access 6 (2018); curve fitted to recordings"
    signature = "periodic in heading, the same at all distances"

    headings_deg: tuple[float, ...] = (0.0,)
    bias_m: tuple[float, ...] = (0.0,)

    def __post_init__(self) -> None:
        super().__post_init__()
        _as_tuples(self, headings_deg=None, bias_m=len(self.headings_deg))

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by the curve at each row's heading."""
        return batch.longer(closed(heading_rad(batch.rows), self.headings_deg, self.bias_m))


def closed(heading: Floats, headings_deg: tuple[float, ...], values: tuple[float, ...]) -> Floats:
    """Return a closed curve at headings [n] in radians."""
    return np.asarray(np.interp(np.degrees(heading), headings_deg, values, period=360.0))


@dataclass(frozen=True)
class Unnamed(Effect):
    """UNNAMED: a smooth discrepancy of the range over one covariate; no physics is claimed.

    `column` is a numeric column of the rows, `knots` its values and `shifts_m` the mean
    discrepancy there (linear between, constant beyond), `spread_m` the scatter around it.
    """

    name = "unnamed"
    fitted: ClassVar[bool] = False
    stage = "ranging"
    source = "fitted to recordings by bench diagnose; no physics is claimed"
    signature = "whatever was left after every known effect"

    column: str = "true_range_m"
    knots: tuple[float, ...] = (0.0,)
    shifts_m: tuple[float, ...] = (0.0,)
    spread_m: float = parameter(0, "m", 0, 100, "std around the mean discrepancy", null=0)

    def __post_init__(self) -> None:
        super().__post_init__()
        _as_tuples(self, knots=None, shifts_m=len(self.knots))

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by the discrepancy at each row's value of the covariate."""
        value = batch.rows.number(self.column, float(np.median(self.knots)))
        scatter = self.spread_m * draws.normal(len(batch.rows))
        return batch.longer(np.interp(value, self.knots, self.shifts_m) + scatter)
