"""Effects on levels must predict better than what levels do for other reasons."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.discrepancy.select.second_level import predicts
from bench.physics.effects.propagation.two_rays import fading_db, fading_ways, pulling_ways, rays
from bench.physics.scene import scene

LINKS, ROWS = 40, 10


def _made():
    rng = np.random.default_rng(4)
    far = rng.uniform(5, 60, LINKS * ROWS)
    heading = rng.uniform(-np.pi, np.pi, LINKS * ROWS)
    return rng, far, heading, np.repeat(np.arange(LINKS), ROWS)


def test_a_gain_over_headings_is_no_path_loss_and_a_slope_is_one() -> None:
    rng, far, heading, links = _made()
    gain = 2 * np.cos(heading) + rng.normal(size=len(far))
    slope = -10 * np.log10(far / 20)
    waves = np.stack([np.ones(len(far)), np.cos(heading), np.sin(heading)], axis=1)
    assert not predicts(gain, slope, waves, links)
    assert predicts(gain + 0.5 * slope, slope, waves, links)


def test_what_every_link_keeps_for_itself_is_no_slope() -> None:
    rng, far, _, links = _made()
    shadowing = rng.normal(size=LINKS)[links] * 3
    slope = -10 * np.log10(np.repeat(far[::ROWS], ROWS) / 20)
    assert not predicts(shadowing, slope, np.ones((len(far), 1)), links)


def _heights(far, channel=None) -> pd.DataFrame:
    frame = pd.DataFrame({"true_range_m": far, "tx_z_m": 1.8, "rx_z_m": 2.4})
    return frame if channel is None else frame.assign(channel=channel)


def test_two_ray_fading_is_a_sum_of_its_ways() -> None:
    _, far, _, _ = _made()
    rows = scene(_heights(far, 5), "recorded")
    found = rays(rows)
    assert found is not None
    fading = fading_db(found.ray(6.4896, 0.3, 0.0))
    ways = np.column_stack([fading_ways(rows), np.ones(len(far))])
    left = fading - ways @ np.linalg.lstsq(ways, fading, rcond=None)[0]
    assert np.std(left) < 0.25 * np.std(fading)


def test_without_heights_nothing_is_reflected() -> None:
    _, far, _, _ = _made()
    rows = scene(_heights(far).drop(columns="tx_z_m"), "recorded")
    assert rays(rows) is None
    assert fading_ways(rows).shape[1] == 0
    assert pulling_ways(rows) is None


def test_carriers_are_those_of_the_channel_or_all() -> None:
    _, far, _, _ = _made()
    told, untold = (scene(_heights(far, channel), "recorded") for channel in (5, None))
    assert len(pulling_ways(told) or ()) == 1
    assert len(pulling_ways(untold) or ()) == 4
