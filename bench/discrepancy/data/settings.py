"""Numbers by which input is refused, with where they come from (see bench.discrepancy.settings)."""

from __future__ import annotations

from typing import Final

LONGEST_MEDIAN_RANGE_M: Final = 500.0  # [source] UWB at -41.3 dBm/MHz is not heard so far
SHORTEST_MEDIAN_RANGE_M: Final = 0.02  # [derived] shorter than an antenna: kilometres were meant
UNIT_MISTAKE: Final = 300.0  # [derived] measured / true: mistakes of units are by 1000
SIGN_TURNED: Final = -0.5  # [convention] correlation of negative ranges with true ones
SAME_PERIOD: Final = 0.05  # of a sample period, up to which two tables have the same [convention]
SAMPLE_PERIOD_NS: Final = (0.2, 5.0)  # [source] receivers sample at 0.2 to 5 GS/s
LOUDEST_DBM: Final = 10.0  # [source] UWB is sent at -14 dBm: what is received is far below
WILD: Final = 1000.0  # [derived] times the limits of a median: a row that no instrument reads
LARGEST_FIGURE: Final = 1e30  # [derived] of any instrument, in any unit: squares stay finite
SMALLEST_SPREAD: Final = 1e-30  # [derived] that of no instrument in any unit: squares stay above 0
LONGEST_REPLY_S: Final = 0.5  # [derived] replies take 0.2 to 200 ms: ppm of more are 75 m each
LATEST_S: Final = 1e11  # [derived] a count from 1970 in seconds is 2e9, in milliseconds 2e12
TEMPERATURES_C: Final = (-100.0, 150.0)  # [source] silicon works from -55 to 125 degC
FAINTEST_DBM: Final = -200.0  # [derived] the noise of one hertz at room temperature is -174 dBm
DEEPEST_SAMPLE: Final = 0.1  # [convention] of the peak: smaller negative samples are arithmetic
FOOT_M: Final = 0.3048  # [source] international foot, exact
ONE_FACTOR: Final = 0.05  # [convention] scatter of a ratio up to which it is one factor
EXACT_M: Final = 1e-3  # [derived] no UWB range is so near the truth in half of the rows
PLACES_APART: Final = 1.5  # [convention] times the truth: no survey of antennas is so far off
READ_M: Final = 0.01  # [derived] what UWB ranges miss the truth by at least
QUARTILES: Final = (25, 50, 75)  # per cent [convention]

# --- Rows far off their own link (data/own_link) --------------------------------------------------
FEWEST_OF_LINK: Final = 3  # rows, to say which of them is off [derived]
FAR_SCATTERS: Final = 10.0  # standard deviations of rows about their link's median [convention]
FAR_OFF_LINK_M: Final = (
    0.5  # and so many metres at least: no clutter moves one row so far [convention]
)
FEWEST_FAR: Final = 3  # rows, to be worth a line [convention]
FAR_OFF_LINK_TIMES: Final = 3.0  # the share of simulated rows that are as far [convention]
SHOWN_FAR: Final = 5  # numbers of rows in the line [convention]

# --- Tables that are one, or of other units (data/checks) -----------------------------------------
SAME_RANGE_M: Final = 1e-4  # [derived] ranges that differ by less in every row are one measurement
FULL_TURN_DEG: Final = 360.0  # [derived]
TURNS: Final = 0.8  # of a turn, by which headings differ that go all around [convention]

# --- Noise that is logged as it was asked for (data/nominal_noise) --------------------------------
LOGS_ALIKE_DB: Final = 0.5  # by which logs of one noise differ at most [convention]
SAMPLES_APART_DB: Final = 2.0  # by which what samples hold differs at least [convention]
ROWS_THAT_TELL: Final = 2000  # of a table [cost]

# --- Ranges that never change, truths that are none (data/checks, data/truth) ---------------------
STUCK_ROWS: Final = 10  # of one range, to say that a receiver is stuck [convention]
MOST_NEGATIVE: Final = 0.05  # of the rows with a negative true range: more are no slips
# [convention]
STUCK_APART_M: Final = 2.0  # that true ranges differ by then: no rounding is so coarse [convention]

# --- Columns that cannot be used (unread) ---------------------------------------------------------
MOSTLY_NUMBERS: Final = 0.9  # of the cells of a text, to be numbers that were written so
# [convention]
SHOWN_CELL: Final = 30  # characters of a cell in a line about its column [convention]

# --- Gaps (gaps) ----------------------------------------------------------------------------------
GAP_KNOWN: Final = (
    0.5  # of the rows, whose temperature is known, to fill in the others [convention]
)
GAP_ERROR: Final = 0.5  # of its standard deviation, that a temperature may be off the mean of those
# before and after, to be told by time [convention]
