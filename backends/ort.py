"""ONNX Runtime on the processor: opening files, and reading what it really executes."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from numpy.typing import NDArray

from backends.base import Floats, KernelCoverage, Runner
from backends.inputs import feeder, feeds
from zoo.inputs import Input

if TYPE_CHECKING:
    import onnx
    import onnxruntime

Optimisation = Literal["off", "extended", "all"]
_ERRORS_ONLY = 3
_WEIGHT_FOLDER = "session.model_external_initializers_file_folder_path"
_EXACT_SUMS = "session.x64quantprecision"
_INTEGER = ("QLinearConv", "ConvInteger", "QGemm", "QLinearMatMul", "MatMulInteger")
_FLOAT = ("Conv", "Gemm", "MatMul", "FusedConv", "FusedGemm", "FusedMatMul", "MatMulIntegerToFloat")


def open_plain(path: Path, threads: int = 1) -> Runner:
    """Return a runner of the graph exactly as the file has it. Raises ValueError as `session`."""
    return runner(session(path, threads, "off"))


def open_optimised(path: Path, threads: int = 1) -> Runner:
    """Return a runner with every optimisation for this machine. Raises ValueError as `session`."""
    return runner(session(path, threads, "all"))


def runner(opened: onnxruntime.InferenceSession) -> Runner:
    """Return a session as a plain function: rows float32 [n, width] -> errors float32 [n].

    A graph of several inputs takes them as blocks of columns, in its own order. The function
    raises ValueError for rows of another width or type, or where the graph fails.
    """
    run, outputs = opened.run, [opened.get_outputs()[0].name]
    feed = feeder(tuple(Input(one.name, int(one.shape[1] or 0)) for one in opened.get_inputs()))

    def predict(rows: Floats) -> Floats:
        try:
            errors: Floats = run(outputs, feed(rows))[0]
        except Exception as problem:  # the runtime's exceptions share no base class
            raise ValueError(f"ONNX Runtime: {first_line(problem)}") from problem
        return errors

    return predict


def second_output(path: Path) -> Runner:
    """Return a runner of a graph's second output; ValueError where it has but one."""
    opened = session(path)
    names = [one.name for one in opened.get_outputs()]
    if len(names) < 2:
        raise ValueError(f"{path}: no second output, the standard deviation")
    feed = feeder(tuple(Input(one.name, int(one.shape[1] or 0)) for one in opened.get_inputs()))

    def spread(rows: Floats) -> Floats:
        found: Floats = opened.run(names[1:2], feed(rows))[0]
        return found

    return spread


def session(
    path: Path, threads: int = 1, optimisation: Optimisation = "all", save_to: Path | None = None
) -> onnxruntime.InferenceSession:
    """Return a session on the processor, results the same from run to run.

    `save_to` receives the graph that is executed. Raises ValueError, naming the file, where it
    is missing, truncated, no ONNX model, or one that the runtime refuses.
    """
    import onnxruntime

    try:
        return onnxruntime.InferenceSession(
            path.read_bytes(),
            _options(threads, optimisation, save_to),
            providers=["CPUExecutionProvider"],
        )
    except OSError as problem:
        raise ValueError(f"{path}: cannot be read ({problem.strerror})") from problem
    except Exception as problem:  # the runtime's exceptions share no base class
        raise ValueError(f"{path}: refused by ONNX Runtime: {first_line(problem)}") from problem


def first_line(problem: Exception) -> str:
    """Return the first line of an exception's text, or its kind where it has none."""
    return next(iter(str(problem).splitlines()), type(problem).__name__)


def _options(
    threads: int, optimisation: Optimisation, save_to: Path | None
) -> onnxruntime.SessionOptions:
    import onnxruntime

    level = onnxruntime.GraphOptimizationLevel
    options = onnxruntime.SessionOptions()
    options.graph_optimization_level = {
        "off": level.ORT_DISABLE_ALL,
        "extended": level.ORT_ENABLE_EXTENDED,
        "all": level.ORT_ENABLE_ALL,
    }[optimisation]
    options.intra_op_num_threads = threads
    options.inter_op_num_threads = 1
    options.use_deterministic_compute = True
    options.log_severity_level = _ERRORS_ONLY
    # a file may name other files as its weights, found from here: nowhere
    options.add_session_config_entry(_WEIGHT_FOLDER, os.devnull)
    if save_to is None:
        # without VNNI, unsigned times signed bytes are added in 16 bits, where they overflow
        options.add_session_config_entry(_EXACT_SUMS, "1")
    else:  # what is only read keeps its weights as they are
        options.optimized_model_filepath = str(save_to)
    return options


def run_once(model: onnx.ModelProto, cirs: Floats) -> list[NDArray[Any]]:
    """Return every output of a model for rows float32 [n, width], operators as they stand."""
    return run_feeds(model, feeds(model, cirs))


def run_feeds(model: onnx.ModelProto, named: dict[str, NDArray[Any]]) -> list[NDArray[Any]]:
    """Return every output of a model for its inputs by name, operators as they stand."""
    import onnxruntime

    opened = onnxruntime.InferenceSession(
        model.SerializeToString(), _options(1, "off", None), providers=["CPUExecutionProvider"]
    )
    values: list[NDArray[Any]] = opened.run(None, named)
    return values


def executed_graph(path: Path, optimisation: Optimisation = "all") -> onnx.ModelProto:
    """Return the graph the runtime executes for a file, after its own optimisation.

    "extended" stops before the rewrites that fit memory layouts to this very processor.
    Raises ValueError as `session`.
    """
    from backends.graph_file import load_graph

    with tempfile.TemporaryDirectory() as folder:
        executed = Path(folder) / "executed.onnx"
        session(path, 1, optimisation, executed)
        return load_graph(executed)


def kernel_coverage(path: Path) -> KernelCoverage:
    """Return how many operators with weights run on integers in the graph really executed."""
    graph = executed_graph(path).graph
    constants = {tensor.name for tensor in graph.initializer}
    kernels: dict[str, int] = {}
    integer = total = 0
    for node in graph.node:
        kernels[node.op_type] = kernels.get(node.op_type, 0) + 1
        if node.op_type in _INTEGER + _FLOAT and constants & set(node.input):
            total += 1
            integer += node.op_type in _INTEGER
    return KernelCoverage(integer, total, kernels)
