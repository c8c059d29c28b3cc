"""Links whose straight path is weak, and ranged all the same, are obstructed."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from test_wave_strikes import LINKS, found_in, recordings

from bench.discrepancy.data.observables import profile_ns
from bench.discrepancy.joint.witness import first_db, weak_first
from bench.physics.effects.propagation.obstructed_path import ObstructedPath

NAMES = ("rx_power_dbm", "profile_db[-1.5..1.5ns]", "profile_db[6.5..10.5ns]",
         "profile_db[10.5..15.5ns]")  # fmt: skip
STRUCK = np.arange(100) < 30


def found_with(first: np.ndarray, all_db: float = 0.0) -> Any:
    """Return links whose first paths are off by `first` [L], and everything by `all_db`."""
    rng = np.random.default_rng(0)
    left, *others = rng.normal(0, 1.5, (5, 100, 4))
    left += all_db
    left[:, 1] += first
    given = SimpleNamespace(names=NAMES, others=lambda _: others)
    mixture = SimpleNamespace(given=given, bare=SimpleNamespace(left=left), beside=())
    return SimpleNamespace(mixture=mixture, struck=STRUCK)


def test_bins_of_a_profile_are_told_by_their_names() -> None:
    assert profile_ns("profile_db[-1.5..1.5ns]") == (-1.5, 1.5)
    assert profile_ns("rx_power_dbm") is None


def test_first_paths_that_are_weak_beside_later_ones_are_seen() -> None:
    found = found_with(np.where(STRUCK, -9.0, 0.0), -3.0)
    assert weak_first(found)
    assert np.median(first_db(NAMES, found.mixture.bare.left)[STRUCK]) == pytest.approx(-9, abs=1.0)


def test_what_weakens_all_that_arrives_is_none() -> None:
    found = found_with(np.zeros(100))
    found.mixture.bare.left[STRUCK] -= 9.0
    assert not weak_first(found)


@pytest.mark.parametrize("seed", range(8))
def test_the_weaker_third_of_links_that_fade_is_no_sort_of_its_own(seed: int) -> None:
    power = np.sort(np.random.default_rng(seed).exponential(size=100))
    assert not weak_first(found_with(10 * np.log10(power)))


def test_without_later_samples_nothing_is_seen() -> None:
    found = found_with(np.where(STRUCK, -9.0, 0.0))
    found.mixture.given.names = NAMES[:2]
    found.mixture.bare.left = found.mixture.bare.left[:, :2]
    assert not weak_first(found)


def test_an_obstruction_that_leaves_ranges_as_they_are_is_found() -> None:
    weak = ObstructedPath(
        share=0.3, loss_db=11.0, loss_spread_db=1.0, common=0.0, delay_m=0.0, detour_m=0.0
    )
    made = found_in(recordings((weak,)))
    assert made is not None
    assert isinstance(made.effect, ObstructedPath)
    assert not any(one.effect.silent_before for one in made.others)
    assert 0.15 * LINKS < len(made.struck) < 0.5 * LINKS
