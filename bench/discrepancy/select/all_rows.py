"""What all working rows show, where a search of waveforms in half of them shows nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.data.observables import LEVEL, RANGE
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select.predictive_cells import kept
from bench.discrepancy.select.settings import WAVES_SHARE
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.stepwise import located_in
from bench.discrepancy.settings import FAMILY_WISE, RESOLUTION, SEARCH_FIRST, SEARCH_MEMBERS


def with_waveforms(search: Search, found: Located) -> Located:
    """Return what was found, or, where that is nothing, what waveforms of all working rows show.

    Of a dozen links whose versions are compared sign by sign no difference stands out, however
    large; of twice as many it does.
    """
    others = tuple(name for name in search.both.recorded.names if name not in (RANGE, LEVEL))
    waves = None if found.significant else _of_all_rows(search, others)
    return waves if waves is not None and waves.significant else found


def with_ranges(search: Search, found: Located) -> Located:
    """Return what waveforms show, or, where that is nothing, what ranges of all working rows do.

    One device of five that is late is seen by its ranges, and one finding among hundreds by chance.
    """
    ranges = None if found.significant else _of_all_rows(search, (RANGE,))
    if ranges is None:
        return found
    least = {**found.detectable, **ranges.detectable}
    least = {n: min(value, found.detectable.get(n, np.inf)) for n, value in least.items()}
    return replace(ranges if ranges.significant else found, detectable=least)


def with_levels(search: Search, found: Located) -> Located:
    """Return what was found, or, where that is nothing, what levels of all working rows show.

    A weak antenna at one device of six is seen by these, and one finding among hundreds by chance.
    Less than readings of levels tell (`RESOLUTION`) is nothing, however surely it is seen.
    """
    levels = None if found.significant else _of_all_rows(search, (LEVEL,))
    large = tuple(o for o in levels.findings if _readable(o.told.effect)) if levels else ()
    if levels is None or not large:
        return found
    return replace(levels, findings=large, detectable=found.detectable)


def _readable(effect: Estimate) -> bool:
    """Return whether a reading of levels could tell so much of a difference in dB."""
    return max(abs(effect.low), abs(effect.high)) >= RESOLUTION["dB"]


def _of_all_rows(search: Search, names: tuple[str, ...]) -> Located | None:
    """Return what observables of all working rows show, None where sides share none of them.

    These share the error of the whole search with that of waveforms of half of them.
    """
    rows = search.both
    if not set(names) & set(rows.recorded.names):
        return None
    made = search.comparison.ensemble(rows, (), SEARCH_MEMBERS, SEARCH_FIRST)
    shared = tuple(name for name in names if name in made.names)
    if not shared:
        return None
    share = (1 - WAVES_SHARE) / 3
    return located_in(search, rows, kept(made, shared), 0, share * FAMILY_WISE)
