"""A sum of regression trees as a torch module, and as the one operator ONNX has for it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

_FIELDS = ("feature", "threshold", "left", "right", "missing_left", "value")
_TINY_STEP = np.float32(-np.inf)


class TreeEnsemble(nn.Module):
    """base + sum over trees of the value of the leaf a row falls into: [n, columns] -> [n].

    All trees' nodes lie in flat arrays; a leaf is its own child, so that every row may take
    `depth` steps in every tree. A value equal to a threshold goes left, NaN where
    `missing_left` says.
    """

    feature: Tensor
    threshold: Tensor
    left: Tensor
    right: Tensor
    missing_left: Tensor
    value: Tensor
    roots: Tensor
    base: Tensor
    depth: Tensor

    def __init__(self, nodes: int, trees: int) -> None:
        super().__init__()
        for name in _FIELDS:
            kind = torch.float32 if name in ("threshold", "value") else torch.int64
            self.register_buffer(name, torch.zeros(nodes, dtype=kind))
        self.register_buffer("roots", torch.zeros(trees, dtype=torch.int64))
        self.register_buffer("base", torch.zeros(()))
        self.register_buffer("depth", torch.zeros((), dtype=torch.int64))

    def forward(self, x: Tensor) -> Tensor:
        """Return the sums [n]."""
        at = self.roots.expand(len(x), -1)
        for _ in range(int(self.depth)):
            seen = torch.gather(x, 1, self.feature[at])
            low = torch.where(
                torch.isnan(seen), self.missing_left[at] > 0, seen <= self.threshold[at]
            )
            at = torch.where(low, self.left[at], self.right[at])
        return self.base + self.value[at].sum(1)

    def attributes(self) -> dict[str, Any]:
        """Return the attributes of ONNX's `ai.onnx.ml.TreeEnsembleRegressor`."""
        tree = np.searchsorted(self.roots.numpy(), np.arange(len(self.value)), side="right") - 1
        number = np.arange(len(self.value)) - self.roots.numpy()[tree]
        leaf = (self.left == torch.arange(len(self.left))).numpy()
        return {
            **_node_attributes(self, tree, number, leaf),
            "target_treeids": tree[leaf].tolist(),
            "target_nodeids": number[leaf].tolist(),
            "target_ids": [0] * int(leaf.sum()),
            "target_weights": self.value.numpy()[leaf].tolist(),
            "base_values": [float(self.base)],
            "n_targets": 1,
        }


def _node_attributes(
    trees: TreeEnsemble, tree: NDArray[np.int64], number: NDArray[np.int64], leaf: NDArray[np.bool_]
) -> dict[str, Any]:
    starts = trees.roots.numpy()[tree]
    return {
        "nodes_treeids": tree.tolist(),
        "nodes_nodeids": number.tolist(),
        "nodes_featureids": trees.feature.tolist(),
        "nodes_values": trees.threshold.tolist(),
        "nodes_modes": np.where(leaf, "LEAF", "BRANCH_LEQ").tolist(),
        "nodes_truenodeids": np.where(leaf, 0, trees.left.numpy() - starts).tolist(),
        "nodes_falsenodeids": np.where(leaf, 0, trees.right.numpy() - starts).tolist(),
        "nodes_missing_value_tracks_true": np.where(leaf, 0, trees.missing_left.numpy()).tolist(),
    }


def from_boosting(machine: Any) -> TreeEnsemble:
    """Return a fitted scikit-learn HistGradientBoostingRegressor as a module.

    Thresholds are rounded down to float32, so that a float32 value falls on the same side.
    """
    grown = [stage[0].nodes for stage in machine._predictors]
    sizes = [len(nodes) for nodes in grown]
    roots = np.concatenate([[0], np.cumsum(sizes)[:-1]]).astype(np.int64)
    flat = np.concatenate(grown)
    start = np.repeat(roots, sizes)
    own, leaf = np.arange(len(flat)), flat["is_leaf"].astype(bool)
    trees = TreeEnsemble(len(flat), len(roots))
    trees.load_state_dict(
        _tensors(
            {
                "feature": np.where(leaf, 0, flat["feature_idx"]),
                "threshold": np.where(leaf, 0, _rounded_down(flat["num_threshold"])),
                "left": np.where(leaf, own, start + flat["left"]),
                "right": np.where(leaf, own, start + flat["right"]),
                "missing_left": np.where(leaf, 0, flat["missing_go_to_left"]),
                "value": np.where(leaf, flat["value"], 0),
                "roots": roots,
                "base": np.array(np.ravel(machine._baseline_prediction)[0]),
                "depth": np.array(flat["depth"].max()),
            },
            trees,
        )
    )
    return trees


def _tensors(arrays: Mapping[str, NDArray[Any]], like: nn.Module) -> dict[str, Tensor]:
    kinds = {name: buffer.dtype for name, buffer in like.named_buffers()}
    return {name: torch.tensor(array).to(kinds[name]) for name, array in arrays.items()}


def _rounded_down(thresholds: NDArray[np.float64]) -> NDArray[np.float32]:
    single = thresholds.astype(np.float32)
    above = single.astype(np.float64) > thresholds
    rounded: NDArray[np.float32] = np.where(above, np.nextafter(single, _TINY_STEP), single)
    return rounded
