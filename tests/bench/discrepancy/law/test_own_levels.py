"""Levels at wrong distances are no other path loss: a fault of the set-up says what made them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.law import own_levels
from bench.discrepancy.law.search import Proposal
from bench.discrepancy.select.state import Search, Selection
from bench.discrepancy.select.verdict import Control, LeftOut, Unknown
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.ranging.range_scale import RangeScale

NATS = Estimate(0.13, 0.05, 0.22)


def rows_of(links: int) -> View:
    """Return rows of links, four each; SIMULATED."""
    far_m = np.linspace(2, 20, 4 * links)
    frame = pd.DataFrame({"link": np.repeat([f"l{n}" for n in range(links)], 4)})
    frame = frame.assign(true_range_m=far_m, range_m=far_m, error_m=0.0)
    return view(frame, link_codes(frame), np.arange(4 * links), Window(), ("error_m",), False)


@pytest.mark.parametrize(("elsewhere", "named"), [(-0.02, False), (0.1, True)])
def test_levels_are_asked_for_where_no_device_is_elsewhere(
    monkeypatch: pytest.MonkeyPatch, elsewhere: float, named: bool
) -> None:
    """Two anchors were exchanged, and a path loss of 1.92 [1, 2.4] stood beside that."""
    rows, asked = rows_of(10), []
    exchanged = rows.links < 4

    def gained(before: View, *_: object) -> Estimate:
        asked.append(before)
        return Estimate(elsewhere, elsewhere - 0.05, elsewhere + 0.05)

    monkeypatch.setattr(own_levels, "shift_m", lambda *_: np.where(exchanged, 3.0, 0.0))
    monkeypatch.setattr(own_levels, "tally", lambda one: one)
    monkeypatch.setattr(own_levels, "gain_interval", gained)
    comparison = SimpleNamespace(ensemble=lambda view, *_: view)
    search = cast(Search, SimpleNamespace(both=rows, comparison=comparison, seed=0))
    loss, scale = PathLoss(exponent=1.9), RangeScale(0.01)
    said = [LeftOut(one, (), NATS, 1.0, Control("", None)) for one in (loss, scale)]
    left = Unknown((), NATS, beside=("path-loss", "range-scale"))
    found = Selection((*said, left), (loss, scale), ())
    made = own_levels.at_right_distances(search, found, cast(Proposal, None))
    assert [set(one.links.tolist()) for one in asked] == [set(range(4, 10))]
    names = ("path-loss", "range-scale") if named else ("range-scale",)
    assert made.names == tuple((name,) for name in names)
    assert made.added == ((loss, scale) if named else (scale,))
    assert cast(Unknown, made.verdicts[-1]).beside == names
