from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
import pytest
from physics_scenes import line, room, seen

from bench.errors import BenchError
from bench.physics import Base, Batch, Draws, Effect, Simulator, parameter
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.randomness import BLOCK
from bench.physics.scene import scene
from bench.recordings.table import Recordings


def test_same_seed_same_numbers_other_seed_or_replicate_others() -> None:
    rows = scene(line())
    simulator = Simulator(effects=(DiffuseTail(), TimestampJitter()), seed=3)
    first, again = simulator.observe(rows), simulator.observe(rows)
    np.testing.assert_array_equal(first.cir, again.cir)
    np.testing.assert_array_equal(first.range_m, again.range_m)
    assert not np.array_equal(first.range_m, simulator.observe(rows, seed=4).range_m)
    assert not np.array_equal(first.range_m, simulator.observe(rows, replicate=1).range_m)


def test_numbers_do_not_depend_on_how_rows_are_cut() -> None:
    frame = line(2 * BLOCK + 100)
    simulator = Simulator(effects=(DiffuseTail(), TimestampJitter()))
    whole = simulator.observe(scene(frame))
    tail = simulator.observe(scene(frame.iloc[BLOCK:].reset_index(drop=True)), first_row=BLOCK)
    np.testing.assert_array_equal(whole.cir[BLOCK:], tail.cir)
    np.testing.assert_array_equal(whole.range_m[BLOCK:], tail.range_m)


def test_adding_an_effect_leaves_the_draws_of_others_alone() -> None:
    frame = line()
    jitter = seen(frame, TimestampJitter()).error_m - seen(frame).error_m
    both = seen(frame, DiffuseTail(), TimestampJitter()).error_m
    np.testing.assert_allclose(both - seen(frame, DiffuseTail()).error_m, jitter, atol=1e-12)


def test_ensemble_gives_independent_replicates() -> None:
    rows = scene(line())
    made = list(Simulator(effects=(TimestampJitter(),)).ensemble(rows, 3))
    correlation = np.corrcoef([outcome.error_m for outcome in made])
    assert np.abs(correlation[np.triu_indices(3, 1)]).max() < 0.2


def test_group_draws_are_equal_within_a_group_and_independent_between() -> None:
    draws = Draws(0, 0, "effect", 0)
    hashes = scene(line(4000)).group("link")
    values = draws.group_normal(hashes)
    np.testing.assert_array_equal(values[0::4], values[3::4])
    assert abs(values[::4].std() - 1) < 0.06
    assert abs(np.corrcoef(values[::4], draws.group_normal(hashes, 1)[::4])[0, 1]) < 0.1
    np.testing.assert_array_equal(values, replace(draws, block=7).group_normal(hashes))
    taps = draws.group_complex(hashes, 20)
    np.testing.assert_array_equal(taps[0], taps[3])
    assert abs(np.mean(np.abs(taps[::4]) ** 2) - 1) < 0.05


def test_base_is_unbiased_free_space_and_reports_the_manuals_powers() -> None:
    frame = line(2000)
    made = seen(frame)
    assert abs(made.error_m.mean()) < 1e-3
    assert made.error_m.std() < 0.01
    expected = -14.3 - 44.5 - 20 * np.log10(frame["true_range_m"])  # 44.5 dB at 1 m, channel 2
    np.testing.assert_allclose(made.rx_power_dbm, expected, atol=0.1)
    energy = np.sum(made.cir.astype(float) ** 2, axis=1)
    level = 10 * np.log10(energy / made.preamble_count**2) - 121.74
    np.testing.assert_allclose(level, made.rx_power_dbm, atol=0.05)
    assert made.cir.shape == (2000, 157)
    assert made.cir.dtype == np.float32


def test_first_path_lies_five_samples_in_at_half_of_the_first_peak() -> None:
    made = seen(line(1000))
    assert np.all((made.first_path_index >= 5) & (made.first_path_index < 6))
    np.testing.assert_array_equal(made.first_path_index * 64 % 1, 0)
    peaks = made.cir.argmax(axis=1) - made.first_path_index
    assert 1.0 < peaks.mean() < 1.5  # recorded: 1.1 to 1.3 samples later
    half = [
        np.interp(i, np.arange(157), row) / row.max()
        for i, row in zip(made.first_path_index, made.cir, strict=True)
    ]
    assert abs(np.mean(half) - 0.5) < 0.05


def test_a_weaker_noise_base_and_settings_of_the_rows_are_used() -> None:
    frame = line(400, preamble_count=np.where(np.arange(400) % 2, 256.0, np.nan))
    made = seen(frame)
    np.testing.assert_array_equal(made.preamble_count, np.where(np.arange(400) % 2, 256, 1024))
    ratio = made.noise_std[0::2].mean() / made.noise_std[1::2].mean()
    assert abs(ratio - 2) < 0.05  # grows as the root of the count
    assert abs(made.noise_std[0::2].mean() / 32 - 4.5) < 0.1
    ignored = seen(frame, base=Base(keep_count=0))
    np.testing.assert_array_equal(ignored.preamble_count, 1024)


