"""Devices whose logged noise is louder than simulated, where that of the others is not.

A noise floor of one level for all would make ranges of all devices late, and delays of the others
would be named to take that back.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import View
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.device_rows import devices_of
from bench.discrepancy.data.grouped import means_by_group
from bench.discrepancy.data.observables import NOISE
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select.receiver_logs import Logged
from bench.discrepancy.select.settings import (
    NOISE_FORMULA_DB,
    NOISY_ERRORS,
    NOISY_LEAST_DB,
    NOISY_LINKS,
    NOISY_MOST,
    NOISY_SHARE,
)
from bench.discrepancy.select.state import Search
from bench.discrepancy.settings import MAD_TO_STD, ONE_SIDED_95
from bench.physics.effects.fitted.noise_of_devices import NoiseOfDevices
from bench.physics.units import Floats

Masks = Mapping[str, NDArray[np.bool_]]
Level = tuple[float, float]


def noise_of_devices(search: Search, rows: View, seen: Logged) -> NoiseOfDevices | None:
    """Return the noise floor of few devices that are louder than simulated, None where none is."""
    known = np.isfinite(seen.noise_db)
    masks = {name: mask[known] for name, mask in devices_of(rows.frame).items()}
    if seen.links is None or not (known.any() and masks):
        return None
    level_db = seen.noise_db[known] - _simulated_db(search, masks)
    found = louder_devices(level_db, seen.links[known], masks)
    if not found:
        return None
    louder, doubts = zip(*found.values(), strict=True)
    return NoiseOfDevices(
        lag_1=0, lag_2=0, lag_3=0, devices=tuple(found), louder_db=louder, doubts_db=doubts
    )


def read_levels(effect: NoiseOfDevices) -> tuple[ParameterEstimate, ...]:
    """Return by how much each device is louder, as its log says, with 90 % intervals."""
    return tuple(
        ParameterEstimate(f"louder_db[{name}]", by_db, by_db - reach, by_db + reach, "dB")
        for name, by_db, reach in zip(
            effect.devices, effect.louder_db, ONE_SIDED_95 * np.array(effect.doubts_db), strict=True
        )
    )


def louder_devices(level_db: Floats, links: NDArray[np.intp], masks: Masks) -> dict[str, Level]:
    """Return by how much few devices are louder than others, with its standard error, by name.

    The loudest first, each beside those before it: medians of links, that few others move. None
    where it is more than a share of all: then they differ as devices do.
    """
    code = np.unique(links, return_inverse=True)[1]
    count = np.bincount(code)
    left = means_by_group(level_db[:, None], code, count)[:, 0]
    of_links = {name: np.bincount(code, mask) > 0 for name, mask in masks.items()}
    found: dict[str, Level] = {}
    for _ in range(NOISY_MOST + 1):
        rest = {name: _apart(left, mine) for name, mine in of_links.items() if name not in found}
        name = max(rest, key=lambda one: rest[one][0] / rest[one][1], default="")
        if not name or not _louder(*rest[name]):
            break
        found[name] = rest[name]
        left = left - found[name][0] * of_links[name]
    few = len(found) <= min(NOISY_MOST, NOISY_SHARE * len(masks))
    return found if few else {}


def _apart(left: Floats, mine: NDArray[np.bool_]) -> Level:
    """Return by how much the median of some links is above that of others, and its error."""
    if min(mine.sum(), (~mine).sum()) < NOISY_LINKS:
        return 0.0, 1.0
    middles = [float(np.median(left[part])) for part in (mine, ~mine)]
    beside = np.abs(left - np.where(mine, *middles))
    scatter = max(MAD_TO_STD * float(np.median(beside)), NOISE_FORMULA_DB)
    error = scatter * np.sqrt(np.pi / 2 * (1 / mine.sum() + 1 / (~mine).sum()))
    return middles[0] - middles[1], float(error)


def _louder(by_db: float, error_db: float) -> bool:
    return by_db > max(NOISY_LEAST_DB, NOISY_ERRORS * error_db)


def _simulated_db(search: Search, masks: Masks) -> Floats:
    """Return by how much rows' devices are louder than others in a simulated table [n].

    Rows that stand for recorded ones may be other devices'.
    """
    out = np.zeros(len(next(iter(masks.values()))))
    other = search.comparison
    if not isinstance(other, TableComparison):
        return out
    with np.errstate(divide="ignore", invalid="ignore"):
        level_db = 20 * np.log10(numeric(other.frame, NOISE))
    known = np.isfinite(level_db)
    theirs = devices_of(other.frame)
    for name in set(theirs) & set(masks):
        mine, others = theirs[name] & known, ~theirs[name] & known
        if mine.any() and others.any():
            by_db = float(np.median(level_db[mine]) - np.median(level_db[others]))
            out = out + max(by_db, 0.0) * masks[name]
    return out
