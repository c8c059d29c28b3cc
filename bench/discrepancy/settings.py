"""Every number that decides something in a diagnosis: its meaning, unit and where it comes from.

Each says after its meaning how it was set:
[derived] from the mathematics or the format; [source] from the literature named; [cost] a limit of
time or memory that changes what is found only through what is left undone; [convention] a customary
level. [blind] was set on blind cases of the ranges, seeds 0 and 1; [waves] on waveform cases, seed
1; [plan cases] in tests/benchmarks/plan_cases.py; [apartment] on the split of seed 0 of the
apartment: see docs/diagnose-history.md.
Those have no better reason than that, and other recordings may ask for others.
"""

from __future__ import annotations

from typing import Final

# --- What is compared (data/observables, data/covariates) ----------------------------------------
PROFILE_EDGES_NS: Final = (
    -4.0, -1.5, 1.5, 3.5, 6.5, 10.5, 15.5, 22.5, 32.5, 45.5, 62.5, 82.5, 105.5,
)  # fmt: skip  # delay bins after the first path, widening by 1.4 [waves]
RISE_HIGH: Final = 0.6  # share of the maximum [source] Marano et al. 2010
RISE_LOW: Final = 6.0  # multiples of the noise std [source] Marano et al. 2010
LEAD_LEVEL: Final = 5.0  # multiples of the noise std that are energy before the path [convention]
FARTHEST_SAMPLE: Final = 1e6  # a first path beyond is in no CIR [derived]
WINDOW_FULL_SHARE: Final = 0.98  # of the rows must fill the window that is compared [convention]
WINDOW_BEFORE: Final = (2, 24)  # samples before the path, least and most [cost]
WINDOW_AFTER: Final = (16, 110)  # samples after it; 110 reach the last bin of the profile [derived]
NOISE_BEFORE_NS: Final = -3.5  # earlier samples hold noise alone: the pulse is 2 ns wide [derived]
EARLY_FEWEST: Final = 4  # samples so early, to say how they scatter [convention]
LEAST_VARIATION: Final = 1e-7  # of a column, of its size: less is how it was written [derived]
MOST_CATEGORIES: Final = 24  # of one column; more is an identifier, not a covariate [cost]
RAREST_CATEGORY: Final = 0.02  # share of the rows below which a category is not searched [blind]

MEASURED_SCATTER: Final = 0.5  # of the variance of a column of the user's own that is from row to
# row of a link: from there on it is taken as measured, not known before [convention]
MEASURED_VALUES: Final = 0.5  # of the rows must have values of their own: settings are few

MOVING_SHARE: Final = 0.2  # of the rows, whose speed must be known [convention]
SLOWEST_M_PER_S: Final = 0.02  # where hardly a row is faster, nothing moves [convention]
FASTEST_M_PER_S: Final = 60.0  # faster than any vehicle on the ground [derived]

# --- Split by link (data/split) ------------------------------------------------------------------
FEWEST_LINKS: Final = 4  # one to confirm on, and more than one to resample [derived]
SHARED_BELOW: Final = 8  # links: fewer are searched and fitted in stretches of rows [convention]
STRETCH_ROWS: Final = 20  # length of these stretches [convention]
RARE_DEVICE: Final = 8  # links: a device with fewer has them in both working parts [blind]
DISCOVER_SHARE: Final = 0.4  # of the links [convention]
FIT_SHARE: Final = 0.35  # of the links; the rest confirms [convention]

