"""Every number that decides about sets of waveform effects: unit, reason, and its origin.

Origins in brackets as in `bench.discrepancy.settings`; [joint] was set on blind cases of waveforms
of seed 71537 that had been opened.
"""

from __future__ import annotations

from typing import Final

ROWS: Final = 320  # of the working rows, that take part at most [cost]
SCREEN_ROWS: Final = 60  # of those, that effects are tried on first [cost]
KNOWN_SHARE: Final = 0.5  # of the rows, that must know a statistic [convention]
MEMBERS: Final = 4  # simulated versions that a set is judged by [cost]
OTHERS: Final = 8  # further simulated versions, that stand in the recorded ones' place [cost]
OTHERS_KEPT: Final = 4  # sets whose further versions are remembered (changes nothing but time)
NOISE_LEAST: Final = 0.3  # squared standard deviations, that a squared deviation counts at least
FLOOR: Final = {"dB": 0.15, "ns": 0.1, "counts": 0.15, "symbols": 0.15, "1": 0.15}
# standard deviations that every statistic has at least: counts, symbols and kurtosis in decibels
DECIBELS: Final = {
    "noise_std": 20.0,
    "preamble_count": 10.0,
    "kurtosis": 10.0,
    "early_scatter": 20.0,
}
# observables that are compared by their logarithm, and how many decibels a decade is [convention]
LEAST_LOGGED: Final = 1e-3  # of the median, that such a value counts at least: none is zero
LEAST_UNIT: Final = 1e-12  # of such a median, in counts of whatever scale [rounding]
KEPT: Final = 500  # statistics of sets that are remembered (changes nothing but time)
LEVELS: Final = ("rx_power_dbm", "energy_db", "max_amplitude_db")  # of a link, as far as known
WEIGHED: Final = 4  # sets to weigh, from which on forks do it sooner (changes nothing but time)
LEAST_MOVED: Final = 1e-3  # of a statistic, in its unit: a link that moves by less is left alone
# [rounding]
LEAST_VARIANCE: Final = 1e-12  # of a statistic, in its unit squared: nothing [rounding]
SAME_SCATTER: Final = (0.2, 0.5)  # of the logarithm of a variance: so far off a sum is believed,
# and from there on it is not [convention]
LEAST_EIGENVALUE: Final = 0.02  # of the median one of a covariance [convention]
TAIL: Final = 30.0  # degrees of freedom of a link's misfit: far ones count by their logarithm
WEIGHINGS: Final = 4  # of links by how far they are off [cost]
ALONE: Final = (0.025, 0.05, 0.1)  # of a response, that links differ by: one of these [convention]
FORMS: Final = (0.1, 0.2, 0.3)  # of a response, that another form of it may differ by: one of these
CURVE_PARTS: Final = 5  # of the links, in each of which a curve of a receiver's own is free [cost]
UNEVEN: Final = (0.3, 1.0)  # of a response, that links have more or less of it in all at once
FREE_SIZES: Final = (0.3, 1.0, 3.0, 10.0)  # of what has no form at all, in the statistics' units
SIZE_STEPS: Final = 5  # of fitting a size for every statistic [cost]
SIZE_WEIGHINGS: Final = 2  # of links, in each of those [cost]
SIZE_LEAST: Final = 0.01  # of what has no form in a statistic, in its unit: none [convention]
SIZE_LARGEST: Final = 20.0  # the same: as far as anything goes [convention]
KNOWN_SIZE: Final = 1.0  # the same over one covariate, per standard deviation [convention]
FEWEST_ALIKE: Final = 4  # links of a group, and outside, to ask whether it differs [convention]
ACTS: Final = 0.05  # decibels or ns, below which a response is none [convention]
TOUCHES: Final = 4.0  # squared scatters over all links, that an effect must move to be tried

