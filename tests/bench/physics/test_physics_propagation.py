"""Signature, magnitude and negative control of the effects on paths."""

import numpy as np
import pandas as pd
import pytest
from physics_scenes import change, line, room, seen

from bench.physics import Base
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.propagation.diffraction import Diffraction, knife_edge
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.fading import SmallScaleFading, scatter_db
from bench.physics.effects.propagation.ground_bounce import GroundBounce
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.propagation.specular import SpecularReflections
from bench.physics.randomness import Draws
from bench.physics.scene import scene

GHZ = 3.9936
NS = 1 / 0.299792458


def walls(n: int = 256, **columns):
    """Return rows behind a wall in turn with rows behind nothing."""
    return line(n, obstacles=[["wall"] if row % 2 else [] for row in range(n)], **columns)


def test_a_wall_is_a_fixed_step_at_all_distances_and_weakens() -> None:
    made, base = change(walls(), MaterialDelay())
    shift = made.range_m - base.range_m
    np.testing.assert_array_equal(shift[0::2], 0)  # no wall, no delay
    np.testing.assert_allclose(shift[1::2], 0.14 * (np.sqrt(3.91) - 1), atol=0.02)
    assert abs(shift[1::2].mean() - 0.14 * (np.sqrt(3.91) - 1)) < 0.003
    loss = (base.first_path_power_dbm - made.first_path_power_dbm)[1::2]
    assert 3 < loss.mean() < 12
    np.testing.assert_array_equal(made.cir[0::2], base.cir[0::2])


def test_two_walls_are_twice_one_and_thickness_counts() -> None:
    two = line(64, obstacles=[["wall", "wall"]] * 64)
    thick = line(64, obstacles=[["wall"]] * 64, obstacle_thickness_m=[[0.28]] * 64)
    shifts = [np.subtract(*(x.range_m for x in change(f, MaterialDelay()))) for f in (two, thick)]
    np.testing.assert_allclose(shifts[0], shifts[1], atol=0.02)


def test_rows_without_sight_and_without_a_list_get_a_wall() -> None:
    frame = line(64, los=[bool(row % 2) for row in range(64)])
    shift = np.subtract(*(x.range_m for x in change(frame, MaterialDelay())))
    np.testing.assert_array_equal(shift[1::2], 0)
    assert shift[0::2].min() > 0.12


def test_material_delay_names_its_control_rows() -> None:
    batch = Base().paths(scene(walls(4)))
    np.testing.assert_array_equal(MaterialDelay().inert(batch), [True, False, True, False])


def test_spill_lets_a_wall_weaken_every_path() -> None:
    frame = room(256).assign(obstacles=[["wall"]] * len(room(256)))
    alone = seen(frame, MaterialDelay(), DiffuseTail(level_db=0))
    spilt = seen(frame, MaterialDelay(spill=1.0), DiffuseTail(level_db=0))
    difference = np.median(alone.rx_power_dbm - spilt.rx_power_dbm)
    assert 3 < difference < 12


def test_knife_edge_is_the_recommendation() -> None:
    excess, loss = knife_edge(np.array([4.0]), np.array([0.0]), np.array([0.5]), GHZ)
    assert excess[0] == 0
    assert abs(loss[0] - 6.03) < 0.05  # grazing: half the field


def test_a_body_mid_link_loses_much_and_delays_little() -> None:
    frame = line(64, far_m=5.0, los=False).assign(true_range_m=4.0)
    made, base = change(frame, Diffraction(body_half_width_m=0.23))
    one_edge = knife_edge(np.array([4.0]), np.array([0.23]), np.array([0.5]), GHZ)
    assert 13 < one_edge[1][0] < 19
    assert 0.02 < one_edge[0][0] < 0.04
    assert 0.015 < np.median(made.range_m - base.range_m) < 0.05
    assert 5 < np.median(base.rx_power_dbm - made.rx_power_dbm) < 19  # both edges add up


def test_a_body_near_one_end_loses_more_and_delays_more() -> None:
    excess, loss = knife_edge(np.array([4.0]), np.array([0.2]), np.array([0.025]), GHZ)
    assert 22 < loss[0] < 26
    assert 0.11 < excess[0] < 0.15


def test_diffraction_leaves_line_of_sight_alone() -> None:
    frame = line(64, los=[bool(row % 2) for row in range(64)])
    made, base = change(frame, Diffraction())
    np.testing.assert_array_equal((made.range_m - base.range_m)[1::2], 0)
    np.testing.assert_array_equal(made.cir[1::2], base.cir[1::2])
    np.testing.assert_array_equal(
        Diffraction().inert(Base().paths(scene(frame))), frame["los"].to_numpy()
    )


