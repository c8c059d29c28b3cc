"""Versions of a table that are changed at once are, to the last bit, those changed one by one."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.batch import Batch
from bench.physics.effect import Effect
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.ground_bounce import GroundBounce
from bench.physics.effects.propagation.obstructed_path import ObstructedPath
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.effects.receiver.pulse_ringing import PulseRinging
from bench.physics.randomness import Draws
from bench.physics.simulator import Simulator

ROWS = 41
STACKED = "bench.discrepancy.compare.table_waveforms.STACKED_ROWS"


def _table(replicate: int, prefix: str, **columns: object) -> pd.DataFrame:
    far = np.linspace(2, 20, ROWS)
    plan = pd.DataFrame({"true_range_m": far, "tx": "a", "rx": "b", "los": True})
    plan["link"] = [f"{prefix}{row // 3}" for row in range(ROWS)]
    chain = (PathLoss(shadowing_db=2.0), DiffuseTail(), TimestampJitter())
    made = Simulator(Base(cir_samples=70), chain, 1).simulate(plan, replicate=replicate)
    return made.frame.assign(**columns)


RECORDED = _table(0, "link")
OTHER = [_table(n, f"other{n}-", **({"preamble_count": np.nan} if n == 2 else {})) for n in (1, 2)]


def _comparison(scaled: bool = False) -> tuple[TableComparison, View]:
    """Return the comparison with a table of links of its own, and all recorded rows."""
    frame = pd.concat(OTHER, ignore_index=True)
    if scaled:  # every CIR to one peak, as some simulators store them
        frame["cir"] = [2e4 * np.asarray(cir) / np.max(cir) for cir in frame["cir"]]
    seen = view(RECORDED, link_codes(RECORDED), np.arange(ROWS), window_of(RECORDED))
    return TableComparison(frame, window_of(RECORDED)), seen


@dataclass(frozen=True)
class Unlikely(Effect):
    """Fails in one replicate alone."""

    name = "unlikely"
    stage = "receiver"
    source = "a test"

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        if draws.replicate == 2:
            raise ValueError("not this one")
        return batch


SETS: tuple[tuple[Effect, ...], ...] = (
    (PulseRinging(ring_db=-12.0),),
    (NoiseFloor(level_db=3.0), TimestampJitter()),
    (NoiseFloor(level_db=3.0), TimestampJitter(jitter_samples=0.2)),
    (DiffuseTail(level_db=-10.0), NarrowbandInterference(level_db=5.0)),
    (PathLoss(exponent=2.4, shadowing_db=3.0), ObstructedPath()),
)


@pytest.mark.parametrize("scaled", [False, True], ids=["as received", "scaled"])
def test_versions_changed_at_once_are_those_changed_one_by_one(monkeypatch, scaled) -> None:
    together, seen = _comparison(scaled)
    alone, _ = _comparison(scaled)
    for effects in SETS:
        for members, first in ((5, 0), (3, 0), (3, 7)):
            monkeypatch.setattr(STACKED, 100 * ROWS)
            made = together.ensemble(seen, effects, members, first)
            monkeypatch.setattr(STACKED, 0)
            other = alone.ensemble(seen, effects, members, first)
            assert made.names == other.names
            np.testing.assert_array_equal(made.versions, other.versions)


def test_versions_are_changed_at_once(monkeypatch) -> None:
    comparison, seen = _comparison()
    monkeypatch.setattr("bench.physics.foreign.ForeignTable.observe", None)  # one by one
    assert len(comparison.ensemble(seen, SETS[0], 4).simulated) == 4


def test_the_first_version_that_fails_says_why() -> None:
    comparison, seen = _comparison()
    assert len(comparison.ensemble(seen, (Unlikely(),), 2).simulated) == 2
    with pytest.raises(BenchError, match=r"unlikely.*not this one"):
        comparison.ensemble(seen, (Unlikely(),), 4)


def test_a_reflection_turns_with_the_carrier_of_the_recordings_channel() -> None:
    """Beside any other channel's carrier ranges of CIR tables went up and down elsewhere."""
    rng = np.random.default_rng(6)
    far = rng.uniform(4, 20, 150)
    plan = pd.DataFrame({"true_range_m": far, "tx_z_m": 1.1, "rx_z_m": rng.uniform(0.6, 1.4, 150)})
    plan = plan.assign(link=[f"l{n}" for n in range(150)], los=True, channel=5)
    base = Base(channel=5, cir_samples=70)
    frame = Simulator(base).simulate(plan).frame
    seen = view(frame, link_codes(frame), np.arange(150), window_of(frame))
    longer = np.sqrt(far**2 + 4 * 1.1 * plan["rx_z_m"]) - far
    pull = -np.cos(2 * np.pi * longer * 6.4896 / 0.299792458) * longer * far / (far + longer)
    near = longer < 0.45  # what comes later leaves the edge as it is
    for radio, alike in ((base, True), (replace(base, channel=2), False)):
        comparison = TableComparison(frame, window_of(frame), 0, radio)
        bare, with_it = (
            comparison.ensemble(seen, some, 1).simulated_of("error_m")[0]
            for some in ((), (GroundBounce(upright=0.0),))
        )
        assert (np.corrcoef((with_it - bare)[near], pull[near])[0, 1] > 0.7) == alike
