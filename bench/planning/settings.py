"""Every number that decides something in a plan: its meaning, unit and where it comes from.

[derived] from mathematics; [cost] a limit of time; [convention] a customary level; [plan cases] so
that diagnoses of planned rows were settled in tests/benchmarks/plan_cases.py.
"""

from __future__ import annotations

from typing import Final

# --- How sure (choose) ---------------------------------------------------------------------------
SURE: Final = 0.95  # probability that the right explanation has at least this probability
ASSURED_NATS: Final = 10.5  # a log ratio of mean D scatters by sqrt(2 D): D - 1.645 sqrt(2 D) is
# ln(0.95 / 0.05) here [derived]
SURE_NATS: Final = 30.0  # expected nats for a pair until it is settled: about three times that,
# because a diagnosis holds links out and judges by resampled scores [plan cases]
LINK_NATS: Final = 2.5  # that one link counts for at most: a diagnosis resamples links, and needs
# a dozen that tell [plan cases]
NEAR_SHARE: Final = (
    0.3  # of the best gain: what was tried and gained more stays in view [plan cases]
)
BEHIND_NATS: Final = 12.0  # behind the likeliest, from which on it does not [convention]
MOST_ALTERNATIVES: Final = 5  # [cost]
STEP_LINKS: Final = 2  # that are added at once [cost]
MOST_LINKS: Final = 80  # that are counted out before "cannot be told" is said [convention]
LEAST_NATS: Final = 0.01  # per link; a measurement that brings less is not listed [convention]
CHANCE_STD: Final = (
    3.0  # of the nats of repeats, that it must bring more: nats of random simulations
)
# are estimates [convention]
ROWS_PER_LINK: Final = (3, 20)  # of a planned link: as recorded, within these [convention]

# --- What the recordings leave open (alternatives) -----------------------------------------------
WALKERS: Final = 24  # parameter sets moved together (Goodman and Weare 2010) [cost]
SWEEPS: Final = 40  # moves of each walker [cost]
KEPT_EVERY: Final = 6  # half sweeps, after which walkers are elsewhere [convention]
KEPT_DRAWS: Final = 48  # parameter sets of an explanation, at most [cost]
WAVE_SWEEPS: Final = 10  # the same where waveforms are simulated [cost]
WAVE_ROWS: Final = 150  # recorded rows that are simulated again with waveforms [cost]
STRETCH: Final = 2.0  # of a move [source: Foreman-Mackey et al. 2013]
START_SHARE: Final = 0.03  # of the bounds, by which walkers start apart [convention]
FIT_MEMBERS: Final = 4  # simulated versions of the recorded rows for a likelihood [cost]
SCATTER_MEMBERS: Final = 24  # for the scatter that an explanation simulates [cost]
LEAST_SCATTER: Final = {"m": 1e-3, "dB": 0.1}  # within a link: rounding of the values [derived]
TREND_REACH: Final = 5.0  # spans beyond the recorded values to which a trend is drawn [convention]
TREND_NATS: Final = 6.0  # behind the best trend: likelier ones stay in question [convention]
SEED_FIRST: Final = 20_000  # of replicates: apart from those of a diagnosis

# --- What can be measured (measurements) ---------------------------------------------------------
REPEATS: Final = 8  # of what was recorded, each with random numbers of its own [cost]
DISTANCES_M: Final = (1.0, 2.0, 4.0, 7.0, 12.0, 20.0, 35.0)
FARTHER: Final = 2.0  # than recorded: a hall has an end
FARTHEST_LEAST_M: Final = 8.0  # that is always offered: most rooms have a diagonal of it
REPLIES: Final = (0.5, 2.0, 4.0, 8.0)  # times the recorded reply time
REPLY_S: Final = (1e-4, 2e-2)  # shortest and longest a chip can keep
LESS_POWER_DB: Final = (6.0, 12.0)  # below the recorded transmit power
FULL_TURN_DEG: Final = 360.0
TEMPERATURES_C: Final = (5.0, 40.0)  # a fridge, a warm air blower
SWITCHED_ON_S: Final = (0.0, 300.0, 3600.0)  # since switching on
SPEEDS_M_PER_S: Final = (0.0, 1.5, -1.5)  # standing, walking away, walking near
HEIGHTS_M: Final = (0.5, 1.0, 2.0)
