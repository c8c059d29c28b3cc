import numpy as np
import pytest
from physics_scenes import room

from bench.errors import BenchError
from bench.physics.images import image_paths, orders
from bench.physics.materials import (
    WATER,
    excess_m,
    is_object,
    is_opaque,
    loss_db,
    material,
    obstacle,
    reflection,
    upright_reflection,
)
from bench.physics.scene import scene
from bench.physics.slabs import of_kind, opaque, slabs

GHZ = 3.9936
NORMAL = np.zeros(1)


@pytest.mark.parametrize(
    ("name", "cm"),
    [("concrete", 12.9), ("brick", 9.8), ("plasterboard", 6.5), ("wood", 4.1), ("glass", 15.1)],
)
def test_excess_path_of_ten_centimetres(name: str, cm: float) -> None:
    made = excess_m(np.array([0.1]), material(name).permittivity(GHZ), NORMAL)
    assert abs(made[0] * 100 - cm) < 0.06


def test_oblique_slabs_follow_the_formula_and_foam_adds_almost_nothing() -> None:
    theta = np.radians([0.0, 30.0, 60.0])
    made = excess_m(np.full(3, 0.2), 4.0 + 0j, theta)
    np.testing.assert_allclose(made, 0.2 * (np.sqrt(4 - np.sin(theta) ** 2) - np.cos(theta)))
    assert excess_m(np.array([0.1]), material("foam").permittivity(GHZ), NORMAL)[0] < 0.003


@pytest.mark.parametrize(("name", "db"), [("concrete", -8), ("glass", -7), ("plasterboard", -12)])
def test_reflection_at_normal_incidence(name: str, db: float) -> None:
    made = reflection(material(name).permittivity(GHZ), NORMAL)
    assert abs(20 * np.log10(np.abs(made[0])) - db) < 0.8


def test_metal_reflects_all_and_isolates() -> None:
    metal = material("metal").permittivity(GHZ)
    assert abs(np.abs(reflection(metal, NORMAL)[0]) - 1) < 0.01
    assert loss_db(np.array([0.002]), metal, NORMAL, GHZ)[0] == 60.0


def test_loss_grows_with_thickness_and_no_slab_loses_nothing() -> None:
    brick = material("brick").permittivity(GHZ)
    loss = loss_db(np.array([0.0, 0.1, 0.2, 0.4]), brick, NORMAL, GHZ)
    assert loss[0] == 0
    # Attenuation of a good dielectric: 1636 sigma / sqrt(eps) dB per metre.
    sigma = 0.0238 * GHZ**0.16
    np.testing.assert_allclose(
        np.diff(loss)[1:] / [0.1, 0.2], 1636 * sigma / np.sqrt(3.91), rtol=0.02
    )


def test_unknown_material_is_named_and_unknown_obstacle_is_a_panel() -> None:
    with pytest.raises(BenchError, match="did you mean 'plywood'"):
        material("plywod")
    assert obstacle("sofa").material == "chipboard"


def test_an_obstacle_may_be_named_by_its_material() -> None:
    named = {"concrete": "concrete", "Brick wall": "brick", "plywood": "plywood", "wood": "wood"}
    assert {kind: obstacle(kind).material for kind in named} == named
    assert obstacle("wall").material == "brick"  # a kind of its own


def test_nothing_goes_through_metal_and_bodies_and_of_objects_nobody_knows() -> None:
    kinds = ("metal plate", "two persons", "a worker", "brick wall", "plywood", "crate", "curtain")
    assert [is_opaque(kind) for kind in kinds] == [True, True, True, False, False, False, False]
    assert [is_object(kind) for kind in kinds] == [False, False, False, False, False, True, False]


def test_slabs_take_thickness_of_the_rows_else_of_the_kind() -> None:
    frame = room(8).assign(obstacles=[["wall", "metal plate"]] * 8)
    rows = scene(frame)
    delay, loss = slabs(rows, GHZ)
    assert abs(delay[0, 0] - 0.14 * (np.sqrt(3.91) - 1)) < 1e-3
    assert loss[0, 1] == 60
    np.testing.assert_array_equal(opaque(rows)[0], [False, True])
    np.testing.assert_array_equal(of_kind(rows, "wall")[0], [True, False])
    assert not of_kind(rows, "sofa").any()
    thick = scene(frame.assign(obstacle_thickness_m=[[0.28, 0.01]] * 8))
    np.testing.assert_allclose(slabs(thick, GHZ)[0][:, 0], 2 * delay[:, 0])


def test_images_are_the_mirror_images_of_the_room() -> None:
    size, tx, rx = np.array([5.0, 4.0, 3.0]), np.array([1.0, 1.5, 1.2]), np.array([3.9, 2.0, 1.7])
    walls = ("concrete", "concrete", "concrete")
    length, factor = image_paths(tx[None], rx[None], size[None], 2, walls, GHZ)
    assert length.shape == (1, 24)
    first = [
        np.linalg.norm(np.where(np.arange(3) == axis, 2 * wall * size - tx, tx) - rx)
        for axis in range(3)
        for wall in (0, 1)
    ]
    np.testing.assert_allclose(np.sort(length[0, :6]), np.sort(first))
    twice = orders(2).tolist().index([2, 0, 0])  # off x = 0, then off x = 5: 10 m further
    source = tx + np.array([10.0, 0, 0])
    np.testing.assert_allclose(length[0, twice], np.linalg.norm(source - rx))
    angle = np.arccos(abs(source[0] - rx[0]) / np.linalg.norm(source - rx))
    expected = reflection(material("concrete").permittivity(GHZ), np.array([angle]))[0] ** 2
    assert abs(factor[0, twice] - expected) < 2e-3


def test_floor_and_ceiling_have_their_own_materials() -> None:
    size, tx, rx = np.array([[5.0, 4.0, 3.0]]), np.array([[1.0, 2, 1.0]]), np.array([[4.0, 2, 1.0]])
    length, factor = image_paths(tx, rx, size, 1, ("foam", "metal", "foam"), GHZ)
    floor = orders(1).tolist().index([0, 0, -1])
    assert abs(length[0, floor] - np.hypot(3, 2)) < 1e-9
    assert np.abs(factor[0, floor]) > 0.99
    assert np.delete(np.abs(factor[0]), floor).max() < 0.2


def test_upright_fields_are_not_returned_at_brewsters_angle() -> None:
    brewster = np.arctan(np.sqrt(4.0))
    angles = np.array([0.0, brewster, np.pi / 2 - 1e-6])
    steep, none, grazing = upright_reflection(4.0 + 0j, angles)
    np.testing.assert_allclose([steep, none, grazing], [1 / 3, 0, -1], atol=1e-4)
    np.testing.assert_allclose(steep, -reflection(4.0 + 0j, angles)[0])


def test_water_relaxes_as_debye_says() -> None:
    for ghz in (3.5, 4.5, 6.5, 8.0):
        debye = 5.2 + 74.9 / (1 + 1j * ghz / 17.1)
        assert abs(WATER.permittivity(ghz) - debye) < 3.5
