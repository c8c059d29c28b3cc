"""The width rule and the scalings inside the module."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from zoo.modules.preparation import BLOCK_ROWS, Crop, Preparation, apply_in_blocks
from zoo.modules.scaling import GlobalScale, PeakScale, Standardise


def test_wider_rows_are_cropped_from_the_first_sample_wanted() -> None:
    row = torch.arange(20.0)[None]
    assert Crop(20, 5, 3)(row).tolist() == [[5, 6, 7]]
    assert Crop(20, 5, None)(row).tolist() == [list(range(5, 20))]


def test_rows_exactly_as_wide_pass_untouched() -> None:
    row = torch.ones(1, 8)
    assert Crop(8, 0, 8)(row) is row


def test_narrower_rows_are_refused_naming_both_widths() -> None:
    with pytest.raises(ValueError, match=r"152 samples from sample 5 on.*at least 157.*got 156"):
        Crop(156, 5, 152)


@pytest.mark.parametrize(("first", "samples"), [(-1, 4), (0, 0)])
def test_impossible_crops_are_refused(first: int, samples: int) -> None:
    with pytest.raises(ValueError, match="cannot crop"):
        Crop(20, first, samples)


def test_standardise_gives_mean_0_and_deviation_1_and_centres_constants() -> None:
    values = torch.randn(500, 3, generator=torch.Generator().manual_seed(0)) * 40 + 1e4
    values[:, 1] = 7e3
    scaling = Standardise(3)
    scaling.fit(values)
    scaled = scaling(values)
    assert scaled.mean(0).tolist() == pytest.approx([0, 0, 0], abs=1e-4)
    assert scaled.std(0, correction=0).tolist() == pytest.approx([1, 0, 1], abs=1e-4)


def test_global_scale_keeps_levels_apart_and_peak_scale_does_not() -> None:
    rows = torch.tensor([[1.0, 2.0], [3.0, 6.0]])
    scale = GlobalScale()
    scale.fit(rows)
    assert scale(rows).tolist() == [[0.25, 0.5], [0.75, 1.5]]
    assert PeakScale()(rows).tolist() == [[0.5, 1.0], [0.5, 1.0]]


@pytest.mark.parametrize("scaling", [Standardise(4), GlobalScale(), PeakScale()])
def test_all_zero_training_rows_give_finite_output(scaling: torch.nn.Module) -> None:
    scaling.fit(torch.zeros(5, 4))
    assert torch.isfinite(scaling(torch.ones(2, 4))).all()


def test_preparation_fits_on_what_it_passes_on() -> None:
    rows = np.random.default_rng(0).normal(5, 2, (50, 10)).astype(np.float32)
    preparation = Preparation(Crop(10, 2, 6), Standardise(6))
    prepared = preparation.fit(rows)
    assert prepared.shape == (50, 6)
    np.testing.assert_array_equal(prepared, preparation(torch.from_numpy(rows)).numpy())


def test_blocks_give_the_same_as_one_pass() -> None:
    rows = np.random.default_rng(0).random((BLOCK_ROWS + 3, 2)).astype(np.float32)
    assert torch.equal(apply_in_blocks(PeakScale(), rows), PeakScale()(torch.from_numpy(rows)))
