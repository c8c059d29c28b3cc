"""Training a `SmallNetwork` by matrix products written out: the steps of `eager.train`, sooner.

A step of so small a network is almost all overhead in torch: autograd, and convolutions of a few
thousand multiplications. Here time comes before channels, so that a window of any layer is one
stretch of memory, a layer is one matrix product, and its gradients are two more.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import torch
from numpy.typing import ArrayLike
from torch import Tensor, nn

from zoo.modules.remnet import CONV_KERNEL
from zoo.modules.small import SmallNetwork
from zoo.training import eager
from zoo.training.eager import FloatArray, Progress, as_tensors, epoch_orders, one_thread, report
from zoo.training.recipe import TrainingLog, TrainingRecipe, check_recipe, falling

BETA_1, BETA_2, EPSILON = 0.9, 0.999, 1e-8
_after_relu = torch.ops.aten.threshold_backward  # the gradient where the output is positive


def why_not(module: nn.Module, recipe: TrainingRecipe) -> str | None:
    """Return why `module` cannot be trained by `recipe` here, or None if it can."""
    if type(module) is not SmallNetwork:
        return "not a small network"
    gated = any(not isinstance(block.gate, nn.Identity) for block in module.blocks)
    if gated or module.hidden is not None or module.dropout.p > 0:
        return "neither attention, hidden units nor dropout is written out"
    if recipe.loss != "mae" or recipe.stopping is not None or recipe.weight_decay:
        return "whole epochs with the loss 'mae' and without weight decay are written out"
    if any(not p.requires_grad or p.dtype != torch.float32 for p in module.parameters()):
        return "a parameter is frozen or not float32"
    return None


def train(
    module: nn.Module,
    X: FloatArray,
    y: FloatArray,
    recipe: TrainingRecipe,
    *,
    groups: ArrayLike | None = None,
    progress: Progress | None = None,
) -> TrainingLog:
    """Train as `zoo.training.eager.train` does, written out if `why_not` has no objection.

    X is [n, samples] and y [n] in metres. Both end at the same weights but for the order of sums.
    Raises ValueError as the plain loop.
    """
    if why_not(module, recipe) is not None:
        return eager.train(module, X, y, recipe, groups=groups, progress=progress)
    assert isinstance(module, SmallNetwork)
    inputs, targets = as_tensors(X, y)
    check_recipe(recipe, len(inputs))
    started, losses = time.perf_counter(), []
    with one_thread(), torch.no_grad():
        steps = _Steps(module, recipe, len(inputs))
        for epoch, order in enumerate(epoch_orders(len(inputs), recipe.epochs, recipe.seed)):
            rows = torch.from_numpy(order)
            losses.append(steps.run(inputs[rows], targets[rows]) / len(inputs))
            report(progress, (epoch + 1) / recipe.epochs)
        steps.write_back()
    module.eval()
    seconds = time.perf_counter() - started
    return TrainingLog(tuple(losses), len(inputs), seconds, "fused", steps.done)


@dataclass
class _Layer:
    """A convolution [n, time, channels] -> [n, out, filters] with its ReLU, and its gradients.

    `weight` [taps * channels, filters] and `bias` [filters] are views into all weights,
    `weight_grad` and `bias_grad` into all gradients; `windows` and `maps` are of the last batch.
    """

    weight: Tensor
    bias: Tensor
    weight_grad: Tensor
    bias_grad: Tensor
    channels: int
    stride: int
    padding: int
    length: int = 0

    def forward(self, x: Tensor) -> Tensor:
        """Return the maps [n, out, filters] of x [n, time, channels]."""
        rows, self.length, channels = x.shape
        padded = torch.constant_pad_nd(x, (0, 0, self.padding, self.padding))
        taps = len(self.weight) // channels
        out = (padded.shape[1] - taps) // self.stride + 1
        size = (rows, out, taps * channels)
        strides = (padded.shape[1] * channels, self.stride * channels, 1)
        self.windows = padded.as_strided(size, strides).reshape(rows * out, -1)
        self.maps = torch.addmm(self.bias, self.windows, self.weight).relu_()
        return self.maps.view(rows, out, -1)

    def learn(self, grad: Tensor) -> Tensor:
        """Take the gradient of the maps [n, out, filters]; return that before the ReLU, flat."""
        before: Tensor = _after_relu(grad.reshape(self.maps.shape), self.maps, 0.0)
        torch.mm(self.windows.t(), before, out=self.weight_grad)
        torch.sum(before, 0, out=self.bias_grad)
        return before

    def back(self, before: Tensor, rows: int) -> Tensor:
        """Return the gradient of x [n, time, channels] for that before the ReLU."""
        grad = torch.mm(before, self.weight.t()).view(rows, -1, CONV_KERNEL, self.channels)
        out = grad.shape[1]
        padded = before.new_zeros((rows, self.length + 2 * self.padding, self.channels))
        for tap in range(CONV_KERNEL):
            padded[:, tap : tap + self.stride * (out - 1) + 1 : self.stride] += grad[:, :, tap]
        return padded[:, self.padding : self.padding + self.length]


class _Steps:
    """Steps of Adam on one network; all its weights lie in one vector, time before channels."""

    def __init__(self, module: SmallNetwork, recipe: TrainingRecipe, rows: int) -> None:
        self.module, self.recipe, self.done = module, recipe, 0
        self._most = recipe.epochs * -(-rows // recipe.batch_size)
        self._filters = module.first.out_channels
        turned = [_turned(values, self._filters) for values in module.parameters()]
        self._shapes = [values.shape for values in turned]
        self.weights = torch.cat([values.reshape(-1) for values in turned])
        self.grads, self._mean, self._square = (torch.zeros_like(self.weights) for _ in range(3))
        own, learnt = self._views(self.weights), self._views(self.grads)
        convolutions = [one for one in module.modules() if isinstance(one, nn.Conv1d)]
        pairs = zip(convolutions, own[::2], own[1::2], learnt[::2], learnt[1::2], strict=False)
        self.layers = [_layer(*pair) for pair in pairs]
        self.head, self.head_grad = own[-2:], learnt[-2:]

    def _views(self, vector: Tensor) -> list[Tensor]:
        """Return the parts of a vector that belong to each parameter, in their shapes."""
        parts = torch.split(vector, [shape.numel() for shape in self._shapes])
        return [part.view(shape) for part, shape in zip(parts, self._shapes, strict=True)]

    def run(self, inputs: Tensor, targets: Tensor) -> float:
        """Take a step per batch of rows in order; return the loss summed over the rows."""
        size, total = self.recipe.batch_size, torch.zeros((), dtype=torch.float64)
        for x, y in zip(torch.split(inputs, size), torch.split(targets, size), strict=True):
            total += self.gradient(x, y)
            self._adam()
        return float(total)

    def gradient(self, x: Tensor, y: Tensor) -> Tensor:
        """Leave a batch's gradient in `grads`; return its summed absolute error."""
        maps = x.unsqueeze(2)
        for layer in self.layers:
            maps = layer.forward(maps)
        flat, (weight, bias) = maps.reshape(len(x), -1), self.head
        error = torch.addmm(bias, flat, weight) - y.unsqueeze(1)
        slope = error.sign().div_(len(x))
        torch.mm(flat.t(), slope, out=self.head_grad[0])
        torch.sum(slope, 0, out=self.head_grad[1])
        grad = slope * weight.t()
        for layer in reversed(self.layers):
            before = layer.learn(grad)
            grad = grad if layer is self.layers[0] else layer.back(before, len(x))
        return error.abs_().sum()

    def _adam(self) -> None:
        """Kingma and Ba 2015, algorithm 1, ordered as in torch.optim.Adam."""
        rate = self.recipe.learning_rate
        rate = falling(rate, self.done / self._most) if self.recipe.decay else rate
        self.done += 1
        self._mean.lerp_(self.grads, 1 - BETA_1)
        self._square.mul_(BETA_2).addcmul_(self.grads, self.grads, value=1 - BETA_2)
        root = self._square.sqrt().div_(math.sqrt(1 - BETA_2**self.done)).add_(EPSILON)
        self.weights.addcdiv_(self._mean, root, value=-rate / (1 - BETA_1**self.done))

    def write_back(self) -> None:
        """Put the weights into the module."""
        for values, now in zip(self.module.parameters(), self._views(self.weights), strict=True):
            values.copy_(_turned_back(now, values.shape, self._filters))


def _layer(like: nn.Conv1d, weight: Tensor, bias: Tensor, *grads: Tensor) -> _Layer:
    """Return a layer of these weights with the sizes of a convolution."""
    sizes = like.in_channels, like.stride[0], int(like.padding[0])
    return _Layer(weight, bias, grads[0], grads[1], *sizes)


def _turned(values: Tensor, filters: int) -> Tensor:
    """Return a parameter with time before channels, ready to be multiplied by rows of windows."""
    if values.ndim == 3:  # [filters, channels, taps]
        return values.detach().permute(2, 1, 0).reshape(-1, len(values))
    if values.ndim == 2:  # the head: [1, filters * time]
        return values.detach().view(filters, -1).t().reshape(-1, 1)
    return values.detach()


def _turned_back(values: Tensor, shape: torch.Size, filters: int) -> Tensor:
    """Return a parameter as the module has it."""
    if len(shape) == 3:
        return values.view(shape[2], shape[1], shape[0]).permute(2, 1, 0)
    if len(shape) == 2:
        return values.view(-1, filters).t().reshape(shape)
    return values
