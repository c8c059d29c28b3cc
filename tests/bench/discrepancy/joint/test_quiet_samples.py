"""Samples that hold nothing but noise: how they scatter tells a tone from a noise floor."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.joint import noisy as noise_of
from bench.discrepancy.joint import quiet
from bench.discrepancy.joint import sets as module
from bench.discrepancy.joint.quiet import Quiet, quiet_samples, speaks
from bench.discrepancy.joint.quiet_moments import error_of, loud_moments, moments_of, ratio_of
from bench.discrepancy.joint.sets import Sets
from bench.discrepancy.joint.settings import KEPT
from bench.discrepancy.joint.tone_or_noise import with_floor, with_tone
from bench.discrepancy.select.state import Search
from bench.physics.effects.fitted.noise_of_devices import NoiseOfDevices
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.effects.receiver.quantisation import Quantisation
from bench.physics.memory import Memory

ROWS, SAMPLES, BEFORE = 240, 100, 12
TONE, FLOOR = NarrowbandInterference(level_db=0.0), NoiseFloor(level_db=3.0)
OFFSET = Quantisation(step_counts=0, offset_counts=100)


def test_what_is_before_the_path_and_behind_the_last_one_is_quiet():
    rng = np.random.default_rng(0)
    magnitude, delay = _samples(rng, 0.0)

    found = quiet_samples(magnitude, delay)

    assert found[: BEFORE - 3].all()
    assert not found[BEFORE : BEFORE + 20].any()
    assert found[-40:].all()
    assert not quiet_samples(magnitude[:, BEFORE:], delay[:, BEFORE:]).any()


def test_a_tone_makes_quiet_samples_alike_as_rice_says():
    rng = np.random.default_rng(1)
    noise, tone = (ratio_of(moments_of(_quiet(rng, power))) for power in (0.0, 1.0))

    assert noise == pytest.approx(2.0, abs=0.05)
    assert noise - tone == pytest.approx(0.25, abs=0.04)


@pytest.mark.filterwarnings("error")
def test_rows_that_end_early_say_nothing_and_spoil_nothing() -> None:
    magnitude = _quiet(np.random.default_rng(2), 0.0)
    whole = ratio_of(moments_of(magnitude))
    magnitude[3, 1:], magnitude[4], magnitude[:, -1] = np.nan, np.nan, np.nan
    made = moments_of(magnitude)
    assert (made[3:5] == 0).all()
    assert ratio_of(made) == pytest.approx(whole, abs=0.02)
    delay = np.tile(np.arange(magnitude.shape[1]) - 5.0, (len(magnitude), 1))
    assert not quiet_samples(magnitude, delay)[-1] or np.isnan(magnitude[:, -1]).all()


def test_the_colour_of_noise_does_not_make_quiet_samples_alike():
    rng = np.random.default_rng(4)
    white = _wave(rng, 0.0, 1.0, 24, rows=4000)
    coloured = (white[:, :-1] + 0.8 * white[:, 1:])[:, :23]

    of_white, of_coloured = (ratio_of(moments_of(np.abs(one))) for one in (white, coloured))
    assert of_coloured == pytest.approx(of_white, abs=0.02)


def test_a_ratio_speaks_for_a_tone_or_for_noise_or_for_neither():
    says = lambda *numbers: speaks(*(np.array([one]) for one in numbers))  # noqa: E731
    assert says(-0.2, -0.2, 0.03) > 10
    assert says(0.0, -0.2, 0.03) < -3
    assert says(0.12, -0.2, 0.03) > -3  # less alike than noise: some other thing
    assert says(0.12, -0.2, 0.03) <= 0
    assert abs(says(0.0, -0.01, 0.03)) < 0.1  # a weak tone does nothing to see
    assert says(-0.1, -0.2, 0.03) > 0  # two tones that beat
    assert says(0.025, -0.1, 0.03) < -3  # as far on the other side as chance may take it


@pytest.mark.parametrize(("power", "for_a_tone"), [(1.0, True), (0.0, False)])
def test_sets_with_a_tone_are_likelier_where_one_was_recorded(monkeypatch, power, for_a_tone):
    heard = _heard(monkeypatch, power)

    assert heard.nats(()) == heard.nats((FLOOR,)) == 0.0
    assert (heard.nats((TONE,)) > 3) if for_a_tone else (heard.nats((TONE,)) < -3)


def test_what_makes_samples_as_steady_without_a_tone_speaks_for_none(monkeypatch):
    """An offset of all samples beside noise is Rice's law as well, and no tone."""
    heard = _heard(monkeypatch, 1.0)
    assert heard.nats((OFFSET, TONE)) == heard.nats((TONE,)) > 3  # one that does nothing
    made, seen = quiet.simulated_record, heard._heard

    def offset(comparison, rows, added, number):
        more = (TONE,) if OFFSET in added else ()
        return made(comparison, rows, (*added, *more), number)

    monkeypatch.setattr(quiet, "simulated_record", offset)
    other = _heard_again(heard)
    assert other._heard is seen
    assert other.nats((OFFSET, TONE)) <= 0


