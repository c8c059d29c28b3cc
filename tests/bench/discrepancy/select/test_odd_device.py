"""One device of many whose waveforms are far off in all of its links is found, and said."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select.odd_device import beyond_all, with_odd_device

TAGS, ANCHORS, ROWS = 7, 6, 8
NAMES = ("error_m", "rx_power_dbm", "profile_db[1.5..3.5ns]", "first_path_lead_ns")
UNITS = ("m", "dB", "dB", "ns")
NOTHING = Located((), 0.8, 3.2, 4.0, 900, {})


@dataclass
class Compared:
    """A comparison whose versions are given: the first three are the rows' own."""

    made: Ensemble
    own: int = 3
    same_links: bool = True

    def ensemble(self, *_: object) -> Ensemble:
        return self.made

    def distinct(self, _: object) -> int:
        return self.own

    def paired(self, _: object) -> bool:
        return self.same_links


def made(shift: float, anchors: tuple[int, ...] = (4,), links: int = TAGS) -> Ensemble:
    """Return versions whose links have draws of their own; some of an anchor's are shifted."""
    rng = np.random.default_rng(3)
    link = np.repeat(np.arange(TAGS * ANCHORS), ROWS)
    draws = rng.normal(size=(17, TAGS * ANCHORS, len(NAMES)))
    draws[1:4] = draws[1]  # a table that repeats a link draws once what it has by chance
    versions = draws[:, link] + 0.3 * rng.normal(size=(17, len(link), len(NAMES)))
    for anchor in anchors:
        mine = [tag * ANCHORS + anchor for tag in range(links)]
        versions[0, np.isin(link, mine), 2] += shift
    return Ensemble(NAMES, UNITS, versions, link)


def searched(one: Ensemble, **of: object) -> SimpleNamespace:
    tag, anchor = np.divmod(one.links, ANCHORS)
    groups = {f"tx=t{i}": tag == i for i in range(TAGS)}
    groups |= {f"rx=a{i}": anchor == i for i in range(ANCHORS)}
    rows = SimpleNamespace(covariates=Covariates({}, groups))
    return SimpleNamespace(comparison=Compared(one, **of), both=rows, seed=0)  # type: ignore[arg-type]


def test_a_device_that_is_far_off_in_all_its_links_is_found_and_named() -> None:
    found = with_odd_device(searched(made(25.0)), NOTHING)  # type: ignore[arg-type]
    assert [str(one).partition(":")[0] for one in found.findings] == [
        "profile_db[1.5..3.5ns] where rx=a4"
    ]
    assert found.significant
    assert found.findings[0].effect.value == pytest.approx(25.0, abs=2.0)


@pytest.mark.parametrize(
    ("one", "of"),
    [
        (made(0.0), {}),
        (made(4.0), {}),  # no farther than links are by chance
        (made(25.0, links=2), {}),  # two of seven links of it
        (made(25.0), {"same_links": False}),  # a place that no simulated link has
    ],
)
def test_what_chance_or_another_place_makes_is_no_odd_device(
    one: Ensemble, of: dict[str, object]
) -> None:
    assert with_odd_device(searched(one, **of), NOTHING) is NOTHING  # type: ignore[arg-type]


def test_of_a_simulator_every_version_is_held_against_the_others() -> None:
    given = searched(made(25.0), own=16)
    assert set(beyond_all(given.comparison.made, 16, given.both)) == {
        ("rx=a4", "profile_db[1.5..3.5ns]")
    }
    bare = searched(made(0.0), own=16)
    assert not beyond_all(bare.comparison.made, 16, bare.both)


def test_what_a_search_found_stays() -> None:
    told = with_odd_device(searched(made(25.0)), NOTHING)  # type: ignore[arg-type]
    assert with_odd_device(searched(made(0.0)), told) is told  # type: ignore[arg-type]
