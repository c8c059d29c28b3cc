"""Tables that our own simulator did not make, default options: what must not be called physics."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy_tables as made
import pandas as pd
import pytest

from bench.discrepancy import NoMismatch, Options, diagnose
from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.radio import base_of
from bench.discrepancy.data.columns import known_columns
from bench.discrepancy.report.document import markdown, summary
from bench.discrepancy.select.candidates import library, offered
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.temperature import TemperatureDrift
from bench.physics.effects.ranging.time_lag import TimeLag
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.recordings.table import Recordings

SOME = {"antenna-delay": AntennaDelay, "temperature-drift": TemperatureDrift}


@pytest.mark.parametrize("replicas", [1, 3, 8])
def test_another_mix_of_distances_is_not_physics(replicas):
    recorded, simulated = made.tables(7 + replicas, None, replicas=replicas, paired=False,
                                      theirs=(2.0, 8.0))  # fmt: skip
    found = diagnose(recorded, simulated)
    assert isinstance(found.selection.verdicts[0], NoMismatch)
    assert 0.5 > found.uncovered > 0.0  # the far links have no counterpart and take no part


def test_rooms_that_only_the_recordings_have_take_no_part():
    recorded, simulated = made.tables(3, None, paired=False)
    cellar = (recorded.frame["environment"] == "cellar").to_numpy()
    frame = recorded.frame.assign(error_m=recorded.frame["error_m"] + 0.5 * cellar)
    kept = simulated.frame[simulated.frame["environment"] != "cellar"].reset_index(drop=True)
    found = diagnose(replace(recorded, frame=frame), replace(simulated, frame=kept), kinds=SOME)
    assert found.selection.names == ()
    assert found.uncovered >= cellar.mean()


def test_tables_of_ranges_need_no_flag():
    recorded, simulated = made.tables(2, made.warmth, replicas=3)
    found = diagnose(recorded, simulated, Options(seed=2), kinds=SOME)
    assert found.options.waveform is False
    assert "rx_power_dbm" in found.confirmed.before.names  # levels take part
    assert found.selection.names == (("temperature-drift",),)
    assert found.confirmed.mae_after_m.value < 0.8 * found.confirmed.mae_before_m.value


def test_an_effect_is_offered_only_where_its_columns_are():
    recorded, _ = made.tables(1, None)
    every, _ = library()
    able, lacking = offered(every, recorded.frame, False)
    assert "room_x_m" in lacking["specular-reflections"]
    assert "could not be tried: needs azimuth_deg" in lacking["antenna-pattern"]
    assert {"quantisation", "diffuse-tail", "material-delay"} <= set(lacking)
    assert {"antenna-delay", "temperature-drift", "power-bias", "clock-offset"} <= set(able)
    with_heading = recorded.frame.assign(azimuth_deg=np.nan)
    assert "antenna-pattern" in offered(every, with_heading, False)[1]
    assert "azimuth_deg" not in known_columns(with_heading)
    for turn_deg, words in ((20.0, "headings all around"), (360.0, "")):
        turned = recorded.frame.assign(azimuth_deg=np.linspace(0, turn_deg, len(recorded)))
        assert words in offered(every, turned, False)[1].get("antenna-pattern", "")
    assert "antenna-pattern" in offered(every, turned, False)[0]


def test_an_unknown_heading_is_no_heading():
    recorded, _ = made.tables(1, None, links=8)
    turned = recorded.frame.assign(azimuth_deg=np.where(np.arange(48) < 24, 90.0, np.nan))
    ranges = [
        Simulator(Base(), effects).observe(scene(turned), 0, cir=False).range_m
        for effects in ((), (AntennaPattern(delay_m=0.3, phase_deg=90.0),))
    ]
    change = ranges[1] - ranges[0]
    assert change[:24] == pytest.approx(0.3, abs=1e-3)
    assert change[24:] == pytest.approx(0.0, abs=1e-6)


def test_a_step_that_fails_does_not_end_the_diagnosis():
    @dataclass(frozen=True)
    class Moody(TemperatureDrift):
        """Fails in company, and on held-out links."""

        name = "moody"

        def apply(self, batch, draws):
            if len(batch) % 2 or draws.replicate >= 100:
                raise ArithmeticError("not today")
            return super().apply(batch, draws)

    recorded, simulated = made.tables(2, made.warmth, replicas=3, links=40)
    found = diagnose(recorded, simulated, kinds={"moody": Moody, **SOME})
    assert "not today" in found.selection.skipped["moody"]
    assert found.selection.names == (("temperature-drift",),)


def test_what_a_failed_negative_control_refutes_is_not_named():
    @dataclass(frozen=True)
    class HotRooms(AntennaDelay):
        """A constant that must vanish in the cold: it does not."""

        name = "hot-rooms"
        control = "rows below 20 degrees"

        def inert(self, batch):
            return np.asarray(batch.rows.number("temperature_c", 0.0) < 20)

    recorded, simulated = made.tables(5, made.constant, replicas=3)
    alone = recorded.frame.drop(columns=["tx", "rx", "rx_power_dbm"])  # but the constant itself
    found = diagnose(replace(recorded, frame=alone), simulated, kinds={"hot-rooms": HotRooms})
    assert "hot-rooms" not in {name for names in found.selection.names for name in names}
    assert found.selection.names in ((), (("antenna-delay",),))


def test_tables_that_share_nothing_are_refused():
    recorded, simulated = made.tables(1, None, paired=False)
    far = simulated.frame.assign(true_range_m=200.0)
    with pytest.raises(BenchError, match="no overlap"):
        diagnose(recorded, replace(simulated, frame=far))


def _drive(lag_s: float) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return recorded and simulated rows of a robot that drives to and fro along each link."""
    rng = np.random.default_rng(11)
    frames = []
    for _ in range(2):
        time = np.tile(np.arange(30) * 0.2, 24)
        link = np.repeat(np.arange(24), 30)
        phase = rng.uniform(0, 6, 24)[link]
        distance = 8 + 3 * np.sin(0.9 * time + phase)
        speed = 3 * 0.9 * np.cos(0.9 * time + phase)
        error = rng.normal(0, 0.03, len(link)) + (0 if frames else lag_s) * speed
        frames.append(
            pd.DataFrame(
                {"link": [f"l{i}" for i in link], "time_s": time, "true_range_m": distance,
                 "error_m": error, "range_m": distance + error}
            )
        )  # fmt: skip
    return frames[0], frames[1]