@pytest.mark.parametrize(("power", "steadier"), [(1.0, True), (0.0, False)])
def test_samples_of_a_tone_are_steadier_than_noise_as_loud(monkeypatch, power, steadier):
    assert _heard(monkeypatch, power).steadier((FLOOR,)) is steadier


@pytest.mark.parametrize("steady", [True, False])
def test_a_noise_floor_of_devices_is_none_where_their_samples_are_a_tones(monkeypatch, steady):
    """What raises it is tried like anything else then; not said to be noise by its log."""
    noisy = NoiseOfDevices(devices=("a3",), louder_db=(6.0,), doubts_db=(0.1,))
    monkeypatch.setattr(noise_of, "steady_at", lambda *_: steady)
    search = Search(None, None, None, {}, 0, logged=(OFFSET, noisy))  # type: ignore[arg-type]
    found = noise_of.without_steady(search)
    assert found.logged == ((OFFSET,) if steady else (OFFSET, noisy))
    assert found.kinds == ({"noise-floor": NoiseFloor} if steady else {})
    assert noise_of.without_steady(replace(search, logged=())).kinds == {}


def _heard_again(heard: Quiet) -> Quiet:
    """Return the same recorded rows, with nothing remembered of sets."""
    other = Quiet.__new__(Quiet)
    other.given, other._heard, other._ratios = heard.given, heard._heard, Memory(KEPT)
    return other


@pytest.mark.parametrize(("power", "for_a_tone"), [(1.0, True), (0.0, False)])
def test_the_few_samples_before_the_path_are_enough(monkeypatch, power, for_a_tone):
    said = _heard(monkeypatch, power, samples=BEFORE + 30).nats((TONE,))

    assert (said > 3) if for_a_tone else (said < -1)


def test_where_hardly_a_sample_is_quiet_nothing_is_said(monkeypatch):
    monkeypatch.setattr(quiet, "QUIET_EARLY", BEFORE + 1)

    assert _heard(monkeypatch, 1.0, samples=BEFORE + 30).nats((TONE,)) == 0.0


def test_loud_rows_and_few_samples_leave_the_ratio_of_noise_as_it_is():
    rng = np.random.default_rng(5)
    noise = _wave(rng, 0.0, 1.0, 8, rows=4000)
    loud = noise * rng.lognormal(0.0, 0.5, (4000, 1))

    assert ratio_of(moments_of(np.abs(loud))) == pytest.approx(2.0, abs=0.05)
    assert ratio_of(loud_moments(np.abs(loud))) == pytest.approx(2.0, abs=0.05)


def test_a_tone_that_fades_is_heard_in_loud_rows():
    rng = np.random.default_rng(6)
    noise, tone = _wave(rng, 0.0, 1.0, 24), _wave(rng, 1.0, 0.0, 24)
    faded = noise + 0.5 * rng.lognormal(0.0, 0.6, (ROWS, 1)) * tone
    power = np.abs(faded) ** 2
    alike = power / power.mean(axis=1, keepdims=True)  # every row counts the same

    said = [2.0 - ratio_of(loud_moments(one)) for one in (np.abs(faded), np.sqrt(alike))]
    assert said[0] > 1.3 * said[1] > 0


def test_links_of_many_rows_count_as_many_in_the_error():
    rng = np.random.default_rng(7)
    rows = moments_of(_quiet(rng, 0.0))
    many = np.r_[rows[:200].sum(axis=0, keepdims=True), rows[200:]]

    assert ratio_of(many) == pytest.approx(ratio_of(rows))
    assert error_of(many[1:]) == pytest.approx(error_of(rows[200:]))


