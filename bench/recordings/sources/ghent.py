"""The industrial hall of Ghent University; the files' form is described in `readers.ghent`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.errors import BenchError
from bench.recordings.sources.base import Publisher, Source, find_file, how_to_get

if TYPE_CHECKING:
    from bench.recordings.table import Recordings

FILES = ("meta_IIoT_19.csv", "meta_IIoT_20.csv")


class GhentSource(Source):
    """Industrial hall, features and raw timestamps, no CIR (Fontaine et al. 2023, real)."""

    name = "ghent"
    title = "UWB (N)LOS measurements in an industrial hall, 2019 and 2020"
    licence = "not stated, cite 10.1109/JIOT.2023.3299319"
    publisher = Publisher("https://doi.org/10.1109/JIOT.2023.3299319")

    def available(self) -> str | None:
        """Return None where both years are here, else how to get them."""
        missing = [name for name in FILES if find_file(self.name, name) is None]
        return how_to_get(self, " and ".join(missing)) if missing else None

    def load(self) -> Recordings:
        """Read both years (environments IIoT_19 and IIoT_20).

        Raises BenchError where a file is missing or has another form.
        """
        from bench.recordings.readers.ghent import read_ghent
        from bench.recordings.table import Recordings

        paths = [path for name in FILES if (path := find_file(self.name, name))]
        if len(paths) < len(FILES):
            raise BenchError(f"{self.name}: {self.available()}")
        read = read_ghent(*paths)
        return Recordings(read.frame, self.name, self.licence, dropped=read.dropped)
