"""Effects in company: useless ones go, simple ones come before those that could stand in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.challenge.obstruction import link_log_odds, obstructing
from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.skill import Tally, gain_interval, tally
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.search import (
    Objective,
    pursue,
    refine,
    screen,
)
from bench.discrepancy.fit.starts import by_level, by_ratio
from bench.discrepancy.select.backfitting import (
    beyond,
    chosen_first,
    polished,
    pruned,
    refitted,
    rivals,
)
from bench.discrepancy.select.candidates import Contender, Explanation, explain
from bench.discrepancy.settings import FIT_MEMBERS
from bench.physics.base import Base
from bench.physics.batch import Batch
from bench.physics.effect import Effect
from bench.physics.effects.fitted.power_curve import PowerCurve
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.obstructed_path import ObstructedPath
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.temperature import TemperatureDrift
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.effects.receiver.pulse_ringing import PulseRinging
from bench.physics.randomness import Draws
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

WINDOW = Window(5, 60)
WORLD = Resimulation(Simulator(Base(keep_count=0), name="base"), WINDOW)
LINKS, ROWS = 12, 4


def _recorded(*effects: object, links: int = LINKS) -> pd.DataFrame:
    """Return a SIMULATED table that plays the recordings."""
    rng = np.random.default_rng(4)
    link = np.repeat(np.arange(links), ROWS)
    frame = pd.DataFrame(
        {
            "link": [f"l{i:02d}" for i in link],
            "true_range_m": rng.uniform(2, 6, links)[link],
            "temperature_c": rng.uniform(0, 40, links)[link],
        }
    )
    made = Simulator(Base(keep_count=0), tuple(effects), 5).observe(scene(frame), 77)
    return made.table(frame)


def _views(frame: pd.DataFrame):
    codes = link_codes(frame)
    half = len(frame) // 2
    rows = np.arange(half), np.arange(half, len(frame))
    return tuple(view(frame, codes, part, WINDOW) for part in rows)


def test_what_held_out_links_do_not_miss_is_taken_out() -> None:
    _, held = _views(_recorded(AntennaDelay(delay_ns=2.0)))
    added = (AntennaDelay(delay_ns=2.0), TemperatureDrift(slope_mm_per_c=-4.0))
    assert [e.name for e in pruned(WORLD, held, added, 0, 0.01)] == ["antenna-delay"]
    assert pruned(WORLD, held, added[:1], 0, 0.01) == added[:1]


def test_fitted_together_each_gives_back_what_is_not_its_own() -> None:
    fit, _ = _views(_recorded(AntennaDelay(delay_ns=2.0), TemperatureDrift(slope_mm_per_c=5.0)))
    wrong = (AntennaDelay(delay_ns=3.0), TemperatureDrift(slope_mm_per_c=0.5))
    fixed = {effect.name: effect for effect in polished(WORLD, fit, wrong)}
    assert fixed["antenna-delay"].delay_ns == pytest.approx(2.0, abs=0.5)
    assert fixed["temperature-drift"].slope_mm_per_c == pytest.approx(5.0, abs=2.5)


def test_a_parameter_over_decades_is_searched_by_ratio() -> None:
    peak = next(p for p in LevelControl.parameters() if p.name == "peak_counts")
    assert by_ratio(peak)
    fit, _ = _views(_recorded(LevelControl(peak_counts=6000)))
    base = tally(WORLD.ensemble(fit, (), FIT_MEMBERS))
    objective = Objective(LevelControl, WORLD, fit, (), base)
    found = refine(objective, screen(objective)).effect
    assert found.peak_counts == pytest.approx(6000, rel=0.2)


def _objective(kind: type[Effect], fit: View) -> Objective:
    return Objective(kind, WORLD, fit, (), tally(WORLD.ensemble(fit, (), FIT_MEMBERS)))


def test_a_level_that_starts_from_nothing_is_searched_evenly_in_decibels() -> None:
    levels = {p.name for p in DiffuseTail.parameters() if by_level(p)}
    assert levels == {"level_db"}
    ring = PulseRinging(ring_db=-30, ring_delay_ns=17.0)
    fit, _ = _views(_recorded(ring))
    objective = _objective(PulseRinging, fit)
    found = pursue(objective, refine(objective, screen(objective))).effect
    assert found.ring_db == pytest.approx(-30, abs=3)
    assert found.ring_delay_ns == pytest.approx(17.0, abs=1.5)


def test_little_of_one_amplitude_is_seen_beside_what_is_strong_by_default() -> None:
    fit, _ = _views(_recorded(LevelControl(compression=0, accumulation=0.1, peak_counts=1e9)))
    assert screen(_objective(LevelControl, fit)).gain > 0.1


def test_what_refitting_alone_gains_is_no_merit_of_a_newcomer() -> None:
    views = _views(_recorded(AntennaDelay(delay_ns=2.0)))
    added = (AntennaDelay(delay_ns=1.0),)  # badly fitted: anything beside it would mend it
    reference = tally(WORLD.ensemble(views[1], added, 8))
    known = Explanation((), reference, Estimate(1, 1, 1), reference, {}, {})
    better = refitted(WORLD, views, added, known, {"obstructed-path": ObstructedPath}, 0)
    assert all(one.gain.value < 0.1 for one in better.contenders)
    assert beyond(better, 0.1).contenders == ()


def _tally(errors: np.ndarray) -> Tally:
    return Tally(("error_m",), errors[:, None], np.ones((len(errors), 1)))


def _explanation(*effects: object, crps: tuple[float, ...]) -> Explanation:
    """Return contenders with these mean CRPS on eight links, the simulator at 1."""
    wobble = np.linspace(0.9, 1.1, 8)
    base = _tally(wobble)
    ranked = []
    for number, (effect, value) in enumerate(zip(effects, crps, strict=True)):
        scored = _tally(value * np.roll(wobble, number))
        ranked.append(Contender(effect, scored, gain_interval(base, scored, 0)))
    nothing = Estimate(0, 0, 0)
    return Explanation(tuple(ranked), base, nothing, base, {}, {})


def test_common_goes_before_per_link_and_constant_before_curve() -> None:
    for general in (ObstructedPath(), PowerCurve()):
        close = _explanation(general, AntennaDelay(delay_ns=1), crps=(0.50, 0.51))
        assert chosen_first(close, 0, 0.01).contenders[0].name == "antenna-delay"
        behind = _explanation(general, AntennaDelay(delay_ns=1), crps=(0.2, 0.6))
        assert chosen_first(behind, 0, 0.01).contenders[0].effect is general


def test_between_common_effects_the_gain_decides() -> None:
    plain = _explanation(TemperatureDrift(), AntennaDelay(delay_ns=1), crps=(0.50, 0.51))
    assert chosen_first(plain, 0, 0.01).contenders == plain.contenders


def test_contenders_are_scored_after_all_were_fitted_again() -> None:
    frame = _recorded(AntennaDelay(delay_ns=2.0), TemperatureDrift(slope_mm_per_c=5.0))
    views = _views(frame)
    added = (AntennaDelay(delay_ns=2.7),)  # holds the mean of the drift as well
    drift = TemperatureDrift(slope_mm_per_c=2.0)
    reference = tally(WORLD.ensemble(views[1], added, 8))
    scored = tally(WORLD.ensemble(views[1], (*added, drift), 8))
    one = Contender(drift, scored, replace(gain_interval(reference, scored, 0), low=0.01))
    known = Explanation((one,), reference, Estimate(0, 0, 0), reference, {}, {})
    better = refitted(WORLD, views, added, known, {}, 0)
    assert better.contenders[0].gain.value >= one.gain.value
    assert [effect.name for effect in better.contenders[0].company] in (
        [],
        ["antenna-delay", "temperature-drift"],
    )


def test_a_rival_that_falls_behind_in_company_is_no_alternative() -> None:
    frame = _recorded(AntennaDelay(delay_ns=2.0), TemperatureDrift(slope_mm_per_c=6.0))
    views = _views(frame)
    added = (AntennaDelay(delay_ns=2.0), TemperatureDrift(slope_mm_per_c=6.0))
    other = Contender(LevelControl(), tally(WORLD.ensemble(views[1], (), 8)), Estimate(1, 1, 1))
    kinds = {"level-control": LevelControl}
    assert rivals(WORLD, views, added, added[1], (other,), kinds, 0) == ()


def test_obstructed_links_are_told_from_clear_ones() -> None:
    shared = (DiffuseTail(level_db=-9), LevelControl())
    struck = ObstructedPath(share=0.5, loss_db=18, loss_spread_db=3, delay_m=0.2)
    frame = _recorded(*shared, struck, links=30)
    drawn = struck.struck(Base().paths(scene(frame)), Draws(77, 0, struck.name, 0))
    truth = pd.Series(drawn).groupby(frame["link"]).first()
    every = view(frame, link_codes(frame), np.arange(len(frame)), WINDOW)
    odds = link_log_odds(WORLD, every, (*shared, struck))
    assert odds is not None
    assert obstructing((*shared, struck)) is struck
    agree = (odds > 0) == truth.loc[odds.index]
    assert 5 < truth.sum() < 25
    assert agree.mean() > 0.9


def test_without_an_obstruction_no_link_has_a_score() -> None:
    frame = _recorded()
    every = view(frame, link_codes(frame), np.arange(len(frame)), WINDOW)
    assert link_log_odds(WORLD, every, (LevelControl(),)) is None


def test_an_effect_that_fails_on_held_out_rows_is_skipped_and_the_rest_goes_on() -> None:
    frame = _recorded(TemperatureDrift(slope_mm_per_c=5.0))
    codes = link_codes(frame)
    parts = np.flatnonzero(codes < 5), np.flatnonzero(codes >= 5)
    fit, held = (view(frame, codes, rows, WINDOW, ("error_m",), False) for rows in parts)

    class Picky(TemperatureDrift):
        """Cannot do as many rows as are held out."""

        name = "picky"

        def apply(self, batch: Batch, draws: Draws) -> Batch:
            if len(batch.rows) == len(parts[1]):
                raise RuntimeError("too many rows")
            return super().apply(batch, draws)

    kinds = {"picky": Picky, "temperature-drift": TemperatureDrift}
    found = explain(WORLD, fit, held, (), kinds, ("error_m",), 0)
    assert "too many rows" in found.skipped["picky"]
    assert "temperature-drift" in {one.name for one in found.contenders}
