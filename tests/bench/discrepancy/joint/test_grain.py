"""How late samples scatter tells a tail of waves from a gain, and what dies away from noise."""

from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.joint import grain
from bench.discrepancy.joint.grain import Grain, grain_of, growing
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.pulse_ringing import PulseRinging

ROWS, BEFORE, AFTER = 240, 10, 110
DELAY = np.arange(-BEFORE, AFTER, dtype=float)
TAIL, RINGING = DiffuseTail(), PulseRinging()
GIVEN = SimpleNamespace(
    comparison=None,
    rows=None,
    beside=(),
    links=60,
    of_links=lambda x: x.reshape(60, 4, -1).mean(axis=1),
)


def test_a_dense_tail_scatters_samples_as_chance_does_whatever_it_decays_by(monkeypatch):
    heard = _heard(monkeypatch, lambda rng: _echoes(rng) + _tail(rng, 0.2, 25.0))

    after, before, foreseen = heard.misfits((TAIL,), ())

    assert before > 0.5 * foreseen > 10 > after
    assert not heard.refutes((TAIL,), TAIL.name)


def test_a_gain_that_grows_over_the_delay_leaves_samples_as_uneven_as_they_were(monkeypatch):
    gain = 10 ** (np.clip(DELAY - 5, 0, 60) * 0.2 / 20)
    heard = _heard(monkeypatch, lambda rng: _echoes(rng) * gain)

    after, before, foreseen = heard.misfits((TAIL,), ())

    assert before < 10 < min(after, foreseen)
    assert heard.refutes((TAIL,), TAIL.name)


