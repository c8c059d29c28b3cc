"""Every number that decides about names of waveforms beside those that all names share.

Origins in brackets as in `bench.discrepancy.settings`.
"""

from __future__ import annotations

from typing import Final

# --- Rows of one link are alike (select/adequacy) -------------------------------------------------
FEWEST_SEVERAL: Final = 12  # links of several rows, to say whether they are alike [convention]
MOST_STRUCK: Final = 0.8  # of links: where more seem struck, all are moved [convention]
KIND_LINKS: Final = 4  # with another number of a kind of obstacle, to say what one adds [derived]
SEVERAL_ROWS: Final = 2.0  # of a link, in the mean, to say what they have in common [derived]
OF_LINKS_SHARE: Final = 0.5  # of a mismatch of levels, that rows of a link must have in common
# for an effect that draws every link anew [convention]
LIKE_NONE: Final = 0.9  # of the most that an effect changes, which is no likeness if left [conv.]
OF_LINKS_DB: Final = 1.0  # change of a level, below which that is not asked [convention]

# --- What links have drawn (select/own_draws) ----------------------------------------------------
EVERYWHERE_SHARE: Final = 0.5  # of the error of a search, for what is off in all rows [convention]
IN_PLACES_SHARE: Final = 1 / 6  # for each of the three that look everywhere else

# --- What ranges or levels show by themselves (select/all_rows) -----------------------------------
WAVES_SHARE: Final = 0.25  # of the error of a search, for half of the rows; the rest for all
# of all rows, in equal parts [convention]

# --- One device whose waveforms are far off (select/odd_device) -----------------------------------
ODD_LINKS: Final = 3  # of a device, that its waveforms are told by [convention]
ODD_SHARE: Final = 0.8  # of its links, that are far off to one side [convention]

# --- How links scatter (select/shared_variance) ---------------------------------------------------
ALIKE_DEGREES: Final = (0.01, 200.0)  # of freedom, that other links add to what is known of one:
# none, and so many that a t is a normal distribution [derived]

# --- Independent scatter (select/scatter_shape) ---------------------------------------------------
NO_SCATTER_SHARE: Final = (
    0.1  # of recorded variance: less than that has no shape to see [convention]
)
FEWEST_SHAPED: Final = 50  # rows, for a kurtosis within 0.7 of its own [convention]
SHAPE_Z: Final = 3.0  # of shorter tails than normal, and below which a skew is none [convention]
OVERDONE_P: Final = 1e-3  # chance of rows of links that scatter as much less than with a jitter, by
# variances and by ranks, below which there is none of that size [convention]
BOUNDED_P: Final = 0.01  # of equal widths in all links, that a bounded scatter must have [conv.]

# --- Rows that follow each other (select/in_turn) -------------------------------------------------
IN_TURN_ROWS: Final = 3  # of a link, at least: two differ by as much in either turn [derived]
IN_TURN_SHARE: Final = 0.5  # of what rows of a link scatter by, less than which rows that follow
# each other differ by where most of it is not drawn for each, as `LAW_OF_SCATTER` [convention]
IN_TURN_P: Final = 0.01  # that rows in random turns differ by so little [convention]
IN_TURN_DRAWS: Final = 400  # of random turns [cost]

# --- Faults of the recorder (select/recorder) -----------------------------------------------------
CLIPPED_ROWS: Final = 0.05  # of the rows, with one largest value [convention]
CLIPPED_SAME: Final = 1e-6  # of it, within which values are one: 24 bits of single precision
UNITS_DB: Final = 60.0  # between peaks of both sides: no effect moves levels so far [convention]
GAIN_DB: Final = 30.0  # the same beside what levels differ by: both weaken alike [convention]
LOGARITHMS_DB: Final = 20.0  # the same, from which on samples may be logarithms on one side
LEAST_OF_MEDIAN: Final = 0.4  # of the median sample of a row, that its least one in a hundred is of
# logarithms at least: of magnitudes of noise it is 0.12 [derived]
MOST_ROWS_FAR: Final = 0.5  # of the rows, of which it must be so large [convention]
HELD_DB: Final = 0.2  # that peaks vary by, at most, which were scaled to one: 2 % [derived]
VARIED_DB: Final = 1.0  # that peaks vary by, at least, which were not [convention]
STUCK_DB: Final = 6.0  # out of both neighbours: a pulse of 2 samples at half height is 3 [derived]
STUCK_Z: Final = 8.0  # standard errors over rows [convention]
STUCK_PLACES: Final = 3  # at least [convention]
STUCK_QUIET: Final = 25.0  # percentile of the levels of places that is no more than noise: records
# begin before the first path, and tails end [convention]
PULSE_SAMPLES: Final = 6  # around the first path, where the pulse itself stands [derived]

