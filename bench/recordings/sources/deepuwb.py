"""The Deep UWB data set of the REMnet paper; its form is described in `readers.deepuwb`."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from bench.errors import BenchError
from bench.recordings.sources.base import Publisher, Source, find_file, how_to_get

if TYPE_CHECKING:
    from bench.recordings.table import Recordings

FILE = "dataset.pkl"


class DeepUwbSource(Source):
    """Deep UWB, the REMnet paper's own data: rooms and obstacles (Angarano et al. 2021, real)."""

    name = "deepuwb"
    title = "Deep UWB Dataset (of the REMnet paper)"
    licence = "not stated here, see 10.5281/zenodo.4290069"
    test_environment: ClassVar[str | None] = "medium"
    publisher = Publisher("https://doi.org/10.5281/zenodo.4290069", doi="10.5281/zenodo.4290069")
    untested = "written by its published description, never tried on a real file"

    def available(self) -> str | None:
        """Return None where the pickle is here, else how to get it."""
        return None if find_file(self.name, FILE) else how_to_get(self, FILE)

    def load(self) -> Recordings:
        """Read the pickle, or what was read of this very file before.

        Raises BenchError where it is missing, cut short, hostile or of another form.
        """
        from bench.recordings.readers.deepuwb import MODULES, read_deepuwb
        from bench.recordings.sources.cached import cached

        path = find_file(self.name, FILE)
        if path is None:
            raise BenchError(f"{self.name}: {how_to_get(self, FILE)}")
        return cached(self, [path], MODULES, lambda: read_deepuwb(path))
