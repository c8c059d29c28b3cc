"""What a diagnosis rests on, kept beside its report: the rows it worked with, and their simulation.

Small: no waveform, at most a few hundred rows. `bench plan` goes on from it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.compare.view import Comparison, View
from bench.discrepancy.data.observables import unit_of
from bench.discrepancy.data.split import thinned
from bench.discrepancy.settings import EVIDENCE_MEMBERS
from bench.errors import BenchError
from bench.recordings.io import read_recordings, write_recordings
from bench.recordings.table import CIR_COLUMNS, Recordings

FILE = "evidence.parquet"
KEPT = ("error_m", "rx_power_dbm", "first_path_power_dbm")
RECORDED, SIMULATED = "recorded: ", "simulated: "
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Evidence:
    """Rows with what is known before measuring (`frame`, [n]), recorded and simulated values.

    `recorded` and `simulated` [n, p] hold the observables `names` [p]; `simulated` is the mean of
    what the simulator says without anything added. Rows with an unknown value are left out.
    """

    frame: pd.DataFrame
    names: tuple[str, ...]
    recorded: Floats
    simulated: Floats

    @property
    def links(self) -> NDArray[np.intp]:
        """Link codes 0..L-1 of the rows [n]."""
        return np.unique(self.frame["link"].astype(str), return_inverse=True)[1].astype(np.intp)

    def thinned(self, most: int) -> Evidence:
        """Return at most about `most` rows, evenly from every link."""
        kept = thinned(np.arange(len(self.frame)), self.links, most)
        frame = self.frame.iloc[kept].reset_index(drop=True)
        return Evidence(frame, self.names, self.recorded[kept], self.simulated[kept])

    def only(self, name: str) -> Evidence:
        """Return the same rows with one observable."""
        at = [self.names.index(name)]
        return Evidence(self.frame, (name,), self.recorded[:, at], self.simulated[:, at])

    @property
    def units(self) -> tuple[str, ...]:
        """The units of the observables [p]."""
        return tuple(unit_of(name) for name in self.names)


def evidence(comparison: Comparison, rows: View) -> Evidence:
    """Return some rows beside what the simulator says of them."""
    made = comparison.ensemble(rows, (), EVIDENCE_MEMBERS)
    names = tuple(name for name in KEPT if name in made.names)
    at = [made.place(name) for name in names]
    recorded, simulated = made.recorded[:, at], made.simulated[..., at].mean(axis=0)
    known = np.isfinite(recorded + simulated).all(axis=1)
    frame = rows.frame.drop(columns=[c for c in CIR_COLUMNS if c in rows.frame])
    kept = frame[known].reset_index(drop=True)
    return Evidence(kept, names, recorded[known], simulated[known])


def write_evidence(found: Evidence, folder: Path) -> None:
    """Write what a diagnosis rests on. Raises BenchError where the folder cannot be written."""
    columns = {RECORDED + n: c for n, c in zip(found.names, found.recorded.T, strict=True)}
    columns |= {SIMULATED + n: c for n, c in zip(found.names, found.simulated.T, strict=True)}
    whole = pd.concat([found.frame, pd.DataFrame(columns)], axis=1)
    write_recordings(Recordings(whole, "diagnosis"), folder / FILE)


def read_evidence(folder: Path) -> Evidence:
    """Read what a diagnosis rests on. Raises BenchError where it is not there or damaged."""
    path = folder / FILE
    if not path.exists():
        raise BenchError(f"{path}: not there; expected a folder that `bench diagnose -o` wrote")
    whole = read_recordings(path).frame
    names = tuple(name for name in KEPT if {RECORDED + name, SIMULATED + name} <= set(whole))
    if not names:
        raise BenchError(f"{path}: holds no recorded and simulated values side by side")
    both = [
        np.stack([whole[word + n].to_numpy(np.float64) for n in names], axis=1)
        for word in (RECORDED, SIMULATED)
    ]
    if not np.isfinite(both).all():
        raise BenchError(f"{path}: holds values that are no numbers")
    extra = [c for c in whole if str(c).startswith((RECORDED, SIMULATED))]
    return Evidence(whole.drop(columns=extra), names, both[0], both[1])
