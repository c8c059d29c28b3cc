"""Outcome files of a reproduction -> Markdown pages and pictures. Knows files, never models."""

from reports.reproduction.draw import pictures
from reports.reproduction.load import OutcomeFile, read_outcome, read_outcomes
from reports.reproduction.pages import full_page, index_page, outcome_page

__all__ = [
    "OutcomeFile",
    "full_page",
    "index_page",
    "outcome_page",
    "pictures",
    "read_outcome",
    "read_outcomes",
]
