"""Any recordings a run can use: data sets, files, simulators' TOML files."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pandas as pd

from bench.errors import BenchError
from bench.files import cache_dir
from bench.provenance import packages_code_hash
from bench.recordings.io import read_recordings
from bench.recordings.open import Table, open_recordings, read
from bench.recordings.table import Recordings


def open_any(spec: Table) -> tuple[str, Recordings]:
    """Return the name and rows of a data set, a file, a table or a simulator (`SIM.toml`).

    A simulator is run in the rooms of the default data. Raises BenchError where there is nothing
    of that name, or the file is not what it should be.
    """
    if isinstance(spec, Recordings | pd.DataFrame):
        table = read(spec)
        return table.source, table
    if str(spec).endswith(".toml"):
        return str(spec), _simulated(Path(spec))
    recordings, source = open_recordings(spec)
    return source.full_name if source else str(spec), recordings


def _simulated(path: Path) -> Recordings:
    """Return a simulator's rows, kept once they are made."""
    from bench.physics import stream
    from bench.physics.room_plan import ROW_TOTAL
    from bench.physics.toml_file import read_toml, to_toml

    simulator = read_toml(path)
    code = packages_code_hash("bench/physics", "bench/recordings")
    key = hashlib.sha256(f"{to_toml(simulator)}{code}".encode()).hexdigest()[:20]
    target = cache_dir() / "simulated" / f"{path.stem}-{key}.parquet"
    if target.exists():
        try:
            return read_recordings(target)
        except BenchError:
            target.unlink(missing_ok=True)
    stream.simulate_to(simulator, stream.rooms(ROW_TOTAL, simulator.seed), target)
    return read_recordings(target)
