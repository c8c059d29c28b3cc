"""The same network in the form that the runtime's integer kernels are quick with.

Integer kernels take about 1.7 us each however small the work, and a network for a range has many
small ones; so what counts is their number, and how long the stretches of memory are that they
work on. Every rewrite here is exact but for the order of float32 sums. On an AVX-512 machine they
take REMnet from 1.04 to 0.93 of the unoptimised float32 latency (one row), and from 0.98 to 0.86
(four rows).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import torch
from torch import nn
from torch.fx import GraphModule, Node

_aten = torch.ops.aten
SPAN_STEPS = 16  # time steps gated by one stretch of memory
FEWEST_STEPS = 100  # below this, longer stretches cost more in reshaping than they save


def to_integer_form(program: GraphModule) -> None:
    """Rewrite a program of core operators in place; its parameters may change shape and order."""
    for rewrite in (_drop_copies, _gates_in_spans, _gates_as_convolutions, _channels_last):
        rewrite(program)
    program.graph.eliminate_dead_code()
    program.recompile()


def _drop_copies(program: GraphModule) -> None:
    """Remove what dropout leaves behind in eval mode."""
    for node in _calls(program, _aten.clone.default):
        _replace(node, _input(node))


def _gates_as_convolutions(program: GraphModule) -> None:
    """Keep a channel gate in channel form: dense layers on [n, c] become convolutions of width 1.

    mean [n, c] -> dense layers -> unsqueeze [n, c, 1] becomes mean [n, c, 1] -> convolutions,
    which spares the integer graph a squeeze and an unsqueeze per gate.
    """
    for mean in _calls(program, _aten.mean.dim):
        chain, end = _gate(mean)
        dense = [node for node in chain if node.target is _aten.linear.default]
        if end is not None and all(_owns_weight(node) for node in dense):
            mean.args = (mean.args[0], [-1], True)
            for node in dense:
                _as_convolution(program, node)
            _replace(end, _input(end))


def _gate(mean: Node) -> tuple[list[Node], Node | None]:
    """Return the layers that follow a mean over time, and the unsqueeze that ends them."""
    chain: list[Node] = []
    node = _only_user(mean) if mean.args[1] == [-1] and len(mean.args) == 2 else None
    links = (_aten.linear.default, _aten.relu.default, _aten.sigmoid.default)
    while node is not None and node.target in links:
        chain.append(node)
        node = _only_user(node)
    ends = node is not None and node.target is _aten.unsqueeze.default and node.args[1] == -1
    return chain, node if ends else None


def _as_convolution(program: GraphModule, dense: Node) -> None:
    _change_weight(program, dense, lambda weight: weight[:, :, None])
    dense.target = _aten.conv1d.default


def _channels_last(program: GraphModule) -> None:
    """Enter and leave the convolutions through transposes, which the runtime then cancels.

    Its integer convolutions keep channels innermost; without these it adds transposes of its own.
    """
    for node in _calls(program, _aten.unsqueeze.default):
        if node.args[1] == 1 and len(_shape(_input(node))) == 2:  # [n, w] -> [n, 1, w]
            last = _before(node, _aten.unsqueeze.default, node.args[0], 2)
            _replace(node, _before(node, _aten.permute.default, last, [0, 2, 1]))
    for view in _calls(program, _aten.view.default):
        dense = _only_user(view)
        flattens = len(_shape(_input(view))) == 3 and len(_shape(view)) == 2
        if flattens and dense is not None and dense.target is _aten.linear.default:
            _flatten_channels_last(program, view, dense)


def _flatten_channels_last(program: GraphModule, view: Node, dense: Node) -> None:
    """Flatten [n, c, w] with channels innermost, and order the dense layer's inputs alike."""
    if not _owns_weight(dense):
        return
    channels, width = (int(size) for size in _shape(_input(view))[1:])
    view.args = (_before(view, _aten.permute.default, view.args[0], [0, 2, 1]), view.args[1])
    view.target = _aten.reshape.default
    _change_weight(
        program,
        dense,
        lambda weight: weight.reshape(-1, channels, width).transpose(1, 2).flatten(1),
    )


def _owns_weight(layer: Node) -> bool:
    """Tell whether a layer's weight is a parameter that nothing else uses."""
    weight = layer.args[1]
    return isinstance(weight, Node) and weight.op == "get_attr" and len(weight.users) == 1


def _change_weight(
    program: GraphModule, layer: Node, change: Callable[[torch.Tensor], torch.Tensor]
) -> None:
    """Store a layer's weight in another shape or order."""
    weight = layer.args[1]
    assert isinstance(weight, Node)
    owner, _, name = str(weight.target).rpartition(".")
    holder = program.get_submodule(owner)
    old = getattr(holder, name).detach()
    setattr(holder, name, nn.Parameter(change(old).contiguous()))


def _gates_in_spans(program: GraphModule) -> None:
    """Multiply maps [n, c, w] by gates [n, c, 1] in stretches of several time steps.

    With channels innermost the runtime works on c values at a time; the gate repeated for
    `SPAN_STEPS` steps makes that c x 16.
    """
    for product in _calls(program, _aten.mul.Tensor):
        maps, gate = product.args
        if isinstance(maps, Node) and isinstance(gate, Node) and _gates_steps(maps, gate):
            _replace(product, _spanned(product, maps, gate))


def _gates_steps(maps: Node, gate: Node) -> bool:
    """Tell whether `gate` has one value per channel for enough steps of `maps`."""
    sizes, ones = _shape(maps), _shape(gate)
    if len(sizes) != 3 or len(ones) != 3 or ones[2] != 1 or ones[1] != sizes[1]:
        return False
    return bool(sizes[2] >= FEWEST_STEPS and sizes[2] % SPAN_STEPS == 0)


def _spanned(product: Node, maps: Node, gate: Node) -> Node:
    channels, width = (int(size) for size in _shape(maps)[1:])
    long = channels * SPAN_STEPS
    steps = _before(product, _aten.permute.default, maps, [0, 2, 1])
    steps = _before(product, _aten.reshape.default, steps, [-1, width // SPAN_STEPS, long])
    gates = _before(product, _aten.permute.default, gate, [0, 2, 1])
    gates = _before(product, _aten.expand.default, gates, [-1, SPAN_STEPS, channels])
    gates = _before(product, _aten.reshape.default, gates, [-1, 1, long])
    gated = _before(product, _aten.mul.Tensor, steps, gates)
    gated = _before(product, _aten.reshape.default, gated, [-1, width, channels])
    return _before(product, _aten.permute.default, gated, [0, 2, 1])


def _calls(program: GraphModule, target: Any) -> list[Node]:
    return [node for node in program.graph.nodes if node.target is target]


def _input(node: Node) -> Node:
    first = node.args[0]
    assert isinstance(first, Node)
    return first


def _only_user(node: Node) -> Node | None:
    return next(iter(node.users)) if len(node.users) == 1 else None


def _shape(node: Node) -> tuple[Any, ...]:
    """Return the sizes of a value of the original program; the batch size is symbolic."""
    value = node.meta.get("val")
    return tuple(value.shape) if isinstance(value, torch.Tensor) else ()


def _before(node: Node, target: Any, *args: Any) -> Node:
    with node.graph.inserting_before(node):
        return node.graph.call_function(target, args)


def _replace(node: Node, by: Node) -> None:
    node.replace_all_uses_with(by)
    node.graph.erase_node(node)
