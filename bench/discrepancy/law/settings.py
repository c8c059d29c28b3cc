"""Every number that decides about laws without a name: unit, reason, and in brackets its origin.

Origins as in `bench.discrepancy.settings`.
"""

from __future__ import annotations

from typing import Final

LAW_NATS: Final = 3.0  # beyond what its complexity costs: 20 to 1 [convention]
LAW_TIED_NATS: Final = 3.0  # behind the best, within which a law is not excluded [convention]
LAW_INSTEAD_NATS: Final = 10.0  # beyond all named effects together: 20 000 to 1 [convention]
LAW_OF_SCATTER: Final = 0.5  # of what rows of links scatter by, less than which a law leaves that
# stands in for jitter: most of that it predicts [convention]
LAW_OWN_FORM: Final = 1e-6  # of its square that effects of its form leave: rounding [derived]
LAW_VALUE_NATS: Final = 1.0  # that a value of a named effect pays [source: Akaike 1974]
LAW_TAIL: Final = 4.0  # degrees of freedom of the Student t that residuals have [convention]
LAW_PASSES: Final = 10  # of reweighting [cost]
LAW_CLIP: Final = 4.0  # scales beyond which residuals are cut when laws are screened [convention]
LAW_REFINED: Final = 28  # best of the screening that are fitted in full [cost]
LAW_DRAWS: Final = 40  # of links, for the intervals of the law's constants [cost]
LAW_MEMBERS: Final = 8  # simulated versions whose mean a row is compared with [cost]
LAW_FEWEST_ROWS: Final = 24  # below which no law is looked for [convention]
LAW_DEVICE_ROWS: Final = 6  # of a device, to ask whether it stands elsewhere [convention]
LAW_MOST_COLUMNS: Final = 40  # that laws are over [cost]
LAW_MOST_FACTORS: Final = 72  # that a law is multiplied with [cost]
LAW_LONGEST_NAME: Final = 40  # characters of a device in an expression [cost]
LAW_KNOWN_SHARE: Final = 0.9  # of the rows, that must know a covariate [convention]
LAW_POWERS: Final = (-4, -3, -1.5, -0.5, 0.25, 0.5, 0.75, 1.5, 2, 2.5, 3, 4)  # exponents tried
LAW_POWER_BOUNDS: Final = (-5.0, 5.0)  # beyond, they are steps [convention]
LAW_SPREAD: Final = 1.5  # largest / smallest value, for a power or logarithm to show [convention]
LAW_STEPS: Final = 40  # places of a step that are screened, at equal shares of the rows [cost]
LAW_STEP_SHARE: Final = 0.04  # of the rows, least on either side of a step [convention]
LAW_SCALES: Final = 16  # time constants and saturation lengths that are screened [cost]
LAW_TAU: Final = (0.02, 2.0)  # time constants, of the span [convention]
LAW_SATURATION: Final = (0.1, 3.0)  # saturation lengths, of the smallest and largest [convention]
LAW_CYCLES: Final = (0.75, 200.0)  # of a period within the span of the rows: at most half as many
# as rows, which show no more (Nyquist), and no more than these [cost]
LAW_SWIFT_CYCLES: Final = 4000.0  # of a period that is sought in all rows alike [cost]
LAW_SWIFT_ROWS: Final = 2000  # of which it is sought, at most [cost]
LAW_AT_ONCE: Final = 512  # of these periods [cost]
LAW_CYCLE_STEP: Final = 0.25  # cycles between periods screened: half the resolution [derived]
LAW_ONE_PHASE: Final = 0.6  # resultant length of phases, from which on they are one [convention]
LAW_GRID_P: Final = 0.01  # that places of one phase are so by chance, of all periods asked of
# [convention]
LAW_NYQUIST: Final = 2.1  # spacings of the places, that a period is longer than [derived]
LAW_FEW_TURNS: Final = 3.0  # of a period within the span, below which phases are few [convention]
LAW_HALF_TURN: Final = {"deg": 180.0, "rad": 3.14159265}  # what spans less, as a tilt, does not
# go round [definition]
LAW_FACING: Final = 0.95  # resultant length of headings off bearings, from which on they are one
# [convention]
LAW_FEWEST_PLACES: Final = 8  # that differ, to show a period: of fewer any has one [derived]
LAW_HARMONICS: Final = (1, 2, 3, 4)  # of an angle [source: antenna patterns are smooth]
LAW_DESCENT: Final = 14  # evaluations of a place, power or period [cost]
LAW_RATIOS: Final = {
    0.3048: "feet taken for metres in the truth", 1 / 0.3048: "feet taken for metres",
    0.9144: "yards taken for metres in the truth", 1 / 0.9144: "yards taken for metres",
    0.5: "half the way taken for the whole", 2.0: "the way there and back taken for one way",
    0.1: "a decimal place lost", 10.0: "a decimal place too many",
}  # fmt: skip  # measured / true where units were confused [derived]
LAW_RATIO_DOUBT: Final = 0.05  # standard error of a free slope, of the unit's: above it, 10 % of
# all slopes would pass for one of them by coincidence [derived]
LAW_OWN_RATE: Final = 1e-4  # of the true range, that one device is off by: five times what its
# crystal may be [source: IEEE 802.15.4], and light is as fast for all
LAW_EVERY_RATE: Final = 0.05  # the same of all devices: the bound of `range-scale` [derived]
LAW_LATTICE: Final = (0.002, 1.0)  # m: steps of a rounding that is looked for [convention]
LAW_ON_LATTICE: Final = (0.02, 0.98)  # of a step, and of the rows, to be on a lattice [convention]
LAW_ACTS_M: Final = 1e-9  # of range, from which on a law acts on a row [derived]
LAW_ALIKE: Final = 1e-9  # of their size: parts of a law that say the same [derived]
LAW_ONE_STEP: Final = 1.5  # times the smallest gap: wider ones are two steps [derived]
LAW_PLAN_PLACES: Final = 4  # of an end, to say that their plan is turned or stretched [derived]
LAW_FLAT_PLAN: Final = 0.1  # width of places over length: below, they are on a line [convention]
LAW_FAR: Final = 60.0  # percentile of measured ranges, above which a ceiling is sought [cost]
LAW_FLOOR_M: Final = 0.006  # that true ranges are off distances of places, in whole cm [derived]
LAW_SAME_PLACE_M: Final = 0.05  # positions of a device that stands still; and as true ranges say
SHOWN_RIVALS: Final = 5  # laws that are not excluded, shown to people [convention]
UNDETERMINED_M: Final = 50.0  # of a shift's interval, that says nothing of where [convention]
LAW_DIGITS: Final = range(3, 10)  # of a constant, until ends of its interval differ [convention]
MIRRORED: Final = -100.0  # %, by which a stretched axis ends at one place [derived]