def test_metal_whose_edges_nobody_lists_is_gone_around_as_a_body_is() -> None:
    listed = line(64, obstacles=[["metal"]] * 64)
    body = line(64, los=[False] * 64)
    around, of_body = (change(one, Diffraction(body_half_width_m=0.23)) for one in (listed, body))
    moved = [np.median(made.range_m - base.range_m) for made, base in (around, of_body)]
    assert moved[1] > 0.015
    assert abs(moved[0] - moved[1]) < 0.01


def test_metal_is_gone_around_and_wood_is_gone_through() -> None:
    def behind(kind: str) -> np.ndarray:
        frame = line(
            64,
            obstacles=[[kind]] * 64,
            obstacle_clearance_m=[[0.4]] * 64,
            obstacle_far_clearance_m=[[0.6]] * 64,
        ).assign(true_range_m=3.0)
        made, _ = change(frame, MaterialDelay(), Diffraction())
        return np.subtract(made.range_m, seen(frame).range_m)

    around = 2 * np.hypot(1.5, 0.4) - 3
    assert abs(np.median(behind("metal plate")) - around) < 0.06
    assert np.median(behind("wood door")) < 0.04


def test_reflections_arrive_where_the_images_are() -> None:
    frame = room(64).assign(
        tx_x_m=1.0, tx_y_m=2.0, tx_z_m=1.4, rx_x_m=4.0, rx_y_m=2.0, rx_z_m=1.4, true_range_m=3.0
    )
    effect = SpecularReflections(walls="metal", floor="foam", ceiling="foam", highest_order=1)
    made = seen(frame, effect)
    profile = np.median(made.cir, axis=0)
    direct = np.median(made.first_path_index) + 1.25
    wall = (np.hypot(3, 4) - 3) * NS  # off y = 0 and y = 4 alike: 5 m instead of 3
    end = (5 - 3) * NS  # off x = 0: 1 + 4 m
    for delay in (wall, end):
        at = round(direct + delay / 1.0016)
        assert profile[at - 1 : at + 2].max() > 0.25 * profile.max()
    assert profile[120:].max() < 0.01 * profile.max()


def test_reflections_of_unknown_rooms_come_from_two_walls() -> None:
    frame = line(64, far_m=4.0)
    made, base = change(frame, SpecularReflections(wall_m=4.0, walls="concrete"))
    assert np.all(made.cir[:, 20:60].max(axis=1) > 5 * base.cir[:, 20:60].max(axis=1))
    none = seen(frame, SpecularReflections(wall_m=0.0))
    np.testing.assert_array_equal(none.cir, base.cir)


@pytest.mark.parametrize(("moved_m", "alike"), [(0.0, True), (0.03, False)])
def test_reflections_keep_their_phase_within_a_link_that_does_not_move(
    moved_m: float, alike: bool
) -> None:
    """Positions are known to centimetres: phases differ between links, and where rows move."""
    effect = SpecularReflections(wall_m=0.4, walls="metal", moved_m=moved_m)
    frame = line(256).assign(true_range_m=4.0)
    level = seen(frame, effect).rx_power_dbm.reshape(-1, 4)
    within, between = np.median(level.std(axis=1)), level.mean(axis=1).std()
    assert between > 0.5
    assert bool(within < 0.2 * between) is alike


def test_surfaces_of_a_link_reflect_each_as_it_does() -> None:
    alike, own = (
        seen(line(256, far_m=4.0), SpecularReflections(wall_m=4.0, spread_db=db)).cir[:, 20:60]
        for db in (0.0, 8.0)
    )
    spread = [20 * np.log10(one.max(axis=1)).std() for one in (alike, own)]
    assert spread[1] > spread[0] + 2


def test_ground_bounce_is_the_two_ray_model() -> None:
    batch = Base().paths(scene(line(64, tx_z_m=1.0, rx_z_m=2.0)))
    made = GroundBounce().apply(batch, Draws(0, 0, "x", 0))
    truth = batch.rows.true_range_m
    flat = np.sqrt(truth**2 - 1.0)  # horizontal distance
    with np.errstate(invalid="ignore"):
        expected = np.sqrt(flat**2 + 9) - np.sqrt(flat**2 + 1)
    np.testing.assert_allclose(made.excess_ns[1:, 1], expected[1:] * NS, rtol=1e-5)
    assert made.excess_ns[-1, 1] < made.excess_ns[10, 1] / 2  # falls with distance