# --- Scores and their intervals (compare) --------------------------------------------------------
BOOTSTRAP_DRAWS: Final = 500  # of a mean over links [cost]
GAIN_DRAWS: Final = 400  # of a gain [cost]
TWO_SIDED_95: Final = 1.960  # normal quantiles [derived]
ONE_SIDED_95: Final = 1.645
CENTRAL_95: Final = (2.5, 97.5)  # percentiles [derived]
CENTRAL_90: Final = (5.0, 95.0)
LARGE_ERROR_M: Final = 0.1  # beyond it range errors count by their logarithm: several times the
# scatter of a range in line of sight [source: DW1000 data sheet, 0.02 m]
LEAST_CRPS: Final = 1e-9  # keeps the logarithm of a score finite [derived]
LINEAR_BELOW: Final = 1.0  # nats: the interval of a smaller gain comes from differences [blind]
RESOLUTION: Final = {"m": 5e-4, "dB": 0.1, "counts": 1.0, "symbols": 4.0, "ns": 0.05, "1": 0.05}
# Added to every score, in its unit: so a constant both sides share cannot drive the gain, nor can
# the last tenth of a decibel of a curve that no library has quite right. [waves]
READ_ALIKE: Final = 0.99  # of the rows, whose levels agree so far: none is read [convention]
READ_FARTHEST: Final = 4.0  # times what is read, that these are off: weak ones scatter [convention]
RANGE_WEIGHT: Final = 1.0  # weight of an observable's score: correlated ones share theirs [waves]
LEVEL_WEIGHT: Final = 0.4  # of each level, the noise and the count
PROFILE_WEIGHT: Final = 0.15  # of each of the twelve bins of the power-delay profile
FEATURE_WEIGHT: Final = 0.25  # of each other feature of the CIR
KNOWN_SHARE: Final = 0.1  # of the rows, that must know an observable to compare it [convention]
PATHS_ONLY_RICHER: Final = 3  # times as many members where no waveform is simulated [blind]
STRIKING_RICHER: Final = 3  # times as many for what strikes links at random: few draws, few strikes
AUC_LEAVES: Final = 8  # of the trees that tell recorded from simulated rows [convention]
AUC_TREES, AUC_FOLDS = 40, 4
EASIER_AUC: Final = 0.15  # by which rows are surely told more easily, of few links [convention]
FEWEST_AUC_LINKS: Final = 5  # fewer, all on one side: p >= 1/16 by a sign test [derived]

QUANTILE_DRAWS: Final = 300  # of a median or 90th percentile [cost]
FARTHER_SHARE: Final = 0.25  # more range error after than before is worse, by chance or not: few
# sealed links prove nothing [convention]
NEARER_SHARE: Final = 0.9  # of the mean before: below it anyone reads "nearer" [convention]
LEAST_NOTICED_M: Final = 0.0023  # half a time stamp of the DW1000: less is no worse [data sheet]
NOTICED_SHARE: Final = 0.02  # less of it is worse for nobody, however sure [convention]
HIGH_QUANTILE: Final = 0.9  # of |recorded - simulated| [convention]

# --- Replicates: ranges of random numbers that no two uses share [derived] -----------------------
FIT_MEMBERS: Final = 4  # replicates 0.. for fits: common random numbers [cost]
RESIDUAL_MEMBERS: Final = 4  # for residuals that values per device are fitted to [cost]
INTERVAL_MEMBERS: Final = 8  # for intervals of parameters [cost]
CURVE_MEMBERS: Final = 8  # for the unnamed curve [cost]
SCORE_FIRST: Final = 100  # scores on held-out links
SCORE_MEMBERS: Final = 12
SEARCH_FIRST: Final = 1000  # searches: fresh in every round
SEARCH_MEMBERS: Final = 16
CONFIRM_FIRST: Final = 5000  # the confirm links
CONFIRM_MEMBERS: Final = 16
OFFSET_FIRST: Final = 7000  # offsets of links
OFFSET_MEMBERS: Final = 12
UNLIMITED_MEMBERS: Final = 1 << 16  # a simulator gives as many as are asked for

RARE_P: Final = 0.001  # family-wise, of single links beyond all scatter [convention]
RARE_BEYOND: Final = 2.0  # times the widest simulated link, that such a link must be off [blind]
FEW_VERSIONS: Final = 3  # simulated rows per recorded row: with fewer, scatter is borrowed
ROWS_P: Final = 0.01  # of single rows beyond all simulated ones, by exchange alone [convention]
RARE_FEWEST: Final = 2  # simulated versions, to know the scatter of links [derived]

