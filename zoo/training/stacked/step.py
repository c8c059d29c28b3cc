"""One Adam step of many networks of one architecture, with one set of tensor calls."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.func import functional_call, vmap

from zoo.training.eager import Loss, LossFunction, loss_function
from zoo.training.stacked.dropout import MaskSource, expose_dropout


class Stack:
    """The networks' weights in one tensor [networks, parameters], stepped together.

    `row` is a batch of one, to trace the dropouts with. The modules change at `write_back`.
    """

    def __init__(
        self,
        modules: Sequence[nn.Module],
        row: Tensor,
        loss: Loss,
        seeds: Sequence[int],
        batch_size: int,
    ) -> None:
        self._modules, self._batch_size = modules, batch_size
        self._template, places = expose_dropout(modules[0], row)
        self._masks = MaskSource(places, seeds, batch_size)
        self._weights = torch.stack([_flat(module) for module in modules])
        self._grads = torch.zeros_like(self._weights)
        self._leaves = self._named_views(self._weights)
        self._leaf_grads = self._named_views(self._grads)
        for leaf in self._leaves.values():
            leaf.requires_grad_()
        self._buffers = _stacked_buffers(modules)
        self._forward = vmap(self._forward_one)
        self._row_losses = row_losses(loss)

    def _named_views(self, flat: Tensor) -> dict[str, Tensor]:
        """View [networks, parameters] as the named parameters [networks, ...]."""
        views, start = {}, 0
        for name, parameter in self._modules[0].named_parameters():
            piece = flat.detach()[:, start : start + parameter.numel()]
            views[name] = piece.view(len(flat), *parameter.shape)
            start += parameter.numel()
        return views

    def _forward_one(
        self, weights: dict[str, Tensor], buffers: dict[str, Tensor], batch: Tensor
    ) -> Tensor:
        predictions: Tensor = functional_call(self._template, (weights, buffers), (batch,))
        return predictions

    def adam(self, learning_rate: float, weight_decay: float, together: bool) -> torch.optim.Adam:
        """Return the optimiser; `together` if all networks take the same number of steps.

        If not, each is a parameter of its own, counts its own steps and rests without rows.
        """
        values = [self._weights] if together else list(self._weights)
        self._grad_rows = [self._grads] if together else list(self._grads)
        parameters = [nn.Parameter(value) for value in values]
        for parameter, grad in zip(parameters, self._grad_rows, strict=True):
            parameter.grad = grad
        return torch.optim.Adam(parameters, learning_rate, weight_decay=weight_decay, fused=True)

    def step(
        self,
        inputs: Tensor,
        targets: Tensor,
        batches: Sequence[NDArray[np.int64]],
        optimiser: torch.optim.Adam,
    ) -> Tensor:
        """Step network m on rows batches[m] of the data; without rows it rests.

        Returns the summed loss of each network's batch, [networks].
        """
        rows, share = self._padded(batches)
        batch = inputs.index_select(0, rows.flatten()).view(*rows.shape, *inputs.shape[1:])
        masks = self._masks.draw([len(batch) for batch in batches])
        predictions = self._forward(self._leaves, {**self._buffers, **masks}, batch)
        losses = self._row_losses(predictions, targets[rows])
        self._take_gradient((losses * share).sum())
        self._rest(batches, optimiser)
        optimiser.step()
        return (losses.detach() * (share > 0)).sum(dim=1)

    def _take_gradient(self, total: Tensor) -> None:
        grads = torch.autograd.grad(total, list(self._leaves.values()))
        torch._foreach_copy_(list(self._leaf_grads.values()), grads)

    def _rest(self, batches: Sequence[NDArray[np.int64]], optimiser: torch.optim.Adam) -> None:
        """Keep the networks without rows from being stepped by their momentum."""
        if len(self._grad_rows) > 1:
            for batch, parameter in zip(batches, optimiser.param_groups[0]["params"], strict=True):
                if not len(batch):
                    parameter.grad = None

    def _padded(self, batches: Sequence[NDArray[np.int64]]) -> tuple[Tensor, Tensor]:
        """Return rows [networks, batch], short ones filled with row 0, and each row's weight."""
        rows = np.zeros((len(batches), self._batch_size), np.int64)
        share = np.zeros(rows.shape, np.float32)
        for m, batch in enumerate(batches):
            rows[m, : len(batch)] = batch
            share[m, : len(batch)] = 1.0 / max(len(batch), 1)
        return torch.from_numpy(rows), torch.from_numpy(share)

    def write_back(self) -> None:
        """Put the weights into the modules, and leave them in eval mode."""
        with torch.no_grad():
            for module, row in zip(self._modules, self._weights, strict=True):
                nn.utils.vector_to_parameters(row.clone(), module.parameters())
                module.eval()


def row_losses(loss: Loss) -> LossFunction:
    """Return `loss` without its mean: predictions and targets [...] to losses [...]."""
    if loss == "mae":
        return lambda predictions, targets: (predictions - targets).abs()
    if loss == "mse":
        return lambda predictions, targets: (predictions - targets).square()
    mapped: LossFunction = vmap(vmap(loss_function(loss)))
    return mapped


def _flat(module: nn.Module) -> Tensor:
    return nn.utils.parameters_to_vector(module.parameters()).detach()


def _stacked_buffers(modules: Sequence[nn.Module]) -> dict[str, Tensor]:
    names = [name for name, _ in modules[0].named_buffers()]
    return {name: torch.stack([module.get_buffer(name) for module in modules]) for name in names}
