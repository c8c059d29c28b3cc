"""What is said of a set of waveform effects: a refused name takes what may mend its form along."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import NOISE, RANGE, Window
from bench.discrepancy.joint import turn, verdicts
from bench.discrepancy.joint.choice import WaveChoice
from bench.discrepancy.joint.rows import fewer
from bench.discrepancy.joint.verdicts import beside_untold, standing
from bench.discrepancy.locate.finding import Finding
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.select.undetermined import taken_away
from bench.discrepancy.select.verdict import Control, LeftOut, Unknown, Verdict
from bench.discrepancy.sets.choice import MERE, Choice
from bench.physics.effect import Effect
from bench.physics.effects.propagation.fading import SmallScaleFading
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.late_detection import LateDetection
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.effects.receiver.pulse_ringing import PulseRinging
from bench.physics.effects.receiver.quantisation import Quantisation

GAIN = Estimate(1, 0.5, 1.5, "nats")
REFUSED = Unknown((), GAIN, {}, "looks most like it")


def said(*effects: Effect) -> dict[str, Verdict]:
    """Return names of effects, and a refused pulse-ringing."""
    held: dict[str, Verdict] = {
        e.name: LeftOut(e, (), GAIN, 1.0, Control("", None)) for e in effects
    }
    return held | {"pulse-ringing": REFUSED}


def names(verdicts: tuple[Verdict, ...]) -> set[str]:
    """Return all names that are stated."""
    return {name for verdict in verdicts for name in verdict.names}


def test_what_brings_little_beside_a_refused_name_goes_with_it():
    choice = WaveChoice(nats={"pulse-ringing": 100.0, "noise-floor": 150.0})
    assert names(standing(said(NoiseFloor()), choice)) == set()
    loud = WaveChoice(nats={"pulse-ringing": 100.0, "noise-floor": 350.0})
    assert names(standing(said(NoiseFloor()), loud)) == {"noise-floor"}


def test_less_noise_than_simulated_is_nothing_that_was_left_out():
    assert "1.5 dB" in taken_away(NoiseFloor(level_db=-1.5))
    assert not taken_away(NoiseFloor(level_db=1.5))
    assert not taken_away(PathLoss(exponent=1.5))


def test_what_a_refused_name_does_not_do_in_any_form_stands_beside_it():
    choice = WaveChoice(
        nats={"pulse-ringing": 100.0, "noise-floor": 150.0},
        beyond={"noise-floor": ("pulse-ringing",)},
    )
    assert names(standing(said(NoiseFloor()), choice)) == {"noise-floor"}


def test_a_noise_floor_does_not_stand_beside_a_refused_tone():
    """To first order a tone does to magnitudes what noise does: either may mend the other."""
    noise, tone = NoiseFloor(level_db=3.0), NarrowbandInterference(level_db=1.0)
    held = {name: one for name, one in said(noise).items() if one.names} | {tone.name: REFUSED}
    choice = WaveChoice(
        (noise, tone),
        nats={tone.name: 100.0, noise.name: 900.0},
        beyond={noise.name: (tone.name,)},
    )
    assert names(standing(held, choice)) == set()
    assert names(standing({noise.name: held[noise.name]}, choice)) == {noise.name}


def test_what_another_tool_logs_of_noise_refuses_no_tone_beside_a_noise_floor():
    noise, tone, loss = NoiseFloor(level_db=6.0), NarrowbandInterference(), PathLoss()
    table = TableComparison(pd.DataFrame({"true_range_m": [1.0]}), Window())
    options, why = [noise, tone, loss], ["", "109% is left in noise_std", "90% is left"]
    assert beside_untold(table, noise, options, why) == ["", "", "90% is left"]
    again = Resimulation.__new__(Resimulation)  # its own log is known to be of scatter
    assert beside_untold(again, noise, options, why) == why


def test_marks_and_ranges_stand_beside_a_refused_name():
    choice = WaveChoice(
        nats={"pulse-ringing": 100.0, "quantisation": 20.0}, marked=("quantisation",)
    )
    held = standing(said(Quantisation(), AntennaDelay()), choice)
    assert names(held) == {"quantisation", "antenna-delay"}
    assert REFUSED in held


def test_what_is_doubted_is_named_only_by_its_mark():
    both = (PulseRinging(ring_db=-10.0), Quantisation())
    found = WaveChoice(both, marked=("quantisation",), doubted=("pulse-ringing", "quantisation"))
    assert [effect.name for effect in found.named] == ["quantisation"]
    assert found.likeness() == "looks most like pulse-ringing, but "
    assert found.likeness(["pulse-ringing"]) == ""
    assert WaveChoice(both, unexplained=True).named == both
    assert WaveChoice(both).likeness() == ""
    assert found.unlisted  # a doubted name stands for something that nobody listed
    assert WaveChoice(both, unexplained=True).unlisted
    assert not WaveChoice(both).unlisted


def test_fewer_rows_are_of_all_links():
    links = np.repeat(np.arange(30), 10)
    frame = pd.DataFrame(
        {"link": links, "true_range_m": np.arange(300.0) + 1, "error_m": np.zeros(300)}
    )
    rows = view(frame, links, np.arange(300), Window(), None, False)
    some = fewer(rows, 60)
    assert len(some.rows) == 60
    assert len(np.unique(some.links)) == 30
    assert some.frame["true_range_m"].to_numpy().tolist() == (some.rows + 1.0).tolist()
    assert fewer(rows, 300) is rows


@pytest.mark.parametrize("jumpy", [LateDetection(rise_db=6.0), SmallScaleFading(direct_m=2.0)])
def test_what_scatters_beside_first_paths_that_jump_is_no_scatter_of_its_own(jumpy):
    state = SimpleNamespace(search=None, added=(PathLoss(), jumpy))
    assert turn.with_scatter(state, None, WaveChoice()) is state
    assert not PathLoss.jumps


def test_why_the_only_name_is_refused_is_said(monkeypatch):
    seen = Finding(Cell("energy_db", "mean", Place()), Estimate(3, 2, 4), 9.0, 0.001, 9, 9)
    last = SimpleNamespace(
        located=SimpleNamespace(findings=(seen,), significant=True), explanation=None, added=None
    )
    loss = PathLoss()
    first = SimpleNamespace(**{**vars(last), "added": loss}, strike=None)
    monkeypatch.setattr(verdicts, "_said", lambda *_: REFUSED)
    monkeypatch.setattr(verdicts, "sizes_seen", lambda *_: None)
    search = SimpleNamespace(choice=Choice())
    found = verdicts.wave_verdicts(search, (first, last), (loss,), WaveChoice((loss,)))
    assert len(found) == 1
    assert found[0].note.startswith(REFUSED.note)


def test_a_small_constant_beside_waveforms_is_said(monkeypatch):
    """Nothing is named, and no other search need find it: ranges of all working rows did."""
    seen = Finding(Cell(RANGE, "mean", Place()), Estimate(0.03, 0.02, 0.04), 9.0, 0.001, 9, 9)
    first = SimpleNamespace(
        located=SimpleNamespace(findings=(seen,), significant=True), explanation=None, added=None
    )
    nothing = SimpleNamespace(findings=(), significant=False, detectable={}, p=0.5)
    last = SimpleNamespace(located=nothing, explanation=None, added=None, strike=None)
    first.strike = None
    monkeypatch.setattr(verdicts, "real", lambda *_: False)
    search = SimpleNamespace(choice=Choice(others=(MERE,)))
    found = verdicts.wave_verdicts(search, (first, last), (), WaveChoice())
    assert [one.note for one in found] == [verdicts.CONSTANT]
    assert found[0].findings == (seen,)
    search = SimpleNamespace(choice=Choice())
    assert verdicts.wave_verdicts(search, (first, last), (), WaveChoice())[0].names == ()
    assert not isinstance(
        verdicts.wave_verdicts(search, (first, last), (), WaveChoice())[0], Unknown
    )


def test_what_is_left_of_ranges_is_said_only_where_no_detector_would_leave_it(monkeypatch):
    seen = Finding(Cell(RANGE, "mean", Place()), Estimate(0.03, 0.02, 0.04), 9.0, 0.001, 9, 9)
    left = SimpleNamespace(removable=Estimate(0.7, 0.6, 0.8, "nats"))
    last = SimpleNamespace(
        located=SimpleNamespace(findings=(seen,), significant=True), explanation=left, added=None
    )
    late = LateDetection(rise_db=0.0)
    first = SimpleNamespace(**{**vars(last), "added": late}, strike=None)
    last.strike = None
    monkeypatch.setattr(verdicts, "_said", lambda *_: said(late)[late.name])
    monkeypatch.setattr(verdicts, "sizes_seen", lambda *_: None)
    monkeypatch.setattr(verdicts, "seen_beside", lambda _, made, *__: made)
    misplaced = Choice((), forms_do=True, tied=("antenna-delay",))
    fault = Choice((), ("the position of a3",), forms_do=True)
    law = Choice((), ("a law of time_s",), forms_do=True)
    every = ((Choice(forms_do=True), 1), (Choice(), 2), (misplaced, 2), (fault, 2), (law, 1))
    for choice, count in every:
        search = SimpleNamespace(choice=choice)
        made = verdicts.wave_verdicts(search, (first, last), (late,), WaveChoice((late,)))
        assert len(made) == count


@pytest.mark.parametrize(
    ("observables", "of_form", "others", "left"),
    [((), False, (), 1), ((RANGE,), True, (), 1), ((RANGE,), False, (), 2),
     (("rise_ns",), True, (), 2), ((), False, ("the position of a3",), 2)],
)  # fmt: skip
def test_what_no_search_finds_beside_names_is_not_there(
    monkeypatch, observables, of_form, others, left
):
    cells = [SimpleNamespace(cell=Cell(name, "mean", Place())) for name in observables]
    found = SimpleNamespace(findings=tuple(cells), significant=bool(cells))
    beside = []
    monkeypatch.setattr(verdicts, "replace", lambda search, **_: search)
    monkeypatch.setattr(verdicts, "locate_left", lambda _, held, __: beside.append(held) or found)
    monkeypatch.setattr(verdicts, "made_by_forms", lambda *_: of_form)
    loss, noise = PathLoss(), NoiseFloor(level_db=-0.03)
    search = SimpleNamespace(choice=Choice((), others), both=None)
    both = tuple(said(loss).values())
    made = verdicts.seen_beside(search, both, (noise, loss), (None,))
    assert len(made) == left
    assert all(held == (loss,) for held in beside)  # what is refused takes no part
    assert verdicts.seen_beside(search, (REFUSED,), (noise,), (None,)) == (REFUSED,)


@pytest.mark.parametrize(("observables", "left"), [((NOISE,), 1), ((NOISE, "rise_ns"), 2), ((), 2)])
def test_what_only_the_log_of_a_named_effect_says_is_its_form(monkeypatch, observables, left):
    """Noise that is louder in some rows is noise all the same; beside another name it is not."""
    cells = [SimpleNamespace(cell=Cell(name, "slope", Place("mill_kw"))) for name in observables]
    found = SimpleNamespace(findings=tuple(cells), significant=bool(cells))
    monkeypatch.setattr(verdicts, "replace", lambda search, **_: search)
    monkeypatch.setattr(verdicts, "locate_left", lambda *_: found)
    monkeypatch.setattr(verdicts, "made_by_forms", lambda *_: False)
    noise, loss = NoiseFloor(level_db=3.0), PathLoss()
    search = SimpleNamespace(choice=Choice((), ("the position of a3",)), both=None)
    of_noise = LeftOut(noise, (), GAIN, 1.0, Control("", None)), REFUSED
    assert len(verdicts.seen_beside(search, of_noise, (noise,), (None,))) == left
    of_loss = LeftOut(loss, (), GAIN, 1.0, Control("", None)), REFUSED
    assert len(verdicts.seen_beside(search, of_loss, (loss,), (None,))) == 2


def test_a_fault_of_ranges_is_there_though_no_regression_foretells_it(monkeypatch):
    monkeypatch.setattr(verdicts, "real", lambda *_: False)
    rounds = (SimpleNamespace(strike=None),)
    for others, more in ((("the position of a3",), True), (("a law of time_s",), False)):
        search = SimpleNamespace(choice=Choice((), others))
        assert verdicts._more(search, rounds) is more


def test_what_a_log_shows_is_refused_by_no_interval(monkeypatch):
    """Its log is a measurement of it, however small it is; a failed control is none."""
    noise = NoiseFloor(level_db=0.5)
    option = LeftOut(noise, (), GAIN, 1.0, Control("", None))
    monkeypatch.setattr(verdicts, "untold", lambda option: True)
    monkeypatch.setattr(verdicts, "adequacy", lambda *_: SimpleNamespace(adequate=False))
    monkeypatch.setattr(verdicts, "surely_there", lambda *_: False)
    search, plain = SimpleNamespace(), WaveChoice(scattering=(noise.name,))
    shown = WaveChoice(scattering=(noise.name,), shown=(noise.name,))
    assert "told from zero" in verdicts._objection(search, (), option, noise, plain)
    assert verdicts._objection(search, (), option, noise, shown) == ""
    there = LeftOut(noise, (), GAIN, 1.0, Control("rows", False))
    assert verdicts._objection(search, (), there, noise, shown)
    monkeypatch.setattr(verdicts, "surely_there", lambda *_: True)
    assert verdicts._objection(search, (), option, noise, WaveChoice()) == ""