# --- Where they differ (locate) ------------------------------------------------------------------
FAMILY_WISE: Final = 0.025  # error of the whole search: below 5 % in few tables, too [convention]
UNUSUAL_P: Final = 0.05  # what is no less likely than this needs no word about it [convention]
PERMUTATIONS: Final = 499  # p values down to 0.002 [cost]
NULL_TAIL: Final = 0.1  # of permuted maxima, whose exponential goes on beyond them [convention]
PERMUTED_AT_ONCE: Final = 100  # [cost]
MOST_FINDINGS: Final = 12  # that are listed [convention]
INTERVAL_COUNTS: Final = (4, 12)  # coarse for what is weak, fine for what changes sign [blind]
TAIL_SHARE: Final = 0.05  # of the rows, in either tail of a covariate [blind]
NOISE_APART_DB: Final = 1.0  # logged noise of both sides, from where on it is said [convention]
LEAST_ROW_SCATTER: Final = 1e-3  # of the mean variance within links, that a link has at least:
# whole numbers are often all one [convention]
CLIP_STD: Final = 8.0  # standardised values beyond are cut, so one wild row decides nothing [blind]
MOST_CLUSTERS: Final = 80  # more links are grouped at random: still exchangeable [cost]
PART_SHARE: Final = 0.3  # of the rows, in which a shift may be seen better than in all [convention]
LARGER_HERE: Final = 1.5  # times what is found over all rows: then some rows are told [convention]
SPREAD_TOLD: Final = 0.6  # a spread is told after a mean unless it is this much louder [convention]

# --- Fitting one effect (fit/search) -------------------------------------------------------------
LINE_STEPS: Final = (
    1.0,
    0.5,
    0.25,
    0.12,
    0.05,
    0.02,
    0.005,
)  # shares of the way from null to bound
FINE_LINE_STEPS: Final = (0.0025, 0.001, 0.0004)  # besides, where no waveform is simulated [blind]
RATIO_STEPS: Final = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.3)  # where the way is in decades [waves]
DECIBEL_STEPS: Final = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1)  # in decibels [waves]
ONSET_SHARES: Final = (0.2, 0.4, 0.6, 0.8)  # of the way from a point that does nothing to one that
# does too much [convention]
SCATTERED_POINTS: Final = 128  # where no amplitude leads from nothing, of paths alone [cost]
SCATTERED_WAVEFORMS: Final = 16  # and of waveforms [cost]
ELSEWHERE_POINTS: Final = 8  # with the other parameters elsewhere [cost]
DELAY_POINTS: Final = 16  # of those where a delay is among them: echoes are short [waves]
SHORTEST_ECHO_NS: Final = 1.5  # of the delays tried: half a pulse of 500 MHz [derived]
ECHO_WEAKER_DB: Final = 4.0  # a second strength at which delays are tried [cost]
ELSEWHERE_SHARES: Final = (None, 0.05, 0.2, 0.5)  # amplitudes there: as found, or of the bound
ELSEWHERE_LEVELS: Final = (None, 0.85, 0.7, 0.5)  # the same in decibels [waves]
LOUD_DB: Final = 30.0  # a level with this much room above "nothing" is searched in decibels [waves]
DECADES: Final = 1e3  # bounds this far apart, both positive, are searched by ratio [convention]
EVALUATIONS: Final = 60  # of one descent [cost]
EVALUATIONS_PER_PARAMETER: Final = 15  # at least, with waveforms [waves]
MORE_DESCENTS: Final = 2  # at most, each from where the last one ended [waves]
STALLED: Final = 0.01  # of the gain, or nats: below it another descent is not worth it [waves]
SIMPLEX_DONE: Final = (0.02, 1e-4)  # first steps, nats: where Nelder-Mead stops [cost]
IDLE_NATS: Final = 1e-9  # a parameter that changes less does nothing [derived]
NOTHING_NATS: Final = -1e6  # the gain of values that leave nothing to compare [derived]
FIRST_STEP_DB: Final = 3.0  # first steps of a descent: levels [cost]
FIRST_STEP_LOG: Final = 0.5  # logarithms: a factor of 1.6
FIRST_STEP_OF_WAY: Final = 3.0  # part of the way from null
FIRST_STEP_AT_NULL: Final = 0.02  # of the bounds
FIRST_STEP_OTHER: Final = 0.1  # of the bounds, for a parameter without a null

