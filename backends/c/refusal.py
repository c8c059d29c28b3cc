"""Whether C can be written for a model, asked before anything is built."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from zoo.base import MitigationModel


def why_no_c(model: MitigationModel) -> str | None:
    """Return why no C can be written for the fitted model's float graph, or None.

    The graph is exported and read; the export is the one that `build` uses later.
    """
    from backends.c.emit import generate
    from backends.export import export_module
    from backends.graph_file import save_graph

    width = getattr(model, "n_features_in_", None)
    if width is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.onnx"
        save_graph(export_module(model.to_module(), width), path)
        try:
            generate(path, "fp32")
        except ValueError as problem:
            return f"{type(model).__name__}: {str(problem).removeprefix(f'{path}: ')}"
    return None
