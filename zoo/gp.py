"""Gaussian process regression on levels, range and features, with its variance."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Self

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import cholesky, solve_triangular
from sklearn.cluster import MiniBatchKMeans
from torch import Tensor, nn

from zoo.base import Progress
from zoo.block_model import BlockModel
from zoo.gbm import thinned
from zoo.modules.blocks import BlockError, Columns, Table

Floats = NDArray[np.float64]
JITTER = 1e-4  # of the signal's variance, on the diagonal of the points' own kernel


class GaussianProcessNetwork(nn.Module):
    """Figures [n, columns] -> [n, 2]: mean (m) and log deviation, from the kernel to m points.

    mean = offset + k(x) a, variance = signal + noise - |k(x) L|^2, with the kernel
    k = signal exp(-|x - p|^2 / 2) between x and the points p, both divided by the length.
    """

    points: Tensor
    reduction: Tensor
    signal: Tensor
    noise: Tensor
    length: Tensor

    def __init__(self, points: int, columns: int) -> None:
        super().__init__()
        self.register_buffer("points", torch.zeros(points, columns))
        self.register_buffer("reduction", torch.zeros(points, points))
        self.mean = nn.utils.skip_init(nn.Linear, points, 1)  # type: ignore[no-untyped-call]
        for name in ("signal", "noise", "length"):
            self.register_buffer(name, torch.ones(()))

    def forward(self, x: Tensor) -> Tensor:
        """Return mean and log deviation [n, 2]."""
        x = x / self.length
        near = x @ (2 * self.points.T) - (x * x).sum(1, keepdim=True)
        kernel = self.signal * torch.exp(0.5 * (near - (self.points * self.points).sum(1)))
        explained = (kernel @ self.reduction).square().sum(1, keepdim=True)
        left = torch.relu(self.signal - explained) + self.noise
        return torch.cat([self.mean(kernel), 0.5 * torch.log(left)], 1)


class GaussianProcess(BlockModel):
    """Gaussian process on levels, range and the six features; gives a deviation.

    Source: Wymeersch, Marano, Gifford and Win, "A machine learning approach to ranging error
    mitigation for UWB localization", IEEE Trans. Commun. 60(6), 2012. Squared-exponential kernel
    of one `length` (in standard deviations of the figures) around the median error; `signal_m`
    and `noise_m` are deviations in metres. Sparse (Titsias, AISTATS 2009): kept at `points`
    inducing points, the centres of k-means, which are the rows themselves where these are as few;
    so an export holds 128 x 128 numbers, not 2 000 x 2 000. At most `max_train_rows` rows are
    taken, drawn with `random_state`. Does without what a table lacks, as long as it has one.
    """

    reads: ClassVar[tuple[str, ...]] = ("cir", "levels", "features", "range")
    does_without: ClassVar[tuple[str, ...]] = ("cir", "levels", "features", "range")
    gives_std: ClassVar[bool] = True
    module_: BlockError

    def __init__(
        self,
        points: int = 128,
        length: float = 4.0,
        signal_m: float = 0.5,
        noise_m: float = 0.2,
        max_train_rows: int = 12_000,
        random_state: int = 0,
    ) -> None:
        self.points = points
        self.length = length
        self.signal_m = signal_m
        self.noise_m = noise_m
        self.max_train_rows = max_train_rows
        self.random_state = random_state

    def fit(
        self,
        X: ArrayLike,
        y: ArrayLike,
        progress: Progress | None = None,
        groups: ArrayLike | None = None,
    ) -> Self:
        """Fit on rows [n, width] and errors [n] in metres; sets `module_`, `n_features_in_`."""
        rows, errors = thinned(*self._training_rows(X, y), self.max_train_rows, self.random_state)
        table = Table(Columns(self._layout(rows.shape[1])))
        figures = table.fit(rows).astype(np.float64) / self.length
        network = self._conditioned(figures, errors.astype(np.float64))
        self.module_ = BlockError(table, network, spread=True).eval()
        return self

    def _conditioned(self, x: Floats, errors: Floats) -> GaussianProcessNetwork:
        """Return the process given the errors at `x`, by inducing points (Titsias)."""
        points, offset = self._chosen(x), float(np.median(errors))
        signal, noise = self.signal_m**2, self.noise_m**2
        own = _kernel(points, points, signal) + JITTER * signal * np.eye(len(points))
        root = cholesky(own, lower=True)
        scaled = solve_triangular(root, _kernel(points, x, signal), lower=True)
        inner = cholesky(np.eye(len(points)) + scaled @ scaled.T / noise, lower=True)
        target = solve_triangular(inner, scaled @ (errors - offset) / noise, lower=True)
        inverse = solve_triangular(root, np.eye(len(points)), lower=True)
        weights = inverse.T @ solve_triangular(inner, target, lower=True, trans=1)
        return self._network(points, offset, weights, _reduction(inverse, inner))

    def _network(
        self, points: Floats, offset: float, weights: Floats, reduction: Floats
    ) -> GaussianProcessNetwork:
        network = GaussianProcessNetwork(*points.shape)
        numbers = {"signal": self.signal_m**2, "noise": self.noise_m**2, "length": self.length}
        arrays = {"points": points, "reduction": reduction, "mean.weight": weights[None]}
        state = {**arrays, **numbers, "mean.bias": [offset]}
        network.load_state_dict({k: torch.tensor(np.asarray(v)).float() for k, v in state.items()})
        return network

    def _chosen(self, x: Floats) -> Floats:
        """Return the points the process is kept at."""
        distinct = np.unique(x, axis=0)
        if len(distinct) <= self.points:
            return distinct
        clusters = MiniBatchKMeans(self.points, n_init=1, random_state=self.random_state)
        centres: Floats = clusters.fit(distinct).cluster_centers_
        return centres

    def _skeleton(self, width: int, weights: Mapping[str, Tensor]) -> nn.Module:
        shape = weights["network.points"].shape
        network = GaussianProcessNetwork(shape[0], shape[1])
        return BlockError(Table(Columns(self._layout(width))), network, spread=True)


def _kernel(a: Floats, b: Floats, signal: float) -> Floats:
    distance = (a * a).sum(1)[:, None] + (b * b).sum(1) - 2 * a @ b.T
    kernel: Floats = signal * np.exp(-0.5 * np.maximum(distance, 0))
    return kernel


def _reduction(inverse: Floats, inner: Floats) -> Floats:
    """Return L [m, m] with |k L|^2 = k (K^-1 - (K + K_mn K_nm / noise)^-1) k: what is known."""
    count = len(inverse)
    outer = solve_triangular(inner, np.eye(count), lower=True)
    known = inverse.T @ (np.eye(count) - outer.T @ outer) @ inverse
    values, vectors = np.linalg.eigh((known + known.T) / 2)
    reduction: Floats = vectors * np.sqrt(np.maximum(values, 0))
    return reduction
