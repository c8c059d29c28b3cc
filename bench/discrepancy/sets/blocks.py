"""What takes part beside faults of the set-up: effects of the library, laws over covariates.

Laws have no name to be given; they are there so that no name is given for them.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import View
from bench.discrepancy.data.columns import known_columns, numeric
from bench.discrepancy.data.covariates import DEVICES
from bench.discrepancy.data.grouped import in_several
from bench.discrepancy.data.observables import LEVEL
from bench.discrepancy.law.settings import LAW_SAME_PLACE_M
from bench.discrepancy.sets.settings import (
    DEFORMED,
    FEWEST_ROWS,
    LAW_M,
    LEAST_LEVEL_DB,
    LEVEL_PASSES,
    LEVELS,
    MOST_DEVICES,
    OFF_BY,
    USUAL_LEVEL_DB,
    USUAL_SCATTERS,
)
from bench.discrepancy.settings import LEAST_VARIATION
from bench.physics.effect import Effect
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.clock_offset import ClockOffset
from bench.physics.effects.ranging.power_bias import PowerBias
from bench.physics.ways import known_mostly, spread_over
from bench.recordings.motion import SPEED

Floats = NDArray[np.float64]
Blocks = dict[str, tuple[Floats, ...]]
OF_RANGE = "a law of true_range_m"
# What changes clocks and delays, and no pulse on its way.
OF_CLOCKS = ("temperature_c", "time_s", "reply_time_s", SPEED)
OF_DELAYS = ("time_s", "reply_time_s", SPEED)  # one that follows the temperature is a drift
OF_CRYSTALS = ("temperature_c", "time_s")  # of the reply time an exchange makes a proportion
ALWAYS = (AntennaDelay, ClockOffset, PowerBias, AntennaPattern)
PER_DEVICE = (AntennaDelay, ClockOffset)
Kinds = Mapping[str, type[Effect]]


def named_kinds(kinds: Kinds, rows: View) -> dict[str, type[Effect]]:
    """Return the effects that say what they can do to these rows, by name.

    Those whose values per device or level are fitted by code of ours are always among them.
    """
    known = known_columns(rows.frame)
    own = {kind.name: kind for kind in ALWAYS if not kind.lacking(known)}
    every = own | {kind.name: kind for kind in kinds.values()}
    return {name: kind for name, kind in every.items() if kind.ways(rows.scene) is not None}


def of_library(kinds: Kinds, rows: View) -> Blocks:
    """Return the parts [n, k] of what every effect can do, by its name."""
    found = {n: kind.ways(rows.scene) for n, kind in named_kinds(kinds, rows).items()}
    blocks = {name: block for name, block in found.items() if block is not None}
    if AntennaDelay.name in blocks:
        common, own = blocks[AntennaDelay.name]
        blocks[AntennaDelay.name] = common, _of_several_links(own, rows.links)
    return blocks


def kept_rows(blocks: Blocks, rows: NDArray[np.intp]) -> Blocks:
    """Return the blocks of some rows, those that do anything there."""
    made = {name: tuple(part[rows] for part in block) for name, block in blocks.items()}
    return {name: block for name, block in made.items() if any(part.any() for part in block)}


def _of_several_links(own: Floats, links: NDArray[np.intp]) -> Floats:
    """Return the columns [n, k] that are of rows of several links.

    One of a device of one link is whatever that link has by itself.
    """
    rows, columns = np.nonzero(own)
    several = in_several(columns, links[rows], own.shape[1])
    return own[:, several] if several.any() else own[:, :1] * 0.0


def of_one_device(blocks: Blocks) -> dict[str, Blocks]:
    """Return, by effect, the parts of which one column alone acts: a single device that is off.

    Where most devices are as they should be, values of one common size are not what is there.
    """
    out: dict[str, Blocks] = {}
    for name in (kind.name for kind in PER_DEVICE if kind.name in blocks):
        wide = max(blocks[name], key=lambda part: part.shape[1])
        columns = [wide[:, [i]] for i in range(wide.shape[1])]
        out[name] = {f"{name} of device {i}": (one,) for i, one in enumerate(columns)}
    return out


def of_laws(kinds: Kinds, rows: View) -> Blocks:
    """Return smooth laws over known numbers, but those that an effect has for its own."""
    own = _own_columns(list(kinds.values()), known_columns(rows.frame))
    out: Blocks = {}
    for name, values in rows.covariates.numbers.items():
        known = known_mostly(values)
        if name in own or known is None or len(np.unique(known)) < LEVELS:
            continue
        level = np.full((len(known), 1), LAW_M)
        out[f"a law of {name}"] = level, LAW_M * spread_over(known)
    return out | _of_devices(rows)


def _of_devices(rows: View) -> Blocks:
    """Return laws of the distance that hold for one device alone."""
    known = known_mostly(rows.scene.true_range_m)
    if known is None:
        return {}
    law = LAW_M * spread_over(known)
    devices = {n: mask for n, mask in rows.covariates.groups.items() if _of_device(n)}
    often = sorted(devices, key=lambda n: -int(devices[n].sum()))[: 2 * MOST_DEVICES]
    return {f"a law of {n}": (law * devices[n][:, None],) for n in often}


def _own_columns(kinds: Collection[type[Effect]], known: Collection[str]) -> set[str]:
    """Return the columns that effects are about, where these are known."""
    ways = [way for kind in kinds for way in kind.needs if set(way) <= set(known)]
    return {column for way in ways for column in way}


def usual_levels(rows: View, made: Ensemble | None = None) -> NDArray[np.bool_]:
    """Return which rows [n] have a level as is usual at their distance; all without levels.

    With what was simulated (`made`): as is simulated there, but for a line over the distance, and
    as near to that as simulated levels scatter.
    What stands in the way only takes: of two levels that are as frequent the stronger is usual.
    """
    level, width = numeric(rows.frame, LEVEL), USUAL_LEVEL_DB
    if made is not None and LEVEL in made.names:
        simulated = made.simulated_of(LEVEL)
        known = np.isfinite(simulated)
        count = np.where(known.any(axis=0), known.sum(axis=0), np.nan)  # none: not known here
        level = level - np.where(known, simulated, 0.0).sum(axis=0) / count
        width = float(np.clip(USUAL_SCATTERS * made.scatter_of(LEVEL), LEAST_LEVEL_DB, width))
    usual = np.isfinite(level) & (rows.scene.true_range_m > 0)
    if usual.sum() < FEWEST_ROWS:
        return np.ones(len(level), bool)
    if made is not None and LEVEL in made.names:
        usual &= np.abs(np.nan_to_num(level, nan=np.inf) - _strongest(level[usual])) < width
    far = np.log10(np.maximum(rows.scene.true_range_m, LAW_SAME_PLACE_M))
    for _ in range(LEVEL_PASSES):
        slopes = np.ptp(far[usual]) > LEAST_VARIATION  # all at one distance: a level, no line
        line = np.polynomial.Polynomial.fit(far[usual], level[usual], int(slopes))
        near = np.abs(np.nan_to_num(level - line(far), nan=np.inf)) < width
        usual = near if near.sum() >= FEWEST_ROWS else usual
    return np.asarray(usual)


def _strongest(level_db: Floats) -> float:
    """Return the strongest level about which half as many rows are as about any other."""
    width = USUAL_LEVEL_DB / 2
    places = np.arange(level_db.min(), level_db.max() + width, width / 2)
    near = (np.abs(level_db[:, None] - places) < width).sum(axis=0)
    return float(places[np.flatnonzero(near >= near.max() / 2)[-1]])


def deformed(
    response: Floats, rows: View, kind: type[Effect] | None = None, calibrated: bool = True
) -> Floats:
    """Return smooth deformations [n, k] of a response [n], that of an effect of this kind.

    Other sizes over every covariate and device, and another curve. What clocks make is of the same
    size everywhere, so only over what clocks go by; a delay that temperature changes is a drift.
    What crystals make is in proportion to the reply time, and no other curve. Where a mean may have
    been `calibrated` away a curve moves also rows in which the effect does nothing.
    """
    numbers = rows.covariates.numbers
    known = (known_mostly(numbers[name]) for name in varies_with(rows, kind) if name in numbers)
    slopes = [np.clip(standard(values), -2, 2) for values in known if values is not None]
    devices = [mask * 1.0 for name, mask in rows.covariates.groups.items() if _of_device(name)]
    bends = [response * one for one in (*slopes, *devices)]
    if kind is not ClockOffset:
        own = standard(response)
        bends += [response * own]
        bends += [float(np.std(response)) * (own**2 - 1)] if calibrated else []
    return DEFORMED * np.stack(bends or [response * 0], axis=1)


def varies_with(rows: View, kind: type[Effect] | None) -> tuple[str, ...]:
    """Return the numbers over which an effect of this kind may be of another size.

    What follows a measured level does so at any distance.
    """
    some = tuple(rows.covariates.numbers)
    if kind is not None and kind.follows:
        return tuple(name for name in some if name != "true_range_m")
    some = OF_CLOCKS if kind is not None and kind.everywhere else some
    return OF_DELAYS if kind is AntennaDelay else OF_CRYSTALS if kind is ClockOffset else some


def off_by(response: Floats, rows: View, kind: type[Effect] | None = None) -> Floats:
    """Return what a response [n] may be off by [n, k]: a constant, and a line over the distance.

    The mean of a pattern and the pull of a reflection depend on the make. No line where clocks
    make it, or the direction, or the level, which are the same at all distances, and nothing in
    rows where it does nothing (nothing is in the way). What crystals make is off by neither: beside
    them a constant is an antenna's.
    """
    far = known_mostly(rows.scene.true_range_m)
    same = kind is not None and (kind.everywhere or kind.follows or kind is AntennaPattern)
    line = [] if far is None or same else [np.clip(standard(far), -2, 2)]
    share = 0.0 if kind is ClockOffset else OFF_BY
    size = share * float(np.std(response)) * (response != 0)
    return np.stack([size, *(size * one for one in line)], axis=1)


def _of_device(name: str) -> bool:
    return name.startswith(DEVICES)


def standard(values: Floats) -> Floats:
    """Return values [n] beside their mean, in standard deviations."""
    return np.asarray((values - values.mean()) / max(float(np.std(values)), 1e-12))
