"""Counts over all unlisted laws and faults of the set-up, and how often noise has a law.

python -m pytest tests/benchmarks/test_unlisted_laws.py -s

`LAW_EMPTY` says in how many noises a law is looked for. `LAW_PUBLIC` names more cases, or `all`, to
go through `bench.diagnose`: each takes minutes, and is printed.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

HERE = Path(__file__).parents[1] / "bench" / "discrepancy" / "law"
sys.path.insert(0, str(HERE))

from test_laws import answer, errors_of, is_right  # noqa: E402
from unlisted import CASES, FAULTS, LAWS, tables  # noqa: E402

import bench  # noqa: E402

SURE = "anchors 0 and 1 swapped"
PUBLIC = os.environ.get("LAW_PUBLIC", SURE).split(",")
EMPTY = int(os.environ.get("LAW_EMPTY", "20"))


def test_forms_constants_and_faults() -> None:
    """Print and hold the counts: forms >= 75 %, constants within 10 %, faults >= 80 %."""
    right, near, named, wrong = [], [], [], []
    for number, case in enumerate(CASES):
        law, fault = answer(case, number)
        if is_right(case, law):
            right.append(case.name)
            near += [case.name] * (max(errors_of(case, law), default=0.0) < 0.1)
        else:
            wrong.append((case.name, law and law.words))
        if case.fault and fault and fault.kind == case.fault:
            named.append(case.name)
    print(f"\nright form: {len(right)} of {len(CASES)}; constants within 10 %: {len(near)}")
    print(f"faults of the set-up named: {len(named)} of {len(FAULTS)}; not right: {wrong}")
    assert len(CASES) >= 40
    assert len(right) >= 0.75 * len(CASES)
    assert len(near) >= 0.75 * len(CASES)
    assert len(named) >= 0.8 * len(FAULTS)
    assert len(LAWS) + len(FAULTS) == len(CASES)


def test_noise_has_no_law() -> None:
    """Print and hold how often a law is said where nothing is hidden: at most 5 %."""
    said = [law.words for law, _ in (answer(None, 500 + i) for i in range(EMPTY)) if law]
    print(f"\na law where nothing is hidden: {len(said)} of {EMPTY} {said}")
    assert len(said) <= 0.05 * EMPTY


def test_by_the_public_command() -> None:
    """Print what `bench.diagnose` says with its default options; the swapped anchors are named."""
    right, asked = [], [SURE, *PUBLIC]
    for number, case in enumerate(CASES):
        if case.name not in asked and PUBLIC != ["all"]:
            continue
        recorded, simulated = tables(case, number)
        found = bench.diagnose(recorded, simulated=simulated)
        said = found.setup_fault or found.law
        right += [case.name] * is_right(case, found.law)
        print(f"{case.name}: {found.selection.names or 'unknown'} | {said}")
    print(f"by bench.diagnose, right form: {right}")
    assert SURE in right
