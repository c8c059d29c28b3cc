"""All of the Ghent publisher's environments; their form is described in `readers.ghent_family`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from bench.errors import BenchError
from bench.recordings.sources.base import Publisher, Source, find_files, how_to_get

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bench.recordings.table import Recordings

CIRS = "CIRsV2.hdf5"


class GhentFamilySource(Source):
    """Office, industry and university, features; variant cir with CIRs (Fontaine et al., real)."""

    name = "ghent-family"
    title = "UWB data sets of an office, industrial and university environment"
    licence = "not stated, cite 10.1109/JIOT.2023.3299319"
    publisher = Publisher(
        "https://github.com/JaronFontaine/"
        "UWB-dataset-from-an-office-industrial-and-university-environment"
    )
    variants: ClassVar[Mapping[str, str]] = {"cir": f"with the CIRs of {CIRS} (needs h5py)"}
    untested = "only IIoT without CIRs was tried on real files"

    def available(self) -> str | None:
        """Return None where an environment's table is here, else how to get it."""
        wanted = "meta_NAME.csv or features_NAME.csv"
        if not self._files():
            return how_to_get(self, wanted)
        return how_to_get(self, CIRS) if self.variant and not self._cirs() else None

    def load(self) -> Recordings:
        """Read every environment (with `:cir`: those that CIRsV2.hdf5 holds, with their CIRs).

        Raises BenchError where a file is missing or has another form.
        """
        from bench.recordings.readers.ghent_family import read_family
        from bench.recordings.table import Recordings

        missing = self.available()
        if missing:
            raise BenchError(f"{self.full_name}: {missing}")
        read = read_family(self._files(), self._cirs() if self.variant else None)
        return Recordings(read.frame, self.full_name, self.licence, dropped=read.dropped)

    def _files(self) -> list[Path]:
        """Return the tables, in this data set's folder or in that of `ghent`."""
        for name in (self.name, "ghent"):
            found = [p for kind in ("meta_*.csv", "features_*.csv") for p in find_files(name, kind)]
            if found:
                return found
        return []

    def _cirs(self) -> Path | None:
        found = [path for name in (self.name, "ghent") for path in find_files(name, CIRS)]
        return found[0] if found else None