FITTED_ON: Final = 4  # points of an effect that do unlike things, fitted on few rows [cost]
ALIKE: Final = 0.9  # of a correlation, from where on two points do the same [convention]
BEGUN: Final = 2  # such points, from which an effect is fitted on all rows [cost]
TRIED_BESIDE: Final = 3  # points of an effect beside a set, that leave least [cost]
FAR_OFF: Final = 2.0  # squared, in scatters of links: a set that leaves so much is not all there is
# [convention]
STARTED: Final = 8  # forms of what is marked that are fitted in full [cost]
REFITTED: Final = 2  # steps of a fit that others began [cost]
POLISHED: Final = 8  # single effects that are fitted in full [cost]
BEAM: Final = (5, 4, 2)  # sets of one, of two, ... effects that are added to [cost]
GROWN: Final = 2  # sets with one effect more that are fitted in full, of each [cost]
MOST: Final = 4  # effects in a set [cost]
SETTLED: Final = 6  # times that another set may take the place of the likeliest [cost]
STEPS: Final = 5  # of a fit [cost]
PASSES: Final = 2  # of leaving off what is not needed, each with a fit of the rest [cost]
FIT_ROUNDS: Final = 3  # of so many steps, where the last still gains [cost]
STEP: Final = 0.03  # of the bounds, for differences [convention]
LONGEST_STEP: Final = 0.3  # of the bounds, in one step of a fit [convention]
DAMPING: Final = (0.1, 0.1, 10.0)  # tried one after the other [convention]
UNSURE_NATS: Final = 20.0  # that other responses may make of a difference [convention]
DONE_NATS: Final = 0.5  # a step that gains less is the last [cost]
SPREAD_WEIGHT: Final = 0.4  # of squared deviations in a fit, beside the means [convention]

NAME_NATS: Final = 8.0  # that a name must bring: some fifteen compete with many forms [joint]
NAME_SHARE: Final = 0.04  # of all that a set explains, that a name must bring [joint]
LEVEL_DB: Final = 3.0  # by which transmit powers and antennas of all links may be off [convention]
CLASS_NATS: Final = 3.0  # behind the best set, within which another is not excluded: 20 to 1
CLASS_SHARE: Final = 0.95  # of what a name brings, from which on another may do as well [joint]
OFF_SHARE: Final = 0.9  # the same of one whose late samples surely scatter otherwise [convention]
LEFT_NATS: Final = 10.0  # that something without a form brings beside the best set: something is
# there that no effect explains [convention]
LEFT_SHARE: Final = NAME_SHARE  # and of all that is explained then: as a name must [derived]
SCATTERED_SHARE: Final = 0.01  # the same over one covariate, of a set that scatters links: that
# hides much of what goes with a covariate, but no form is right to a thousandth [convention]
MISFIT: Final = 1.0  # mean square of what a set leaves, in scatters of simulated links, up to which
# it may be what is there; right sets leave 0.5 to 0.9 [derived]
MISFIT_FAR: Final = 3.0  # scatters, that a link's statistic counts in that at most: of normal ones
# three in a thousand are farther [convention]
MISFIT_SHARE: Final = 0.02  # of the mean square beyond chance without any effect, that a set may
# leave: forms of effects are right to a seventh at best [convention]
SCATTERS: Final = 2.0  # times the variance of a statistic, from where on a set makes links scatter:
# what is known must then tell nothing of it, however little that is beside the scatter [convention]
DB_PER_NEPER: Final = 8.686  # of an amplitude [derived]
TONE_FADING_DB: Final = 3.0  # of a tone where its fit begins: half that of a Rayleigh channel
QUIET_FEWEST: Final = 24  # samples of noise alone in a record, of which some lie behind the last
# path: of fewer, those hold echoes that are rare [convention]
QUIET_EARLY: Final = 8  # samples before the path, to say how they scatter: ten pairs of them are no
# neighbours [derived]
QUIET_LOUDER: Final = 1.26  # times the power before the path, up to which samples behind the last
# path hold noise alone: one decibel [convention]
QUIET_SMOOTH: Final = 8  # samples that this power is averaged over, as many as are before the path
QUIET_SURE: Final = 3.0  # standard errors, by which samples surely are more alike [convention]
QUIET_MEMBERS: Final = 16  # simulated versions of them: their error is a quarter of the recorded
# ones' then [cost]
COLOUR_SAMPLES: Final = 4  # from here on noise has nothing in common, as `NoiseFloor` says
CARRIED_LAGS: Final = 24  # samples apart, up to which they are asked if they go together [cost]
CARRIED_FEWEST: Final = 6  # such distances, to tell a beat from a tail's slope [convention]
CARRIED_PAIRS: Final = 4  # of samples in a row, at each: one pair may lie beside the path
CARRIED_P: Final = 1e-6  # of a test over all of them: rows share scenes, carriers are plain to see
# where they matter at all [convention]
QUIET_ERROR: Final = 0.01  # of the mean squared power over the square, 2 of noise, by which that of
# a receiver is off: samples are whole numbers, and clipped [convention]
SCATTER_LOGGED: Final = 0.15  # of the square of what is logged over the power of samples, by which
# it may be off that of the scatter of noise: a component's is 2.3 times that [convention]
MODULATED: Final = (
    0.1  # of the tones, that scatter as noise does over the samples that a log is of:
)
# many carriers at once do [convention]
QUIET_MOST_NATS: Final = 100.0  # that they may say: that is beyond doubt, and a share of it asks no
# more of another name than NAME_NATS [derived]
STEADY_PARTS: Final = (0.5, 1.0)  # of what a steady tone does, that another does: two that beat do
# half [derived]
RISE_NS: Final = 2.0  # of an edge of 500 MHz: by at most so much a level moves it [derived]
LOUDER: Final = 3.0  # times what a refused name brings, from where on another stands without it
BOUNDS_INFORMATION: Final = 12.0  # of a parameter that lies anywhere between its bounds [derived]
SIZE_STEP: Final = 0.06  # of the bounds, both ways, for intervals of parameters [convention]
SIZE_MEMBERS: Final = 8  # simulated versions for them [cost]
SIZE_WIDER: Final = 3.0  # times what slopes say: valleys bend, and fits end before their floor.
# Measured on recordings of known effects, seeds 52960 and 73311: 86 % hold the truth so, 61 % at 1