# --- A stuck bit of the ranges (select/range_word) ------------------------------------------------
BIT_PERIOD_M: Final = (0.02, 3.0)  # twice the weight of a bit: coarse enough to matter [convention]
BIT_BIN_M: Final = 0.002  # of the histogram whose periods are looked at: a tenth of the shortest
BIT_OVERSAMPLED: Final = 16  # frequencies per cycle over all distances: phases to 1/32 [derived]
BIT_TRIES: Final = 8  # frequencies at which readings crowd most [cost]
BIT_ROWS: Final = 60  # at least: 0.5^60 by chance, over 10^5 frequencies [derived]
BIT_LINKS: Final = 12  # at least, as rows of one place are alike [convention]
BIT_EMPTY: Final = (0.45, 0.56)  # share of a period that no reading falls into [derived]
BIT_FILLED: Final = 0.3  # of true ranges, that lie there all the same: half by chance [derived]
BIT_UNEVEN_P: Final = 1e-3  # of readings even over the other half: a rounding that scatters is not

# --- Ranges beside waveform effects (select/range_part) -------------------------------------------
DETECTION_M: Final = (
    0.01  # that receivers differ by in what they make of a changed waveform [waves]
)
ALIKE_M: Final = 1e-3  # by which an effect moves ranges, below which it moves levels alone
UNLISTED_M: Final = 0.5  # that a changed waveform of no known effect may shift a range [waves]
DETECTION_SHARE: Final = 0.5  # of what an effect does to ranges, that depends on the detector
FORM_SIZES: Final = (0.1, 0.3, 1.0)  # times all these, as forms may be: half decades

# --- Weak signals scatter more (select/row_weights) -----------------------------------------------
NOISE_PARTS: Final = (0.0, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0)  # of the variance, at the median level,
# that falls as the power, over what does not [cost]
SCATTER_PART_NATS: Final = 3.0  # that such a part must bring: 20 to 1 [convention]
SCATTER_OUTLIER: Final = 5.0  # standard deviations, as far as one row counts [convention]

# --- Marks of ranges (select/marks) ---------------------------------------------------------------
FORM_LEAD_NATS: Final = 3.0  # by which another form of a mark must lead the plain one: 20 to 1
MARK_SHARE: Final = 0.2  # of the scatter of rows: less adds 2 % to it, as centimetres printed do
PRINTED: Final = 1e-3  # of a decade, that a printed step may be read off by [convention]
ODD_MARK_SHARE: Final = 0.1  # of steps that no number is printed in; adds 0.5 % [convention]

# --- Logs of the receiver beside ranges (select/logged) -------------------------------------------
LOGGED_NATS: Final = 6.0  # that a name must bring, as in a set of causes [derived]
LOGGED_LEVELS: Final = (0.05, 0.15, 0.25, 0.4, 0.5, 0.6, 0.75, 0.85, 0.95)  # quantiles, from which
# on counts may fall [cost]
LOGGED_SHARES: Final = (0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0, 1.2)  # of the measured fall [cost]
LOGGED_SHIFTS_DB: Final = (-6.0, -4.5, -3.0, -1.5, 0.0, 1.5, 3.0, 4.5, 6.0)  # [cost]
LOGGED_COMPRESSIONS: Final = (0.0, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0, 1.25, 1.5)  # [cost]
CONTROL_SLOPES: Final = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8, 1.0)  # of every dB above
# its start, that a control may take: no more than all [cost]
CONTROL_BEND_DB: Final = 0.02  # that a control's own curve may be off by between its knots [cost]
CONTROL_TURNS: Final = 6  # of a control's own curve and the effects beside it [cost]
CONTROL_RATIO: Final = 3.2  # dB that a level falls by for each dB of the count, at most: 17.5 and
# 5.6 dB at -60 dBm [manual of the DW1000, figure 22, and recorded counts]
NOISE_FORMULA_DB: Final = 0.1  # that a std of some hundred samples and its formula differ by: 1 %
LEAST_ADDED_DB: Final = 0.2  # of noise, that has a name: twice what levels are told to [convention]
NOISY_LINKS: Final = (
    3  # of a device, and of others, to ask whether its noise is louder [convention]
)
NOISY_ERRORS: Final = 6.0  # standard errors, by which a device's noise surely is [convention]
NOISY_LEAST_DB: Final = 1.0  # that it is louder by: devices of one make differ by less [convention]
NOISY_MOST, NOISY_SHARE = 3, 1 / 3  # devices that are, and of all: more differ as devices do
# [convention]
EXTRA_SCATTER_M: Final = (1e-3, 1.0, 61)  # tried beside the simulated: from, to, how many [cost]
PATHS_TIMES: Final = 2.0  # of what named paths move ranges by, that another form may [convention]
REPLY_RATIO: Final = 2.0  # of the longest reply time to the shortest, to tell what goes with it:
# four times the variance [convention]
ROUNDING_VARIANCE: Final = 1 / 12  # of whole symbols [derived]
SPARE_LINKS: Final = 8  # at least, beyond what is fitted [convention]

