"""Sealed links refuse what makes them worse; absolute errors are counted from the median."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.skill import Tally
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.untimed import Untimed
from bench.discrepancy.confirm import Served, is_farther, served
from bench.discrepancy.data.observables import RANGE, Window
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.headline import headline
from bench.discrepancy.law.found import FAULT, LAW
from bench.discrepancy.law.unexplained import weighed
from bench.discrepancy.locate.finding import Finding, Located
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.select import sealed
from bench.discrepancy.select.candidates import Explanation
from bench.discrepancy.select.conclude import of_class
from bench.discrepancy.select.link_mixture import Strike
from bench.discrepancy.select.objections import objection
from bench.discrepancy.select.sealed import unrefused
from bench.discrepancy.select.state import Round, Selection
from bench.discrepancy.select.undetermined import undetermined
from bench.discrepancy.select.unnamed import unnamed
from bench.discrepancy.select.verdict import Ambiguous, Control, LeftOut, Unknown
from bench.discrepancy.sets.choice import Choice
from bench.physics.effect import Effect
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.time_lag import TimeLag
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.effects.receiver.pulse_ringing import PulseRinging

DELAY, SCALE, LAG = AntennaDelay(), RangeScale(), TimeLag()
ONE = Estimate(1, 0.5, 1.5)
UNTOLD, WORSE = Estimate(-0.1, -0.5, 0.4), Estimate(-1, -1.5, -0.5)
LINKS = np.repeat(np.arange(40), 3)


def named(effect: Effect) -> LeftOut:
    return LeftOut(effect, (), ONE, 1.0, Control("", None))


def selection() -> Selection:
    """Return a selection of a class and a name."""
    tally = Tally(("error_m",), np.ones((4, 1)), np.ones((4, 1)))
    told = Explanation((), tally, ONE, tally, {}, {})
    turn = Round(Located((), 0.002, 9.0, 3.0, 1, {}), told, None)
    said = Ambiguous((named(DELAY), named(SCALE)), ""), named(LAG)
    return Selection(said, (DELAY, LAG), (turn,))


def kept(monkeypatch: pytest.MonkeyPatch, wrong: tuple[object, ...]) -> Selection:
    """Return what stays where sealed links are worse with some effects, better with others."""

    def judge(_: object, __: object, added: tuple[object, ...], ___: int) -> Served:
        bad = sum(one in wrong for one in added)
        gain = len(added) - 3.0 * bad
        return Served(Estimate(gain, gain - 1, gain + 1), bad > 0, 0.1 * bad)

    monkeypatch.setattr(sealed, "served", judge)
    rows = SimpleNamespace(frame=pd.DataFrame({"error_m": [0.0]}), waveform=False)
    return unrefused(None, rows, selection(), (), 0)[0]  # type: ignore[arg-type]


def test_what_makes_sealed_links_worse_loses_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    found = kept(monkeypatch, (DELAY, SCALE))
    assert found.names == (("time-lag",),)
    assert found.added == (LAG,)
    assert "antenna-delay or range-scale" in found.verdicts[-1].note
    assert not found.sealed_choice
    assert kept(monkeypatch, ()).added == (DELAY, LAG)
    assert len(kept(monkeypatch, ()).verdicts) == 2
    nothing = kept(monkeypatch, (DELAY, LAG))
    assert (nothing.names, nothing.added, len(nothing.verdicts)) == ((), (), 1)


@pytest.mark.parametrize(("missed_m", "said"), [(0.1, True), (0.1001, False)])
def test_sealed_links_refuse_no_name_of_what_does_nothing_there(
    monkeypatch: pytest.MonkeyPatch, missed_m: float, said: bool
) -> None:
    """No metal stands in any of them."""
    judged = Served(Estimate(0, 0, 0), False, missed_m, 0.1)
    monkeypatch.setattr(sealed, "served", lambda *_: judged)
    found = replace(selection(), added=(LAG,), verdicts=(named(LAG),))
    rows = SimpleNamespace(frame=pd.DataFrame({"error_m": [0.0]}), waveform=False)
    made = unrefused(None, rows, found, (), 0)[0]  # type: ignore[arg-type]
    assert made.added == ()
    assert bool(made.names) is said
    assert ("changes nothing in sealed links" in made.withheld.get("time-lag", "")) is said


@pytest.mark.parametrize(
    ("high", "nats", "surely", "said"),
    [
        (1, -4, False, True),
        (-1, -4, False, False),
        (-1, None, False, False),
        (-1, -2, False, True),
        (-1, -4, True, False),
        (-1, -2, True, True),
    ],
)
def test_what_strikes_few_links_keeps_its_name_unless_worse_beyond_chance(
    monkeypatch: pytest.MonkeyPatch, high: float, nats: float | None, surely: bool, said: bool
) -> None:
    """Nor where offsets of sealed links may be of it, whatever the median of versions does."""
    judged = Served(Estimate(-2, -3, high), False, 0.1, surely=surely)
    monkeypatch.setattr(sealed, "served", lambda *_: judged)
    monkeypatch.setattr(sealed, "STRUCK", lambda *_: nats)
    found = selection()
    strike = Strike(LAG, ONE, (), np.empty(0, np.intp))
    found = replace(found, added=(LAG,), verdicts=(named(LAG),),
                    rounds=(replace(found.rounds[0], strike=strike),))  # fmt: skip
    rows = SimpleNamespace(frame=pd.DataFrame({"error_m": [0.0]}), waveform=False)
    made = unrefused(None, rows, found, (), 0)[0]  # type: ignore[arg-type]
    assert made.added == ()
    assert bool(made.names) is said
    assert ("time-lag" in made.withheld) is said


@pytest.mark.parametrize(("share", "said"), [(0.04, True), (0.3, False)])
def test_a_score_says_nothing_where_chance_may_spare_all_sealed_links(
    monkeypatch: pytest.MonkeyPatch, share: float, said: bool
) -> None:
    """Of 40 links that are struck with a chance of 0.04 none is in one of five draws."""
    monkeypatch.setattr(sealed, "served", lambda *_: Served(Estimate(-2, -3, -1), False, 0.1, 0.1))
    known = ParameterEstimate("share", share, share / 2, 2 * share, "ratio")
    strike = Strike(LAG, ONE, (known,), np.empty(0, np.intp))
    found = selection()
    found = replace(found, added=(LAG,), verdicts=(named(LAG),),
                    rounds=(replace(found.rounds[0], strike=strike),))  # fmt: skip
    frame = pd.DataFrame({"error_m": np.zeros(len(LINKS))})
    rows = SimpleNamespace(frame=frame, waveform=False, links=LINKS)
    made = unrefused(None, rows, found, (), 0)[0]  # type: ignore[arg-type]
    assert made.added == ()
    assert bool(made.names) is said


@pytest.mark.parametrize(("waves", "said"), [(1.0, True), (-1.0, False)])
def test_a_detector_does_not_take_the_name_of_what_waveforms_bear_out(
    monkeypatch: pytest.MonkeyPatch, waves: float, said: bool
) -> None:
    """Ranges are worse with it on sealed links: only what it does to waveforms decides."""
    judged = Served(Estimate(-1, -2, 1), True, 0.1, 0.02, Estimate(waves, waves - 2, waves + 2))
    monkeypatch.setattr(sealed, "served", lambda *_: judged)
    found = selection()
    ringing = PulseRinging(ring_db=-10.0)
    found = replace(found, added=(ringing,), verdicts=(named(ringing),))
    rows = SimpleNamespace(frame=pd.DataFrame({"error_m": [0.0]}), waveform=True)
    made = unrefused(None, rows, found, (), 0)[0]  # type: ignore[arg-type]
    assert made.added == ()
    assert bool(made.names) is said


@pytest.mark.parametrize(("gain", "stays"), [(1.0, True), (-1.0, False)])
def test_in_a_table_waveforms_keep_an_effect_whose_ranges_are_refused(
    monkeypatch: pytest.MonkeyPatch, gain: float, stays: bool
) -> None:
    """It comes back without what it does to ranges, if it serves so."""

    def judge(comparison: object, *_: object) -> Served:
        apart = isinstance(comparison, Untimed)
        return Served(Estimate(gain, gain - 1, gain + 1), not apart, 0.1, 0.1, ONE)

    monkeypatch.setattr(sealed, "served", judge)
    ringing = PulseRinging(ring_db=-10.0)
    found = replace(selection(), added=(ringing,), verdicts=(named(ringing),))
    rows = SimpleNamespace(frame=pd.DataFrame({"error_m": [0.0]}), waveform=True)
    table = TableComparison(rows.frame, Window())
    made = unrefused(table, rows, found, (), 0)[0]  # type: ignore[arg-type]
    assert made.names == (("pulse-ringing",),)
    assert (made.added == (ringing,)) is stays
    assert (made.untimed == ("pulse-ringing",)) is stays
    assert ("without what it does to ranges" in made.withheld["pulse-ringing"]) is stays


def test_of_three_causes_none_is_said_of_waveforms() -> None:
    turn = selection().rounds[0]
    options = tuple(map(named, (DELAY, SCALE, LAG)))
    names = tuple(option.names[0] for option in options)
    for waveform, most in ((True, 2), (False, 3)):
        said = [of_class(turn, options[:i], waveform).names for i in (1, 2, 3)]
        assert said == [names[:i] if i <= most else () for i in (1, 2, 3)]


def test_a_cause_of_which_no_size_is_determined_is_no_name() -> None:
    sizes = [ParameterEstimate(n, 1.0, 0.0, 1.5, "ratio", determined=False)
             for n in ("compression", "accumulation")]  # fmt: skip
    made = LeftOut(LevelControl(), tuple(sizes), ONE, 1.0, Control("", None))
    assert undetermined(made)
    assert not undetermined(
        replace(made, parameters=(replace(sizes[0], determined=True), sizes[1]))
    )
    assert not undetermined(named(LAG))


@pytest.mark.parametrize("waveform", [False, True])
def test_ranges_on_a_grid_stay_rounded_whatever_sealed_links_say(
    monkeypatch: pytest.MonkeyPatch, waveform: bool
) -> None:
    monkeypatch.setattr(sealed, "served", lambda *_: Served(Estimate(-2, -3, -1), True, 0.1))
    made = RangeRounding(step_m=0.15)
    found = replace(selection(), added=(made,), verdicts=(named(made),))
    rows = SimpleNamespace(frame=pd.DataFrame({"error_m": [0.0]}), waveform=waveform)
    kept_names = unrefused(None, rows, found, (), 0)[0].names  # type: ignore[arg-type]
    assert kept_names == (("range-rounding",),)


@pytest.mark.parametrize(
    ("effect", "beside", "named"),
    [
        (TimestampJitter(), (), True),
        (TimestampJitter(), (RangeRounding(step_m=0.1),), False),
        (LevelControl(), (), False),
    ],
)
def test_scatter_needs_no_width_of_its_own(
    effect: Effect, beside: tuple[Effect, ...], named: bool
) -> None:
    """Rows of one link tell how much there is; beside a grid another form of that may be it."""
    sizes = [ParameterEstimate(p.name, 1.0, 0.0, 2.0, p.unit, determined=False)
             for p in effect.parameters()]  # fmt: skip
    made = LeftOut(effect, tuple(sizes), ONE, 1.0, Control("", None))
    search = SimpleNamespace(
        choice=Choice(), logged=(), fit=SimpleNamespace(waveform=False, recorded=None)
    )
    turn, added = selection().rounds[0], (*beside, effect)
    assert (objection(search, turn, added, effect, made) == "") is named  # type: ignore[arg-type]


class Striking:
    """A comparison in which an effect strikes a share of the links, by a metre."""

    def __init__(self, share: float = 0.1) -> None:
        self.share = share

    def ensemble(self, *asked: object) -> Ensemble:
        rng = np.random.default_rng(2)
        versions = rng.normal(0, 0.02, (31, len(LINKS), 1))
        struck = rng.random((31, 40, 1)) < self.share
        versions[0] += struck[0][LINKS]
        if asked[1]:
            versions[1:] += struck[1:][:, LINKS]
        return Ensemble(("error_m",), ("m",), versions, LINKS)


def test_what_strikes_some_links_makes_the_others_no_worse() -> None:
    rows = SimpleNamespace(links=LINKS, waveform=False)
    before, after = (served(Striking(), rows, some, 0) for some in ((), (DELAY,)))  # type: ignore[arg-type]
    assert after.serves
    assert after.missed_m < 1.02 * before.missed_m


def test_spared_links_are_typical_beside_what_strikes_a_good_share() -> None:
    rows = SimpleNamespace(links=LINKS, waveform=False)
    by_name, by_all = (
        served(Striking(0.3), rows, (effect,), 0)  # type: ignore[arg-type]
        for effect in (BlockedPath(), DELAY)
    )
    assert by_name.medians_m[1] == by_name.medians_m[0]
    assert not by_name.farther
    assert by_all.medians_m[1] > by_all.medians_m[0]  # an effect on all links has no such excuse


def test_worse_is_what_anybody_would_notice() -> None:
    sure, maybe = Estimate(-0.01, -0.02, -0.001), Estimate(-0.01, -0.02, 0.001)
    assert is_farther(sure, (1.0, 1.03), (1.0, 1.0))
    assert not is_farther(sure, (1.0, 1.01), (1.0, 1.0))
    assert not is_farther(sure, (0.021, 0.0224), (0.02, 0.02))
    assert not is_farther(maybe, (1.0, 1.2), (1.0, 1.0))
    assert is_farther(maybe, (1.0, 1.0), (1.0, 1.3))


def test_of_spoilt_recordings_the_first_line_says_so_and_no_law_is_looked_for() -> None:
    spoilt = Unknown((), ONE, {}, "", cause="samples are clipped")
    found = Selection((spoilt,), (), selection().rounds)
    assert weighed(None, found).proposal is None  # type: ignore[arg-type]
    assert unnamed(None, found) == ()  # type: ignore[arg-type]
    line = headline(found.verdicts, False, None)  # type: ignore[arg-type]
    assert line.startswith("Something is there, without a name: samples are clipped.")


@pytest.mark.parametrize(
    ("names", "more", "said"),
    [
        ((), f"{FAULT}: a and b are swapped", "A fault of the set-up: a and b are swapped. "),
        ((LAG,), f"{LAW} without a name: error = 1", "Left out: time-lag - and a law without a na"),
        (
            (LAG,),
            "a constant 1 m",
            "Left out: time-lag - and something without a name (a co",
        ),
        ((), "", "Something is there, without a name. "),
    ],
)
def test_a_law_or_a_fault_stands_for_itself(
    names: tuple[Effect, ...], more: str, said: str
) -> None:
    verdicts = (*map(named, names), Unknown((), Estimate(0.0, 0.0, 0.0)))
    assert headline(verdicts, False, None, more).startswith(said)  # type: ignore[arg-type]


def test_the_headline_says_why_a_name_was_not_added() -> None:
    worse = Served(Estimate(3.8, 3.2, 4.2), True, 0.0293, 0.0239)
    why = {"time-lag": f"was not added: {worse}"}
    line = headline((named(LAG),), False, SimpleNamespace(), "", why)  # type: ignore[arg-type]
    assert "Nothing was added" not in line
    assert "time-lag was not added: with it the score is better, but ranges are worse" in line
    assert "0.0239 -> 0.0293 m" in line


def test_what_is_said_to_be_worse_is_worse() -> None:
    """The mean may be nearer where most links are farther: it is the median that is worse then."""
    worse = Served(Estimate(3, 2, 4), True, 0.203, 0.21, medians_m=(0.020, 0.034))
    assert str(worse).endswith(
        "ranges are worse: median |recorded - simulated| 0.02 -> 0.034 m, on sealed links"
    )


@pytest.mark.parametrize(("gain", "said"), [(0.2, "beside the others"), (-0.2, "no better")])
def test_why_an_effect_was_not_added_goes_by_what_it_does_alone(gain: float, said: str) -> None:
    alone = Served(Estimate(gain, gain - 0.1, gain + 0.1, "nats"), False, 0.1, 0.1)
    assert said in sealed._why(alone)


@pytest.mark.parametrize(("surely", "said"), [(False, True), (True, False)])
def test_what_strikes_most_links_may_move_the_median_away(
    monkeypatch: pytest.MonkeyPatch, surely: bool, said: bool
) -> None:
    """The mean is nearer by it; spared links are far from what most of them are."""
    judged = Served(Estimate(1, -1, 3), True, 0.25, 0.3, medians_m=(0.03, 0.13), surely=surely)
    monkeypatch.setattr(sealed, "served", lambda *_: judged)
    strike = Strike(LAG, ONE, (), np.empty(0, np.intp))
    found = selection()
    found = replace(found, added=(LAG,), verdicts=(named(LAG),),
                    rounds=(replace(found.rounds[0], strike=strike),))  # fmt: skip
    rows = SimpleNamespace(frame=pd.DataFrame({"error_m": [0.0]}), waveform=False, links=LINKS)
    made = unrefused(None, rows, found, (), 0)[0]  # type: ignore[arg-type]
    assert made.added == ()
    assert bool(made.names) is said


@pytest.mark.parametrize(
    ("score", "likelier", "said"),
    [(UNTOLD, True, True), (UNTOLD, False, False), (WORSE, True, False)],
)
def test_where_scores_of_waveforms_tell_nothing_their_likelihood_does(
    monkeypatch: pytest.MonkeyPatch, score: Estimate, likelier: bool, said: bool
) -> None:
    """A name that working links' score left open needs sealed links' likelihood in any case."""
    judged = Served(score, False, 0.1, 0.1, score)
    monkeypatch.setattr(sealed, "served", lambda *_: judged)
    monkeypatch.setattr(sealed, "LIKELIER", lambda *_: likelier)
    rings = PulseRinging()
    name = replace(named(rings), gain=UNTOLD)
    found = replace(selection(), added=(rings,), verdicts=(name,))
    rows = SimpleNamespace(frame=pd.DataFrame({"error_m": [0.0]}), waveform=True)
    made = unrefused(None, rows, found, (), 0)[0]  # type: ignore[arg-type]
    assert made.added == ()
    assert bool(made.names) is said


def test_what_ranges_still_differ_by_is_said_of_what_was_not_added() -> None:
    """A constant of 0.1 m beside a tail that was not added for its ranges had not been said."""
    cells = (Cell(name, "mean", Place()) for name in ("first_path_lead_ns", RANGE))
    seen = tuple(Finding(one, Estimate(0.11, 0.09, 0.13), 9.0, 0.002, 40, 8) for one in cells)
    turns = (SimpleNamespace(located=SimpleNamespace(findings=seen)),)
    words = sealed._left_of_ranges(SimpleNamespace(rounds=turns))  # type: ignore[arg-type]
    assert words.startswith(f"; with it ranges still differ: {RANGE} in all rows: recorded - sim")
    assert sealed._left_of_ranges(SimpleNamespace(rounds=())) == ""  # type: ignore[arg-type]
