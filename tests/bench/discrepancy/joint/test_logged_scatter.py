"""A log of how much noise scatters, beside the power of samples, tells a tone from noise."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.joint import quiet
from bench.discrepancy.joint.own_log import of_scatter
from bench.discrepancy.joint.quiet import Quiet, agreed
from bench.discrepancy.joint.quiet_moments import log_moments, ratio_of
from bench.discrepancy.joint.tone_or_noise import scatter_logged
from bench.physics.effects.receiver.interference import NarrowbandInterference

ROWS, BEFORE = 240, 14
TONE = NarrowbandInterference(level_db=-2.0, fading_db=0.0, power_logged=1.0)


@pytest.mark.parametrize(("tone", "ratio"), [(0.0, 1.0), (1.0, 0.826)])
def test_a_log_of_scatter_rises_less_with_a_tone_as_rice_says(tone, ratio) -> None:
    (magnitude, delay), logged = _record(np.random.default_rng(0), tone, 1.0, "scatter")
    assert ratio_of(log_moments(magnitude[:, delay[0] < -4], logged)) == pytest.approx(
        ratio, abs=0.04
    )


@pytest.mark.parametrize(("kind", "told"), [("scatter", True), ("part", False), ("size", False)])
def test_simulated_noise_says_what_is_logged(kind, told) -> None:
    (magnitude, delay), logged = _record(np.random.default_rng(1), 0.0, 1.0, kind)
    moments = log_moments(magnitude[:, delay[0] < -4], logged)
    assert of_scatter(moments) is told
    assert not of_scatter(np.zeros_like(moments))


@pytest.mark.filterwarnings("error")
def test_rows_without_a_log_or_samples_say_nothing() -> None:
    (magnitude, _), logged = _record(np.random.default_rng(2), 0.0, 1.0, "scatter")
    logged[0], magnitude[1] = np.nan, np.nan
    assert (log_moments(magnitude[:, :8], logged)[:2] == 0).all()


@pytest.mark.parametrize("again", [False, True])
@pytest.mark.parametrize("power", [0.0, 0.6])
def test_a_log_makes_surer_what_few_samples_say(monkeypatch, power, again) -> None:
    with_log = _heard(monkeypatch, power, "scatter", again).nats((TONE,))
    without = _heard(monkeypatch, power, "size", again).nats((TONE,))
    assert with_log > max(without, 3.0) if power else with_log < without - 0.5


def test_what_is_of_neither_kind_tells_nothing() -> None:
    tone, errors = np.array([-0.2, -0.1]), np.array([0.03, 0.015])
    assert agreed(np.array([0.0, -0.1]), tone, errors) == 0.0
    assert agreed(np.array([0.0, 0.0]), tone, errors) < -3


def test_a_log_that_follows_power_is_of_a_modulated_tone_one_time_in_ten() -> None:
    tone, errors = np.array([-0.2, -0.1]), np.array([0.03, 0.001])
    steady = agreed(np.array([-0.2]), tone[:1], errors[:1])
    assert agreed(np.array([-0.2, 0.0]), tone, errors) == pytest.approx(steady - np.log(10))


def test_tones_are_asked_as_scatter_is_logged() -> None:
    (made,) = scatter_logged((TONE,))
    assert isinstance(made, NarrowbandInterference)
    assert made.power_logged == 0.0


def _heard(monkeypatch, power: float, kind: str, again: bool = False) -> Quiet:
    """Return recorded rows with a tone of a power beside noise, or with as much more noise."""
    rng = np.random.default_rng(3)
    more = 1.0 if power else 1.6
    recorded, logged = _record(rng, power, more, kind)

    def simulated(comparison, rows, added, number):
        tones = [one for one in added if isinstance(one, NarrowbandInterference)]
        tone = 0.6 if tones else 0.0
        return _record(np.random.default_rng([4, number]), tone, 1.0 if tones else 1.6, kind)

    monkeypatch.setattr(quiet, "recorded_samples", lambda comparison, rows: recorded)
    monkeypatch.setattr(quiet, "simulated_record", simulated)
    count = np.ones(ROWS, np.intp)
    rows = SimpleNamespace(frame=pd.DataFrame({"noise_std": logged}))
    return Quiet(
        SimpleNamespace(
            comparison=None,
            rows=rows,
            beside=(),
            count=count,
            by_rows=again,
            names=("noise_std",),
            of_links=np.array,
        )
    )


def _record(rng, tone: float, noise: float, kind: str):
    """Return rows with a path amid noise and a tone, and a log of the noise, of 500 samples."""
    delay = np.tile(np.arange(40.0) - BEFORE, (ROWS, 1))
    path = np.where(delay >= -2, 30.0, 0.0)
    long = _wave(rng, tone, noise, 500)
    size = {"scatter": np.abs(long).std(axis=1), "part": long.real.std(axis=1)}
    logged = size.get(kind, np.sqrt((np.abs(long) ** 2).mean(axis=1)))
    return (np.abs(_wave(rng, tone, noise, 40) + path), delay), logged


def _wave(rng, tone: float, noise: float, samples: int):
    parts = rng.normal(size=(2, ROWS, samples)) * np.sqrt(noise / 2)
    turns = 0.08 * np.arange(samples) + rng.random((ROWS, 1))
    return parts[0] + 1j * parts[1] + np.sqrt(tone) * np.exp(2j * np.pi * turns)
