"""MILUV, quadcopters in a room with obstacles; its form is described in `readers.miluv`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from bench.errors import BenchError
from bench.recordings.sources.base import Publisher, Source, find_files, how_to_get

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bench.recordings.table import Recordings

WANTED = "EXPERIMENT/ROBOT/uwb_range.csv and uwb_cir.csv"


class MiluvSource(Source):
    """Quadcopters in a room: CIRs, ranges, timestamps; moving (Shalaby et al. 2025, real)."""

    name = "miluv"
    title = "MILUV: multi-UAV indoor localisation with UWB and vision, moving pairs"
    licence = "not stated here, see 10.25452/figshare.plus.28386041"
    publisher = Publisher("https://doi.org/10.25452/figshare.plus.28386041.v1")
    variants: ClassVar[Mapping[str, str]] = {
        "ds": "double-sided ranges of the timestamps, before calibration",
        "ss": "single-sided ranges of the timestamps, before calibration",
    }

    def available(self) -> str | None:
        """Return None where an experiment with CIRs is here, else how to get one."""
        return None if self._experiments() else how_to_get(self, WANTED)

    def load(self) -> Recordings:
        """Read every experiment that has CIRs (environment: the experiment's name).

        Raises BenchError where there is none or a file has another form.
        """
        from bench.recordings.readers.miluv import read_miluv
        from bench.recordings.table import Recordings

        folders = self._experiments()
        if not folders:
            raise BenchError(f"{self.name}: {self.available()}")
        read = read_miluv(folders, self.variant)
        return Recordings(read.frame, self.full_name, self.licence, dropped=read.dropped)

    def _experiments(self) -> list[Path]:
        """Return the folders of the experiments that have both tables."""
        with_cir = {path.parent.parent for path in find_files(self.name, "uwb_cir.csv")}
        with_range = {path.parent.parent for path in find_files(self.name, "uwb_range.csv")}
        return sorted(with_cir & with_range)
