"""The furnished apartment of Kolakowski (2021); its form is described in `readers.apartment`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from bench.errors import BenchError
from bench.recordings.sources.base import Publisher, Source, find_file, how_to_get

if TYPE_CHECKING:
    from bench.recordings.table import Recordings

TABLES = ("anchors.csv", "tags.csv", "pairs.csv", "labels.csv")


class ApartmentSource(Source):
    """Furnished apartment: complex CIRs and ranges of still links (Kolakowski 2021, real)."""

    name = "apartment"
    title = "UWB Channel Impulse Responses Registered in a Furnished Apartment"
    licence = "CC-BY-4.0"
    publisher = Publisher("https://doi.org/10.5281/zenodo.4742391", doi="10.5281/zenodo.4742391")

    def available(self) -> str | None:
        """Return None where logs and tables are here, else how to get them."""
        missing = [name for name in (*TABLES, "*.log") if find_file(self.name, name) is None]
        return how_to_get(self, ", ".join(missing)) if missing else None

    def load(self) -> Recordings:
        """Read the logs, or what was parsed of these very files before (environment: apartment).

        Raises BenchError where files are missing or one is not as published.
        """
        from bench.recordings.readers.apartment import MODULES, read_apartment
        from bench.recordings.sources.cached import cached

        tables = {name: self._find(name) for name in TABLES}
        folder = self._find("*.log").parent
        logs = sorted(folder.glob("*.log"), key=lambda path: (len(path.stem), path.stem))
        read = [*logs, *tables.values()]
        return cached(self, read, MODULES, lambda: read_apartment(logs, tables))

    def _find(self, wanted: str) -> Path:
        """Return one of the files. Raises BenchError where it is missing."""
        found = find_file(self.name, wanted)
        if found is None:
            raise BenchError(f"{self.name}: {how_to_get(self, wanted)}")
        return found
