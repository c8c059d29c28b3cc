"""ONNX's sum of regression trees as flat tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from backends.c.operators import Trees
from backends.c.reading import Node, Reading, UnknownOperatorError, Value
from backends.c.views import is_contiguous

LEAF = 0x7FFF  # the feature of a node that has none
MISSING_LEFT = 0x8000  # added to the feature where an unknown value goes left
_ONLY = {"aggregate_function": "SUM", "post_transform": "NONE", "n_targets": 1}


@dataclass(frozen=True)
class _Branch:
    feature: int
    threshold: float
    left: int
    right: int
    leaf: bool


def tree_ensemble(reading: Reading, node: Node) -> Value:
    """TreeEnsembleRegressor of comparisons `<=`, summed to one number."""
    for name, wanted in _ONLY.items():
        if node.get(name, wanted) != wanted:
            raise UnknownOperatorError(node.operator, f"with {name} {node.get(name, '')}")
    x = reading.ref(node.inputs[0])
    x = x if is_contiguous(x) else reading.packed(x)
    nodes, weights = _nodes(node), _weights(node)
    roots: list[int] = []
    tables = _Tables([], [], [])
    for tree in sorted({tree for tree, _ in nodes}):
        roots.append(len(tables.features))
        _lay_out(
            tables, {number: n for (t, number), n in nodes.items() if t == tree}, weights[tree]
        )
    if any(f & LEAF != LEAF and f & LEAF >= x.shape[-1] for f in tables.features):
        raise ValueError(f"{node.operator} compares a column that is not there")
    y = reading.new((1, 1))
    reading.operators.append(tables.operator(x, y, roots, node))
    return y


@dataclass(frozen=True)
class _Tables:
    features: list[int]
    thresholds: list[float]
    rights: list[int]

    def operator(self, x: object, y: object, roots: list[int], node: Node) -> Trees:
        base = node.get("base_values", [0.0])
        return Trees(
            x,  # type: ignore[arg-type]
            y,  # type: ignore[arg-type]
            np.array(self.features, np.uint16),
            np.array(self.thresholds, np.float32),
            np.array(self.rights, np.uint16),
            np.array(roots, np.uint16),
            float(base[0]),
        )


def _nodes(node: Node) -> dict[tuple[int, int], _Branch]:
    modes = [_text(mode) for mode in node.attributes["nodes_modes"]]
    if set(modes) - {"LEAF", "BRANCH_LEQ"}:
        raise UnknownOperatorError(node.operator, "with other comparisons than <=")
    if len(modes) >= LEAF:
        raise ValueError(f"{len(modes)} nodes of trees, at most {LEAF - 1} are taken")
    a = node.attributes
    missing = node.get("nodes_missing_value_tracks_true", [0] * len(modes))
    features = [
        int(feature) + (MISSING_LEFT if left else 0)
        for feature, left in zip(a["nodes_featureids"], missing, strict=True)
    ]
    keys = zip(a["nodes_treeids"], a["nodes_nodeids"], strict=True)
    columns = (features, a["nodes_values"], a["nodes_truenodeids"], a["nodes_falsenodeids"])
    leaves = [mode == "LEAF" for mode in modes]
    branches = [_Branch(*row) for row in zip(*columns, leaves, strict=True)]
    return dict(zip(keys, branches, strict=True))


def _text(mode: object) -> str:
    return mode.decode() if isinstance(mode, bytes) else str(mode)


def _weights(node: Node) -> dict[int, dict[int, float]]:
    a = node.attributes
    found: dict[int, dict[int, float]] = {tree: {} for tree in a["nodes_treeids"]}
    keys = zip(a["target_treeids"], a["target_nodeids"], a["target_weights"], strict=True)
    for tree, number, weight in keys:
        found[tree][number] = found[tree].get(number, 0.0) + weight
    return found


def _lay_out(tables: _Tables, nodes: Mapping[int, _Branch], weights: Mapping[int, float]) -> None:
    """Append a tree, each node followed by its left child. Raises ValueError for a loop."""
    waiting: list[tuple[int, int | None]] = [(min(nodes), None)]
    start = len(tables.features)
    while waiting:
        number, parent = waiting.pop()
        place = len(tables.features)
        if place - start >= len(nodes):
            raise ValueError("a tree whose nodes form a loop")
        if parent is not None:
            tables.rights[parent] = place
        one = nodes[number]
        tables.features.append(LEAF if one.leaf else one.feature)
        tables.thresholds.append(weights.get(number, 0.0) if one.leaf else one.threshold)
        tables.rights.append(0)
        if not one.leaf:
            waiting += [(one.right, place), (one.left, None)]
