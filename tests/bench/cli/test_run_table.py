"""The table of `bench run`: every figure whole at 80 columns."""

from __future__ import annotations

from io import StringIO

import result_files as files
from rich.console import Console

from bench.cli.run_view import _accuracy_table
from reports.terminal import parts


def test_no_figure_is_cut_at_80_columns() -> None:
    runs = [
        files.run(model, "c-fp32", nlos=files.score(10.1234, 12.5))
        for model in ("constant-by-level", "remnet-levels")
    ]
    shown = Console(file=StringIO(), width=80)
    for part in parts(_accuracy_table(runs, [files.timing(runs[0], 12345.6)]), 80):
        shown.print(part)
    text = shown.file.getvalue()
    assert "…" not in text
    assert "10.1234" in text
    assert "12345.6" in text
    assert max(map(len, text.splitlines())) <= 80
