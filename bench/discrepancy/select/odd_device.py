"""One device of many whose waveforms are far off in all of its links: a fault of that device.

A register that is read late, or a clock of samples that runs otherwise, is a device's own. Its few
links hardly stand out among hundreds of figures, as chance picks all of them often enough. But no
chance has them all twice as far off as any simulated link of any device, and to one side.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import View
from bench.discrepancy.data.covariates import DEVICES
from bench.discrepancy.data.observables import LEVEL, RANGE
from bench.discrepancy.locate.finding import Located, finding_of
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.select.settings import LEADING, ODD_LINKS, ODD_SHARE
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.within_links import link_medians
from bench.discrepancy.settings import (
    RARE_BEYOND,
    RARE_P,
    RESOLUTION,
    SEARCH_FIRST,
    SEARCH_MEMBERS,
)
from bench.physics.units import Floats


def with_odd_device(search: Search, found: Located) -> Located:
    """Return what was found, or, where that is nothing, at which device waveforms are far off.

    Only where every recorded link has simulated rows of its own: a place that no simulated link
    has may be as far off.
    """
    rows = search.both
    if found.significant or not search.comparison.paired(rows):
        return found
    made = search.comparison.ensemble(rows, (), SEARCH_MEMBERS, SEARCH_FIRST)
    times = beyond_all(made, search.comparison.distinct(rows), rows)
    most = sorted(times, key=lambda one: -times[one])[:LEADING]
    seen = tuple(
        finding_of(
            made, rows.covariates, Cell(name, "mean", Place(device)),
            times[device, name], RARE_P, search.seed,
        )
        for device, name in most
    )  # fmt: skip
    return replace(found, findings=seen, p=RARE_P, tail_p=RARE_P) if seen else found


def beyond_all(made: Ensemble, own: int, rows: View) -> dict[tuple[str, str], float]:
    """Return by how many of the widest simulated links' offsets devices are off, by figure.

    Of the first `own` simulated versions the mean is what a link should have; the others, of
    similar links, say how far links may be from that. Of devices whose links are nearly all farther
    off than any of these.
    """
    out = {}
    devices = {n: m for n, m in rows.covariates.groups.items() if n.startswith(DEVICES)}
    code = np.unique(made.links, return_inverse=True)[1]
    for name, unit in zip(made.names, made.units, strict=True):
        if name in (RANGE, LEVEL):
            continue
        offset, widest = _offsets(made.versions_of(name), own, code)
        beyond = max(RARE_BEYOND * widest, RESOLUTION.get(unit, 0.0))
        for device, mask in devices.items():
            mine = offset[np.unique(code[mask])]
            mine = mine[np.isfinite(mine)]
            if widest > 0 and _odd(mine, beyond):
                out[device, name] = float(np.median(np.abs(mine))) / widest
    return out


def _offsets(versions: Floats, own: int, code: NDArray[np.intp]) -> tuple[Floats, float]:
    """Return what recorded links [L] are off by, and what the widest simulated one is.

    Of a simulator all versions are a link's own: each is held against the mean of the others.
    """
    recorded, simulated = versions[0], versions[1:]
    mean = simulated[:own].mean(axis=0)
    others = simulated[own:] - mean
    if not len(others):
        rest = (simulated.sum(axis=0) - simulated) / max(len(simulated) - 1, 1)
        others = simulated - rest
    widest = float(np.nanmax(np.abs(link_medians(others, code)), initial=0.0))
    return link_medians((recorded - mean)[None], code)[0], widest


def _odd(offsets: Floats, beyond: float) -> bool:
    """Return whether nearly all links of a device [k] are off to one side by more than `beyond`."""
    if len(offsets) < ODD_LINKS:
        return False
    sides = (float(np.mean(side * offsets > beyond)) for side in (-1, 1))
    return max(sides) >= ODD_SHARE
