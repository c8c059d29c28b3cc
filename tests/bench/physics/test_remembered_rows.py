"""What follows from rows alone is worked out once, and is the same as anew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.physics.memory import Memory
from bench.physics.room_geometry import room_geometry
from bench.physics.rooms import Rooms
from bench.physics.scene import scene

ROWS = scene(room_geometry(np.random.default_rng(0), 60))


def test_the_same_rows_are_the_same_object():
    assert ROWS.slice(0, 60) is ROWS
    assert ROWS.slice(0, 1024) is ROWS
    part = ROWS.slice(5, 20)
    assert part is ROWS.slice(5, 20)
    assert part is not ROWS.slice(5, 21)
    np.testing.assert_array_equal(part.true_range_m, ROWS.true_range_m[5:20])


def test_rows_that_were_simulated_before_give_what_new_ones_do():
    simulator = Rooms().simulator
    for effect in simulator.effects:
        simulator.with_effect(effect).observe(ROWS, 1)
    fresh = replace(ROWS, parts=Memory(4), known=Memory(6))
    again, anew = simulator.observe(ROWS, 2), simulator.observe(fresh, 2)
    assert again.cir is not None
    np.testing.assert_array_equal(again.cir, anew.cir)
    np.testing.assert_array_equal(again.range_m, anew.range_m)


def test_an_effect_with_other_parameters_is_not_the_remembered_one():
    simulator = Rooms().simulator
    before = simulator.observe(ROWS, 1).range_m
    for name, values in (
        ("material-delay", {"thickness_scale": 2.0}),
        ("diffraction", {"clearance_scale": 0.3}),
        ("specular-reflections", {"highest_order": 1}),
    ):
        effect = next(e for e in simulator.effects if e.name == name)
        other = simulator.with_effect(replace(effect, **values)).observe(ROWS, 1)
        fresh = replace(ROWS, parts=Memory(4), known=Memory(6))
        anew = simulator.with_effect(replace(effect, **values)).observe(fresh, 1)
        np.testing.assert_array_equal(other.range_m, anew.range_m)
        np.testing.assert_array_equal(other.cir, anew.cir)
    np.testing.assert_array_equal(simulator.observe(ROWS, 1).range_m, before)
