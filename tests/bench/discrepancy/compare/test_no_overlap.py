"""Tables without rows alike: the message names what keeps them apart."""

import numpy as np

from bench.discrepancy.compare.shared import no_overlap


def test_only_what_keeps_links_apart_is_named() -> None:
    far = np.array([[True, True, False, False], [False] * 4, [True] * 4])
    words = no_overlap(("true_range_m", "tx_z_m", "room_x_m"), far, np.zeros(4, bool))
    assert "room_x_m (100 % of the links), true_range_m (50 % of the links)" in words
    assert "tx_z_m" not in words


def test_categories_that_no_simulated_link_has_are_named() -> None:
    words = no_overlap(("tx_z_m",), np.zeros((1, 4), bool), np.array([True, True, True, False]))
    assert "of their category (75 %)" in words
    assert "tx_z_m" not in words
