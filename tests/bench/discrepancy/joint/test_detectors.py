"""Detectors that indices of simulated rows tell, and what only a changed pulse makes late."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.joint.detector import USUAL, Detector, Heard, as_deaf, learned
from bench.physics.units import Floats

DELAY = np.arange(-12.0, 28.0)
RISE = np.array([[0, 0, 0, 0, 2.0, 4.0, 3.0, 1.0, 8.0, 10.0, 5.0, 0]])


def pulses(first: float, rung: float = 0.0, rows: int = 60) -> tuple[Floats, Floats]:
    """Return records [n, 40] of a first path of such a size and a strong one, and their places."""
    places = np.random.default_rng(2).uniform(-0.5, 0.5, rows)
    weak = np.random.default_rng(3).uniform(0.8, 1.2, rows) * first

    def pulse(at: Floats) -> Floats:
        return np.asarray(np.exp(-(((DELAY - at[:, None]) / 1.3) ** 2)))

    made = weak[:, None] * (pulse(places) + rung * pulse(places + 1.5)) + pulse(places + 12.0)
    return 100 * made, places


def found(made: Floats, detector: Detector) -> Heard:
    """Return records as that detector finds them: their delays are after its index."""
    flat = Heard((made, np.tile(DELAY, (len(made), 1))), np.full(len(made), 0.5))
    return Heard((made, DELAY - detector.edges_ns(flat)[:, None]), flat.noise)


def test_an_edge_is_timed_at_half_of_the_first_maximum() -> None:
    delay = np.arange(-4.0, 8.0)[None]
    for noise, edge in ((0.1, 0.0), (0.5, 0.0), (1.0, 4.0 - 1 + 4 / 7)):
        heard = Heard((RISE, delay), np.array([noise]))
        assert USUAL.edges_ns(heard) == pytest.approx([edge])


@pytest.mark.parametrize(
    "detector", [USUAL, Detector(at=0.8), Detector(at=0.3, of_highest=True), Detector(at=None)]
)
def test_simulated_indices_tell_how_edges_are_timed(detector: Detector) -> None:
    told = learned([found(pulses(0.6)[0], detector)])
    assert told.at == pytest.approx(detector.at)
    assert told.of_highest == detector.of_highest


def test_a_changed_pulse_is_late_by_another_timing_alone() -> None:
    centre = Detector(at=None)
    rung = found(pulses(0.6, rung=0.6)[0], centre)
    plain = found(pulses(0.6)[0], centre)
    assert np.median(USUAL.edges_ns(plain) - USUAL.edges_ns(rung)) > 0.1
    told = learned([plain])
    assert np.median(told.edges_ns(plain) - told.edges_ns(rung)) == pytest.approx(0, abs=0.02)


def test_a_weak_path_is_passed_over_by_a_detector_that_simulated_rows_do_not_exclude() -> None:
    plain = found(pulses(0.6)[0], hard_of_hearing())
    weak = found(pulses(0.2)[0], hard_of_hearing())
    assert np.median(USUAL.edges_ns(weak)) < -5
    deaf = as_deaf(learned([plain]), [plain], weak)
    assert any(abs(np.median(one.edges_ns(weak))) < 1 for one in deaf)


def test_no_detector_is_deafer_than_recorded_indices_show() -> None:
    alone = found(pulses(3.0)[0], hard_of_hearing())
    heard = found(pulses(0.4)[0], hard_of_hearing())
    deaf = as_deaf(learned([alone]), [alone], heard)
    assert all(abs(np.median(one.edges_ns(heard))) < 1 for one in deaf)


def test_a_threshold_that_goes_with_the_noise_is_crossed_later_where_there_is_more() -> None:
    plain, loud = (crossed(noise) for noise in (1.0, 5.0))
    assert np.median(USUAL.edges_ns(plain) - USUAL.edges_ns(loud)) > 0.2
    told = learned([plain])
    assert told.crossed
    assert told.of_noise == pytest.approx(4.0, rel=0.15)
    assert np.median(told.edges_ns(plain) - told.edges_ns(loud)) == pytest.approx(0, abs=0.02)


def test_a_threshold_that_simulated_noise_does_not_reach_is_tried() -> None:
    plain, loud = (crossed(noise, part=0.2) for noise in (1.0, 7.5))
    told = learned([plain])
    assert not told.crossed
    assert np.median(told.edges_ns(plain) - told.edges_ns(loud)) > 0.15
    deaf = as_deaf(told, [plain], loud)
    assert any(abs(np.median(one.edges_ns(plain) - one.edges_ns(loud))) < 0.1 for one in deaf)


def crossed(noise: float, part: float = 0.0) -> Heard:
    """Return records whose indices are where a threshold of 4 times the noise is crossed."""
    made = pulses(0.6)[0]
    way = Detector(of_noise=3.9, of_peak=0.0, at=part, of_highest=True, crossed=True)
    flat = Heard((made, np.tile(DELAY, (len(made), 1))), np.full(len(made), noise))
    return Heard((made, DELAY - way.edges_ns(flat)[:, None]), flat.noise)


def hard_of_hearing() -> Detector:
    """Return a detector that passes over what is below a third of the highest sample."""
    return Detector(of_peak=0.33)
