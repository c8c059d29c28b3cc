"""Reading ONNX files as what they may be (hostile), and writing them as small as they can be."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count
from pathlib import Path
from typing import Any

import onnx
from google.protobuf.message import DecodeError  # type: ignore[import-untyped]
from onnx import AttributeProto, GraphProto, ModelProto, NodeProto, TensorProto

_DIGITS = "0123456789abcdefghijklmnopqrstuvwxyz"


def load_graph(path: Path) -> ModelProto:
    """Return the ONNX model in a file.

    Raises ValueError, naming the file, where it is missing, empty, truncated, no ONNX model, or
    keeps its weights in other files (a way to read files it was not given).
    """
    try:
        model = onnx.load_model_from_string(path.read_bytes())
    except (OSError, DecodeError) as problem:
        raise ValueError(f"{path}: no readable ONNX model ({problem})") from problem
    if not model.graph.output:
        raise ValueError(f"{path}: no ONNX model, or a truncated one (it has no outputs)")
    if any(tensor.data_location == TensorProto.EXTERNAL for tensor in model.graph.initializer):
        raise ValueError(f"{path}: refers to weights in other files, which is not allowed")
    return model


def save_graph(model: ModelProto, path: Path) -> None:
    """Write the model without anything the runtime does not need. `model` is changed."""
    compact(model)
    path.write_bytes(model.SerializeToString())


def compact(model: ModelProto) -> None:
    """Strip documentation, metadata and defaults, share equal constants, shorten all names.

    Names of inputs and outputs stay, as does every value: the graph computes the same.
    """
    _strip_metadata(model)
    _share_constants(model.graph)
    _drop_unused_constants(model.graph)
    _drop_defaults(model)
    _shorten_names(model.graph)
    _drop_unused_domains(model)


def _strip_metadata(model: ModelProto) -> None:
    graph = model.graph
    for field in ("producer_name", "producer_version", "domain", "doc_string", "model_version"):
        model.ClearField(field)
    for field in ("metadata_props", "functions"):
        model.ClearField(field)
    for field in ("value_info", "doc_string", "metadata_props", "quantization_annotation"):
        graph.ClearField(field)
    for item in (*graph.node, *graph.initializer, *graph.input, *graph.output):
        item.ClearField("doc_string")
        item.ClearField("metadata_props")
    graph.name = "g"


def _share_constants(graph: GraphProto) -> None:
    """Keep one of several constants with the same type, shape and values.

    Not of the zero points of signed weights: a runtime that makes these unsigned replaces each.
    """
    seen: dict[tuple[Any, ...], str] = {}
    renamed: dict[str, str] = {}
    for tensor in graph.initializer:
        _use_raw_data(tensor)
        if tensor.data_type == TensorProto.INT8 and not any(tensor.raw_data):
            continue
        key = (tensor.data_type, *tensor.dims, tensor.raw_data)
        renamed[tensor.name] = seen.setdefault(key, tensor.name)
    _rename(graph, renamed)


def _use_raw_data(tensor: TensorProto) -> None:
    array = onnx.numpy_helper.to_array(tensor)
    tensor.CopyFrom(onnx.numpy_helper.from_array(array, tensor.name))


def _drop_unused_constants(graph: GraphProto) -> None:
    used = {name for node in graph.node for name in node.input}
    used |= {value.name for value in graph.output}
    kept = [tensor for tensor in graph.initializer if tensor.name in used]
    del graph.initializer[:]
    graph.initializer.extend(kept)


def _drop_defaults(model: ModelProto) -> None:
    """Drop attributes that say what the operator's schema assumes anyway."""
    versions = {entry.domain: entry.version for entry in model.opset_import}
    for node in model.graph.node:
        defaults = _default_attributes(node, versions.get(node.domain, 1))
        kept = [entry for entry in node.attribute if not _is_default(entry, defaults)]
        del node.attribute[:]
        node.attribute.extend(kept)


def _default_attributes(node: NodeProto, version: int) -> dict[str, AttributeProto]:
    if node.domain or not onnx.defs.has(node.op_type):
        return {}
    schema = onnx.defs.get_schema(node.op_type, version)
    return {name: entry.default_value for name, entry in schema.attributes.items()}


def _is_default(entry: AttributeProto, defaults: dict[str, AttributeProto]) -> bool:
    default = defaults.get(entry.name)
    if default is None or not default.name:
        return False
    same: bool = onnx.helper.get_attribute_value(entry) == onnx.helper.get_attribute_value(default)
    return same


def _shorten_names(graph: GraphProto) -> None:
    names = _short_names()
    kept = {value.name for value in (*graph.input, *graph.output)} | {""}
    values = [tensor.name for tensor in graph.initializer]
    values += [name for node in graph.node for name in (*node.input, *node.output)]
    short = {name: next(names) for name in dict.fromkeys(values) if name not in kept}
    for tensor in graph.initializer:
        tensor.name = short.get(tensor.name, tensor.name)
    for node in graph.node:
        node.name = ""
    _rename(graph, short)


def _rename(graph: GraphProto, new_names: dict[str, str]) -> None:
    for node in graph.node:
        node.input[:] = [new_names.get(name, name) for name in node.input]
        node.output[:] = [new_names.get(name, name) for name in node.output]


def _short_names() -> Iterator[str]:
    """Yield 0, 1, .. z, 10, 11, .."""
    for number in count():
        text = ""
        while number >= len(_DIGITS):
            number, digit = divmod(number, len(_DIGITS))
            text = _DIGITS[digit] + text
        yield _DIGITS[number] + text


def _drop_unused_domains(model: ModelProto) -> None:
    used = {node.domain for node in model.graph.node} | {""}
    kept = [entry for entry in model.opset_import if entry.domain in used]
    del model.opset_import[:]
    model.opset_import.extend(kept)
