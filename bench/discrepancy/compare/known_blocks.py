"""Columns of what both tables know of a row: a simulator may be off there what it is elsewhere."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bench.discrepancy.compare.settings import HEADING_WAVES, PARTS, RISE_M
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.split import Rows
from bench.physics.effects.propagation.antenna_pattern import harmonics, heading_rad
from bench.physics.effects.propagation.two_rays import rays
from bench.physics.scene import scene
from bench.physics.units import C_M_PER_NS, CENTRE_GHZ, Floats

AZIMUTH, REPLY, WARM = "azimuth_deg", "reply_time_s", "temperature_c"
SETTINGS = ("tx_power_dbm", "preamble_symbols")  # of radios, that may differ from row to row
ENDS = ("tx", "rx")
PLACES = tuple(f"{end}_{axis}_m" for end in ENDS for axis in "xyz")


@dataclass(frozen=True)
class Block:
    """Columns of recorded rows `ours` [n, w] and simulated ones `theirs` [k, w].

    `part` [k]: a code of simulated rows that have about the same in them.
    """

    ours: Floats
    theirs: Floats
    part: Rows


def known_blocks(recorded: pd.DataFrame, simulated: pd.DataFrame) -> Iterator[Block]:
    """Yield what both tables know of all rows: devices, clocks, warmth, power, heading, ground."""
    devices = [_devices(recorded, simulated, end) for end in ENDS]
    for ours, theirs in devices:
        if ours.shape[1] > 1:
            yield Block(ours, theirs, np.zeros(len(theirs), np.intp))
    reply = [numeric(frame, REPLY) for frame in (recorded, simulated)]
    if _all_known(*reply):
        yield from _of_clocks(recorded, simulated, reply)
    for name in (WARM, *SETTINGS):
        known = [numeric(frame, name) for frame in (recorded, simulated)]
        if _all_known(*known):
            yield _of_number(*known)
    headings = [_headings(frame) for frame in (recorded, simulated)]
    if _all_known(*headings) and (AZIMUTH in recorded) == (AZIMUTH in simulated):
        ours, theirs = (np.stack(harmonics(one, HEADING_WAVES), axis=1) for one in headings)
        yield Block(ours, theirs, _parts(headings[1] % (2 * np.pi)))
    rays = [_two_rays(frame) for frame in (recorded, simulated)]
    if all(np.isfinite(turn).all() for _, turn in rays):
        yield Block(rays[0][0], rays[1][0], _parts(rays[1][1]))


def _two_rays(frame: pd.DataFrame) -> tuple[Floats, Floats]:
    """Return how two rays go up and down [n, 8], and the phase between them [n] in radians.

    Of a mirror at height zero, to second order: levels in dB are not linear in what it returns.
    Ranges are pulled by as much more as the second way is longer, up to a pulse's rise. Phases are
    NaN where distances, heights or channels are not known.
    """
    known = frame[[name for name in ("true_range_m", *PLACES) if name in frame]]
    found = rays(scene(known, "table", moving=False))
    if found is None:
        return np.zeros((len(frame), 0)), np.full(len(frame), np.nan)
    centre_ghz = pd.Series(numeric(frame, "channel")).map(CENTRE_GHZ).to_numpy(np.float64)
    turn = 2 * np.pi * found.longer_m * centre_ghz / C_M_PER_NS
    share = found.size
    waves = np.stack([share**k * of(k * turn) for k in (1, 2) for of in (np.cos, np.sin)], axis=1)
    pulled = np.minimum(found.longer_m, RISE_M)[:, None] * waves
    return np.hstack([waves, pulled]), turn % (2 * np.pi)


def _of_number(ours: Floats, theirs: Floats) -> Block:
    """Return a slope and a bow over a number, in standard deviations of the simulated rows."""
    scale = max(float(theirs.std()), 1e-9)
    columns = [np.stack([x := (v - theirs.mean()) / scale, x**2], axis=1) for v in (ours, theirs)]
    return Block(columns[0], columns[1], _parts(theirs))


def _of_clocks(
    recorded: pd.DataFrame, simulated: pd.DataFrame, reply: list[Floats]
) -> Iterator[Block]:
    """Yield what goes with the reply time: of all rows, and of which clocks are at its ends."""
    yield _of_number(*reply)
    names = sorted(_names(recorded, ENDS) & _names(simulated, ENDS))
    if len(names) > 1:
        ours, theirs = (
            (_coded(frame, "tx", names) - _coded(frame, "rx", names))
            * (long / reply[1].mean() - 1)[:, None]  # devices have what goes with its mean
            for frame, long in zip((recorded, simulated), reply, strict=True)
        )
        yield Block(ours, theirs, _parts(reply[1]))


def _devices(recorded: pd.DataFrame, simulated: pd.DataFrame, end: str) -> tuple[Floats, Floats]:
    """Return which device of those in both tables is at an end of rows, [n, d] and [k, d]."""
    names = sorted(_names(recorded, (end,)) & _names(simulated, (end,)))
    return _coded(recorded, end, names), _coded(simulated, end, names)


def _names(frame: pd.DataFrame, ends: tuple[str, ...]) -> set[str]:
    """Return the names of devices at some ends of a table's rows."""
    return {str(name) for end in ends if end in frame for name in frame[end].dropna().unique()}


def _coded(frame: pd.DataFrame, end: str, names: list[str]) -> Floats:
    """Return 1 where one of `names` [d] is at an end of a row, else 0, [n, d]."""
    if end not in frame:
        return np.zeros((len(frame), len(names)))
    return np.asarray(frame[end].astype(str).to_numpy()[:, None] == np.array(names), np.float64)


def _headings(frame: pd.DataFrame) -> Floats:
    """Return the headings of a table's rows, or bearings where it has none, NaN where unknown."""
    known = frame[[name for name in (AZIMUTH, *PLACES) if name in frame]]
    if AZIMUTH in known and not _all_known(numeric(known, AZIMUTH)):
        return np.full(len(frame), np.nan)  # a heading is no bearing
    return heading_rad(scene(known.assign(true_range_m=1.0), "table"))


def _all_known(*values: Floats) -> bool:
    """Return whether numbers are known in all rows, and differ in the last of them."""
    return all(np.isfinite(one).all() for one in values) and bool(np.ptp(values[-1]))


def _parts(values: Floats) -> Rows:
    """Return a code of rows [k] whose values are about the same."""
    edges = np.quantile(values, np.linspace(0, 1, PARTS + 1)[1:-1])
    return np.asarray(np.searchsorted(edges, values), np.intp)
