"""Counts and noise that a receiver logs tell causes apart where no waveform is compared."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Comparison, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.select import logged, marks, stepwise
from bench.discrepancy.select.candidates import offered
from bench.discrepancy.select.receiver_logs import Logged
from bench.discrepancy.select.settings import LOGGED_NATS
from bench.discrepancy.select.state import Search
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.simulator import Simulator

Floats = NDArray[np.float64]
KINDS: dict[str, type[Effect]] = {
    "level-control": LevelControl, "noise-floor": NoiseFloor, "path-loss": PathLoss,
}  # fmt: skip
LEVEL = np.linspace(-98.0, -70.0, 160)
DEVICES = np.stack([np.ones(160), np.arange(160) % 4 == 0], axis=1).astype(np.float64)


def _logs(count_db: Floats, noise_db: Floats) -> Logged:
    scatter = 0.05 * np.random.default_rng(1).normal(size=160)
    return Logged(LEVEL, count_db + scatter, noise_db + 4 * scatter[::-1], DEVICES, 40.0, 1e-6)


def _frame(count: Floats | None = None, louder_db: float = 0.0, seed: int = 1) -> pd.DataFrame:
    rng = np.random.default_rng(seed)
    true = np.repeat(rng.uniform(1, 30, 40), 4)
    error = 0.02 * rng.normal(size=160)
    frame = pd.DataFrame(
        {
            "link": np.repeat([f"l{i}" for i in range(40)], 4),
            "true_range_m": true, "range_m": true + error, "error_m": error,
            "rx_power_dbm": -64 - 20 * np.log10(true) + rng.normal(size=160),
            "preamble_count": np.full(160, 1024.0),
            "noise_std": rng.normal(50, 2, 160) * 10 ** (louder_db / 20),
        }
    )  # fmt: skip
    return frame if count is None else frame.assign(preamble_count=count)


def _search(frame: pd.DataFrame, other: Comparison) -> Search:
    rows = view(frame, link_codes(frame), np.arange(160), Window(), None, False)
    return Search(other, rows, rows, KINDS, 0, work=rows)


def test_counts_that_fall_with_the_level_show_a_control_of_any_form() -> None:
    for fall in (0.1 * np.maximum(LEVEL + 84, 0), 0.5 * (LEVEL > -76), 0.002 * (LEVEL + 98) ** 2):
        seen = _logs(-fall, np.zeros(160))
        assert logged.ends_early(seen) > LOGGED_NATS
        assert logged.ends_early(replace(seen, simulated=seen)) < LOGGED_NATS  # that may do so, too


def test_rows_that_end_early_by_chance_count_by_rows_and_those_of_a_link_by_links() -> None:
    rng, links = np.random.default_rng(3), np.arange(160) % 40
    early = rng.random(160) < np.clip((LEVEL + 95) / 12, 0.2, 0.8)
    seen = replace(_logs(-1.0 * early, np.zeros(160)), links=links)
    assert logged.ends_early(seen) > LOGGED_NATS
    own = replace(_logs(rng.normal(size=40)[np.arange(160) // 4], np.zeros(160)))
    assert logged.ends_early(replace(own, links=np.arange(160) // 4)) < LOGGED_NATS


def test_what_is_turned_down_now_and_then_reads_weaker_than_what_is_not() -> None:
    rng = np.random.default_rng(4)
    arrives = rng.uniform(-94, -84, 160)
    small = rng.random(160) < (arrives + 94) / 10
    shadowed = arrives + rng.normal(0, 2, 160)
    seen = replace(_logs(-4.0 * small, np.zeros(160)), level_dbm=shadowed - 6.0 * small)
    assert logged.ends_early(seen) < LOGGED_NATS
    assert logged.ends_early(replace(seen, arriving_dbm=arrives)) > LOGGED_NATS


def test_what_is_turned_down_now_and_then_within_links_stops_early() -> None:
    """Levels of links that nobody knows: only rows of one link tell; and a simulator may do so."""
    rng, links = np.random.default_rng(4), np.arange(160) // 4
    small, own = rng.random(160) < 0.7, rng.normal(0, 5, 40)[links]
    level = LEVEL + own + rng.normal(0, 0.5, 160)
    seen = _logs(-2.2 * small, np.zeros(160))
    same = replace(seen, links=links, arriving_dbm=LEVEL, level_dbm=level - 2.8 * small)
    none = replace(_logs(np.zeros(160), np.zeros(160)), links=links, arriving_dbm=LEVEL)
    seen = replace(same, simulated=none)
    assert logged.turns_down(seen) > LOGGED_NATS
    weak = replace(seen, level_dbm=level + 2.8 * small)
    for other in (weak, replace(seen, level_dbm=level), replace(seen, simulated=same), same):
        assert logged.turns_down(other) < LOGGED_NATS


def test_counts_that_devices_are_set_to_or_that_rise_show_none() -> None:
    for count_db in (np.zeros(160), -3.0 * DEVICES[:, 1], 0.1 * np.maximum(LEVEL + 84, 0)):
        seen = _logs(count_db, np.zeros(160))
        assert logged.ends_early(seen) < LOGGED_NATS
        assert logged.as_simulated(seen) > LOGGED_NATS


def test_noise_is_louder_beyond_what_goes_with_the_count() -> None:
    fall = -0.1 * np.maximum(LEVEL + 84, 0)
    for noise_db, louder in ((np.zeros(160), False), (-fall, False), (np.full(160, 0.7), True)):
        assert (logged.louder(_logs(fall, noise_db)) > LOGGED_NATS) is louder
    of_one = 2.0 * DEVICES[:, 1]
    assert logged.louder(_logs(np.zeros(160), of_one)) > LOGGED_NATS
    assert logged.louder(_logs(np.zeros(160), of_one - 3.0)) == 0.0  # the simulator has too much


def test_logs_that_are_alike_leave_a_path_loss_alone() -> None:
    found = logged.read_logs(_search(_frame(), TableComparison(_frame(seed=2), Window())))
    assert found.logged == ()
    assert set(found.kinds) == {"noise-floor", "path-loss"}


def test_what_is_not_logged_says_nothing() -> None:
    frame = _frame().drop(columns=["preamble_count", "noise_std"])
    found = logged.read_logs(_search(frame, TableComparison(_frame(seed=2), Window())))
    assert (found.logged, set(found.kinds)) == ((), set(KINDS))


def test_a_level_control_is_not_offered_where_no_counts_are_told() -> None:
    able, lacking = offered(KINDS, _frame().drop(columns=["preamble_count"]), False)
    assert "level-control" not in able
    assert "needs preamble_count" in lacking["level-control"]
    assert "level-control" in offered(KINDS, _frame(), False)[0]


def test_a_louder_floor_is_a_mark_that_no_score_takes_back() -> None:
    search = _search(_frame(louder_db=2.0), TableComparison(_frame(seed=2), Window()))
    found = logged.read_logs(search)
    (floor,) = marks.marked(found)
    assert isinstance(floor, NoiseFloor)
    assert floor.level_db == pytest.approx(2.0, abs=0.3)
    assert stepwise.bears_mark(found, floor)
    (level,) = logged.read_off(found, floor)
    assert level is not None
    assert level.low < floor.level_db < level.high < level.low + 0.5
    assert logged.read_off(found, PathLoss()) == ()
    assert "noise_std" in logged.judged_by(found, floor)
    assert not logged.judged_by(search, floor)
    assert not stepwise.bears_mark(search, floor)


def test_beside_waveforms_counts_show_a_control_and_noise_is_left_to_these() -> None:
    frame = _frame(louder_db=2.0)
    counted = np.rint(1024 * np.where(frame["rx_power_dbm"] > -80, 0.98, 1.0))  # hardly seen
    search = _search(
        frame.assign(preamble_count=counted), TableComparison(_frame(seed=2), Window())
    )
    rows = replace(search.fit, waveform=True)
    found = logged.read_logs(replace(search, fit=rows, discover=rows, work=None))
    (control,) = found.logged
    assert isinstance(control, LevelControl)
    assert marks.forms_of_marks(found) == [control.forms()]
    assert {form.in_samples for form in control.forms()} == {1.0, 0.5, 0.0}


def test_a_simulator_that_reads_counts_from_rows_is_asked_for_its_own() -> None:
    frame = _frame()
    strong = np.maximum(frame["rx_power_dbm"].to_numpy(np.float64) + 88, 0)
    counted = frame.assign(preamble_count=np.rint(1024 * 10 ** (-0.03 * strong)))
    world = Resimulation(Simulator(Base(), (), 3), Window())
    quiet = 4.5 * np.sqrt(counted["preamble_count"])
    (control,) = logged.read_logs(_search(counted.assign(noise_std=quiet), world)).logged
    assert isinstance(control, LevelControl)
    assert control.accumulation > 0
    bare = replace(_search(frame.assign(noise_std=4.5 * 32.0), world))
    assert logged.read_logs(bare).logged == ()


def test_where_a_control_starts_is_for_counts_to_say_not_for_levels() -> None:
    frame = _frame()
    lost = 0.2 * frame["true_range_m"].to_numpy(np.float64)  # a loss per metre moves every level
    level = frame["rx_power_dbm"] - lost
    counted = np.rint(1024 * np.where(level > -80, 0.4, 1.0))
    shown = frame.assign(rx_power_dbm=level, preamble_count=counted)
    table = TableComparison(_frame(seed=2), Window())
    (control,) = logged.read_logs(_search(shown, table)).logged
    assert isinstance(control, LevelControl)
    assert control.shift_db >= 1.5