# --- Values per device and level (fit/clocks, headings, per_device) ------------------------------
HUBER: Final = 1.5  # scales beyond which a residual weighs less [convention]
MAD_TO_STD: Final = 1.4826  # of a normal distribution [derived]
ROBUST_PASSES: Final = 6  # [cost]
OFFSET_PRIOR_PPM: Final = 20.0  # [source] IEEE 802.15.4: crystals within 20 ppm
WANDER_SETTLES_S: Final = (600.0, 3600.0, 21600.0, 129600.0)
CLOCK_KNOTS: Final = 32  # at most, per device [cost]
CLOCK_RIDGES: Final = 1e-14, 1e-11, 1e-8  # [derived] of the largest weight, rounded at 1e-16
CLOCK_SHORTEST_S: Final = 10.0  # between knots: crystals do not wander faster [convention]
CLOCK_FOLDS: Final = 4  # [convention]
CLOCK_LINK_FOLDS: Final = 5  # [convention]
CLOCK_STRETCHES: Final = 8  # per pair of devices and link, left out in turn [convention]
RICHER_CLOCK: Final = 0.9  # of the simpler clock's error on left-out rows, that it must reach
DELAY_PRIOR_NS: Final = 3.0  # [source] APS014: uncalibrated antenna delays differ by nanoseconds
LONGEST_DELAY_NS: Final = 20.0  # metres are not an antenna's delay [source: APS014]
UNCOMPRESSED_DBM: Final = -80.5  # logged levels below follow the true one [source: APS011, fig. 5]
LEVEL_KNOTS_DBM: Final = (-97.0, -50.0, 3.0)  # from, to, step: a curve over the receive level
MOST_LEVEL_BIAS_M: Final = 0.3  # [source] APS011: -11 to 8 cm at 64 MHz PRF, -28 to 15 cm at others
STEEPEST_M_PER_KNOT: Final = 0.12  # three times the steepest part of the published curve [source]
LEVEL_KNOWN_SHARE: Final = 0.5  # of the rows, that must have logged a level [convention]
LEVEL_WEAK_ROWS: Final = 10  # that must be uncompressed, to know the budget [convention]
BUDGET_SPREADS_DB: Final = (0.5, 1.0, 15.0)  # how far a budget is trusted: least, tried, most
BUDGET_AT_1M_DBM: Final = (-80.0, -30.0)  # [derived] the bounds of the effect
LEVEL_BEND: Final = 0.1  # weight of second differences of the curve [blind]
HALF_TURN_DEG: Final = 180.0  # [derived]
HEADING_STEP_DEG: Final = 15.0  # between knots of a pattern [convention]
HEADING_BENDS: Final = (0.03, 0.1, 0.3, 1.0)  # weights of its bends, tried on links left out
HEADING_FOLDS: Final = 4  # [convention]
HEADING_SECTOR_DEG: Final = 30.0  # twelfths of a circle
HEADING_SECTORS: Final = 6  # of 12: headings that fill fewer are no circle [convention]
MOST_PATTERN_GAIN_DB: Final = 15.0  # of a pattern: that of the library's [convention]
PATTERN_GAIN_SHARE: Final = 0.05  # of the error of levels, that a gain takes off [convention]
LEAST_HALF: Final = 1e-6  # of an interval, in m or ns: a grid is known to the last digit [derived]
MOST_PATTERN_BIAS_M: Final = 0.3  # [source] Ledergerber 2018: 10-20 cm over direction; more of it
# is no antenna
UNNAMED_KNOTS: Final = 9  # of the curve of what has no name [convention]
UNNAMED_LINKS: Final = 3  # links to a knot of it, or it follows single links [convention]
UNNAMED_ROWS: Final = 20  # below which there is no curve [convention]
UNNAMED_RIDGE: Final = 1e-3  # keeps empty knots at zero [derived]
UNNAMED_WIDEST_M: Final = 100.0  # [derived] the bound of the effect

