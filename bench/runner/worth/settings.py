"""Every number that decides something in the table of what a diagnosis is worth."""

from __future__ import annotations

from typing import Final

LINKS: Final = (2, 4, 8)  # surveyed links, before all that there are
DRAWS: Final = 3  # of so many links, in every split
SIMULATED_LINKS: Final = 250  # places of recorded links, each drawn anew
SIMULATED_ROWS: Final = 6  # of each of these
STRETCH: Final = 0.2  # simulated ranges are the places' times 1 +- this
ROWS_PER_LINK: Final = 40  # of a recorded link at most: neighbours in time say the same
STEPS: Final = 400  # of training
PRIOR_LINKS: Final = 1.0  # links that a shrunken offset counts for
FEWEST_LINKS: Final = 4  # to survey, beside the sealed ones
