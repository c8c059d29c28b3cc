"""Tables without rows alike: the message names what keeps them apart."""

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.shared import behind_more, far_apart, in_reach, no_overlap, unseen


def test_only_what_keeps_links_apart_is_named() -> None:
    far = np.array([[True, True, False, False], [False] * 4, [True] * 4])
    words = no_overlap(("true_range_m", "tx_z_m", "room_x_m"), far, np.zeros(4, bool))
    assert "room_x_m (100 % of the links), true_range_m (50 % of the links)" in words
    assert "tx_z_m" not in words


def test_categories_that_no_simulated_link_has_are_named() -> None:
    words = no_overlap(("tx_z_m",), np.zeros((1, 4), bool), np.array([True, True, True, False]))
    assert "of their category (75 %)" in words
    assert "tx_z_m" not in words


@pytest.mark.parametrize(("higher_m", "apart"), [(0.4, False), (0.8, True)])
def test_devices_that_all_hang_a_little_higher_have_counterparts(
    higher_m: float, apart: bool
) -> None:
    far = np.linspace(2, 50, 60)
    ours = pd.DataFrame({"true_range_m": far, "rx_z_m": np.where(far > 25, 3.0, 3.1)})
    theirs = ours.assign(rx_z_m=ours["rx_z_m"] + higher_m)
    both = in_reach(ours, theirs)
    found = far_apart(both.names, both.left, both.right)
    assert bool(found.any()) is apart


def _behind(*many: int) -> pd.DataFrame:
    """Return one row of each link behind so many walls."""
    walls = [["brick"] * count for count in many]
    return pd.DataFrame({"link": [f"l{n}" for n in range(len(many))], "obstacles": walls})


def test_behind_more_walls_than_two_simulated_links_are_there_is_no_counterpart() -> None:
    """One simulated link behind three walls stood for four recorded ones, and they differed."""
    recorded = _behind(0, 1, 2, 3, 3)
    for simulated, lone in ((_behind(0, 1, 1, 2, 3), 2), (_behind(0, 1, 2, 3, 4), 0)):
        assert behind_more(recorded, simulated).sum() == lone
        assert ("3 obstacles or more in two links (2 rows)" in unseen(recorded, simulated)) == (
            lone > 0
        )
    assert not behind_more(_behind(0, 1, 1), _behind(0, 0, 0)).any()
