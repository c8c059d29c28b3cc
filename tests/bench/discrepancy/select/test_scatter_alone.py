"""Scatter alone is seen within links; rows and links far off are seen by themselves."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.skill import Tally
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select.candidates import Contender, Explanation
from bench.discrepancy.select.link_mixture import Strike
from bench.discrepancy.select.scatter_alone import scatter_alone, scatter_beside
from bench.discrepancy.select.scatter_size import told_by_rows, with_sizes
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.within_links import rows_beyond, weakened
from bench.physics.base import Base
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.physics.units import C_M_PER_NS

LINK = np.repeat(np.arange(80), 4)


def found(
    of_rows_m: float, of_links_m: float, *moments: str, links: int = 80, far_m: float = 0.0
) -> Strike | None:
    """Return what is said of one simulated row for each recorded one, which scatters more.

    Rows of the first `links` links. Those far away are longer by `far_m`.
    """
    rng = np.random.default_rng(4)
    frame = pd.DataFrame(
        {"link": [f"l{i}" for i in LINK], "true_range_m": rng.uniform(3, 20, 80)[LINK]}
    )
    recorded, simulated = (frame.assign(error_m=rng.normal(0, 0.02, len(LINK))) for _ in range(2))
    recorded["error_m"] += of_rows_m * rng.normal(size=len(LINK)) * (links > LINK)
    recorded["error_m"] += of_links_m * rng.normal(size=80)[LINK]
    recorded["error_m"] += far_m * (frame["true_range_m"] > 11)
    seen = view(recorded, link_codes(recorded), np.arange(len(LINK)), Window(), None, False)
    tally = Tally(("error_m",), np.ones((4, 1)), np.ones((4, 1)))
    made = Contender(TimestampJitter(), tally, Estimate(0, 0, 0))
    told = Explanation((made,), tally, Estimate(0, 0, 0), tally, {}, {})
    search = Search(TableComparison(simulated, Window()), seen, seen, {}, 0, work=seen)
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


def test_means_that_scatter_makes_are_no_other_finding() -> None:
    assert found(0.02, 0.0, "spread", "mean") is not None
    assert found(0.02, 0.0, "rows", "mean", far_m=0.012) is None


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


def beside(jitter_m: float, more_m: float = 0.0) -> Strike | None:
    """Return what is said of scatter beside a delay that is named; rows of a link may jump."""
    rng = np.random.default_rng(6)
    frame = pd.DataFrame(
        {"link": [f"l{i}" for i in LINK], "true_range_m": rng.uniform(3, 20, 80)[LINK]}
    )
    recorded, simulated = (frame.assign(error_m=rng.normal(0, 0.02, len(LINK))) for _ in range(2))
    recorded["error_m"] += 0.15 + jitter_m * rng.normal(size=len(LINK))
    recorded["error_m"] += more_m * (rng.random(len(LINK)) < 0.3)
    seen = view(recorded, link_codes(recorded), np.arange(len(LINK)), Window(), None, False)
    kinds = {TimestampJitter.name: TimestampJitter}
    search = Search(TableComparison(simulated, Window()), seen, seen, kinds, 0, work=seen)
    nothing = Located((), 0.4, 2.0, 3.0, 1, {})
    made = scatter_beside(search, (AntennaDelay(delay_ns=0.5),), nothing)
    return made and made.strike


def test_scatter_beside_a_name_is_found_where_nothing_else_stands_out() -> None:
    made = beside(0.015)
    assert made is not None
    size = made.parameters[0]
    assert size.low < 0.015 / (C_M_PER_NS * 1.0016) < size.high
    assert beside(0.0) is None
    assert beside(0.0, 0.4) is None  # jumps are no scatter


@pytest.mark.parametrize(("jitter_m", "said"), [(0.0, False), (0.03, True)])
def test_rows_that_stand_for_several_make_no_scatter(jitter_m: float, said: bool) -> None:
    """Simulated links have two rows for four: what is there twice scatters less."""
    rng = np.random.default_rng(9)
    theirs = np.repeat(np.arange(80), 2)
    ours, others = (
        pd.DataFrame(
            {
                "link": [f"{name}{i}" for i in link],
                "true_range_m": far_m[link] + rng.uniform(-0.2, 0.2, len(link)),
            }
        )
        for name, link, far_m in (
            ("l", LINK, rng.uniform(3, 20, 80)),
            ("o", theirs, rng.uniform(3, 20, 80)),
        )
    )
    recorded = ours.assign(error_m=rng.normal(0, np.hypot(0.02, jitter_m), len(LINK)))
    simulated = others.assign(error_m=rng.normal(0, 0.02, len(theirs)))
    seen = view(recorded, link_codes(recorded), np.arange(len(LINK)), Window(), None, False)
    kinds = {TimestampJitter.name: TimestampJitter}
    search = Search(TableComparison(simulated, Window()), seen, seen, kinds, 0, work=seen)
    found = scatter_beside(search, (), Located((), 0.4, 2.0, 3.0, 1, {}))
    assert bool(found) == said


@pytest.mark.parametrize("own_m", [0.0, 0.02])
def test_the_size_of_scatter_is_what_rows_of_links_say(own_m: float) -> None:
    """Whatever the simulator scatters by; beside it, nothing is heavy."""
    rng = np.random.default_rng(8)
    frame = pd.DataFrame(
        {"link": [f"l{i}" for i in LINK], "true_range_m": rng.uniform(3, 20, 80)[LINK]}
    )
    recorded = frame.assign(error_m=rng.normal(0, np.hypot(own_m, 0.06), len(LINK)))
    noise = rng.normal(0, 1, (3, len(LINK))) * own_m
    simulated = pd.concat([frame.assign(error_m=one) for one in noise], ignore_index=True)
    seen = view(recorded, link_codes(recorded), np.arange(len(LINK)), Window(), None, False)
    search = Search(TableComparison(simulated, Window()), seen, seen, {}, 0, work=seen)
    fitted = TimestampJitter(jitter_samples=0.1, heavy=0.4)
    (made,) = with_sizes(search, (fitted,))
    assert isinstance(made, TimestampJitter)
    assert made.heavy == 0
    (told,) = told_by_rows(search, (), fitted, ())
    assert told.low < 0.06 / (C_M_PER_NS * 1.0016) < told.high
    assert told.value == made.jitter_samples
    delay = AntennaDelay(delay_ns=0.5)
    assert with_sizes(search, (delay,)) == (delay,)


def test_scatter_comes_on_top_of_what_the_simulator_has() -> None:
    rng = np.random.default_rng(7)
    frame = pd.DataFrame(
        {"link": [f"l{i}" for i in LINK], "true_range_m": rng.uniform(3, 20, 80)[LINK]}
    )
    simulator, wider = (Simulator(Base(), (TimestampJitter(s),), 1, "it") for s in (0.08, 0.16))
    made = wider.observe(scene(frame), 1, 999, cir=False).table(frame)
    recorded = frame.assign(error_m=made["error_m"])
    seen = view(recorded, link_codes(recorded), np.arange(len(LINK)), Window(), None, False)
    kinds = {TimestampJitter.name: TimestampJitter}
    search = Search(Resimulation(simulator, Window()), seen, seen, kinds, 0, work=seen)
    nothing = Located((), 0.4, 2.0, 3.0, 1, {})
    found = scatter_beside(search, (RangeScale(scale=0.0),), nothing)
    assert found is not None
    assert found.strike is not None
    assert found.strike.parameters[0].low < 0.16 < found.strike.parameters[0].high
