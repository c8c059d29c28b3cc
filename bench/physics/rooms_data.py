"""The embedded default data: rooms simulated from a seed, and kept once made.

Structure and error statistics follow the Deep UWB dataset of Angarano et al. (Zenodo
10.5281/zenodo.4290069): 55 000 rows, three rooms, ten obstacle kinds, 157 CIR samples with five
before the detected first path. Nothing in it was measured: it is SIMULATED.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.errors import BenchError
from bench.files import cache_dir
from bench.physics.room_plan import LICENCE
from bench.provenance import decisive_versions, keep, kept, packages_code_hash
from bench.recordings.sources.base import Source

if TYPE_CHECKING:
    from pathlib import Path

    from bench.physics.rooms import Rooms
    from bench.recordings.table import Recordings

_KIND = "rooms"


class RoomsSource(Source):
    """Three office rooms, outdoor and through the wall (SIMULATED, made from a seed in seconds)."""

    name = "rooms"
    title = "Simulated rooms after the Deep UWB dataset"
    licence = LICENCE
    simulated = True
    test_environment = "medium"

    def available(self) -> str | None:
        """Return None: the rows are simulated on this machine."""
        return None

    def load(self) -> Recordings:
        """Simulate the rows, or read what the same simulator, seed and code made before.

        Where the cache cannot be written the rows are returned all the same.
        """
        from bench.recordings.io import read_recordings, write_recordings

        rooms = self._rooms()
        target = self._place(rooms.key())
        if target.exists():
            try:
                return read_recordings(target)
            except BenchError:
                target.unlink(missing_ok=True)
        made = rooms.generate()
        try:
            write_recordings(made, target)
        except BenchError:
            return made
        return read_recordings(target)

    def kept(self) -> Path:
        """Return where the rows are kept once made; known unmade where nothing has changed."""
        question = [self.name, packages_code_hash("bench/physics"), decisive_versions()]
        if (key := kept(_KIND, question)) is None:
            keep(_KIND, question, key := self._rooms().key())
        return self._place(str(key))

    def _place(self, key: str) -> Path:
        return cache_dir() / "simulated" / f"{self.name}-{key}.parquet"

    def _rooms(self) -> Rooms:
        """Return the simulator with its rows."""
        from bench.physics.rooms import Rooms

        return Rooms()


class IdealRoomsSource(RoomsSource):
    """`rooms` as it was before docs/rooms.md, to repeat figures published with it (SIMULATED)."""

    name = "rooms-ideal"
    superseded = True
    title = "Simulated rooms without what real recordings show (docs/rooms.md)"

    def _rooms(self) -> Rooms:
        from bench.physics.rooms import IdealRooms

        return IdealRooms()
