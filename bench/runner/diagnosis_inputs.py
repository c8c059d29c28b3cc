"""What a diagnosis was made from, kept beside its report, so that others can go on from it."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path

import pandas as pd

from bench.discrepancy.report.folder import INPUTS, read_part
from bench.errors import BenchError
from bench.files import write_atomically
from bench.physics.base import Base
from bench.physics.simulator import Simulator
from bench.physics.toml_file import from_toml, to_toml
from bench.recordings.open import Table, is_path, read
from bench.recordings.table import Recordings


@dataclass(frozen=True)
class Inputs:
    """The recordings and what they were compared with: a simulator, or a table's rows."""

    recorded: Recordings
    simulator: Simulator
    table: Recordings | None


def write_inputs(
    folder: Path,
    recorded: Table,
    simulated: object,
    environment: str | None,
    table: Recordings,
    against: Simulator | Recordings,
    base: Base,
) -> None:
    """Write the names of both sides, absolute, and the simulator; tables at hand have no name."""
    if isinstance(against, Recordings):
        simulator, named, mark = Simulator(base, name="base"), _name(simulated), against.fingerprint
    else:
        simulator, named, mark = replace(against, base=base), None, None
    content = {
        "recorded": _name(recorded),
        "environment": environment,
        "fingerprint": table.fingerprint,
        "simulated_table": named,
        "simulated_fingerprint": mark,
        "simulator_toml": to_toml(simulator),
    }
    write_atomically(folder / INPUTS, json.dumps(content, indent=1) + "\n")


def _name(given: object) -> str | None:
    """Return a data set's name or a file's absolute path, None for a table at hand."""
    if isinstance(given, Recordings | pd.DataFrame) or given is None:
        return None
    return str(Path(str(given)).resolve()) if is_path(str(given)) else str(given)


def read_inputs(folder: Path, recorded: Table | None = None) -> Inputs:
    """Open what a diagnosis was made from; `recorded` instead of the name that it remembers.

    Raises BenchError where it is not there, is gone, or holds other rows by now.
    """
    path, content = folder / INPUTS, read_part(folder, INPUTS)
    if not isinstance(content.get("simulator_toml"), str):
        raise BenchError(f"{path}: not what `bench diagnose` writes")
    table = _opened(path, content, "recorded", "fingerprint", recorded)
    if table is None:
        raise BenchError(f"{path}: the recordings were a table at hand; name them: --recorded PATH")
    simulator = from_toml(content["simulator_toml"], str(path))
    foreign = _opened(path, content, "simulated_table", "simulated_fingerprint", None)
    return Inputs(table, simulator, foreign)


def _opened(
    path: Path, content: dict[str, object], name: str, mark: str, given: Table | None
) -> Recordings | None:
    """Return a table by the name in a file (or `given`), if its rows are still the same."""
    named = content.get(name) if given is None else given
    if not isinstance(named, str | Path | pd.DataFrame | Recordings):
        return None
    environment = content.get("environment") if name == "recorded" else None
    table = read(named, environment if isinstance(environment, str) else None)
    if table.fingerprint != content.get(mark):
        raise BenchError(f"{path}: {named} holds other rows than were diagnosed; diagnose again")
    return table
