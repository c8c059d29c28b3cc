"""Effects on the rows of another simulator's table."""

import numpy as np
import pandas as pd
import pytest
from physics_scenes import line

from bench.errors import BenchError
from bench.physics import ForeignTable, Simulator
from bench.physics.base import RAYLEIGH_STD
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.fading import SmallScaleFading
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.propagation.specular import SpecularReflections
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.power_bias import PowerBias, published_bias_m
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.effects.receiver.pulse_ringing import PulseRinging
from bench.physics.effects.receiver.quantisation import Quantisation


def simulated(**columns) -> pd.DataFrame:
    """Return a table as another simulator might give it."""
    frame = line(300, far_m=8.0, los=True, **columns)
    return Simulator(effects=(DiffuseTail(),)).simulate(frame).frame


@pytest.fixture(scope="module")
def table() -> ForeignTable:
    return ForeignTable(simulated(obstacles=[["wall"] if row % 2 else [] for row in range(300)]))


def test_without_effects_the_table_comes_back(table: ForeignTable) -> None:
    made = table.observe(())
    for name in ("range_m", "rx_power_dbm", "first_path_power_dbm", "noise_std", "preamble_count"):
        np.testing.assert_allclose(getattr(made, name), table.frame[name], rtol=1e-9)
    np.testing.assert_allclose(made.cir, np.stack(table.frame["cir"]), rtol=1e-5, atol=0.1)
    np.testing.assert_allclose(made.first_path_index, table.frame["first_path_index"])


def test_a_table_that_tells_no_count_nor_noise_gets_none(table: ForeignTable) -> None:
    bare = ForeignTable(table.frame.drop(columns=["preamble_count", "noise_std"]))
    made = bare.observe((PathLoss(exponent=2.5),))
    assert np.isnan(made.preamble_count).all()
    assert np.isnan(made.noise_std).all()
    assert made.cir is not None
    plain = np.stack(table.frame["cir"]).max(axis=1)
    assert np.median(made.cir.max(axis=1) / plain) == pytest.approx(0.75, abs=0.25)


def test_ranging_effects_act_in_full(table: ForeignTable) -> None:
    made = table.observe((AntennaDelay(delay_ns=2.0),))
    np.testing.assert_allclose(made.range_m - table.range_m, 0.299792458)
    biased = table.observe((PowerBias(),)).range_m - table.range_m
    level = table.frame["rx_power_dbm"].to_numpy()
    np.testing.assert_allclose(biased, published_bias_m(level), atol=1e-6)


def test_a_wall_delays_and_weakens_the_first_path_of_its_rows_alone(table: ForeignTable) -> None:
    made, base = table.observe((MaterialDelay(),)), table.observe(())
    shift = made.range_m - base.range_m
    np.testing.assert_array_equal(shift[0::2], 0)
    assert abs(np.median(shift[1::2]) - 0.137) < 0.03
    drop = (base.first_path_power_dbm - made.first_path_power_dbm)[1::2]
    assert 3 < np.median(drop) < 12
    tail = made.cir[1::2, 30:] / base.cir[1::2, 30:]
    assert abs(np.median(tail) - 1) < 0.01  # what comes later stays


def test_all_paths_can_be_moved_and_weakened(table: ForeignTable) -> None:
    frame = table.frame.assign(azimuth_deg=0.0)
    made = ForeignTable(frame).observe((AntennaPattern(delay_m=0.1),))
    np.testing.assert_allclose(made.range_m - table.range_m, 0.1, atol=1e-4)
    np.testing.assert_allclose(made.cir, np.stack(frame["cir"]), rtol=1e-3, atol=1)
    weaker = table.observe((PathLoss(offset_db=6.0),))
    np.testing.assert_allclose(weaker.rx_power_dbm, table.frame["rx_power_dbm"] - 6, atol=0.05)


def test_reflections_and_tails_are_added_to_the_cir(table: ForeignTable) -> None:
    base = table.observe(())
    for effect in (SpecularReflections(wall_m=5.0, walls="metal"), DiffuseTail(level_db=3.0)):
        made = table.observe((effect,))
        assert made.cir.shape == base.cir.shape
        assert np.median(made.cir[:, 10:60].sum(axis=1) / base.cir[:, 10:60].sum(axis=1)) > 1.2


def test_a_blocked_path_moves_the_detection_in_the_cir(table: ForeignTable) -> None:
    frame = table.frame.assign(los=False)
    made = ForeignTable(frame).observe((BlockedPath(share=1.0, detour_m=3.0, reflection_db=-3),))
    shift = made.range_m - table.range_m
    moved = (made.first_path_index - table.frame["first_path_index"]) * 0.3003
    np.testing.assert_allclose(shift, moved, atol=2e-3)
    assert np.median(shift) > 0.5


def test_receiver_effects_act_on_the_cir(table: ForeignTable) -> None:
    base = table.observe(())
    louder = table.observe((NoiseFloor(level_db=20.0),))
    np.testing.assert_allclose(louder.noise_std / base.noise_std, 10, rtol=1e-6)
    before = louder.cir[:, :2].mean() / base.cir[:, :2].mean()
    assert 7 < before < 13
    lower = table.observe((NoiseFloor(level_db=-6.0, lag_1=0, lag_2=0, lag_3=0),))
    np.testing.assert_allclose(lower.noise_std, base.noise_std, rtol=1e-6)  # nor reported so
    held = table.observe((LevelControl(),))
    assert np.median(held.preamble_count) < 400
    assert held.cir.max() < 20_500
    rung = table.observe((PulseRinging(ring_db=-3.0),))
    assert not np.allclose(rung.cir, base.cir, rtol=0.01)


