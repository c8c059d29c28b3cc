"""First paths that are found late: seen in where their index lies in its own record."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import Added, view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.joint import late
from bench.discrepancy.joint.choice import WaveChoice
from bench.discrepancy.joint.detector import TIMED, USUAL
from bench.discrepancy.joint.late import Late, found_late, holds, moved
from bench.discrepancy.joint.quiet_moments import early_samples
from bench.discrepancy.joint.settings import LATE_ERRORS, NAME_NATS
from bench.discrepancy.select.logged import judged_by
from bench.discrepancy.select.state import Search
from bench.physics.base import Base
from bench.physics.effects.propagation.ground_bounce import GroundBounce
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.receiver.late_detection import LateDetection
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS = 40
LATE = LateDetection(peak_fraction=0.75)


def searched(hidden: Added) -> Search:
    """Return a search on rows of 40 links with CIRs, beside a simulator without effects."""
    rng = np.random.default_rng(3)
    frame = pd.DataFrame(
        {
            "link": [f"l{i}" for i in range(LINKS)],
            "true_range_m": rng.uniform(2, 15, LINKS),
            "tx": [f"t{i % 3}" for i in range(LINKS)],
            "rx": [f"r{i % 4}" for i in range(LINKS)],
        }
    )
    made = Simulator(Base(), hidden, 5, "test").observe(scene(frame), 5, 77).table(frame)
    window = window_of(made)
    rows = view(made, link_codes(made), np.arange(len(made)), window)
    comparison = Resimulation(Simulator(Base(), (), 11, "test"), window)
    return Search(comparison, rows, rows, {LateDetection.name: LateDetection}, 1, work=rows)


NONE = np.zeros(60)


def test_late_detection_is_seen_where_the_index_lies_and_fitted_to_that() -> None:
    found = found_late(searched((LATE,)))
    assert found is not None
    assert found.peak_fraction == pytest.approx(LATE.peak_fraction, abs=0.15)


def test_edges_are_looked_for_above_the_noise_of_a_component() -> None:
    search = searched(())
    rows = search.work
    assert rows is not None
    sides = late._recorded(search, rows), late._simulated(search, rows, (), 0)
    for heard in (one for one in sides if one):
        magnitude, delay = heard.samples
        part = np.sqrt(np.nanmean(magnitude[:, early_samples(delay)] ** 2) / 2)
        assert np.median(heard.noise) == pytest.approx(part, rel=0.1)
    assert all(sides)


def test_what_a_late_detection_is_told_by_is_said() -> None:
    search = replace(searched((LATE,)), logged=(LATE,))
    assert "told by where the index lies" in judged_by(search, LATE)


def test_what_moves_ranges_and_no_index_is_no_late_detection() -> None:
    assert found_late(searched((AntennaDelay(delay_ns=0.5),))) is None
    assert found_late(searched((PathLoss(offset_db=6.0),))) is None
    assert found_late(searched(())) is None


def test_it_is_none_where_waveforms_show_what_no_effect_explains() -> None:
    search = searched((LATE,))
    assert holds(search, LATE, WaveChoice((LATE,)))
    assert not holds(search, LATE, WaveChoice((LATE,), unexplained=True))


def test_beside_rays_that_meet_a_late_path_is_late_however_it_is_timed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    search, beside = searched((LATE,)), WaveChoice((GroundBounce(strength_db=-30.0), LATE))
    assert holds(search, LATE, beside)
    parts = [one for one in TIMED if one.at is not None]
    monkeypatch.setattr(late, "_late", lambda _, detector: detector in (USUAL, *parts))
    assert not holds(search, LATE, beside)  # at its centre of weight the pulse is not late
    assert holds(search, LATE, WaveChoice((PathLoss(offset_db=0.5), LATE)))


def test_first_paths_found_elsewhere_are_seen_unless_a_set_has_that() -> None:
    search = searched((LATE,))
    assert moved(search, WaveChoice())
    assert not moved(search, WaveChoice((LATE,)))
    assert not moved(searched((AntennaDelay(delay_ns=0.5),)), WaveChoice())


def test_a_share_is_wrong_only_where_ranges_exclude_it() -> None:
    rng = np.random.default_rng(1)
    index, noise = np.maximum(rng.normal(0, 0.1, 60), 0), rng.normal(0, 0.1, (2, 60))
    assert Late(index, 0.6 * index + noise[0], noise[1], NONE).follows
    assert not Late(index, 0.6 * index + 0.02 * noise[0], noise[1], NONE).follows


def test_ranges_must_follow_the_index_by_as_much() -> None:
    rng = np.random.default_rng(1)
    index, noise = np.maximum(rng.normal(0, 0.1, 60), 0), rng.normal(0, 0.01, (2, 60))
    assert Late(index, index + noise[0], noise[1], NONE).found
    assert not Late(index, 2.5 * index + noise[0], noise[1], NONE).found
    assert not Late(-index, noise[0] - index, noise[1], NONE).found  # sooner
    assert not Late(index, 0.3 + noise[0], noise[1], NONE).found
    jitter = rng.normal(0, 0.05, (2, 60))
    assert Late(jitter[0], jitter[0] + noise[0], jitter[1], NONE).nats > NAME_NATS
    assert not Late(jitter[0], jitter[0] + noise[0], jitter[1], NONE).found  # any detector's


def test_a_few_rows_on_a_later_path_are_found_though_they_move_no_sum() -> None:
    rng = np.random.default_rng(1)
    index, noise = rng.normal(0, 0.003, 86), rng.normal(0, 0.01, (2, 86))
    index[:3] += 0.25  # one row of each of three links
    few = Late(index, index + noise[0], 0.003 * noise[1], np.zeros(86))
    assert few.later < LATE_ERRORS
    assert not few.found
    assert replace(few, chance=0.006).found
    assert not replace(few, chance=0.06).found
    assert not replace(few, chance=0.006, range_m=noise[0]).found  # ranges do not follow


def test_a_jump_of_few_rows_is_followed_though_edges_scatter_more_than_ranges() -> None:
    rng = np.random.default_rng(2)
    index, noise, jumps = rng.normal(0, 0.02, 98), rng.normal(0, 0.003, 98), np.zeros(98)
    jumps[:2] = 4.9, 2.0
    made = Late(index + jumps, jumps + noise, index, jumps, 0.03)
    assert made.found
    assert made.nats > NAME_NATS > replace(made, jumps_m=np.zeros(98)).nats
    assert not replace(made, jumps_m=-jumps, index_m=index).found  # ranges follow no jump