STRIKE_POINTS: Final = (0.03, 0.1, 0.25, 0.45, 0.7, 0.9)  # of the bounds, of a strike [cost]
STRIKE_HARD: Final = 0.45  # of the bounds, up to which a strike must leave a statistic known [cost]
STRIKE_PASSES: Final = 4  # over its parameters, while they gain [cost]
CLIMB_POINTS: Final = 32  # all over the bounds, that are tried for the values of a strike [cost]
CLIMB_STARTS: Final = 2  # of these, that steps are taken from, beside what is known [cost]
CLIMB_STEP: Final = 0.1  # of the bounds, first of these steps [cost]
CLIMB_LEAST: Final = 0.01  # and the smallest [convention]
CLIMB_TRIES: Final = 12  # of every parameter [cost]
CLIMB_GAIN: Final = 0.05  # nats, less than which is no gain [convention]
SANDWICH_STEP: Final = 0.03  # of the bounds, between points of a slope [convention]
OTHERS_HELD: Final = 1.5  # of an interval beside other values, known no better [convention]
RANGED_WEIGHT: Final = 10.0  # of what ranges of struck links say of a strike's lengths: a link has
# some twenty statistics of samples, whose forms are never right, and one range [convention]
RANGED_M: Final = 0.05  # that detectors of two makes find the same path apart [convention]
STRIKE_TURNS: Final = 3  # of fitting effects to spared links, and asking which are struck [cost]
STRUCK_FEWEST: Final = 4  # links, to say that links were struck [convention]
MOST_STRUCK: Final = 0.75  # of the links: what strikes nearly all has no calm ones to show it
CALM_FEWEST: Final = 4  # links that were not [convention]
CALM_SHARE: Final = 0.33  # of the struck ones, as many as were not at least [convention]
STRIKE_ALIKE: Final = 0.3  # of what a strike brings, from where another may do as well [convention]
LONGER_ODDS: Final = (
    0.75  # that a struck link reads longer than a spared one, at least [convention]
)
LONGER_M: Final = 0.03  # by which struck links read longer, in the median [convention]
FAINT_DB: Final = 4.0  # by which first paths of struck links are weaker than those of others, where
# these read no longer: more than shadowing or antennas of links in sight differ by [convention]
CALM_WIDER: Final = 1.25  # times the simulated standard deviation, that first paths of the others
# may differ by: of links that all fade (Rayleigh), the stronger two thirds do by 2.5 dB [derived]
FAINT_ODDS: Final = 0.9  # that a struck link's is weaker than a spared one's [convention]
LATER_NS: Final = 6.0  # behind the first path, from where on others are heard alone [derived]
SHORT_OF_STRUCK: Final = 0.5  # as many links as are struck, more than which read short by far where
# both ways are moved alike: of eight so moved, in six draws of seven [derived]
PREDICTED_P: Final = 0.01  # by chance, that something known tells which links are struck
PREDICTED_SHARE: Final = 0.25  # of which those are, that it tells then (as a correlation a
# half), where straight paths are seen behind what stands there [convention]
TOUCHED_P: Final = 0.05  # that links struck at random are all behind what is in place [convention]
SAME_DEVICE: Final = 0.999  # correlation, from where on a number is which device it is [convention]

