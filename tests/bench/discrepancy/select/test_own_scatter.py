"""Scatter that goes with noise over the signal, the distance or motion is no jitter; even is."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.joint import turn
from bench.discrepancy.select import own_scatter, refute
from bench.discrepancy.select.adequacy import Adequacy
from bench.discrepancy.select.own_scatter import beyond_causes
from bench.discrepancy.select.state import Search
from bench.physics.effect import Effect
from bench.physics.effects.propagation.specular import SpecularReflections
from bench.physics.effects.ranging.clock_offset import ClockOffset
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.time_lag import TimeLag
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.units import Floats

ROWS = 360
NOISY = (NoiseFloor(level_db=3.0),)
SCALE = RangeScale(scale=5e-5)


def near(true_range_m: Floats) -> SimpleNamespace:
    """Return as much of a scene as is asked of true ranges [n]."""
    return SimpleNamespace(true_range_m=true_range_m)


@pytest.mark.parametrize(
    ("of_noise", "logged", "named"),
    [(False, NOISY, True), (True, NOISY, False), (True, (), False)],
)
def test_scatter_of_a_logged_noise_is_no_jitter(
    monkeypatch: pytest.MonkeyPatch, of_noise: bool, logged: tuple[Effect, ...], named: bool
) -> None:
    rng, links = np.random.default_rng(5), np.repeat(np.arange(ROWS // 3), 3)
    level = rng.uniform(-95, -75, ROWS // 3)[links]
    wide = 0.05 * 10 ** (-(level + 88) / 20) if of_noise else 0.05
    versions = rng.normal(0, 0.02, (9, ROWS, 1))
    versions[0, :, 0] += wide * rng.normal(size=ROWS)
    made = Ensemble(("error_m",), ("m",), versions, links)
    monkeypatch.setattr(own_scatter, "versions", lambda *_: made)
    noise = SimpleNamespace(noise_db=np.full(ROWS, 3.0))
    monkeypatch.setattr(own_scatter, "logs", lambda *_: noise)
    frame = pd.DataFrame({"rx_power_dbm": level})
    work = SimpleNamespace(frame=frame, scene=near(np.full(ROWS, 5.0)))
    search = SimpleNamespace(logged=logged, work=work, comparison=None, seed=0)
    jitter = TimestampJitter()
    assert beyond_causes(search, (jitter,), jitter).adequate is named  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("scatter_m", "as_moved", "waveform", "said"),
    [
        (0.06, True, True, True),  # the other form of a reflection moves rows so
        (0.06, False, True, False),  # a jitter does not
        (0.40, True, True, False),  # nor is so much of them
        (0.06, True, False, False),  # ranges alone tell no paths
        (0.00, False, True, True),  # nothing tells: no jitter is named for it
    ],
)
def test_scatter_as_named_paths_move_ranges_is_no_jitter(
    monkeypatch: pytest.MonkeyPatch, scatter_m: float, as_moved: bool, waveform: bool, said: bool
) -> None:
    rng, links = np.random.default_rng(3), np.repeat(np.arange(ROWS // 3), 3)
    wide = rng.gamma(0.6, 1.0, ROWS)  # how far paths move the range of a row
    wide = 0.06 * wide / np.sqrt(np.mean(wide**2))
    bare = rng.normal(0, 0.02, (9, ROWS, 1))
    moved = bare.copy()
    moved[1:, :, 0] += wide * rng.normal(size=(8, ROWS))
    moved[0, :, 0] += wide * rng.normal(size=ROWS)
    moved[0, :, 0] += scatter_m * (wide / 0.06 if as_moved else 1.0) * rng.normal(size=ROWS)
    echo = SpecularReflections()
    made = {
        bool(some): Ensemble(("error_m",), ("m",), one, links)
        for some, one in (((echo,), moved), ((), bare))
    }
    monkeypatch.setattr(own_scatter, "versions", lambda _, __, added: made[echo in added])
    search = SimpleNamespace(comparison=None, fit=SimpleNamespace(waveform=waveform))
    rest = (SCALE, echo)
    found = own_scatter.of_paths(search, SimpleNamespace(), rest, made[True])  # type: ignore[arg-type]
    assert found == ([own_scatter.OF_PATHS] if said else [])


@pytest.mark.parametrize(
    ("growing", "simulated_growing", "even"),
    [(True, False, False), (False, False, True), (False, True, True), (True, True, False)],
)
def test_scatter_that_grows_with_the_distance_is_no_jitter(
    growing: bool, simulated_growing: bool, even: bool
) -> None:
    """Whether what simulated rows scatter by grows with it or not."""
    rng, links = np.random.default_rng(7), np.repeat(np.arange(ROWS // 3), 3)
    range_m = rng.uniform(2, 30, ROWS // 3)[links]
    share = range_m / np.sqrt(np.mean(range_m**2))
    versions = rng.normal(0, 0.03, (9, ROWS, 1))
    versions[..., 0] *= share if simulated_growing else 1.0
    versions[0, :, 0] += 0.06 * (share if growing else 1.0) * rng.normal(size=ROWS)
    made = Ensemble(("error_m",), ("m",), versions, links)
    rows = SimpleNamespace(frame=pd.DataFrame(index=links), scene=near(range_m))
    assert own_scatter.uneven(made, rows) == ([] if even else [own_scatter.FARTHER])  # type: ignore[arg-type]


def test_even_scatter_is_seldom_taken_for_growing() -> None:
    links = np.repeat(np.arange(ROWS // 3), 3)
    for seed in range(30):
        rng = np.random.default_rng(seed)
        versions = rng.normal(0, 0.03, (5, ROWS, 1))
        versions[0] *= 2.0
        made = Ensemble(("error_m",), ("m",), versions, links)
        frame = pd.DataFrame({"rx_power_dbm": rng.uniform(-95, -75, ROWS // 3)[links]})
        rows = SimpleNamespace(frame=frame, scene=near(rng.uniform(2, 30, ROWS // 3)[links]))
        assert own_scatter.uneven(made, rows) == []  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("of_motion", "beside", "named"),
    [(False, TimeLag(lag_s=0.1), True), (True, TimeLag(lag_s=0.1), False), (True, SCALE, True)],
)
def test_a_truth_of_another_age_in_every_row_is_no_jitter(
    monkeypatch: pytest.MonkeyPatch, of_motion: bool, beside: Effect, named: bool
) -> None:
    rng, links = np.random.default_rng(6), np.repeat(np.arange(ROWS // 6), 6)
    speed = rng.normal(0, 1.5, ROWS)
    scatter = 0.03 * (speed if of_motion else 1.0) * rng.normal(size=ROWS)
    versions = rng.normal(0, 0.02, (9, ROWS, 1)) + 0.1 * speed[:, None]
    versions[0, :, 0] += scatter

    def ensemble(_: object, added: tuple[Effect, ...], __: int) -> Ensemble:
        moved = versions if beside in added else versions - 0.1 * speed[:, None]
        return Ensemble(("error_m",), ("m",), moved, links)

    monkeypatch.setattr(own_scatter, "versions", lambda _, rows, added: ensemble(rows, added, 8))
    recorded = SimpleNamespace(names=())  # nothing to ask of the shape of the scatter
    frame, at = pd.DataFrame(index=links), near(np.full(ROWS, 5.0))
    work = SimpleNamespace(rows=links, recorded=recorded, frame=frame, scene=at)
    comparison = SimpleNamespace(ensemble=ensemble)
    search = SimpleNamespace(logged=(), work=work, comparison=comparison, seed=0)
    jitter = TimestampJitter()
    found = beyond_causes(search, (beside, jitter), jitter)  # type: ignore[arg-type]
    assert found.adequate is named
    waves = Search(comparison, work, work, {}, 0, work=work)  # type: ignore[arg-type]
    assert turn._scatters_by_itself(waves, (beside, jitter), jitter) is named


@pytest.mark.parametrize(("note", "strange"), [(own_scatter.OF_MOTION, 0), ("it is no jitter", 1)])
def test_scatter_of_a_named_cause_is_nothing_without_a_name(
    monkeypatch: pytest.MonkeyPatch, note: str, strange: int
) -> None:
    lag, jitter = TimeLag(lag_s=0.1), TimestampJitter()
    doubt = refute.Doubt(jitter, Adequacy(False, 1.0, note=note))
    monkeypatch.setattr(refute, "_refuted", lambda *_: (doubt,))
    monkeypatch.setattr(refute, "_standing", lambda *_: ((lag,), ()))
    search = SimpleNamespace(fit=SimpleNamespace(waveform=False))
    found = refute._stated(search, (), (lag, jitter), ())  # type: ignore[arg-type]
    assert found.added == (lag,)
    assert len(found.doubts) == strange


@pytest.mark.parametrize(
    ("of_reply", "beside", "named"),
    [(False, ClockOffset(), True), (True, ClockOffset(), False), (True, SCALE, True)],
)
def test_scatter_of_clocks_that_wander_is_no_jitter(
    monkeypatch: pytest.MonkeyPatch, of_reply: bool, beside: Effect, named: bool
) -> None:
    """What a crystal is off by, and how much that changes, both go with the reply time."""
    rng, links = np.random.default_rng(8), np.repeat(np.arange(ROWS // 6), 6)
    reply_s = rng.uniform(0.005, 0.05, ROWS // 6)[links]
    share = reply_s / np.sqrt(np.mean(reply_s**2)) if of_reply else 1.0
    versions = rng.normal(0, 0.02, (9, ROWS, 1))
    versions[0, :, 0] += 0.04 * share * rng.normal(size=ROWS)
    made = Ensemble(("error_m",), ("m",), versions, links)
    monkeypatch.setattr(own_scatter, "versions", lambda *_: made)
    frame, at = pd.DataFrame({"reply_time_s": reply_s}), near(np.full(ROWS, 5.0))
    work = SimpleNamespace(frame=frame, scene=at)
    search = SimpleNamespace(logged=(), work=work, comparison=None, seed=0)
    jitter = TimestampJitter()
    assert beyond_causes(search, (beside, jitter), jitter).adequate is named  # type: ignore[arg-type]


@pytest.mark.parametrize("moving", [True, False])
def test_scatter_that_grows_with_the_speed_is_no_jitter(moving: bool) -> None:
    """Nor where nothing is named that moves: places may be off along the way."""
    rng, links = np.random.default_rng(9), np.repeat(np.arange(ROWS // 6), 6)
    speed = rng.normal(0, 1.5, ROWS) * (rng.random(ROWS) < 0.6)
    versions = rng.normal(0, 0.02, (9, ROWS, 1))
    versions[0, :, 0] += 0.03 * (speed if moving else 1.0) * rng.normal(size=ROWS)
    made = Ensemble(("error_m",), ("m",), versions, links)
    frame = pd.DataFrame({"radial_speed_m_per_s": speed})
    rows = SimpleNamespace(frame=frame, scene=near(np.full(ROWS, 5.0)))
    assert own_scatter.uneven(made, rows) == [own_scatter.FASTER] * moving  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("moment", "note", "nothing"),
    [
        ("spread", own_scatter.OF_NOISE, True),
        ("mean", own_scatter.OF_NOISE, False),
        ("spread", own_scatter.FARTHER, False),
    ],
)
def test_what_noise_scatters_that_has_a_name_is_not_left_without_one(
    monkeypatch: pytest.MonkeyPatch, moment: str, note: str, nothing: bool
) -> None:
    monkeypatch.setattr(own_scatter, "beyond_causes", lambda *_: Adequacy(False, 1.0, note=note))
    search = SimpleNamespace(kinds={TimestampJitter.name: TimestampJitter})
    left = (SimpleNamespace(cell=SimpleNamespace(observable="error_m", moment=moment)),)
    assert own_scatter.left_by_causes(search, NOISY, left) is nothing  # type: ignore[arg-type]
    assert not own_scatter.left_by_causes(search, (), left)  # type: ignore[arg-type]


@pytest.mark.parametrize("alone", [True, False])
def test_scatter_of_one_device_is_no_jitter(alone: bool) -> None:
    rng, links = np.random.default_rng(6), np.repeat(np.arange(ROWS // 3), 3)
    device = links % 6
    versions = rng.normal(0, 0.02, (9, ROWS, 1))
    wide = np.where((device == 2) | (not alone), 0.06, 0.0)
    versions[0, :, 0] += wide * rng.normal(size=ROWS)
    made = Ensemble(("error_m",), ("m",), versions, links)
    work = SimpleNamespace(frame=pd.DataFrame({"rx": [f"A{n}" for n in device], "tx": "tag"}))
    said = own_scatter.of_one_device(made, work)  # type: ignore[arg-type]
    assert said == ["it scatters where rx is A2 alone"] * alone