def test_rows_without_a_cir_have_ranges_and_powers(table: ForeignTable) -> None:
    bare = ForeignTable(table.frame.drop(columns=["cir", "rx_power_dbm", "first_path_power_dbm"]))
    made = bare.observe((MaterialDelay(),))
    assert made.cir is None
    np.testing.assert_allclose((made.range_m - table.range_m)[1::2], 0.1368, atol=1e-3)
    np.testing.assert_allclose((made.range_m - table.range_m)[0::2], 0, atol=1e-12)
    assert np.isfinite(made.rx_power_dbm).all()


def test_errors_alone_and_complex_cirs_are_enough(table: ForeignTable) -> None:
    frame = table.frame.drop(columns="range_m")
    cir = np.stack(frame["cir"])
    turned = frame.drop(columns="cir").assign(cir_i=list(0.6 * cir), cir_q=list(0.8 * cir))
    made = ForeignTable(turned).observe(())
    np.testing.assert_allclose(made.cir, cir, rtol=1e-4, atol=0.1)
    np.testing.assert_allclose(made.range_m, table.range_m)


def test_what_cannot_be_done_is_said() -> None:
    frame = simulated()
    with pytest.raises(BenchError, match="'small-scale-fading' needs the simulator"):
        ForeignTable(frame).observe((SmallScaleFading(),))
    with pytest.raises(BenchError, match="'range_m' or 'error_m'"):
        ForeignTable(frame.drop(columns=["range_m", "error_m"])).observe(())
    uneven = frame.assign(cir=[np.ones(3 + row % 2) for row in range(len(frame))])
    with pytest.raises(BenchError, match="different lengths"):
        ForeignTable(uneven).observe(())


def test_what_is_remembered_gives_the_same_numbers(table: ForeignTable) -> None:
    """Effects on the range alone reuse the detected batch, whatever was asked before."""
    both = (PulseRinging(), AntennaDelay(delay_ns=1.0))
    fresh = ForeignTable(table.frame).observe(both, 3, 2)
    table.observe((PulseRinging(), AntennaDelay(delay_ns=2.0)), 3, 2)
    again = table.observe(both, 3, 2)
    np.testing.assert_array_equal(again.range_m, fresh.range_m)
    np.testing.assert_array_equal(again.cir, fresh.cir)
    assert table.observe(both, 3, 2, cir=False).cir is None


def test_a_tone_makes_noise_alike_within_a_record_of_magnitudes() -> None:
    """Noise has phases though a table of magnitudes has none: it does not beat as one wave."""
    frame = Simulator(effects=()).simulate(line(200, far_m=8.0)).frame
    magnitudes = ForeignTable(frame.drop(columns=["cir_i", "cir_q"], errors="ignore"))
    tone = NarrowbandInterference(level_db=0.0, fading_db=0.0, offset_mhz=80.0)

    def scatter(effects: tuple[NarrowbandInterference, ...]) -> float:
        cir = magnitudes.observe(effects).cir
        assert cir is not None
        late = cir[:, -12:]
        return float(np.median(late.std(axis=1) / late.mean(axis=1)))

    assert scatter((tone,)) < 0.9 * scatter(())  # 0.41 beside 0.52, if there were many samples


def test_a_tone_raises_the_magnitude_but_hardly_its_scatter(table: ForeignTable) -> None:
    """The chip reports the scatter of magnitudes: against samples drawn as it would see them."""
    rng = np.random.default_rng(0)
    own = table.frame["noise_std"].to_numpy() / RAYLEIGH_STD
    drawn = own[:, None] * (rng.normal(size=(2, 300, 4000)).T @ np.array([1, 1j])).T
    for level_db in (0.0, 6.0, 20.0):
        tone = NarrowbandInterference(level_db=level_db, fading_db=0.0)
        made = table.observe((tone,))
        size = np.sqrt(2) * own[:, None] * 10 ** (level_db / 20)
        np.testing.assert_allclose(made.noise_std, np.abs(drawn + size).std(axis=1), rtol=0.06)
    offset = table.observe((Quantisation(step_counts=0, offset_counts=900.0),))
    assert np.all(offset.noise_std < 2 * table.frame["noise_std"])


def test_an_echo_on_magnitudes_adds_noise_as_noise() -> None:
    rng = np.random.default_rng(2)
    noise = np.abs(rng.normal(0, 40, (100, 150)) + 1j * rng.normal(0, 40, (100, 150)))
    noise[:, 20:23] += np.array([2000, 4000, 2000])
    table = ForeignTable(
        pd.DataFrame(
            {"true_range_m": 5.0, "range_m": 5.0, "noise_std": 26.0, "preamble_count": 1000}
            | {"first_path_index": 20.0, "cir": list(noise)},
            index=range(100),
        )
    )
    made = table.observe((PulseRinging(ring_db=-3, ring_delay_ns=30, on_top=1.0),))
    late = np.mean(made.cir[:, 80:] ** 2) / np.mean(noise[:, 80:] ** 2)
    assert abs(late - 1.5) < 0.12  # 2.3 if all magnitudes had one phase