def test_without_a_waveform_ranges_and_powers_agree_with_those_with_one() -> None:
    frame = room()
    short, long = seen(frame, cir=False), seen(frame)
    assert short.cir is None
    np.testing.assert_allclose(short.range_m, long.range_m, atol=0.05)
    np.testing.assert_allclose(short.rx_power_dbm, long.rx_power_dbm, atol=0.1)


def test_simulate_keeps_columns_and_says_simulated() -> None:
    given = Recordings(line(50, colour="red", error_m=9.0, cir=[np.ones(3)] * 50), "mine")
    made = Simulator(name="mine-simulated").simulate(given, seed=8)
    assert made.simulated
    assert made.seed == 8
    assert made.label == "mine-simulated (SIMULATED)"
    assert (made.frame["colour"] == "red").all()
    assert made.frame["cir"].iloc[0].shape == (157,)
    np.testing.assert_allclose(made.errors_m(), made.frame["range_m"] - given.frame["true_range_m"])
    assert np.abs(made.errors_m()).max() < 0.1


def test_effects_are_added_replaced_and_removed_by_name() -> None:
    simulator = Simulator(effects=(DiffuseTail(), TimestampJitter()))
    louder = simulator.with_effect(DiffuseTail(level_db=-3))
    assert [effect.name for effect in louder.effects] == ["diffuse-tail", "timestamp-jitter"]
    assert louder.effects[0] == DiffuseTail(level_db=-3)
    assert louder.without("diffuse-tail").effects == (TimestampJitter(),)
    with pytest.raises(BenchError, match="did you mean 'diffuse-tail'"):
        louder.without("difuse-tail")
    with pytest.raises(BenchError, match="listed twice"):
        Simulator(effects=(DiffuseTail(), DiffuseTail()))


def test_effects_act_by_stage_whatever_their_order() -> None:
    @dataclass(frozen=True)
    class Late(Effect):
        """Needs a range."""

        name, stage, source = "late", "ranging", "test"
        by_m: float = parameter(1.0, "m", 0, 2, "shift")

        def apply(self, batch: Batch, draws: Draws) -> Batch:
            return batch.longer(self.by_m)

    frame = line(64)
    assert np.array_equal(
        seen(frame, Late(), DiffuseTail()).range_m, seen(frame, DiffuseTail(), Late()).range_m
    )


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        (pd.DataFrame({"range_m": [1.0]}), "no column 'true_range_m'"),
        (pd.DataFrame({"true_range_m": [np.nan]}), "must be known"),
        (pd.DataFrame({"true_range_m": [-1.0]}), "must be known"),
        (pd.DataFrame({"true_range_m": [5e4]}), "must be known"),
        (
            line(2, obstacles=[["wall"]] * 2, obstacle_thickness_m=[[0.1, 0.2]] * 2),
            "one value per entry of 'obstacles'",
        ),
    ],
)
def test_bad_geometry_is_one_clear_line(frame: pd.DataFrame, message: str) -> None:
    with pytest.raises(BenchError, match=message):
        Simulator().simulate(frame)


def test_truth_comes_from_positions_in_a_plane_too() -> None:
    frame = pd.DataFrame({"tx_x_m": [0.0], "tx_y_m": [0.0], "rx_x_m": [3.0], "rx_y_m": [4.0]})
    assert scene(frame).true_range_m[0] == 5.0


@dataclass(frozen=True)
class Broken(Effect):
    """Fails in the way asked for."""

    name, stage, source = "broken", "ranging", "test"
    way: str = "raises"

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        if self.way == "raises":
            raise ZeroDivisionError("by design")
        return batch.longer(np.nan) if self.way == "nan" else None


@pytest.mark.parametrize(
    ("way", "message"),
    [
        ("raises", "effect 'broken' failed: ZeroDivisionError: by design"),
        ("nan", "effect 'broken' gave a range that is no number"),
        ("none", "effect 'broken' gave NoneType, expected a Batch"),
    ],
)
def test_a_failing_effect_is_named(way: str, message: str) -> None:
    with pytest.raises(BenchError, match=message):
        seen(line(8), Broken(way=way))


def test_loops_compile_where_nothing_can_be_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    import numba

    from bench.compiled import compiled
    from bench.physics import loops

    real = numba.njit

    def without_cache(**how):
        if how.get("cache"):
            raise RuntimeError("no locator available")
        return real(**how)

    monkeypatch.setattr(numba, "njit", without_cache)
    made = np.empty((1, 4), np.float32)
    values = np.ones((1, 4), np.float32)
    taps = np.ones(1, np.float32)
    compiled.__wrapped__(loops.filter_rows, finite=True)(
        made, values, np.zeros(1, np.intp), taps, 0 * taps
    )
    np.testing.assert_array_equal(made, values)