def test_a_tone_is_judged_beside_a_noise_floor_that_hides_as_much():
    (floor,) = with_floor((NarrowbandInterference(level_db=0.0, fading_db=0.0),))

    assert isinstance(floor, NoiseFloor)
    assert floor.level_db == pytest.approx(3.0, abs=0.02)  # twice the power
    assert (floor.lag_1, floor.lag_2, floor.lag_3) == (0.0, 0.0, 0.0)
    assert with_floor((TONE, FLOOR)) == (FLOOR,)
    assert with_tone((NoiseFloor(level_db=-2.0),)) == ()


@pytest.mark.parametrize(("own", "told"), [(-1.0, True), (1.0, False)])
def test_a_weak_tone_is_no_louder_noise_where_one_as_loud_would_be_heard(monkeypatch, own, told):
    weak, floor = _fit(NarrowbandInterference(level_db=-15.0)), _fit(FLOOR)
    sets = Sets.__new__(Sets)
    sets.given = SimpleNamespace()
    said = {weak.effects: own, floor.effects: 0.0, with_tone((FLOOR,)): -6.0}
    sets.quiet = SimpleNamespace(nats=said.__getitem__)
    sets.weighing = SimpleNamespace(evidence=lambda fit: 0.0 if fit is floor else -40.0)
    monkeypatch.setattr(module, "steady", lambda given, fit: 0.0)

    assert sets._told(floor, weak) is told


def _fit(effect):
    return SimpleNamespace(effects=(effect,), names=(effect.name,))


def test_what_quiet_samples_rule_out_is_not_taken_for_the_better_fit(monkeypatch):
    tone, floor = (SimpleNamespace(nats=nats, names=("one",)) for nats in (-1077.0, -291.0))
    known = {id(tone): -41.0, id(floor): -126.0}
    sets = Sets.__new__(Sets)
    sets.none = SimpleNamespace(nats=-9000.0)
    known[id(sets.none)] = -9000.0
    sets.weighing = SimpleNamespace(evidence=lambda fit: known[id(fit)], weigh=list)
    for ruled_out, best in ((True, tone), (False, floor)):
        told = lambda _, one, other, out=ruled_out: out and (one, other) == (tone, floor)  # noqa: E731
        monkeypatch.setattr(Sets, "_told", told)
        assert sets._likeliest([floor, tone]) is best


def _heard(monkeypatch, power: float, samples: int = SAMPLES) -> Quiet:
    """Return recorded rows with a tone of this power over the noise's, none where it is 0."""
    recorded = _samples(np.random.default_rng(2), power, 1.0 if power else 2.0, samples)

    def simulated(comparison, rows, added, number):
        tone = any(isinstance(one, NarrowbandInterference) for one in added)
        made = _samples(np.random.default_rng([3, number]), float(tone), 1.0, samples)
        return made, np.full(ROWS, np.nan)

    monkeypatch.setattr(quiet, "recorded_samples", lambda comparison, rows: recorded)
    monkeypatch.setattr(quiet, "simulated_record", simulated)
    links = np.repeat(np.arange(ROWS // 4), 4)
    means = lambda values: values.reshape(-1, 4, values.shape[1]).mean(axis=1)  # noqa: E731
    given = SimpleNamespace(
        comparison=None,
        by_rows=True,
        names=(),
        rows=SimpleNamespace(frame=pd.DataFrame()),
        beside=(),
        links=ROWS // 4,
        code=links,
        count=np.bincount(links),
        of_links=means,
    )
    return Quiet(given)


def _samples(rng, tone: float, noise: float = 1.0, samples: int = SAMPLES):
    """Return rows with a path of 20 samples amid noise of a power, beside a tone of a power."""
    delay = np.tile(np.arange(samples) - float(BEFORE), (ROWS, 1))
    path = np.where((delay >= -2) & (delay < 20), 30.0, 0.0)
    return np.abs(_wave(rng, tone, noise, samples) + path), delay


def _quiet(rng, tone: float):
    return np.abs(_wave(rng, tone, 1.0, SAMPLES))


def _wave(rng, tone: float, noise: float, samples: int, rows: int = ROWS):
    parts = rng.normal(size=(2, rows, samples)) * np.sqrt(noise / 2)
    turns = 0.08 * np.arange(samples) + rng.random((rows, 1))
    return parts[0] + 1j * parts[1] + np.sqrt(tone) * np.exp(2j * np.pi * turns)