def test_ground_bounce_ripples_power_and_is_the_floor_of_a_room_once() -> None:
    frame = line(512, far_m=40.0)
    made, base = change(frame, GroundBounce())
    ripple = (made.rx_power_dbm - base.rx_power_dbm)[256:]
    assert ripple.max() > 0.5
    assert ripple.min() < -0.5
    shift = made.range_m - base.range_m
    assert shift.max() > 0.005
    assert shift.min() < -0.005
    inside, without = change(room(), GroundBounce())
    assert not np.array_equal(inside.cir, without.cir)
    both, walls = change(room(), SpecularReflections(), GroundBounce())
    np.testing.assert_array_equal(both.cir, walls.cir)


def test_a_floor_seen_from_uncertain_heights_turns_the_carrier_of_every_link() -> None:
    frame = line(64, tx_z_m=1.0, rx_z_m=2.0, link=[f"l{i // 2}" for i in range(64)])
    batch = Base().paths(scene(frame))
    sure, unsure = (
        GroundBounce(placed_m=size).apply(batch, Draws(0, 0, "x", 0)).gain[:, 1]
        for size in (0.0, 0.02)
    )
    turned = np.angle(unsure[2:] / sure[2:])
    np.testing.assert_allclose(np.abs(unsure), np.abs(sure), rtol=1e-5)
    np.testing.assert_allclose(turned[::2], turned[1::2], atol=0.2)  # heights are of links
    assert turned.std() > 0.2


def _bounced(**values: float) -> np.ndarray:
    frame = line(64, tx_z_m=1.0, rx_z_m=2.0, link=[f"l{i // 2}" for i in range(64)])
    batch = Base().paths(scene(frame))
    return GroundBounce(**values).apply(batch, Draws(0, 0, "x", 0)).gain[2:, 1]


def test_no_two_links_see_ground_that_is_alike() -> None:
    plain, larger, rough = (_bounced(), _bounced(spread_db=6.0), _bounced(rough=0.7))
    by = larger / plain
    np.testing.assert_allclose(by.imag, 0, atol=1e-4)  # what differs in size alone is not turned
    np.testing.assert_allclose(by[::2], by[1::2], rtol=1e-4)  # of links
    assert 3 < (20 * np.log10(np.abs(by))).std() < 9
    assert 0.4 < np.abs(rough / plain - 1).std() + np.abs(rough / plain - 1).mean() < 1.4
    assert np.angle(rough / plain).std() > 0.2


def test_upright_fields_are_turned_around_past_brewsters_angle_and_water_reflects_when_steep() -> (
    None
):
    level, upright, wet = _bounced(), _bounced(upright=1.0), _bounced(wet=1.0)
    turned = (upright / level).real
    assert turned[0] < 0 < turned[-1]  # steep where ends are near, grazing far off
    share = np.abs(wet / level)
    assert share[0] > 1.5
    assert share[0] > share[-1] > 1.0
    half = _bounced(upright=0.5)
    np.testing.assert_allclose(half, (level + upright) / 2, rtol=1e-4, atol=1e-9)


def test_tail_decays_as_asked_and_has_the_level_asked_for() -> None:
    frame = line(4096, far_m=2.0)
    effect = DiffuseTail(
        level_db=0, distance_exponent=0, ray_decay_ns=20, cluster_rate=0.001, cluster_sigma_db=0
    )
    made, base = change(frame, effect)
    profile = np.log(np.mean(made.cir.astype(float) ** 2, axis=0))
    slope = np.polyfit(np.arange(20, 80) * 1.0016, profile[20:80], 1)[0]
    assert abs(-1 / slope - 20) < 1.5
    extra = np.mean(10 ** (made.rx_power_dbm / 10)) - np.mean(10 ** (base.rx_power_dbm / 10))
    assert abs(10 * np.log10(extra) - (-14.3 - 44.5)) < 0.5
    assert (
        np.abs(np.median(made.cir[:, :3], axis=0)).max() < 400
    )  # nothing before the straight line


def test_tail_is_kept_within_a_link_as_far_as_it_is_static() -> None:
    frame = line(512, far_m=2.0).assign(true_range_m=2.0)

    def likeness(static: float) -> float:
        made = seen(frame, DiffuseTail(level_db=0, static=static), complex_cir=True)
        assert made.cir_complex is not None
        taps = (
            made.cir_complex[:, 20:60] / np.linalg.norm(made.cir_complex[:, 20:60], axis=1)[:, None]
        )
        return float(np.abs(np.mean(np.sum(taps[0::4] * taps[1::4].conj(), axis=1))))

    assert likeness(0.0) < 0.15
    assert likeness(1.0) > 0.5


