"""Sets of causes: the true one has most evidence, and none is made of what another does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.select.candidates import library, offered
from bench.discrepancy.select.state import Search
from bench.discrepancy.sets.blocks import usual_levels
from bench.discrepancy.sets.choose import Contest, chosen
from bench.discrepancy.sets.evidence import Evidence
from bench.discrepancy.sets.install import together
from bench.discrepancy.sets.weigh import weighed
from bench.physics.effects.ranging.clock_offset import ClockOffset
from bench.physics.effects.ranging.power_bias import PowerBias
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.scene import scene
from bench.recordings.table import Recordings
from tests.bench.discrepancy.numpy_tables import Hidden, constant, tables, walls, warmth


def search_of(
    hidden: Hidden | None, seed: int, change: Callable[[Recordings], Recordings] = lambda one: one
) -> Search:
    """Return a search over every row of two tables, ranges and levels alone; both changed so."""
    recorded, simulated = map(change, tables(seed, hidden))
    frame, codes = recorded.frame, link_codes(recorded.frame)
    rows = view(frame, codes, np.arange(len(frame)), Window(), None, False)
    kinds, _ = offered(library()[0], frame, False, False)
    return Search(TableComparison(simulated.frame, Window()), rows, rows, kinds, 0, work=rows)


def both(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """Return 0.12 m everywhere and 8 mm per metre: either passes for a part of the other."""
    return constant(frame, rng) + 0.008 * frame["true_range_m"].to_numpy()


def elsewhere(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """Return a law of the distance that holds for one device alone: no delay of it."""
    return 0.0012 * (frame["tx"] == "d1") * frame["true_range_m"].to_numpy() ** 2


@pytest.mark.parametrize(
    ("hidden", "names"),
    [(None, ()), (warmth, ("temperature-drift",)), (both, ("antenna-delay", "range-scale"))],
)
def test_the_true_set_has_most_evidence(hidden: Hidden | None, names: tuple[str, ...]) -> None:
    found = chosen(search_of(hidden, 3), ())
    assert (found.names, found.others) == (names, ())


def test_links_that_are_struck_make_no_law() -> None:
    assert chosen(search_of(walls, 5), ()).names == ()


def test_a_law_takes_the_name_from_what_stands_in_for_it() -> None:
    found = chosen(search_of(elsewhere, 4), ())
    assert found.names == ()
    assert found.others == ("a law of tx=d1",)


def test_effects_that_have_much_in_common_are_fitted_at_once() -> None:
    search = search_of(both, 6)
    found = chosen(search, ())
    made = {effect.physics: effect for effect in together(replace(search, choice=found), ())}
    scale = made["range-scale"]
    assert isinstance(scale, RangeScale)
    assert scale.scale == pytest.approx(0.008, abs=0.0012)
    known = found.unsure["range-scale"]
    assert known.sets[0].covariance()[0, 0] > 1.4 * known.alone.covariance()[0, 0]


def hardly_more(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """Return 0.12 m everywhere and 1.1 mm per metre: too little for a name of its own."""
    return constant(frame, rng) + 0.0011 * frame["true_range_m"].to_numpy()


def test_what_falls_short_of_a_name_may_still_be_there() -> None:
    found = chosen(search_of(hardly_more, 6), ())
    assert found.names == ("antenna-delay",)
    first, *others = found.unsure["antenna-delay"].sets
    assert sum(one.share for one in (first, *others)) == pytest.approx(1.0)
    columns = found.unsure["antenna-delay"].columns
    moved = [float(np.mean(columns @ (one.factors - first.factors))) for one in others]
    assert max(one.share for one in others) > 0.1
    assert min(moved) < -0.003


def test_a_cause_pays_for_freedom_that_it_does_not_use() -> None:
    rng = np.random.default_rng(0)
    line = rng.normal(size=(200, 1))
    many = np.hstack([line, rng.normal(size=(200, 30))])
    left = 0.2 * line[:, 0] + rng.normal(0, 0.1, 200)
    evidence = Evidence(left, np.arange(200), {"line": (line,), "many": (many,)})
    alone, free = evidence.of(("line",)).nats, evidence.of(("many",)).nats
    assert alone > evidence.of(()).nats + 20
    assert alone > free + 10


def test_offsets_that_links_keep_are_no_cause_of_their_own() -> None:
    rng = np.random.default_rng(1)
    links = np.repeat(np.arange(20), 10)
    of_link = rng.normal(size=20)
    left = 0.1 * rng.normal(size=20)[links] + rng.normal(0, 0.02, 200)
    evidence = Evidence(left, links, {"of links": (of_link[links][:, None],)})
    assert evidence.of(("of links",)).nats < evidence.of(()).nats + 6


def test_a_level_bias_is_long_where_signals_are_weak() -> None:
    frame = pd.DataFrame({"true_range_m": np.ones(60), "rx_power_dbm": np.linspace(-95, -62, 60)})
    rows, level = scene(frame), frame["rx_power_dbm"].to_numpy()
    usual = -0.006 * (level + 77)
    assert PowerBias.possible(rows, usual)
    assert not PowerBias.possible(rows, -usual)
    assert not PowerBias.possible(rows, usual + 0.5)


@pytest.mark.parametrize(("size_m", "possible"), [(0.15, True), (-0.15, False), (0.25, False)])
def test_ranges_may_be_right_at_the_level_of_their_calibration(
    size_m: float, possible: bool
) -> None:
    level = np.linspace(-60, -76, 60)  # where the published curve is short throughout
    rows = scene(pd.DataFrame({"true_range_m": np.ones(60), "rx_power_dbm": level}))
    assert PowerBias.possible(rows, size_m * np.linspace(-1, 1, 60)) is possible


def test_levels_are_usual_beside_those_of_the_same_distance() -> None:
    recorded, _ = tables(7)
    frame = recorded.frame.assign(link_number=pd.factorize(recorded.frame["link"])[0])
    behind = (frame["link_number"] < 6).to_numpy()
    frame["rx_power_dbm"] -= 9.0 * behind
    rows = view(frame, link_codes(frame), np.arange(len(frame)), Window(), None, False)
    usual = usual_levels(rows)
    assert not usual[behind].any()
    assert usual[~behind].mean() > 0.97


def test_levels_at_one_distance_leave_no_warning(recwarn: pytest.WarningsRecorder) -> None:
    recorded, _ = tables(7)
    frame = recorded.frame.assign(true_range_m=5.0)
    rows = view(frame, link_codes(frame), np.arange(len(frame)), Window(), None, False)
    assert usual_levels(rows).any()
    assert not len(recwarn)


def test_of_two_levels_as_frequent_the_stronger_is_usual() -> None:
    """A wall between half of the links, that nobody listed, takes 7 dB of what was simulated."""
    recorded, _ = tables(7)
    frame = recorded.frame.assign(link_number=pd.factorize(recorded.frame["link"])[0])
    behind = (frame["link_number"] % 2 == 0).to_numpy()
    simulated = frame["rx_power_dbm"].to_numpy(np.float64)
    frame["rx_power_dbm"] -= 7.0 * behind
    rows = view(frame, link_codes(frame), np.arange(len(frame)), Window(), None, False)
    versions = np.stack([frame["rx_power_dbm"], simulated, simulated])[..., None]
    made = Ensemble(("rx_power_dbm",), ("dBm",), versions, rows.links)
    usual = usual_levels(rows, made)
    assert not usual[behind].any()
    assert usual[~behind].all()


def test_rows_that_take_no_part_have_no_weight() -> None:
    rng = np.random.default_rng(2)
    line = rng.normal(size=(120, 1))
    left = rng.normal(0, 0.1, 120) + np.where(np.arange(120) < 40, 0.5, 0.0) * line[:, 0]
    evidence = Evidence(left, np.arange(120), {"line": (line,)})
    some = evidence.among(np.arange(120) >= 40)
    assert evidence.of(("line",)).nats > evidence.of(()).nats + 6
    assert some.of(("line",)).nats < some.of(()).nats + 6


def test_what_stands_in_the_way_of_some_links_is_no_constant() -> None:
    rng = np.random.default_rng(4)
    links = np.repeat(np.arange(80), 4)
    noise = rng.normal(0, 0.02, len(links))
    walls = np.where(rng.random(80) < 0.35, rng.uniform(0.05, 0.2, 80), 0.0)
    parts = {"a constant": (np.full((len(links), 1), 0.05),)}
    few = 0.01 * rng.normal(size=80)
    every = ((walls[links] + noise, False), (0.05 + noise, True), (0.05 + few[links] + noise, True))
    for left, named in every:
        evidence = Evidence(left, links, parts)
        evidence.reweigh(())
        assert (evidence.of(("a constant",)).nats > evidence.of(()).nats + 6) is named


@pytest.mark.parametrize(("walls", "named"), [(True, False), (False, True)])
def test_jitter_beside_walls_makes_no_constant_of_them(walls: bool, named: bool) -> None:
    """Offsets of links are as large as they were, measured by what simulated rows scatter."""
    rng = np.random.default_rng(8)
    links = np.repeat(np.arange(80), 4)
    offset = np.where(rng.random(80) < 0.5, rng.uniform(0.05, 0.2, 80), 0.0) if walls else 0.06
    left = (offset * np.ones(80))[links] + rng.normal(0, 0.09, len(links))
    evidence = Evidence(left, links, {"a constant": (np.full((len(links), 1), 0.05),)})
    evidence.scatter_m2 = 0.02**2
    evidence.reweigh(())
    assert (evidence.of(("a constant",)).nats > evidence.of(()).nats + 6) is named


def test_signals_weaker_than_any_published_may_be_later_still() -> None:
    """By the slope at the end of the curve: 0.29 m at -101.5 dBm, not half a metre."""
    level = np.linspace(-101.5, -82.5, 60)
    rows = scene(pd.DataFrame({"true_range_m": np.full(60, 5.0), "rx_power_dbm": level}))
    late = np.clip(-(level + 86) / 15, 0, None)
    assert PowerBias.possible(rows, 0.29 * late)
    assert not PowerBias.possible(rows, 0.5 * late)


def test_one_device_alone_is_weighed_although_a_part_follows_it() -> None:
    """A clock has a part of the temperature behind those of its devices."""
    rng, every = np.random.default_rng(9), np.arange(80)
    rows = search_of(None, 3).sharpest
    devices = (every[:, None] % 8 == np.arange(8)).astype(float)
    name = ClockOffset.name
    blocks = {name: (np.ones((80, 1)), devices, rng.normal(size=(80, 2)))}
    evidence = Evidence(0.3 * devices[:, 1] + rng.normal(0, 0.02, 80), every, blocks)
    contest = Contest(evidence, {name: ClockOffset}, 1.0, rows, every, every >= 0)
    alone = contest.evidence.of((f"{name} of device 1",)).nats - np.log(8)
    assert alone > contest.evidence.of((name,)).nats
    assert contest.nats((name,)) == pytest.approx(alone, abs=1)  # a second one is of no size


def test_two_devices_of_eight_are_delays_and_no_law_of_one_of_them() -> None:
    """All eight pay for six that are as they should be; a law of one, beside a delay, for more."""
    rng, every = np.random.default_rng(9), np.arange(80)
    devices = (every[:, None] % 8 == np.arange(8)).astype(float)
    left = 0.3 * devices[:, 1] - 0.25 * devices[:, 4] + rng.normal(0, 0.02, 80)
    evidence = Evidence(left, every, {"delays": (devices,), "a law": (devices[:, [4]],)})
    single = {"delays": {f"delay {i}": (devices[:, [i]],) for i in range(8)}}
    evidence = evidence.with_blocks(evidence.blocks | single["delays"])
    made = weighed(evidence, single, [("delays",), ("a law", "delays")])
    two = evidence.of(("delay 1", "delay 4")).nats - np.log(28)
    assert made["delays",] == pytest.approx(two)
    assert two > evidence.of(("delays",)).nats
    assert made["a law", "delays"] < made["delays",] + 3


def test_rows_without_any_simulated_level_are_not_usual_and_warn_of_nothing(
    recwarn: pytest.WarningsRecorder,
) -> None:
    recorded, _ = tables(7)
    frame = recorded.frame
    rows = view(frame, link_codes(frame), np.arange(len(frame)), Window(), None, False)
    level = frame["rx_power_dbm"].to_numpy(np.float64)
    simulated = np.stack([level, level])
    simulated[:, :5] = np.nan
    versions = np.concatenate([level[None], simulated])[..., None]
    made = Ensemble(("rx_power_dbm",), ("dB",), versions, rows.links)
    usual = usual_levels(rows, made)
    assert not usual[:5].any()
    assert usual[5:].mean() > 0.9
    assert not recwarn.list


def test_what_takes_few_decibels_is_not_usual_where_simulated_levels_scatter_little() -> None:
    """A wall behind a third of the links takes 4 dB; levels of a row scatter by half a decibel."""
    recorded, _ = tables(7)
    frame = recorded.frame.assign(link_number=pd.factorize(recorded.frame["link"])[0])
    behind = (frame["link_number"] % 3 == 0).to_numpy()
    level = frame["rx_power_dbm"].to_numpy(np.float64)
    scatter_db = np.random.default_rng(3).normal(0, 0.5, (4, len(frame)))
    frame["rx_power_dbm"] = level + scatter_db[0] - 4.0 * behind
    rows = view(frame, link_codes(frame), np.arange(len(frame)), Window(), None, False)
    versions = np.stack([frame["rx_power_dbm"], *(level + scatter_db[1:])])[..., None]
    made = Ensemble(("rx_power_dbm",), ("dB",), versions, rows.links)
    usual = usual_levels(rows, made)
    assert usual[behind].mean() < 0.02
    assert usual[~behind].mean() > 0.97
