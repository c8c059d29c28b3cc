"""A curve that is level is the constant it contains: no second explanation beside it.

Nor is a drift of which nothing but its constant is there: that is an antenna delay.
"""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.view import View
from bench.discrepancy.data.observables import LEVEL
from bench.discrepancy.select.verdict import LeftOut
from bench.discrepancy.sets.settings import FLAT_M
from bench.discrepancy.settings import LEVEL_CURVE_SHARE, WIDE_LEVELS_DB
from bench.physics.effect import Effect
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.temperature import TemperatureDrift
from bench.physics.units import Floats


def without_disguises(options: tuple[LeftOut, ...], rows: View) -> tuple[LeftOut, ...]:
    """Return the options without curves and drifts that only repeat a simpler one of them.

    Curves only where the rows spread over levels: where they do not, one is level for want of data.
    """
    options = _without_steady(options, rows)
    levels = _most_levels_dbm(rows)
    if len(options) < 2 or np.ptp(levels) <= WIDE_LEVELS_DB:
        return options
    names = {name for option in options for name in option.names}
    first, *others = options  # the first is in the simulator: it stays
    return (first, *(option for option in others if not _repeats(option, names, levels)))


def _without_steady(options: tuple[LeftOut, ...], rows: View) -> tuple[LeftOut, ...]:
    """Return the options without drifts that hardly drift in these rows, beside a delay.

    The first is in the simulator: it stays.
    """
    if not any(AntennaDelay.name in option.names for option in options):
        return options
    return (*options[:1], *(one for one in options[1:] if not _steady(one.effect, rows)))


def _steady(effect: Effect, rows: View) -> bool:
    """Return whether an effect is a drift that is the same in all rows, to a tick of a clock."""
    if not isinstance(effect, TemperatureDrift):
        return False
    return float(np.ptp(effect.longer_m(rows.scene))) < FLAT_M


def _most_levels_dbm(rows: View) -> Floats:
    """Return the recorded levels between which most rows are [2], equal ones without levels."""
    known = rows.recorded.column(LEVEL) if LEVEL in rows.recorded.names else np.empty(0)
    known = known[np.isfinite(known)]
    return np.quantile(known, (0.1, 0.9)) if len(known) else np.zeros(2)


def _repeats(option: LeftOut, names: set[str], levels_dbm: Floats) -> bool:
    """Return whether an option is a curve, level where rows are, whose constant is among names."""
    knots = np.array(getattr(option.effect, "levels_dbm", ()))
    if not len(knots) or not names & set(type(option.effect).contains):
        return False
    values = np.array(list(option.effect.values().values()))
    between = np.linspace(levels_dbm[0], levels_dbm[1], 2 * len(knots))
    values = np.interp(between, knots, values)
    return bool(np.ptp(values) < LEVEL_CURVE_SHARE * abs(values.mean()))
