"""A curve that is level is the constant it contains: no second explanation beside it."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.view import View
from bench.discrepancy.select.verdict import LeftOut
from bench.discrepancy.settings import LEVEL_CURVE_SHARE, WIDE_LEVELS_DB

LEVELS = "rx_power_dbm"


def without_disguises(options: tuple[LeftOut, ...], rows: View) -> tuple[LeftOut, ...]:
    """Return the options without curves that only repeat a simpler one of them.

    Only where the rows spread over levels: where they do not, a curve is level for want of data.
    """
    if len(options) < 2 or not _wide(rows):
        return options
    names = {name for option in options for name in option.names}
    first, *others = options  # the first is in the simulator: it stays
    return (first, *(option for option in others if not _repeats(option, names)))


def _wide(rows: View) -> bool:
    if LEVELS not in rows.recorded.names:
        return False
    levels = rows.recorded.column(LEVELS)
    known = levels[np.isfinite(levels)]
    if not len(known):
        return False
    low, high = np.quantile(known, (0.1, 0.9))
    return bool(high - low > WIDE_LEVELS_DB)


def _repeats(option: LeftOut, names: set[str]) -> bool:
    """Return whether an option is a level curve whose constant is among the names."""
    values = np.array(list(option.effect.values().values()))
    if not len(values) or not names & set(type(option.effect).contains):
        return False
    low, middle, high = np.quantile(values, (0.1, 0.5, 0.9))  # few rows reach the ends
    return bool(high - low < LEVEL_CURVE_SHARE * abs(middle))
