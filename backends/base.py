"""The adapter a backend is: a fitted model in, a file that runs out."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from zoo.base import MitigationModel, Progress


Floats = NDArray[np.float32]
Precision = Literal["fp32", "fp16", "int8"]
Runner = Callable[[Floats], Floats]
"""Rows [n, width] -> errors [n] in metres; what latency is measured on."""


class CannotTakeError(ValueError):
    """Raised by `build` where only building shows that a backend does not take a model.

    The pair is then skipped with this reason, as if `supports` had given it.
    """


@dataclass(frozen=True)
class TrainingData:
    """The training split, for calibrating ranges and for quantisation-aware training.

    `cirs` float32 [n, width]: rows as the model takes them, CIRs in counts unless it reads other
    blocks too. `errors_m` float32 [n]; `seed` drives every random choice.
    """

    cirs: Floats
    errors_m: Floats
    seed: int


@dataclass(frozen=True)
class KernelCoverage:
    """How many of the operators that carry weights run as integer kernels.

    Read from the graph the runtime really executes (after its own optimisation).
    `kernels` counts every operator type in that graph.
    """

    integer: int
    total: int
    kernels: dict[str, int]


@dataclass(frozen=True)
class Artifact:
    """A model as one file on disk, and how to run it.

    `opener` is "module:function", called with (path, threads) and returning a `Runner`; a fresh
    process needs nothing else to time it. `note` says in words what the backend really did.
    """

    path: Path
    precision: Precision
    opener: str
    note: str = ""
    coverage: KernelCoverage | None = None

    def open(self, threads: int = 1) -> Runner:
        """Return the callable that runs the file on this machine with that many threads."""
        module, _, function = self.opener.partition(":")
        runner: Runner = getattr(import_module(module), function)(self.path, threads)
        return runner

    def predict(self, cirs: Floats, batch_rows: int = 4096) -> Floats:
        """Return errors [n] in metres for CIRs [n, width], in blocks of `batch_rows`."""
        run = self.open()
        blocks = [run(cirs[i : i + batch_rows]) for i in range(0, len(cirs), batch_rows)]
        return np.concatenate(blocks) if blocks else np.empty(0, np.float32)

    def deviations(self, cirs: Floats, batch_rows: int = 4096) -> Floats:
        """Return standard deviations [n] in metres, the second output `std_m` of an ONNX file.

        Raises ValueError where the file has no such output.
        """
        from backends.ort import second_output

        run = second_output(self.path)
        return np.concatenate(
            [run(cirs[i : i + batch_rows]) for i in range(0, len(cirs), batch_rows)]
        )


class Backend(ABC):
    """Turns a fitted model into an `Artifact`. Only `build` must be written.

    `opener` runs its files later, in other processes too: it is taken from the registered backend
    alone, never from a result file. `rests_on` names the distributions whose versions decide its
    figures, beyond those of the harness itself. `bits_depend_on_threads` is False where the
    number of threads in `build` changes no bit of the file.

    >>> class Mine(Backend):
    ...     name = "mine"
    ...     precision = "fp32"
    ...     opener = "my_package:open_runner"
    ...     rests_on = ("my-runtime",)
    ...     def build(self, model, data, path, progress=None):
    ...         path.write_bytes(b"...")
    ...         return Artifact(path, "fp32", self.opener)
    """

    name: ClassVar[str]
    precision: ClassVar[Precision]
    opener: ClassVar[str]
    rests_on: ClassVar[tuple[str, ...]] = ()
    bits_depend_on_threads: ClassVar[bool] = True
    exports_as: ClassVar[str | None] = None
    """The backend whose file this one runs, where that is another: exported without its tools."""

    def cache_key(self) -> str:
        """Return text that changes with whatever else decides a result.

        That is the content of files and the values of environment variables that it reads; source
        and versions are seen without it.
        """
        return ""

    def supports(self, model: MitigationModel) -> str | None:
        """Return None, or the reason why this backend skips the fitted model."""
        del model
        return None

    @abstractmethod
    def build(
        self,
        model: MitigationModel,
        data: TrainingData,
        path: Path,
        progress: Progress | None = None,
    ) -> Artifact:
        """Write the fitted model to `path` and return it as an artifact."""
