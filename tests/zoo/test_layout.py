"""Channels innermost: the same answers and gradients as torch's own order, in another layout."""

from __future__ import annotations

import pytest
import torch
from torch import nn

from zoo.training.layout import FEWEST_ROWS, channels_innermost


class Everything(nn.Module):
    """What networks over time are made of."""

    def __init__(self) -> None:
        super().__init__()
        self.maps = nn.Sequential(
            *(nn.Conv1d(1, 6, 4, bias=False), nn.BatchNorm1d(6), nn.LeakyReLU(0.3)),
            *(nn.ConstantPad1d((1, 2), 0.5), nn.Conv1d(6, 8, 3, stride=2), nn.ReLU()),
            *(nn.MaxPool1d(3, 2, 1), nn.Conv1d(8, 4, 3, padding=2, dilation=2, groups=2)),
            *(nn.MaxPool1d(2, ceil_mode=True),),
        )
        self.normal = nn.BatchNorm1d(4)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return self.normal(self.maps(x.unsqueeze(1)).mean(2)).sum(1)


class Viewed(nn.Module):
    """Flattens its maps by a view, as many a network does."""

    def __init__(self) -> None:
        super().__init__()
        self.maps, self.head = nn.Conv1d(1, 6, 4), nn.Linear(6 * 37, 1)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        maps = self.maps(x.unsqueeze(1))
        return self.head(maps.view(maps.size(0), -1)).squeeze(1)


def learnt(module: nn.Module, x: torch.Tensor, rows: int) -> list[torch.Tensor]:
    module.zero_grad()
    with channels_innermost(module, rows):
        said = module(x)
    (said * torch.arange(len(x))).sum().backward()
    return [said.detach(), *(p.grad.clone() for p in module.parameters())]


@pytest.mark.parametrize("kind", [Everything, Viewed])
def test_answers_and_gradients_are_those_of_torchs_own_order(kind: type[nn.Module]) -> None:
    torch.manual_seed(0)
    module, x = kind(), torch.randn(5, 40)
    plain, inner = learnt(module, x, FEWEST_ROWS - 1), learnt(module, x, FEWEST_ROWS)
    assert all(one.abs().max() > 0 for one in plain)
    for one, other in zip(plain, inner, strict=True):
        torch.testing.assert_close(other, one, rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize(("rows", "innermost"), [(FEWEST_ROWS, True), (FEWEST_ROWS - 1, False)])
def test_maps_lie_in_memory_as_said(rows: int, innermost: bool) -> None:
    maps: list[torch.Tensor] = []
    module = nn.Sequential(nn.Conv1d(1, 6, 3), nn.ReLU(), nn.Conv1d(6, 8, 3), nn.MaxPool1d(2))
    for layer in module:
        layer.register_forward_hook(lambda _, __, out: maps.append(out))
    with channels_innermost(module, rows):
        module(torch.randn(5, 1, 40))
    assert [one.stride(1) == 1 for one in maps] == [innermost] * 4


def test_without_a_convolution_nothing_changes() -> None:
    module = nn.Linear(3, 2)
    with channels_innermost(module, FEWEST_ROWS) as entered:
        assert entered is None
        assert module(torch.zeros(2, 3)).shape == (2, 2)
