"""Every number that decides about sets of causes: unit, reason, and in brackets its origin.

Origins as in `bench.discrepancy.settings`; [sets] was set on blind cases of seed 83029.
"""

from __future__ import annotations

from typing import Final

NAME_NATS: Final = 6.0  # of evidence, that a name in a set must bring: 400 to 1, as some twenty
# names compete [sets]
SEEN_NATS: Final = 12.0  # that the loudest name must bring where a search found nothing: its price,
# and as much again [convention]
LAW_NATS: Final = 8.0  # the same for a law over a covariate, of which there are more [sets]
RANGE_LAW_NATS: Final = 12.0  # of a law over the distance: two names, a constant and a scale, may
# make one too [derived]
SMALLEST_STEP_NATS: Final = 1.0  # for the size of a cause, which is fitted [source: Akaike 1974]
RIVAL_NATS: Final = 3.0  # behind the best set, within which another is not excluded: 20 to 1 [sets]
MOST_CAUSES: Final = 5  # in a set [cost]
BEAM: Final = 5  # sets that are followed [cost]
OFFSET_RATIOS: Final = (0.0, *(0.05 * 2 ** (step / 2) for step in range(15)))  # variance of link
# offsets over that of rows; so close that a set hardly gains by what falls between two [cost]
FIRST_RATIO: Final = 7  # place of the ratio that is tried first: 0.4 [cost]
ROWS_PER_LINK: Final = 3  # on average, to tell what links keep from what rows do [convention]
ANY_MEAN: Final = 1e6  # variance of a mean over that of rows: nothing is known of it [derived]
LARGE_OFFSETS: Final = 2.0  # of the variance of rows, from which on link offsets are more than what
# positions and antennas leave, and their mean is in doubt [plan cases]
OWN_OFFSETS: Final = 4.0  # of the variance of simulated links, the same: two sides differ by twice
# that, and few links tell a variance within a factor of two [derived]
EM_STEPS: Final = 14  # of the sizes of causes [cost]
SIZE_BOUNDS: Final = (1e-8, 100.0)  # of a cause's variance, of what is typical: what is left of a
# clock whose carrier was corrected is a hundredth of a ppm and less, over milliseconds [convention]
LAW_SIZE: Final = 1e5  # largest, of a law's variance: faults of the set-up are metres [convention]
REWEIGHINGS: Final = 3  # [cost]
NOTHING: Final = 1e-6  # the weight of a row that takes no part [derived]
LEAST_WEIGHT: Final = 1e-3  # of a row that takes part [convention]
STRAY_LINK_M: Final = 0.25  # of offset from all others, from which on a link takes no part
STRAY_LINK_STD: Final = 5.0  # and as many scales of the others' offsets
LEAST_VARIANCE_M2: Final = 1e-8  # of rows: a tenth of a millimetre [derived]
DEFORMED: Final = 0.3  # share of a response that a smooth deformation of it may be [convention]
OFF_BY: Final = 0.15  # of what a response does over rows, that a constant or a line over the
# distance may be off beside it: a half at 20 to 1 [convention]
LAW_M: Final = 0.1  # typical size of a law, and of how far a device stands elsewhere [convention]
LAW_SCALE: Final = 0.02  # typical error of one device's unit [convention]
FEWEST_BEHIND: Final = 8  # links there, and in sight, to say how far these are off [derived]
LEAST_WIDER: Final = 4.0  # variances: of eight links each, less is chance (F, 5 %) [derived]
MOST_WIDER: Final = 400.0  # twenty times as far off [convention]
WIDER_P: Final = 0.01  # that simulated links behind something differ by no more [convention]
FEWEST_IN_SIGHT: Final = 24  # links in sight that tell without others what is constant [convention]
MOST_DEVICES: Final = 12  # at either end, those of most rows, whose faults take part [cost]
OWN_SCALE: Final = 0.003  # typical share of the distance, by which a device differs from the common
# scale: a third of that [convention]
LEVELS: Final = 5  # different values, fewer of which are categories [convention]
USUAL_LEVEL_DB: Final = 4.0  # off what is usual at a distance: half of what an obstacle takes
USUAL_SCATTERS: Final = 3.0  # of simulated levels, that usual ones are off at most [convention]
LEAST_LEVEL_DB: Final = 2.0  # and at least: a simulator's levels may hardly scatter [convention]
LEVEL_PASSES: Final = 4  # [cost]
FADING_SHARE: Final = 0.5  # of how much stronger signals are than simulated, that is no curve over
# the distance and the simulated level: else a path loss or a control of levels is most [convention]
FEWEST_ROWS: Final = 30  # below which sets are not told apart [convention]
DEVICE_ROWS: Final = 7  # of a device, to ask whether it stands elsewhere [convention]
SCATTER_NATS: Final = 0.02  # of gain, of scatter beside a set: it leaves less than single names
LEFT_SHARE: Final = 0.15  # of what names gain, that their forms may leave [convention]
MOST_LAWS: Final = 6  # that take part: that do most alone, and that do most beside names [cost]
EXPLAINED_STRAYS: Final = 0.34  # of the links that are far off, that may stay so beside a law: else
# they were struck one by one, and no law is made of them [convention]
FORMS_TRIED: Final = 8  # laws of a form in the place of a name [cost]
FORM_NATS: Final = 6.0  # by which a law over what a name is about must lead it: 400 to 1 [sets]
TIED_NATS: Final = -3.0  # of lead, from which on a law over anything else is no worse than a name:
# 20 to 1 [convention]
SAME_SHAPE: Final = 1e-6  # of a law's square, that a name cannot do: rounding [derived]
MISTAKEN_NATS: Final = 12.0  # that a law over a column that was set aside must bring beside a set;
# in the place of a name as one over what it is about, `FORM_NATS` [sets]
AS_SIMULATED: Final = (0.7, 1.8)  # of the simulated variance, what is left then [convention]
CALIBRATED_SHARE: Final = 0.25  # of a constant, that ranges may have in the mean where it is what a
# calibration took off: by chance one in four at most [convention]
SMALL_CONSTANT_M: Final = 0.05  # of all ranges, below which covers, detectors and films make one as
# well: an antenna's delay is mostly more than a third of a nanosecond [source: APS014; convention]
FLAT_M: Final = 0.005  # by which what is the same in all ranges may differ: a tick [convention]
HUMP_STEPS: Final = 60  # of expectation and maximisation, of two humps of ranges [cost]
SECOND_HUMP: Final = 3.0  # parameters more than of one: a share, a width, a centre [derived]
LEAST_SHARE: Final = 0.01  # of belief, that a set is asked for what else a name may do [cost]
CONSTANT_M: Final = 1e-9  # by which a column of one value may differ from row to row [rounding]
OWN_SHARE: Final = 0.1  # of what a value of an effect does, that no others of it do [convention]
NAMED_STRUCK: Final = 0.9  # of the links on which names act that are struck, and
NAMED_STRUCK_P: Final = 1e-4  # the chance of that, for what strikes to be the names' [convention]
NEAR_NATS: Final = 12.0  # behind the best set at its own weights, that others are asked at theirs:
# weights speak for their set by some nats, and against another [sets]
NEAR_SETS: Final = 4  # that are asked so [cost]
MOST_STD: Final = 2.5  # of a number, that a cause times it goes on to: a row far off all others is
# no proportion [convention]
GROUND_SIZES: Final = (-0.9, -0.7, -0.5, -0.3, -0.15, 0.15, 0.3, 0.5, 0.7, 0.9)  # of a reflection
# of the ground in levels [cost]
GROUND_STEEPNESSES: Final = (0.0, 0.5, 1.5)  # how much weaker where it is steep [cost]
OTHER_LEVELS_DB: Final = 3.0  # typical, of what else levels do: obstacles, antennas [convention]
LEVELS_MOST_NATS: Final = 4.0  # of the price of a name of ranges, that levels may pay [convention]
LEVEL_TURNS: Final = 3  # of names that share what levels do [cost]
STEADIER_NATS: Final = 3.0  # by which levels of links tell an error better than rows' [convention]
