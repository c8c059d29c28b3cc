"""The outdoor measurements of Hanyang University; their form is described in `readers.outdoor`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.errors import BenchError
from bench.recordings.sources.base import Publisher, Source, find_file, how_to_get

if TYPE_CHECKING:
    from bench.recordings.table import Recordings

FOLDER = "Static_measurements"


class OutdoorSource(Source):
    """Outdoors at many heights and distances, features only, no CIR (Hanyang, real)."""

    name = "outdoor"
    title = "Comprehensive outdoor UWB dataset, static measurements"
    licence = "Apache-2.0"
    publisher = Publisher("https://doi.org/10.5281/zenodo.15226105", doi="10.5281/zenodo.15226105")

    def available(self) -> str | None:
        """Return None where the static measurements are here, else how to get them."""
        missing = f"the folder {FOLDER}"
        return None if find_file(self.name, FOLDER) else how_to_get(self, missing)

    def load(self) -> Recordings:
        """Read the static part (environment: outdoor).

        Raises BenchError where it is missing or a file has another form.
        """
        from bench.recordings.readers.outdoor import read_outdoor
        from bench.recordings.table import Recordings

        folder = find_file(self.name, FOLDER)
        if folder is None:
            raise BenchError(f"{self.name}: {self.available()}")
        read = read_outdoor(folder)
        return Recordings(read.frame, self.name, self.licence, dropped=read.dropped)
