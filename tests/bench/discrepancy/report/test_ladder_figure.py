"""The picture of the ladder: nats of a likelihood stand on an axis of their own."""

from __future__ import annotations

import warnings
from types import SimpleNamespace
from typing import Any

from matplotlib.figure import Figure

from bench.discrepancy.compare.crps import LIKELIHOOD, Estimate
from bench.discrepancy.report.figures import ladder_figure


def _turn(name: str, value: float, unit: str) -> Any:
    contender = SimpleNamespace(name=name, gain=Estimate(value, value - 0.1, value + 0.1, unit))
    return SimpleNamespace(added=name, explanation=SimpleNamespace(contenders=(contender,)))


def _axes(*turns: Any) -> list[Any]:
    figure = Figure()
    diagnosis: Any = SimpleNamespace(selection=SimpleNamespace(rounds=turns))
    ladder_figure(figure.add_subplot(), diagnosis)
    return list(figure.axes)


def test_a_likelihood_does_not_dwarf_a_gain_of_the_score() -> None:
    score, likelihood = _axes(_turn("struck", 24.0, LIKELIHOOD), _turn("delay", 0.9, "nats"))
    assert score.get_xlim()[1] < 2
    assert likelihood.get_xlim()[1] > 20
    assert "likelihood" in likelihood.get_xlabel()
    assert [label.get_text() for label in score.get_yticklabels()] == ["struck", "delay"]


def test_one_unit_has_one_axis() -> None:
    (score,) = _axes(_turn("delay", 0.9, "nats"))
    (likelihood,) = _axes(_turn("struck", 24.0, LIKELIHOOD))
    assert "log CRPS" in score.get_xlabel()
    assert "likelihood" in likelihood.get_xlabel()


def test_marks_are_promised_where_there_are_any() -> None:
    (alone,) = _axes(_turn("delay", 0.9, "nats"))
    turn, other = _turn("delay", 0.9, "nats"), _turn("clock", 0.5, "nats")
    turn.explanation.contenders += other.explanation.contenders
    (both,) = _axes(turn)
    assert "marks" not in alone.get_xlabel()
    assert "marks: others in its place" in both.get_xlabel()


def test_the_first_step_stands_on_top() -> None:
    low, high = _axes(_turn("first", 0.9, "nats"), _turn("second", 0.4, "nats"))[0].get_ylim()
    assert low > high


def test_a_ladder_without_steps_is_drawn_without_a_warning() -> None:
    """A law or a fault alone adds no effect: matplotlib warned of an axis without height."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        (axes,) = _axes()
    low, high = axes.get_ylim()
    assert low > high
    assert [text.get_text() for text in axes.texts] == ["nothing was added"]
