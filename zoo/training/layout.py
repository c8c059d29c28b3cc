"""Training convolutions with channels innermost: the same sums, in two thirds of the time.

torch keeps maps [n, channels, time] with time innermost, which for a few channels leaves its
kernels (convolution, normalisation, pooling) much to shuffle. With channels innermost in memory
they have stretches to work on. Shapes stay as they are; what changes is where values lie, and with
it the order in which sums are taken.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any

import torch
from torch import Tensor, nn
from torch.nn import functional
from torch.overrides import TorchFunctionMode

Sizes = int | tuple[int, ...] | list[int]


FEWEST_ROWS = 100
"""In smaller batches the calls in between take longer than what is saved."""


def channels_innermost(module: nn.Module, rows: int) -> AbstractContextManager[object]:
    """Have a module's operations over time keep channels innermost meanwhile, at `rows` a batch.

    Nothing changes without a convolution over time, or with few rows. May be entered again.
    """
    convolves = any(isinstance(one, nn.Conv1d) for one in module.modules())
    return _ChannelsInnermost() if convolves and rows >= FEWEST_ROWS else nullcontext()


class _ChannelsInnermost(TorchFunctionMode):
    def __torch_function__(
        self, func: Any, types: Any, args: Any = (), kwargs: dict[str, Any] | None = None
    ) -> Any:
        return _FORMS.get(func, func)(*args, **(kwargs or {}))


def conv1d(
    x: Tensor,
    weight: Tensor,
    bias: Tensor | None = None,
    stride: Sizes = 1,
    padding: Sizes = 0,
    dilation: Sizes = 1,
    groups: int = 1,
) -> Tensor:
    """Return `torch.conv1d` of x [n, c, t], channels innermost in memory."""
    sizes = _pair(stride, 1), _pair(padding, 0), _pair(dilation, 1)
    return torch.conv2d(_tall(x), weight.unsqueeze(2), bias, *sizes, groups).squeeze(2)


def max_pool1d(
    x: Tensor,
    kernel_size: Sizes,
    stride: Sizes | None = None,
    padding: Sizes = 0,
    dilation: Sizes = 1,
    *rest: Any,
    **named: Any,
) -> Tensor:
    """Return `functional.max_pool1d` of x [n, c, t], channels innermost in memory."""
    if x.ndim != 3 or any(rest) or any(named.values()):  # rounded up, or with indices
        plain: Tensor = functional.max_pool1d(
            x, kernel_size, stride, padding, dilation, *rest, **named
        )
        return plain
    stride = stride or kernel_size
    sizes = _pair(kernel_size, 1), _pair(stride, 1), _pair(padding, 0), _pair(dilation, 1)
    return functional.max_pool2d(_tall(x), *sizes).squeeze(2)


def _batch_norm(x: Tensor, *args: Any, **named: Any) -> Tensor:
    if x.ndim != 3:
        return functional.batch_norm(x, *args, **named)
    return functional.batch_norm(_tall(x), *args, **named).squeeze(2)


def _pad(x: Tensor, pad: Any, *args: Any, **named: Any) -> Tensor:
    if x.ndim != 3 or len(pad) != 2:
        return functional.pad(x, pad, *args, **named)
    return functional.pad(_tall(x), pad, *args, **named).squeeze(2)


def _view(x: Tensor, *shape: Any, **named: Any) -> Tensor:
    """Return x in another shape: copied where its channels lie innermost."""
    by_type = named or isinstance(shape[0], torch.dtype)
    return x.view(*shape, **named) if by_type else x.reshape(*shape)


def _tall(x: Tensor) -> Tensor:
    """Return maps [n, c, t] as pictures [n, c, 1, t] with channels innermost."""
    one = x.shape[1] == 1  # then torch cannot tell which is innermost, unless the strides say it
    inner = x.reshape(len(x), -1, 1) if one else x.transpose(1, 2).contiguous()
    return inner.transpose(1, 2).unsqueeze(2)


def _pair(size: Sizes, across: int) -> tuple[int, int]:
    """Return a size along time as one of a picture, `across` the height of 1."""
    return across, size if isinstance(size, int) else size[0]


_FORMS: dict[Any, Callable[..., Tensor]] = {
    torch.conv1d: conv1d,
    functional.max_pool1d: max_pool1d,
    functional.batch_norm: _batch_norm,
    functional.pad: _pad,
    torch.Tensor.view: _view,
    torch.Tensor.view_as: torch.Tensor.reshape_as,
}