# --- Walls that nobody listed (select/unlisted) ---------------------------------------------------
MOST_OBJECTS: Final = 0.5  # of the rows behind something, behind what waves may go around, too:
# most of them, for that to be said beside what goes through [convention]
WALLS_M: Final = 1.0  # of excess, that walls make at most: 0.8 m of concrete [derived]

# --- Effects on levels beside geometry (select/second_level) -------------------------------------
LEVEL_FOLDS: Final = 5  # of links, each predicted by the others [convention]
LEVEL_HARMONICS: Final = 4  # of a gain over headings, as of a pattern's delay [source: library]
LEVEL_RIDGE: Final = 1e-3  # of a column's square, that keeps alike columns apart [convention]
LEVEL_SHARE: Final = 0.02  # of what levels miss by, that a second cause takes off [convention]
GOES_WITH_ERRORS: Final = 4.0  # standard errors of a slope, over links: levels surely go with it
# [convention]
LEVEL_PRINTED_DB: Final = 0.1  # to which levels are printed; from paths they are no finer
CURVE_NEIGHBOURS: Final = 2  # rows at nearly the same level: more blur a step [convention]
CURVE_ROWS: Final = 0.9  # those that a curve misses least: others lie beside its steps [convention]
LEVEL_LEFT: Final = 0.15  # of the squares of levels, that forms of names may leave [convention]

# --- A curve without a name (select/unnamed) ------------------------------------------------------
SMALLEST_BEND_M: Final = 0.001  # of its shifts and scatter, less of which is not said [convention]
HARDLY_BENT: Final = 0.2  # of its mean, less of which a curve is called a constant [convention]
OWN_GRID_PLACES: Final = 12  # of different ranges of a device, that lie on coarser steps than all
# ranges do: by chance one device in two thousand [derived]
STRUCK_LIST: Final = 20  # links that are held to be struck, listed by name [convention]
MIXED_TIMES: Final = range(
    2, 11
)  # of a step, that most ranges may be rounded to: decimals, halves,
# thirds [convention]
MIXED_P: Final = 1e-4  # of points that are used alike, for all of these at once 1e-3 [derived]
USED_POINTS: Final = 0.7  # of as many points of a grid as simulated ranges have, fewer of which are
# some of its points alone: by chance a few in a hundred are missing [convention]

# --- What names leave at one device (select/one_device) -------------------------------------------
DEVICE_LEADS: Final = 2.0  # times what is off elsewhere: a form is off everywhere [four tables]
LEADING: Final = 3  # findings, the most telling ones, that name a device where all are of it [one
# may be of it by chance]

# --- What is said and shown (report) --------------------------------------------------------------
MOST_PUBLISHED_M: Final = 0.25  # from weak to strong, of a DW1000 at 64 MHz: -0.11 to 0.08 m, a
# third more for other makes [source: APS011, table 2; convention]
RANK_BINS: Final = 12  # of the picture of ranks [convention]
IDLE_SHARE: Final = 0.1  # of a strike's size, that it must move links by to act at all [convention]
SHARES_TOLD: Final = 9  # of struck links over the interval that working links leave, of which the
# mean likelihood of sealed ones is taken: chance has few or many of them there [cost]

# --- Links far off all others (far_links) ---------------------------------------------------------
FAR_STD: Final = 5.0  # of the other links' offsets, from which on a link is far off [convention]
FAR_M: Final = 0.1  # and at least so far [convention]
FAR_SHARE: Final = 0.45  # of the links: of half of them none are the exceptions [convention]
FAR_LIST: Final = 5  # that are listed [convention]
LONG_SHARE: Final = 0.8  # of them read long: nothing in a way makes a range shorter [physics]
ONE_STEP: Final = 1.01  # of a rounding, which a row off its link jumps by at least [rounding]
