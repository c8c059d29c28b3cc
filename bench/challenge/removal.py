"""How much of the mismatch a diagnosis removes on sealed links, beside what the truth removes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.challenge.cases import Case
from bench.challenge.truths import RANDOM
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.skill import weight_of
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.data.observables import observe, window_of
from bench.discrepancy.diagnosis import Diagnosis
from bench.discrepancy.settings import RESOLUTION

Floats = NDArray[np.float64]
MEMBERS = 16
WORTH = 1.1  # times the truth's score: observables that are no worse before take no part


def removed(case: Case, found: Diagnosis) -> tuple[float, float]:
    """Return how far the mismatch of sealed rows falls: by the diagnosis, and by the truth.

    Mismatch: the excess of the CRPS over the truth's, per observable in units of the truth's,
    weighted as the diagnosis weighs observables, of those that what is hidden moved. Both 0 where
    the concealment left no truth.
    """
    before, after = found.confirmed.before, found.confirmed.after
    true = None if case.drawn.concealed == "aggregate" else _true(case, found)
    if true is None:
        return 0.0, 0.0
    totals, counted = [0.0, 0.0], moved(case) & {*true.names} & {*after.names}
    for name in (one for one in before.names if one in counted):
        was, now, best = (_score(one, name) for one in (before, after, true))
        if np.isfinite([was, now, best]).all() and was > WORTH * best > 0:
            totals[0] += weight_of(name) * (was - now) / best
            totals[1] += weight_of(name) * (was - best) / best
    return totals[0], totals[1]


def moved(case: Case) -> set[str]:
    """Return the observables that what is hidden moved in any recorded row.

    In all others the simulated and the true table differ by what each drew, which no diagnosis
    removes.
    """
    frames, window = (case.recorded.frame, case.clean), window_of(case.recorded.frame)
    now, clean = (observe(frame, window) for frame in frames)
    same = {n for n in clean.names if n in now.names and _same(now.column(n), clean.column(n))}
    return {*now.names} - same


def _same(ours: Floats, other: Floats) -> bool:
    return bool(np.array_equal(ours, other, equal_nan=True))


def _true(case: Case, found: Diagnosis) -> Ensemble:
    """Return sealed rows beside what a simulator with the hidden physics in it says of them.

    Where ranges and levels alone are changed, by what was really added to every row; else, and
    for what is drawn at random, by the true table.
    """
    if case.shifts_m is not None and not set(case.drawn.hidden) & set(RANDOM):
        return _shifted(case, found.confirmed.before, found.confirmed.view.frame["range_m"])
    comparison = TableComparison(case.truth.frame, window_of(case.recorded.frame), 0)
    return comparison.ensemble(found.confirmed.view, (), MEMBERS)


def _shifted(case: Case, before: Ensemble, range_m: object) -> Ensemble:
    """Return the ensemble with what was added to each row, known by its measured range."""
    recorded = case.recorded.frame
    place = {value: row for row, value in enumerate(recorded["range_m"])}
    rows = np.array([place[value] for value in np.asarray(range_m, np.float64)])
    versions = before.versions.copy()
    for number, name in enumerate(before.names):
        if name in recorded and name in case.clean:
            moved = (recorded[name] - case.clean[name]).to_numpy(np.float64)[rows]
            versions[1:, :, number] += moved
    return replace(before, versions=versions)


def _score(ensemble: Ensemble, name: str) -> float:
    """Return the mean CRPS of an observable in its unit, plus what counts as nothing in it."""
    place = ensemble.place(name)
    least = RESOLUTION.get(ensemble.units[place], 0.0)
    versions = ensemble.versions[..., place : place + 1]
    one = replace(ensemble, names=(name,), units=(ensemble.units[place],), versions=versions)
    return float(np.nanmean(one.scores())) + least
