"""The one error a report raises."""


class ReportError(Exception):
    """Results cannot be read or shown: what is wrong, where, and what was expected."""
