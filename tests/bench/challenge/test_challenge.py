"""The challenge: sealed, resumable, by defaults, and scored without favour."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
import pytest

from bench.challenge import blind, cases
from bench.challenge.blind import run_blind, seal
from bench.challenge.blind_report import blind_markdown
from bench.challenge.cases import LIMIT_Z, Case, drawn_of, make_case
from bench.challenge.rates import Rate, cause, median_share, rates
from bench.challenge.scoring import Outcome, blank, scored
from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.diagnosis import Diagnosis
from bench.discrepancy.select.verdict import Unknown
from bench.errors import BenchError
from bench.parallel import Spread
from bench.recordings.table import Recordings

DEVELOPED = ("mint", "breadworks")


@pytest.fixture(scope="module")
def case() -> Case:
    number = next(n for n in range(1, 400) if _alone(n))
    return make_case(number, 4, ("mint",))


def _alone(number: int) -> bool:
    """Whether a case hides one effect of the library that shifts ranges, in a table."""
    turn, drawn = drawn_of(number, 4, ("mint",))
    return turn.mode == "ranges" and drawn.hidden == ("temperature-drift",)


@pytest.mark.parametrize("mode", ["CIR", "CIR again"])
def test_of_several_causes_the_weakest_beside_the_others_is_asked_for(mode: str) -> None:
    """A loud tail or echo does not make a quiet shift of ranges one that must be found."""
    made = make_case(next(n for n in range(20_000) if _hides_both(n, mode)), 6)
    assert 0 < made.strength_z < cases._moved(made.clean, made.recorded.frame)


def _hides_both(number: int, mode: str) -> bool:
    """Return whether a case of a mode hides something loud in waveforms and a shift of ranges."""
    turn, drawn = drawn_of(number, 6)
    loud, quiet = {"diffuse-tail", "pulse-ringing"}, {"range-scale", "antenna-delay"}
    both = loud & set(drawn.hidden) and quiet & set(drawn.hidden)
    return turn.mode == mode and bool(both) and drawn.strength <= 0.5


def test_the_seal_holds_the_answers_of_a_whole_challenge():
    assert seal(20, 1, DEVELOPED) == seal(40, 1, DEVELOPED)
    assert seal(20, 1, DEVELOPED) != seal(20, 2, DEVELOPED)


def test_strength_counts_standard_deviations_of_a_matched_filter(case):
    assert case.strength_z > 0
    assert case.above_limit == (case.strength_z >= LIMIT_Z)
    half = replace(case, shifts_m=np.zeros_like(case.shifts_m))
    assert half.strength_z != case.strength_z


def test_of_scatter_no_test_knows_the_draws():
    """Of 400 rows a third of the variance more is 4 standard deviations of a variance, no 10."""
    rng = np.random.default_rng(0)
    noise, jitter = rng.normal(0, 0.03, 400), rng.normal(0, 0.03 * np.sqrt(1 / 3), 400)
    made = pd.DataFrame({"error_m": noise + jitter})
    knowing, scatter = (
        cases._matched(made, jitter[None], (name,))
        for name in ("antenna-delay", "timestamp-jitter")
    )
    assert 8 < knowing < 12
    assert 3 < scatter < 6


@pytest.mark.parametrize("beside", ["timestamp-jitter", "range-rounding"])
def test_scatter_and_rounding_are_noise_to_a_test_for_anything_else(beside):
    """A drift of 1 cm beside 3 cm of noise alone is loud; where 10 cm more scatter, it is not."""
    rng = np.random.default_rng(1)
    drift, scatter = rng.normal(0, 0.01, 900), rng.normal(0, 0.1, 900)
    made = pd.DataFrame({"error_m": rng.normal(0, 0.03, 900) + drift + scatter})
    shifts = np.stack([drift, scatter])
    known, noise = (
        cases._matched(made, shifts, ("range-scale", name)) for name in ("antenna-delay", beside)
    )
    assert known == pytest.approx(np.sqrt(0.75 * 900) / 3, rel=0.2)
    assert noise == pytest.approx(known * 0.03 / np.hypot(0.03, 0.1), rel=0.5)


def test_cases_do_not_show_their_answer(case):
    assert not {"clock_offset_ppm", "_rare"} & set(case.recorded.frame)
    assert not case.recorded.simulated
    assert case.simulated.simulated


def test_an_effect_whose_columns_are_missing_counts_as_outside():
    cases = (make_case(n, 1, ("aviary",)) for n in range(1, 400) if _unlisted_wall(n))
    assert "material-delay" in next(cases).outside


def _unlisted_wall(number: int) -> bool:
    _, drawn = drawn_of(number, 1, ("aviary",))
    return "material-delay" in drawn.hidden and not drawn.listed


@dataclass(frozen=True)
class Said:
    """What a diagnosis says, as far as scores ask."""

    verdicts: tuple[object, ...]
    names: tuple[tuple[str, ...], ...]

    @property
    def selection(self) -> Said:
        """Itself."""
        return self


def _said(*names: str) -> Said:
    rest = Unknown((), Estimate(1.0, 0.5, 1.5), {}, "")
    return Said((rest,), tuple((name,) for name in names))


@pytest.mark.parametrize(
    ("concealed", "names", "score"),
    [
        ("plain", ("temperature-drift",), "ambiguous"),
        ("aggregate", ("temperature-drift",), "right"),
        ("aggregate", ("temperature-drift", "timestamp-jitter"), "right"),
        ("aggregate", ("temperature-drift", "power-bias"), "wrong"),
        ("plain", ("temperature-drift", "timestamp-jitter"), "wrong"),
    ],
)
def test_what_a_concealment_does_is_true_where_it_is_said(case, concealed, names, score):
    bent = replace(case, drawn=replace(case.drawn, concealed=concealed))
    assert scored(bent, _said(*names)) == score


def test_a_class_that_has_what_could_not_be_tried_is_no_wrong_name(case):
    bent = replace(
        case,
        drawn=replace(case.drawn, hidden=("small-scale-fading",)),
        outside=("small-scale-fading",),
    )
    rest = Unknown((), Estimate(0, 0, 0), {})
    either = Said((rest,), (("timestamp-jitter", "small-scale-fading"),))
    assert scored(bent, either) == "ambiguous"
    assert scored(bent, _said("timestamp-jitter")) == "wrong"
    one = _outcome(1, ("supply",), "ambiguous", names=[["supply", "x"]])
    worse = replace(one, names=[["x"]], score="wrong")
    (bar,) = (r for r in rates([one, worse]) if "not given" in r.words)
    assert (bar.hits, bar.cases) == (1, 2)


def test_effects_of_motion_belong_to_the_library_where_things_move():
    moving = {"time-lag", "exchange-motion"}
    drawn = (n for n in range(60) if moving & set(drawn_of(n, 2, ("bowls",))[1].hidden))
    assert not moving & set(make_case(next(drawn), 2, ("bowls",)).outside)


def _outcome(number: int, what: tuple[str, ...], score: str, **known: object) -> Outcome:
    plain = Outcome(
        number=number, mode="ranges", family="mint", hidden=list(what),
        outside=[n for n in what if n == "supply"], forms=[], strength=1.0, ratio=3, paired=True,
        same_mix=True, listed=True, counted=True, concealed="plain", verdict="", names=[],
        score=score,
        strength_z=20.0 if what else 0.0, alarm_z=0.5,
    )  # fmt: skip
    return replace(plain, **known)


def test_rates_count_every_case_once_against_its_bar():
    outcomes = [_outcome(i, (), "alarm" if i == 0 else "clean") for i in range(10)]
    outcomes.append(_outcome(10, ("clock-offset",), "right", names=[["clock-offset"]]))
    outcomes.append(_outcome(11, ("supply",), "wrong", names=[["power-bias"]]))
    found = {rate.words: rate for rate in rates(outcomes)}
    assert found["false alarms, nothing hidden"].met is False
    assert found["wrong names, something hidden"].hits == 1
    assert found["wrong names, something hidden"].causes == "1 x supply -> power-bias"
    assert found["outside the library: not given a library name"].hits == 0
    assert found["right name or class, above the limit"].met is True
    assert found["crashed"].met is True


def test_an_interval_is_wilsons():
    low, high = Rate("", 1, 20).interval
    assert (low, high) == pytest.approx((0.0089, 0.2361), abs=1e-4)
    assert np.isnan(Rate("", 0, 0).interval[0])
    assert Rate("", 0, 0, most=0.05).met is None


def test_shifts_planted_around_the_stated_one_judge_it():
    seen = [{"1/1.5": i == 0} if i < 3 else {"1.5": i != 4} for i in range(7)]
    outcomes = [_outcome(i, (), "clean", detected=one) for i, one in enumerate(seen)]
    found = {rate.words: rate for rate in rates(outcomes) if "detectable" in rate.words}
    assert [(rate.hits, rate.met) for rate in found.values()] == [(3, True), (1, True)]


def test_the_median_share_counts_what_was_missed():
    shares = [(0.9, 1.0), (0.0, 1.0), (0.95, 1.0)]
    outcomes = [
        _outcome(i, ("power-bias",), "right", removed=a, removable=b)
        for i, (a, b) in enumerate(shares)
    ]
    assert median_share(outcomes) == pytest.approx(0.9)


def test_the_report_begins_with_what_was_missed():
    outcomes = [_outcome(0, (), "alarm", same_mix=False), _outcome(1, ("supply",), "unknown")]
    text = "\n".join(blind_markdown(outcomes, 3))
    assert text.index("Bars that were missed") < text.index("### ranges: 2 cases")
    assert "nothing, another mix -> alarm" in text
    assert cause(outcomes[1]) == "supply -> unknown"


def _quick(ran: list[int]):
    def run(number: int, seed: int, families: tuple[str, ...] = ()) -> Outcome:
        ran.append(number)
        return _outcome(number, (), "clean")

    return run


def test_finished_cases_are_kept_and_another_seed_is_refused(tmp_path, monkeypatch):
    ran: list[int] = []
    monkeypatch.setattr(blind, "run_case", _quick(ran))
    first = run_blind(3, 5, tmp_path, lambda _: None, families=DEVELOPED)
    again = run_blind(4, 5, tmp_path, lambda _: None, families=DEVELOPED)
    assert ran == [0, 1, 2, 3]
    assert again[:3] == first
    for seed, families in ((6, DEVELOPED), (5, ("mint",))):
        with pytest.raises(BenchError, match="seed 5"):
            run_blind(2, seed, tmp_path, lambda _: None, families=families)


def test_cases_that_other_code_finished_are_run_again(tmp_path, monkeypatch):
    ran: list[int] = []
    monkeypatch.setattr(blind, "run_case", _quick(ran))
    run_blind(2, 5, tmp_path, lambda _: None, families=DEVELOPED)
    monkeypatch.setattr(blind, "code", lambda: "other")
    run_blind(2, 5, tmp_path, lambda _: None, families=DEVELOPED)
    assert ran == [0, 1, 0, 1]


@pytest.mark.parametrize(
    ("problem", "score"), [(BenchError("no overlap"), "refused"), (KeyError("x"), "crash")]
)
def test_a_case_that_fails_is_scored_and_the_rest_goes_on(monkeypatch, case, problem, score):
    def failing(*_: object) -> Diagnosis:
        raise problem

    monkeypatch.setattr(blind, "make_case", lambda *_: case)
    monkeypatch.setattr(blind, "diagnose", failing)
    made = blind.run_case(3, 4)
    assert (made.score, made.names) == (score, [])
    assert blank(case, 3, score, "").hidden == made.hidden


@pytest.mark.slow
def test_cases_do_not_depend_on_how_they_were_spread(tmp_path):
    """A cluster that is threads of this process: the workers of the test on fits are others."""
    distributed = pytest.importorskip("distributed")
    run_blind(1, 5, tmp_path / "alone", lambda _: None, families=("mint",))
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None,
        protocol="tcp://", silence_logs=50,
    ) as local:  # fmt: skip
        spread = Spread(scheduler=local.scheduler_address)
        run_blind(1, 5, tmp_path / "dask", lambda _: None, spread, ("mint",))
    alone, dask = (tmp_path / one / "cases" / "0000.json" for one in ("alone", "dask"))
    assert _timeless(dask.read_text()) == _timeless(alone.read_text())


def _timeless(text: str) -> list[str]:
    """Return the lines of an outcome without its time and its digest."""
    return [line for line in text.splitlines() if "seconds" not in line and "sha256" not in line]


def test_a_third_of_the_tables_tells_no_counts_but_where_these_alone_tell_what_is_hidden() -> None:
    every = [drawn_of(number, 3)[1] for number in range(240)]
    share = np.mean([not one.counted for one in every])
    assert 0.2 < share < 0.45
    assert all(one.counted for one in every if "level-control" in one.hidden)
    turns = ((n, drawn_of(n, 3)) for n in range(240))
    bare = next(n for n, (turn, one) in turns if turn.mode == "CIR" and not one.counted)
    case = make_case(bare, 3)
    assert isinstance(case.simulated, Recordings)
    tables = (case.recorded.frame, case.simulated.frame, case.truth.frame, case.clean)
    assert not any("preamble_count" in frame for frame in tables)
