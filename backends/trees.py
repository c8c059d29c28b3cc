"""The tail of a graph that torch has no operator for: a sum of trees."""

from __future__ import annotations

from collections import defaultdict
from statistics import fmean
from typing import TYPE_CHECKING, Any

from onnx import ModelProto, NodeProto, TensorProto, helper

if TYPE_CHECKING:
    from torch import nn

DOMAIN, VERSION = "ai.onnx.ml", 3
_NODES = (
    *("nodes_treeids", "nodes_nodeids", "nodes_modes"),
    *("nodes_truenodeids", "nodes_falsenodeids"),
)


def tree_tail(module: nn.Module) -> nn.Module | None:
    """Return the trees a module ends in, or None: `network`, where that is a TreeEnsemble."""
    from zoo.modules.trees import TreeEnsemble

    network = getattr(module, "network", None)
    return network if isinstance(network, TreeEnsemble) else None


def with_trees(columns: ModelProto, trees: Any) -> ModelProto:
    """Return the graph of the trees' columns [n, c] with the trees behind it: `error_m` [n]."""
    graph = ModelProto()
    graph.CopyFrom(columns)
    last = graph.graph.output[0]
    name, last_name = last.name, f"{last.name}_columns"
    for node in graph.graph.node:
        node.output[:] = [last_name if one == name else one for one in node.output]
        node.input[:] = [last_name if one == name else one for one in node.input]
    operator, column = "TreeEnsembleRegressor", f"{name}_column"
    attributes = trees.attributes()
    ensemble = helper.make_node(operator, [last_name], [column], domain=DOMAIN, **attributes)
    axes = helper.make_tensor(f"{name}_axes", TensorProto.INT64, [1], [1])
    graph.graph.initializer.append(axes)
    squeeze = helper.make_node("Squeeze", [column, axes.name], [name])
    graph.graph.node.extend([ensemble, squeeze])
    rows = last.type.tensor_type.shape.dim[0].dim_param or "n"
    last.CopyFrom(helper.make_tensor_value_info(name, TensorProto.FLOAT, [rows]))
    graph.opset_import.append(helper.make_opsetid(DOMAIN, VERSION))
    return graph


def nodes_passed(node: NodeProto) -> int:
    """Return the nodes a row passes in all trees, every leaf of a tree taken as equally likely.

    A node that is listed in front of the one it hangs from counts as a root.
    """
    given = {entry.name: helper.get_attribute_value(entry) for entry in node.attribute}
    depths: dict[tuple[int, int], int] = {}
    leaves: dict[int, list[int]] = defaultdict(list)
    for tree, number, mode, *below in zip(*(given.get(name, ()) for name in _NODES), strict=False):
        depth = depths.get((tree, number), 1)
        if mode == b"LEAF":
            leaves[tree].append(depth)
        else:
            depths.update({(tree, one): depth + 1 for one in below})
    return round(sum(map(fmean, leaves.values())))
