"""What a receiver logs beside ranges, recorded and simulated: symbols accumulated, and noise."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.residual_range import crowded, own_versions
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import View
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.observables import COUNT, LEVEL, NOISE
from bench.discrepancy.select.settings import ROUNDING_VARIANCE
from bench.discrepancy.select.state import Search
from bench.physics.simulator import Simulator

Floats = NDArray[np.float64]
Made = tuple[Floats, Floats, Floats]


@dataclass(frozen=True)
class Logged:
    """Recorded over simulated logs in dB, [n] each, NaN where a side does not log them.

    `level_dbm` [n] as recorded; `devices` [n, k] is 1 where a row is of a device, which may have
    settings of its own; `freedom` how many independent links there are; `rounding_db2` the variance
    that whole symbols have; `links` [n] tells the links, None where every row counts as its link;
    `arriving_dbm` [n] is the level as simulated, before a receiver turns it down. `simulated` is
    the same of a simulated version in the recorded rows' place, None where there is no other.
    """

    level_dbm: Floats
    count_db: Floats
    noise_db: Floats
    devices: Floats
    freedom: float
    rounding_db2: float
    links: NDArray[np.intp] | None = None
    arriving_dbm: Floats | None = None
    simulated: Logged | None = None

    @property
    def levels_dbm(self) -> tuple[Floats, ...]:
        """The levels [n] that counts may follow: as recorded, and as they arrive if that is known.

        What is turned down by many dB, now and then, is recorded weaker than what is not.
        """
        arriving = self.arriving_dbm
        if arriving is None or not np.isfinite(arriving).all():
            return (self.level_dbm,)
        return self.level_dbm, arriving

    @property
    def followed(self) -> tuple[Floats, ...]:
        """What counts may fall with [n]: the levels, and how far these fall behind what arrives.

        A receiver turns down and stops early at once; what is in the way of a signal makes it weak,
        and a receiver of weak signals accumulates all.
        """
        levels = self.levels_dbm
        return (*levels, *(arriving - levels[0] for arriving in levels[1:]))

    def known(self, *columns: Floats) -> NDArray[np.bool_]:
        """Return the rows [n] in which some columns are known."""
        return np.asarray(np.isfinite(np.stack(columns)).all(axis=0))


def logs(search: Search, rows: View) -> Logged:
    """Return what both sides log for some rows."""
    return _logged(search, rows, _simulated(search, rows))


def logs_as_simulated(search: Search, rows: View) -> Logged:
    """Return what both sides log, and the same of a simulated version (`Logged.simulated`)."""
    made = _simulated(search, rows)
    seen = _logged(search, rows, made)
    return replace(seen, simulated=_as_recorded(search, rows, seen, made))


def _logged(search: Search, rows: View, made: Made) -> Logged:
    """Return what is recorded of some rows over what is simulated of them (see `_simulated`)."""
    frame, (count, noise, arriving) = rows.frame, made
    level, counted = numeric(frame, LEVEL), numeric(frame, COUNT)
    most = float(np.nan_to_num(counted).max(initial=1.0))
    rounding = ROUNDING_VARIANCE * (10 / np.log(10) / most) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        count_db = 10 * np.log10(counted) - count
        noise_db = 20 * np.log10(numeric(frame, NOISE)) - noise
    devices = np.stack([np.ones(len(frame)), *rows.covariates.devices()], axis=1)
    links = len(np.unique(rows.links)) / crowded(search.comparison, rows)
    return Logged(level, count_db, noise_db, devices, links, rounding, rows.links, arriving)


def _as_recorded(search: Search, rows: View, seen: Logged, made: Made) -> Logged | None:
    """Return what a simulated version logs beside the others, None where there are no others."""
    other = search.comparison
    if isinstance(other, Resimulation):
        again = _counting(other).observe(rows.scene, replicate=1, cir=False)
        count_db, level = 10 * np.log10(again.preamble_count) - made[0], again.rx_power_dbm
        return replace(seen, level_dbm=np.asarray(level), count_db=count_db, arriving_dbm=made[2])
    if not isinstance(other, TableComparison):
        return None
    count, level = _matched(other, rows, COUNT, LEVEL)
    if len(level) < 2:
        return None
    with np.errstate(divide="ignore", invalid="ignore"):
        count = 10 * np.log10(count)
    count_db, arriving = count[0] - count[1:].mean(axis=0), level[1:].mean(axis=0)
    return replace(seen, level_dbm=level[0], count_db=count_db, arriving_dbm=arriving)


def _matched(other: TableComparison, rows: View, *names: str) -> list[Floats]:
    """Return columns of the simulated rows [v, n] that stand for some rows."""
    picks = np.stack(other.versions(rows)[: own_versions(other, rows)])
    return [numeric(other.frame, name)[picks] for name in names]


def _counting(other: Resimulation) -> Simulator:
    """Return the simulator with a count of its own.

    A count is to be explained here, not taken from the rows; the noise goes with the count.
    """
    return replace(other.simulator, base=replace(other.simulator.base, keep_count=0))


def _simulated(search: Search, rows: View) -> Made:
    """Return simulated counts and noise in dB and levels in dBm, [n]; NaN where not known."""
    other, unknown = search.comparison, np.full(len(rows.rows), np.nan)
    if isinstance(other, Resimulation):
        made = _counting(other).observe(rows.scene, cir=False).preamble_count
        seen = other.simulator.observe(rows.scene, cir=False)
        # What a receiver adds to samples, such as an offset, is in the noise that it logs of them.
        sampled = other.simulator.of_samples and not rows.waveform
        logged = other.simulator.observe(rows.scene) if sampled else seen
        return 10 * np.log10(made), 20 * np.log10(logged.noise_std), np.asarray(seen.rx_power_dbm)
    if not isinstance(other, TableComparison):
        return unknown, unknown, unknown
    count, noise, arriving = _matched(other, rows, COUNT, NOISE, LEVEL)
    with np.errstate(divide="ignore", invalid="ignore"):
        count, noise = np.log10(count), np.log10(noise)
    return 10 * count.mean(axis=0), 20 * noise.mean(axis=0), arriving.mean(axis=0)
