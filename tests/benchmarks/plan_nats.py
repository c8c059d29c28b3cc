"""Expected against reached nats of plans, without the two diagnoses around each (they take long).

    python tests/benchmarks/plan_nats.py [first case] [cases]

The cases of plan_cases.py; the explanations in question are those of the case's kind, at values
that predict the same where nothing varies. The planned rows are recorded by the generator.
"""

from __future__ import annotations

import sys

import numpy as np
import pandas as pd
from plan_cases import KINDS, SETTINGS, cases, known, measured, nats

from bench.discrepancy.report.evidence import Evidence
from bench.physics.base import Base
from bench.physics.simulator import Simulator
from bench.planning.plan import answer
from bench.planning.questions import Question
from bench.plugins import load

# What each says where it is all the same: 0.11 m, as the generator has it.
VALUES = {
    "antenna-delay": {"delay_ns": 0.73},
    "clock-offset": {"offset_ppm": 0.73},
    "temperature-drift": {"slope_mm_per_c": 8.0},
    "range-scale": {"scale": 0.01},
    "power-bias": {"scale": 1.4, "shift_db": 18.0},
    "material-delay": {},
    "antenna-pattern": {"delay_m": 0.11, "phase_deg": 20.0},
}
NAMES = ("error_m", "rx_power_dbm")


def main(first: int = 0, count: int = 17) -> None:
    """Print each case's nats, then the median of their ratio."""
    ratios, ahead = [], 0
    for case in cases()[first : first + count]:
        rng = np.random.default_rng([case.seed, 7, *map(ord, case.kind + case.truth)])
        old = known(case, rng)
        table, none = measured(old, case.truth, rng), measured(old, "none", rng, 0.0)
        rows = [t[list(NAMES)].to_numpy(float) for t in (table, none)]
        options = tuple(load("effects", n).from_values(VALUES[n]) for n in KINDS[case.kind][1])
        question = Question(case.kind, options, ())
        made = answer(question, Evidence(old, NAMES, *rows), Simulator(Base()), None, 0)
        if not made.planned():
            print(case.kind, case.truth, "no plan:", made.note, flush=True)
            continue
        new = made.geometry("plan 0")
        new = new.drop(columns=[c for c in new if c not in old and c not in SETTINGS])
        later, plain = measured(new, case.truth, rng), measured(new, "none", rng, 0.0)
        found = nats(made, case, later, plain)
        ratios.append(found["reached_nats"] / found["expected_nats"])
        ahead += found["reached_nats"] > np.log(19)
        plan = [f"{n} x {m.words}" for m, n in made.planned()]
        print(case.kind, case.truth, pd.Series(found).to_dict(), plan, flush=True)
    within = sum(0.5 <= one <= 2 for one in ratios)
    print(f"{len(ratios)} plans; truth ahead by 20 to 1 in {ahead}; reached / expected: median "
          f"{np.median(ratios):.2f}, within a factor of two in {within}")  # fmt: skip


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
