"""A name must reproduce what it acts on; another form of it may leave a little."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.skill import Tally
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.fit.search import Fitted
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.select import refute
from bench.discrepancy.select.adequacy import Adequacy, brought, judged
from bench.discrepancy.select.candidates import Contender, Explanation
from bench.discrepancy.select.deformation import within
from bench.discrepancy.select.predictive_cells import told_by_places
from bench.discrepancy.select.state import Round
from bench.discrepancy.sets.choice import Choice
from bench.physics.effect import Effect
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.effects.receiver.noise_floor import NoiseFloor

LINKS, ROWS, MEMBERS = 30, 2, 10
NAMES = ("profile_db[a]", "profile_db[b]", "profile_db[c]", "rx_power_dbm")


def _ensemble(recorded: np.ndarray, simulated: np.ndarray, seed: int) -> Ensemble:
    """Return rows that scatter by 1 dB around means [n, p]."""
    rng = np.random.default_rng(seed)
    rows = LINKS * ROWS
    noise = rng.normal(size=(1 + MEMBERS, rows, len(NAMES)))
    means = np.stack([recorded, *[simulated] * MEMBERS])
    links = np.repeat(np.arange(LINKS), ROWS)
    return Ensemble(NAMES, ("dB",) * len(NAMES), noise + means, links)


def _judged(
    recorded: list[float],
    fitted: list[float],
    warming: float = 0.0,
    seed: int = 5,
    over: str = "temperature_c",
    around: bool = False,
) -> Adequacy:
    """Return the adequacy of an effect that shifts means by `fitted`; the truth by `recorded`.

    `warming` is a trend of the last observable over a covariate, per standard deviation.
    """
    rows = LINKS * ROWS
    trend = np.linspace(-1.7, 1.7, rows)
    truth = np.tile(np.array(recorded, float), (rows, 1))
    truth[:, -1] += warming * trend
    whole = _ensemble(truth, np.tile(fitted, (rows, 1)), seed)
    rest = _ensemble(truth, np.zeros((rows, len(NAMES))), seed)
    weights = np.stack([np.ones(rows), trend], axis=1)
    return judged(whole, rest, (Place(), Place(over, trend=True)), weights, 1.0, around)


def test_the_right_effect_in_another_form_is_adequate() -> None:
    assert _judged([6, 5, 4, 0], [6, 5, 4, 0]).adequate
    found = _judged([6, 5, 4, 0], [5, 5, 5, 0])
    assert found.adequate
    assert found.left < 0.4


def test_an_effect_of_another_shape_is_not() -> None:
    found = _judged([0, 9, 0, 0], [3, 3, 3, 0])
    assert not found.adequate
    assert "profile_db[b]" in str(found)


def test_a_trend_over_what_the_effect_does_not_know_is_not_left_unsaid() -> None:
    assert _judged([0, 0, 0, -3], [0, 0, 0, -3]).adequate
    found = _judged([0, 0, 0, -3], [0, 0, 0, -3], warming=-2.0)
    assert not found.adequate
    assert "as a trend over temperature_c" in found.where


def test_noise_may_go_with_whatever_runs_around() -> None:
    """A motor's current tells how much it disturbs: that is no other form of a path."""
    assert _judged([0, 0, 0, -3], [0, 0, 0, -3], warming=-2.0, around=True).adequate


def test_what_links_differ_by_anyway_is_told_by_no_covariate() -> None:
    """More than simulated ones do: in some interval of some number they are farther off."""

    def told(warming: float, seed: int) -> float:
        rows, rng = LINKS * ROWS, np.random.default_rng(seed)
        trend, none = np.linspace(-1.7, 1.7, rows), np.zeros((rows, len(NAMES)))
        truth = none.copy()
        truth[:, -1] = warming * trend + np.repeat(rng.normal(0, 4, LINKS), ROWS)
        whole = _ensemble(truth, none, seed)
        return float(told_by_places(whole, whole, trend[:, None])[0, -1, 0])

    assert sum(told(0, seed) > 2.58 for seed in range(200)) <= 6  # of 200 at 1 %: P(more) = 0.005
    assert min(told(8, seed) for seed in range(20)) > 5


def test_what_the_effect_does_not_act_on_is_no_matter_of_its_own() -> None:
    assert _judged([6, 5, 4, -5], [6, 5, 4, 0]).adequate


