"""Power at the delays of a link's own walls is a mark of reflections; a tail leaves none."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.data.observables import Window
from bench.discrepancy.select import marks
from bench.physics import Simulator
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.mirrored import mirrored, wall_delays_ns
from bench.physics.effects.propagation.specular import SpecularReflections

LINKS, SAMPLES, FIRST = 40, 150, 12


def rooms(echo: float, tail: float, of_others: bool = False) -> pd.DataFrame:
    """Return rows with magnitudes made by numpy: a pulse, echoes of walls, a tail and noise."""
    rng = np.random.default_rng(4)
    room = rng.uniform([7, 5, 2.6], [15, 11, 4], (LINKS, 3))
    ends = rng.uniform(0.4, room - 0.4, (2, LINKS, 3))
    frame = pd.DataFrame({"link": [f"l{i}" for i in range(LINKS)], "first_path_index": FIRST - 1.2})
    for name, place in (("tx", ends[0]), ("rx", ends[1]), ("room", room)):
        for axis, column in zip("xyz", place.T, strict=True):
            frame[f"{name}_{axis}_m"] = column
    late = wall_delays_ns(frame)
    late = late[rng.permutation(LINKS)] if of_others else late
    grid, start = np.arange(SAMPLES), FIRST + rng.uniform(-0.4, 0.4, (LINKS, 1))
    parts = rng.normal(size=(2, LINKS, SAMPLES))
    cir = 30 * (parts[0] + 1j * parts[1]) + 6000 * np.exp(-((grid - start) ** 2) / 2.2)
    for column in late.T:
        turn = np.exp(2j * np.pi * rng.random((LINKS, 1)))
        cir = cir + 6000 * echo * turn * np.exp(-((grid - start - column[:, None]) ** 2) / 2.2)
    fall = np.exp(-np.maximum(grid - start, 0) / 40) * (grid > start)
    cir = cir + 6000 * tail * fall * (parts[1] - 1j * parts[0])
    return frame.assign(cir=list(np.abs(cir).astype(np.float32)))


@pytest.mark.parametrize(
    ("echo", "tail", "others", "seen"),
    [
        (0.15, 0.0, False, True),
        (0.3, 0.05, False, True),
        (0.0, 0.1, False, False),
        (0.15, 0.0, True, False),
        (0.0, 0.0, False, False),
    ],
)
def test_only_echoes_of_a_links_own_walls_are_a_mark(
    echo: float, tail: float, others: bool, seen: bool
) -> None:
    frame = rooms(echo, tail, others)
    assert mirrored(frame) is seen
    assert bool(SpecularReflections.by_mark(frame)) is seen


def test_a_faint_hint_of_reflections_in_another_table_is_enough_to_make_no_news_of_them() -> None:
    faint = rooms(0.008, 0.0)
    assert not mirrored(faint)
    assert SpecularReflections.hinted(faint)
    assert not SpecularReflections.hinted(rooms(0.0, 0.1))


def test_without_rooms_nothing_is_said() -> None:
    assert not mirrored(rooms(0.15, 0.0).drop(columns="room_x_m"))
    assert not mirrored(rooms(0.15, 0.0).iloc[:6])


def test_a_simulator_that_has_reflections_already_makes_no_mark_of_them() -> None:
    class Some:
        comparison = Resimulation(Simulator(effects=(SpecularReflections(),)), Window())

    class Without:
        comparison = Resimulation(Simulator(effects=(DiffuseTail(),)), Window())

    assert marks._simulated(Some, SpecularReflections)  # type: ignore[arg-type]
    assert not marks._simulated(Without, SpecularReflections)  # type: ignore[arg-type]
