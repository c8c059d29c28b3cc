"""A negative control refuses a name where something is left beyond chance, and only there."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.discrepancy.compare.crps import Estimate, cluster_bootstrap
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select import controls
from bench.discrepancy.select.controls import control_passed, struck_control
from bench.discrepancy.select.undetermined import hardly_more, untold
from bench.discrepancy.select.verdict import Control, LeftOut
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.effects.receiver.noise_floor import NoiseFloor

ROWS = 60
SIGHT = np.arange(ROWS) % 2 == 0


@pytest.mark.parametrize(
    ("quiet", "loud", "passed"),
    [
        (Estimate(0.01, -0.005, 0.025, "m"), 0.03, True),  # holds zero
        (Estimate(0.01, 0.008, 0.012, "m"), 0.1, True),  # little beside what is elsewhere
        (Estimate(-0.011, -0.019, -0.001, "m"), 0.03, None),  # one interval in twenty is such
        (Estimate(0.03, 0.02, 0.04, "m"), 0.03, False),
        (Estimate(-0.03, -0.04, -0.02, "m"), 0.03, False),
    ],
)
def test_chance_alone_refuses_no_name(quiet: Estimate, loud: float, passed: bool | None) -> None:
    assert control_passed(quiet, loud) is passed


class _Strike:
    """Something that strikes rows without sight by half a metre in the mean."""

    control = "rows with line of sight"

    def inert(self, _: object) -> np.ndarray:
        return SIGHT


def _search(left_m: np.ndarray, crowding: float = 1.0) -> Any:
    """Return a search in whose ranges `left_m` [n] is left, of links that share simulated rows."""

    def ensemble(_: object, added: tuple[object, ...], members: int, __: int) -> Ensemble:
        noise = np.random.default_rng(len(added)).normal(0, 0.01, (1 + members, ROWS, 1))
        noise[0, :, 0] += left_m
        noise[1:, ~SIGHT] += 0.5 * len(added)
        return Ensemble(("error_m",), ("m",), noise, np.arange(ROWS) // 3)

    return SimpleNamespace(
        discover=SimpleNamespace(scene=None),
        comparison=SimpleNamespace(ensemble=ensemble, crowding=lambda _: crowding),
        seed=0,
    )


@pytest.mark.parametrize(
    ("left_m", "passed"),
    [
        (np.full(ROWS, 0.3), True),  # all rows: another cause
        (np.where(SIGHT, 0.5, 0.0), False),
        (np.where(SIGHT, -0.5, 0.0), True),  # shorter in sight: most others are struck
    ],
)
def test_what_strikes_links_is_not_there_in_sight(
    monkeypatch: pytest.MonkeyPatch, left_m: np.ndarray, passed: bool
) -> None:
    monkeypatch.setattr(controls, "Base", lambda: SimpleNamespace(paths=lambda _: None))
    found = struck_control(_search(left_m), (), _Strike())  # type: ignore[arg-type]
    assert found.passed is passed
    assert found.left is not None
    assert found.left.unit == "m"


def test_a_name_of_which_nothing_is_told_from_zero_is_none() -> None:
    none, some = Estimate(0.06, -0.02, 0.15, "nats"), Estimate(0.06, 0.02, 0.1, "nats")
    wide = ParameterEstimate("delay_ns[tag]", -0.4, -0.9, 0.03, "ns")
    sharp = ParameterEstimate("delay_ns[tag]", -0.4, -0.6, -0.2, "ns")
    open_ = ParameterEstimate("delay_ns[7]", 3.0, 1.0, 20.0, "ns", determined=False)

    def named(gain: Estimate, *sizes: ParameterEstimate) -> LeftOut:
        return LeftOut(AntennaDelay(), sizes, gain, 1.0, Control("", None))

    assert untold(named(none, wide, open_))
    assert not untold(named(some, wide, open_))
    assert not untold(named(none, wide, sharp))
    assert not untold(named(none))
    rounded = LeftOut(RangeRounding(), (wide,), none, 1.0, Control("", None))
    assert not untold(rounded)


def test_a_tenth_of_a_decibel_more_noise_is_none_unless_its_colour_is_told() -> None:
    def named(by_db: float, lag: float) -> LeftOut:
        level = ParameterEstimate("level_db", by_db, by_db - 0.05, by_db + 0.05, "dB")
        sizes = level, ParameterEstimate("lag_1", lag, lag - 0.1, lag + 0.1, "1")
        gain = Estimate(0.06, 0.02, 0.1, "nats")
        return LeftOut(NoiseFloor(level_db=by_db), sizes, gain, 1.0, Control("", None))

    assert hardly_more(named(0.096, 0.0)).startswith("0.1 dB more")
    assert not hardly_more(named(0.096, 0.3))
    assert hardly_more(named(0.096, 0.3), rounded=True)  # that is the colour of what rounding makes
    assert not hardly_more(named(0.5, 0.0))
    assert not hardly_more(named(-1.5, 0.0))  # said otherwise: see `taken_away`
    delay = ParameterEstimate("delay_ns[tag]", 0.1, 0.05, 0.2, "ns")
    assert not hardly_more(
        LeftOut(AntennaDelay(), (delay,), Estimate(1, 1, 1), 1.0, Control("", None))
    )


def test_links_that_share_simulated_rows_refuse_a_name_only_beyond_what_these_scatter(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Nine links at rest were 9 mm short beside one simulated row each, which others shared."""
    monkeypatch.setattr(controls, "Base", lambda: SimpleNamespace(paths=lambda _: None))
    by_link = 0.2 + 0.3 * np.random.default_rng(1).normal(size=ROWS // 3)[np.arange(ROWS) // 3]
    left_m = np.where(SIGHT, np.abs(by_link), 0.0)
    once, shared, crowd = (
        struck_control(_search(left_m, wider), (), _Strike())  # type: ignore[arg-type]
        for wider in (1.0, 1.5, 8.0)
    )
    assert (once.passed, crowd.passed) == (False, True)
    assert once.left is not None
    assert shared.left is not None
    assert shared.left.value == once.left.value
    assert shared.left.high - shared.left.low == pytest.approx(
        1.5 * (once.left.high - once.left.low)
    )


def test_of_few_links_an_interval_drawn_again_is_too_narrow() -> None:
    rng = np.random.default_rng(7)
    links, held = np.arange(5), [0, 0]
    for _ in range(300):
        made = cluster_bootstrap(rng.normal(size=5), links, 0, "m")
        for place, wider in enumerate((1.0, controls.of_few(5))):
            low, high = (wider * (end - made.value) for end in (made.low, made.high))
            held[place] += low <= -made.value <= high
    assert held[0] < 0.88 * 300
    assert held[1] > 0.91 * 300
    assert controls.of_few(400) == pytest.approx(1.0, abs=0.01)
