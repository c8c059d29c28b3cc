"""A reflection of the ground is told by how it goes up and down, whatever smooth part it has."""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace

import numpy as np
import pandas as pd

from bench.discrepancy.sets.own_form import others_may
from bench.physics.base import Base
from bench.physics.effects.fitted.ground_ray import GroundRay
from bench.physics.effects.propagation.ground_bounce import LEAST_RIPPLE, GroundBounce
from bench.physics.effects.propagation.two_rays import goes_up_and_down
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from tests.bench.discrepancy.sets.test_same_rows import LINKS, ROWS, names_of, rows_of


@cache
def low_and_near() -> pd.DataFrame:
    """Return rows of low antennas up to 15 m apart, where two rays hardly turn."""
    rng, link = np.random.default_rng(7), np.repeat(np.arange(LINKS), ROWS)
    far = rng.uniform(4, 15, LINKS)[link]
    high = {"tx_z_m": rng.uniform(0.6, 2.5, LINKS), "rx_z_m": rng.uniform(1, 2.5, LINKS)}
    return rows_of(5).assign(true_range_m=far, **{n: one[link] for n, one in high.items()})


def pull_m() -> np.ndarray:
    """Return what a reflection does to the ranges of these rows [n], in metres."""
    rows, ray = scene(low_and_near(), "recorded"), GroundRay(size=0.6, reach_m=0.7)
    made, bare = (Simulator(Base(), some, 0).observe(rows, 0, cir=False) for some in ((ray,), ()))
    assert made.range_m is not None
    assert bare.range_m is not None
    return np.asarray(made.range_m - bare.range_m)


def test_a_reflection_that_is_mostly_smooth_is_one_where_its_ripple_is_sure() -> None:
    pull = pull_m()
    assert goes_up_and_down(scene(low_and_near(), "recorded"), pull) < LEAST_RIPPLE
    assert names_of(low_and_near(), pull) == {"ground-bounce"}


def test_what_is_smooth_alone_is_none() -> None:
    curve = 0.15 * np.log(low_and_near()["true_range_m"].to_numpy() / 8)
    assert "ground-bounce" not in names_of(low_and_near(), curve)


def test_others_may_not_do_what_physics_forbids_but_what_is_little() -> None:
    rows, pull = scene(low_and_near(), "recorded"), pull_m()
    far = rows.true_range_m - rows.true_range_m.mean()
    made = {("ground-bounce", "range-scale"): pull, ("ground-bounce",): pull + 0.1 * far}
    contest = SimpleNamespace(
        kinds={"ground-bounce": GroundBounce},
        rows=SimpleNamespace(scene=rows),
        shifts=lambda causes: {"ground-bounce": made[causes]},
    )
    both = ("ground-bounce", "range-scale")
    assert not others_may(contest, both, "range-scale")  # type: ignore[arg-type]
    made["ground-bounce",] = pull + 1e-3 * far
    assert others_may(contest, both, "range-scale")  # type: ignore[arg-type]
