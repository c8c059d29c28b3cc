"""One self-contained page of results: sort, filter, explore, a view per run. No network."""

from __future__ import annotations

from reports.site.page import Page, render
from reports.site.payload import payload

__all__ = ["Page", "payload", "render"]
