"""What draws every link anew leaves its rows alike; fading does not."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.select.adequacy import link_by_link, row_by_row
from bench.discrepancy.select.within_links import as_loud, of_links, rows_per_link
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.ranging.antenna_delay import AntennaDelay

LINKS, ROWS, MEMBERS = 40, 2, 6
LINK = np.repeat(np.arange(LINKS), ROWS)


def levels(of_link_db: float, of_row_db: float, fitted_db: float = 0.0) -> Ensemble:
    """Return levels, recorded with a scatter over links and one over rows, simulated without.

    `fitted_db` is what an effect takes off the simulated ones.
    """
    rng = np.random.default_rng(3)
    versions = rng.normal(0, 0.5, (1 + MEMBERS, LINKS * ROWS, 1))
    versions[0, :, 0] += of_link_db * rng.normal(size=LINKS)[LINK]
    versions[0, :, 0] += of_row_db * rng.normal(size=LINKS * ROWS) - 6
    versions[1:] -= fitted_db
    return Ensemble(("rx_power_dbm",), ("dB",), versions, LINK)


def test_the_share_of_a_mismatch_that_links_keep() -> None:
    assert of_links(levels(5, 0), "rx_power_dbm")[0] > 0.9
    assert of_links(levels(0, 5), "rx_power_dbm")[0] < 0.4
    share, error = of_links(levels(5, 5), "rx_power_dbm")
    assert share == pytest.approx(0.5, abs=3 * error)
    alone = levels(5, 0)
    assert np.isnan(of_links(alone.rows(np.arange(0, LINKS * ROWS, 2)), "rx_power_dbm")[0])


def test_fading_from_row_to_row_is_no_obstacle() -> None:
    for of_link_db, of_row_db, refused in ((5, 0.5, False), (0, 5, True)):
        rest, whole = (levels(of_link_db, of_row_db, fitted) for fitted in (0, 6))
        assert bool(row_by_row(whole, rest)) is refused
        assert row_by_row(rest, rest) == ""  # it does not change levels at all


def test_what_links_keep_is_no_fading() -> None:
    rng = np.random.default_rng(8)
    for of_link_db, of_row_db, refused in ((5, 0.5, True), (0.5, 5, False)):
        rest = levels(of_link_db, of_row_db)
        by_rows, by_links = (np.array(rest.versions) for _ in range(2))
        by_rows[1:] += 5 * rng.normal(size=by_rows[1:].shape)
        by_links[1:, :, 0] += 5 * rng.normal(size=(MEMBERS, LINKS))[:, LINK]
        fading, obstacle = (Ensemble(rest.names, rest.units, v, LINK) for v in (by_rows, by_links))
        assert bool(link_by_link(fading, rest)) is refused
        assert link_by_link(obstacle, rest) == ""


def test_rows_count_as_far_as_those_of_a_link_have_nothing_in_common() -> None:
    rng, code = np.random.default_rng(5), np.repeat(np.arange(50), 4)
    assert rows_per_link(rng.normal(size=200), code) > 3
    alike = rng.normal(size=50)[code] + 0.1 * rng.normal(size=200)
    assert rows_per_link(alike, code) < 1.1
    assert rows_per_link(rng.normal(size=50), np.arange(50)) == 1


def test_what_reaches_struck_links_is_as_loud_as_recorded() -> None:
    struck = (np.arange(LINKS) % 5 == 0).astype(np.intp)
    made = levels(0.5, 0.5)
    versions = np.array(made.versions)
    versions[0, :, 0] -= 5.2 * struck[LINK]
    seen = Ensemble(made.names, made.units, versions, LINK)
    effect = as_loud(BlockedPath(share=0.2), seen, struck)
    assert isinstance(effect, BlockedPath)
    assert effect.reflection_db == pytest.approx(-5.2, abs=1)
    assert as_loud(effect, seen, 0 * struck) is effect  # none is struck
    assert as_loud(AntennaDelay(), seen, struck) == AntennaDelay()
