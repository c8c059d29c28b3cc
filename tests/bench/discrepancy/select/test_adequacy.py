"""A name must reproduce what it acts on; another form of it may leave a little."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.locate.hypotheses import Place
from bench.discrepancy.select import refute
from bench.discrepancy.select.adequacy import Adequacy, judged
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.noise_floor import NoiseFloor

LINKS, ROWS, MEMBERS = 30, 2, 10
NAMES = ("profile_db[a]", "profile_db[b]", "profile_db[c]", "rx_power_dbm")
PLACES = (Place(), Place("temperature_c", trend=True))


def _ensemble(recorded: np.ndarray, simulated: np.ndarray, seed: int) -> Ensemble:
    """Return rows that scatter by 1 dB around means [n, p]."""
    rng = np.random.default_rng(seed)
    rows = LINKS * ROWS
    noise = rng.normal(size=(1 + MEMBERS, rows, len(NAMES)))
    means = np.stack([recorded, *[simulated] * MEMBERS])
    links = np.repeat(np.arange(LINKS), ROWS)
    return Ensemble(NAMES, ("dB",) * len(NAMES), noise + means, links)


def _judged(
    recorded: list[float], fitted: list[float], warming: float = 0.0, seed: int = 5
) -> Adequacy:
    """Return the adequacy of an effect that shifts means by `fitted`; the truth by `recorded`.

    `warming` is a trend of the last observable over a temperature, per standard deviation.
    """
    rows = LINKS * ROWS
    trend = np.linspace(-1.7, 1.7, rows)
    truth = np.tile(np.array(recorded, float), (rows, 1))
    truth[:, -1] += warming * trend
    whole = _ensemble(truth, np.tile(fitted, (rows, 1)), seed)
    rest = _ensemble(truth, np.zeros((rows, len(NAMES))), seed)
    weights = np.stack([np.ones(rows), trend], axis=1)
    return judged(whole, rest, PLACES, weights, 1.0)


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


def test_what_the_effect_does_not_act_on_is_no_matter_of_its_own() -> None:
    assert _judged([6, 5, 4, -5], [6, 5, 4, 0]).adequate


def test_chance_is_not_held_against_a_weak_effect() -> None:
    weak = [0.3, 0.2, 0.3, 0.0]
    refused = sum(not _judged(weak, weak, seed=seed).adequate for seed in range(60))
    assert refused <= 6  # of 60 at 5 %: P(more) = 0.04


def test_the_worst_name_is_taken_back_and_the_rest_asked_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tail, noise = DiffuseTail(), NoiseFloor()

    def fits(_: object, added: tuple[object, ...], effect: object) -> Adequacy:
        alone = len(added) == 1
        left = {tail.name: 2.0, noise.name: 0.9}[effect.name]  # type: ignore[attr-defined]
        return Adequacy(alone, left, 9.0, "the mean of profile_db in all rows")

    monkeypatch.setattr(refute, "fits", fits)
    monkeypatch.setattr(refute, "polished", lambda _comparison, _rows, added, *_: added)
    monkeypatch.setattr(refute, "_left", lambda *_: True)
    search = _Search()
    found = refute.checked(search, (), (tail, noise))  # type: ignore[arg-type]
    assert found.added == (noise,)
    assert [doubt.effect for doubt in found.doubts] == [tail]
    assert "looks most like diffuse-tail" in str(found.doubts[0])


@dataclass(frozen=True)
class _Search:
    comparison: None = None
    fit: None = None


def test_an_effect_takes_the_place_of_another() -> None:
    tail, noise = DiffuseTail(), NoiseFloor()
    other = replace(noise, level_db=3.0)
    assert refute.swapped_for((tail, noise), noise, other) == (tail, other)


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
