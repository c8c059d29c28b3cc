"""REMnet training in plain numba with BLAS: what `zoo.training.fused_remnet` is measured against.

Whole batches, feature maps [rows, time, features]; a convolution is one copy of its windows
(im2col) and one `np.dot`, its gradients two more. Nothing here knows of vectors or threads.
"""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np
import torch
from numpy.typing import NDArray

from zoo.modules.remnet import RemnetModule
from zoo.training.eager import epoch_orders

Floats = NDArray[np.float32]
njit: Any = numba.njit(nogil=True, fastmath=True, error_model="numpy")
ZERO, ONE = np.float32(0), np.float32(1)


@njit
def windows(x: Floats, taps: int, stride: int) -> Floats:
    rows, time, features = x.shape
    out, half = (time + stride - 1) // stride, taps // 2
    columns = np.zeros((rows, out, taps, features), np.float32)
    for n in range(rows):
        for t in range(out):
            for k in range(taps):
                at = t * stride + k - half
                if 0 <= at < time:
                    for f in range(features):
                        columns[n, t, k, f] = x[n, at, f]
    return columns.reshape(rows * out, taps * features)


@njit
def add_windows(columns: Floats, into: Floats, taps: int, stride: int) -> None:
    rows, time, features = into.shape
    out, half = (time + stride - 1) // stride, taps // 2
    pieces = columns.reshape(rows, out, taps, features)
    for n in range(rows):
        for t in range(out):
            for k in range(taps):
                at = t * stride + k - half
                if 0 <= at < time:
                    for f in range(features):
                        into[n, at, f] += pieces[n, t, k, f]


@njit
def layer(columns: Floats, w: Floats, b: Floats) -> Floats:
    """Return relu(columns @ w + b)."""
    y = np.dot(columns, w)
    for i in range(y.shape[0]):
        for f in range(y.shape[1]):
            y[i, f] = max(y[i, f] + b[f], ZERO)
    return y


@njit
def layer_back(columns: Floats, y: Floats, dy: Floats, dw: Floats, db: Floats) -> Floats:
    """Fill the gradients of w and b; return that of the columns before the ReLU."""
    d = np.where(y > ZERO, dy, ZERO).astype(np.float32)
    dw[:] = np.dot(columns.T, d)
    for f in range(d.shape[1]):
        db[f] = d[:, f].sum()
    return d


@njit
def block(x: Floats, p: Any) -> Any:
    rw, rb, ww, wb, nw, nb, sw, sb, ew, eb = p
    rows, time, features = x.shape
    c1 = windows(x, 3, 1)
    y1 = layer(c1, rw, rb)
    maps = y1.reshape(rows, time, features)
    mean = np.zeros((rows, features), np.float32)
    for n in range(rows):
        for t in range(time):
            for f in range(features):
                mean[n, f] += maps[n, t, f] / time
    hidden = layer(mean, sw, sb)
    gate = ONE / (ONE + np.exp(-(np.dot(hidden, ew) + eb)))
    both = np.empty_like(x)
    for n in range(rows):
        for t in range(time):
            for f in range(features):
                both[n, t, f] = maps[n, t, f] * gate[n, f] + x[n, t, f]
    c2, c3 = windows(both, 3, 2), windows(both, 1, 2)
    y2, y3 = layer(c2, ww, wb), layer(c3, nw, nb)
    out = (y2 + y3).reshape(rows, -1, features)
    return out, (c1, y1, mean, hidden, gate, c2, y2, c3, y3)


@njit
def block_back(x: Floats, dy: Floats, p: Any, g: Any, kept: Any) -> Floats:
    c1, y1, mean, hidden, gate, c2, y2, c3, y3 = kept
    rows, time, features = x.shape
    flat = dy.reshape(y2.shape)
    dboth = np.zeros_like(x)
    add_windows(np.dot(layer_back(c2, y2, flat, g[2], g[3]), p[2].T), dboth, 3, 2)
    add_windows(np.dot(layer_back(c3, y3, flat, g[4], g[5]), p[4].T), dboth, 1, 2)
    maps = y1.reshape(rows, time, features)
    dgate = np.zeros_like(gate)
    for n in range(rows):
        for t in range(time):
            for f in range(features):
                dgate[n, f] += dboth[n, t, f] * maps[n, t, f]
    dlogit = dgate * gate * (ONE - gate)
    g[8][:] = np.dot(hidden.T, dlogit)
    for f in range(features):
        g[9][f] = dlogit[:, f].sum()
    dmean = np.dot(layer_back(mean, hidden, np.dot(dlogit, p[8].T), g[6], g[7]), p[6].T)
    dmaps = np.empty_like(x)
    for n in range(rows):
        for t in range(time):
            for f in range(features):
                dmaps[n, t, f] = dboth[n, t, f] * gate[n, f] + dmean[n, f] / time
    before = layer_back(c1, y1, dmaps.reshape(y1.shape), g[0], g[1])
    add_windows(np.dot(before, p[0].T), dboth, 3, 1)
    return dboth


