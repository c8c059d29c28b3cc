"""Scatter alone is seen within links; rows and links far off are seen by themselves."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.skill import Tally
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.select.candidates import Contender, Explanation
from bench.discrepancy.select.link_mixture import Strike
from bench.discrepancy.select.scatter_alone import scatter_alone
from bench.discrepancy.select.within_links import rows_beyond, weakened
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.units import C_M_PER_NS

LINK = np.repeat(np.arange(80), 4)


def found(of_rows_m: float, of_links_m: float, *moments: str, links: int = 80) -> Strike | None:
    """Return what is said of one simulated row for each recorded one, which scatters more.

    Rows of the first `links` links.
    """
    rng = np.random.default_rng(4)
    frame = pd.DataFrame(
        {"link": [f"l{i}" for i in LINK], "true_range_m": rng.uniform(3, 20, 80)[LINK]}
    )
    recorded, simulated = (frame.assign(error_m=rng.normal(0, 0.02, len(LINK))) for _ in range(2))
    recorded["error_m"] += of_rows_m * rng.normal(size=len(LINK)) * (links > LINK)
    recorded["error_m"] += of_links_m * rng.normal(size=80)[LINK]
    seen = view(recorded, link_codes(recorded), np.arange(len(LINK)), Window(), None, False)
    tally = Tally(("error_m",), np.ones((4, 1)), np.ones((4, 1)))
    made = Contender(TimestampJitter(), tally, Estimate(0, 0, 0))
    told = Explanation((made,), tally, Estimate(0, 0, 0), tally, {}, {})
    search = SimpleNamespace(comparison=TableComparison(simulated, Window()), work=seen, logged=())
    cells = [
        SimpleNamespace(cell=SimpleNamespace(observable="error_m", moment=one))
        for one in moments or ("spread",)
    ]
    return scatter_alone(search, (), told, SimpleNamespace(findings=cells))  # type: ignore[arg-type]


def test_scatter_within_links_is_named_with_its_size() -> None:
    made = found(0.02, 0.0)
    assert made is not None
    size = made.parameters[0]
    assert size.low < 0.02 / (C_M_PER_NS * 1.0016) < size.high
    assert size.value == pytest.approx(0.0666, rel=0.25)


def test_what_links_keep_or_what_moves_is_no_scatter() -> None:
    assert found(0.0, 0.0) is None
    assert found(0.02, 0.06) is None
    assert found(0.02, 0.0, "mean") is None
    assert found(0.02, 0.0, "link") is None
    assert found(0.02, 0.06, "spread", "link") is None


def test_means_of_few_rows_scatter_with_them() -> None:
    assert found(0.02, 0.0, "spread", "link") is not None


def test_what_a_few_links_make_is_no_scatter_of_all() -> None:
    assert found(0.1, 0.0, links=3) is None


def errors(wild: int, members: int = 3) -> Ensemble:
    rng = np.random.default_rng(1)
    versions = rng.standard_t(3, (1 + members, len(LINK), 1)) * 0.02
    versions[0, :wild] += 5
    return Ensemble(("error_m",), ("m",), versions, LINK)


def test_rows_beyond_all_simulated_ones_are_counted() -> None:
    assert rows_beyond(errors(0)) == 0
    assert rows_beyond(errors(4)) == 4
    assert rows_beyond(errors(4, 1)) == 0  # one version tells nothing of scatter


def test_what_blocks_links_takes_their_level() -> None:
    rng = np.random.default_rng(2)
    versions = rng.normal(0, 1, (5, len(LINK), 1))
    struck = np.arange(80) < 4
    weak, strong = versions.copy(), versions.copy()
    weak[0, struck[LINK]] -= 5
    strong[0, struck[LINK]] += 5
    made = [Ensemble(("rx_power_dbm",), ("dB",), v, LINK) for v in (weak, versions, strong)]
    assert weakened(made[0], struck) > 6
    assert [weakened(one, struck) < 2 for one in made[1:]] == [True, True]
    assert weakened(Ensemble(("error_m",), ("m",), weak, LINK), struck) == 0
