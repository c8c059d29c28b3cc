"""Bregar's positioning data set of 2023; its form is described in `readers.bregar`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.errors import BenchError
from bench.recordings.sources.base import Publisher, Source, find_files, how_to_get

if TYPE_CHECKING:
    from bench.recordings.table import Recordings

FILE = "data.json"


class BregarSource(Source):
    """Four indoor sites, six channels: complex CIRs, levels, positions (Bregar 2023, real)."""

    name = "bregar"
    title = "Indoor UWB positioning and position tracking data set"
    licence = "not stated here, see 10.5281/zenodo.7629141"
    publisher = Publisher("https://doi.org/10.5281/zenodo.7629141", doi="10.5281/zenodo.7629141")
    untested = "written by its published description, never tried on a real file"

    def available(self) -> str | None:
        """Return None where a site is here, else how to get it."""
        return None if find_files(self.name, FILE) else how_to_get(self, f"SITE/{FILE}")

    def load(self) -> Recordings:
        """Read the sites (environments), or what was parsed of these very files before.

        Raises BenchError where there is none or one has another form.
        """
        from bench.recordings.readers.bregar import MODULES, read_bregar
        from bench.recordings.sources.cached import cached

        files = find_files(self.name, FILE)
        if not files:
            raise BenchError(f"{self.name}: {self.available()}")
        return cached(self, files, MODULES, lambda: read_bregar(files))