def _links(table: Recordings) -> int:
    return int(table.frame["link"].nunique())


def test_a_time_lag_on_a_drive_is_found_from_positions_and_times():
    recorded, simulated = (Recordings(f, "drive") for f in _drive(0.06))
    simulated = replace(simulated, simulator="numpy")
    kinds = {"time-lag": TimeLag, **SOME}
    found = diagnose(recorded, simulated, kinds=kinds)
    assert "time-lag" in {name for names in found.selection.names for name in names}
    lag = next(effect for effect in found.added if isinstance(effect, TimeLag))
    assert lag.lag_s == pytest.approx(0.06, abs=0.01)
    assert found.recommended
    assert "The simulated table with it fits better" in found.headline
    assert found.counted[0] == f"recorded: {len(recorded)} rows of {_links(recorded)} links"
    assert found.counted[1] == f"simulated: {len(simulated)} rows of {_links(simulated)} links"
    assert summary(found)["rows"] == list(found.counted)
    broken = markdown(replace(found, source="a\n# heading of theirs"), [])
    assert "a\\n# heading of theirs" in broken.splitlines()[0]


def test_what_makes_ranges_worse_is_not_recommended():
    recorded, simulated = made.tables(2, made.warmth, replicas=3, links=40)
    found = diagnose(recorded, simulated, Options(seed=1), kinds=SOME)
    worse = replace(found.confirmed, mae_after_m=found.confirmed.mae_before_m,
                    mae_before_m=found.confirmed.mae_after_m,
                    nearer_m=Estimate(-0.01, -0.02, -0.001, "m"))  # fmt: skip
    same = replace(found.confirmed, mae_after_m=found.confirmed.mae_before_m,
                   nearer_m=Estimate(-0.001, -0.01, 0.008, "m"))  # fmt: skip
    told = replace(found, confirmed=worse)
    assert found.recommended
    assert not told.recommended
    assert told.headline.startswith("NOT RECOMMENDED")
    assert "ranges as far off as before, within chance" in replace(found, confirmed=same).headline
    half = replace(found.confirmed.mae_before_m, value=0.5 * found.confirmed.mae_before_m.value)
    few = replace(found.confirmed, mae_after_m=half, nearer_m=Estimate(0.03, -0.01, 0.08, "m"))
    assert "ranges nearer, though not beyond chance" in replace(found, confirmed=few).headline


def test_the_radio_settings_of_the_table_are_the_bases():
    recorded, _ = made.tables(2, None)
    frame = recorded.frame.assign(channel=5, prf_mhz=16)
    base = base_of(frame, Simulator(Base()))
    assert (base.channel, base.prf_mhz, base.tx_power_dbm) == (5, 16, Base().tx_power_dbm)
    assert base_of(frame.assign(channel=[5, 2] * (len(frame) // 2)), Simulator(Base())).channel == 2
    assert base_of(frame.assign(channel=9), Simulator(Base())).channel == 9  # of a DW3000


def test_with_one_simulated_row_for_each_recorded_one_scatter_is_borrowed():
    recorded, simulated = made.tables(121, made.crystals, replicas=1)
    found = diagnose(recorded, simulated, kinds=SOME)
    assert found.selection.rounds[0].located.significant
    assert found.selection.names == (("clock-offset",),)
    assert found.confirmed.mae_after_m.value < 0.2 * found.confirmed.mae_before_m.value


@pytest.mark.parametrize(("replicas", "paired"), [(1, True), (2, True), (3, False)])
def test_where_nothing_is_left_out_hardly_a_search_finds_anything(replicas, paired):
    found = 0
    for seed in range(8):
        recorded, simulated = made.tables(500 + seed, None, replicas=replicas, paired=paired,
                                          links=30)  # fmt: skip
        verdict = diagnose(recorded, simulated, kinds={}).selection.verdicts[0]
        found += not isinstance(verdict, NoMismatch)
    assert found <= 2