EARLIEST_SAMPLES: Final = 40  # before a detected path, where a straight one is looked for [cost]
STRAIGHT_NS: Final = (-0.5, 2.5)  # about the edge of a straight path that would be detected: so
# long its pulse of 2 ns lasts [derived]
AHEAD_NS: Final = 4.0  # before that there is noise alone [derived]
EDGE_NS: Final = tuple(-8.0 + 0.5 * step for step in range(19))
# delays, in which the rise of a detected edge is looked for [convention]
RISEN: Final = 2.0  # times the noise, from where on that edge rises [convention]
SHOULDER_NS: Final = 1.0  # by which edges of struck links may rise sooner: paths close together
# have one edge, that is less steep. With 0 one blocked table in 25 showed a straight path [joint]

EDGE_OF_NOISE: Final = 6.0  # times the noise of a component, from where on a sample is a path: of
# 1 000 samples of noise alone none in 60 000 records [derived]
EDGE_OF_PEAK: Final = 0.12  # of the highest sample, the same: over side lobes [convention]
EDGE_AT: Final = 0.5  # of the first maximum, where an edge is timed: steepest there [derived]
EDGE_PARTS: Final = tuple(0.1 * step for step in range(1, 10))
# of a maximum, where detectors are tried to time an edge [cost]
CROSSED_NOISE: Final = tuple(2.5 * 1.25**step for step in range(10))
# times the noise of a component, where thresholds that edges are timed at are tried [cost]
CENTRE_SAMPLES: Final = 2  # on both sides of a top: so long a pulse of 2 ns is [derived]
DEAF_TIMES: Final = tuple(1.25**step for step in range(1, 10))  # deafer, that is tried [cost]
EDGE_WRONG_NS: Final = 3.0  # from where on an edge is another path: a pulse lasts 2 ns [derived]
EDGE_SPARE_NS: Final = 0.005  # on the mean, by which deafer detectors may differ in simulated rows:
# one edge in 600 is another path [convention]
EDGE_EARLY_NS: Final = 0.03  # on the mean, by which a recorded index may lie before what a deafer
# detector finds: one in 100 is of noise [convention]
LATE_MEMBERS: Final = 8  # simulated versions whose edges are found: of three late rows, all are
# recorded ones by chance once in 200 [derived]
LATE_SIZES_M: Final = tuple(1e-3 * 10 ** (0.1 * step) for step in range(41))
# scatters of links that are tried, up to 10 m [cost]
LATE_SHARES: Final = tuple(0.05 * step for step in range(-20, 61))
# of the index, that ranges may follow it by [cost]
LATE_TIMES: Final = 1.5  # that the likeliest may be off one: a detector may be timed at another
# part of a rise than half of it, and rises of 2 ns then differ by a third [convention]
LATE_LEAST_M: Final = 0.003  # that edges scatter by at least: samples are rounded [convention]
LATE_ERRORS: Final = 4.0  # that an index lies later by, to be late: ranges follow what a detector
# scatters by in all tables [joint]
LATE_P: Final = 0.05  # of rows on a later path in recordings alone, which ranges follow: ranges
# that did not differ at all were not asked [convention]
LATE_OWN: Final = 0.1  # squared logarithm that an edge scatters by at least [convention]
LATE_RISES_DB: Final = tuple(2.0 * step for step in range(1, 20))
# of a late detection, that are tried [cost]
LATE_FRACTIONS: Final = tuple(0.025 * step for step in range(1, 34))  # the same of the peak [cost]