def test_bigger_rooms_ring_longer_and_the_open_hardly() -> None:
    small, big = room(1024, (3.0, 3.0, 2.5)), room(1024, (12.0, 10.0, 4.0))
    effect = DiffuseTail(level_db=-6)

    def late_share(frame) -> float:
        cir = seen(frame, effect).cir.astype(float) ** 2
        return float(np.median(cir[:, 40:100].sum(axis=1) / cir.sum(axis=1)))

    open_air = small.assign(room_x_m=np.nan, room_y_m=np.nan, room_z_m=np.nan)
    assert late_share(big) > 3 * late_share(small)
    assert late_share(open_air) < 0.5 * late_share(small)


def test_path_loss_has_its_exponent_and_shadowing_is_of_the_link() -> None:
    frame = line(1024, far_m=40.0)
    made = seen(frame, PathLoss(exponent=3.0))
    slope = np.polyfit(10 * np.log10(frame["true_range_m"]), made.rx_power_dbm, 1)[0]
    assert abs(slope + 3) < 0.1
    shaded, base = change(frame, PathLoss(shadowing_db=4.0), cir=False)
    drop = shaded.rx_power_dbm - base.rx_power_dbm
    np.testing.assert_allclose(drop[0::4], drop[3::4], atol=1e-5)
    assert abs(drop.std() - 4) < 0.6
    np.testing.assert_array_equal(shaded.range_m, base.range_m)
    leaves, base = change(frame, PathLoss(per_metre_db=0.3), cir=False)
    lost = base.rx_power_dbm - leaves.rx_power_dbm
    np.testing.assert_allclose(lost, 0.3 * frame["true_range_m"], atol=1e-3)


def test_fading_keeps_the_mean_power_and_spreads_it() -> None:
    frame = line(4096).assign(true_range_m=3.0)
    made, base = change(frame, SmallScaleFading(direct_m=3.0))
    power = 10 ** ((made.rx_power_dbm - base.rx_power_dbm) / 10)
    assert abs(power.mean() - 1) < 0.04
    assert abs(power.var() - 1 / 3) < 0.05


def test_a_blocked_path_reads_metres_long_with_nothing_before_it() -> None:
    frame = line(2048, far_m=5.0, los=[bool(row // 4 % 2) for row in range(2048)])
    made, base = change(frame, BlockedPath(share=0.5, detour_m=2.0))
    shift = made.range_m - base.range_m
    np.testing.assert_array_equal(shift[frame["los"]], 0)  # line of sight: never
    blocked = shift[~frame["los"].to_numpy()]
    struck = blocked > 0.01
    assert 0.35 < struck.mean() < 0.65
    assert abs(blocked[struck].mean() - 2.0) < 0.4
    assert blocked.min() > -0.02
    early = made.cir[:, :3].max(axis=1) / made.cir.max(axis=1)
    assert early.max() < 0.1
    links = shift.reshape(-1, 4)
    assert np.abs(links - links.mean(axis=1, keepdims=True)).max() < 0.05  # jumps with geometry


def test_fades_may_take_more_than_peaks_give() -> None:
    made, base = change(line(4000), SmallScaleFading(direct_m=2.0, deeper=1.5), cir=False)
    plain, _ = change(line(4000), SmallScaleFading(direct_m=2.0), cir=False)
    shift = np.mean(plain.rx_power_dbm) - np.mean(made.rx_power_dbm)
    assert abs(shift - 1.5 * scatter_db(2.0)) < 0.4
    assert abs(np.std(made.rx_power_dbm - base.rx_power_dbm) - scatter_db(2.0)) < 0.3
    none, base = change(line(200), SmallScaleFading(1000, 1000, 1000, deeper=3.0), cir=False)
    np.testing.assert_allclose(none.rx_power_dbm, base.rx_power_dbm)


def test_tails_decay_more_slowly_where_links_and_rooms_are_larger_as_far_as_asked() -> None:
    """Greenstein et al. 1997: delay spreads grow with the distance."""
    frame = line(1024, far_m=16.0)
    far = frame["true_range_m"] > 8

    def longer(effect: DiffuseTail, of: pd.DataFrame, one: pd.Series) -> float:
        power = np.abs(seen(of, effect).cir.astype(float)) ** 2
        late = power[:, 60:].sum(axis=1) / power[:, 10:60].sum(axis=1)
        return float(np.median(late[one]) / np.median(late[~one]))

    plain = {"level_db": 2.0, "distance_exponent": 2.0}
    grown = longer(DiffuseTail(delay_exponent=0.6, **plain), frame, far)
    assert grown > 2 * longer(DiffuseTail(**plain), frame, far)
    rooms = frame.assign(true_range_m=5.0, room_y_m=5.0, room_z_m=3.0)
    rooms["room_x_m"] = np.where(far, 40.0, 4.0)
    follows, not_at_all = (longer(DiffuseTail(room_scaling=s, **plain), rooms, far) for s in (1, 0))
    assert follows > 1.5
    assert 0.7 < not_at_all < 1.4
