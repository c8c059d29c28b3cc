"""Every number that decides something in the table of what a diagnosis is worth."""

from __future__ import annotations

from typing import Final

LINKS: Final = (2, 4, 8)  # surveyed links, before all that there are
DRAWS: Final = 3  # of so many links, in every split
SIMULATED_LINKS: Final = 250  # places of recorded links, each drawn anew
SIMULATED_ROWS: Final = 6  # of each of these
STRETCH: Final = 0.2  # simulated ranges are the places' times 1 +- this
ROWS_PER_LINK: Final = 40  # of a recorded link at most: neighbours in time say the same
HIDDEN: Final = 32  # units of the network
STEPS: Final = 500  # of training [convention]
BATCH: Final = 128  # rows
PACE: Final = 3e-3  # of Adam
PENALTY: Final = 1e-3  # on squared weights
FURTHER_STEPS: Final = 100  # on surveyed links, after training on simulated rows
FURTHER_PACE: Final = 0.3  # of the first pace
FARTHEST_STD: Final = 3.0  # from the training rows: beyond, a figure counts as that far
BEND_M: Final = 0.3  # errors beyond count by their logarithm
TREES: Final = 100  # of gradient boosting
LEAF_ROWS: Final = 10
PRIOR_LINKS: Final = 1.0  # links that a shrunken offset counts for
FEWEST_LINKS: Final = 4  # to survey, beside the sealed ones
