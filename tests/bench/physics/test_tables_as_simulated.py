"""What an effect does to another simulator's CIRs is what it does in a simulation."""

from __future__ import annotations

from functools import cache

import numpy as np
import pandas as pd
import pytest
from physics_scenes import room

from bench.discrepancy.data.observables import observe, window_of
from bench.physics import ForeignTable, Simulator
from bench.physics.effect import Effect
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.propagation.diffraction import Diffraction
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.ground_bounce import GroundBounce
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.propagation.obstructed_path import ObstructedPath
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.propagation.specular import SpecularReflections
from bench.physics.effects.receiver.late_detection import LateDetection
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.effects.receiver.pulse_ringing import PulseRinging

ROOM: tuple[Effect, ...] = (SpecularReflections(), DiffuseTail())
ACTING: tuple[Effect, ...] = (
    BlockedPath(share=1.0), Diffraction(), GroundBounce(), MaterialDelay(),
    ObstructedPath(share=1.0), PathLoss(exponent=2.6), LateDetection(), LevelControl(),
    NoiseFloor(level_db=4.0), PulseRinging(),
)  # fmt: skip
MADE = ("range_m", "error_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
        "preamble_count", "first_path_index", "sample_period_ns", "cir")  # fmt: skip
MOST_STD, MOST_SHARE = 0.3, 0.3  # of what rows scatter by, or of the change, that both may differ


@cache
def plain() -> pd.DataFrame:
    """Return what a room's simulator gives of 600 rows, every second link out of sight."""
    frame = room(600, (9.0, 7.0, 3.0))
    return Simulator(effects=ROOM, seed=1).simulate(frame.assign(los=frame.index % 8 < 4)).frame


def figures(frame: pd.DataFrame) -> dict[str, np.ndarray]:
    """Return all that is compared of rows, [n] each."""
    seen = observe(frame, window_of(plain()))
    known = zip(seen.names, seen.values.T, strict=True)
    return {name: values for name, values in known if np.isfinite(values).all()}


@pytest.mark.parametrize("effect", ACTING, ids=lambda one: one.name)
def test_a_table_changes_as_a_simulation_does(effect: Effect) -> None:
    given = plain()
    geometry = given.drop(columns=[*MADE])
    made = figures(ForeignTable(given).observe((effect,)).table(geometry))
    true = figures(Simulator(effects=(*ROOM, effect), seed=1).simulate(geometry).frame)
    wide = 2.0 if isinstance(effect, Diffraction) else 1.0  # phases of magnitudes are not known
    before = figures(given)
    for name in before.keys() & made.keys() & true.keys():
        table, simulated = (float(np.mean(one[name] - before[name])) for one in (made, true))
        most = max(MOST_STD * float(np.std(before[name])), MOST_SHARE * abs(simulated))
        assert abs(table - simulated) <= wide * most, (name, table, simulated)