def test_a_tail_with_gaps_is_no_dense_one_but_changes_how_samples_scatter(monkeypatch):
    def gapped(rng):
        heard = np.repeat(rng.random((ROWS, len(DELAY) // 5)) < 0.6, 5, axis=1)
        return _echoes(rng) + heard * _tail(rng, 0.4, 25.0)

    heard = _heard(monkeypatch, gapped)

    assert not heard.refutes((TAIL,), TAIL.name)
    monkeypatch.setattr(Grain, "misfits", lambda *_: (52.0, 42.0, 219.0))
    assert not heard.refutes((TAIL,), TAIL.name)  # far from both: without it is no answer either


def test_what_is_steadier_than_waves_in_any_phase_is_no_tail(monkeypatch):
    def smooth(rng):
        phases = np.exp(2j * np.pi * rng.random((ROWS, 1)))
        return _echoes(rng) + 0.5 * phases * np.exp(-np.maximum(DELAY, 0) / 60) * (DELAY > 3)

    heard = _heard(monkeypatch, smooth)
    after, before, _ = heard.misfits((TAIL,), ())

    assert min(after, before) > 10  # neither as with a tail nor as without it
    assert heard.refutes((TAIL,), TAIL.name)
    assert not heard.refutes((PathLoss(),), PathLoss.name)


def test_another_may_be_farther_behind_a_tail_that_late_samples_are_not_as(monkeypatch):
    """Most of what is late is alike in all rows, as a ringing is: the form of the tail is off."""
    phase = np.exp(2j * np.pi * np.random.default_rng(8).random(len(DELAY)))
    steady = 0.4 * phase * np.exp(-np.maximum(DELAY, 0) / 20) * (DELAY > 3)
    right = _heard(monkeypatch, lambda rng: _echoes(rng) + _tail(rng, 0.25, 20.0))
    assert right.slack((TAIL,), TAIL.name) == pytest.approx(0.05)
    off = _heard(monkeypatch, lambda rng: _echoes(rng) + 0.4 * _tail(rng, 0.25, 20.0) + steady)
    assert off.slack((TAIL,), TAIL.name) == pytest.approx(0.1)


def test_noise_that_grows_is_no_tail_but_may_be_what_need_not_die_away(monkeypatch):
    louder = np.sqrt(np.clip(DELAY - 8, 0, None) / 60)
    heard = _heard(monkeypatch, lambda rng: _echoes(rng) + 0.1 * louder * _wave(rng))

    assert heard.grows(())
    assert heard.refutes((TAIL,), TAIL.name)
    assert not heard.refutes((PathLoss(),), PathLoss.name)


@pytest.mark.parametrize(("delay", "told"), [(12, True), (40, False)])
def test_an_echo_shows_at_its_own_delay(monkeypatch, delay, told):
    def recorded(rng):
        made = _echoes(rng) + 0.05 * _wave(rng)
        made[:, BEFORE + delay] += 0.5
        return made

    heard = _heard(monkeypatch, recorded, echo=12)
    share, plain = heard.shown((TAIL,), ())

    assert plain > 20
    assert share == pytest.approx(1.0, abs=0.4) if told else share < 0.2
    assert heard.refutes((RINGING,), RINGING.name) is not told


def test_without_waveforms_nothing_is_refuted(monkeypatch):
    monkeypatch.setattr(grain, "recorded_samples", lambda *_: None)
    monkeypatch.setattr(grain, "simulated_samples", lambda *_: None)

    assert not Grain(GIVEN).refutes((TAIL,), TAIL.name)


def test_only_surely_more_than_there_was_has_grown():
    rng = np.random.default_rng(3)
    dies = np.exp(-np.arange(6) / 2) + 0.1 * rng.normal(size=(60, 6))

    assert not growing(dies)
    assert growing(dies[:, ::-1])
    assert not growing(dies[:, ::-1] - 1.5)  # less and less is missing: nothing was added


def test_what_is_added_late_has_not_grown_where_early_nobody_knows():
    """Strong reflections of both sides leave early stretches unsure; SIMULATED links."""
    rng = np.random.default_rng(5)
    early = rng.normal(-0.2, 2.0, (90, 1))
    late = 0.02 + 0.02 * rng.normal(size=(90, 1))

    assert late.mean() > 5 * late.std() / np.sqrt(90)
    assert not growing(np.hstack([early, late]))
    assert growing(np.hstack([0.01 * early, 10 * late]))


@pytest.mark.parametrize("rings", [True, False])
def test_a_ringing_beneath_a_tail_is_alike_in_all_rows(monkeypatch, rings):
    steady = 0.35 * np.exp(-np.maximum(DELAY, 0) / 25) * (DELAY > 3) * 1j
    weaker = (TAIL, RINGING)

    def simulated(comparison, rows, added, number):
        rng = np.random.default_rng(100 + number)
        more = steady if RINGING in added else 0.0
        return _samples(_first(rng) + _tail(rng, 0.25, 25.0) + more)

    recorded = _first(np.random.default_rng(1)) + _tail(np.random.default_rng(2), 0.25, 25.0)
    shown = _samples(recorded + steady * rings)
    monkeypatch.setattr(grain, "simulated_samples", simulated)
    monkeypatch.setattr(grain, "recorded_samples", lambda *_: shown)
    assert Grain(GIVEN).steadies(weaker, (TAIL,)) is rings
    assert not Grain(GIVEN).steadies((TAIL,), ())


def test_neither_colour_nor_level_is_grain():
    rng = np.random.default_rng(4)
    white = _wave(rng)
    coloured = (white + 0.9 * np.roll(white, 1, axis=1)) * rng.lognormal(0.0, 0.5, (ROWS, 1))
    crest = np.where(DELAY == 0, 30.0, 0.0)

    seen, other = (grain_of(_samples(crest + one), GIVEN) for one in (white, coloured))
    assert seen[0][:4] == pytest.approx(other[0][:4], abs=0.1)


def _heard(monkeypatch, recorded, echo: int = 0) -> Grain:
    """Return recorded rows beside simulated ones, which have a tail or an echo where `added`."""

    def simulated(comparison, rows, added, number):
        rng = np.random.default_rng(100 + number)
        made = _echoes(rng)
        if added and echo:
            made[:, BEFORE + echo] += 0.5
        return _samples(made + _tail(rng, 0.25, 20.0) if added and not echo else made)

    monkeypatch.setattr(grain, "simulated_samples", simulated)
    shown = _samples(recorded(np.random.default_rng(1)))
    monkeypatch.setattr(grain, "recorded_samples", lambda *_: shown)
    return Grain(GIVEN)


def _samples(wave):
    return np.abs(wave), np.tile(DELAY, (len(wave), 1))


def _wave(rng):
    return rng.normal(size=(ROWS, len(DELAY))) + 1j * rng.normal(size=(ROWS, len(DELAY)))


def _first(rng):
    """Return a first path and a little noise [n, K]."""
    made = 0.01 * _wave(rng)
    made[:, BEFORE] += 1.0
    return made


def _echoes(rng):
    """Return a first path, few echoes and a little noise [n, K]."""
    made = 0.01 * _wave(rng)
    made[:, BEFORE] += 1.0
    comes = (rng.random(made.shape) < 0.08) & (DELAY > 3)
    return made + comes * 0.15 * _wave(rng) * np.exp(-DELAY / 80)


def _tail(rng, size, decay):
    return size * _wave(rng) * np.sqrt(np.exp(-np.maximum(DELAY, 0) / decay) * (DELAY > 3) / 2)