GRAIN_ZONES_NS: Final = (4.0, 14.0, 30.0, 60.0, 112.0)  # behind the first path, in each of which it
# is asked how samples of a record scatter: the first is behind a pulse [convention]
GRAIN_FINE_NS: Final = (4.0, 6.0, 9.0, 14.0, 20.0, 30.0, 60.0, 112.0)  # the same of rows, sample by
# sample: an echo lasts as long as a pulse [convention]
GRAIN_FEWEST: Final = 8  # samples of a zone: ten pairs of them are no neighbours [derived]
GRAIN_CREST_NS: Final = 4.0  # about the first path, where its crest is [derived]
GRAIN_WEAKEST: Final = 1e-4  # of a crest, that a sample counts at least [rounding]
GRAIN_MEMBERS: Final = 4  # simulated versions of it [cost]
GRAIN_LEAST: Final = (0.03, 0.15)  # of the logarithm of a ratio, and of decibels: by so much
# receivers differ, by whole numbers and clipped samples [convention]
GRAIN_FORM: Final = 0.3  # of what an effect does to it, that is a matter of its form [convention]
GRAIN_CHANCE: Final = 1e-3  # of late samples that scatter so far from what is right [derived]
DENSE_SHARE: Final = 0.5  # of the power of a zone that was added, to say of how many ways it is
# made: half, of which a quarter shows [convention]
GRAIN_ABOUT: Final = 4  # samples on both sides, over which a profile is smooth [convention]
GRAIN_ALIKE: Final = 3.0  # samples that a pulse makes alike, which count once [derived]
BENEATH_DELAYS_NS: Final = (3.0, 5.0, 8.0, 12.0)  # of a ringing where its fit beside a tail
# begins, and how it decays: one echo, or what rings on [convention]
BENEATH_DECAYS_NS: Final = (0.01, 2.0, 4.0, 6.0, 8.0, 10.0)  # the same [convention]
BENEATH_BEGUN_DB: Final = -10.0  # while its shape is compared: its size follows [convention]
BENEATH_DB: Final = 2.0  # by which both are weaker there than each would be [convention]
BENEATH_LEAST: Final = 0.15  # of a late power that is alike in all rows, to begin with [convention]
BENEATH_ABOUT: Final = 2  # samples on both sides, over which it is smooth [convention]
PULSE_NS: Final = 2.0  # so long a pulse rises, and falls [derived]
GROWTH_NS: Final = (14.0, 30.0, 46.0, 62.0, 78.0, 94.0, 110.0)  # stretches of delay, of which later
# ones must not have more of what dies away: past the build-up of a room [convention]
GROWN_TIMES: Final = 1.25  # as much, from where on it grew: a decibel [convention]
GROWN_ERRORS: Final = 5.0  # standard errors, by which it is surely more: of fifteen pairs of
# stretches, by some thirty links [convention]
WIDER: Final = 1.1  # times, from which on a wider pulse as high as before is 0.4 dB more [derived]
