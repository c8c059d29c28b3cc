"""Result files -> Markdown and figures. Knows result files, never models."""

from reports.boards import Board, make_boards
from reports.errors import ReportError
from reports.load import Results, read_results

__all__ = ["Board", "ReportError", "Results", "make_boards", "read_results"]