@njit
def gradient(signals: Floats, errors: Floats, mask: Floats, p: Any, g: Any) -> float:
    """Fill `g` with the gradient of the batch's mean absolute error; return its sum."""
    rows = len(signals)
    columns = windows(signals.reshape(rows, -1, 1), 7, 1)
    first = layer(columns, p[0][0], p[0][1])
    maps0 = first.reshape(rows, signals.shape[1], -1)
    maps1, kept1 = block(maps0, p[1])
    maps2, kept2 = block(maps1, p[2])
    maps3, kept3 = block(maps2, p[3])
    flat = maps3.reshape(rows, -1) * mask
    predicted = np.dot(flat, p[4][0]) + p[4][1]
    d = (np.sign(predicted[:, 0] - errors) / rows).astype(np.float32).reshape(rows, 1)
    g[4][0][:] = np.dot(flat.T, d)
    g[4][1][0] = d.sum()
    back = (np.dot(d, p[4][0].T) * mask).reshape(maps3.shape)
    back = block_back(maps2, back, p[3], g[3], kept3)
    back = block_back(maps1, back, p[2], g[2], kept2)
    back = block_back(maps0, back, p[1], g[1], kept1)
    layer_back(columns, first, back.reshape(first.shape), g[0][0], g[0][1])
    return np.abs(predicted[:, 0] - errors).sum()


@njit
def adam(flat: Floats, grads: Floats, mean: Floats, square: Floats, step: int, rate: float) -> None:
    pace = np.float32(rate / (1 - 0.9**step))
    root = np.float32(1 / math.sqrt(1 - 0.999**step))
    for i in range(len(flat)):
        mean[i] += np.float32(0.1) * (grads[i] - mean[i])
        square[i] = np.float32(0.999) * square[i] + np.float32(0.001) * grads[i] * grads[i]
        flat[i] -= pace * mean[i] / (math.sqrt(square[i]) * root + np.float32(1e-8))


class PlainNumba:
    """The default REMnet's weights, gradients and moments, each as views into one flat array."""

    def __init__(self, module: RemnetModule) -> None:
        shapes = [[(7, 16), (16,)]]
        hidden = 16 // module.reduction
        pairs = [(48, 16), (48, 16), (16, 16), (16, hidden), (hidden, 16)]
        shapes += [[s for a, b in pairs for s in ((a, b), (b,))] for _ in range(3)]
        shapes += [[(module.head.in_features, 1), (1,)]]
        size = sum(math.prod(s) for group in shapes for s in group)
        self.flat, self.grads, self.mean, self.square = np.zeros((4, size), np.float32)
        self.p, self.g = (self._views(flat, shapes) for flat in (self.flat, self.grads))
        self._read(module)

    @staticmethod
    def _views(flat: Floats, shapes: list[list[tuple[int, ...]]]) -> tuple[Any, ...]:
        views, start = [], 0
        for group in shapes:
            pieces = []
            for shape in group:
                pieces.append(flat[start : start + math.prod(shape)].reshape(shape))
                start += math.prod(shape)
            views.append(tuple(pieces))
        return tuple(views)

    def _read(self, module: RemnetModule) -> None:
        layers = [[module.first]]
        layers += [
            [r.residual, r.wide, r.narrow, r.gate.squeeze, r.gate.excite] for r in module.rrms
        ]
        with torch.no_grad():
            for group, found in zip(self.p, layers, strict=False):
                for i, one in enumerate(found):
                    order = (2, 1, 0) if one.weight.ndim == 3 else (1, 0)
                    group[2 * i][:] = one.weight.permute(order).reshape(group[2 * i].shape)
                    group[2 * i + 1][:] = one.bias
            head = module.head.weight.view(16, -1).T.reshape(-1, 1)  # time first, as maps lie here
            self.p[-1][0][:], self.p[-1][1][:] = head, module.head.bias

    def train(
        self, X: Floats, y: Floats, *, epochs: int, batch: int, rate: float, seed: int
    ) -> None:
        step, units = 0, self.p[-1][0].shape[0]
        generator = np.random.default_rng(seed)
        for order in epoch_orders(len(y), epochs, seed):
            for start in range(0, len(y), batch):
                rows = order[start : start + batch]
                mask = 2 * (generator.random((len(rows), units), np.float32) < 0.5)
                gradient(X[rows], y[rows], mask.astype(np.float32), self.p, self.g)
                step += 1
                adam(self.flat, self.grads, self.mean, self.square, step, rate)
