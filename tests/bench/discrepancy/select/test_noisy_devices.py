"""Devices whose logged noise is louder than simulated are told from a noise floor of all."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.device_rows import devices_of
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.select.logged import read_logs, read_off
from bench.discrepancy.select.noisy_devices import louder_devices
from bench.discrepancy.select.state import Search
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.effects.fitted.noise_of_devices import NoiseOfDevices
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

KINDS: dict[str, type[Effect]] = {"noise-floor": NoiseFloor}
TAGS, ANCHORS, EACH = 4, 9, 5


def _frame(louder_db: dict[str, float], seed: int = 1) -> pd.DataFrame:
    rng = np.random.default_rng(seed)
    pairs = [(f"t{i}", f"a{j}") for i in range(TAGS) for j in range(ANCHORS) for _ in range(EACH)]
    tx, rx = map(list, zip(*pairs, strict=True))
    true_m = np.repeat(rng.uniform(1, 20, TAGS * ANCHORS), EACH)
    louder = np.array([louder_db.get(t, 0.0) + louder_db.get(r, 0.0) for t, r in pairs])
    noise = rng.normal(50, 1, len(pairs)) * 10 ** (louder / 20)
    error_m = 0.02 * rng.normal(size=len(pairs))
    return pd.DataFrame(
        {
            "link": [f"{t}-{r}" for t, r in pairs], "tx": tx, "rx": rx, "true_range_m": true_m,
            "range_m": true_m + error_m, "error_m": error_m, "noise_std": noise,
            "rx_power_dbm": -64 - 20 * np.log10(true_m) + rng.normal(size=len(pairs)),
        }
    )  # fmt: skip


def _search(recorded: pd.DataFrame, simulated: pd.DataFrame) -> Search:
    rows = view(
        recorded, link_codes(recorded), np.arange(len(recorded)), Window(), None, waveform=False
    )
    return Search(TableComparison(simulated, Window()), rows, rows, KINDS, 0, work=rows)


@pytest.mark.parametrize("who", ["a3", "t1"])
def test_a_device_that_is_louder_at_either_end_is_read_off_its_log(who: str) -> None:
    search = read_logs(_search(_frame({who: 6.0}), _frame({}, 2)))
    (found,) = search.logged
    assert isinstance(found, NoiseOfDevices)
    assert found.devices == (who,)
    assert found.physics == "noise-floor"
    assert "noise-floor" not in search.kinds
    assert not found.fitted  # so that no search of effects offers it without devices
    (level,) = read_off(search, found)
    assert level.name == f"louder_db[{who}]"
    assert level.low < 6.0 < level.high
    assert level.high - level.low < 1.0


def test_all_are_louder_together_or_as_a_simulated_device_is() -> None:
    every = {f"a{i}": 6.0 for i in range(ANCHORS)}
    (found,) = read_logs(_search(_frame(every), _frame({}, 2))).logged
    assert type(found) is NoiseFloor
    assert not read_logs(_search(_frame({"a3": 6.0}), _frame({"a3": 6.0}, 2))).logged


def test_many_that_differ_do_as_devices_do() -> None:
    frame = _frame({"a1": 3.0, "a2": 5.0, "a5": 8.0, "t2": 4.0})
    links = link_codes(frame)
    level_db = 20 * np.log10(frame["noise_std"].to_numpy() / 50)
    assert louder_devices(level_db, links, devices_of(frame)) == {}
    frame = _frame({"a1": 3.0, "a5": 8.0})
    level_db = 20 * np.log10(frame["noise_std"].to_numpy() / 50)
    found = louder_devices(level_db, links, devices_of(frame))
    assert {name: round(by_db) for name, (by_db, _) in found.items()} == {"a1": 3, "a5": 8}


def test_it_acts_on_rows_of_its_devices_alone() -> None:
    frame = _frame({})
    noisy = NoiseOfDevices(devices=("a3", "t1"), louder_db=(6.0, 3.0), doubts_db=(0.1, 0.1))
    made = [
        Simulator(Base(), effects, 5, "test").observe(scene(frame), 5, 0).noise_std
        for effects in ((replace(noisy, louder_db=(0.0, 0.0)),), (noisy,))
    ]
    by_db = 20 * np.log10(np.asarray(made[1]) / np.asarray(made[0]))
    for tx, rx, more_db in (
        ("t0", "a3", 6.0),
        ("t1", "a0", 3.0),
        ("t1", "a3", 9.0),
        ("t0", "a0", 0),
    ):
        rows = ((frame["tx"] == tx) & (frame["rx"] == rx)).to_numpy()
        assert by_db[rows] == pytest.approx(more_db, abs=0.3)
