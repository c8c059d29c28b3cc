"""The six features: known values, edge cases, and the torch module against numpy."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from scipy import stats

from bench.discrepancy.data.cir_features import shape_figures
from zoo.modules.features import (
    FEATURES,
    NOISE_MULTIPLE,
    NOISE_SAMPLES,
    PEAK_FRACTION,
    SAMPLE_PERIOD_NS,
    MaranoFeatures,
    marano_features,
)


def column(name: str, row: list[float], **options: float) -> float:
    return float(marano_features([row], **options)[0, FEATURES.index(name)])


def test_energy_and_maximum_are_in_counts() -> None:
    assert column("energy", [0, 0, 0, 0, 3, 4]) == 25
    assert column("max_amplitude", [0, 0, 0, 0, 3, 4]) == 4


def test_rise_time_runs_from_six_sigma_to_six_tenths_of_the_maximum() -> None:
    # noise 1, 1 -> sigma_n = sqrt(1/2), 6 sigma_n = 4.24: first above at sample 3; 0.6 x 20 at 5
    row = [1, 1, 4, 5, 11, 12, 20, 0]
    assert column("rise_time_ns", row, noise_samples=2) == pytest.approx(2 * SAMPLE_PERIOD_NS)


def test_noise_is_that_of_the_first_four_samples_unless_told_otherwise() -> None:
    # noise 1 -> 6 sigma_n = 4.24: first above at sample 4, 0.6 x 20 reached at 6. Were sample 4
    # taken for noise too, nothing before sample 6 would stand out.
    row = [1, 1, 1, 1, 10, 11, 13, 20, 0]
    assert column("rise_time_ns", row) == pytest.approx(2 * SAMPLE_PERIOD_NS)
    module = MaranoFeatures(9)(torch.tensor([row], dtype=torch.float32)).numpy()
    assert module[0, FEATURES.index("rise_time_ns")] == pytest.approx(2 * SAMPLE_PERIOD_NS)


def test_constants_of_the_rise_time_are_parameters() -> None:
    row = [1, 1, 4, 5, 11, 12, 20, 0]
    early = column("rise_time_ns", row, noise_samples=2, noise_multiple=5.0)
    late = column("rise_time_ns", row, noise_samples=2, peak_fraction=0.9, sample_period_ns=1.0)
    assert early == pytest.approx(3 * SAMPLE_PERIOD_NS)
    assert late == pytest.approx(3)


def test_a_row_that_never_leaves_the_noise_has_no_rise_time() -> None:
    assert column("rise_time_ns", [5, 6, 5, 6, 7, 6]) == 0


def test_delay_and_spread_of_two_equal_echoes() -> None:
    row = [0, 0, 0, 0, 2, 0, 0, 0, 2, 0]
    assert column("mean_excess_delay_ns", row) == pytest.approx(6 * SAMPLE_PERIOD_NS)
    assert column("rms_delay_spread_ns", row) == pytest.approx(2 * SAMPLE_PERIOD_NS)


def test_kurtosis_is_the_one_of_statistics_not_the_excess() -> None:
    row = np.random.default_rng(0).rayleigh(100, 157)
    assert column("kurtosis", list(row)) == pytest.approx(stats.kurtosis(row, fisher=False))


@pytest.mark.parametrize("level", [0.0, 1.0, 1e4])
def test_flat_rows_give_finite_features(level: float) -> None:
    rows = np.full((3, 157), level, np.float32)
    module = MaranoFeatures(157)(torch.from_numpy(rows)).numpy()
    assert np.isfinite(module).all()
    assert np.isfinite(marano_features(rows)).all()
    assert module[:, FEATURES.index("kurtosis")] == pytest.approx([0, 0, 0], abs=1e-3)


def test_an_all_zero_row_gives_zeros() -> None:
    assert not marano_features(np.zeros((1, 20))).any()
    assert not MaranoFeatures(20)(torch.zeros(1, 20)).any()


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
def test_the_module_agrees_with_numpy(scale: float) -> None:
    rows = scale * cirs(200)
    module = MaranoFeatures(157)(torch.from_numpy(rows)).numpy()
    np.testing.assert_allclose(module, marano_features(rows), rtol=2e-5)


def test_numpy_torch_and_the_compiled_loop_of_the_diagnosis_are_equal() -> None:
    """Three implementations for three uses: training, the exported graph, millions of waveforms."""
    rows = cirs(200).astype(np.float64)
    noise = np.sqrt((rows[:, :NOISE_SAMPLES] ** 2).mean(axis=1) / 2)
    delay = np.tile(np.arange(rows.shape[1]) * SAMPLE_PERIOD_NS, (len(rows), 1))
    levels = (PEAK_FRACTION, NOISE_MULTIPLE, NOISE_MULTIPLE)
    figures, _ = shape_figures(rows, delay, noise, (0.0, 1.0), levels)
    names = ("total", "peak", "rise", "excess", "spread", "kurtosis")
    compiled = np.column_stack([figures[name] for name in names])
    compiled[:, 2] = np.clip(compiled[:, 2], 0, None)  # never above the noise: NaN or negative
    compiled[:, 2] = np.nan_to_num(compiled[:, 2])
    plain = marano_features(rows)
    assert (plain[:, 2] > 0).mean() > 0.3
    np.testing.assert_allclose(compiled, plain, rtol=1e-9)
    torched = MaranoFeatures(157)(torch.from_numpy(rows.astype(np.float32))).numpy()
    np.testing.assert_allclose(torched, plain, rtol=2e-5)


def test_the_module_takes_its_constants() -> None:
    options = {"noise_samples": 2, "peak_fraction": 0.9, "noise_multiple": 3.0}
    rows = cirs(50)
    module = MaranoFeatures(157, **options)(torch.from_numpy(rows)).numpy()
    np.testing.assert_allclose(module, marano_features(rows, **options), rtol=2e-5)
    assert not np.allclose(module, marano_features(rows))


def test_shape_features_do_not_depend_on_the_level() -> None:
    rows = cirs(50).astype(np.float64)
    shape = slice(FEATURES.index("rise_time_ns"), None)
    np.testing.assert_allclose(
        marano_features(8 * rows)[:, shape], marano_features(rows)[:, shape], rtol=1e-9
    )


@pytest.mark.parametrize(("samples", "noise"), [(4, 4), (10, 0), (1, 1)])
def test_rows_without_room_for_noise_and_signal_are_refused(samples: int, noise: int) -> None:
    with pytest.raises(ValueError, match=f"n_features = {samples}, noise_samples = {noise}"):
        marano_features(np.ones((2, samples)), noise_samples=noise)
    with pytest.raises(ValueError, match="at least one noise sample"):
        MaranoFeatures(samples, noise_samples=noise)


def cirs(rows: int) -> np.ndarray:
    """Noise with a decaying pulse after five samples: a made-up shape, not a simulation."""
    generator = np.random.default_rng(1)
    decay = np.where(np.arange(157) < 5, 0, np.exp(-(np.arange(157) - 5) / 20))
    signal = generator.rayleigh(generator.uniform(200, 4000, (rows, 1)), (rows, 157)) * decay
    return (generator.rayleigh(80, (rows, 157)) + signal).astype(np.float32)
