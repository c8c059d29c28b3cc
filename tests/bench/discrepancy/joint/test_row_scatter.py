"""What draws every row anew is told by how rows of one link scatter; SIMULATED rows."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import Added, View, view
from bench.discrepancy.data.observables import RANGE, window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.joint import untried
from bench.discrepancy.joint.chance import by_chance
from bench.discrepancy.joint.form import beyond_forms, of_form
from bench.discrepancy.joint.polish import fitted, polished
from bench.discrepancy.joint.sets import Sets
from bench.discrepancy.joint.statistics import Statistics
from bench.discrepancy.joint.untried import scatter_at_most, with_unlisted, with_untried
from bench.discrepancy.select.adequacy import adequacy, by_itself
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.verdict import Ambiguous, Control, LeftOut
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.propagation.diffraction import Diffraction
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.fading import SmallScaleFading
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.propagation.obstructed_path import ObstructedPath
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.propagation.specular import SpecularReflections
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS, EACH = 20, 3
FADED = SmallScaleFading(direct_m=12.0)
STEEPER, SLIGHTLY = PathLoss(exponent=2.8), SmallScaleFading(direct_m=999.0, deeper=3.0)
SHADOWED = PathLoss(shadowing_db=1.2)
SAID = LeftOut(
    TimestampJitter(jitter_samples=0.1), (), Estimate(1, 0.5, 1.5, "nats"), 1.0, Control("", None)
)


def compared(hidden: Added) -> tuple[Resimulation, View]:
    """Return rows of links with several each beside a simulator that lacks what is hidden."""
    rng = np.random.default_rng(4)
    frame = pd.DataFrame(
        {
            "link": [f"l{i}" for i in range(LINKS)],
            "true_range_m": rng.uniform(2, 15, LINKS),
            "tx": [f"t{i % 3}" for i in range(LINKS)],
            "rx": [f"r{i % 4}" for i in range(LINKS)],
        }
    )
    frame = pd.concat([frame] * EACH, ignore_index=True)
    frame = Simulator(Base(), hidden, 5, "test").observe(scene(frame), 5, 77).table(frame)
    window = window_of(frame)
    rows = view(frame, link_codes(frame), np.arange(len(frame)), window)
    return Resimulation(Simulator(Base(), (), 11, "test"), window), rows


@pytest.mark.parametrize(
    ("hidden", "other"), [(FADED, SHADOWED), (SHADOWED, FADED)], ids=["fading", "shadowing"]
)
def test_fading_and_shadowing_are_told_apart_by_rows_of_one_link(hidden, other):
    comparison, rows = compared((hidden,))
    given = Statistics(comparison, rows)
    right, wrong = given.moments((hidden,)), given.moments((other,))
    assert right is not None
    assert wrong is not None
    assert right.within > wrong.within + 20
    found = Sets(comparison, rows, rows, (SmallScaleFading, PathLoss)).chosen()
    assert {effect.name for effect in found.named} == {hidden.name}


def test_fading_is_no_other_form_of_what_moves_means_alone():
    """A steep path loss beside it moves every mean by more than fading does."""
    comparison, rows = compared((FADED, STEEPER))
    given = Statistics(comparison, rows)
    both = fitted(given, (FADED, STEEPER))
    assert both is not None
    assert not of_form(given, both, FADED.name)
    assert not of_form(given, both, STEEPER.name)
    assert beyond_forms(given, both, FADED.name) == (STEEPER.name,)  # which makes nothing scatter
    twice = fitted(given, (SLIGHTLY, STEEPER))
    assert twice is not None
    assert of_form(given, twice, SLIGHTLY.name)  # a shift that is a little of the same


def test_what_rows_scatter_by_chance_is_no_sign_of_an_effect():
    """A first path that is found late in a few rows makes what scatters uneven, on both sides."""
    comparison, rows = compared(())
    given = Statistics(comparison, rows)
    (one, *_), moments = given.others_rows(()), given.needed(())
    assert moments.rows is not None
    # By chance 38 nats, one standard deviation of eight seeds; rows that fade bring hundreds.
    assert given.within(one, moments.rows) == pytest.approx(moments.within, abs=120)
    faded, bare = fitted(given, (FADED,)), fitted(given, ())
    assert faded is not None
    assert bare is not None
    assert by_chance(given, faded, bare) == 0.0
    assert faded.moments.rows is not None
    assert given.within(one, moments.rows) > given.within(one, faded.moments.rows) + 50


def test_means_of_many_sets_are_those_of_each():
    comparison, rows = compared(())
    given = Statistics(comparison, rows)
    many = [(SHADOWED, replace(STEEPER, exponent=one)) for one in (1.5, 2.5, 3.5)]
    for one, other in zip(given.means(many), map(given.mean, many), strict=True):
        np.testing.assert_array_equal(one, other)


def test_where_links_have_one_row_nothing_scatters_about_them():
    comparison, rows = compared(())
    alone = View(rows.frame, rows.recorded, np.arange(len(rows.rows)), rows.rows)
    moments = Statistics(comparison, alone).moments(())
    assert moments is not None
    assert moments.within == 0.0


def test_fading_is_judged_by_levels_whatever_the_shape_of_pulses_does():
    comparison, rows = compared((FADED,))
    torn = [
        cir * np.exp(0.2 * np.random.default_rng(i).normal(size=len(cir)))
        for i, cir in enumerate(rows.frame["cir"])
    ]
    frame = rows.frame.assign(cir=torn)
    again = view(frame, rows.links, np.arange(len(frame)), comparison.window)
    assert adequacy(comparison, (again,), (FADED,), FADED).adequate
    still = SmallScaleFading(direct_m=300.0)
    assert not adequacy(comparison, (again,), (still,), still).adequate


@dataclass
class Table:
    """Answers for a table: ranges scatter by jitter, recorded levels by `recorded_db`."""

    recorded_db: float
    seed: int = 0

    def ensemble(self, _: object, added: Added, members: int, first: int = 0) -> Ensemble:
        """Return 240 rows of 60 links: ranges and levels."""
        rng = np.random.default_rng(self.seed + first)
        ranges, level = rng.normal(size=(2, 1 + members, 240))
        level *= np.array([self.recorded_db] + [0.3] * members)[:, None]
        ranges *= 0.1 if added else 0.01
        values = np.stack([ranges, level], axis=2)
        return Ensemble((RANGE, "rx_power_dbm"), ("m", "dB"), values, np.repeat(np.arange(60), 4))


def search_of(table: Table) -> Search:
    """Return a search over a table into which fading cannot be put."""
    kinds = {"small-scale-fading": SmallScaleFading}
    return Search(table, None, None, {}, 0, untried=kinds)  # type: ignore[arg-type]


@pytest.mark.parametrize(("level_db", "excluded"), [(2.5, False), (0.3, True)])
def test_scatter_is_a_class_with_what_could_not_be_tried_unless_levels_are_calm(
    monkeypatch: pytest.MonkeyPatch, level_db: float, excluded: bool
) -> None:
    monkeypatch.setattr(untried, "compared_rows", lambda search: None)
    (found,) = with_untried(search_of(Table(level_db)), (SAID.effect,), (SAID,))
    if excluded:
        assert found == SAID
        return
    assert isinstance(found, Ambiguous)
    assert found.names == ("timestamp-jitter", "small-scale-fading")
    assert "could not be tried" in found.options[1].note


def test_where_all_can_be_tried_or_nothing_scatters_verdicts_stay(monkeypatch):
    monkeypatch.setattr(untried, "compared_rows", lambda search: None)
    bare = Search(Table(2.5), None, None, {}, 0)
    assert with_untried(bare, (SAID.effect,), (SAID,)) == (SAID,)
    other = LeftOut(SHADOWED, (), SAID.gain, 1.0, SAID.control)
    assert with_untried(search_of(Table(2.5)), (SHADOWED,), (other,)) == (other,)


UNLISTED: dict[str, type[Effect]] = {
    kind.name: kind for kind in (Diffraction, MaterialDelay, SmallScaleFading)
}


@pytest.mark.parametrize(
    ("effect", "names"),
    [
        (ObstructedPath(), ("obstructed-path", "diffraction", "material-delay")),
        (BlockedPath(), ("blocked-path",)),  # nothing came through or around an edge
    ],
)
def test_what_obstructs_links_may_be_what_obstacles_do_that_nobody_listed(
    effect: Effect, names: tuple[str, ...]
) -> None:
    search = Search(None, None, None, {}, 0, untried=UNLISTED)  # type: ignore[arg-type]
    said = LeftOut(effect, (), SAID.gain, 1.0, SAID.control)
    assert with_unlisted(search, said).names == names
    assert with_unlisted(replace(search, untried={}), said) is said


def test_where_a_table_tells_only_which_ways_are_clear_walls_of_any_make_strike_the_others() -> (
    None
):
    """Three tables of walls of unlike makes were obstructed or blocked paths, or diffraction."""
    rows = SimpleNamespace(scene=scene(pd.DataFrame({"true_range_m": [3.0, 4.0], "los": [1, 0]})))
    kinds: dict[str, type[Effect]] = {MaterialDelay.name: MaterialDelay}
    search = Search(None, None, rows, kinds, 0, whole=rows)  # type: ignore[arg-type]
    said = LeftOut(ObstructedPath(), (), SAID.gain, 1.0, SAID.control)
    assert with_unlisted(search, said).names == ("obstructed-path", "material-delay")


def test_in_a_table_a_blocked_path_may_be_an_obstructed_one() -> None:
    """The table has no rays round what stands in the way, so neither fits as it would."""
    said = LeftOut(BlockedPath(), (), SAID.gain, 1.0, SAID.control)
    kinds: dict[str, type[Effect]] = {k.name: k for k in (BlockedPath, ObstructedPath)}
    table = Search(None, None, None, kinds, 0)  # type: ignore[arg-type]
    assert with_unlisted(table, said).names == ("blocked-path", "obstructed-path")
    again = replace(table, comparison=Resimulation.__new__(Resimulation))
    assert with_unlisted(again, said) is said


def test_what_links_keep_of_a_tail_is_fitted_to_how_their_rows_scatter():
    hidden = DiffuseTail(static=0.95)
    comparison, rows = compared((hidden,))
    given = Statistics(comparison, rows)
    right, begun = fitted(given, (hidden,)), fitted(given, (DiffuseTail(static=0.4),))
    found = polished(given, (DiffuseTail(static=0.4),))
    assert right is not None
    assert begun is not None
    assert found is not None
    assert found.nats - begun.nats > 0.9 * (right.nats - begun.nats)
    (tail,) = found.effects
    assert isinstance(tail, DiffuseTail)
    assert tail.static == pytest.approx(hidden.static, abs=0.1)


def test_a_tail_may_be_reflections_of_walls_that_nobody_placed():
    tail = replace(SAID, effect=DiffuseTail())
    known = SimpleNamespace(frame=pd.DataFrame(columns=["tx_x_m", "rx_x_m"]))
    untold = Search(None, None, known, {}, 0, untried={"specular-reflections": SpecularReflections})  # type: ignore[arg-type]
    (found,) = with_untried(untold, (), (tail,))
    assert isinstance(found, Ambiguous)
    assert found.names == ("diffuse-tail", "specular-reflections")
    assert found.options[1].note.endswith("it needs room_x_m and room_y_m")
    assert with_untried(replace(untold, untried={}), (), (tail,)) == (tail,)
    assert with_untried(untold, (), (SAID,)) == (SAID,)


def test_what_levels_may_scatter_beyond_simulated_ones_is_bounded():
    made = Table(1.0).ensemble(None, (), 4)
    extra = np.sqrt(1.0 - 0.3**2)
    assert extra < scatter_at_most(made, "rx_power_dbm") < 1.3 * extra
    single = Ensemble(made.names, made.units, made.versions, np.arange(240))
    assert scatter_at_most(single, "rx_power_dbm") == float("inf")


def test_a_count_that_another_effect_turns_levels_into_is_no_matter_of_what_made_these():
    comparison, rows = compared((FADED,))
    frame = rows.frame.assign(preamble_count=1000.0)
    again = view(frame, rows.links, np.arange(len(frame)), comparison.window)
    control = LevelControl(compression=1.0, accumulation=0.8)
    every, asked = ("preamble_count", "rx_power_dbm"), (comparison, (again,))
    assert by_itself(*asked, control, every) == every
    assert by_itself(*asked, SHADOWED, every) == every[1:]
