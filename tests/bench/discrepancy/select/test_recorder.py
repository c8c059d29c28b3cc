"""Faults of a recorder are seen by marks that no signal leaves, and take every name."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.skill import Tally
from bench.discrepancy.data.observables import LEVEL
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select.candidates import Explanation
from bench.discrepancy.select.recorder import (
    AMPLITUDE,
    PEAK,
    clipped,
    recorder_fault,
    repeated,
    spoilt,
    stuck,
)
from bench.discrepancy.select.state import Round, Search, State

ROWS, SAMPLES, FIRST = 60, 120, 20


def samples(echo: float = 0.0) -> np.ndarray:
    """Return magnitudes [n, K] of a pulse, a tail and noise, with an echo 30 samples later."""
    rng = np.random.default_rng(1)
    start = FIRST + rng.random((ROWS, 1))
    loud = 5000 * rng.uniform(0.3, 1, (ROWS, 1))
    grid = np.arange(SAMPLES)
    pulse = [np.exp(-4 * np.log(2) * ((grid - start - late) / 2.5) ** 2) for late in (0, 30)]
    noise = rng.normal(0, 40, (2, ROWS, SAMPLES))
    return np.asarray(np.abs(loud * (pulse[0] + echo * pulse[1]) + noise[0] + 1j * noise[1]))


def frame(cir: np.ndarray) -> pd.DataFrame:
    return pd.DataFrame({"cir": list(cir.astype(np.float32)), "first_path_index": FIRST})


def test_what_is_right_bears_no_mark() -> None:
    for echo in (0.0, 0.5):  # an echo at one delay is wider than a sample
        assert clipped(frame(samples(echo))) == ""
        assert stuck(frame(samples(echo))) == ""


def test_clipped_peaks_share_one_value() -> None:
    for most, words in ((3000, "3000"), (3001.0, "3001"), (0.25, "0.25"), (2999.5, "3000")):
        scale = most / 3000
        assert f"clipped at {words} counts" in clipped(frame(scale * np.minimum(samples(), 3000)))


def test_stuck_samples_stand_out_in_every_row_above_or_below() -> None:
    for value in (600.0, 2.0):
        cir = samples()
        cir[:, [45, 61, 77, 93]] = value
        assert "samples 45, 61, 77" in stuck(frame(cir))


def test_where_waves_cancel_noise_stays_and_no_sample_is_stuck() -> None:
    zeros = [45, 61, 77, 93]  # of the field, between echoes of a ringing
    field = np.where((np.arange(SAMPLES) > FIRST) & (np.arange(SAMPLES) < 100), 1000.0, 0.0)
    field[zeros] = 0.0
    noise = np.random.default_rng(4).normal(0, 40, (2, ROWS, SAMPLES))
    cir = np.abs(field + noise[0] + 1j * noise[1])
    assert stuck(frame(cir)) == ""
    cir[:, zeros] = 2.0  # where even noise is missing
    assert "samples 45, 61, 77" in stuck(frame(cir))


def test_samples_that_are_mostly_rounded_to_zero_do_not_stand_out() -> None:
    noise = np.random.default_rng(2).normal(0, 1, (2, 300, SAMPLES))
    noise *= np.where(np.arange(SAMPLES) % 2, 1.0, 0.5)  # a ripple of 6 dB
    cir = np.hypot(*np.round(noise / 3) * 3)
    assert np.mean(cir == 0) > 0.6
    assert stuck(frame(cir)) == ""
    cir[:, [45, 61, 77, 93]] = 18.0
    assert "samples 45, 61, 77" in stuck(frame(cir))


def search_of(
    rows: pd.DataFrame,
    recorded_db: np.ndarray,
    simulated_db: np.ndarray,
    levels_db: float | None = None,
) -> Search:
    """Return a search over rows whose peaks are so many decibels on both sides, [n] each.

    Receive levels of both sides, if any, are `levels_db` apart.
    """
    peaks = np.stack([recorded_db, simulated_db])[:, :, None].repeat(2, axis=2)
    names, units = (AMPLITUDE, PEAK), ("dB", "dB")
    if levels_db is not None:
        levels = np.stack([np.full(len(rows), levels_db), np.zeros(len(rows))])[:, :, None]
        names, units = (*names, LEVEL), (*units, "dBm")  # type: ignore[assignment]
        peaks = np.concatenate([peaks, levels], axis=2)
    made = Ensemble(names, units, peaks, np.arange(len(rows)))
    view = SimpleNamespace(waveform=True, frame=rows)
    other = SimpleNamespace(ensemble=lambda *_: made)
    return SimpleNamespace(fit=view, discover=view, comparison=other)  # type: ignore[return-value]


def test_samples_that_are_not_scaled_alike_are_said_so_not_clipped() -> None:
    varied, rows = np.linspace(70, 80, ROWS), frame(samples() / 5000)
    volts = recorder_fault(search_of(rows, varied - 140, varied))
    assert "other units: recorded peaks lie 140 dB below" in volts
    one = np.full(ROWS, 75.0)
    assert "all recorded samples were scaled to one peak" in recorder_fault(
        search_of(rows, one, varied)
    )
    assert "all simulated samples" in recorder_fault(search_of(rows, varied, one))
    for alike in (varied, one):
        assert recorder_fault(search_of(rows, alike, alike - 20)) == ""


def test_samples_that_are_weaker_than_levels_say_are_of_another_gain() -> None:
    varied, rows = np.linspace(70, 80, ROWS), frame(samples())
    words = recorder_fault(search_of(rows, varied - 38, varied, levels_db=15.0))
    assert "another gain: recorded peaks lie 38 dB below simulated ones" in words
    assert words.endswith("receive levels differ by +15 dB")
    for levels_db in (None, -38.0, -20.0):
        assert recorder_fault(search_of(rows, varied - 38, varied, levels_db)) == ""


def test_samples_in_decibels_are_said_so() -> None:
    varied, counts = np.linspace(70, 80, ROWS), samples()
    noise = np.random.default_rng(1).rayleigh(50, counts.shape)
    rows, logged = (frame(one) for one in (counts + noise, 20 * np.log10(counts + noise + 1)))
    assert "recorded samples look like decibels" in recorder_fault(
        search_of(logged, varied - 48, varied)
    )
    assert recorder_fault(search_of(rows, varied - 48, varied)) == ""
    assert recorder_fault(search_of(logged, varied - 5, varied)) == ""


def test_what_is_seen_takes_every_name() -> None:
    rows = frame(np.minimum(samples(), 3000))
    level = np.linspace(70, 80, ROWS)
    words = recorder_fault(search_of(rows, level, level))
    tally = Tally(("noise_std",), np.ones((4, 1)), np.ones((4, 1)))
    told = Explanation((), tally, Estimate(1, 0, 2), tally, {}, {})
    state = State(None, (), (Round(Located((), 0.002, 9.0, 3.0, 1, {}), told, None),))  # type: ignore[arg-type]
    found = spoilt(state, words)
    assert found.names == found.added == ()
    assert str(found.verdicts[0]).endswith(words)
    assert "clipped" in words


@pytest.mark.filterwarnings("error")
def test_samples_rounded_to_zero_are_no_fault() -> None:
    coarse = np.rint(samples() / 4000) * 4000
    assert np.median(coarse) == 0
    assert stuck(frame(coarse)) == ""
    assert stuck(frame(0 * coarse)) == ""


def test_samples_that_repeat_each_other_behind_first_paths_alone_were_replaced() -> None:
    made = samples(0.5)
    late = np.arange(SAMPLES) > FIRST + 8
    powers = np.where(late, 3.0 ** np.floor(np.log(made) / np.log(3)), made)
    assert "all behind first paths" in repeated(frame(powers))
    assert repeated(frame(made)) == ""
    assert repeated(frame(np.rint(made / 60) * 60)) == ""  # a converter takes noise ahead, too
    assert repeated(frame(np.where(late & (made < 60), 0.0, made))) == ""  # nor what is left out