def test_a_trend_over_the_distance_may_be_another_form_of_the_effect() -> None:
    assert _judged([0, 0, 0, -3], [0, 0, 0, -3], warming=-2.0, over="true_range_m").adequate
    assert not _judged([0, 0, 0, -3], [0, 0, 0, -3], warming=-6.0, over="true_range_m").adequate


def test_what_moves_things_that_did_not_differ_is_refused() -> None:
    nothing = np.zeros((LINKS * ROWS, len(NAMES)))
    rest = _ensemble(nothing, nothing, 5)
    wider = rest.versions * np.array([1, 1, 1, 1.5])
    wider[0] = rest.versions[0]
    found = judged(replace(rest, versions=wider), rest, (Place(),), np.ones((len(nothing), 1)), 1.0)
    assert not found.adequate
    assert "the spread of rx_power_dbm" in str(found)


def test_an_effect_cuts_down_something_that_it_was_brought_in_for() -> None:
    rows = LINKS * ROWS
    truth = np.tile(np.array([6.0, 0, 0, -5]), (rows, 1))
    whole, rest = _ensemble(truth, truth * [1, 0, 0, 0], 5), _ensemble(truth, truth * 0, 5)
    wanted = [(Cell(name, "mean", Place()), np.ones(rows)) for name in NAMES]
    assert brought(whole, rest, wanted).adequate
    refused = brought(whole, rest, wanted[3:])
    assert not refused.adequate
    assert "explains nothing of rx_power_dbm in all rows" in refused.note


def test_a_small_response_is_within_the_form_of_a_large_one() -> None:
    large, apart = np.array([[9.0, 0], [8, 0], [0, 0]]), np.array([[0.0, 0], [0, 0], [4, 0]])
    assert within(0.2 * large, large[None])
    assert not within(0.5 * large, large[None])
    assert not within(apart, large[None])


def test_the_rival_of_a_refuted_name_gained_nearly_as_much(monkeypatch: pytest.MonkeyPatch) -> None:
    tally = Tally(("rx_power_dbm",), np.ones((4, 1)), np.ones((4, 1)))
    tail, noise, loss = DiffuseTail(), NoiseFloor(), PathLoss()
    gains = {tail: 2.0, noise: 1.4, loss: 0.1}
    each = tuple(Contender(e, tally, Estimate(g, g / 2, 2 * g)) for e, g in gains.items())
    turn = Round(
        Located((), 1.0, 1.0, 9.0, 1, {}),
        Explanation(each, tally, each[0].gain, tally, {}, {}),
        tail,
    )
    monkeypatch.setattr(refute, "beside_others", lambda *a: Fitted(a[3].effect, 1.0, 0))
    monkeypatch.setattr(refute, "fits", lambda *_: Adequacy(True))
    search = _Search()

    def rival(refuted: set[str]) -> Contender | None:
        return refute._adequate_rival(search, (turn,), (tail,), tail, refuted)  # type: ignore[arg-type]

    found = rival({tail.name})
    assert found is not None
    assert found.name == noise.name
    assert rival({tail.name, noise.name}) is None


def test_chance_is_not_held_against_a_weak_effect() -> None:
    weak = [0.3, 0.2, 0.3, 0.0]
    refused = sum(not _judged(weak, weak, seed=seed).adequate for seed in range(60))
    assert refused <= 6  # of 60 at 5 %: P(more) = 0.04


Fits = Callable[[tuple[Effect, ...], Effect], bool]