# --- Intervals of parameters (fit/sandwich, fit/bootstrap) ---------------------------------------
INTERVAL_LEVEL: Final = 0.90  # [convention]
VALUE_DRAWS: Final = 60  # of links, for values per device and level [cost]
KNOT_ROWS: Final = 10  # within a knot's reach, below which a level is not determined [convention]
FLAT_CURVATURE: Final = 1e-4  # of the largest: the score hardly changes that way [convention]
LEAST_CURVATURE: Final = 1e-12  # keeps what is flat everywhere finite [derived]
FLAT_LOADING: Final = 0.05  # share in flat directions: a parameter is not determined [convention]
UNDETERMINED: Final = 0.9  # of the bounds: a wider interval says nothing [convention]
STEP_OF_WAY: Final = 0.1  # finite differences: of the way from null [derived]
STEP_OF_BOUNDS: Final = (0.002, 0.25)  # and at least, at most, of the bounds
STEP_DB: Final = 1.0  # of a level
AT_BOUND: Final = 1e-3  # of the bounds: nearer is at the bound [derived]
MOVED_M: Final = 1e-3  # that an effect does more, to see which of its values change [derived]

# --- What could be removed at all (fit/reference_regression) -------------------------------------
REGRESSION_ROWS: Final = 4000  # at most [cost]
REGRESSION_FOLDS: Final = 4  # [convention]
REGRESSION_BETTER: Final = 0.98  # of the error so far, that a richer model must reach [convention]
REGRESSION_KNOTS: Final = (6, 24)  # smooth over all covariates; fine over each alone [blind]
REGRESSION_TREES: Final = 60  # of 12 leaves with 15 rows each [convention]
REGRESSION_LEAVES: Final = (12, 15)
REGRESSION_RATE: Final = 0.15
LEAST_SCALE: Final = 0.05  # of the spread: an ensemble is never made sharper [convention]

# --- Candidates (select/candidates) --------------------------------------------------------------
REFINED: Final = 6  # best effects of the line search that are fitted in full [cost]
FAR_BEHIND: Final = 0.12  # of the best gain: what screens below does not catch up [blind]
WORTH_FITTING_NATS: Final = 0.002  # [cost]
CURVE_FREEDOM_NATS: Final = 0.02  # what a free curve gains by its freedom is less [blind]
WORTH_PURSUING: Final = 0.5  # of the best gain, with waveforms [waves]
SAME_LINKS: Final = 0.5  # correlation over links of two gains, from which on they are of one thing:
# a constant and pure scatter may gain as much, but not on the same rows [convention]
EQUIVALENT_SHARE: Final = 0.5  # of the best gain, from which on another may do as well [blind]

# --- Selection (select/stepwise, backfitting, conclude) ------------------------------------------
MOST_ROUNDS: Final = 9  # [cost]
MARGIN_NATS: Final = 0.01  # that an effect must gain: 1 % of one score [blind]
WAVE_MARGIN_NATS: Final = 0.03  # the same with waveforms: some twenty scores, not one [waves]
WAVE_MARGIN_SHARE: Final = 0.02  # of the gain reached so far, with waveforms [waves]
WAVE_LEFT_SHARE: Final = 0.25  # of what could still be removed, with waveforms [waves]
SCATTER_MARGIN_NATS: Final = 0.05  # of independent scatter: misfitted effects leave less [blind]
SURE_P: Final = 0.005  # a mismatch of smaller p needs no second witness [blind]
REMOVED_SHARE: Final = 0.6  # of what a regression removes, that named effects must remove [blind]
TIED_CONTENDERS: Final = 3  # that are tried with all others fitted again [cost]
TOUCHED_NATS: Final = 0.01  # of gain in an observable: an effect acts on it [waves]
SIMPLER_SHARE: Final = (
    0.5  # of a more flexible effect's gain, for a simpler one to go first [waves]
)
BACKFIT_PASSES: Final = 2  # [cost]
BACKFIT_EVALUATIONS: Final = 30  # per effect and pass [cost]
BACKFIT_STALLED_NATS: Final = 0.01  # on the fitted rows: another pass is not worth it [cost]
CONTROL_ROWS: Final = 10  # that a negative control needs [convention]
CONTROL_QUIET: Final = 0.25  # of what is left elsewhere may be left where the effect vanishes
CONTROL_REACH: Final = 2.0  # times the half 95 % interval from zero, to refuse a name: 10 000 to 1

