"""A diagnosis finds the same bits however its fits are spread."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from light_tasks import power

from bench.discrepancy import Options, diagnose
from bench.parallel import Spread, each, spreading
from bench.physics.base import Base
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings

KINDS = {kind.name: kind for kind in (AntennaDelay, PathLoss)}
FEW = Options(search_rows=48, fit_rows=24, confirm_rows=24)
SIMULATOR = Simulator(replace(Base(), cir_samples=48), (DiffuseTail(),), 3, "mine")


@pytest.fixture(scope="module")
def recorded() -> Recordings:
    link = np.repeat(np.arange(12), 6)
    frame = pd.DataFrame({"link": [f"l{one}" for one in link]})
    frame["true_range_m"] = np.linspace(2, 12, 12)[link]
    made = SIMULATOR.with_effect(AntennaDelay(delay_ns=2.0)).simulate(frame, seed=8)
    return Recordings(made.frame, "mine")


def test_each_keeps_the_order_wherever_it_works(cluster: str) -> None:
    for spread in (Spread(), Spread(jobs=2), Spread(scheduler=cluster)):
        with spreading(spread):
            assert each(power, 2, range(5)) == [0, 1, 4, 9, 16]
    assert each(power, 3, [2], far=False) == [8]


@pytest.mark.slow
def test_a_diagnosis_does_not_depend_on_how_its_fits_were_spread(
    recorded: Recordings, cluster: str
) -> None:
    found = []
    for spread in (Spread(), Spread(scheduler=cluster)):  # processes: see the test above
        with spreading(spread):
            found.append(diagnose(recorded, SIMULATOR, FEW, kinds=KINDS))
    assert "antenna-delay" in str(found[0].selection.names)
    for other in found[1:]:
        assert other.added == found[0].added
        assert other.selection.verdicts == found[0].selection.verdicts
        assert other.confirmed.gain == found[0].confirmed.gain