def _checked(
    monkeypatch: pytest.MonkeyPatch,
    added: tuple[Effect, ...],
    fits: Fits,
    missed: bool,
    gained: float = 0.0,
) -> refute.Checked:
    """Return what is checked where `fits` says which names hold beside which others.

    `gained` is what one that was refused gains when it is taken again.
    """
    none, gain = Tally((), np.ones((4, 0)), np.ones((4, 0))), Estimate(gained, gained, gained)
    told = Explanation((), none, gain, none, {}, {})
    last = Round(Located((), 1.0, 1.0, 9.0, 1, {}), told, None)

    def looked(_: object, beside: tuple[Effect, ...], effect: Effect, __: object) -> Adequacy:
        left = {"diffuse-tail": 2.0}.get(effect.name, 0.9)
        return Adequacy(fits(beside, effect), left, 9.0, "the mean of profile_db in all rows")

    def unmissed(_: object, beside: tuple[Effect, ...], effect: Effect) -> tuple[Effect, ...]:
        return beside if missed else tuple(e for e in beside if e is not effect)

    monkeypatch.setattr(refute, "fits", looked)
    monkeypatch.setattr(refute, "_unmissed", unmissed)
    monkeypatch.setattr(refute, "polished", lambda _comparison, _rows, added, *_: added)
    monkeypatch.setattr(refute, "pruned", lambda _comparison, _rows, added, *_: added)
    monkeypatch.setattr(refute, "margin", lambda *_: 0.01)
    monkeypatch.setattr(refute, "announced", lambda _s, _l, _a, effect: replace(last, added=effect))
    monkeypatch.setattr(refute, "_left", lambda *_: True)
    monkeypatch.setattr(refute, "needless", lambda *_: None)
    monkeypatch.setattr(refute, "working", lambda _: ())
    monkeypatch.setattr(refute, "_loudest", lambda *_: Adequacy(True))
    return refute.checked(_Search(), (last,), added)  # type: ignore[arg-type]


def test_the_worst_name_is_taken_back_and_the_rest_asked_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tail, noise = DiffuseTail(), NoiseFloor()
    found = _checked(monkeypatch, (tail, noise), lambda beside, _: len(beside) == 1, missed=False)
    assert found.simulated == found.added == (noise,)
    assert [doubt.effect for doubt in found.doubts] == [tail]
    assert "the nearest, diffuse-tail, leaves" in str(found.doubts[0])


def test_a_refused_effect_that_links_miss_stays_in_the_simulator_without_its_name(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tail, noise = DiffuseTail(), NoiseFloor()
    found = _checked(monkeypatch, (tail, noise), lambda _, effect: effect is noise, missed=True)
    assert found.added == (noise,)
    assert found.simulated == (tail, noise)
    assert [doubt.effect for doubt in found.doubts] == [tail]


def test_a_refusal_that_another_effect_lifts_is_not_final(monkeypatch: pytest.MonkeyPatch) -> None:
    tail, noise, loss = DiffuseTail(), NoiseFloor(), PathLoss()
    rival = Contender(loss, Tally((), np.ones((4, 0)), np.ones((4, 0))), Estimate(1, 1, 1))
    monkeypatch.setattr(refute, "_adequate_rival", lambda *a: rival if a[3] is noise else None)
    for gained, taken in ((0.0, ()), (1.0, (noise,))):
        lifted = _checked(
            monkeypatch, (tail, noise), lambda beside, _: loss in beside, missed=True, gained=gained
        )
        assert lifted.added == lifted.simulated == (tail, loss, *taken)
        assert [turn.added for turn in lifted.rounds[:-1]] == list(taken)
        assert not lifted.doubts


@dataclass(frozen=True)
class _Fit:
    waveform: bool = True


@dataclass(frozen=True)
class _Search:
    comparison: None = None
    fit: _Fit = _Fit()
    discover: None = None
    seed: int = 0
    kinds: None = None
    choice: Choice = field(default_factory=Choice)
    logged: tuple[()] = ()


def test_an_effect_takes_the_place_of_another() -> None:
    tail, noise = DiffuseTail(), NoiseFloor()
    other = replace(noise, level_db=3.0)
    assert refute.swapped_for((tail, noise), noise, other) == (tail, other)


def test_a_level_control_that_ends_no_accumulation_is_none() -> None:
    assert refute.unused(LevelControl(accumulation=0.1)) == ""
    assert "accumulation" in refute.unused(LevelControl(accumulation=0.001))
    assert refute.unused(NoiseFloor()) == ""
    assert "share" in refute.unused(NarrowbandInterference(share=0.0, level_db=-9.0))
    assert refute.unused(NarrowbandInterference(share=0.3, level_db=-9.0)) == ""


def test_an_essential_parameter_does_something_within_its_bounds() -> None:
    (item,) = (p for p in PathLoss.parameters() if p.name in PathLoss.essential)
    words = [
        refute.idle(item, ParameterEstimate(item.name, value, value - 0.2, value + 0.2, "1"))
        for value in (2.7, 2.05, 2.15, 1.03)
    ]
    assert words[0] == ""
    assert "do as well" in words[1]
    assert "do as well" in words[2]
    assert "bound" in words[3]
