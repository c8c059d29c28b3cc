"""Numbers that decide about fits of values: unit, reason, and in brackets the origin."""

from __future__ import annotations

from typing import Final

WALL_PRIOR_M: Final = 1.0  # typical delay of one obstacle at most: 0.8 m of concrete
# [source: ITU-R P.2040-3, table 3]
WALL_PRIOR_DB: Final = 30.0  # typical loss of one obstacle at most [source: the same]
WARM_PRIOR_PPM_PER_C: Final = 0.3  # typical slope of a crystal's offset over temperature at most:
# 10 ppm over 35 degrees [source: Vig 1992, AT-cut quartz]
SLOPE_VALUES: Final = 3  # different times or temperatures, from which on a slope is asked for
# [convention]