# --- A name reproduces what it acts on (select/adequacy) ------------------------------------------
ADEQUACY_FIRST: Final = 9000  # replicates that nothing else looks at [derived]
ADEQUACY_MEMBERS: Final = 10  # [cost]
ADEQUACY_ALPHA: Final = 0.05  # over all places and observables of one name [convention]
ADEQUACY_LEFT: Final = (0.7, 1.0)  # of the response in an observable, over all places, that may
# be left in its mean, in its spread: other forms leave up to 0.6, wrong ones more [waves]
ADEQUACY_MOST: Final = 0.5  # of the response, in which too much is left, refuses [convention]
ADEQUACY_CUT: Final = 0.5  # of what was there, that an effect has done its part by [convention]
ADEQUACY_BROUGHT: Final = 0.6  # of what was there, that may be left of the cell it reduces most,
# among those it was brought in for [convention]
ADEQUACY_OFF_COVARIATE: Final = 0.4  # the same at a place where more is left than the effect does
FORM_REACHED: Final = 0.9  # of the removable fall of the scores; with so much removed, what is left
# needs no cause of its own: another form of the named ones would [waves]
FORM_SHARE: Final = 0.3  # of an effect's response, that another form of it may differ by [waves]
ADEQUACY_TOUCHED: Final = 0.3  # of its largest response: an effect acts on an observable
NEARLY_SHARE: Final = 0.8  # of the best gain: another form may make up for the rest [waves]
ESSENTIAL_SHARE: Final = 0.02  # of its bounds: so near the null it does nothing [convention]
ADEQUACY_RIVALS: Final = 3  # contenders that are tried in the place of a refuted one [cost]
ADEQUACY_INTERVALS: Final = 4  # of a covariate [convention]
ADEQUACY_LEAST: Final = 0.02  # squared scatter that rows have at least, of the typical [convention]
ADEQUACY_WIDEST: Final = 30.0  # times the scatter, beyond which values are cut [convention]

# --- An effect over levels at a fixed distance (select/fixed_distance) ----------------------------
FADING_M: Final = 0.06  # a wavelength at 5 GHz: within it the level of a path stays [derived]
FOLLOWING_PLACES: Final = 40  # that must be known [convention]
FOLLOWING_KNOTS: Final = 6  # of what is usual at a distance [convention]
FOLLOWING_WIDEST: Final = 3.0  # standard deviations beyond which a row is cut [convention]
FOLLOWING_DRAWS: Final = 200  # of links [cost]
FOLLOWING_LEAST: Final = 0.5  # of the response, that the interval must reach [convention]

FORMS_OF_MARK: Final = 2.0  # times what a rounding does: rounded by chance, its error is of twice
# the variance [derived]
SCATTER_OF_LINKS: Final = 0.5  # of the variance that is missing within links, that may be
# missing between them: by chance; of what scatter makes, that rows of a link show [convention]
SCATTER_SHAPE_P: Final = 1e-3  # of a distribution, to be another than scatter's [convention]
STEADY_P: Final = 0.05  # above which rows of a link scatter as simulated ones do [convention]

