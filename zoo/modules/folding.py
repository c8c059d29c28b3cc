"""Batch normalisation made part of the convolution before it, once training is over."""

from __future__ import annotations

from copy import deepcopy
from itertools import pairwise

from sklearn.utils.validation import check_is_fitted
from torch import nn
from torch.nn.utils.fusion import fuse_conv_bn_eval

from zoo.module_model import ModuleModel


class FoldedModel(ModuleModel):
    """A model whose exported module has no batch normalisation left: fewer kernels, same sums."""

    def to_module(self) -> nn.Module:
        """Return a copy of the fitted module in eval mode, normalisation folded."""
        check_is_fitted(self)
        module = deepcopy(self.module_).eval()
        fold(module)
        return module


def fold(module: nn.Module) -> None:
    """Fold every normalisation that follows a convolution among a module's children, in place.

    The folded one leaves an identity in its place. Modules must be in eval mode.
    """
    for parent in module.modules():
        names = list(parent._modules)
        for before, name in pairwise(names):
            convolution, normal = parent._modules[before], parent._modules[name]
            if isinstance(convolution, nn.Conv1d) and isinstance(normal, nn.BatchNorm1d):
                parent._modules[before] = fuse_conv_bn_eval(convolution, normal)
                parent._modules[name] = nn.Identity()
