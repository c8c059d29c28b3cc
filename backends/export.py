"""A torch module as one ONNX graph."""

from __future__ import annotations

import hashlib
import logging
import pickle
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import lru_cache
from io import BytesIO

import torch
from onnx import ModelProto
from onnxscript.optimizer import fold_constants
from torch import Tensor, nn
from torch.export import Dim, ExportedProgram

INPUT = "cir"
OUTPUT = "error_m"
_NO_LIMIT = 1 << 30
OPSET = 20  # the newest whose 8-bit operators the runtime fuses


def export_module(module: nn.Module, width: int) -> ModelProto:
    """Return the module as an ONNX graph: `cir` float32 [n, width] -> `error_m` float32 [n].

    Value names are those of the exported program's nodes (torch.fx), so that what is learnt about
    a value in torch can be said of it in ONNX; `backends.graph_file.save_graph` shortens them.
    The last few exports are kept, so that every backend of one fitted model shares one.
    """
    digest = _digest(module)
    if digest is None:
        return program_to_graph(export_program(module, width))
    graph: ModelProto = ModelProto.FromString(_exported(_Request(digest, width, module)))
    return graph


@dataclass(frozen=True)
class _Request:
    """What is exported; two are the same where the digests and widths are."""

    digest: str
    width: int
    module: nn.Module = field(compare=False)


@lru_cache(maxsize=16)  # every backend goes through all folds before the next one does
def _exported(request: _Request) -> bytes:
    graph = program_to_graph(export_program(request.module, request.width))
    serialised: bytes = graph.SerializeToString()
    return serialised


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


def export_program(module: nn.Module, width: int) -> ExportedProgram:
    """Return the module, in eval mode, as a program of core operators with a free batch size."""
    rows = torch.zeros(2, width)
    with quiet():
        program = torch.export.export(module.eval(), (rows,), dynamic_shapes=({0: Dim("n")},))
        decomposed: ExportedProgram = program.run_decompositions({})
    return decomposed


def program_to_graph(program: ExportedProgram) -> ModelProto:
    """Return an exported program as ONNX.

    torch has two exporters. The older, by tracing, takes 0.1 s but is deprecated and silently
    freezes whatever Python decides; this one (3 to 5 s) reads the program itself, folds its
    constants, and is paid once per fit.
    """
    with quiet():
        exported = torch.onnx.export(
            program,
            (),
            dynamo=True,
            opset_version=OPSET,
            input_names=[INPUT],
            output_names=[OUTPUT],
            verbose=False,
        )
        assert exported is not None
        # the exporter stops folding at 8 KiB, which leaves slices of weights to every call
        fold_constants(exported.model, input_size_limit=_NO_LIMIT, output_size_limit=_NO_LIMIT)
    graph: ModelProto = exported.model_proto
    return graph


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
