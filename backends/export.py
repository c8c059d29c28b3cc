"""A torch module as one ONNX graph."""

from __future__ import annotations

import gc
import hashlib
import logging
import pickle
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from copy import deepcopy
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from importlib import import_module
from io import BytesIO
from typing import Any

import torch
from onnx import ModelProto
from onnxscript.optimizer import fold_constants
from torch import Tensor, nn
from torch.export import Dim, ExportedProgram
from torch.fx import GraphModule

from backends.inputs import inputs_of
from backends.trees import tree_tail, with_trees
from zoo.inputs import Input

OUTPUTS = ("error_m", "std_m")
_NO_LIMIT = 1 << 30
OPSET = 20  # the newest whose 8-bit operators the runtime fuses


Rewrite = Callable[[GraphModule], None]
"""Changes a program in place to another form of the same function."""


@dataclass(frozen=True)
class Exported:
    """A module as ONNX, and as the program of core operators (torch.fx) that ONNX was made from.

    Values have the same names in both, so that what is learnt about a value in torch can be said
    of it in ONNX. `graph` maps the module's inputs (`cir` float32 [n, width] unless it names
    others) to `error_m` float32 [n], and `std_m` [n] where the module gives that too.
    """

    graph: ModelProto
    program: ExportedProgram

    def module(self) -> GraphModule:
        """Return the program as a module, with parameters of its own."""
        with quiet():
            return deepcopy(as_module(self.program))


def export_module(module: nn.Module, width: int) -> ModelProto:
    """Return the module as an ONNX graph: its inputs [n, width] -> `error_m` float32 [n].

    A module that ends in trees ends in ONNX's own operator for them.
    """
    trees = tree_tail(module)
    if trees is None:
        return exported(module, width).graph
    return with_trees(exported(module.preparation, width).graph, trees)  # type: ignore[arg-type]


def exported(module: nn.Module, width: int, rewrite: Rewrite | None = None) -> Exported:
    """Return the module, rewritten if asked, as ONNX. The last few are kept for other backends."""
    digest = _digest(module)
    request = _Request(digest or "", width, rewrite, module)
    found = _kept(request) if digest else _export(request)
    graph = ModelProto()
    graph.CopyFrom(found.graph)
    return Exported(graph, found.program)


@dataclass(frozen=True)
class _Request:
    """What is exported; two are the same where digests, widths and rewrites are."""

    digest: str
    width: int
    rewrite: Rewrite | None
    module: nn.Module = field(compare=False)


@lru_cache(maxsize=16)  # every backend goes through all folds before the next one does
def _kept(request: _Request) -> Exported:
    return _export(request)


def _export(request: _Request) -> Exported:
    inputs = inputs_of(request.module, request.width)
    with quiet(), _no_collecting():
        program = _traced(replace(request, rewrite=None)) if request.digest else _trace(request)
        if request.rewrite is not None:
            module = as_module(program.run_decompositions({}))
            request.rewrite(module)
            program = _program(module, inputs)
        return _to_onnx(program, inputs)


@lru_cache(maxsize=4)  # the rewritten form follows the plain one
def _traced(request: _Request) -> ExportedProgram:
    return _trace(request)


def _trace(request: _Request) -> ExportedProgram:
    return _program(request.module, inputs_of(request.module, request.width))


class _Fingerprint(pickle.Pickler):
    """Pickles a module with the values of its tensors in place of where they are stored."""

    def persistent_id(self, obj: object) -> object:
        if not isinstance(obj, Tensor):
            return None
        values = obj.detach().cpu().contiguous()
        return str(values.dtype), tuple(values.shape), values.numpy().tobytes()


def _digest(module: nn.Module) -> str | None:
    """Return a hash of all that the module is and holds; None where it cannot be pickled."""
    stream = BytesIO()
    try:
        _Fingerprint(stream).dump(module.eval())
    except (pickle.PicklingError, AttributeError, TypeError, RuntimeError):
        return None
    return hashlib.sha256(stream.getvalue()).hexdigest()


def _program(module: nn.Module, inputs: Sequence[Input]) -> ExportedProgram:
    """Return the module, in eval mode, as a program with a free batch size."""
    rows = tuple(torch.zeros(2, one.width) for one in inputs)
    free = tuple({0: Dim("n")} for _ in inputs)
    return torch.export.export(module.eval(), rows, dynamic_shapes=free)


def as_module(program: ExportedProgram) -> GraphModule:
    """Return an exported program as a module, its nodes named as in the program."""
    module = program.module(check_guards=False)
    return GraphModule(module, module.graph)


def _to_onnx(program: ExportedProgram, inputs: Sequence[Input]) -> Exported:
    """Return an exported program as ONNX.

    torch has two exporters. The older, by tracing, takes 0.1 s but is deprecated and silently
    freezes whatever Python decides; this one (1 to 3 s) reads the program itself, takes it apart
    into core operators, folds its constants, and is paid once per fit.
    """
    _list_operators_once()
    made = torch.onnx.export(
        program,
        (),
        dynamo=True,
        opset_version=OPSET,
        input_names=[one.name for one in inputs],
        output_names=OUTPUTS[: len(program.graph_signature.user_outputs)],
        verbose=False,
    )
    assert made is not None
    assert made.exported_program is not None
    # the exporter stops folding at 8 KiB, which leaves slices of weights to every call
    fold_constants(made.model, input_size_limit=_NO_LIMIT, output_size_limit=_NO_LIMIT)
    return Exported(made.model_proto, made.exported_program)


@cache
def _list_operators_once() -> None:
    """Have the exporter keep its list of a thousand operators: each export makes it anew, 0.4 s."""
    with suppress(ImportError, AttributeError):  # private to torch: without it, exports take longer
        private: Any = import_module("torch.onnx._internal._lazy_import").onnxscript_apis
        private.get_torchlib_ops = cache(private.get_torchlib_ops)


@contextmanager
def _no_collecting() -> Iterator[None]:
    """Leave the garbage until later: an export makes a million small objects, few of them garbage.

    They are all looked through at every collection, a sixth of the time.
    """
    before = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if before:
            gc.enable()


@contextmanager
def quiet() -> Iterator[None]:
    """Silence the chatter of the exporter: its warnings concern its own internals."""
    chatty = [logging.getLogger(name) for name in ("torch.onnx", "torch.export", "onnxscript")]
    levels = [logger.level for logger in chatty]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for logger in chatty:
            logger.setLevel(logging.ERROR)
        try:
            yield
        finally:
            for logger, level in zip(chatty, levels, strict=True):
                logger.setLevel(level)
