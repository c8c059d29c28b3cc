"""Every number that decides about comparing with a table: unit, reason, and its origin.

Origins in brackets as in `bench.discrepancy.settings`.
"""

from __future__ import annotations

from typing import Final

FREE_SPACE_DB: Final = -20.0  # that a level changes per decade of distance (Friis) [physics]
SLOPE_LINKS: Final = 8  # at least, to tell what a table does over the distance [convention]
WALK_CLIP: Final = 4.5  # median distances of links from a walk, that one counts for at most: three
# standard deviations of a normal law [convention]
KIND_FREEDOM: Final = 4.0  # links of a kind, that how all kinds scatter counts as, beside its own:
# of two or three a variance says next to nothing [convention]
LEAST_VARIANCE: Final = 1e-30  # keeps kinds that scatter by nothing comparable [derived]
HEADING_WAVES: Final = 2  # of an observable over headings: a lobe to one side, and to both
# [convention]
PARTS: Final = 6  # of a number, that rows of one link are told apart by [convention]
KNOWN_LINKS: Final = 16  # at least, to tell what devices, temperatures or headings do [convention]
KNOWN_P: Final = 1e-3  # that they do nothing, below which what they do is taken off: what is not
# plain would but add to the scatter [convention]
KNOWN_PASSES: Final = 4  # over all of them, until each stands beside the others [cost]
OVER_PASSES: Final = 2  # of distance and kinds beside that, and of that beside them [cost]
MOST_LEVER: Final = 0.9  # of a link on its own fit: more, and it tells nothing [convention]
LEAST_SPREAD: Final = 1e-9  # of the widest direction of columns: one below says nothing [derived]
UNKNOWN_SHARE: Final = 0.1  # of rows without an observable, to tell what is done to it [convention]
ROWS_ASSIGNED_AT_ONCE: Final = 400  # of a link; longer ones are matched in stretches [cost]
CHOICES_PER_ROW: Final = 4  # simulated rows looked at for each recorded one [cost]
COUPLED_ERRORS: Final = 4.0  # standard errors over links, from which on simulated range errors go
# with levels within links, or between them [convention]
FEWEST_TO_SCATTER: Final = 3  # links that may scatter about a line [derived]
COUPLED_LINKS: Final = 3  # for every thing known, beside which levels are asked [derived]
COUPLED_MOST: Final = 3.0  # scatters of simulated links, that a level may be off by multipath: more
# is something in the way [convention]
TIE: Final = 1e-9  # squared standard deviations by which earlier rows are nearer [derived]
MOST_VERSIONS: Final = 24  # matched simulated rows for each recorded one [cost]
SAME_PLACE_M: Final = 1.0  # [convention] links of one name whose true ranges differ by more in the
# median are other links: names such as A1 are used again in every building
FAR_STD: Final = 0.5  # standard deviations: a farther link is no counterpart [convention]
SAME_HEIGHT_M: Final = 0.5  # that a device hangs higher or lower and is a counterpart still: less
# than people, who hold tags, differ by [convention]
LEAST_OVERLAP: Final = 0.1  # share of simulated links near a distance, tables counting alike: fewer
# do not stand for the recorded ones [source] Crump, Hotz, Imbens and Mitnik 2009
CATEGORY_STD: Final = 2.0  # that another room, sight or obstacle counts as [convention]
DEVICE_STD: Final = 0.3  # that another device counts as: it varies less than a room [convention]
OVERLAP_SHARE: Final = 0.5  # of the rows, that must have a counterpart, to go on [convention]
OVERLAP_LINKS: Final = 16  # or as many links: four to confirm on, a dozen to work with [convention]
LEAST_STD: Final = 1e-9  # keeps a constant covariate finite [derived]
MIX_DIGITS: Final = (
    6  # of a mean of a covariate, that are told: more are how it was added [derived]
)
PAIRS_SHARE: Final = 0.75  # of links that are pairs of their own, at least, or it is said
# [convention]
SOUND_ROWS: Final = 200  # of the recorded ones, that a simulator is tried on first [cost]
AS_ONE: Final = 3.0  # standard deviations over rows, that ranges are off when a simulator
# is asked again, from which on it keeps something between calls [convention]
SAME_M: Final = 1e-6  # by which they may be off: rounding [derived]

# --- Constants (ensemble, locate/permutation_test) -----------------------------------------------
ROUNDING: Final = 1e-9  # of the largest value, that means of a constant are off it [derived]
RISE_M: Final = 1.0  # of a pulse's edge, beyond which no second path pulls it [convention]
LEAST_SINGULAR: Final = 1e-9  # of the largest: less is what other columns make [rounding]
LEAST_SUM: Final = 1e-5  # of standardised values in float32, that is more than rounding [derived]
LINKS_BEHIND: Final = 2  # simulated links behind as many obstacles: one tells no scatter [derived]
UNSEEN_NAMED: Final = 3  # categories that are listed (changes nothing but words)
