"""The named inputs of a graph: what they are called, how wide they are, how rows feed them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from backends.base import Floats
from zoo.inputs import Input

if TYPE_CHECKING:
    from onnx import ModelProto
    from torch import nn

DEFAULT = "cir"
Feed = Callable[[Floats], dict[str, Floats]]


def inputs_of(module: nn.Module, width: int) -> tuple[Input, ...]:
    """Return the inputs a module names in `inputs`, or one CIR of `width`."""
    named: tuple[Input, ...] | None = getattr(module, "inputs", None)
    return named or (Input(DEFAULT, width),)


def graph_inputs(model: ModelProto) -> tuple[Input, ...]:
    """Return the inputs of a graph."""
    values = model.graph.input
    return tuple(Input(one.name, one.type.tensor_type.shape.dim[1].dim_value) for one in values)


def feeder(inputs: tuple[Input, ...]) -> Feed:
    """Return a function from rows [n, width of all] to what a session takes, by name.

    A graph of one input takes the rows as they are. The function raises ValueError where the
    widths do not add up.
    """
    if len(inputs) == 1:
        name = inputs[0].name
        return lambda rows: {name: rows}
    edges = np.cumsum([0, *(one.width for one in inputs)])

    def feed(rows: Floats) -> dict[str, Floats]:
        if rows.shape[1] != edges[-1]:
            raise ValueError(f"rows have {rows.shape[1]} columns, the graph takes {edges[-1]}")
        spans = zip(inputs, edges[:-1], edges[1:], strict=True)
        return {one.name: np.ascontiguousarray(rows[:, a:b]) for one, a, b in spans}

    return feed


def feeds(model: ModelProto, rows: Floats) -> dict[str, Any]:
    """Return rows [n, width of all] as what the graph takes, by name."""
    return feeder(graph_inputs(model))(rows)


def row_of_ones(model: ModelProto) -> Floats:
    """Return one row of ones, as wide as all inputs together."""
    return np.ones((1, sum(one.width for one in graph_inputs(model))), np.float32)
