"""What one observable of all working rows shows, where a search of waveforms shows nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.data.observables import LEVEL, RANGE
from bench.discrepancy.locate.permutation_test import Located
from bench.discrepancy.select.predictive_cells import kept
from bench.discrepancy.select.settings import WAVES_SHARE
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.stepwise import located_in
from bench.discrepancy.settings import FAMILY_WISE, RESOLUTION, SEARCH_FIRST, SEARCH_MEMBERS


def with_ranges(search: Search, found: Located) -> Located:
    """Return what waveforms show, or, where that is nothing, what ranges of all working rows do.

    One device of five that is late is seen by its ranges, and one finding among hundreds by chance.
    """
    ranges = None if found.significant else _of_all_rows(search, RANGE)
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
    levels = None if found.significant else _of_all_rows(search, LEVEL)
    large = tuple(o for o in levels.findings if _readable(o.told.effect)) if levels else ()
    if levels is None or not large:
        return found
    return replace(levels, findings=large, detectable=found.detectable)


def _readable(effect: Estimate) -> bool:
    """Return whether a reading of levels could tell so much of a difference in dB."""
    return max(abs(effect.low), abs(effect.high)) >= RESOLUTION["dB"]


def _of_all_rows(search: Search, name: str) -> Located | None:
    """Return what one observable of all working rows shows, None where sides do not share it.

    These share the error of the whole search with that of waveforms.
    """
    rows = search.both
    if name not in rows.recorded.names:
        return None
    made = search.comparison.ensemble(rows, (), SEARCH_MEMBERS, SEARCH_FIRST)
    if name not in made.names:
        return None
    share = (1 - WAVES_SHARE) / 2
    return located_in(search, rows, kept(made, (name,)), 0, share * FAMILY_WISE)
