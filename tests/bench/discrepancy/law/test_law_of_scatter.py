"""What a law over known columns predicts from row to row is no independent scatter."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.skill import Tally
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.law.unexplained import Weighed, weighed
from bench.discrepancy.select.candidates import Contender, Explanation
from bench.discrepancy.select.state import Round, Search, Selection
from bench.discrepancy.select.verdict import Control, LeftOut
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from tests.bench.discrepancy.numpy_tables import Hidden, tables

GAIN = Estimate(1.0, 0.9, 1.1, "nats")
JITTER = TimestampJitter(jitter_samples=0.2)


def named_as_jitter(hidden: Hidden) -> Weighed:
    """Return what is weighed where the library said jitter of what is hidden."""
    recorded, simulated = tables(6, hidden)
    frame, codes = recorded.frame, link_codes(recorded.frame)
    one, two = (
        view(frame, codes, np.flatnonzero(codes % 2 == part), Window(), None, False)
        for part in range(2)
    )
    search = Search(TableComparison(simulated.frame, Window()), one, two, {}, 0)
    tally = Tally(("error_m",), np.ones((4, 1)), np.ones((4, 1)))
    told = Explanation((Contender(JITTER, tally, GAIN),), tally, GAIN, tally, {}, {})
    turn = Round(SimpleNamespace(findings=()), told, JITTER)  # type: ignore[arg-type]
    verdict = LeftOut(JITTER, (), GAIN, 1.0, Control("", None))
    return weighed(search, Selection((verdict,), (JITTER,), (turn,)))


def drawn(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    frame["walked_m"] = rng.uniform(0, 60, len(frame))
    return rng.normal(0, 0.06, len(frame))


def swung(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    frame["walked_m"] = rng.uniform(0, 60, len(frame))
    return np.asarray(0.08 * np.cos(2 * np.pi * frame["walked_m"] / 1.47))


def both(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    return drawn(frame, rng) + 0.6 * swung(frame, rng)


def test_what_a_column_predicts_is_said_as_a_law_and_not_as_jitter() -> None:
    made = named_as_jitter(swung)
    assert made.proposal is not None
    assert made.proposal.best.structure.columns == ("walked_m",)
    assert made.instead is not None
    assert made.instead.names == ()
    assert made.added == ()


def test_jitter_stays_where_a_law_predicts_nothing_or_the_lesser_part_of_it() -> None:
    for hidden in (drawn, both):
        made = named_as_jitter(hidden)
        assert made.instead is None
        assert made.added == (JITTER,)