# --- Links struck at random (select/link_mixture) ------------------------------------------------
WIDEST_OFFSET_M: Final = 5.0  # unexplained offsets are uniform within: the longest mean detour
CALM_EXTRA_M: Final = (0.0, 0.003, 0.3, 9)  # scatter beyond the simulator's: 0, from, to, how many
WILD_SHARES: Final = (0.002, 0.01, 0.03, 0.08, 0.2)  # of links that are anything [cost]
BEHIND_M: Final = (0.0, 0.01, 0.02, 0.03, 0.045, 0.065, 0.1, 0.15)  # what calm links that may be
# struck have in common: where sight is blocked a wall delays what comes through it [cost]
STRUCK_SHARES: Final = (
    0.02, 0.04, 0.06, 0.09, 0.13, 0.18, 0.25, 0.33, 0.42, 0.5, 0.6, 0.7, 0.8, 0.9,
)  # fmt: skip  # [cost]
STRIKE_SIZES: Final = 11  # tried, from a share of the bound on [cost]
SMALLEST_STRIKE: Final = 0.02  # of the bound
ALL_SPARED: Final = 0.05  # that no sealed link is struck: scores say little then [convention]
SHORTEST_DETOUR_M: Final = 0.3  # half a pulse of 500 MHz: a shorter one merges [derived]
STRIKE_NATS: Final = 6.0  # for two parameters: p = 0.0025 by chi-squared [derived]
LEAD_NATS: Final = 3.0  # by which the likeliest must lead: 20 to 1 [convention]
MOST_ALTERNATIVES: Final = 2  # with waveforms, causes that may stand for each other: "X or Y".
# What three do as well is some smooth shift, and mostly of another cause [waves, seed 71537]
ROWS_BEYOND: Final = 3  # so many rows beyond all simulated ones are no chance: even of a Cauchy
# distribution, twice its widest of two versions is passed by a quarter of a row [derived]
STRUCK_LEVEL_LINKS: Final = 2  # that must be struck, to ask for their level [derived]
OFFSET_NATS: Final = 5.0  # for offsets per link: p = 0.0008 by chi-squared [derived]
ROWS_STRUCK_SHARE: Final = 0.25  # of the share of struck links: of rows off their link, allowed
ROW_OFF_STD: Final = 5.0  # standard deviations within links, to be off it [convention]
STRAY_SHARE: Final = 0.2  # of the outliers may be left unexplained [blind]
PROFILE_90_NATS: Final = 1.353  # half the 90 % point of chi-squared, 1 degree [derived]
BEND_M: Final = 0.05  # offsets beyond are smoothed by their logarithm [convention]
LEAST_SCATTER_M: Final = 1e-4  # of links, a tenth of a millimetre: rounding [derived]

# --- Pictures ---------------------------------------------------------------------------------
FIGURE_BINS: Final = 6  # of a covariate, to say over which the residual varies most [convention]
FIGURE_MORE: Final = 0.1  # of the variance, that it must explain beyond the distance [convention]
FEW_POINTS: Final = 500  # of which each is drawn larger [convention]
FIGURE_CENTRE: Final = (0.01, 0.99)  # quantiles that a residual plot shows [convention]

# --- Words (report) ---------------------------------------------------------------------------
SHOWN_VALUES: Final = 4  # of a long list of values, that the first screen shows [convention]

# --- A level curve is a constant (select/disguise) ------------------------------------------------
LEVEL_CURVE_SHARE: Final = 0.2  # of its mean, within which a curve is level [plan cases]
WIDE_LEVELS_DB: Final = 8.0  # that rows must spread over to say so: half the S-curve [plan cases]

# --- What is kept beside the report (report/evidence) --------------------------------------------
EVIDENCE_ROWS: Final = 400  # of the working links [cost]
EVIDENCE_MEMBERS: Final = 8  # whose mean stands for the simulator [cost]
STACKED_ROWS: Final = 2048  # of several replicates that are simulated as one batch, at most:
# enough to pay for the calls, few enough to stay near the processor (changes nothing but time)

# --- Memory (changes nothing but time) -----------------------------------------------------------
KEPT_REPLICATES: Final = 96  # detected replicates that are remembered, up to 2 MB each
KEPT_PATH_REPLICATES: Final = 256  # of those from paths alone, which are small
KEPT_STEPS: Final = 96  # batches after a step of the chain, up to 5 MB each
KEPT_NOISE: Final = 128  # blocks of noise and tails that are drawn again, up to 2 MB each
KEPT_ROWS: Final = 16  # tables of rows that are told apart without looking at their values
KEPT_TABLES: Final = 24  # matched tables with CIRs
KEPT_SHAPES: Final = 96  # figures of the CIRs of a matched table with effects, 0.4 MB each
KEPT_MATCHES: Final = 8  # views with the rows that match them
