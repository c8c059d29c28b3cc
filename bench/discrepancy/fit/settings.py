"""Numbers that decide about fits of values: unit, reason, and in brackets the origin."""

from __future__ import annotations

from typing import Final

WALL_PRIOR_M: Final = 1.0  # typical delay of one obstacle at most: 0.8 m of concrete
# [source: ITU-R P.2040-3, table 3]
WALL_PRIOR_DB: Final = 30.0  # typical loss of one obstacle at most [source: the same]
WALL_TURNS: Final = 3  # what a wall weakens is found later, beside which it delays [cost]
WARM_PRIOR_PPM_PER_C: Final = 0.3  # typical slope of a crystal's offset over temperature at most:
# some ppm over tens of degrees [source: Vig 1992, AT-cut quartz]
SLOPE_VALUES: Final = 3  # different times or temperatures, from which on a slope is asked for
# [convention]
MEAN_TOLD_SHARE: Final = 0.2  # of the squares of a constant that no clocks make, from which on
# clocks are fitted beside one [convention]
MEAN_PRIOR_M: Final = 1.0  # such a constant is rarely more [source: APS014, before calibration]
DRIFT_PRIOR_PPM_PER_HOUR: Final = 0.5  # [source] indoors crystals drift by tenths of a ppm an hour
WANDER_SPREADS_PPM: Final = (0.01, 0.03, 0.1, 0.3, 1.0)  # tried by marginal likelihood [cost]
WANDER_PASSES: Final = 20  # [cost]
SCALE_SETTLED: Final = 0.02  # relative change of the scatter that ends the passes [cost]
BEYOND_CURVE_DB: Final = 1.0  # above the largest level of a DW1000's curve, and
BEYOND_CURVE_SHARE: Final = 0.02  # the share of rows logged there, from which on levels are taken
# as they are logged [source: APS011, fig. 5; RECORDED: of 75 819 rows none is above it]
MOST_LEVERAGE: Final = 0.9  # of a link: more, and a fit follows it, so what it leaves of it tells
# nothing of its errors [convention]
USUAL_GAIN_DB: Final = 3.0  # of an antenna over the heading [convention]
